"""Torque or artefact without a reference: what load and speed tell, and what they do not."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.accuracy.joint import FULL_SCALE_NM, WAVE_FACTOR, make_joint, simulate
from benchmarks.accuracy.motion import LEARNING, STEADY, Segment
from benchmarks.accuracy.ripple import RIGHT
from strainwave.identify.load_sweep import decide_by_load_sweep
from strainwave.identify.moving_rows import moving_rows
from strainwave.identify.recording import CANDIDATES
from strainwave.identify.torque_or_artefact import UNDECIDABLE, TorqueOrArtefact

SLOW_AND_FAST = (150.0, -12.0, 80.0, 12.0, -150.0, -10.0, 40.0, 10.0, -60.0, 11.0, -11.0, 110.0)
FAST = (150.0, 40.0, -120.0, -150.0, 30.0, 100.0)
HIGH_RAD_S = 150.0


def _plan(speeds_rad_s: tuple[float, ...]) -> list[Segment]:
    plan = [Segment(LEARNING, 0.5, 0.0)]
    for speed in speeds_rad_s:
        plan += [
            Segment(STEADY, 0.6, speed),
            Segment(STEADY, float(np.clip(200 / abs(speed), 1.5, 12.0)), speed),
        ]
    return plan


def _judge(
    seed: int,
    speeds_rad_s: tuple[float, ...] = SLOW_AND_FAST,
    load_Nm: float = 12.0,
    parts_Nm: tuple[float, float, float] | None = None,
    delay_s: float | None = 0.0,
    rated_torque_Nm: float = FULL_SCALE_NM,
    resonance_Hz: float | None = None,
) -> TorqueOrArtefact:
    """Judge order 2: the joint's own ripple, or parts constant, times load, times speed square."""
    joint = make_joint(RIGHT, seed)
    motion = simulate(joint, _plan(speeds_rad_s)).motion
    swing_Nm = load_Nm * np.sin(2 * np.pi * motion.time_s / 7.3)
    run = simulate(joint, _plan(speeds_rad_s), swing_Nm)
    torque_Nm = run.measured_torque_Nm
    if parts_Nm is not None:
        square = (motion.speed_rad_s / HIGH_RAD_S) ** 2
        scales = (1.0, run.true_torque_Nm / FULL_SCALE_NM, square)
        wave = np.cos(2 * WAVE_FACTOR * motion.angle_rad + seed)
        amplitude = sum(part * scale for part, scale in zip(parts_Nm, scales, strict=True))
        torque_Nm = torque_Nm - run.ripple_Nm + amplitude * wave
    if resonance_Hz is not None:
        # Kinematic error on the gear's spring, with the arm's inertia behind it.
        turned = 2 * WAVE_FACTOR * motion.angle_rad
        high = WAVE_FACTOR * np.abs(motion.speed_rad_s) / np.pi / resonance_Hz
        response = high**2 / (1 - high**2 + 0.2j * high)
        torque_Nm = torque_Nm - run.ripple_Nm + np.real(response * np.exp(1j * turned))
    rows = moving_rows(motion.time_s, run.motor_angle_rad, torque_Nm)
    return decide_by_load_sweep(rows, [2.0], CANDIDATES, WAVE_FACTOR, delay_s, rated_torque_Nm)


@pytest.mark.parametrize("seed", range(1, 5))
def test_what_needs_neither_load_nor_speed_is_an_artefact(seed: int) -> None:
    # The joint's own ripple: 1.6 Nm that grow a little with load and speed.
    (verdict,) = _judge(seed).verdicts
    assert (verdict.decision, verdict.basis) == ("remove", "load sweep")
    assert verdict.share is not None
    assert -0.05 < verdict.share.value < 0.2
    (constant,) = _judge(seed, parts_Nm=(1.5, 0.0, 0.0)).verdicts
    assert constant.decision == "remove"
    assert constant.share is not None
    assert abs(constant.share.value) < 4 * constant.share.standard_uncertainty
    assert 1e-4 < constant.share.standard_uncertainty < 0.05


@pytest.mark.parametrize("seed", range(1, 5))
def test_what_goes_with_the_square_of_the_speed_is_torque(seed: int) -> None:
    judged = _judge(seed, parts_Nm=(0.0, 0.0, 1.5))
    (verdict,) = judged.verdicts
    assert (verdict.decision, verdict.basis) == ("keep", "load sweep")
    assert verdict.share is not None
    assert abs(verdict.share.value - 1.0) < 4 * verdict.share.standard_uncertainty
    assert judged.says == ()


@pytest.mark.parametrize("seed", range(1, 5))
def test_what_goes_with_the_load_may_be_either(seed: int) -> None:
    judged = _judge(seed, parts_Nm=(0.0, 3.0, 0.0))
    assert judged.verdicts[0].decision == UNDECIDABLE
    assert "is clearly more than half of it" in judged.verdicts[0].reason
    assert "--reference COLUMN" in judged.says[0]


@pytest.mark.parametrize("resonance_Hz", [8.0, 12.0, 20.0, 30.0, 100.0])
def test_torque_of_a_resonance_is_never_removed(resonance_Hz: float) -> None:
    (verdict,) = _judge(3, resonance_Hz=resonance_Hz).verdicts
    assert verdict.decision in ("keep", UNDECIDABLE)
    if resonance_Hz == 100.0:
        assert verdict.decision == "keep"


def test_a_spring_above_resonance_is_not_called_an_artefact() -> None:
    # Constant at every speed that the recording has, none of which is slow.
    judged = _judge(1, FAST, parts_Nm=(1.5, 0.0, 0.0))
    assert judged.verdicts[0].decision == UNDECIDABLE
    assert "slow enough" in judged.says[0]


@pytest.mark.parametrize(
    ("given", "lacking"),
    [
        ({"speeds_rad_s": (150.0, -140.0, 130.0, -150.0)}, "the speed changes by a factor of 1."),
        ({"rated_torque_Nm": 10 * FULL_SCALE_NM}, "of the rated torque only"),
        ({"delay_s": None}, "the delay between angle and torque is not known"),
        ({"speeds_rad_s": (10.0,)}, "windows of travel show it"),
    ],
)
def test_what_the_recording_lacks_is_said(given: dict[str, object], lacking: str) -> None:
    judged = _judge(2, **given)  # type: ignore[arg-type]
    assert judged.verdicts[0].decision == UNDECIDABLE
    assert len(judged.says) == 1
    assert lacking in judged.says[0]
    assert "undecidable from this log" in judged.says[0]
    assert "slow and fast stretches under loads that differ" in judged.says[0]
