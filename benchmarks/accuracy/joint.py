"""Simulated joints with the truth beside the signals; nothing of strainwave takes part in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks.accuracy.load import Load, carried_torque_Nm, contact_torque_Nm, draw_load
from benchmarks.accuracy.motion import FULL_SPEED_RAD_S, Motion, Segment, full_plan, move
from benchmarks.accuracy.ripple import SCENARIOS, Ripple, draw_ripple, ripple_torque_Nm
from benchmarks.accuracy.sampling import converted_Nm, counted_rad

if TYPE_CHECKING:
    from numpy.typing import NDArray

FULL_SCALE_NM: Final = 40.0
RATIO: Final = 100.0
#: Wave angle over motor angle with the circular spline fixed, m = (R + 1)/R.
WAVE_FACTOR: Final = (RATIO + 1) / RATIO
#: White noise of the torque signal, rms.
NOISE_NM: Final = 0.001 * FULL_SCALE_NM


@dataclass(frozen=True)
class Joint:
    """A joint of a scenario.

    Attributes
    ----------
    scenario : str
        One of `benchmarks.accuracy.ripple.SCENARIOS`.
    seed : int
        What was drawn follows from scenario and seed.
    load : Load
        What it carries.
    ripple : Ripple
        How it ripples.
    start_angle_rad : float
        Motor angle at power-up.
    speed_scale : float
        Scale of the speeds other than the full one.
    """

    scenario: str
    seed: int
    load: Load
    ripple: Ripple
    start_angle_rad: float
    speed_scale: float


@dataclass(frozen=True)
class Run:
    """A recording and its truth.

    Attributes
    ----------
    motion : Motion
        Time, phases, and the motor's motion as it truly is.
    motor_angle_rad : numpy.ndarray
        Motor angle as counted, shape (samples,), rad.
    measured_torque_Nm : numpy.ndarray
        Torque as converted, shape (samples,), Nm.
    true_torque_Nm : numpy.ndarray
        Torque without ripple, shape (samples,), Nm.
    ripple_Nm : numpy.ndarray
        Ripple, shape (samples,), Nm.
    """

    motion: Motion
    motor_angle_rad: NDArray[np.float64]
    measured_torque_Nm: NDArray[np.float64]
    true_torque_Nm: NDArray[np.float64]
    ripple_Nm: NDArray[np.float64]


def make_joint(scenario: str, seed: int) -> Joint:
    """Draw a joint.

    Parameters
    ----------
    scenario : str
        One of `benchmarks.accuracy.ripple.SCENARIOS`.
    seed : int
        Joints of one scenario differ by it.

    Returns
    -------
    Joint
        The joint.
    """
    random = np.random.default_rng([seed, SCENARIOS.index(scenario), 0])
    return Joint(
        scenario,
        seed,
        draw_load(random),
        draw_ripple(random, scenario),
        start_angle_rad=random.uniform(0.0, 2 * np.pi),
        speed_scale=random.uniform(0.9, 1.1),
    )


def simulate(
    joint: Joint,
    plan: Sequence[Segment] | None = None,
    added_torque_Nm: NDArray[np.float64] | None = None,
    *,
    ripple_sees_added: bool = True,
) -> Run:
    """Run a joint.

    Parameters
    ----------
    joint : Joint
        The joint.
    plan : sequence of Segment, optional
        How it moves; a minute with every phase without.
    added_torque_Nm : numpy.ndarray, optional
        True torque besides that of the joint's own load and contacts, shape (samples,).
    ripple_sees_added : bool
        Whether the added torque loads the mesh. Without, it is added behind the gear: the ripple
        stays what it was to the last bit, and so does the noise.

    Returns
    -------
    Run
        Signals and truth; the same joint has the same noise in every run.
    """
    segments = full_plan(joint.speed_scale) if plan is None else plan
    motion = move(segments, joint.start_angle_rad)
    torque = carried_torque_Nm(joint.load, motion, RATIO, FULL_SPEED_RAD_S)
    torque = torque + contact_torque_Nm(joint.load, motion)
    added = np.zeros(len(torque)) if added_torque_Nm is None else added_torque_Nm
    ripple = ripple_torque_Nm(
        joint.ripple,
        time_s=motion.time_s,
        wave_angle_rad=WAVE_FACTOR * motion.angle_rad,
        output_angle_rad=motion.angle_rad / RATIO,
        load_share=(torque + added if ripple_sees_added else torque) / FULL_SCALE_NM,
        speed_share=motion.speed_rad_s / FULL_SPEED_RAD_S,
    )
    random = np.random.default_rng([joint.seed, SCENARIOS.index(joint.scenario), 1])
    noise = NOISE_NM * random.standard_normal(len(torque))
    return Run(
        motion,
        counted_rad(motion.angle_rad),
        converted_Nm(torque + added + ripple + noise, FULL_SCALE_NM),
        torque + added,
        ripple,
    )
