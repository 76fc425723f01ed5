"""Drift of zero and gain over temperature: what readings say, and what they cannot."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave import TorqueCalibration
from strainwave.calibrate.thermal import fit_thermal
from strainwave.errors import InputError
from strainwave.simulate import PiecewiseLinear, taghirad1999
from strainwave.simulate.temperature import constant_temperature

GAIN = 6.6
ZERO_DRIFT = 3e-4
GAIN_DRIFT = -2e-4


def _voltage(
    temperature: np.ndarray, load: np.ndarray | float = 0.0, reference: float = 20.0
) -> np.ndarray:
    warmer = temperature - reference
    return np.asarray(0.1 + ZERO_DRIFT * warmer + load / (GAIN * (1 + GAIN_DRIFT * warmer)))


def _table(seed: int, noise_V: float = 1e-4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    loads = np.tile([0.0, 20.0, 40.0, -20.0], 9)
    temperature = np.repeat(np.linspace(5.0, 35.0, 9), 4)
    noise = noise_V * random.standard_normal(36)
    return temperature, loads, _voltage(temperature, loads) + noise


def test_the_core_reads_back_what_was_fitted() -> None:
    """The core's own calibration, without noise: every load comes out to rounding."""
    temperature, load, _ = _table(1)
    fit = fit_thermal(
        temperature, _voltage(temperature, load), load_Nm=load, reference_temperature_degC=20.0
    )
    assert fit.gain_Nm_per_V is not None
    assert fit.gain_drift_per_K is not None
    assert fit.zero_drift_V_per_K == pytest.approx(ZERO_DRIFT, rel=1e-8)
    assert fit.gain_drift_per_K == pytest.approx(GAIN_DRIFT, rel=1e-8)
    calibration = TorqueCalibration(
        gain_Nm_per_V=fit.gain_Nm_per_V,
        zero_V=fit.zero_V,
        full_scale_Nm=40.0,
        reference_temperature_degC=20.0,
        zero_drift_V_per_K=fit.zero_drift_V_per_K,
        gain_drift_per_K=fit.gain_drift_per_K,
    )
    read = calibration.torque_Nm(_voltage(temperature, load), temperature)
    np.testing.assert_allclose(read, load, atol=1e-7)


def test_uncertainties_hold() -> None:
    """Errors over their uncertainties scatter by 1: 300 tables, both drifts."""
    ratios = []
    for seed in range(300):
        temperature, load, voltage = _table(seed)
        fit = fit_thermal(temperature, voltage, load_Nm=load, reference_temperature_degC=20.0)
        assert fit.gain_drift_per_K is not None
        assert fit.gain_drift_standard_uncertainty_per_K is not None
        ratios.append(
            (
                (fit.zero_drift_V_per_K - ZERO_DRIFT) / fit.zero_drift_standard_uncertainty_V_per_K,
                (fit.gain_drift_per_K - GAIN_DRIFT) / fit.gain_drift_standard_uncertainty_per_K,
            )
        )
    # Student's t of 32 degrees of freedom has the variance 1.067; of 300, 3 standard deviations.
    squares = np.mean(np.square(ratios), axis=0)
    assert np.all((squares > 0.78) & (squares < 1.36))


def test_uncertainties_hold_for_a_log_whose_noise_is_correlated() -> None:
    ratios = []
    for seed in range(60):
        random = np.random.default_rng(seed)
        temperature = 20 + 15 * np.sin(2 * np.pi * np.arange(2000) / 2000)
        noise = np.zeros(2000)
        steps = 3e-5 * random.standard_normal(2000)
        for row in range(1, 2000):
            noise[row] = 0.9 * noise[row - 1] + steps[row]
        fit = fit_thermal(temperature, _voltage(temperature) + noise)
        ratios.append(
            (fit.zero_drift_V_per_K - ZERO_DRIFT) / fit.zero_drift_standard_uncertainty_V_per_K
        )
        # (1 + 0.9) / (1 - 0.9) = 19 neighbours.
        assert 50 < fit.effective_rows < 250
    assert 0.5 < np.mean(np.square(ratios)) < 1.9


def test_the_station_of_1999() -> None:
    """Simulated: 2e-7 of strain and 2e-4 of the gain per kelvin are put in."""
    station = taghirad1999(misalignment="none")
    rows = []
    for place, temperature in enumerate(np.linspace(5.0, 35.0, 7)):
        at = replace(station, temperature=constant_temperature(station.temperature, temperature))
        for load in (0.0, 20.0, -20.0):
            profile = PiecewiseLinear((0.0, 0.1, 0.3), (0.0, load, load))
            run = at.hold(profile, 0.3, 100 * place + 30 + int(load), 0.3)
            rows.append((temperature, load, run.volts[150:].sum(axis=1).mean()))
    temperature, load, voltage = np.array(rows).T
    fit = fit_thermal(temperature, voltage, load_Nm=load, reference_temperature_degC=20.0)
    # Eq. (4): strain x amplifier gain x supply x gauge factor / 2.
    assert fit.zero_drift_V_per_K == pytest.approx(2e-7 * 1000 * 10 * 2 / 2, rel=0.02)
    # More sensitivity is less torque for a volt.
    assert fit.gain_drift_per_K == pytest.approx(-2e-4, rel=0.05)


