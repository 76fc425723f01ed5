"""Simulated joints of which some orders are real torque, with a reference sensor beside the gauges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from benchmarks.accuracy.joint import FULL_SCALE_NM, WAVE_FACTOR, Run, make_joint, simulate
from benchmarks.accuracy.motion import (
    CONTACT,
    FULL_SPEED_RAD_S,
    LEARNING,
    SAMPLE_PERIOD_S,
    STEADY,
    Segment,
)
from benchmarks.accuracy.ripple import AMPLITUDES_NM, ORDERS, RIGHT
from strainwave.samples import Samples

#: 15 s at two speeds, both ways, with contacts.
PLAN = (
    Segment(LEARNING, 0.5, 0.0),
    Segment(LEARNING, 1.0, FULL_SPEED_RAD_S),
    Segment(CONTACT, 8.0, FULL_SPEED_RAD_S),
    Segment(STEADY, 1.0, -100.0),
    Segment(STEADY, 4.5, -100.0),
)


@dataclass(frozen=True)
class Reference:
    """A reference sensor: what it does to the torque that it measures."""

    noise_Nm: float = 0.04
    delay_rows: int = 2
    gain: float = 1.0
    low_pass_Hz: float | None = None
    held_rows: int = 1


@dataclass(frozen=True)
class ReferenceRun:
    """A run, its true torque with the real part of the ripple, and what the reference reads."""

    run: Run
    true_torque_Nm: np.ndarray
    reference_Nm: np.ndarray

    @property
    def samples(self) -> Samples:
        """Rows as the package takes them."""
        run = self.run
        return Samples(
            run.motion.time_s,
            run.motor_angle_rad,
            run.measured_torque_Nm,
            np.zeros(len(run.motor_angle_rad)),
        )


def order_torque_Nm(run: Run, seed: int, order: int) -> np.ndarray:
    """Ripple of one order of a joint of right structure, written out once more."""
    ripple = make_joint(RIGHT, seed).ripple
    place = ORDERS.index(order)
    load = run.true_torque_Nm / FULL_SCALE_NM
    speed = np.abs(run.motion.speed_rad_s) / FULL_SPEED_RAD_S
    growth = 1 + ripple.load_growth[place] * load + ripple.speed_growth[place] * speed
    angle = order * WAVE_FACTOR * run.motion.angle_rad + ripple.phases_rad[place]
    torque: np.ndarray = AMPLITUDES_NM[place] * growth * np.cos(angle)
    return torque


def reference_run(
    seed: int,
    shares: Mapping[int, float],
    reference: Reference | None = None,
    plan: Sequence[Segment] | None = PLAN,
) -> ReferenceRun:
    """Simulate a joint; of each order the given share is torque, the rest an artefact."""
    reference = reference or Reference()
    run = simulate(make_joint(RIGHT, seed), plan)
    true_Nm = run.true_torque_Nm + sum(
        share * order_torque_Nm(run, seed, order) for order, share in shares.items()
    )
    read_Nm = reference.gain * true_Nm
    if reference.low_pass_Hz is not None:
        keep = np.exp(-2 * np.pi * reference.low_pass_Hz * SAMPLE_PERIOD_S)
        read_Nm = lfilter([1 - keep], [1, -keep], read_Nm)
    rows = np.arange(len(read_Nm))
    read_Nm = read_Nm[np.maximum(rows - reference.delay_rows, 0)]
    noise = np.random.default_rng([seed, 77]).standard_normal(len(rows))
    read_Nm = read_Nm + abs(reference.gain) * reference.noise_Nm * noise
    read_Nm = read_Nm[rows // reference.held_rows * reference.held_rows]
    return ReferenceRun(run, true_Nm, read_Nm)
