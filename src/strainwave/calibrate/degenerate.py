"""Why gains against a fluctuation are worth nothing, and what would help."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: Length of the sum of a harmonic's phasors over the sum of lengths from which it looks like torque.
LIKE_TORQUE: Final = 0.9
#: Smaller over larger extent of a harmonic's phasors below which they lie on a line.
ON_A_LINE: Final = 0.1
#: Share of the median amplitude below which a gauge hardly sees the wave.
HARDLY_SEES: Final = 0.1


def reasons(conditions: NDArray[np.float64], harmonics: Sequence[int]) -> tuple[str, ...]:
    """Say what in the phasors makes gains useless.

    Parameters
    ----------
    conditions : numpy.ndarray
        Sine and cosine rows, harmonic by harmonic and, with several runs, run after run, shape
        (2 harmonics runs, gauges).
    harmonics : sequence of int
        Numbers of the harmonics, from 1.

    Returns
    -------
    tuple of str
        A clause for each reason that was found, without repetition.
    """
    found: list[str] = []
    for place in range(len(conditions) // 2):
        pair = conditions[2 * place : 2 * place + 2]
        harmonic = harmonics[place % len(harmonics)]
        for clause in _of_one(pair, harmonic):
            if clause not in found:
                found.append(clause)
    return tuple(found)


def _of_one(pair: NDArray[np.float64], harmonic: int) -> list[str]:
    lengths = np.hypot(*pair)
    gauges = pair.shape[1]
    total = float(lengths.sum())
    if total == 0:
        return []
    found = [
        f"gauge {j + 1} hardly sees harmonic {harmonic}, so check its wiring and that it turns "
        "against the wave"
        for j in np.flatnonzero(lengths < HARDLY_SEES * np.median(lengths))
    ]
    if np.hypot(*pair.sum(axis=1)) > LIKE_TORQUE * total:
        found.append(
            f"harmonic {harmonic} has nearly one phase on all {gauges} gauges, as torque has "
            "(equally spaced gauges see every multiple of their number so): compensate fewer "
            f"harmonics, or use a number of gauges that does not divide {harmonic}"
        )
    else:
        extent = np.linalg.svd(pair / total, compute_uv=False)
        if gauges > 2 and extent[1] < ON_A_LINE * extent[0]:
            found.append(
                f"the phasors of harmonic {harmonic} lie on one line: move a gauge off it, by an "
                f"eighth of a turn over {harmonic}"
            )
    return found
