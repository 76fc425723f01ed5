"""How fast the motor turns, from angles and time stamps, chunk by chunk."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.arrays import steps

if TYPE_CHECKING:
    from numpy.typing import NDArray


class BackwardDifference:
    """Motor speed of a row: the angle since the last known row over the time since then.

    Causal: the speed of a row is the mean over the interval that ends with it, which is half an
    interval old. The last known row is carried from chunk to chunk. Real time stamps are used, so
    that jitter and gaps leave the speed right.
    """

    def __init__(self) -> None:
        self._time_s = np.nan
        self._angle_rad = np.nan

    def speeds(
        self, time_s: NDArray[np.float64], angle_rad: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Differentiate the next rows.

        Parameters
        ----------
        time_s : numpy.ndarray
            Time stamps, shape (rows,), s.
        angle_rad : numpy.ndarray
            Motor angle, shape (rows,), rad, not wrapped; NaN where it is not known.

        Returns
        -------
        numpy.ndarray
            Motor speed, shape (rows,), rad/s. 0 at the first row with an angle; NaN where the angle
            or the time is not known, or where time does not advance.
        """
        of_all = self._of_known_rows(time_s, angle_rad)
        if of_all is not None:
            return of_all
        time_s = np.concatenate([[self._time_s], time_s])
        angle_rad = np.concatenate([[self._angle_rad], angle_rad])
        known = np.isfinite(time_s) & np.isfinite(angle_rad)
        # The last known row at or before each row; -1 where there is none yet.
        last = np.maximum.accumulate(np.where(known, np.arange(len(known)), -1))
        before = last[:-1]
        start = np.maximum(before, 0)
        speed_rad_s = np.full(len(before), np.nan)
        with np.errstate(over="ignore"):  # beyond all reach, which the core flags
            interval_s = time_s[1:] - time_s[start]
            usable = known[1:] & (before >= 0) & (interval_s > 0.0)
            travel_rad = angle_rad[1:] - angle_rad[start]
            np.divide(travel_rad, interval_s, out=speed_rad_s, where=usable)
        speed_rad_s[known[1:] & (before < 0)] = 0.0
        if last[-1] >= 0:
            self._time_s = time_s[last[-1]]
            self._angle_rad = angle_rad[last[-1]]
        return speed_rad_s

    def _of_known_rows(
        self, time_s: NDArray[np.float64], angle_rad: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """Speeds where time goes on and all is known, the last row of before too; else None."""
        if not len(time_s) or not np.isfinite(time_s[-1]):
            return None
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            interval_s = steps(time_s, self._time_s)
            speed_rad_s = steps(angle_rad, self._angle_rad)
            speed_rad_s /= interval_s
        # What is not a number, or infinite, shows in a speed.
        if not ((interval_s > 0.0).all() and np.isfinite(speed_rad_s).all()):
            return None
        self._time_s, self._angle_rad = float(time_s[-1]), float(angle_rad[-1])
        return speed_rad_s
