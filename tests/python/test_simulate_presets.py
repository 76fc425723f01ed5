"""The simulated stations against the published figures that they are made to match."""

import math
import time

import numpy as np
import pytest

from strainwave.calibrate.torque import consistency_measure, sensor_gain
from strainwave.errors import ConfigurationError
from strainwave.simulate import (
    CurrentCommand,
    PiecewiseLinear,
    godler2000,
    load_by_weights,
    taghirad1999,
)
from strainwave.simulate.presets import godler2000 as godler
from strainwave.simulate.presets import taghirad1999 as taghirad
from strainwave.simulate.presets.godler2000 import linearity_experiment, one_turn
from strainwave.simulate.presets.taghirad1999 import calibration_experiments, free_motion

THREE_GAINS = np.array([1.0586, 0.9966, 0.9448])
"""Of the third build: Godler et al. 2000, section III."""


def lines(angle_rad, signal, orders):
    """Amplitude of each order, least squares together with a mean."""
    columns = [f(k * angle_rad) for k in orders for f in (np.cos, np.sin)]
    basis = np.stack([*columns, np.ones(len(angle_rad))], axis=1)
    found = np.linalg.lstsq(basis, signal, rcond=None)[0]
    return np.hypot(found[0:-1:2], found[1:-1:2])


@pytest.fixture(scope="module")
def motion():
    begin = time.perf_counter()
    run = free_motion(1)
    # 4.8 s at 1 kHz; the issue of speed is orders of magnitude, not a share of a second.
    assert time.perf_counter() - begin < 5.0
    return run


def test_taghirads_motor_reaches_its_speed_within_its_torque(motion):
    truth = motion.truth
    flat = (motion.time_s >= 0.8) & (motion.time_s < 1.1)
    assert truth.motor_speed_rad_s[flat].mean() == pytest.approx(156.0, abs=1.5)
    assert np.ptp(truth.motor_speed_rad_s[flat]) < 3.0
    assert truth.motor_speed_rad_s[0] == 0.0
    assert 0.08 < np.abs(truth.motor_torque_Nm).max() <= 0.15
    assert np.abs(motion.current_A * 0.0543 - truth.motor_torque_Nm).max() < 0.005


def test_taghirads_spectrum_peaks_at_twice_and_four_times_the_speed(motion):
    """Section V: two peaks, at 312 and 624 rad/s, in the interval 0.8 to 1.1 s."""
    flat = (motion.time_s >= 0.8) & (motion.time_s < 1.1)
    torque = motion.raw_torque_Nm[flat]
    time_s = motion.time_s[flat]
    torque = torque - np.polyval(np.polyfit(time_s, torque, 2), time_s)
    rate_rad_s = np.linspace(150, 1500, 2701)
    window = np.hanning(len(torque))
    spectrum = np.abs(np.exp(-1j * np.outer(rate_rad_s, time_s)) @ (window * torque)) ** 2
    first = rate_rad_s[np.argmax(spectrum)]
    assert first == pytest.approx(312.0, abs=8.0)
    above = rate_rad_s > 450
    assert rate_rad_s[above][np.argmax(spectrum[above])] == pytest.approx(624.0, abs=12.0)
    near = (np.abs(rate_rad_s - 312) < 60) | (np.abs(rate_rad_s - 624) < 60)
    assert spectrum[near].sum() > 0.9 * spectrum.sum()


def test_taghirads_ripple_has_the_chosen_size(motion):
    late = motion.time_s > 1.5
    truth = motion.truth
    angle = truth.motor_angle_at_torque_rad[late] * 1.01
    slow = [1 / 101]
    measured = lines(angle, motion.raw_torque_Nm[late], [2, 4, 6, *slow])
    assert measured[0] == pytest.approx(1.6, rel=0.1)
    assert measured[1] == pytest.approx(0.6, rel=0.1)
    assert measured[2] < 0.05
    assert measured[3] == pytest.approx(5.0, rel=0.03)
    # Most of it is real: section V.
    real = lines(angle, truth.mesh_ripple_Nm[late], [2, 4])
    sensing = lines(angle, truth.sensing_ripple_Nm[late], [2, 4])
    assert np.all(real > 3 * sensing)
    assert np.all(sensing > 0.02)


