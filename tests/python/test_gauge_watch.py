"""A lost gauge: gains solved beforehand, limits from sound gauges, and the watch built from a joint."""

import copy
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import strainwave as sw
from helpers.joint_sections import PROVENANCE, gauges, gear
from strainwave.calibrate.fluctuation import compensation_conditions, equally_spaced_positions_rad
from strainwave.calibrate.gauge_watch import (
    consistency_limits,
    fluctuation_rms,
    signal_directions,
    stuck_samples,
    white_noise,
)
from strainwave.calibrate.lost_gauge import GainsWithoutGauge as Found
from strainwave.calibrate.lost_gauge import gains_without_each
from strainwave.configuration import gauge_monitor_of
from strainwave.errors import ConfigurationError, InputError
from strainwave.joint import Gains, GainsWithoutGauge, GaugeSignal, Identity, Joint

FloatArray = NDArray[np.float64]


def ideal_conditions(count: int, harmonics: int = 1) -> FloatArray:
    shape = (harmonics, count)
    amplitudes = np.ones(shape) / 20.0 ** np.arange(harmonics)[:, np.newaxis]
    return compensation_conditions(amplitudes, np.zeros(shape), equally_spaced_positions_rad(count))


def found_without(conditions: FloatArray, sensitivities: Any = None) -> tuple[Found, ...]:
    count = conditions.shape[1]
    torque = np.ones(count) if sensitivities is None else np.asarray(sensitivities)
    return gains_without_each([conditions], torque)[0]


def test_five_ideal_gauges_without_one_have_the_gains_of_the_closed_form() -> None:
    # The null space of the first harmonic is spanned by 1 and the second harmonic; of that, what
    # is 0 at gauge k is 1 - cos(2 (phi_j - phi_k)), and it is the only one symmetric about it.
    phases = 2 * equally_spaced_positions_rad(5)
    found = found_without(ideal_conditions(5))
    assert [each.gauge for each in found] == [1, 2, 3, 4, 5]
    for each in found:
        expected = 1 - np.cos(2 * (phases - phases[each.gauge - 1]))
        assert each.gains == pytest.approx(expected, abs=1e-7)
        # M sum(g^2) / (sum g)^2 with sum 5 and sum of squares 5 (1 + 1/2).
        assert each.noise_factor == pytest.approx(5 * 7.5 / 25, rel=1e-7)
        assert fluctuation_rms(ideal_conditions(5), each.gains) < 1e-8


@pytest.mark.parametrize(("count", "harmonics"), [(3, 1), (5, 2), (6, 3), (2, 1)])
def test_too_few_gauges_have_no_gains_without_one(count: int, harmonics: int) -> None:
    assert found_without(ideal_conditions(count, harmonics)) == ()


def test_a_harmonic_that_need_not_be_cancelled_is_part_of_the_residual() -> None:
    conditions = ideal_conditions(5, 2)
    found = found_without(conditions[:2])
    assert len(found) == 5
    for each in found:
        # Godler's eq. (8) turned into a signal over a whole turn, and its rms.
        angle = np.linspace(0, np.pi, 1000, endpoint=False)
        sines = [np.sin(2 * angle), np.cos(2 * angle), np.sin(4 * angle), np.cos(4 * angle)]
        signal = np.stack(sines).T @ (conditions @ each.gains)
        left = fluctuation_rms(conditions, each.gains)
        assert left == pytest.approx(np.sqrt(np.mean(signal**2)), rel=1e-9)
        # The second harmonic of gains 1 - cos(2 (phi_j - phi_k)) is 5/2 of a 20th.
        assert left == pytest.approx(2.5 / 20 / math.sqrt(2), rel=1e-6)


@given(
    st.integers(4, 9),
    st.lists(st.floats(0.7, 1.3), min_size=18, max_size=18),
    st.lists(st.floats(-0.2, 0.2), min_size=9, max_size=9),
)
def test_gains_without_a_gauge_cancel_the_wave_and_keep_the_torque(
    count: int, scales: list[float], errors: list[float]
) -> None:
    amplitudes = np.array([scales[:count]])
    sensitivities = np.array(scales[9 : 9 + count])
    conditions = compensation_conditions(
        amplitudes, np.array([errors[:count]]), equally_spaced_positions_rad(count)
    )
    for each in found_without(conditions, sensitivities):
        assert each.gains[each.gauge - 1] == 0
        assert sensitivities @ each.gains == pytest.approx(np.sum(sensitivities), rel=1e-9)
        assert np.abs(conditions @ each.gains).max() < 1e-7 * np.abs(each.gains).max()


