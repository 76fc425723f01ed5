"""Where a recording's motor turns back, and what rows after that gain."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.identify.moving_rows import turning_points

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: A reversal is one where the motor comes back by so many turns.
LEAST_RETURN_TURNS: Final = 1.0
#: Motor turns after a reversal that belong to it.
AFTER_TURNS: Final = 10.0


@dataclass(frozen=True)
class Reversals:
    """A recording's reversals.

    Attributes
    ----------
    turns_forward, turns_backward : float
        Motor turns in each direction.
    after : tuple of tuple of int
        For each reversal, first row after it and the row `AFTER_TURNS` later.
    """

    turns_forward: float
    turns_backward: float
    after: tuple[tuple[int, int], ...]

    @property
    def count(self) -> int:
        """Number of reversals."""
        return len(self.after)

    def sums_after(
        self, rows: NDArray[np.intp], values: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Add up what rows after each reversal have.

        The first reversal is left out: nothing was learned in that direction before.

        Parameters
        ----------
        rows : numpy.ndarray
            Numbers of rows, ascending, shape (rows,).
        values : numpy.ndarray
            One for each of them, shape (rows,).

        Returns
        -------
        numpy.ndarray
            One for each further reversal with rows.
        """
        sums = []
        for first, past in self.after[1:]:
            low, high = np.searchsorted(rows, (first, past))
            if high > low:
                sums.append(float(np.sum(values[low:high])))
        return np.array(sums)


def find_reversals(motor_angle_rad: NDArray[np.float64]) -> Reversals:
    """Find where the motor turns back.

    Parameters
    ----------
    motor_angle_rad : numpy.ndarray
        Angles of consecutive rows, shape (rows,), rad; rows without a number are passed over.

    Returns
    -------
    Reversals
        Of the recording.
    """
    known = np.flatnonzero(np.isfinite(motor_angle_rad))
    turned = motor_angle_rad[known] / (2 * np.pi)
    points = turning_points(turned, LEAST_RETURN_TURNS)
    after, forward, backward = [], 0.0, 0.0
    for number, (start, end) in enumerate(pairwise(points)):
        travel = float(turned[end] - turned[start])
        forward += max(travel, 0.0)
        backward += max(-travel, 0.0)
        if number:
            gone = np.maximum.accumulate(np.abs(turned[start : end + 1] - turned[start]))
            past = start + int(np.searchsorted(gone, AFTER_TURNS))
            after.append((int(known[start]), int(known[min(past, end)])))
    return Reversals(forward, backward, tuple(after))
