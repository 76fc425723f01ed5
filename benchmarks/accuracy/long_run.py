"""One joint for many minutes: a log that is long enough to be cut into chunks."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.accuracy.joint import Run, make_joint, simulate
from benchmarks.accuracy.motion import RESTART, SAMPLE_PERIOD_S, Motion, Segment, full_plan

if TYPE_CHECKING:
    from numpy.typing import NDArray


def long_run(scenario: str, seed: int, minutes: int) -> Run:
    """Run a joint for many minutes, each with every phase and from rest to rest.

    Parameters
    ----------
    scenario : str
        Scenario of the joint.
    seed : int
        Seed of the joint.
    minutes : int
        How often it runs the plan. What drifts within a minute starts again with each.

    Returns
    -------
    Run
        One recording.
    """
    joint = make_joint(scenario, seed)
    plan = (*full_plan(joint.speed_scale), Segment(RESTART, 0.7, 0.0))
    runs: list[Run] = []
    angle_rad = joint.start_angle_rad
    for minute in range(minutes):
        # The noise follows from the seed.
        runs.append(
            simulate(replace(joint, seed=1000 * minute + seed, start_angle_rad=angle_rad), plan)
        )
        angle_rad = runs[-1].motion.angle_rad[-1]

    def joined(name: str) -> NDArray[Any]:
        return np.concatenate([getattr(run, name) for run in runs])

    def moved(name: str) -> NDArray[Any]:
        return np.concatenate([getattr(run.motion, name) for run in runs])

    phase = moved("phase")
    return Run(
        Motion(
            SAMPLE_PERIOD_S * np.arange(len(phase), dtype=np.float64),
            phase,
            moved("angle_rad"),
            moved("speed_rad_s"),
            moved("acceleration_rad_s2"),
        ),
        joined("motor_angle_rad"),
        joined("measured_torque_Nm"),
        joined("true_torque_Nm"),
        joined("ripple_Nm"),
    )
