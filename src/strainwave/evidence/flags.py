"""Rows that bear a flag: which they are, and what the flag says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Stretches of rows that are named for each flag.
MOST_STRETCHES: Final = 5

#: What each flag means, and what was done.
MEANINGS: Final = {
    "torque_not_finite": "No torque, or one beyond 1e15 Nm. The last good torque is held.",
    "rotation_invalid": "No angle or speed, or one beyond reach. The torque is passed on less the "
    "last ripple; nothing is learned.",
    "expected_torque_not_finite": "No expected torque. The row is filtered as if it were 0.",
    "gauge_saturated": "A converter code at an end of its range: the gauge reads no further.",
    "temperature_not_finite": "No temperature.",
    "sample_repeated": "Angle and torque are those of the row before: written again, not measured "
    "again. The result of the row before is held.",
    "sample_out_of_order": "No later than a row before it. The last good torque is held.",
    "time_not_finite": "No time. The last good torque is held.",
    "gauges_insufficient": "Too few gauges are sound for any set of gains. The last good torque is "
    "held.",
    "variance_limited": "The filter knew too little and was kept from forgetting more.",
    "covariance_reset": "The filter lost its footing and began anew.",
    "at_rest": "The motor hardly moves: the ripple is not learned, what is known of it is removed.",
    "samples_missing": "Rows are missing before this one. The angle is taken as it stands after it.",
    "order_above_nyquist": "An order turns by more than half a cycle from row to row: it cannot be "
    "followed there.",
    "temperature_out_of_range": "Outside the temperatures of the calibration.",
    "gauge_lost": "A gauge has failed for good; the torque is made without it.",
    "gauge_suspected": "A gauge reads wrong in this row; the torque is made without it.",
    "gauges_disagree": "The gauges do not agree, and no single one explains it: several of them, or "
    "the angle, may be wrong.",
}

#: Flags of rows that were not used though they hold something new, and why, after their number.
NOT_USED_BECAUSE: Final = {
    "torque_not_finite": "without torque",
    "rotation_invalid": "without angle or speed",
    "expected_torque_not_finite": "without expected torque",
    "gauge_saturated": "with a saturated gauge",
    "temperature_not_finite": "without temperature",
    "sample_out_of_order": "out of order in time",
    "time_not_finite": "without time",
    "gauges_insufficient": "with too few sound gauges",
}


@dataclass(frozen=True)
class Stretch:
    """Consecutive rows.

    Attributes
    ----------
    first_row, last_row : int
        From 1, as a person counts them.
    first_time_s : float
        Time of the first of them as the recording counts it, s; NaN where it has none.
    """

    first_row: int
    last_row: int
    first_time_s: float


@dataclass(frozen=True)
class FlaggedRows:
    """Rows that bear one flag.

    Attributes
    ----------
    name : str
        Name of the flag.
    kind : str
        "not used", "limited" or "remark".
    meaning : str
        What it says, and what was done.
    rows : int
        How many.
    stretches : tuple of Stretch
        The first `MOST_STRETCHES` stretches of such rows.
    """

    name: str
    kind: str
    meaning: str
    rows: int
    stretches: tuple[Stretch, ...]


class FlagTally:
    """Takes status bits chunk by chunk; how they are cut makes no difference."""

    def __init__(self) -> None:
        self._row = 0
        self._counts = dict.fromkeys(_core.StatusFlag, 0)
        self._stretches: dict[_core.StatusFlag, list[Stretch]] = {
            flag: [] for flag in _core.StatusFlag
        }

    def take(self, log_time_s: NDArray[np.float64], status: NDArray[np.uint32]) -> None:
        """Take the next rows.

        Parameters
        ----------
        log_time_s : numpy.ndarray
            Time, shape (rows,), s.
        status : numpy.ndarray
            Status bits, shape (rows,).
        """
        for flag in _core.StatusFlag:
            bears = (status & np.uint32(flag.value)) != 0
            count = int(np.count_nonzero(bears))
            if count:
                self._counts[flag] += count
                self._note(self._stretches[flag], bears, log_time_s)
        self._row += len(status)

    def _note(
        self, stretches: list[Stretch], bears: NDArray[np.bool_], log_time_s: NDArray[np.float64]
    ) -> None:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], bears, [False]])))
        # One more than is shown: the last one that is shown may go on in the next chunk.
        for first, past in edges.reshape(-1, 2)[: MOST_STRETCHES + 1]:
            row, last = self._row + int(first) + 1, self._row + int(past)
            if stretches and stretches[-1].last_row == row - 1:
                before = stretches.pop()
                stretches.append(Stretch(before.first_row, last, before.first_time_s))
            elif len(stretches) <= MOST_STRETCHES:
                stretches.append(Stretch(row, last, float(log_time_s[first])))

    def finish(self) -> tuple[FlaggedRows, ...]:
        """Give every flag that a row bears.

        Returns
        -------
        tuple of FlaggedRows
            By the number of the flag: faults first.
        """
        return tuple(
            FlaggedRows(
                str(flag.name),
                _kind(flag.value),
                MEANINGS[str(flag.name)],
                self._counts[flag],
                tuple(self._stretches[flag][:MOST_STRETCHES]),
            )
            for flag in sorted(_core.StatusFlag, key=lambda each: each.value)
            if self._counts[flag]
        )


def _kind(bit: int) -> str:
    if bit & _core.FAULT_MASK:
        return "not used"
    return "limited" if bit & _core.LIMIT_MASK else "remark"
