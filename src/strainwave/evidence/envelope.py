"""A recording of any length in so many points, none of whose spikes is lost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.methods.interface import Cleaned

#: Points that a page can hold: 44 bytes each in the page.
MOST_POINTS: Final = 20_000


@dataclass(frozen=True)
class Envelope:
    """Lowest and highest torque of consecutive blocks of rows.

    Attributes
    ----------
    rows_per_point : int
        Rows of a block; the last one may have fewer.
    time_s : numpy.ndarray
        Time of each block's first row as the recording counts it, shape (points,), s; rows without
        time have that of the row before.
    before_lowest_Nm, before_highest_Nm, after_lowest_Nm, after_highest_Nm : numpy.ndarray
        Torque as recorded and without ripple, shape (points,), Nm; NaN where no row has one.
    is_rejected : numpy.ndarray
        Whether a row of the block was not used, repeated rows apart, shape (points,).
    """

    rows_per_point: int
    time_s: NDArray[np.float64]
    before_lowest_Nm: NDArray[np.float64]
    before_highest_Nm: NDArray[np.float64]
    after_lowest_Nm: NDArray[np.float64]
    after_highest_Nm: NDArray[np.float64]
    is_rejected: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.time_s)

    def thinned(self, most_points: int) -> Envelope:
        """Put neighbouring blocks together.

        Parameters
        ----------
        most_points : int
            Blocks that may be left.

        Returns
        -------
        Envelope
            The same recording in larger blocks.
        """
        together = max(1, -(-len(self) // most_points))
        starts = np.arange(0, len(self), together)
        return Envelope(
            self.rows_per_point * together,
            self.time_s[starts],
            np.fmin.reduceat(self.before_lowest_Nm, starts),
            np.fmax.reduceat(self.before_highest_Nm, starts),
            np.fmin.reduceat(self.after_lowest_Nm, starts),
            np.fmax.reduceat(self.after_highest_Nm, starts),
            np.logical_or.reduceat(self.is_rejected, starts),
        )


class EnvelopeTally:
    """Takes rows chunk by chunk; how they are cut makes no difference.

    Parameters
    ----------
    rows : int
        Rows that will come.
    most_points : int
        Blocks that they are put into.
    """

    def __init__(self, rows: int, most_points: int = MOST_POINTS) -> None:
        self._rows_per_point = max(1, -(-rows // most_points))
        points = max(1, -(-rows // self._rows_per_point))
        self._time_s = np.full(points, np.nan)
        self._lowest = np.full((2, points), np.nan)
        self._highest = np.full((2, points), np.nan)
        self._rejected = np.zeros(points, bool)
        self._taken = 0

    def take(
        self, log_time_s: NDArray[np.float64], measured_Nm: NDArray[np.float64], cleaned: Cleaned
    ) -> None:
        """Take the next rows.

        Parameters
        ----------
        log_time_s, measured_Nm : numpy.ndarray
            Time, s, and torque as recorded, Nm, shape (rows,).
        cleaned : Cleaned
            What was made of them.
        """
        places = (self._taken + np.arange(len(cleaned))) // self._rows_per_point
        self._taken += len(cleaned)
        starts = np.flatnonzero(np.diff(places, prepend=-1))
        if not len(starts):
            return
        points = places[starts]
        if np.isnan(self._time_s[points[0]]):
            self._time_s[points[0]] = log_time_s[0]
        self._time_s[points[1:]] = log_time_s[starts[1:]]
        for n, torque_Nm in enumerate((measured_Nm, cleaned.torque_Nm)):
            finite = np.where(np.isfinite(torque_Nm), torque_Nm, np.nan)
            low, high = self._lowest[n], self._highest[n]
            low[points] = np.fmin(low[points], np.fmin.reduceat(finite, starts))
            high[points] = np.fmax(high[points], np.fmax.reduceat(finite, starts))
        self._rejected[points] |= np.logical_or.reduceat(is_rejected(cleaned.status), starts)

    def finish(self) -> Envelope:
        """Give the envelope of all rows that were taken.

        Returns
        -------
        Envelope
            The recording.
        """
        count = -(-self._taken // self._rows_per_point)
        known = np.isfinite(self._time_s[:count])
        last = np.maximum.accumulate(np.where(known, np.arange(count), -1))
        time_s = np.where(last >= 0, self._time_s[np.maximum(last, 0)], np.nan)
        if known.any():
            time_s = np.where(last >= 0, time_s, self._time_s[np.flatnonzero(known)[0]])
        return Envelope(
            self._rows_per_point,
            time_s,
            self._lowest[0, :count],
            self._highest[0, :count],
            self._lowest[1, :count],
            self._highest[1, :count],
            self._rejected[:count],
        )


def is_rejected(status: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Tell which rows were not used though they hold something new.

    Parameters
    ----------
    status : numpy.ndarray
        Status bits, shape (rows,).

    Returns
    -------
    numpy.ndarray
        Rows with a fault other than that they repeat the row before, shape (rows,).
    """
    repeated = _core.StatusFlag.sample_repeated.value
    return np.asarray((status & np.uint32(_core.FAULT_MASK & ~repeated)) != 0)
