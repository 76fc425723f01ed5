"""Where in a recording a contact can be added: stretches in motion, and stretches at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.evidence.motion import Motion
    from strainwave.samples import Samples

#: Rows in motion further apart than this, s and in median intervals, are two motions.
APART_S: Final = 0.1
APART_INTERVALS: Final = 6.0


@dataclass(frozen=True)
class Moment:
    """Where a contact is added.

    Attributes
    ----------
    begins_s : float
        Time in the samples, s.
    length_s : float
        How long it lasts, s.
    motor_speed_rad_s : float
        Motor speed there, the median, rad/s.
    slowest_rad_s, fastest_rad_s : float
        Least and largest magnitude of the motor speed meanwhile, rad/s.
    """

    begins_s: float
    length_s: float
    motor_speed_rad_s: float
    slowest_rad_s: float
    fastest_rad_s: float


@dataclass(frozen=True)
class Stretches:
    """Stretches of a recording.

    Attributes
    ----------
    first_s, last_s : numpy.ndarray
        Their ends, shape (stretches,), s.
    time_s, speed_rad_s : numpy.ndarray
        Rows in motion, shape (rows,), s, and their speeds, rad/s.
    """

    first_s: NDArray[np.float64]
    last_s: NDArray[np.float64]
    time_s: NDArray[np.float64]
    speed_rad_s: NDArray[np.float64]

    def at(
        self, shares: Sequence[float], length_s: float, least_s: float, beside_s: float
    ) -> list[Moment]:
        """Choose moments at shares of the time at which a contact can begin.

        Parameters
        ----------
        shares : sequence of float
            Where, 0 to 1.
        length_s, least_s : float
            Length that is wished for, and the least, s.
        beside_s : float
            Time that must be left beside it, s.

        Returns
        -------
        list of Moment
            None where no stretch is long enough.
        """
        lengths = self.last_s - self.first_s
        if not len(lengths) or float(lengths.max()) < least_s + beside_s:
            return []
        length_s = min(length_s, float(lengths.max()) - beside_s)
        # Half of what is beside it lies before it.
        room = np.maximum(lengths - length_s - beside_s, 0.0)
        room = np.where(lengths >= length_s + beside_s, np.maximum(room, 1e-9), 0.0)
        ends = np.cumsum(room)
        moments = []
        for share in shares:
            place = share * ends[-1]
            n = int(np.searchsorted(ends, place))
            begins_s = float(self.last_s[n] - length_s - 0.5 * beside_s - (ends[n] - place))
            moments.append(Moment(begins_s, length_s, *self._speeds(begins_s, length_s)))
        return moments

    def _speeds(self, begins_s: float, length_s: float) -> tuple[float, float, float]:
        within = (self.time_s >= begins_s) & (self.time_s <= begins_s + length_s)
        if not within.any():
            return (0.0, 0.0, 0.0)
        speeds = self.speed_rad_s[within]
        magnitudes = np.abs(speeds)
        return float(np.median(speeds)), float(magnitudes.min()), float(magnitudes.max())


def moments_in_motion(samples: Samples, motion: Motion) -> Stretches:
    """Find the stretches during which the motor turns.

    Parameters
    ----------
    samples : Samples
        The recording.
    motion : Motion
        Its rows in motion.

    Returns
    -------
    Stretches
        None where the motor never moves.
    """
    time_s = samples.time_s[motion.place]
    gaps = np.flatnonzero(np.diff(time_s) > _apart_s(samples))
    if not len(time_s):
        return Stretches(time_s, time_s, time_s, time_s)
    first = time_s[np.append(0, gaps + 1)]
    last = time_s[np.append(gaps, len(time_s) - 1)]
    return Stretches(first, last, time_s, motion.speed_rad_s)


def moments_at_rest(samples: Samples, motion: Motion) -> Stretches:
    """Find the stretches during which the motor stands.

    Parameters
    ----------
    samples : Samples
        The recording.
    motion : Motion
        Its rows in motion.

    Returns
    -------
    Stretches
        None where the motor never stands.
    """
    known = samples.time_s[np.isfinite(samples.time_s) & np.isfinite(samples.motor_angle_rad)]
    nothing = np.empty(0)
    if not len(known):
        return Stretches(nothing, nothing, nothing, nothing)
    moving = moments_in_motion(samples, motion)
    first = np.append(known.min(), moving.last_s)
    last = np.append(moving.first_s, known.max())
    apart = _apart_s(samples)
    long = last - first > 2.0 * apart
    # What is next to a motion may still move.
    return Stretches(first[long] + 0.5 * apart, last[long] - 0.5 * apart, nothing, nothing)


def _apart_s(samples: Samples) -> float:
    steps_s = np.diff(samples.time_s)
    steps_s = steps_s[steps_s > 0.0]
    return max(APART_S, APART_INTERVALS * float(np.median(steps_s)) if len(steps_s) else 0.0)
