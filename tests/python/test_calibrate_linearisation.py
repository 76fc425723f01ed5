"""The linearisation polynomial: found where it is, and not where it is not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.load_tables import FULL_SCALE_NM, GAIN, Truth, experiments
from strainwave.calibrate.linearisation import linearise
from strainwave.calibrate.loadings import Loadings
from strainwave.calibrate.torque import sensor_gain


def _linearise(loadings: Loadings):
    lines = [
        sensor_gain(loadings.voltage_V[rows], loadings.load_Nm[rows], intercept=True)
        for rows in loadings.rows()
    ]
    return linearise(loadings, lines, FULL_SCALE_NM)


def test_a_cubic_is_found_with_gain_and_zero_of_its_own() -> None:
    truth = Truth(cubic=-0.02, gain_scatter=0.02, zero_scatter_V=0.02)
    found = _linearise(experiments(truth, count=6, seed=1))
    assert found.curve.coefficients == pytest.approx([0.0, -0.02], abs=1e-9)
    rng = np.random.default_rng(1)
    for gain, zero_V in zip(found.curve.gains_Nm_per_V, found.curve.zeros_V, strict=True):
        assert gain == pytest.approx(GAIN * (1 + 0.02 * rng.normal()), rel=1e-9)
        assert zero_V == pytest.approx(0.05 + 0.02 * rng.normal(), abs=1e-9)
        rng.normal(size=len(found.curve.residuals_Nm) // 6)  # the noise, of which there is none
    assert np.max(np.abs(found.curve.residuals_Nm)) < 1e-6


def test_noise_and_hysteresis_are_no_curve() -> None:
    # Chosen by chance at most as often as the tests' level times their number allows.
    chosen = 0
    for seed in range(60):
        truth = Truth(gain_scatter=0.02, hysteresis=0.005, noise_V=0.01)
        chosen += len(_linearise(experiments(truth, count=5, seed=seed)).curve.coefficients) > 0
    assert chosen <= 2


def test_a_curve_beside_noise_is_found_nearly_always() -> None:
    found = 0
    for seed in range(20):
        truth = Truth(gain_scatter=0.02, hysteresis=0.005, noise_V=0.01, cubic=-0.02)
        found += len(_linearise(experiments(truth, count=8, seed=seed)).curve.coefficients) >= 2
    assert found >= 19


def test_two_experiments_are_no_evidence() -> None:
    found = _linearise(experiments(Truth(cubic=-0.05), count=2))
    assert found.curve.coefficients == ()
    assert [each.order for each in found.evidence] == [1]


def test_orders_stop_where_loads_are_too_few() -> None:
    loads = [0.0, 20.0, 40.0, 20.0, 0.0]
    found = _linearise(experiments(Truth(cubic=-0.05, noise_V=0.001), count=4, loads=loads))
    assert [each.order for each in found.evidence] == [1]


@settings(max_examples=20, deadline=None)
@given(factor=st.floats(1e-3, 1e3), sign=st.sampled_from([1.0, -1.0]))
def test_volts_scale_the_gain_and_nothing_else(factor: float, sign: float) -> None:
    loadings = experiments(Truth(cubic=-0.03, noise_V=0.002), count=4, seed=2)
    plain = _linearise(loadings).curve
    scaled = _linearise(loadings.with_voltage(sign * factor * loadings.voltage_V)).curve
    assert scaled.coefficients == pytest.approx(plain.coefficients, abs=1e-9)
    assert scaled.gains_Nm_per_V * sign * factor == pytest.approx(plain.gains_Nm_per_V, rel=1e-8)
    assert scaled.zeros_V / (sign * factor) == pytest.approx(plain.zeros_V, rel=1e-6, abs=1e-9)
