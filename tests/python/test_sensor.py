"""The whole chain over recordings: codes in, clean torque out, nothing wild gets through."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave import (
    ConfigurationError,
    Converter,
    Gains,
    InputError,
    OscillatorFilterConfig,
    RotationSource,
    StatusFlag,
    TorqueCalibration,
    TorqueSensor,
    TorqueSensorConfig,
)

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


def test_measured_torque_is_the_parts_one_after_the_other():
    codes, arrays = recording()
    result = TorqueSensor(sensor_config()).process(codes, **arrays)
    volts = -10 + 20 / 65536 * (codes + 32768.0)
    warmer = arrays["temperature_degC"] - 20
    u = 6.6 * (1 + 1e-3 * warmer) * (volts.mean(axis=1) - 0.1)
    torque = u + 40 * 0.01 * (u / 40) ** 2
    np.testing.assert_allclose(result.torque_measured_Nm, torque, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(result.torque_Nm, result.torque_measured_Nm - result.ripple_Nm)
    late = slice(3000, None)
    assert np.ptp(result.torque_measured_Nm[late]) > 2.0
    assert np.ptp(result.torque_Nm[late]) < 0.2


@pytest.mark.parametrize("source", [RotationSource.speed, RotationSource.angle])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_chunks_equal_one_call_to_the_last_bit(source, dtype):
    codes, arrays = recording(2000)
    codes[[10, 700, 701]] = 32767
    arrays["sequence"] = np.arange(2000, dtype=np.uint32) + np.uint32(2**32 - 500)
    arrays["sequence"][1500:] += np.uint32(7)
    whole = TorqueSensor(sensor_config(source=source), dtype=dtype)
    one = whole.process(codes, **arrays)
    pieces = TorqueSensor(sensor_config(source=source), dtype=dtype)
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


def test_one_gauge_and_thirty_two_gauges():
    for gauges in (1, 2, 4, 5, 32):
        codes, arrays = recording(50, gauges)
        result = TorqueSensor(sensor_config(gauges)).process(codes, **arrays)
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
    config = sensor_config(2, rng.choice([RotationSource.speed, RotationSource.angle]))
    sensor = TorqueSensor(config, dtype=rng.choice([np.float32, np.float64]))
    with np.errstate(over="ignore"):
        result = sensor.process(
            rng.integers(-32768, 32768, (n, 2)),
            motor_speed_rad_s=rng.choice(wild, n),
            motor_angle_rad=rng.choice(wild, n),
            expected_torque_Nm=rng.choice(wild, n),
            temperature_degC=rng.choice(wild, n),
            sequence=np.cumsum(rng.choice([1, 1, 1, 2, 50], n)).astype(np.uint32),
        )
    for array in (result.torque_measured_Nm, result.torque_Nm, result.ripple_Nm):
        assert np.isfinite(array).all()
    codes, arrays = recording(8000, 2)
    arrays["temperature_degC"][:] = 20.0
    after = sensor.process(codes, **arrays)
    fresh = TorqueSensor(config).process(codes, **arrays)
    assert np.abs(after.torque_Nm[6000:] - fresh.torque_Nm[6000:]).max() < 0.01


def test_held_rows_are_found_by_an_encoder_that_stands():
    codes, arrays = recording(3000, 3)
    codes[2001:2004] = codes[2000]
    arrays["motor_angle_rad"][2001:2004] = arrays["motor_angle_rad"][2000]
    result = TorqueSensor(sensor_config()).process(codes, **arrays)
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


def test_one_wrong_sequence_number_does_not_stop_the_sensor():
    codes, arrays = recording(3000)
    sequence = np.arange(3000, dtype=np.uint32)
    sequence[1000] ^= np.uint32(1 << 30)
    status = TorqueSensor(sensor_config()).process(codes, **arrays, sequence=sequence).status
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