def test_a_gauge_that_cannot_be_missed_has_no_entry() -> None:
    # Of four gauges three see the same wave: without the fourth only gains of sum 0 cancel it.
    conditions = compensation_conditions(np.ones((1, 4)), np.zeros((1, 4)), [0, 0, 0, math.pi / 2])
    assert 4 not in [each.gauge for each in found_without(conditions)]


@pytest.mark.parametrize("values", [[1.0] * 4, [1.0, 1.0, 1.0, 1.0, math.nan], [0.0] * 5])
def test_sensitivities_that_cannot_be_are_refused(values: list[float]) -> None:
    with pytest.raises(InputError, match="torque_sensitivities"):
        consistency_limits(
            np.zeros((10, 5)),
            np.zeros(10),
            zeros=np.zeros(5),
            conditions=ideal_conditions(5),
            torque_sensitivities=values,
        )


def test_conditions_of_other_gauges_are_refused() -> None:
    with pytest.raises(InputError, match=r"conditions has the shape \(2, 5\): expected a column"):
        gains_without_each([ideal_conditions(5)], np.ones(4))


def test_a_torque_signal_that_is_told_is_kept() -> None:
    sets, said = gains_without_each([ideal_conditions(5)], np.ones(5), torque_signal=4.2)
    assert said == ()
    assert [float(np.sum(each.gains)) for each in sets] == pytest.approx([4.2] * 5)


def test_noise_is_found_beside_a_slow_signal_and_under_the_rounding() -> None:
    generator = np.random.default_rng(4)
    slow = np.sin(0.02 * np.arange(20_000))
    for sigma, step in ((1e-3, 3e-4), (1e-3, 1e-3), (1e-3, 2.5e-3)):
        noisy = slow + sigma * generator.standard_normal(len(slow))
        rounded = step * np.round(noisy / step)
        found = white_noise(rounded[:, np.newaxis], step=step)
        assert found == pytest.approx([sigma], rel=0.05)
    # A tenth of a step: in motion rounding looks like noise, at rest the code stands.
    hidden = np.round(50 * slow + 0.1 * generator.standard_normal(len(slow)))
    assert np.isnan(white_noise(hidden[:, np.newaxis], step=1.0)).all()
    assert np.isnan(white_noise(np.zeros((3, 2)))).all()
    with pytest.raises(InputError, match="signals"):
        white_noise(np.full((10, 2), np.nan))


def test_stuck_samples_bound_what_noise_does() -> None:
    generator = np.random.default_rng(3)
    for sigma in (0.4, 1.0, 3.3):
        codes = np.round(generator.normal(0.0, sigma, 2_000_000)).astype(int)  # mid-code: the worst
        repeated = float(np.mean(codes[1:][codes[:-1] == 0] == 0))
        assert repeated == pytest.approx(math.erf(1 / (2 * math.sqrt(2) * sigma)), abs=3e-3)
        needed = stuck_samples(sigma, 1.0, most_per_hour=3.6, rate_Hz=1000, gauges=1)
        runs = np.diff(np.flatnonzero(np.diff(np.concatenate(([1], codes, [1]))) != 0))
        assert np.count_nonzero(runs > needed) <= 12  # 3.6 an hour are 2 in this time


