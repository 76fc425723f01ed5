"""What a fit over temperature leaves while the sensor warms, against what it leaves while it cools."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Rows of one branch in a part of the range, and parts of it, to compare warming with cooling.
_LEAST_BRANCH_ROWS: Final = 2
_BRANCH_PARTS: Final = 6
#: With fewer readings than these one of a branch is enough in a part.
_FEW_READINGS: Final = 50


def warming_less_cooling(
    temperature: NDArray[np.float64], left: NDArray[np.float64]
) -> float | None:
    """Compare what a fit leaves in parts of the temperature's range, warming against cooling.

    Parameters
    ----------
    temperature : numpy.ndarray
        In the order in which readings were taken, shape (rows,), any unit.
    left : numpy.ndarray
        What is left of each, shape (rows,).

    Returns
    -------
    float or None
        Largest difference of the means in one part, in the unit of `left`; None where no part has
        both.
    """
    low, high = float(temperature.min()), float(temperature.max())
    turns = _branches(temperature, 0.1 * (high - low))
    part = np.minimum((temperature - low) / (high - low) * _BRANCH_PARTS, _BRANCH_PARTS - 1)
    differences = []
    for number in range(_BRANCH_PARTS):
        here = np.floor(part) == number
        sides = [left[here & (turns == sense)] for sense in (1, -1)]
        if min(map(len, sides)) >= _LEAST_BRANCH_ROWS or (
            len(left) < _FEW_READINGS and min(map(len, sides)) >= 1
        ):
            differences.append(abs(float(sides[0].mean() - sides[1].mean())))
    return max(differences) if differences else None


def _branches(temperature: NDArray[np.float64], least_K: float) -> NDArray[np.int64]:
    """Tell warming (1) from cooling (-1): a branch ends where the temperature comes back by so much."""
    senses = np.zeros(len(temperature), np.int64)
    start = extreme = 0
    sense = 0
    for row, value in enumerate(temperature.tolist()):
        if sense == 0:
            if abs(value - temperature[0]) > least_K:
                sense, extreme = (1 if value > temperature[0] else -1), row
            continue
        if sense * (value - temperature[extreme]) > 0:
            extreme = row
        elif sense * (temperature[extreme] - value) > least_K:
            senses[start : extreme + 1] = sense
            start, sense, extreme = extreme + 1, -sense, row
    senses[start:] = sense
    return senses
