"""Torque or artefact by a reference sensor, on simulated joints that know nothing of the package."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.accuracy.joint import WAVE_FACTOR
from benchmarks.accuracy.motion import FULL_SPEED_RAD_S, LEARNING, STEADY, Segment
from helpers.reference_runs import Reference, reference_run
from strainwave.identify.recording import CANDIDATES
from strainwave.identify.reference_share import decide_by_reference
from strainwave.identify.torque_or_artefact import (
    UNDECIDABLE,
    Share,
    TorqueOrArtefact,
    decided,
    share_of,
    weights_of,
)

ORDERS = (2.0, 4.0, 6.0)
SEEDS = range(1, 22)
#: Torque's share of each order: an artefact, torque, and three quarters of it torque.
SHARES = {2: 0.0, 4: 1.0, 6: 0.75}


@cache
def _judged(
    seed: int, shares: tuple[tuple[int, float], ...], reference: Reference, plan: object = None
) -> TorqueOrArtefact:
    given = {} if plan is None else {"plan": plan}
    run = reference_run(seed, dict(shares), reference, **given)  # type: ignore[arg-type]
    return decide_by_reference(run.samples, run.reference_Nm, ORDERS, CANDIDATES, WAVE_FACTOR, 0.0)


def _judge(
    seed: int = 1,
    shares: dict[int, float] = SHARES,
    reference: Reference | None = None,
    plan: object = None,
) -> TorqueOrArtefact:
    return _judged(seed, tuple(shares.items()), reference or Reference(), plan)


@pytest.mark.parametrize("seed", SEEDS)
def test_artefact_is_removed_and_torque_is_kept(seed: int) -> None:
    judged = _judge(seed)
    assert [each.decision for each in judged.verdicts] == ["remove", "keep", "keep"]
    assert {each.basis for each in judged.verdicts} == {"reference"}
    assert judged.says == ()
    assert judged.agreement is not None
    assert judged.agreement.gain == pytest.approx(1.0, abs=1e-3)
    assert judged.agreement.delay_s == pytest.approx(2e-3, abs=2e-4)


def test_uncertainties_are_as_large_as_the_errors() -> None:
    errors = np.array(
        [
            (verdict.share.value - share) / verdict.share.standard_uncertainty
            for seed in SEEDS
            for verdict, share in zip(_judge(seed).verdicts, SHARES.values(), strict=True)
            if verdict.share is not None
        ]
    )
    assert len(errors) == len(ORDERS) * len(SEEDS)
    # Of a normal distribution 68 % are within one, 95 % within two; 63 draws scatter by 6 and 3 %.
    assert 0.53 < np.mean(np.abs(errors) < 1) < 0.84
    assert 0.87 < np.mean(np.abs(errors) < 2) <= 1.0
    assert np.mean(np.abs(errors) < 3) > 0.97
    assert abs(np.mean(errors)) < 0.35
    assert 0.75 < np.std(errors) < 1.3


def test_delay_gain_and_lag_are_as_uncertain_as_they_say() -> None:
    found = [_judge(seed).agreement for seed in SEEDS]
    errors = np.array(
        [
            (
                (each.gain - 1.0) / each.gain_standard_uncertainty,
                (each.delay_s - 2e-3) / each.delay_standard_uncertainty_s,
                each.lag_square_s2 / each.lag_square_standard_uncertainty_s2,
            )
            for each in found
            if each is not None
        ]
    )
    assert len(errors) == len(SEEDS)
    assert np.all(np.mean(np.abs(errors) < 3, axis=0) > 0.9)
    assert np.all(np.median(np.abs(errors), axis=0) < 1.3)
    assert np.all(np.median(np.abs(errors[:, :2]), axis=0) > 0.2)


def test_amounts_are_those_that_went_in() -> None:
    artefact, torque, both = _judge(3).verdicts
    assert artefact.torque_Nm is not None
    assert artefact.torque_standard_uncertainty_Nm is not None
    assert artefact.torque_Nm < 3 * artefact.torque_standard_uncertainty_Nm
    assert artefact.artefact_Nm is not None
    assert 1.6 < artefact.artefact_Nm < 2.2
    assert torque.torque_Nm is not None
    assert 0.6 < torque.torque_Nm < 0.9
    assert torque.artefact_Nm is not None
    assert torque.artefact_standard_uncertainty_Nm is not None
    assert torque.artefact_Nm < 3 * torque.artefact_standard_uncertainty_Nm
    # Order 6 has 0.08 Nm throughout.
    assert both.torque_Nm == pytest.approx(0.06, abs=0.004)
    assert both.artefact_Nm == pytest.approx(0.02, abs=0.004)


def test_half_and_half_is_undecidable() -> None:
    verdicts = [_judge(seed, {2: 0.5, 4: 0.5}).verdicts[0] for seed in range(1, 9)]
    for verdict in verdicts:
        assert verdict.share is not None
        away = abs(verdict.share.value - 0.5)
        assert away < 4 * verdict.share.standard_uncertainty
    undecided = [each for each in verdicts if each.decision == UNDECIDABLE]
    # By chance 5 % of the intervals leave one half out.
    assert len(undecided) >= 6
    assert all("on both sides of 0.5" in each.reason for each in undecided)


def test_torque_and_artefact_against_each_other_may_have_shares_beyond_one() -> None:
    verdict = _judge(2, {2: 2.0}).verdicts[0]
    assert verdict.share is not None
    assert verdict.share.value == pytest.approx(2.0, abs=0.01)
    assert verdict.decision == "keep"


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_slow_reference_decides_nothing(seed: int) -> None:
    judged = _judge(seed, reference=Reference(low_pass_Hz=10.0))
    assert [each.decision for each in judged.verdicts] == [UNDECIDABLE] * 3
    assert all("like a low-pass at 1" in each.reason for each in judged.verdicts)
    assert all("it is too slow" in each for each in judged.says)
    assert all("removed as an artefact" in each for each in judged.says)


def test_a_reference_of_enough_bandwidth_decides() -> None:
    judged = _judge(1, reference=Reference(low_pass_Hz=300.0))
    assert [each.decision for each in judged.verdicts][:2] == ["remove", "keep"]


def test_a_held_reference_decides_nothing() -> None:
    judged = _judge(1, reference=Reference(held_rows=20))
    assert judged.verdicts[0].decision == UNDECIDABLE
    assert "changes only 50.1 times a second" in judged.says[0]


@pytest.mark.parametrize(("gain", "said"), [(-1.0, "reads -1 of"), (1000.0, "reads 1e+03 of")])
def test_a_wrong_sign_or_unit_is_said(gain: float, said: str) -> None:
    judged = _judge(1, reference=Reference(gain=gain))
    assert [each.decision for each in judged.verdicts] == [UNDECIDABLE] * 3
    assert said in judged.says[0]
    assert "check its unit and sign" in judged.says[0]


def test_a_gain_that_is_a_little_off_is_said_and_put_right() -> None:
    judged = _judge(1, reference=Reference(gain=0.9))
    assert [each.decision for each in judged.verdicts] == ["remove", "keep", "keep"]
    assert judged.verdicts[1].share is not None
    assert judged.verdicts[1].share.value == pytest.approx(1.0, abs=0.01)
    assert "reads 0.9 of the measured torque" in judged.says[0]


def test_a_reference_of_something_else_is_said() -> None:
    run = reference_run(1, {})
    noise = np.random.default_rng(4).standard_normal(len(run.reference_Nm))
    judged = decide_by_reference(run.samples, noise, ORDERS, CANDIDATES, WAVE_FACTOR, 0.0)
    assert [each.decision for each in judged.verdicts] == [UNDECIDABLE] * 3
    assert "has too little in common" in judged.says[0]


@pytest.mark.parametrize("value_Nm", [0.0, 3.0])
def test_a_reference_that_never_changes_is_said(value_Nm: float) -> None:
    run = reference_run(1, {})
    constant = np.full(len(run.reference_Nm), value_Nm)
    judged = decide_by_reference(run.samples, constant, ORDERS, CANDIDATES, WAVE_FACTOR, 0.0)
    assert [each.decision for each in judged.verdicts] == [UNDECIDABLE] * 3
    assert "check" in judged.says[0]


def test_a_short_recording_decides_nothing() -> None:
    plan = (
        Segment(LEARNING, 0.3, 0.0),
        Segment(STEADY, 0.3, FULL_SPEED_RAD_S),
        Segment(STEADY, 0.4, FULL_SPEED_RAD_S),
    )
    assert [each.decision for each in _judge(1, plan=plan).verdicts] == [UNDECIDABLE] * 3


def test_rows_without_a_reference_are_left_out() -> None:
    run = reference_run(1, SHARES)
    reference_Nm = run.reference_Nm.copy()
    reference_Nm[3000:5000] = np.nan
    reference_Nm[::97] = np.nan
    judged = decide_by_reference(run.samples, reference_Nm, ORDERS, CANDIDATES, WAVE_FACTOR, 0.0)
    assert [each.decision for each in judged.verdicts] == ["remove", "keep", "keep"]
    nothing = np.full(len(reference_Nm), np.nan)
    judged = decide_by_reference(run.samples, nothing, ORDERS, CANDIDATES, WAVE_FACTOR, 0.0)
    assert [each.decision for each in judged.verdicts] == [UNDECIDABLE] * 3


@given(
    share=st.floats(-3.0, 3.0),
    scale=st.floats(1e-6, 1e6),
    seed=st.integers(0, 1000),
)
def test_the_share_of_a_part_is_its_share(share: float, scale: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    whole = scale * (1.0 + random.uniform(size=12))
    weights = weights_of(scale**2 * random.uniform(0.1, 1.0, 12))
    power = np.abs(whole) ** 2
    found = share_of(share * power, power, weights)
    assert found.value == pytest.approx(share, abs=1e-9)
    assert found.standard_uncertainty < 1e-9
    assert weights.sum() == pytest.approx(1.0)


@given(value=st.floats(-2.0, 3.0), deviation=st.floats(1e-6, 1.0), loss=st.floats(1.0, 3.0))
def test_an_interval_on_one_side_of_a_half_decides(
    value: float, deviation: float, loss: float
) -> None:
    share = Share(value, deviation, 20)
    low, high = share.interval
    # Student's t of 20 degrees of freedom, 95 %.
    assert high - low == pytest.approx(2 * 2.086 * deviation, rel=1e-3)
    decision = decided(2.0, share, "reference", loss).decision
    expected = "keep" if low > 0.5 else "remove" if max(high, loss * high) < 0.5 else UNDECIDABLE
    assert decision == expected
    # What the reference may have lost never makes an order torque, nor an artefact.
    plain = decided(2.0, share, "reference").decision
    assert decision == plain or (plain, decision) == ("remove", UNDECIDABLE)
