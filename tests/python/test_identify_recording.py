"""Ratio, orders, delay and noise from simulated joints that know nothing of the filter."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.signal import lfilter

from benchmarks.accuracy.joint import NOISE_NM, RATIO, WAVE_FACTOR, Run, make_joint, simulate
from benchmarks.accuracy.motion import SAMPLE_PERIOD_S, constant_plan
from benchmarks.accuracy.ripple import MISMATCH, RIGHT, TEETH
from strainwave.identify.delay import find_delay, speed_changes
from strainwave.identify.moving_rows import MovingRows, moving_rows, travel_windows
from strainwave.identify.noise import innovation_noise, rest_noise
from strainwave.identify.orders import find_orders
from strainwave.identify.output_cycles import find_output_cycles
from strainwave.identify.ratio import (
    output_line,
    ratio_of_angles,
    ratio_of_line,
    ratio_of_motor_line,
)
from strainwave.samples import Samples

DELAY_ROWS = 2
DELAY_S = DELAY_ROWS * SAMPLE_PERIOD_S
GIVEN = {
    "torque_noise_Nm": 0.04,
    "torque_walk_Nm_per_sqrt_s": 1.3,
    "initial_amplitude_Nm": 2.0,
    "rated_torque_Nm": 40.0,
}


def _samples(run: Run) -> Samples:
    torque_Nm = run.measured_torque_Nm[:-DELAY_ROWS]
    time_s = run.motion.time_s[DELAY_ROWS:]
    angle_rad = run.motor_angle_rad[DELAY_ROWS:]
    return Samples(time_s, angle_rad, torque_Nm, np.zeros(len(time_s)))


def _rows(samples: Samples, gain: float = 1.0) -> MovingRows:
    return moving_rows(samples.time_s, samples.motor_angle_rad * gain, samples.torque_Nm)


@pytest.mark.parametrize("told", ["100.3", "99.7", None])
@pytest.mark.parametrize(("scenario", "seed"), [(RIGHT, 1), (MISMATCH, 2), (TEETH, 3)])
def test_a_wrong_ratio_is_refined(scenario: str, seed: int, told: str | None) -> None:
    samples = _samples(simulate(make_joint(scenario, seed)))
    ratio = None if told is None else Fraction(told)
    line = output_line(_rows(samples, 1 / RATIO), ratio)
    assert line is not None
    assert line.cycles_per_turn / 2 == pytest.approx(WAVE_FACTOR * RATIO, rel=1e-5)
    found = ratio_of_line(line, ratio)
    # Without a ratio nobody knows that the circular spline is fixed: m R is taken for R.
    expected = RATIO + 1 if told is None else RATIO
    assert float(found.ratio) == pytest.approx(expected, rel=1e-5)
    assert 1e-6 < found.standard_uncertainty < 1e-2
    assert abs(float(found.ratio) - expected) < 4 * found.standard_uncertainty
    assert found.factor == (1 if told is None else 1 + 1 / found.ratio)


def test_a_right_ratio_stays_to_the_letter() -> None:
    line = output_line(_rows(_samples(simulate(make_joint(RIGHT, 1))), 1 / RATIO), Fraction(100))
    assert line is not None
    assert ratio_of_line(line, Fraction(100)).ratio == 100


def test_no_line_in_noise() -> None:
    samples = _samples(simulate(make_joint(RIGHT, 1)))
    noise = np.random.default_rng(5).standard_normal(len(samples))
    rows = moving_rows(samples.time_s, samples.motor_angle_rad / RATIO, noise)
    assert output_line(rows, None) is None
    assert output_line(rows, Fraction(100)) is None


def test_the_motor_alone_shows_the_ratio_where_the_ripple_turns_with_the_wave() -> None:
    samples = _samples(simulate(make_joint(RIGHT, 1)))
    found = ratio_of_motor_line(_rows(samples))
    assert found is not None
    assert float(found.ratio) == pytest.approx(RATIO, rel=1e-3)
    plain = moving_rows(
        samples.time_s, samples.motor_angle_rad, 2.0 * np.cos(2 * samples.motor_angle_rad)
    )
    assert ratio_of_motor_line(plain) is None


@pytest.mark.parametrize("sign", [1, -1])
def test_two_angles_give_ratio_and_sense(sign: int) -> None:
    samples = _samples(simulate(make_joint(RIGHT, 1)))
    motor = samples.motor_angle_rad
    noise = 1e-5 * np.random.default_rng(6).standard_normal(len(motor))
    found = ratio_of_angles(motor, sign * motor / 80.4 + noise, None)
    assert found is not None
    assert float(found.ratio) == pytest.approx(80.4, rel=1e-5)
    assert 0.0 < found.standard_uncertainty < 1e-2
    assert found.direction == sign
    assert ratio_of_angles(motor, noise, None) is None


@pytest.mark.parametrize(
    "seed", [1, 2, 3, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(4, 22))]
)
def test_the_right_orders_and_no_false_one(seed: int) -> None:
    rows = _rows(_samples(simulate(make_joint(RIGHT, seed))))
    found = find_orders(rows, range(1, 13), WAVE_FACTOR, DELAY_S)
    assert len(found) == 12
    present = {order.order: order for order in found if order.is_present}
    assert list(present) == [2.0, 4.0, 6.0]
    # Order 6 does not grow with load or speed: 0.08 Nm throughout.
    assert present[6.0].amplitude_Nm == pytest.approx(0.08, abs=0.0015)
    assert 2e-4 < present[6.0].amplitude_standard_uncertainty_Nm < 6e-4
    assert all(order.is_steady for order in present.values())


def test_phase_and_odd_orders() -> None:
    joint = make_joint(MISMATCH, 1)
    rows = _rows(_samples(simulate(joint)))
    found = find_orders(rows, range(1, 13), WAVE_FACTOR, DELAY_S)
    present = {order.order: order for order in found if order.is_present}
    assert list(present) == [1.0, 2.0, 4.0, 6.0]
    assert present[1.0].amplitude_Nm == pytest.approx(0.04, abs=0.002)
    # In the simulation a phase is added to the angle, here it is taken from it.
    away = np.angle(np.exp(1j * (present[1.0].phase_rad + joint.ripple.output_phase_rad)))
    assert abs(away) < 0.05


@pytest.mark.parametrize("scenario", [RIGHT, MISMATCH, TEETH])
@pytest.mark.parametrize("seed", [1, *(pytest.param(s, marks=pytest.mark.slow) for s in (2, 3))])
def test_delay_to_a_tenth_of_a_sample(scenario: str, seed: int) -> None:
    samples = _samples(simulate(make_joint(scenario, seed)))
    orders = [order * WAVE_FACTOR for order in (2, 4, 6)]
    found = find_delay(samples, _rows(samples), orders, GIVEN)
    assert found is not None
    assert found.delay_s == pytest.approx(DELAY_S, abs=0.1 * SAMPLE_PERIOD_S)
    assert found.doubt == ""
    assert 1e-6 < found.standard_uncertainty_s < 0.1 * SAMPLE_PERIOD_S
    assert abs(found.delay_s - DELAY_S) < 3 * found.standard_uncertainty_s


def test_a_long_delay_needs_a_second_order() -> None:
    run = simulate(make_joint(RIGHT, 1))
    late = Samples(
        run.motion.time_s[20:],
        run.motor_angle_rad[20:],
        run.measured_torque_Nm[:-20],
        np.zeros(len(run.measured_torque_Nm) - 20),
    )
    found = find_delay(late, _rows(late), [2 * WAVE_FACTOR, 4 * WAVE_FACTOR], GIVEN)
    assert found is not None
    assert found.doubt == ""
    assert found.delay_s == pytest.approx(20e-3, abs=1e-4)
    alone = find_delay(late, _rows(late), [2 * WAVE_FACTOR], GIVEN)
    assert alone is not None
    assert "one order of the ripple alone" in alone.doubt


@pytest.mark.slow
def test_a_phase_that_differs_by_direction_widens_the_delays_uncertainty() -> None:
    run = simulate(make_joint(RIGHT, 2))
    extra_Nm = (
        0.3 * np.sign(run.motion.speed_rad_s) * np.cos(2 * WAVE_FACTOR * run.motor_angle_rad + 1)
    )
    samples = _samples(replace(run, measured_torque_Nm=run.measured_torque_Nm + extra_Nm))
    orders = [order * WAVE_FACTOR for order in (2, 4, 6)]
    found = find_delay(samples, _rows(samples), orders, GIVEN)
    assert found is not None
    assert 0.03e-3 < abs(found.delay_s - DELAY_S) < 2 * found.standard_uncertainty_s


def test_the_noises_uncertainty_is_how_far_it_scatters() -> None:
    random = np.random.default_rng(9)
    time_s = np.arange(1000) * 1e-3
    found = [
        rest_noise(Samples(time_s, np.zeros(1000), random.standard_normal(1000), np.zeros(1000)))
        for _ in range(400)
    ]
    values = np.array([each.noise_Nm for each in found if each is not None])
    stated = np.array([each.standard_uncertainty_Nm for each in found if each is not None])
    assert len(values) == 400
    # The larger of two estimates: a little more than the scatter, on average.
    assert 1.0 < float(np.median(stated)) / float(np.std(values)) < 1.5
    assert innovation_noise(np.empty(0)) is None


def test_cycles_per_output_turn_are_rarely_false() -> None:
    random = np.random.default_rng(10)
    angle_rad = np.linspace(0.0, 6 * 2 * np.pi * RATIO, 6_000)
    time_s = np.arange(6_000) * 1e-2
    false = 0
    for _ in range(100):
        # Torque that forgets within a twentieth of an output turn, and white noise.
        slow = lfilter([1.0], [1.0, -0.98], random.standard_normal(6_000))
        rows = moving_rows(time_s, angle_rad, slow + random.standard_normal(6_000))
        false += len(find_output_cycles(rows, Fraction(100)))
    assert false <= 8


def test_one_speed_tells_no_delay() -> None:
    samples = _samples(simulate(make_joint(RIGHT, 1), constant_plan(10.0)))
    steady = Samples(
        *(
            getattr(samples, name)[4000:]
            for name in ("time_s", "motor_angle_rad", "torque_Nm", "expected_torque_Nm")
        )
    )
    assert not speed_changes(_rows(steady))
    assert find_delay(steady, _rows(steady), [2.02], GIVEN) is None


def test_noise_at_rest() -> None:
    samples = _samples(simulate(make_joint(RIGHT, 1)))
    found = rest_noise(samples)
    assert found is not None
    assert found.noise_Nm == pytest.approx(NOISE_NM, rel=0.06)
    assert 0.005 < found.standard_uncertainty_Nm / NOISE_NM < 0.05
    assert abs(found.noise_Nm - NOISE_NM) < 3 * found.standard_uncertainty_Nm
    steady = Samples(
        samples.time_s[5000:9000],
        samples.motor_angle_rad[5000:9000],
        samples.torque_Nm[5000:9000],
        samples.expected_torque_Nm[5000:9000],
    )
    assert rest_noise(steady) is None


def test_cycles_per_output_turn() -> None:
    angle_rad = np.linspace(0.0, 5 * 2 * np.pi * RATIO, 20_000)
    time_s = np.arange(20_000) * 1e-3
    noise = 0.1 * np.random.default_rng(7).standard_normal(20_000)
    torque_Nm = 3.0 * np.sin(angle_rad / RATIO) + 0.5 * np.cos(4 * angle_rad / RATIO) + noise
    rows = moving_rows(time_s, angle_rad, torque_Nm)
    found = find_output_cycles(rows, Fraction(100))
    assert [each.cycles for each in found] == [1, 4]
    assert found[0].amplitude_Nm == pytest.approx(3.0, abs=0.01)
    assert found[1].amplitude_Nm == pytest.approx(0.5, abs=0.01)
    assert all(1e-4 < each.amplitude_standard_uncertainty_Nm < 3e-3 for each in found)
    assert find_output_cycles(rows, Fraction(1000)) == ()


def test_windows_are_of_one_direction_and_cover_the_travel() -> None:
    angle_rad = np.concatenate([np.linspace(0, 30, 3000), np.linspace(30, -10, 4000)])
    angle_rad += 1e-3 * np.random.default_rng(8).standard_normal(7000)
    windows = travel_windows(angle_rad, 5.0, 10)
    assert len(windows) == 14
    for window in windows:
        assert np.ptp(angle_rad[window]) == pytest.approx(5.0, abs=0.8)
    assert travel_windows(np.empty(0), 5.0, 10) == []


def test_held_rows_rows_at_rest_and_rows_without_numbers_are_left_out() -> None:
    time_s = np.arange(400) * 1e-2
    angle_rad = np.repeat(np.arange(100) * 0.2, 4)
    angle_rad[:80] = 0.0
    torque_Nm = np.cos(angle_rad)
    torque_Nm[200] = np.nan
    rows = moving_rows(time_s, angle_rad, torque_Nm)
    assert 70 < len(rows) < 90
    assert np.all(np.diff(rows.angle_rad) > 0)
    assert not len(moving_rows(time_s[:5], angle_rad[:5], torque_Nm[:5]))
