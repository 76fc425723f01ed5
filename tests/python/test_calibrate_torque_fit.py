"""The whole fit: intervals that cover, and what must not change the result."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.load_tables import FULL_SCALE_NM, GAIN, Truth, experiments, series, volts
from strainwave.calibrate.loadings import Loadings
from strainwave.commissioning.torque_fit import FitOptions, calibrated_torque_Nm, fit_torque

OPTIONS = FitOptions(rated_torque_Nm=FULL_SCALE_NM, may_linearise=True)
COARSE = (0.0, 20.0, 40.0, 20.0, 0.0, -20.0, -40.0, -20.0, 0.0)


def test_prediction_interval_and_uncertainties_cover_what_they_promise() -> None:
    truth = Truth(gain_scatter=0.02, zero_scatter_V=0.03, hysteresis=0.01, noise_V=0.005)
    runs = 400
    gains, means, torques = 0, 0, 0
    for seed in range(runs):
        rng = np.random.default_rng(10_000 + seed)
        fit = fit_torque(experiments(truth, count=6, seed=seed, loads=COARSE), OPTIONS)
        new_gain = GAIN * (1 + 0.02 * rng.normal())
        interval = fit.prediction_interval()
        assert interval is not None
        gains += interval[0] <= new_gain <= interval[1]
        means += abs(fit.gain_Nm_per_V - GAIN) <= fit.gain_budget.expanded
        # One reading at full scale, or half of it from either side, at the new position.
        new_zero_V = 0.05 + 0.03 * rng.normal()
        load = np.array([rng.choice([1.0, -1.0]) * FULL_SCALE_NM])
        read = volts(load, np.array([1]), truth, new_gain, new_zero_V) + 0.005 * rng.normal()
        error = (
            calibrated_torque_Nm(
                read, fit.gain_Nm_per_V, fit.zero_V, fit.coefficients, FULL_SCALE_NM
            )[0]
            - load[0]
        )
        torques += abs(fit.percent(error)) <= fit.torque_budget.expanded
    # Two-sided, 3.5 standard deviations of 400 draws of 95 %.
    assert 0.912 < gains / runs < 0.988
    assert 0.912 < means / runs < 0.988
    assert 0.912 < torques / runs < 0.995


def test_gain_standard_uncertainty_is_the_scatter_of_repeated_calibrations() -> None:
    truth = Truth(gain_scatter=0.02)
    fits = [fit_torque(experiments(truth, 5, seed, loads=COARSE), OPTIONS) for seed in range(300)]
    scatter = np.std([fit.gain_Nm_per_V for fit in fits], ddof=1)
    told = np.sqrt(np.mean([fit.gain_budget.combined**2 for fit in fits]))
    assert told == pytest.approx(scatter, rel=0.12)


def _numbers(loadings: Loadings) -> dict[str, float]:
    fit = fit_torque(loadings, OPTIONS)
    assert fit.scatter is not None
    return {
        "gain": fit.gain_Nm_per_V,
        "zero": fit.zero_V,
        "consistency": fit.scatter.consistency,
        "uncertainty": fit.gain_budget.combined / abs(fit.gain_Nm_per_V),
        "linearity": float(fit.errors.linearity_Nm.max()),
        "hysteresis": float(fit.errors.hysteresis_Nm.max()),
        "interpolation": fit.interpolation_error_Nm,
        "total": fit.total_error_Nm,
        "torque": fit.torque_budget.expanded,
        "order": float(len(fit.coefficients)),
    }


BASE = experiments(
    Truth(gain_scatter=0.02, zero_scatter_V=0.02, hysteresis=0.01, noise_V=0.003, cubic=-0.01),
    count=4,
    seed=3,
    loads=series(4),
)


@settings(max_examples=15, deadline=None)
@given(factor=st.floats(1e-3, 1e3))
def test_volts_times_k_are_a_gain_over_k(factor: float) -> None:
    plain = _numbers(BASE)
    scaled = _numbers(BASE.with_voltage(factor * BASE.voltage_V))
    plain["gain"] /= factor
    plain["zero"] *= factor
    assert scaled == pytest.approx(plain, rel=1e-6)


def test_the_sign_of_loads_is_the_sign_of_the_gain() -> None:
    plain = _numbers(BASE)
    mirrored = _numbers(replace(BASE, load_Nm=-BASE.load_Nm, path=(-BASE.path).astype(np.int8)))
    plain["gain"] *= -1
    assert mirrored == pytest.approx(plain, rel=1e-6)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_order_of_rows_is_irrelevant_where_sides_are_told(seed: int) -> None:
    turned = np.random.default_rng(seed).permutation(len(BASE))
    shuffled = replace(
        BASE,
        experiment=BASE.experiment[turned],
        load_Nm=BASE.load_Nm[turned],
        voltage_V=BASE.voltage_V[turned],
        path=BASE.path[turned],
    )
    assert _numbers(shuffled) == pytest.approx(_numbers(BASE), rel=1e-6)


def test_load_uncertainty_and_resolution_enter_the_budgets() -> None:
    plain = fit_torque(BASE, OPTIONS)
    more = fit_torque(BASE, replace(OPTIONS, load_uncertainty=0.01, resolution_V=0.1))
    assert more.gain_budget.combined == pytest.approx(
        np.hypot(plain.gain_budget.combined, 0.01 * plain.gain_Nm_per_V), rel=1e-9
    )
    names = {part.name: part.standard_uncertainty for part in more.torque_budget.components}
    assert names["loads"] == pytest.approx(1.0)
    step = 100 * 0.1 * more.gain_Nm_per_V / FULL_SCALE_NM / np.sqrt(12)
    assert names["resolution"] == pytest.approx(step, rel=1e-9)
    assert more.gain_budget.degrees_of_freedom > plain.gain_budget.degrees_of_freedom


def test_a_reading_that_stands_out_is_named_and_kept() -> None:
    read = BASE.voltage_V.copy()
    read[20] += 0.3
    fit = fit_torque(BASE.with_voltage(read), OPTIONS)
    assert fit.outlying_rows.tolist() == [20]
    assert len(fit.loadings) == len(BASE)
    assert fit_torque(BASE, OPTIONS).outlying_rows.tolist() == []
