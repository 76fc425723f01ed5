"""Positions, temperature, side loads and outliers: what else changes gain and zero."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.load_tables import GAIN, Truth, experiments
from strainwave.calibrate.crosstalk import crosstalk, has_torque, without_crosstalk
from strainwave.calibrate.locked_positions import (
    alias_shares,
    count_positions,
    planned_positions_rad,
    position_dependence,
)
from strainwave.calibrate.temperature_drift import temperature_drift
from strainwave.calibrate.uncertainty import Component, combine, freedom_text, grubbs_outlier
from strainwave.errors import InputError


@given(harmonics=st.integers(1, 6), more=st.integers(0, 5), start=st.floats(-10, 10))
def test_planned_positions_alias_nothing(harmonics: int, more: int, start: float) -> None:
    positions = planned_positions_rad(harmonics, 2 * harmonics + 1 + more)
    assert alias_shares(positions + start, harmonics) == pytest.approx(0.0, abs=1e-12)
    assert count_positions(positions + start) == 2 * harmonics + 1 + more


def test_alias_shares_are_what_the_mean_keeps() -> None:
    # Four positions 67.5 degrees apart: abs(1 + 2j sin 45 deg - j) / 4 of harmonic 1.
    positions = np.radians([0.0, 67.5, 135.0, 202.5])
    expected = abs(1 + 1j * (2 * np.sin(np.pi / 4) - 1)) / 4
    assert alias_shares(positions, 2) == pytest.approx([expected, 0.0], abs=1e-12)
    assert alias_shares([0.3], 3) == pytest.approx([1.0, 1.0, 1.0])
    rng = np.random.default_rng(4)
    angles = rng.uniform(0, 2 * np.pi, 6)
    phases = np.linspace(0, 2 * np.pi, 721)
    kept = [np.mean(np.cos(4 * angles + phase)) for phase in phases]
    assert max(kept) == pytest.approx(alias_shares(angles, 2)[1], rel=1e-4)


def test_half_a_turn_further_is_the_same_position() -> None:
    assert count_positions(np.radians([0.0, 180.0, 359.9, 90.0])) == 2
    assert count_positions([]) == 0
    assert count_positions([1.0]) == 1


def test_harmonics_over_the_positions_are_found() -> None:
    angles = np.radians(np.arange(7) * 180 / 7)
    gains = GAIN * (1 + 0.02 * np.cos(2 * angles + 0.5) + 0.01 * np.cos(4 * angles))
    zeros = 0.1 + 0.03 * np.sin(4 * angles)
    first, second = position_dependence(angles, gains, zeros, 2)
    assert (first.gain_amplitude, second.gain_amplitude) == pytest.approx((0.02, 0.01), rel=1e-9)
    assert first.zero_amplitude_V == pytest.approx(0.0, abs=1e-12)
    assert second.zero_amplitude_V == pytest.approx(0.03, rel=1e-9)
    assert position_dependence(angles[:4], gains[:4], zeros[:4], 2) == ()


def test_too_few_planned_positions_are_refused() -> None:
    with pytest.raises(InputError, match="positions = 4: expected at least 5, which is 2 N"):
        planned_positions_rad(2, 4)


def test_drift_holds_at_the_mean_temperature() -> None:
    temperatures = np.array([5.0, 20.0, 35.0, 12.0])
    gains = GAIN * (1 + 4e-4 * (temperatures - 20))
    drift = temperature_drift(temperatures, gains, 0.1 + 0.002 * (temperatures - 20))
    assert drift is not None
    assert drift.reference_degC == pytest.approx(18.0)
    at_reference = GAIN * (1 - 8e-4)
    assert drift.gain_per_K == pytest.approx(4e-4 * GAIN / at_reference, rel=1e-9)
    assert drift.zero_V_per_K == pytest.approx(0.002, rel=1e-9)
    assert drift.gain_is_told
    assert drift.zero_is_told
    assert temperature_drift([20, 21, 21.5], [1, 1, 1], [0, 0, 0]) is None
    assert temperature_drift([5, 35], [1, 1], [0, 0]) is None


def test_drift_is_told_from_noise_at_its_level() -> None:
    rng = np.random.default_rng(8)
    told = 0
    runs = 1000
    for _ in range(runs):
        drift = temperature_drift(np.linspace(5, 35, 8), rng.normal(6.6, 0.1, 8), np.arange(8.0))
        assert drift is not None
        told += drift.gain_is_told
    assert 0.032 < told / runs < 0.071


def _with_side_load(radial: np.ndarray, volts_per_N: float):
    found = experiments(Truth(gain_scatter=0.02, noise_V=0.0005), count=3, seed=5)
    side = np.tile(radial, 3)
    read = found.voltage_V + volts_per_N * side
    return replace(found, voltage_V=read, side_loads={"radial-force": side})


def test_crosstalk_is_found_and_taken_out() -> None:
    rng = np.random.default_rng(2)
    loadings = _with_side_load(rng.uniform(0, 500, 21), 2e-4)
    (found,) = crosstalk(loadings)
    assert found.sensitivity_V == pytest.approx(2e-4, abs=4 * found.standard_error_V)
    assert 1e-7 < found.standard_error_V < 2e-6
    assert found.largest == pytest.approx(500, rel=0.1)
    plain = experiments(Truth(gain_scatter=0.02, noise_V=0.0005), count=3, seed=5)
    assert without_crosstalk(loadings, (found,)).voltage_V == pytest.approx(
        plain.voltage_V, abs=500 * 4 * found.standard_error_V
    )


def test_crosstalk_uncertainty_covers() -> None:
    covered = 0
    for seed in range(300):
        rng = np.random.default_rng(seed)
        base = experiments(Truth(noise_V=0.002), count=2, seed=seed)
        side = rng.uniform(-300, 300, len(base))
        loadings = replace(
            base, voltage_V=base.voltage_V + 1e-4 * side, side_loads={"axial-force": side}
        )
        (found,) = crosstalk(loadings)
        covered += abs(found.sensitivity_V - 1e-4) <= 2.026 * found.standard_error_V
    assert 0.92 < covered / 300 < 0.98


def test_an_experiment_without_torque_tells_of_side_loads_alone() -> None:
    base = experiments(count=2, loads=[0.0, 20, 40, 20, 0])
    load, side = base.load_Nm.copy(), np.zeros(10)
    load[5:] = 0.0
    side[5:] = [0, 100, 200, 100, 0]
    loadings = replace(
        base,
        load_Nm=load,
        voltage_V=0.05 + load / GAIN + 3e-4 * side,
        side_loads={"axial-force": side},
    )
    assert has_torque(loadings).tolist() == [True, False]
    assert crosstalk(loadings)[0].sensitivity_V == pytest.approx(3e-4, rel=1e-9)


@pytest.mark.parametrize("kind", ["with load", "constant"])
def test_side_loads_that_cannot_be_told_are_refused(kind: str) -> None:
    base = experiments(count=2)
    side = 2.5 * base.load_Nm if kind == "with load" else np.full(len(base), 30.0)
    with pytest.raises(InputError, match="radial-force changes with the torque"):
        crosstalk(replace(base, side_loads={"radial-force": side}))


def test_side_loads_that_go_together_are_refused() -> None:
    base = experiments(count=2)
    side = np.random.default_rng(1).uniform(0, 1, len(base))
    with pytest.raises(InputError, match="axial-force and radial-force change together only"):
        crosstalk(replace(base, side_loads={"axial-force": side, "radial-force": 2 * side}))


def test_welch_and_satterthwaite() -> None:
    # GUM H.1.6: the end gauge: u = 32 nm with 16 degrees of freedom; t for 99 % is 2.92 there.
    parts = [
        Component("calibration of the standard", 25.0, 18, "B"),
        Component("measured difference", 9.7, 25.6, "A"),
        Component("expansion coefficients", 2.9, 50, "B"),
        Component("temperatures", 16.6, 2, "B"),
    ]
    budget = combine(parts)
    assert budget.combined == pytest.approx(32, abs=0.5)
    assert budget.degrees_of_freedom == pytest.approx(16.7, abs=0.1)
    known = combine([Component("known", 3.0, np.inf, "B"), Component("also", 4.0, np.inf, "B")])
    assert known.combined == 5.0
    assert known.coverage_factor == pytest.approx(1.959964, rel=1e-6)
    alone = combine([Component("scatter", 1.0, 7, "A")])
    assert alone.degrees_of_freedom == pytest.approx(7)
    assert alone.coverage_factor == pytest.approx(2.3646, rel=1e-4)
    assert combine([]).expanded == 0.0


def test_grubbs_finds_an_outlier_and_at_its_level_none() -> None:
    assert grubbs_outlier([6.6, 6.61, 6.59, 6.6, 6.62, 7.5]) == 5
    assert grubbs_outlier([1.0, 1.0, 1.0]) is None
    assert grubbs_outlier([1.0, 5.0]) is None
    rng = np.random.default_rng(12)
    false = sum(grubbs_outlier(rng.normal(6.6, 0.1, 8)) is not None for _ in range(2000))
    assert 0.038 < false / 2000 < 0.063


@given(st.floats(0.01, 100), st.integers(0, 5))
def test_grubbs_has_no_unit_and_no_order(factor: float, turn: int) -> None:
    values = np.roll([6.6, 6.61, 6.59, 6.6, 6.62, 7.5], turn)
    assert grubbs_outlier(factor * values) == int(np.argmax(values))
    assert grubbs_outlier(factor * np.minimum(values, 6.62)) is None


def test_one_degree_of_freedom_is_one() -> None:
    assert freedom_text("1") == "1 degree of freedom"
    assert [freedom_text(each) for each in ("0", "1.5", "11")] == [
        "0 degrees of freedom",
        "1.5 degrees of freedom",
        "11 degrees of freedom",
    ]
