"""How the simulated joint's motor turns: minimum-jerk transitions between held speeds, by phases.

Speed, angle and acceleration come from one polynomial, so the angle is exact and nothing has to be
integrated numerically.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Motor speed at which most of a run is spent, and to which ripple's growth with speed refers.
FULL_SPEED_RAD_S: Final = 156.0
SAMPLE_PERIOD_S: Final = 1e-3

#: Learning comes first; it is labelled, and counted in no mean.
LEARNING: Final = "learning"
STEADY: Final = "steady"
CONTACT: Final = "contact"
ACCELERATION: Final = "acceleration"
REVERSAL: Final = "reversal"
STANDSTILL: Final = "standstill"
CRAWL: Final = "crawl"
RESTART: Final = "restart"
#: The phases over which the mean is taken.
PHASES: Final = (STEADY, CONTACT, ACCELERATION, REVERSAL, STANDSTILL, CRAWL, RESTART)


@dataclass(frozen=True)
class Segment:
    """A stretch of motion: from the speed before to this one, by a minimum-jerk transition.

    Attributes
    ----------
    phase : str
        What the stretch belongs to.
    duration_s : float
        How long it takes.
    speed_rad_s : float
        Motor speed at its end.
    """

    phase: str
    duration_s: float
    speed_rad_s: float


@dataclass(frozen=True)
class Motion:
    """Motion of the motor, sample by sample.

    Attributes
    ----------
    time_s : numpy.ndarray
        Time, shape (samples,), s.
    phase : numpy.ndarray
        Name of the phase of each sample, shape (samples,).
    angle_rad, speed_rad_s, acceleration_rad_s2 : numpy.ndarray
        Motor angle and its derivatives, shape (samples,).
    """

    time_s: NDArray[np.float64]
    phase: NDArray[np.str_]
    angle_rad: NDArray[np.float64]
    speed_rad_s: NDArray[np.float64]
    acceleration_rad_s2: NDArray[np.float64]


def full_plan(speed_scale: float = 1.0) -> tuple[Segment, ...]:
    """Give the plan of a minute with every phase in it.

    Parameters
    ----------
    speed_scale : float
        Scale of the speeds other than the full one, so that joints do not all move alike.

    Returns
    -------
    tuple of Segment
        60 s of motion.
    """
    full = FULL_SPEED_RAD_S
    return (
        Segment(LEARNING, 0.5, 0.0),
        Segment(LEARNING, 1.0, full),
        Segment(LEARNING, 2.5, full),
        Segment(STEADY, 10.0, full),
        Segment(CONTACT, 14.0, full),
        Segment(ACCELERATION, 1.0, 60.0 * speed_scale),
        Segment(ACCELERATION, 1.0, 60.0 * speed_scale),
        Segment(ACCELERATION, 1.2, 215.0 * speed_scale),
        Segment(ACCELERATION, 0.8, 215.0 * speed_scale),
        Segment(ACCELERATION, 1.0, 110.0 * speed_scale),
        Segment(ACCELERATION, 1.0, 190.0 * speed_scale),
        Segment(ACCELERATION, 1.0, 40.0 * speed_scale),
        Segment(ACCELERATION, 1.0, full),
        Segment(REVERSAL, 1.2, -full),
        Segment(REVERSAL, 0.8, -full),
        Segment(REVERSAL, 1.0, 100.0 * speed_scale),
        Segment(REVERSAL, 0.5, 100.0 * speed_scale),
        Segment(REVERSAL, 0.7, -80.0 * speed_scale),
        Segment(REVERSAL, 0.8, -80.0 * speed_scale),
        Segment(REVERSAL, 1.4, full),
        Segment(REVERSAL, 0.9, full),
        Segment(REVERSAL, 0.7, 0.0),
        Segment(STANDSTILL, 5.0, 0.0),
        Segment(CRAWL, 0.3, 4.0 * speed_scale),
        Segment(CRAWL, 3.0, 4.0 * speed_scale),
        Segment(CRAWL, 0.4, -3.0 * speed_scale),
        Segment(CRAWL, 2.0, -3.0 * speed_scale),
        Segment(CRAWL, 0.3, 0.0),
        Segment(CRAWL, 0.5, 0.0),
        Segment(RESTART, 0.7, full),
        Segment(RESTART, 3.8, full),
    )


def constant_plan(duration_s: float, speed_rad_s: float = FULL_SPEED_RAD_S) -> tuple[Segment, ...]:
    """Give the plan of a run at one speed, for frequency responses.

    Parameters
    ----------
    duration_s : float
        Time at that speed, after 4 s of learning.
    speed_rad_s : float
        Motor speed.

    Returns
    -------
    tuple of Segment
        The plan.
    """
    return (
        Segment(LEARNING, 0.5, 0.0),
        Segment(LEARNING, 1.0, speed_rad_s),
        Segment(LEARNING, 2.5, speed_rad_s),
        Segment(STEADY, duration_s, speed_rad_s),
    )


def move(plan: Sequence[Segment], start_angle_rad: float = 0.0) -> Motion:
    """Compute a plan's motion at the sampling instants.

    Parameters
    ----------
    plan : sequence of Segment
        The stretches, from rest.
    start_angle_rad : float
        Motor angle at the start.

    Returns
    -------
    Motion
        Angle, speed and acceleration.
    """
    phases, angles, speeds, accelerations = [], [], [], []
    angle, speed = start_angle_rad, 0.0
    for segment in plan:
        samples = round(segment.duration_s / SAMPLE_PERIOD_S)
        share = np.arange(samples) / samples
        change = segment.speed_rad_s - speed
        rise = share**3 * (10 - 15 * share + 6 * share**2)
        travelled = share**4 * (2.5 - 3 * share + share**2)
        slope = 30 * share**2 * (1 - share) ** 2
        duration_s = segment.duration_s
        phases.append(np.full(samples, segment.phase))
        speeds.append(speed + change * rise)
        angles.append(angle + duration_s * (speed * share + change * travelled))
        accelerations.append(change * slope / duration_s)
        angle += duration_s * (speed + 0.5 * change)
        speed = segment.speed_rad_s
    phase = np.concatenate(phases)
    return Motion(
        SAMPLE_PERIOD_S * np.arange(len(phase)),
        phase,
        np.concatenate(angles),
        np.concatenate(speeds),
        np.concatenate(accelerations),
    )