@pytest.mark.parametrize("name", ["noise", "step", "most_per_hour", "rate_Hz"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_stuck_samples_of_nonsense_are_refused(name: str, value: float) -> None:
    values: dict[str, Any] = {"noise": 1.0, "step": 1.0, "most_per_hour": 1.0, "rate_Hz": 1000.0}
    with pytest.raises(InputError, match=name):
        stuck_samples(**{**values, name: value}, gauges=5)


def sound_signals(
    torque_V: FloatArray, angle_rad: FloatArray, growth: float, noise_V: float
) -> FloatArray:
    """Five gauges whose wave grows with the torque by a share of itself per volt."""
    wave = np.stack([np.sin(2 * angle_rad), np.cos(2 * angle_rad)]).T @ ideal_conditions(5)
    noise = noise_V * np.random.default_rng(8).standard_normal((len(torque_V), 5))
    return np.asarray(
        torque_V[:, np.newaxis] + (1 + growth * torque_V[:, np.newaxis]) * wave + noise
    )


def test_limits_hold_what_sound_gauges_do_with_their_margin() -> None:
    angle = np.linspace(0, 300, 30_000)
    torque_V = 2 * np.sin(0.37 * angle)
    signals = sound_signals(torque_V, angle, 0.1, 0.001)
    limits = consistency_limits(
        signals, angle, zeros=np.zeros(5), conditions=ideal_conditions(5), margin=1.5
    )
    # The grown wave has the length 0.1 sqrt(5/2) per volt of one gauge, the torque sqrt(5).
    assert limits.share == pytest.approx(1.5 * 0.1 / math.sqrt(2), rel=0.05)
    # At 5 % of the largest torque 0.1 V x 0.158, and noise in four directions.
    assert 0.02 < limits.limit < 0.035


def test_without_loads_there_is_one_limit_and_no_growth() -> None:
    angle = np.linspace(0, 300, 30_000)
    signals = sound_signals(np.zeros(len(angle)), angle, 0.1, 0.001)
    limits = consistency_limits(
        signals, angle, zeros=np.zeros(5), conditions=ideal_conditions(5), is_loaded=False
    )
    assert limits.share is None
    # Noise in four directions: chi of 4 degrees, the largest of 30000 below 6.5 sigma.
    assert 1.5 * 0.004 < limits.limit < 1.5 * 0.0065


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"margin": 0.9}, "margin = 0.9: expected at least 1"),
        ({"zeros": np.zeros(4)}, r"zeros \(4,\)"),
        ({"signals": np.full((10, 5), np.nan)}, "signals"),
        ({"signals": np.zeros((0, 5)), "wave_angle_rad": np.zeros(0)}, "no rows"),
        ({"wave_angle_rad": np.zeros(9)}, r"wave_angle_rad \(9,\)"),
    ],
)
def test_limits_of_nonsense_are_refused(changes: dict[str, Any], message: str) -> None:
    values = {
        "signals": np.zeros((10, 5)),
        "wave_angle_rad": np.zeros(10),
        "zeros": np.zeros(5),
        "conditions": ideal_conditions(5),
        **changes,
    }
    with pytest.raises(InputError, match=message):
        consistency_limits(values.pop("signals"), values.pop("wave_angle_rad"), **values)


def five_gauge_joint(**changes: Any) -> Joint:
    conditions = ideal_conditions(5)
    values: dict[str, Any] = {
        "gains": (1.0,) * 5,
        "residual_fluctuation_V": 0.01,
        "without_gauge": tuple(
            GainsWithoutGauge(
                gauge=each.gauge,
                gains=tuple(each.gains.tolist()),
                residual_fluctuation_V=0.1 * each.gauge,
            )
            for each in found_without(conditions)
        ),
        "gauge_signals": tuple(
            GaugeSignal(
                zero_V=0.1 * j,
                amplitudes_V=(1.0,),
                phases_rad=(2 * math.pi * j / 5,),
            )
            for j in range(5)
        ),
        "noise_V": 1e-3,
        "consistency_limit_V": 0.05,
        "consistency_limit_share": 0.02,
        "provenance": PROVENANCE,
        **changes,
    }
    converter = {"converter_bits": 16, "converter_minimum_V": -10.0, "converter_maximum_V": 10.0}
    return Joint(
        joint=Identity(name="five gauges"),
        gear=gear(),
        gauges=gauges(5, torn_gauge_rail="upper", **converter),
        gains=Gains.model_validate(values),
    )


def sensor_of_five(**changes: Any) -> sw.TorqueSensorConfig:
    joint = five_gauge_joint(**changes)
    return sw.TorqueSensorConfig(
        converter=sw.Converter(bits=16, minimum_V=-10.0, maximum_V=10.0),
        gains=sw.Gains([1.0] * 5),
        calibration=sw.TorqueCalibration(gain_Nm_per_V=2.0, zero_V=1.0, full_scale_Nm=40.0),
        filter=sw.RippleFilterConfig(orders=[2, 4]),
        monitor=gauge_monitor_of(joint, 1e-3),
    )


def recording(torque_V: float, samples: int = 600) -> tuple[FloatArray, FloatArray]:
    """Voltages and motor angles of five sound gauges of `five_gauge_joint`."""
    angle = 0.02 * np.arange(samples)
    wave = 1.01 * angle[:, np.newaxis]  # circular spline fixed, ratio 100
    phase = 2 * np.pi * np.arange(5) / 5
    noise = 1e-3 * np.random.default_rng(2).standard_normal((samples, 5))
    volts = torque_V + np.sin(2 * wave + phase) + 0.1 * np.arange(5) + noise
    return np.asarray(volts), angle


