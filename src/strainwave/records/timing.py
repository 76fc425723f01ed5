"""What the time stamps of a recording say: rate, jitter, gaps, and rows out of order."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.arrays import steps
from strainwave.records.histogram import LogHistogram

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.records.conversion import Columns

BIN_SHARE: Final = 0.0023
"""Quantiles are known to so much of themselves."""
GAP_INTERVALS: Final = 10.0
"""An interval of more than so many median ones is a gap."""
GAP_S: Final = 0.5
"""An interval longer than this is a gap, in s, unless the recording is that slow."""
#: An interval is longer than another one from this multiple on: rounding is none.
_LONGER: Final = 1.001


@dataclass(frozen=True)
class Timing:
    """What the time stamps say.

    Attributes
    ----------
    duration_s : float
        From the earliest to the latest stamp, s.
    median_interval_s, smallest_interval_s, largest_interval_s : float or None
        Between a row and the latest one before it, s; None where time never goes on.
    interval_1st_percentile_s, interval_99th_percentile_s : float or None
        Between them lie 98 percent of the intervals, s.
    gaps : int
        Intervals of more than ten median ones, or more than half a second.
    first_gap_row : int or None
        The row after the first of them, from 1.
    out_of_order_rows : int
        Rows that are no later than an earlier one.
    first_out_of_order_row : int or None
        The first of them, from 1.
    backward_steps, forward_steps : int
        How often a row is earlier, and later, than the row before it.
    intervals : int
        How many intervals there are.
    """

    duration_s: float
    median_interval_s: float | None
    smallest_interval_s: float | None
    largest_interval_s: float | None
    interval_1st_percentile_s: float | None
    interval_99th_percentile_s: float | None
    gaps: int
    first_gap_row: int | None
    out_of_order_rows: int
    first_out_of_order_row: int | None
    backward_steps: int
    forward_steps: int
    intervals: int

    @property
    def rate_Hz(self) -> float | None:
        """Rows a second, from the median interval, Hz."""
        return None if self.median_interval_s is None else 1.0 / self.median_interval_s

    @property
    def rate_standard_uncertainty_Hz(self) -> float | None:
        """Standard uncertainty of the rate, Hz: that of a median; 0 where stamps are regular."""
        median_s = self.median_interval_s
        early_s, late_s = self.interval_1st_percentile_s, self.interval_99th_percentile_s
        if median_s is None or early_s is None or late_s is None:
            return None
        # A normal distribution has 98 % within 4.65 deviations; a bin of the histogram has 0.23 %.
        spread_s = (late_s - early_s) / 4.65
        if spread_s <= 1e-6 * median_s:
            return 0.0
        bin_s = BIN_SHARE * median_s / math.sqrt(12.0)
        deviation_s = math.hypot(1.2533 * spread_s / math.sqrt(max(1, self.intervals)), bin_s)
        return deviation_s / median_s**2


class TimingTally:
    """Takes time stamps chunk by chunk."""

    def __init__(self) -> None:
        self._intervals = LogHistogram()
        self._earliest = np.inf
        self._latest = -np.inf
        self._previous = np.nan
        # Every interval longer than all before it: the first gap is among them, whatever the limit.
        self._records: list[tuple[int, float]] = []
        self._out_of_order = 0
        self._first_out_of_order: int | None = None
        self._backward = 0
        self._forward = 0

    def take(self, columns: Columns) -> NDArray[np.bool_]:
        """Take the next rows.

        Parameters
        ----------
        columns : Columns
            The rows that follow those of the last call.

        Returns
        -------
        numpy.ndarray
            Which rows are later than every row before them, shape (rows,).
        """
        time_s = columns.time_s
        if self._goes_on(columns):
            return np.ones(len(time_s), np.bool_)
        known = np.isfinite(time_s)
        changes = steps(time_s[known], self._previous)
        self._backward += int((changes < 0.0).sum())
        self._forward += int((changes > 0.0).sum())
        latest = np.maximum.accumulate(np.append(self._latest, np.where(known, time_s, -np.inf)))
        in_order = known & (time_s > latest[:-1])
        self._note_out_of_order(np.flatnonzero(known & ~in_order), columns.first_row)
        stamps = time_s[in_order]
        if len(stamps):
            before = self._latest if np.isfinite(self._latest) else stamps[0]
            intervals = steps(stamps, before)
            self._note_records(intervals, columns.first_row, np.flatnonzero(in_order))
            self._intervals.add(intervals[intervals > 0.0])
            self._latest = float(stamps[-1])
        if known.any():
            self._earliest = min(self._earliest, float(time_s[known].min()))
            self._previous = float(time_s[known][-1])
        return in_order

    def _goes_on(self, columns: Columns) -> bool:
        """Take rows that are each later than the one before; else take nothing, and return False."""
        time_s = columns.time_s
        if not len(time_s) or self._previous != self._latest or not np.isfinite(time_s[-1]):
            return False
        intervals = steps(time_s, self._latest)
        if not (intervals > 0.0).all():
            return False
        self._forward += len(intervals)
        self._note_records(intervals, columns.first_row)
        self._intervals.add(intervals)
        self._latest = self._previous = float(time_s[-1])
        return True

    def _note_out_of_order(self, places: NDArray[np.intp], first_row: int) -> None:
        self._out_of_order += len(places)
        if len(places) and self._first_out_of_order is None:
            self._first_out_of_order = int(places[0]) + first_row

    def _note_records(
        self,
        intervals: NDArray[np.float64],
        first_row: int,
        places: NDArray[np.intp] | None = None,
    ) -> None:
        longest = self._records[-1][1] if self._records else 0.0
        if intervals.max() <= longest * _LONGER:
            return
        before = np.maximum.accumulate(np.append(longest, intervals))[:-1]
        for at in np.flatnonzero(intervals > before * _LONGER):
            place = at if places is None else places[at]
            self._records.append((int(place) + first_row, float(intervals[at])))

    def finish(self) -> Timing:
        """Say what the stamps say.

        Returns
        -------
        Timing
            Of all rows that were taken.
        """
        intervals = self._intervals
        median_s = intervals.quantile(0.5)
        some = median_s is not None
        gaps, first_gap = 0, None
        if median_s is not None:
            limit_s = min(GAP_INTERVALS * median_s, max(GAP_S, 2.0 * median_s))
            gaps = intervals.count_above(limit_s)
            first_gap = next((row for row, interval in self._records if interval > limit_s), None)
        return Timing(
            duration_s=max(0.0, self._latest - self._earliest) if some else 0.0,
            median_interval_s=median_s,
            smallest_interval_s=intervals.smallest if some else None,
            largest_interval_s=intervals.largest if some else None,
            interval_1st_percentile_s=intervals.quantile(0.01),
            interval_99th_percentile_s=intervals.quantile(0.99),
            gaps=gaps if first_gap is not None else 0,
            first_gap_row=first_gap,
            out_of_order_rows=self._out_of_order,
            first_out_of_order_row=self._first_out_of_order,
            backward_steps=self._backward,
            forward_steps=self._forward,
            intervals=intervals.count,
        )
