"""Profiles against calculus: slope and integral belong to the value."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strainwave.errors import ConfigurationError
from strainwave.simulate import (
    NOTHING,
    Chirp,
    CurrentCommand,
    PiecewiseLinear,
    Sine,
    SpeedCommand,
    Sum,
    constant_speed,
    loading_sequence,
    reversals,
    step,
    up_and_down,
)

TIME = np.linspace(0, 4, 400_001)
PROFILES = {
    "ramps": PiecewiseLinear((0.5, 1.0, 2.0, 2.25), (1.0, 3.0, -2.0, 0.5)),
    "constant": PiecewiseLinear((0.0,), (2.0,)),
    "sine": Sine(2.0, 1.3, 0.4, 0.7),
    "chirp": Chirp(1.5, 0.0, 20.0, 0.5, 3.5),
    "sum": Sum((Sine(1.0, 2.0), step(3.0, 1.0, 2.0))),
    "nothing": NOTHING,
    "reversals": reversals(100.0, 0.5, 0.2, 3),
}


@pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES.keys())
def test_integral_is_the_area_under_the_value(profile):
    value = profile.value(TIME)
    area = np.concatenate(([0], np.cumsum((value[1:] + value[:-1]) / 2 * np.diff(TIME))))
    scale = max(np.abs(value).max(), 1.0)
    np.testing.assert_allclose(profile.integral(TIME), area, atol=2e-3 * scale)


@pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES.keys())
def test_slope_is_the_derivative_of_the_value(profile):
    slope = profile.slope(TIME)[1:-1]
    numeric = (profile.value(TIME)[2:] - profile.value(TIME)[:-2]) / (TIME[2:] - TIME[:-2])
    away_from_corners = np.abs(slope - numeric) <= 1e-3 * np.abs(slope) + 0.02
    assert away_from_corners.mean() > 0.9995


def test_named_runs_are_what_they_are_called():
    time = np.array([0.0, 0.25, 0.5, 3.0])
    np.testing.assert_allclose(constant_speed(156.0, 0.5).value(time), [0, 78, 156, 156])
    np.testing.assert_allclose(constant_speed(0.2, 0.0).value(time), 0.2)
    turning = reversals(100.0, 0.5, 0.2, 2).value(np.array([0.45, 1.15, 1.85]))
    np.testing.assert_allclose(turning, [100, -100, 100])
    pushed = step(10.0, 1.0, 2.0).value(np.array([0.99, 1.001, 1.5, 2.1]))
    np.testing.assert_allclose(pushed, [0, 10, 10, 0])
    weights = up_and_down(40.0, 2, both_directions=True)
    assert weights == [0, 20, 40, 20, 0, -20, -40, -20, 0]
    hung = loading_sequence(weights, 0.4, 0.1).value(np.arange(9) * 0.5 + 0.2)
    np.testing.assert_allclose(hung, weights)


def test_chirp_sweeps_its_frequencies():
    chirp = Chirp(1.0, 5.0, 15.0, 0.0, 4.0)
    signs = np.signbit(chirp.value(TIME))
    crossings = TIME[1:][signs[1:] != signs[:-1]]
    assert len(crossings) / 2 == pytest.approx(40, abs=1)
    assert 1 / (2 * np.diff(crossings)[2]) == pytest.approx(5.6, abs=0.5)


@given(st.lists(st.tuples(st.floats(0.01, 2.0), st.floats(-1e3, 1e3)), min_size=1, max_size=8))
def test_profile_stays_between_its_points(pairs):
    times = tuple(np.cumsum([gap for gap, _ in pairs]).tolist())
    values = tuple(value for _, value in pairs)
    profile = PiecewiseLinear(times, values)
    shown = profile.value(TIME[::100])
    assert shown.min() >= min(values) - 1e-9
    assert shown.max() <= max(values) + 1e-9
    assert np.all(np.isfinite(profile.integral(TIME[::100])))


@pytest.mark.parametrize(
    ("build", "parameter"),
    [
        (lambda: PiecewiseLinear((), ()), "values"),
        (lambda: PiecewiseLinear((0.0, 1.0), (1.0,)), "values"),
        (lambda: PiecewiseLinear((1.0, 1.0), (1.0, 2.0)), "times_s"),
        (lambda: PiecewiseLinear((-1.0,), (1.0,)), "times_s"),
        (lambda: PiecewiseLinear((0.0,), (math.nan,)), "values"),
        (lambda: Sine(1.0, 0.0), "frequency_Hz"),
        (lambda: Chirp(1.0, 0.0, 1.0, 2.0, 1.0), "end_s"),
        (lambda: step(1.0, 1.0, 1.0), "end_s"),
        (lambda: reversals(1.0, 1.0, 1.0, 0), "count"),
        (lambda: constant_speed(math.inf), "speed_rad_s"),
        (lambda: up_and_down(1.0, 0), "steps"),
        (lambda: loading_sequence([1.0, math.nan]), "torques_Nm"),
        (lambda: loading_sequence([]), "values"),
        (lambda: CurrentCommand(1.0), "current"),
        (lambda: SpeedCommand(None), "motor_speed"),
    ],
)
def test_impossible_profile_is_refused_by_name(build, parameter):
    with pytest.raises(ConfigurationError) as caught:
        build()
    assert caught.value.parameter == parameter