def codes_of(volts: FloatArray) -> NDArray[np.int32]:
    converter = sw.Converter(bits=16, minimum_V=-10.0, maximum_V=10.0)
    columns = [converter.to_code(np.ascontiguousarray(column)) for column in volts.T]
    return np.stack(columns, axis=1).astype(np.int32)


def test_watch_is_what_the_joint_says() -> None:
    monitor = gauge_monitor_of(five_gauge_joint(detection_time_s=0.02), 1e-3)
    assert monitor is not None
    assert monitor.rail_samples == 20
    assert monitor.consistency_samples == 20
    assert monitor.torn_gauge_rail is sw.TornGaugeRail.upper
    assert monitor.residual_fluctuation_V == 0.01
    assert [each.gauge for each in monitor.without] == [1, 2, 3, 4, 5]
    # Zeros of 0, 0.1, ... 0.4 V under gains 1 - cos(2 (phi_j - phi_k)) less those under 1.
    zero_V = 0.1 * np.arange(5)
    for each in monitor.without:
        assert each.zero_shift_V == pytest.approx(zero_V @ (np.array(each.gains) - 1), abs=1e-12)
        assert each.residual_fluctuation_V == pytest.approx(0.1 * each.gauge)
    # Ends of the range less half as much again as the wave.
    assert monitor.overload_V == pytest.approx(10 - 1.5)


@pytest.mark.parametrize(
    ("changes", "consistency", "stuck"),
    [
        ({}, True, True),
        ({"consistency_limit_V": None}, False, True),
        ({"consistency_limit_share": None}, False, True),  # under load sound gauges part
        ({"gauge_signals": None}, False, True),
        ({"noise_V": None}, True, False),
        ({"noise_V": 1e-5}, True, False),  # a thirtieth of a step: codes stand by themselves
    ],
)
def test_checks_are_those_that_enough_is_known_for(
    changes: dict[str, Any], consistency: bool, stuck: bool
) -> None:
    monitor = gauge_monitor_of(five_gauge_joint(**changes), 1e-3)
    assert monitor is not None
    assert (monitor.consistency_samples > 0) is consistency
    assert (monitor.stuck_samples > 0) is stuck


def test_without_anything_about_lost_gauges_there_is_no_watch() -> None:
    joint = five_gauge_joint(without_gauge=(), gauge_signals=None)
    assert gauge_monitor_of(joint, 1e-3) is None
    assert sensor_of_five(without_gauge=(), gauge_signals=None).monitor is None


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("lost", [1, 3, 5])
def test_torque_goes_on_without_a_torn_gauge(lost: int, dtype: Any) -> None:
    volts, angle = recording(3.0)
    volts[300:, lost - 1] = 10.5
    sensor = sw.TorqueSensor(sensor_of_five(), dtype=dtype)
    result = sensor.process(codes_of(volts), motor_angle_rad=angle)
    # 5 x 3 V, 2 Nm/V; steps of the converter and noise.
    assert result.torque_measured_Nm == pytest.approx(30.0, abs=0.02)
    assert result.left_out_gauge.tolist() == [0] * 300 + [lost] * 300
    flag = sw.StatusFlag.gauge_lost.value
    assert np.flatnonzero(result.status & flag)[0] == 309
    assert not np.any(result.status & sw.StatusFlag.gauges_insufficient.value)
    assert (sensor.lost_gauge, sensor.gauge_fault) == (lost, sw.GaugeFault.open)
    assert sensor.residual_fluctuation_Nm == pytest.approx(0.2 * lost, rel=1e-6)
    assert sensor.counters["gauge_lost"] == 291


def test_a_loss_is_kept_by_copies_and_forgotten_when_cleared() -> None:
    volts, angle = recording(3.0)
    broken = volts.copy()
    broken[300:, 1] = 10.5
    sensor = sw.TorqueSensor(sensor_of_five())
    sensor.process(codes_of(broken), motor_angle_rad=angle)
    twin = copy.copy(sensor)
    twin.clear_lost_gauge()
    assert (sensor.lost_gauge, twin.lost_gauge) == (2, 0)
    assert twin.gauge_fault == sw.GaugeFault.none
    result = twin.process(codes_of(volts), motor_angle_rad=angle)
    assert not np.any(result.left_out_gauge)
    sensor.reset()
    assert sensor.lost_gauge == 0


