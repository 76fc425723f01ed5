"""The whole chain over recordings: codes in, clean torque out, nothing wild gets through."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave import (
    ConfigurationError,
    Converter,
    FrozenTerm,
    Gains,
    InputError,
    OscillatorFilterConfig,
    RippleFilter,
    RippleFilterConfig,
    RippleOrder,
    RotationSource,
    StatusFlag,
    TorqueCalibration,
    TorqueSensor,
    TorqueSensorConfig,
)
from strainwave.configuration import learned_of, sensor_of
from strainwave.joint import parse_joint

CONVERTER = Converter(bits=16, minimum_V=-10, maximum_V=10, lowest_code=-32768)
CALIBRATION = TorqueCalibration(
    gain_Nm_per_V=6.6, zero_V=0.1, gain_drift_per_K=1e-3, linearisation=[0.01]
)


def sensor_config(gauges=3, source=RotationSource.speed, orders=(2, 4)):
    return TorqueSensorConfig(
        converter=CONVERTER,
        gains=Gains([1.0 / gauges] * gauges),
        calibration=CALIBRATION,
        filter=OscillatorFilterConfig(
            orders=list(orders), process_noise_variance_Nm2=1e-4, rotation_source=source
        ),
    )


def ripple_config(gauges=3, orders=(2, 4), sample_period_s=None, **parameters):
    return TorqueSensorConfig(
        converter=CONVERTER,
        gains=Gains([1.0 / gauges] * gauges),
        calibration=CALIBRATION,
        filter=RippleFilterConfig(orders=list(orders), **parameters),
        sample_period_s=sample_period_s,
    )


EITHER_FILTER = pytest.mark.parametrize("configured", [sensor_config, ripple_config])


def recording(n=4000, gauges=3):
    angle = 150e-3 * np.arange(n)
    volts = np.stack(
        [2.0 + 0.4 * np.sin(2 * angle + 2 * np.pi * j / 9) for j in range(gauges)], axis=1
    )
    codes = np.stack([CONVERTER.to_code(np.ascontiguousarray(v)) for v in volts.T], axis=1)
    return np.ascontiguousarray(codes), {
        "motor_speed_rad_s": np.full(n, 150.0),
        "motor_angle_rad": angle,
        "expected_torque_Nm": np.full(n, 12.6),
        "temperature_degC": np.linspace(15.0, 30.0, n),
    }


@EITHER_FILTER
def test_measured_torque_is_the_parts_one_after_the_other(configured):
    codes, arrays = recording()
    result = TorqueSensor(configured()).process(codes, **arrays)
    volts = -10 + 20 / 65536 * (codes + 32768.0)
    warmer = arrays["temperature_degC"] - 20
    u = 6.6 * (1 + 1e-3 * warmer) * (volts.mean(axis=1) - 0.1)
    torque = u + 40 * 0.01 * (u / 40) ** 2
    np.testing.assert_allclose(result.torque_measured_Nm, torque, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(result.torque_Nm, result.torque_measured_Nm - result.ripple_Nm)
    late = slice(3000, None)
    assert np.ptp(result.torque_measured_Nm[late]) > 2.0
    assert np.ptp(result.torque_Nm[late]) < 0.2


@pytest.mark.parametrize("kind", ["speed", "angle", "ripple", "ripple and time"])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_chunks_equal_one_call_to_the_last_bit(kind, dtype):
    by_ripple = kind.startswith("ripple")
    config = ripple_config() if by_ripple else sensor_config(source=RotationSource[kind])
    codes, arrays = recording(2000)
    codes[[10, 700, 701]] = 32767
    arrays["sequence"] = np.arange(2000, dtype=np.uint32) + np.uint32(2**32 - 500)
    arrays["sequence"][1500:] += np.uint32(7)
    if kind == "ripple and time":
        arrays["time_s"] = 1e-3 * np.arange(2000)
        arrays["time_s"][1500:] += 7e-3
    whole = TorqueSensor(config, dtype=dtype)
    one = whole.process(codes, **arrays)
    pieces = TorqueSensor(config, dtype=dtype)
    parts = [
        pieces.process(codes[a:b], **{name: array[a:b] for name, array in arrays.items()})
        for a, b in itertools.pairwise([0, 1, 1, 11, 701, 1500, 2000])
    ]
    for name in ("torque_measured_Nm", "torque_Nm", "ripple_Nm", "status"):
        joined = np.concatenate([getattr(part, name) for part in parts])
        assert joined.tobytes() == getattr(one, name).tobytes()
    assert pieces.counters == whole.counters
    assert whole.counters["samples_missing"] == 1
    assert whole.counters["gauge_saturated"] == 3


@EITHER_FILTER
def test_one_gauge_and_thirty_two_gauges(configured):
    for gauges in (1, 2, 4, 5, 32):
        codes, arrays = recording(50, gauges)
        result = TorqueSensor(configured(gauges)).process(codes, **arrays)
        volts = -10 + 20 / 65536 * (codes.mean(axis=1) + 32768.0)
        assert result.torque_measured_Nm[0] == pytest.approx(
            6.6 * 0.995 * (volts[0] - 0.1), rel=0.01
        )


def test_status_bits_and_counters_add_up():
    codes, arrays = recording(3000)
    codes[100, 0] = 32767
    codes[101, 1] = -32768
    arrays["temperature_degC"][200] = np.nan
    arrays["temperature_degC"][201] = 500.0
    arrays["expected_torque_Nm"][300] = np.inf
    arrays["motor_speed_rad_s"][400] = np.nan
    sequence = np.arange(3000, dtype=np.uint32)
    sequence[500] = 499
    sequence[600] = 590
    sequence[700:] += 5
    sensor = TorqueSensor(sensor_config())
    status = sensor.process(codes, **arrays, sequence=sequence).status
    named = {
        "gauge_saturated": [100, 101],
        "temperature_not_finite": [200],
        "temperature_out_of_range": [201],
        "expected_torque_not_finite": [300],
        "rotation_invalid": [400],
        "sample_repeated": [500],
        "sample_out_of_order": [600],
        # What was refused left a hole.
        "samples_missing": [501, 601, 700],
    }
    for name, places in named.items():
        bit = StatusFlag[name].value
        assert list(np.flatnonzero(status & bit)) == places, name
        assert sensor.counters[name] == len(places)
    assert sensor.counters["faults"] == np.count_nonzero(status & 0xFFF) == 7
    assert sensor.counters["samples"] == 3000


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_wild_streams_give_finite_torque_and_are_forgotten(seed):
    rng = np.random.default_rng(seed)
    n = 600
    wild = np.array([np.nan, np.inf, -np.inf, 1e30, -1e30, 5e-324, 1e-40, 0.0, -1e7, 3.0])
    config = rng.choice(
        [
            sensor_config(2, RotationSource.speed),
            sensor_config(2, RotationSource.angle),
            ripple_config(2),
        ]
    )
    sensor = TorqueSensor(config, dtype=rng.choice([np.float32, np.float64]))
    with np.errstate(over="ignore"):
        result = sensor.process(
            rng.integers(-32768, 32768, (n, 2)),
            motor_speed_rad_s=rng.choice(wild, n),
            motor_angle_rad=rng.choice(wild, n),
            expected_torque_Nm=rng.choice(wild, n),
            temperature_degC=rng.choice(wild, n),
            sequence=np.cumsum(rng.choice([1, 1, 1, 2, 50], n)).astype(np.uint32),
            time_s=rng.choice(wild, n) if rng.random() < 0.5 else None,
        )
    for array in (result.torque_measured_Nm, result.torque_Nm, result.ripple_Nm):
        assert np.isfinite(array).all()
    codes, arrays = recording(8000, 2)
    arrays["temperature_degC"][:] = 20.0
    after = sensor.process(codes, **arrays)
    fresh = TorqueSensor(config).process(codes, **arrays)
    assert np.abs(after.torque_Nm[6000:] - fresh.torque_Nm[6000:]).max() < 0.01


@EITHER_FILTER
def test_held_rows_are_found_by_an_encoder_that_stands(configured):
    codes, arrays = recording(3000, 3)
    codes[2001:2004] = codes[2000]
    arrays["motor_angle_rad"][2001:2004] = arrays["motor_angle_rad"][2000]
    arrays["temperature_degC"] = np.repeat(arrays["temperature_degC"][::10], 10)
    result = TorqueSensor(configured()).process(codes, **arrays)
    repeated = (result.status & StatusFlag.sample_repeated.value) != 0
    assert np.flatnonzero(repeated).tolist() == [2001, 2002, 2003]


def test_equal_codes_alone_are_no_fault():
    """Without an encoder or sample numbers nothing tells a held row from a quiet one."""
    codes, arrays = recording(3000, 3)
    codes[2001:2004] = codes[2000]
    result = TorqueSensor(sensor_config()).process(
        codes, motor_speed_rad_s=arrays["motor_speed_rad_s"]
    )
    assert not np.any(result.status & StatusFlag.sample_repeated.value)


@EITHER_FILTER
def test_one_wrong_sequence_number_does_not_stop_the_sensor(configured):
    codes, arrays = recording(3000)
    sequence = np.arange(3000, dtype=np.uint32)
    sequence[1000] ^= np.uint32(1 << 30)
    status = TorqueSensor(configured()).process(codes, **arrays, sequence=sequence).status
    assert np.count_nonzero(status[1100:] & 0xFFF) == 0


def test_wrong_shapes_and_missing_arrays():
    codes, arrays = recording(20)
    sensor = TorqueSensor(sensor_config())
    with pytest.raises(InputError, match="codes' second axis has 2 elements: expected 3"):
        sensor.process(codes[:, :2], **arrays)
    with pytest.raises(InputError, match="codes has the shape"):
        sensor.process(codes[:, 0], **arrays)
    with pytest.raises(InputError, match="motor_speed_rad_s is missing"):
        sensor.process(codes)
    with pytest.raises(InputError, match="temperature_degC has 19 elements: expected 20"):
        sensor.process(codes, **arrays | {"temperature_degC": np.zeros(19)})
    with pytest.raises(InputError, match="codes holds values that are no whole numbers"):
        sensor.process(codes + 0.5, **arrays)
    with pytest.raises(InputError, match="codes reaches from"):
        sensor.process(codes.astype(np.int64) + 2**31, **arrays)
    assert sensor.counters["samples"] == 0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Converter(bits=0), "bits = 0"),
        (lambda: Converter(bits=33), "bits = 33"),
        (lambda: Converter(minimum_V=5.0, maximum_V=5.0), "maximum_V = 5.0 V"),
        (lambda: Converter(minimum_V=float("nan")), "minimum_V = nan V"),
        (lambda: Converter(lowest_code=-(2**31)), "lowest_code = "),
        (lambda: Gains([]), "gains has 0 elements"),
        (lambda: Gains([1.0, -1.0]), "gains = 0.0"),
        (lambda: Gains([1.0, float("nan")]), "gains[1] = nan"),
        (lambda: Gains([1.0] * 33), "gains has 33 elements"),
        (lambda: TorqueCalibration(gain_Nm_per_V=0), "gain_Nm_per_V = 0.0 Nm/V"),
        (lambda: TorqueCalibration(gain_Nm_per_V=1, full_scale_Nm=-1), "full_scale_Nm = -1.0 Nm"),
        (
            lambda: TorqueCalibration(gain_Nm_per_V=1, linearisation=[0, 2.0]),
            "linearisation[1] = 2.0",
        ),
        (
            lambda: TorqueCalibration(gain_Nm_per_V=1, linearisation=[0] * 5),
            "linearisation has 5 elements",
        ),
    ],
)
def test_wrong_configuration_gives_one_clear_sentence(make, words):
    with pytest.raises(InputError) as caught:
        make()
    message = str(caught.value)
    assert message.startswith(words)
    assert "expected" in message
    assert "\n" not in message
    assert isinstance(caught.value, ConfigurationError) or "elements" in message


# ---- the ripple filter in the chain --------------------------------------------------------------

FROZEN = {
    "orders": [RippleOrder(2, with_load=True), 4],
    "frozen": [FrozenTerm(0.01, cosine_Nm=1, sine_Nm=0)],
}


def timed_recording(n=3000):
    """Jitter, a gap, stamps that are missing, late or twice, and an angle that is not known."""
    codes, arrays = recording(n)
    rng = np.random.default_rng(3)
    time_s = 1e-3 * np.arange(n) + rng.uniform(-2e-4, 2e-4, n)
    time_s[2000:] += 0.02
    time_s[700] = np.nan
    time_s[800] = time_s[798]
    time_s[900] = time_s[899]
    arrays["motor_angle_rad"] = 150.0 * np.where(np.isfinite(time_s), time_s, 0.7)
    arrays["motor_angle_rad"][1000] = np.nan
    return codes, arrays | {"time_s": time_s}


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("angle_referenced", [True, False])
def test_with_times_the_chain_is_the_ripple_filter_on_its_torque(dtype, angle_referenced):
    codes, arrays = timed_recording()
    del arrays["motor_speed_rad_s"]
    sensor = TorqueSensor(ripple_config(**FROZEN), dtype=dtype)
    result = sensor.process(codes, **arrays, angle_referenced=angle_referenced)
    alone = RippleFilter(ripple_config(**FROZEN).filter, dtype=dtype).process(
        arrays["time_s"],
        arrays["motor_angle_rad"],
        result.torque_measured_Nm,
        expected_torque_Nm=arrays["expected_torque_Nm"],
        angle_referenced=angle_referenced,
    )
    np.testing.assert_array_equal(result.torque_Nm, alone.torque_Nm)
    np.testing.assert_array_equal(result.ripple_Nm, alone.ripple_Nm)
    np.testing.assert_array_equal(result.status, alone.status)
    refused = {"time_not_finite": [700], "sample_out_of_order": [800, 900]}
    for name, places in refused.items():
        assert np.flatnonzero(result.status & StatusFlag[name].value).tolist() == places
    for flag in StatusFlag:
        assert sensor.counters[flag.name] == np.count_nonzero(result.status & flag.value), flag
    assert sensor.counters["samples_missing"] == 1
    assert sensor.counters["faults"] == np.count_nonzero(result.status & 0xFFF)
    if angle_referenced:
        assert np.ptp(result.torque_measured_Nm[1500:] - arrays["expected_torque_Nm"][1500:]) > 2.0


def test_without_times_rows_are_the_sample_period_apart():
    codes, arrays = recording()
    by_period = TorqueSensor(ripple_config(sample_period_s=5e-4)).process(codes, **arrays)
    # Exact in binary, so that differences of stamps are the period to the last bit.
    steps = TorqueSensor(ripple_config(sample_period_s=2**-11)).process(codes, **arrays)
    stamps = TorqueSensor(ripple_config()).process(codes, **arrays, time_s=2**-11 * np.arange(4000))
    np.testing.assert_array_equal(steps.torque_Nm, stamps.torque_Nm)
    assert np.any(by_period.torque_Nm != steps.torque_Nm)


def test_a_first_stamp_that_is_missing_does_not_cost_the_second_row():
    codes, arrays = recording(100)
    time_s = 1e-3 * np.arange(100)
    time_s[0] = np.nan
    sensor = TorqueSensor(ripple_config())
    status = sensor.process(codes, **arrays, time_s=time_s).status
    assert np.flatnonzero(status & 0xFFF).tolist() == [0]
    assert sensor.counters["faults"] == 1


def test_the_oscillator_filter_goes_by_samples():
    codes, arrays = recording(2000)
    without = TorqueSensor(sensor_config()).process(codes, **arrays)
    with_times = TorqueSensor(sensor_config()).process(codes, **arrays, time_s=np.zeros(2000))
    np.testing.assert_array_equal(without.torque_Nm, with_times.torque_Nm)
    np.testing.assert_array_equal(without.status, with_times.status)


@pytest.mark.parametrize("orders", [[2], list(range(1, 10))])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_what_was_learned_makes_a_start_clean(orders, dtype):
    codes, arrays = recording()
    sensor = TorqueSensor(ripple_config(orders=orders), dtype=dtype)
    sensor.process(codes, **arrays)
    kept = sensor.learned()
    assert len(kept.coefficients_Nm) == 2 * len(orders)
    assert sensor.copy().learned().coefficients_Nm == kept.coefficients_Nm
    warm = TorqueSensor(ripple_config(orders=orders), kept, dtype=dtype)
    assert warm.learned().coefficients_Nm == kept.coefficients_Nm
    first = warm.process(codes, **arrays)
    assert np.ptp(first.torque_Nm[:100]) < 0.2
    warm.reset()
    again = warm.process(codes, **arrays)
    np.testing.assert_array_equal(again.torque_Nm, first.torque_Nm)


def test_only_the_ripple_filter_keeps_what_it_learned():
    kept = TorqueSensor(ripple_config()).learned()
    with pytest.raises(InputError, match="learned is given, but the filter is the oscillator"):
        TorqueSensor(sensor_config(), kept)
    with pytest.raises(InputError, match="the oscillator filter learns nothing that can be kept"):
        TorqueSensor(sensor_config()).learned()
    with pytest.raises(InputError, match="learned = 3: expected a LearnedRipple"):
        TorqueSensor(ripple_config(), 3)
    with pytest.raises(InputError, match=r"learned\.orders = 2\.0 orders: expected as many"):
        TorqueSensor(ripple_config(orders=[2, 4, 6]), kept)


def test_the_ripple_filter_needs_the_angle():
    codes, arrays = recording(20)
    sensor = TorqueSensor(ripple_config())
    with pytest.raises(InputError, match="motor_angle_rad is missing: expected it for the ripple"):
        sensor.process(codes, motor_speed_rad_s=arrays["motor_speed_rad_s"])
    with pytest.raises(InputError, match="time_s has 19 elements: expected 20"):
        sensor.process(codes, **arrays, time_s=np.zeros(19))


def test_the_sample_period_is_the_filters_or_ones_own():
    assert ripple_config().sample_period_s == 1e-3
    assert ripple_config(sample_period_s=0.25).sample_period_s == 0.25
    slow = OscillatorFilterConfig(orders=[2], sample_period_s=4e-3)
    parts = {"converter": CONVERTER, "gains": Gains([1.0]), "calibration": CALIBRATION}
    assert TorqueSensorConfig(**parts, filter=slow).sample_period_s == 4e-3
    assert TorqueSensorConfig(**parts, filter=slow, sample_period_s=4e-3).sample_period_s == 4e-3
    with pytest.raises(ConfigurationError, match=r"sample_period_s = 0\.001 s: expected that of"):
        TorqueSensorConfig(**parts, filter=slow, sample_period_s=1e-3)
    for wrong in (0.0, -1.0, np.nan, 2e3):
        with pytest.raises(ConfigurationError, match=r"sample_period_s = .* expected a number"):
            ripple_config(sample_period_s=wrong)
    assert "filter=RippleFilterConfig(" in repr(ripple_config())


# ---- the sensor of a joint file ------------------------------------------------------------------

JOINTS = Path(__file__).parents[1] / "data" / "joints"


def ripple_joint():
    """Text of the shoulder with the gauges and the calibration of the elbow."""
    elbow = (JOINTS / "elbow.toml").read_text(encoding="utf-8")
    shoulder = (JOINTS / "shoulder.toml").read_text(encoding="utf-8")
    gauges = elbow[elbow.index("[gauges]") : elbow.index("[ripple_filter]")]
    return shoulder + "\n" + gauges


def test_the_method_of_a_joints_section_is_the_sensors_filter():
    joint = parse_joint(ripple_joint()).joint
    config = sensor_of(joint)
    assert isinstance(config.filter, RippleFilterConfig)
    assert config.sample_period_s == 1 / 4000
    assert config.filter.memory_turns == 30
    kept = learned_of(joint)
    assert TorqueSensor(config, kept).learned().coefficients_Nm == kept.coefficients_Nm
    elbow = sensor_of(parse_joint((JOINTS / "elbow.toml").read_text(encoding="utf-8")).joint)
    assert isinstance(elbow.filter, OscillatorFilterConfig)
    assert elbow.sample_period_s == elbow.filter.sample_period_s


def test_a_missing_sampling_rate_is_named():
    text = ripple_joint()
    assert "sampling_rate_Hz = 4000\n" in text
    without = parse_joint(text.replace("sampling_rate_Hz = 4000\n", "")).joint
    with pytest.raises(InputError, match=r'"shoulder": \[signals\] has no sampling_rate_Hz; exp'):
        sensor_of(without)