def test_taghirads_load_takes_inertia_times_acceleration(motion):
    truth = motion.truth
    early = (motion.time_s > 0.35) & (motion.time_s < 0.65)
    expected = 2.0 * np.polyfit(motion.time_s[early], np.abs(truth.output_speed_rad_s[early]), 1)[0]
    assert truth.torque_without_ripple_Nm[early].mean() == pytest.approx(expected, rel=0.02)
    assert 2.0 < expected < 10.0


@pytest.mark.parametrize(
    ("variant", "lowest_Nm", "highest_Nm"),
    [("as_first_mounted", 9.8, 10.2), ("reassembled", 1.0, 2.0), ("none", 0.0, 0.0)],
)
def test_taghirads_misalignment_peak_to_peak(variant, lowest_Nm, highest_Nm):
    run = free_motion(1, 5.0, misalignment=variant)
    assert abs(run.truth.output_angle_rad[-1]) > 2 * math.pi
    assert lowest_Nm <= np.ptp(run.truth.misalignment_Nm) <= highest_Nm


def gains_Nm_per_V(seed):
    return np.array(
        [
            sensor_gain(experiment.volts[:, 0], experiment.applied_torque_Nm).gain_Nm_per_V
            for experiment in calibration_experiments(seed)
        ]
    )


def test_taghirads_calibration_scatters_by_two_percent():
    """Table I: 6.60 Nm/V, consistency 2 %; 1999 is the seed of the report."""
    gains = [gains_Nm_per_V(seed) for seed in (*range(20), 1999)]
    consistencies = [consistency_measure(each) for each in gains]
    assert np.mean(gains) == pytest.approx(6.60, rel=0.01)
    assert 0.018 < np.mean(consistencies) < 0.022
    assert 0.015 < min(consistencies) < max(consistencies) < 0.025
    assert 0.013 < consistencies[-1] < 0.03


def test_taghirads_scatter_is_put_in_by_the_unevenness_and_not_by_the_arm(monkeypatch):
    monkeypatch.setattr(taghirad, "ARM_ERROR", 0.0)
    gains = gains_Nm_per_V(1999)
    assert 0.018 < consistency_measure(gains) < 0.022
    # It is the position that the gain depends on, and not range or temperature.
    positions = gains.reshape(4, 2)
    assert np.std(positions.mean(axis=1)) > 2 * np.abs(np.diff(positions.mean(axis=0)) / 2)
    monkeypatch.setattr(taghirad, "TORQUE_SHARES", (0.0, 0.0))
    assert 0.004 < consistency_measure(gains_Nm_per_V(1999)) < 0.008


def test_taghirads_experiments_are_not_aliased():
    """Section IV: loading and unloading in both directions, low and full range, positions."""
    experiments = calibration_experiments(1)
    assert len(experiments) == 8
    assert {experiment.direction for experiment in experiments} == {0}
    for experiment in experiments:
        applied = experiment.applied_torque_Nm
        assert applied.max() == -applied.min() == experiment.range_Nm
        for sign in (1, -1):
            steps = experiment.increasing[applied * sign > 0]
            assert 0 < steps.sum() < len(steps)
    of = [(e.position_rad, round(e.range_Nm), e.temperature_degC) for e in experiments]
    places = sorted({position for position, _, _ in of})
    assert sorted((p, r) for p, r, _ in of) == [(p, r) for p in places for r in (10, 40)]
    np.testing.assert_allclose(sorted(t for _, _, t in of), np.linspace(5.0, 35.0, 8))
    for place in places:
        assert np.mean([t for p, _, t in of if p == place]) == pytest.approx(20.0)
    for range_Nm in (10, 40):
        assert np.mean([t for _, r, t in of if r == range_Nm]) == pytest.approx(20.0)
    wave = taghirad1999().wave_factor * np.array(places)
    # Four cycles a turn are met all around and average out; two cycles in four different phases.
    assert abs(np.mean(np.exp(4j * wave))) < 0.1
    assert abs(np.mean(np.exp(2j * wave))) < 0.3