def test_five_gauges_that_cancel_two_harmonics_have_none_to_spare() -> None:
    # M - 1 = 4 < 2 N + 1 = 5: no gains are stored, and the loss makes the torque invalid.
    assert found_without(ideal_conditions(5, 2)) == ()
    volts, angle = recording(3.0)
    volts[300:] += 0.5
    volts[300:, 2] = 10.5
    sensor = sw.TorqueSensor(sensor_of_five(without_gauge=()))
    result = sensor.process(codes_of(volts), motor_angle_rad=angle)
    insufficient = result.status & sw.StatusFlag.gauges_insufficient.value != 0
    assert np.flatnonzero(insufficient).tolist() == list(range(300, 600))
    assert np.all(result.torque_measured_Nm[300:] == result.torque_measured_Nm[299])
    assert sensor.lost_gauge == 3


def test_unknown_zero_of_the_angle_leaves_the_comparison_out() -> None:
    volts, angle = recording(3.0)
    result = sw.TorqueSensor(sensor_of_five()).process(
        codes_of(volts), motor_angle_rad=angle + 0.5, angle_referenced=False
    )
    assert not np.any(result.left_out_gauge)
    disagree = sw.StatusFlag.gauges_disagree.value
    assert not np.any(result.status & disagree)
    wrong = sw.TorqueSensor(sensor_of_five()).process(codes_of(volts), motor_angle_rad=angle + 0.5)
    assert np.any(wrong.status & disagree)
    assert not np.any(wrong.status & sw.StatusFlag.gauge_lost.value)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"rail_samples": 60001}, "rail_samples"),
        ({"stuck_samples": 1}, "stuck_samples"),
        ({"overload_V": 0.0}, "overload_V"),
        ({"torn_gauge_rail": "left"}, "torn_gauge_rail"),
        ({"flat_travel_turns": math.nan}, "flat_travel_turns"),
        ({"without": [3]}, "without"),
        ({"without": [sw.GainsWithoutGauge(1, [0.0, 1.0])] * 2}, "two entries for gauge 1"),
    ],
)
def test_watch_that_cannot_be_is_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        sw.GaugeMonitorConfig(**values)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"samples": 60001}, "consistency_samples"),
        ({"limit_V": 0.0}, "consistency_limit_V"),
        ({"signal_directions": np.ones((1, 5))}, "unit length"),
        ({"signal_directions": signal_directions([1.0, 1.0])}, "elements: expected 2"),
        ({"gauge_zero_V": [0.0]}, "gauge_zero_V has 1 elements"),
        ({"fluctuation_V": np.ones((3, 5))}, "two a harmonic"),
        ({"fluctuation_V": np.ones((10, 5))}, "at most 4"),
        ({"wave_factor": 0.0}, "wave_factor"),
    ],
)
def test_comparison_that_cannot_be_is_refused(values: dict[str, Any], message: str) -> None:
    valid: dict[str, Any] = {
        "samples": 10,
        "signal_directions": signal_directions(np.ones(5)),
        "gauge_zero_V": np.zeros(5),
        "limit_V": 0.1,
    }
    sw.ConsistencyCheck(**valid)
    with pytest.raises(InputError, match=message):
        sw.ConsistencyCheck(**{**valid, **values})


def test_gains_for_a_gauge_that_is_not_there_are_refused() -> None:
    with pytest.raises(InputError, match="gauge = 3: expected 1 to 2"):
        sw.GainsWithoutGauge(3, [1.0, 0.0])
    with pytest.raises(ConfigurationError, match="0 for the gauge that is lost"):
        sw.GainsWithoutGauge(1, [1.0, 0.0])
    monitor = sw.GaugeMonitorConfig(without=[sw.GainsWithoutGauge(1, [0.0, 1.0, 1.0])])
    with pytest.raises(ConfigurationError, match="gains_without"):
        sw.TorqueSensorConfig(
            converter=sw.Converter(bits=16, minimum_V=-10.0, maximum_V=10.0),
            gains=sw.Gains([1.0, 1.0]),
            calibration=sw.TorqueCalibration(gain_Nm_per_V=1.0),
            filter=sw.RippleFilterConfig(orders=[2]),
            monitor=monitor,
        )


def test_rms_of_equal_gains_is_that_of_the_sum() -> None:
    # Three gauges of the paper: their sum has 0.1059 of one gauge's amplitude.
    conditions = compensation_conditions(
        [[1.0, 1.07, 1.15]],
        np.radians([[0.0, -1.5, -0.4]]),
        equally_spaced_positions_rad(3),
    )
    assert fluctuation_rms(conditions, np.ones(3)) == pytest.approx(0.1059 / math.sqrt(2), rel=1e-3)
