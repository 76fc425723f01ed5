"""One run of all gauges: phasors and their honest uncertainty beside slow torque; m and a delay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from helpers.gauge_logs import station_of
from strainwave.calibrate.fluctuation import equally_spaced_positions_rad, fit_fluctuation
from strainwave.calibrate.fluctuation_run import fit_run
from strainwave.calibrate.wave_timing import delayed_angle, fit_timing
from strainwave.errors import InputError
from strainwave.simulate.trajectories import Sine

POSITIONS = equally_spaced_positions_rad(3)
TRUE = np.array([[1.0, 1.07, 1.15], [0.05, 0.04, 0.06]]) * np.exp(
    1j * (2 * np.array([[1], [2]]) * POSITIONS + [[0, -0.026, -0.007], [0.4, -1.2, 2.0]])
)


def signals_of(angle, phasors=TRUE, factor=1.0):
    order = 2 * factor * np.arange(1, len(phasors) + 1)
    return np.imag(np.exp(1j * np.outer(angle, order)) @ phasors)


def coloured(rng, shape, memory):
    """Noise of unit variance whose neighbours are alike."""
    white = np.sqrt(1 - memory**2) * rng.normal(size=(200 + shape[0], shape[1]))
    return lfilter([1.0], [1.0, -memory], white, axis=0)[200:]


def fit(signals, angle, **more):
    given = {"positions_rad": POSITIONS, "harmonics": 2} | more
    return fit_run(signals, angle, **given)


def test_agrees_with_the_plain_fit_where_torque_is_constant() -> None:
    rng = np.random.default_rng(2)
    angle = np.linspace(0, 40, 4000)
    signals = signals_of(angle) + rng.normal(0, 0.02, (4000, 3)) + 0.3
    plain = fit_fluctuation(signals, angle, positions_rad=POSITIONS, harmonics=2)
    run = fit(signals, angle)
    assert run.trend_degree == 0
    assert run.amplitudes == pytest.approx(plain.amplitudes, abs=5e-5)
    assert run.phase_errors_rad == pytest.approx(plain.phase_errors_rad, abs=2e-3)
    assert run.offsets == pytest.approx([0.3] * 3, abs=2e-3)
    # White noise: sigma sqrt(2/n), and the blocks' scatter is at most a little more.
    ratio = run.amplitude_standard_errors / (0.02 * np.sqrt(2 / 4000))
    assert ratio.min() > 0.95
    assert ratio.max() < 1.7


def test_slow_torque_gets_the_degree_it_needs() -> None:
    rng = np.random.default_rng(3)
    angle = np.linspace(0, 80, 6000)
    slow = np.cos(np.linspace(0, 5, 6000))[:, np.newaxis] * [1.0, 1.1, 0.9]
    signals = signals_of(angle) + slow + rng.normal(0, 0.01, (6000, 3))
    run = fit(signals, angle)
    assert 4 <= run.trend_degree <= 12
    assert np.abs(run.phasors - TRUE).max() < 5 * run.amplitude_standard_errors.max()
    # A straight drift is not enough here: its error is many times larger.
    line = fit_fluctuation(signals, angle, positions_rad=POSITIONS, harmonics=2)
    assert np.abs(line.amplitudes - abs(TRUE)).max() > 5 * np.abs(run.phasors - TRUE).max()


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_standard_errors_cover_the_truth_for_residuals_that_are_alike(memory: float) -> None:
    rng = np.random.default_rng(5)
    angle = np.linspace(0, 50, 3000)
    clean = signals_of(angle)
    scatter = []
    for _ in range(60):
        # Torque noise is common to the gauges.
        noise = coloured(rng, (3000, 1), memory) + 0.5 * coloured(rng, (3000, 3), memory)
        run = fit(clean + 0.02 * noise, angle)
        gains = np.array([1.2, 0.9, 0.9])
        away = run.weighted_sum(gains) - TRUE @ gains
        scatter.append(np.abs(away) / (np.sqrt(2) * run.sum_standard_uncertainty(gains)))
        assert np.all(run.is_present)
    assert 0.75 < np.sqrt(np.mean(np.square(scatter))) < 1.15


def test_white_errors_would_not_have() -> None:
    # The same noise, judged as if neighbours were independent, is claimed three times too small.
    rng = np.random.default_rng(6)
    angle = np.linspace(0, 50, 3000)
    noise = 0.02 * coloured(rng, (3000, 3), 0.9)
    honest = fit(signals_of(angle) + noise, angle).amplitude_standard_errors[0]
    plain = fit_fluctuation(
        signals_of(angle) + noise, angle, positions_rad=POSITIONS, harmonics=2
    ).amplitude_standard_errors[0]
    assert np.all(honest > 2 * plain)


def test_stretches_apart_have_trends_of_their_own() -> None:
    rng = np.random.default_rng(8)
    angle = np.concatenate([np.linspace(0, 15, 1500), np.linspace(3, 21, 1500)])
    stretch = np.repeat([0, 1], 1500)
    signals = signals_of(angle) + 2.0 * stretch[:, np.newaxis] + rng.normal(0, 0.01, (3000, 3))
    run = fit(signals, angle, stretches=stretch)
    assert run.trend_degree == 0
    assert np.abs(run.phasors - TRUE).max() < 5 * run.amplitude_standard_errors.max()


def test_a_harmonic_that_is_not_there_is_not_seen() -> None:
    rng = np.random.default_rng(9)
    angle = np.linspace(0, 50, 3000)
    seen = [
        fit(signals_of(angle) + rng.normal(0, 0.02, (3000, 3)), angle, harmonics=4).is_present
        for _ in range(20)
    ]
    assert np.mean(seen, axis=0)[:2].tolist() == [1.0, 1.0]
    assert np.mean(seen, axis=0)[2:].max() < 0.15


@pytest.mark.parametrize("told", [1.0, 1.02, 1.021])
def test_factor_and_delay_from_the_wave(told: float) -> None:
    base = station_of(4)
    late = replace(base.acquisition, angle_to_torque_delay_s=0.004)
    station = replace(base, acquisition=late)
    run = station.rotate(Sine(2 * np.pi, 0.2, 0.0, 4 * np.pi), 10.0, 1)
    found = fit_timing(
        run.volts,
        run.motor_angle_rad,
        harmonics=2,
        wave_factor=told,
        time_s=run.time_s,
        fit_delay=True,
    )
    assert found.factor == pytest.approx(1.02, abs=2e-6)
    assert found.delay_s == pytest.approx(0.004, abs=2e-5)
    assert 0 < found.factor_standard_uncertainty < 1e-5
    assert 0 < found.delay_standard_uncertainty_s < 1e-4


def test_delayed_angle_is_that_of_the_gauges() -> None:
    time_s = np.arange(100) / 100
    assert delayed_angle(3 * time_s, time_s, 0.02)[50] == pytest.approx(3 * 0.48)


def test_delay_that_cannot_be_told_is_refused() -> None:
    angle = np.linspace(0, 40, 2000)
    given = {"harmonics": 2, "wave_factor": 1.0, "fit_delay": True}
    with pytest.raises(InputError, match="the speed hardly changes"):
        fit_timing(signals_of(angle), angle, time_s=np.arange(2000) / 1000, **given)
    with pytest.raises(InputError, match="there is no time"):
        fit_timing(signals_of(angle), angle, **given)


ANGLE = np.linspace(0, 10, 100)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: fit(np.zeros((100, 2)), ANGLE), "a column a gauge"),
        (lambda: fit(signals_of(ANGLE), ANGLE, harmonics=0), "harmonics = 0"),
        (lambda: fit(signals_of(ANGLE), ANGLE, harmonics=60), "at least 122"),
        (lambda: fit(signals_of(ANGLE), ANGLE, wave_factor=0), "wave_factor = 0"),
        (lambda: fit(signals_of(ANGLE), ANGLE, time_s=ANGLE[1:]), "time_s has 99 elements"),
        (lambda: fit(signals_of(ANGLE), ANGLE, time_s=ANGLE * np.nan), "time_s is not finite"),
        (lambda: fit(signals_of(ANGLE), ANGLE, stretches=[1]), "stretches has 1 elements"),
        (lambda: fit(signals_of(ANGLE), ANGLE / 10), "less than half a turn"),
        (lambda: fit(signals_of(ANGLE), np.repeat([0, 4], 50)), "does not tell 2 harmonic"),
    ],
)
def test_bad_input_gets_one_sentence(call, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        call()
    assert "\n" not in str(caught.value)
