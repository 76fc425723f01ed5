"""Gains from runs: invariants, uncertainties against Monte Carlo, grids, lost gauges, reasons."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.gauge_logs import station_of, turns_of
from strainwave.calibrate.degenerate import reasons
from strainwave.calibrate.fluctuation import equally_spaced_positions_rad
from strainwave.calibrate.fluctuation_run import FluctuationRun, fit_run
from strainwave.calibrate.gain_solution import solve_gains
from strainwave.calibrate.gains import compensating_gains
from strainwave.calibrate.lost_gauge import gains_without_each
from strainwave.errors import InputError


def phasors_of(rng, gauges, harmonics, phase=0.1):
    order = np.arange(1, harmonics + 1)[:, np.newaxis]
    lead = 2 * order * equally_spaced_positions_rad(gauges)
    size = rng.uniform(0.8, 1.2, (harmonics, gauges)) / 20.0 ** (order - 1)
    return size * np.exp(1j * (lead + rng.normal(0, phase, (harmonics, gauges))))


def run_of(phasors, sigma=1e-3):
    count, gauges = phasors.shape
    size = 2 * count * gauges
    return FluctuationRun(
        phasors=phasors,
        covariance=(sigma**2 * np.eye(size)).reshape(count, 2, gauges, count, 2, gauges),
        positions_rad=equally_spaced_positions_rad(gauges),
        offsets=np.zeros(gauges),
        residual_rms=np.full(gauges, sigma),
        trend_degree=0,
        wave_turns=3.0,
        rows=1000,
    )


def solved(run, harmonics=(1,), **more):
    return solve_gains([run], harmonics, most_noise=np.inf, **more)


cases = st.tuples(st.integers(3, 8), st.integers(0, 2**31))


@given(cases, st.floats(1e-3, 1e3), st.floats(-3.0, 3.0))
def test_gains_know_neither_scale_nor_zero_of_the_angle(case, scale, turn) -> None:
    gauges, seed = case
    phasors = phasors_of(np.random.default_rng(seed), gauges, 1)
    gains = solved(run_of(phasors)).gains
    other = solved(run_of(phasors * scale * np.exp(1j * turn))).gains
    assert other == pytest.approx(gains, rel=1e-6, abs=1e-9)


@given(cases)
def test_gains_follow_the_gauges_order_and_leave_no_more_than_equal_ones(case) -> None:
    gauges, seed = case
    rng = np.random.default_rng(seed)
    phasors = phasors_of(rng, gauges, 2)
    order = rng.permutation(gauges)
    harmonics = (1, 2) if gauges >= 5 else (1,)
    found = solved(run_of(phasors), harmonics)
    moved = solved(run_of(phasors[:, order]), harmonics)
    assert moved.gains == pytest.approx(found.gains[order], rel=1e-6, abs=1e-9)
    chosen = np.array(harmonics) - 1
    assert np.all(
        found.residual_after[0][chosen]
        <= found.residual_before[0][chosen] + 1e-9 * np.abs(found.gains).max()
    )
    assert found.gains.sum() == pytest.approx(gauges)
    assert found.noise_factor >= 1 - 1e-12


@given(cases)
def test_sensitivities_keep_the_torque_signal(case) -> None:
    gauges, seed = case
    rng = np.random.default_rng(seed)
    torque = rng.uniform(0.8, 1.2, gauges)
    gains = solved(run_of(phasors_of(rng, gauges, 1)), torque_sensitivities=torque).gains
    assert gains @ torque == pytest.approx(torque.sum())


@pytest.mark.parametrize(("gauges", "harmonics"), [(3, (1,)), (5, (1, 2)), (6, (1,)), (4, (1, 2))])
def test_uncertainty_of_gains_against_monte_carlo(gauges, harmonics) -> None:
    rng = np.random.default_rng(31)
    phasors = phasors_of(rng, gauges, 2)
    sigma = 2e-4
    claimed = solved(run_of(phasors, sigma), harmonics).standard_uncertainties
    drawn = [
        solved_plainly(
            phasors
            + sigma * (rng.normal(size=phasors.shape) + 1j * rng.normal(size=phasors.shape)),
            harmonics,
        )
        for _ in range(800)
    ]
    # 800 draws tell a standard deviation to 2.5 %.
    assert np.std(drawn, axis=0) == pytest.approx(claimed, rel=0.12)


def solved_plainly(phasors, harmonics):
    run = run_of(phasors)
    return compensating_gains(run.conditions(harmonics), most_noise=np.inf).gains


def loaded(phasors, shift):
    """The same gauges under load: amplitude grows, and phase shifts gauge by gauge."""
    size = 1 + shift * np.linspace(-1, 1, phasors.shape[1])
    return phasors * (1 + shift) * size * np.exp(1j * shift * np.arange(phasors.shape[1]))


def test_one_set_of_gains_over_a_grid() -> None:
    rng = np.random.default_rng(4)
    phasors = phasors_of(rng, 3, 1)
    runs = [run_of(loaded(phasors, shift)) for shift in (-0.05, 0.0, 0.02, 0.05)]
    total = solve_gains(runs, (1,))
    worst = solve_gains(runs, (1,), over_grid="worst")
    alone = solve_gains(runs[:1], (1,))
    assert np.sum(total.residual_after**2) <= np.sum(worst.residual_after**2)
    assert worst.residual_after.max() < total.residual_after.max()
    assert np.sum(total.residual_after**2) < np.sum(
        [np.abs(run.weighted_sum(alone.gains)) ** 2 for run in runs]
    )
    assert not total.is_exact
    # Brute force over the two free gains.
    first, second = np.meshgrid(np.linspace(0.7, 1.3, 301), np.linspace(0.7, 1.3, 301))
    tried = np.stack([first.ravel(), second.ravel(), 3 - first.ravel() - second.ravel()])
    left = np.array([np.abs(run.phasors[0] @ tried) for run in runs])
    assert np.sum(total.residual_after**2) <= np.sum(left**2, axis=0).min() * (1 + 1e-3)
    assert worst.residual_after.max() <= left.max(axis=0).min() * 1.01


def test_spare_gauges_serve_more_conditions_exactly() -> None:
    rng = np.random.default_rng(7)
    phasors = phasors_of(rng, 6, 1)
    runs = [run_of(loaded(phasors, shift), 1e-6) for shift in (-0.05, 0.05)]
    found = solve_gains(runs, (1,))
    assert found.residual_after.max() < 1e-4
    assert found.gains.sum() == pytest.approx(6)


def test_noise_of_phasors_is_not_fitted_over_a_grid() -> None:
    # The same wave at every load, seen with noise: gains that chase it would be noisier.
    rng = np.random.default_rng(12)
    phasors = phasors_of(rng, 6, 1)
    sigma = 0.02
    runs = [
        run_of(phasors + sigma * (rng.normal(size=(1, 6)) + 1j * rng.normal(size=(1, 6))), sigma)
        for _ in range(2)
    ]
    careful = solve_gains(runs, (1,)).gains
    chasing = solve_gains([replace(run, covariance=0 * run.covariance) for run in runs], (1,)).gains
    assert np.abs(phasors @ careful)[0] < np.abs(phasors @ chasing)[0]


def test_gains_without_each_gauge() -> None:
    rng = np.random.default_rng(14)
    phasors = phasors_of(rng, 6, 2)
    torque = rng.uniform(0.9, 1.1, 6)
    sets, said = gains_without_each([run_of(phasors).conditions((1, 2))], torque, most_noise=1e6)
    assert [each.gauge for each in sets] == [1, 2, 3, 4, 5, 6]
    assert said == ()
    for each in sets:
        assert each.gains[each.gauge - 1] == 0
        # What is calibrated once holds for every set.
        assert each.gains @ torque == pytest.approx(torque.sum())
        assert np.all(np.abs(phasors @ each.gains) < 1e-7 * np.abs(each.gains).max())
        assert each.noise_factor >= 1
    assert gains_without_each([run_of(phasors[:, :5]).conditions((1, 2))], np.ones(5)) == ((), ())
    assert gains_without_each([run_of(phasors[:1, :3]).conditions((1,))], np.ones(3)) == ((), ())


def test_a_gauge_that_cannot_be_lost_is_said() -> None:
    # Without gauge 4 the others lie on one line.
    phasors = np.array([[1.0, 1.0, 1.1, 1j - 1]])
    phasors[0, 3] = -1.0 + 0.5j
    sets, said = gains_without_each([run_of(phasors).conditions((1,))], np.ones(4))
    assert 4 not in [each.gauge for each in sets]
    assert any(words.startswith("Without gauge 4 no gains are stored:") for words in said)


@pytest.mark.parametrize(
    ("phasors", "harmonics", "words"),
    [
        (np.array([[1, 1.01, 1.02j / 1j]]), (1,), "has nearly one phase on all 3 gauges"),
        (np.array([[1, 1, -1.0]]), (1,), "lie on one line"),
    ],
)
def test_degenerate_waves_are_refused_with_their_reason(phasors, harmonics, words) -> None:
    bent = phasors.astype(complex) * np.exp(1j * np.array([[0.0, 0.01, -0.02]]))
    with pytest.raises(InputError, match=words) as caught:
        solve_gains([run_of(bent)], harmonics)
    assert "\n" not in str(caught.value)


def test_harmonic_three_on_three_gauges_looks_like_torque() -> None:
    rng = np.random.default_rng(3)
    phasors = phasors_of(rng, 7, 3)[:, :7]
    lead = np.exp(6j * equally_spaced_positions_rad(3))
    assert np.abs(lead - 1).max() < 1e-6
    three = np.vstack([phasors[:2, :3] * 0 + 1e-3, lead * [1.0, 1.02, 0.99]])
    with pytest.raises(InputError, match="harmonic 3 has nearly one phase on all 3 gauges"):
        solve_gains([run_of(three)], (3,))


def test_a_gauge_that_hardly_sees_the_wave_is_named() -> None:
    (words,) = reasons(run_of(np.array([[1, 0.01, -1j]])).conditions((1,)), (1,))
    assert words.startswith("gauge 2 hardly sees harmonic 1")


def test_no_reason_is_invented_for_good_gauges() -> None:
    rng = np.random.default_rng(1)
    assert reasons(run_of(phasors_of(rng, 5, 2)).conditions((1, 2)), (1, 2)) == ()


def test_claimed_uncertainty_covers_what_runs_scatter_by() -> None:
    station = station_of(3)
    found = []
    for seed in range(30):
        run = turns_of(station, 1.0, seed)
        fit = fit_run(
            run.volts,
            run.motor_angle_rad,
            positions_rad=equally_spaced_positions_rad(3),
            harmonics=4,
        )
        found.append(solve_gains([fit], (1,)))
    scatter = np.std([each.gains for each in found], axis=0)
    claimed = np.mean([each.standard_uncertainties for each in found], axis=0)
    assert np.all(scatter < 1.2 * claimed)
    assert np.all(scatter > 0.5 * claimed)