def test_calibration_reads_the_weights_that_hang():
    station = taghirad1999(misalignment="none")
    experiment = load_by_weights(station, [10.0, 20.0, 10.0, 0.0], 3, arm_error=0.1)
    applied = experiment.applied_torque_Nm
    np.testing.assert_allclose(applied, [10, 20, 10, 0])
    np.testing.assert_array_equal(experiment.increasing, [True, True, False, False])
    # The gain differs by up to 3 % from position to position.
    np.testing.assert_allclose(experiment.volts[:, 0] * 6.6, 1.1 * applied, atol=0.3, rtol=0.03)
    assert experiment.run.truth.torque_Nm.max() == pytest.approx(22.0 - 0.1)
    # Friction of bearing and spring: unloading reads more than loading did.
    assert experiment.volts[2, 0] > experiment.volts[0, 0]


@pytest.fixture(scope="module")
def turns():
    return {gauges: one_turn(gauges, 1) for gauges in (2, 3, 4)}


def fluctuation_percent(run):
    """Sum of the channels in %FS of 100 Nm, about its mean, and its lines 2, 4, 6."""
    signal = run.raw_torque_Nm - run.raw_torque_Nm.mean()
    return signal, run.truth.motor_angle_rad


def test_godlers_two_gauges_leave_four_percent_at_the_double_frequency(turns):
    signal, angle = fluctuation_percent(turns[2])
    assert (signal.max() - signal.min()) / 2 == pytest.approx(4.0, abs=0.4)
    basic, double = lines(angle, signal, [2 * 51 / 50, 4 * 51 / 50])
    assert double > 5 * basic
    each = np.abs(turns[2].truth.fluctuation_Nm).max(axis=0)
    np.testing.assert_allclose(each, 40.0, atol=2.5)
    ratios = [
        np.divide(*lines(angle, column, [2.04, 4.08])) for column in turns[2].truth.fluctuation_Nm.T
    ]
    np.testing.assert_allclose(ratios, 20.0, rtol=0.05)


def test_godlers_four_gauges_leave_one_percent_at_the_basic_frequency(turns):
    signal, angle = fluctuation_percent(turns[4])
    assert (signal.max() - signal.min()) / 2 == pytest.approx(1.0, abs=0.2)
    basic, double = lines(angle, signal, [2.04, 4.08])
    assert basic > 3 * double


def test_godlers_three_gauges_leave_two_percent_and_gains_a_tenth_of_it(turns):
    run = turns[3]
    signal, angle = fluctuation_percent(run)
    assert (signal.max() - signal.min()) / 2 == pytest.approx(2.0, abs=0.3)
    amplitudes, phases = [], []
    for j, column in enumerate(run.truth.fluctuation_Nm.T):
        basis = np.stack([f(k * angle) for k in (2, 4) for f in (np.sin, np.cos)], axis=1)
        sine, cosine = np.linalg.lstsq(basis, column, rcond=None)[0][:2]
        amplitudes.append(math.hypot(sine, cosine))
        phases.append(math.degrees(math.atan2(cosine, sine) - 2 * math.pi * j / 3))
    np.testing.assert_allclose(np.array(amplitudes) / amplitudes[0], [1, 1.07, 1.15], atol=1e-4)
    assert amplitudes[0] == pytest.approx(18.9, rel=1e-4)
    wrapped = (np.array(phases) + 180) % 360 - 180
    np.testing.assert_allclose(wrapped, [0, -1.5, -0.4], atol=0.01)
    compensated = run.truth.fluctuation_Nm @ THREE_GAINS
    assert lines(angle, compensated, [2, 4])[0] < 0.005
    assert np.ptp(compensated) / 2 == pytest.approx(0.2, abs=0.05)


def linearity_percent(gauges, gains=None):
    """Half the range of the error about the best line over the closed loop, %FS."""
    experiment = linearity_experiment(gauges, 1)
    volts = experiment.volts[10:] @ (np.ones(gauges) if gains is None else gains)
    applied = experiment.applied_torque_Nm[10:]
    line = sensor_gain(volts, applied, intercept=True)
    error = line.gain_Nm_per_V * (volts - line.zero_V) - applied
    assert applied.max() == 100.0
    assert applied.min() == -100.0
    return np.ptp(error) / 2