@pytest.mark.parametrize("lag_s", [120.0, -60.0, 0.0])
def test_the_lag_of_a_log(lag_s: float) -> None:
    random = np.random.default_rng(1)
    time = np.arange(0.0, 7200.0, 2.0)
    temperature = 20 + 15 * np.sin(2 * np.pi * time / 7200)
    felt = 20 + 15 * np.sin(2 * np.pi * (time - lag_s) / 7200)
    voltage = _voltage(felt) + 1e-4 * random.standard_normal(len(time))
    fit = fit_thermal(temperature, voltage, time_s=time)
    assert fit.lag_s == pytest.approx(lag_s, abs=5.0)
    assert fit.lag_is_used == (lag_s != 0.0)
    assert fit.zero_drift_V_per_K == pytest.approx(ZERO_DRIFT, rel=0.01)
    untold = fit_thermal(temperature, voltage)
    assert untold.lag_s is None
    assert untold.hysteresis_V is not None
    # At the middle of the range the rate is 15 x 2 pi / 7200 K/s, and both branches are off by it.
    expected = 2 * abs(lag_s) * 15 * 2 * np.pi / 7200 * ZERO_DRIFT
    assert untold.hysteresis_V == pytest.approx(expected, rel=0.15, abs=4e-5)


def test_warming_against_cooling_in_a_table() -> None:
    temperature = np.array([5, 10, 15, 20, 25, 30, 35, 30, 25, 20, 15, 10, 5.0])
    voltage = _voltage(temperature)
    voltage[:7] += 1e-3
    fit = fit_thermal(temperature, voltage)
    assert fit.hysteresis_V == pytest.approx(1e-3, rel=0.15)
    up = fit_thermal(temperature[:7], voltage[:7])
    assert up.hysteresis_V is None
    assert up.zero_drift_V_per_K == pytest.approx(ZERO_DRIFT, rel=1e-9)


def test_a_bent_drift_is_seen() -> None:
    temperature = np.linspace(0.0, 40.0, 21)
    random = np.random.default_rng(3)
    voltage = _voltage(temperature) + 1e-6 * (temperature - 20) ** 2
    voltage += 1e-5 * random.standard_normal(21)
    fit = fit_thermal(temperature, voltage)
    assert fit.curvature_is_clear
    assert fit.curvature_V == pytest.approx(4e-4, rel=0.1)
    straight = fit_thermal(temperature, _voltage(temperature) + 1e-5 * random.standard_normal(21))
    assert not straight.curvature_is_clear


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-1e-2, 1e-2),
    st.floats(-2e-3, 2e-3),
    st.floats(0.5, 500.0),
    st.floats(-40.0, 60.0),
)
def test_exact_readings_give_exact_drifts(
    zero_drift: float, gain_drift: float, gain: float, reference: float
) -> None:
    load = np.tile([0.0, 10.0, -30.0], 5)
    temperature = np.repeat(np.linspace(reference - 20, reference + 30, 5), 3)
    warmer = temperature - reference
    voltage = -0.3 + zero_drift * warmer + load / (gain * (1 + gain_drift * warmer))
    fit = fit_thermal(temperature, voltage, load_Nm=load, reference_temperature_degC=reference)
    scale = 1.0 + abs(30 / gain)
    assert fit.zero_drift_V_per_K == pytest.approx(zero_drift, abs=1e-9 * scale)
    assert fit.gain_drift_per_K == pytest.approx(gain_drift, abs=1e-8 * gain)
    assert fit.gain_Nm_per_V == pytest.approx(gain, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"temperature_degC": [20.0, 21.0]}, "voltage_V has 36 elements: expected 2"),
        ({"temperature_degC": np.full(36, 20.0)}, "the temperature varies by 0 K"),
        ({"voltage_V": np.full(36, np.nan)}, "voltage_V is not finite at row 0"),
        ({"load_Nm": np.linspace(5.0, 35.0, 9).repeat(4)}, "vary together"),
        ({"time_s": np.zeros(36)}, "time_s does not grow at row 1"),
    ],
)
def test_readings_that_do_not_do(change: dict[str, Any], words: str) -> None:
    temperature, load, voltage = _table(1)
    given_values: dict[str, Any] = {
        "temperature_degC": temperature,
        "voltage_V": voltage,
        "load_Nm": load,
        **change,
    }
    if "vary" in words:
        # One load at each temperature, in step with it.
        given_values["load_Nm"] = np.where(temperature == 5.0, 0.0, 10.0)
        given_values["temperature_degC"] = np.where(temperature == 5.0, 5.0, 35.0)
    with pytest.raises(InputError, match=words):
        fit_thermal(
            given_values.pop("temperature_degC"), given_values.pop("voltage_V"), **given_values
        )


def test_too_few_readings() -> None:
    with pytest.raises(InputError, match="there are 3 readings: expected at least 4"):
        fit_thermal([10, 20, 30], [0.1, 0.2, 0.3])
    with pytest.raises(InputError, match="there are 5 readings: expected at least 6"):
        fit_thermal([10, 20, 30, 30, 10], [0.1, 0.2, 0.3, 1, 1], load_Nm=[0, 0, 0, 9, 9])
