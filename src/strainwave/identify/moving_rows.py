"""Rows of a recording that tell something of ripple: in motion, and new; and windows of travel."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Rows over which a speed is taken, on both sides.
SPEED_ROWS: Final = 4
#: Rows slower than this share of the high speed are at rest.
LEAST_SPEED_SHARE: Final = 0.03
#: A reversal is one where the angle comes back by this share of a window.
REVERSAL_SHARE: Final = 0.05


@dataclass(frozen=True)
class MovingRows:
    """Rows in motion, each of which brings something new.

    Attributes
    ----------
    time_s, angle_rad, speed_rad_s, torque_Nm : numpy.ndarray
        Shape (rows,); angle and speed are those of the side that was measured.
    place : numpy.ndarray
        Where each row was among the rows that were given, shape (rows,), from 0.
    """

    time_s: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    speed_rad_s: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    place: NDArray[np.intp]

    def __len__(self) -> int:
        return len(self.time_s)


def moving_rows(
    time_s: NDArray[np.float64], angle_rad: NDArray[np.float64], torque_Nm: NDArray[np.float64]
) -> MovingRows:
    """Leave out rows without a number, rows out of order, held rows, and rows at rest.

    Parameters
    ----------
    time_s, angle_rad, torque_Nm : numpy.ndarray
        Consecutive rows, shape (rows,), s, rad and Nm.

    Returns
    -------
    MovingRows
        What is left.
    """
    known = np.isfinite(time_s) & np.isfinite(angle_rad) & np.isfinite(torque_Nm)
    stamps = np.where(known, time_s, -np.inf)
    latest = np.maximum.accumulate(np.append(-np.inf, stamps))[:-1]
    good = np.flatnonzero(known & (stamps > latest))
    time_s, angle_rad, torque_Nm = time_s[good], angle_rad[good], torque_Nm[good]
    if len(good) < 2 * SPEED_ROWS + 2:
        nothing = np.empty(0)
        return MovingRows(nothing, nothing, nothing, nothing, np.empty(0, np.intp))
    new = np.append(True, (np.diff(angle_rad) != 0.0) | (np.diff(torque_Nm) != 0.0))
    good, time_s, angle_rad, torque_Nm = good[new], time_s[new], angle_rad[new], torque_Nm[new]
    rows = np.arange(len(time_s))
    after = np.minimum(rows + SPEED_ROWS, len(rows) - 1)
    before = np.maximum(rows - SPEED_ROWS, 0)
    speed = (angle_rad[after] - angle_rad[before]) / (time_s[after] - time_s[before])
    high = float(np.quantile(np.abs(speed), 0.95))
    moving = np.abs(speed) > max(LEAST_SPEED_SHARE * high, 1e-9)
    return MovingRows(
        time_s[moving], angle_rad[moving], speed[moving], torque_Nm[moving], good[moving]
    )


def travel_windows(
    angle_rad: NDArray[np.float64], length_rad: float, least_rows: int
) -> list[slice]:
    """Cut rows into windows of one direction and about one length, without overlap.

    Parameters
    ----------
    angle_rad : numpy.ndarray
        Angles, shape (rows,), rad.
    length_rad : float
        Length of a window; stretches are cut evenly, into windows of this length or up to twice
        it.
    least_rows : int
        Windows with fewer rows are left out.

    Returns
    -------
    list of slice
        The windows.
    """
    windows = []
    ends = turning_points(angle_rad, REVERSAL_SHARE * length_rad)
    for start, end in pairwise(ends):
        travelled = np.maximum.accumulate(np.abs(angle_rad[start : end + 1] - angle_rad[start]))
        count = int(travelled[-1] // length_rad)
        edges = np.searchsorted(travelled, np.linspace(0.0, travelled[-1], count + 1)[: count + 1])
        for first, past in pairwise(edges):
            if past - first >= least_rows:
                windows.append(slice(int(start + first), int(start + past)))
    return windows


def turning_points(angle_rad: NDArray[np.float64], least_return_rad: float) -> list[int]:
    """Give first row, reversals and last row.

    Parameters
    ----------
    angle_rad : numpy.ndarray
        Angles, shape (rows,), rad.
    least_return_rad : float
        What comes back by less is no reversal.

    Returns
    -------
    list of int
        Numbers of rows, ascending.
    """
    if not len(angle_rad):
        return [0]
    points = [0]
    highest = lowest = 0
    direction = 0
    angles = angle_rad.tolist()
    for row, angle in enumerate(angles):
        if angle >= angles[highest]:
            highest = row
        if angle <= angles[lowest]:
            lowest = row
        if direction >= 0 and angles[highest] - angle > least_return_rad:
            if direction > 0:
                points.append(highest)
            direction, lowest = -1, row
            highest = row
        elif direction <= 0 and angle - angles[lowest] > least_return_rad:
            if direction < 0:
                points.append(lowest)
            direction, highest = 1, row
            lowest = row
    return [*points, len(angle_rad) - 1]
