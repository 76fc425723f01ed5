"""Static calibration against certified data, the paper's table and the theory of small samples."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strainwave.calibrate.torque import (
    consistency,
    consistency_measure,
    least_squares,
    observation_matrix,
    pseudo_inverse,
    sensor_gain,
)
from strainwave.errors import InputError

# NIST Statistical Reference Datasets, linear regression "NoInt1": y = 60 + x, through the origin.
NOINT1_X = np.arange(60.0, 71.0)
NOINT1_Y = np.arange(130.0, 141.0)


def test_certified_regression_through_the_origin() -> None:
    fit = least_squares(observation_matrix(NOINT1_X), NOINT1_Y)
    assert fit.parameters[0] == pytest.approx(2.07438016528926, rel=1e-13)
    assert fit.standard_errors[0] == pytest.approx(0.0165289256198347, rel=1e-11)
    assert np.sqrt(fit.residuals @ fit.residuals / 10) == pytest.approx(3.56753034006338, rel=1e-12)


def test_pseudo_inverse_is_the_normal_equations_inverse() -> None:
    matrix = np.random.default_rng(5).normal(size=(20, 3))
    textbook = np.linalg.inv(matrix.T @ matrix) @ matrix.T
    assert pseudo_inverse(matrix) == pytest.approx(textbook, rel=1e-10, abs=1e-13)


def test_four_conditions_of_moore_and_penrose() -> None:
    matrix = np.random.default_rng(6).normal(size=(9, 4))
    inverse = pseudo_inverse(matrix)
    assert matrix @ inverse @ matrix == pytest.approx(matrix, abs=1e-12)
    assert inverse @ matrix @ inverse == pytest.approx(inverse, abs=1e-12)
    assert matrix @ inverse == pytest.approx((matrix @ inverse).T, abs=1e-12)
    assert inverse @ matrix == pytest.approx((inverse @ matrix).T, abs=1e-12)


def test_one_direction_loading_turns_a_zero_error_into_a_gain_error() -> None:
    # Closed form: through the origin, gain = sum(u v) / sum(v^2) with v = (u + offset)/gain.
    torque = np.linspace(0.0, 40.0, 9)
    offset_Nm = 0.4
    volts = (torque + offset_Nm) / 6.6
    through_origin = sensor_gain(volts, torque)
    shifted = torque + offset_Nm
    expected = 6.6 * np.sum(torque * shifted) / np.sum(shifted**2)
    assert through_origin.gain_Nm_per_V == pytest.approx(expected, rel=1e-12)
    assert through_origin.gain_Nm_per_V / 6.6 - 1 == pytest.approx(-0.0140, abs=0.0005)
    with_zero = sensor_gain(volts, torque, intercept=True)
    assert with_zero.gain_Nm_per_V == pytest.approx(6.6, rel=1e-12)
    assert with_zero.zero_V == pytest.approx(offset_Nm / 6.6, rel=1e-9)


def test_table_1_supports_what_small_samples_support() -> None:
    # Eight gains with exactly 2 % of scatter: intervals from tables of t and chi squared with 7
    # degrees of freedom (2.3646, 1.6899, 16.0128).
    gains = 6.60 * (1 + 0.02 * np.sqrt(7 / 8) * np.array([1, -1, 1, -1, 1, -1, 1, -1]))
    result = consistency(gains.tolist())
    assert result.gain_Nm_per_V == pytest.approx(6.60, rel=1e-12)
    assert result.consistency == pytest.approx(0.02, rel=1e-12)
    assert result.standard_uncertainty == pytest.approx(0.02 / np.sqrt(8), rel=1e-12)
    assert result.prediction_95 == pytest.approx(2.3646 * 0.02 * np.sqrt(9 / 8), rel=1e-4)
    assert result.consistency_low == pytest.approx(0.02 * np.sqrt(7 / 16.0128), rel=1e-4)
    assert result.consistency_high == pytest.approx(0.02 * np.sqrt(7 / 1.6899), rel=1e-4)


def test_intervals_cover_what_they_promise() -> None:
    rng = np.random.default_rng(11)
    covered = 0
    runs = 2000
    for _ in range(runs):
        *past, new = rng.normal(6.6, 0.13, size=9)
        result = consistency(past)
        reach = result.prediction_95 * result.gain_Nm_per_V
        covered += abs(new - result.gain_Nm_per_V) <= reach
    assert 0.935 < covered / runs < 0.965


@given(
    gain=st.floats(0.1, 100.0),
    scale=st.floats(0.1, 10.0),
    loads=st.lists(st.floats(0.5, 100.0), min_size=2, max_size=12, unique=True),
)
def test_gain_scales_with_torque(gain: float, scale: float, loads: list[float]) -> None:
    volts = np.array(loads)
    assert sensor_gain(volts, gain * volts).gain_Nm_per_V == pytest.approx(gain, rel=1e-9)
    assert sensor_gain(volts, scale * gain * volts).gain_Nm_per_V == pytest.approx(
        scale * gain, rel=1e-9
    )


@given(st.lists(st.floats(1.0, 10.0), min_size=2, max_size=10), st.floats(0.01, 100.0))
def test_consistency_has_no_unit(gains: list[float], factor: float) -> None:
    assert consistency_measure(np.array(gains) * factor) == pytest.approx(
        consistency_measure(gains), rel=1e-9, abs=1e-12
    )


def test_consistency_of_negative_and_of_huge_gains() -> None:
    plain = consistency([6.5, 6.7])
    mirrored = consistency(np.array([-6.5, -6.7]))
    assert mirrored.gain_Nm_per_V == -plain.gain_Nm_per_V
    assert mirrored.consistency == pytest.approx(plain.consistency, rel=1e-12)
    assert consistency([1e308, 1e308]).gain_Nm_per_V == pytest.approx(1e308)


def test_weak_but_real_gains_are_fitted() -> None:
    fit = sensor_gain([0.0, 1e-6, 2e-6], [5.0, 5.001, 5.002], intercept=True)
    assert fit.gain_Nm_per_V == pytest.approx(1e3, rel=1e-6)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: sensor_gain([], []), "volts has no value other than 0 in 0 measurements"),
        (lambda: sensor_gain([0.0, 0.0], [1.0, 2.0]), "volts has no value other than 0"),
        (lambda: sensor_gain([1, 1], [1, 2], intercept=True), "volts has the same value in all 2"),
        (lambda: sensor_gain([0, 1], [0, 0], intercept=True), "torque_Nm has the same value"),
        (lambda: sensor_gain([0, 1], [0, 0]), "torque_Nm has no value other than 0"),
        (lambda: sensor_gain([0, 1, 2], [1, 2, 1], intercept=True), "does not follow volts"),
        (lambda: sensor_gain([1, -1], [1, 1]), "does not follow volts"),
        (lambda: sensor_gain([1.0, 2.0], [1.0]), "torque_Nm has 1 elements: expected 2"),
        (lambda: sensor_gain([1.0, np.nan], [1.0, 2.0]), "volts is not finite in row 1"),
        (lambda: sensor_gain([1.0, 2.0], [np.inf, 2.0]), "torque_Nm is not finite in row 0"),
        (lambda: least_squares([[1.0], [2.0]], [1.0]), "measurements has 1 elements: expected 2"),
        (lambda: least_squares([[np.inf]], [1.0]), "matrix is not finite in row 0"),
        (lambda: least_squares([[1e300], [1e300]], [1e-300, 1e300]), "range of double precision"),
        (lambda: pseudo_inverse([[np.nan]]), "matrix is not finite in row 0"),
        (lambda: pseudo_inverse(np.zeros((0, 0))), "0 rows and 0 columns"),
        (lambda: pseudo_inverse([[1, 1], [2, 2]]), "not independent.*fit fewer parameters"),
        (lambda: consistency([np.nan, 1]), "gains_Nm_per_V is not finite in row 0"),
        (lambda: consistency([1, -1]), "expected gains of one sign"),
        (lambda: consistency([1, 0]), "expected gains of one sign"),
        (lambda: sensor_gain(["a", "b"], [1.0, 2.0]), "volts holds"),
        (lambda: consistency([6.6]), "expected at least 2"),
    ],
)
def test_bad_input_gets_one_sentence(call, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        call()
    assert "\n" not in str(caught.value)