def test_godlers_linearity_errors():
    two, four = linearity_percent(2), linearity_percent(4)
    three = linearity_percent(3, THREE_GAINS)
    assert two == pytest.approx(2.0, abs=0.3)
    assert four == pytest.approx(0.5, abs=0.1)
    assert four + 0.3 < three < two - 0.3


def test_godlers_builds_differ_by_what_their_gauges_cancel(monkeypatch):
    """One flexspline: the wave under load makes the difference, hysteresis is in all alike."""
    fields = [godler2000(gauges).strain_field for gauges in (2, 3, 4)]
    assert len({field.bypassed_hysteresis for field in fields}) == 1
    for name in ("phase_rad", "load_growth", "load_phase_rad", "torque_share"):
        assert len({tuple(getattr(h, name) for h in field.harmonics) for field in fields}) == 1
    assert len({godler2000(gauges).flexspline for gauges in (2, 3, 4)}) == 1
    for name in ("LOAD_GROWTHS", "LOAD_PHASES_RAD", "TORQUE_SHARES"):
        monkeypatch.setattr(godler, name, (0.0, 0.0, 0.0))
    left = [linearity_percent(2), linearity_percent(3, THREE_GAINS), linearity_percent(4)]
    np.testing.assert_allclose(left, left[0], atol=0.02)
    assert 0.3 < left[0] < 0.6


def test_godlers_gears_are_the_papers():
    for gauges, ratio, direction, factor in ((2, 50, -1, 1.02), (4, 50, -1, 1.02), (3, 51, 1, 1.0)):
        station = godler2000(gauges)
        assert float(station.gear.ratio) == ratio
        assert station.gear.output_direction == direction
        assert station.wave_factor == pytest.approx(factor)
        assert station.gear.rated_torque_Nm == 100.0
        assert station.channel_count == gauges


CONSTANT = PiecewiseLinear((0.0,), (1.0,))


@pytest.mark.parametrize(
    ("build", "parameter"),
    [
        (lambda: godler2000(5), "gauges"),
        (lambda: godler2000(3.0), "gauges"),
        (lambda: godler2000(None), "gauges"),
        (lambda: one_turn("3", 1), "gauges"),
        (lambda: taghirad1999(misalignment=[]), "misalignment"),
        (lambda: taghirad1999().rotate(5.0, 1.0, 1), "motor_speed"),
        (lambda: taghirad1999().rotate(None, 1.0, 1), "motor_speed"),
        (lambda: taghirad1999().rotate(PiecewiseLinear, 1.0, 1), "motor_speed"),
        (lambda: taghirad1999().rotate(CONSTANT, 1.0, 1, 5.0), "contact_torque"),
        (lambda: taghirad1999().hold(5.0, 1.0, 1), "applied_torque"),
        (lambda: taghirad1999().drive(CONSTANT, 1.0, 1), "command"),
        (lambda: taghirad1999().drive(CurrentCommand(CONSTANT), 1.0, 1, None), "contact_torque"),
        (lambda: taghirad1999().with_changes(gaer=1), "with_changes"),
        (lambda: load_by_weights(godler2000(2), 5.0, 1), "torques_Nm"),
        (lambda: taghirad1999(misalignment="bent"), "misalignment"),
        (lambda: calibration_experiments(-1), "seed"),
        (lambda: load_by_weights(godler2000(2), [], 1), "torques_Nm"),
        (lambda: load_by_weights(godler2000(2), [math.nan], 1), "torques_Nm"),
        (lambda: load_by_weights(godler2000(2), [1.0], 1, arm_error=1.0), "arm_error"),
        (lambda: load_by_weights(godler2000(2), [1.0], 1, temperature_degC=900.0), "values_degC"),
    ],
)
def test_impossible_experiment_is_refused_by_name(build, parameter):
    with pytest.raises(ConfigurationError) as caught:
        build()
    assert caught.value.parameter == parameter
