"""Memory and terms by likelihood, on simulated recordings that know nothing of the filter."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from benchmarks.accuracy.evaluation import log_of
from benchmarks.accuracy.joint import FULL_SCALE_NM, Run, make_joint, simulate
from benchmarks.accuracy.motion import LEARNING, constant_plan
from benchmarks.accuracy.ripple import MISMATCH, RIGHT
from strainwave import RippleFilter, RippleFilterConfig, RippleOrder, StatusFlag
from strainwave.identify import ripple_settings
from strainwave.identify.likelihood import row_likelihoods
from strainwave.identify.ripple_settings import (
    MEMORIES_TURNS,
    RippleSettings,
    Terms,
    choose_ripple_settings,
)
from strainwave.methods.registry import Setting, build_method
from strainwave.methods.ripple import learned_at_the_start
from strainwave.samples import Samples

GIVEN = {
    "torque_noise_Nm": 0.04,
    "torque_walk_Nm_per_sqrt_s": 1.3,
    "initial_amplitude_Nm": 2.0,
    "rated_torque_Nm": FULL_SCALE_NM,
}


def _choose(excerpt: Samples) -> RippleSettings:
    return choose_ripple_settings(excerpt, [2, 4, 6], [2, 4], 10.0, GIVEN)


def _simulated(scenario: str, seed: int) -> Samples:
    log = log_of(simulate(make_joint(scenario, seed)))
    return Samples(log.time_s, log.wave_angle_rad, log.torque_Nm, log.expected_torque_Nm)


def _made(amplitude: np.ndarray, angle_rad: np.ndarray, seed: int = 4) -> Samples:
    time_s = np.arange(len(angle_rad)) * 1e-3
    noise_Nm = 0.04 * np.random.default_rng(seed).standard_normal(len(angle_rad))
    torque_Nm = 3.0 * np.sin(time_s) + amplitude * np.cos(2 * angle_rad) + noise_Nm
    return Samples(time_s, angle_rad, torque_Nm, np.zeros(len(angle_rad)))


@pytest.mark.parametrize("seed", [31, 32])
def test_load_and_speed_are_found_where_they_are(seed: int) -> None:
    found = _choose(_simulated(RIGHT, seed))
    assert found.is_chosen
    assert found.terms == Terms(load=True, speed=True)
    # With the right structure nothing is left that a short memory would have to follow.
    assert found.config.memory_turns >= 80.0
    assert [order.with_load for order in found.config.orders] == [True, True, False]


@pytest.mark.parametrize("seed", [31, 32])
def test_what_the_model_leaves_out_shortens_the_memory(seed: int) -> None:
    found = _choose(_simulated(MISMATCH, seed))
    assert found.terms.load
    assert found.config.memory_turns <= 20.0


def test_a_ripple_that_stays_has_no_terms_and_the_longest_memory() -> None:
    angle_rad = 120.0 * np.arange(40_000) * 1e-3
    found = _choose(_made(np.full(40_000, 1.5), angle_rad))
    assert found.is_chosen
    assert found.terms == Terms()
    assert found.config.memory_turns == max(MEMORIES_TURNS)


def test_a_ripple_that_swells_within_turns_has_a_short_memory() -> None:
    angle_rad = 120.0 * np.arange(40_000) * 1e-3
    swelling = 1.5 * (1 + 0.6 * np.sin(angle_rad / 12.0))
    found = _choose(_made(swelling, angle_rad))
    assert found.config.memory_turns <= 5.0


def test_a_short_recording_keeps_the_standard_and_few_turns_get_no_terms() -> None:
    few_rows = _choose(_made(np.ones(450), 300.0 * np.arange(450) * 1e-3))
    assert (few_rows.is_chosen, few_rows.config.memory_turns) == (False, 10.0)
    at_rest = _choose(_made(np.ones(9000), np.zeros(9000)))
    assert not at_rest.is_chosen
    joint = make_joint(RIGHT, 33)
    log = log_of(simulate(joint, constant_plan(7.0)))
    part = Samples(log.time_s, log.wave_angle_rad, log.torque_Nm, log.expected_torque_Nm)
    assert 100 < np.ptp(part.motor_angle_rad) / (2 * np.pi) < 300
    found = _choose(part)
    assert found.is_chosen
    assert found.terms == Terms()


def test_the_likelihood_is_students() -> None:
    excerpt = _simulated(RIGHT, 34)
    config = RippleFilterConfig(orders=[2, 4, 6], memory_turns=20.0, **GIVEN)
    result = RippleFilter(config).process(
        excerpt.time_s, excerpt.motor_angle_rad, excerpt.torque_Nm
    )
    moving = (result.innovation_variance_Nm2 > 0) & (result.status & StatusFlag.at_rest.value == 0)
    rows = np.flatnonzero(moving)
    rows = rows[len(rows) // 8 :]
    deviations = np.sqrt(result.innovation_variance_Nm2[rows])
    scales = np.geomspace(0.2, 5.0, 2000)
    by_scale = [
        np.mean(stats.t.logpdf(result.innovation_Nm[rows[::50]], 4, scale=s * deviations[::50]))
        for s in scales
    ]
    best = scales[int(np.argmax(by_scale))]
    whole = np.mean(stats.t.logpdf(result.innovation_Nm[rows], 4, scale=best * deviations))
    constant = stats.t.logpdf(0.0, 4)
    assert float(np.mean(row_likelihoods(excerpt, config))) == pytest.approx(
        whole - constant, abs=2e-3
    )


@pytest.mark.parametrize("name", ["ripple", "smoother"])
def test_a_method_chooses_on_the_excerpt_it_is_given(name: str) -> None:
    excerpt = _simulated(RIGHT, 35)
    method = build_method(name, Setting(1e-3, None, FULL_SCALE_NM, excerpt=excerpt))
    assert method.settings.terms.load
    without = build_method(name, Setting(1e-3, None, FULL_SCALE_NM))
    assert not without.settings.is_chosen
    assert without.settings.config.memory_turns == 10.0


def _with_direction(seed: int, size_Nm: float, *, another: bool = False) -> tuple[Run, Samples]:
    """Give a joint whose order 2 differs by direction; the separate run starts elsewhere."""
    joint = make_joint(RIGHT, seed)
    if another:
        joint = replace(joint, start_angle_rad=joint.start_angle_rad + 1, speed_scale=0.95)
    run = simulate(joint)
    log = log_of(run)
    extra_Nm = size_Nm * np.sign(run.motion.speed_rad_s) * np.cos(2 * log.wave_angle_rad + 1.0)
    torque_Nm = log.torque_Nm + extra_Nm
    return run, Samples(log.time_s, log.wave_angle_rad, torque_Nm, log.expected_torque_Nm)


def _error_percent(run: Run, samples: Samples, config: RippleFilterConfig) -> float:
    cleaned = RippleFilter(config).process(
        samples.time_s, samples.motor_angle_rad, samples.torque_Nm
    )
    error_Nm = (cleaned.torque_Nm - run.true_torque_Nm)[run.motion.phase != LEARNING]
    return 100 * float(np.sqrt(np.mean(error_Nm**2))) / FULL_SCALE_NM


def test_ripple_that_differs_by_direction_gets_the_term_and_is_the_better_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    excerpt = _with_direction(2, 0.3)[1]
    found = _choose(excerpt)
    assert found.terms.direction
    assert [order.with_direction for order in found.config.orders] == [True, True, False]
    monkeypatch.setattr(ripple_settings, "LEAST_REVERSALS", 1000)
    without = _choose(excerpt)
    assert not without.terms.direction
    run, other = _with_direction(2, 0.3, another=True)
    error_percent = _error_percent(run, other, found.config)
    assert 0.1 < error_percent < 0.16
    assert error_percent < 0.65 * _error_percent(run, other, without.config)


@pytest.mark.parametrize(
    "seed", [1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 22))]
)
@pytest.mark.parametrize("scenario", [RIGHT, MISMATCH])
def test_no_term_in_direction_where_there_is_none(scenario: str, seed: int) -> None:
    assert not _choose(_simulated(scenario, seed)).terms.direction


def test_one_reversal_gives_no_term_in_direction() -> None:
    there_rad = 150.0 * np.arange(20_000) * 1e-3
    angle_rad = np.concatenate([there_rad, there_rad[::-1]])
    direction = np.sign(np.gradient(angle_rad))
    assert not _choose(_made(1.5 + 0.7 * direction, angle_rad)).terms.direction


def test_a_memory_that_is_told_well_has_a_narrow_interval() -> None:
    found = _choose(_simulated(MISMATCH, 31))
    assert found.memory_interval_turns is not None
    shortest, longest = found.memory_interval_turns
    assert 3.0 <= shortest <= found.config.memory_turns <= longest <= 20.0


def test_coefficients_learned_backwards_serve_forwards() -> None:
    to_and_fro_rad = 200.0 * np.abs((np.arange(40_000) * 1e-3) % 4.0 - 2.0)
    direction = np.sign(np.gradient(to_and_fro_rad))
    samples = _made(1.5 + 0.6 * direction, to_and_fro_rad)
    config = RippleFilterConfig(
        orders=[RippleOrder(2, with_direction=True)], memory_turns=80.0, **GIVEN
    )
    learned = learned_at_the_start(samples, config)
    assert learned is not None
    assert learned.coefficients_Nm == pytest.approx([1.5, 0.0, 0.6, 0.0], abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_what_any_memory_and_terms_could_reach_with_mismatch(seed: int) -> None:
    """Chosen with the truth of the separate run itself: the least error that a choice could have."""
    joint = make_joint(MISMATCH, seed)
    joint = replace(joint, start_angle_rad=joint.start_angle_rad + 1, speed_scale=0.95)
    run = simulate(joint)
    log = log_of(run)
    samples = Samples(log.time_s, log.wave_angle_rad, log.torque_Nm, log.expected_torque_Nm)
    errors_percent = []
    for memory_turns, load, speed, direction in itertools.product(
        MEMORIES_TURNS, *[(False, True)] * 3
    ):
        orders = [
            RippleOrder(order, with_load=load, with_speed=speed, with_direction=direction)
            for order in (2, 4, 6)
        ]
        config = RippleFilterConfig(
            orders=[1, *orders], memory_turns=memory_turns, reference_speed_rad_s=156.0, **GIVEN
        )
        errors_percent.append(_error_percent(run, samples, config))
    assert 0.125 < min(errors_percent) < 0.155
