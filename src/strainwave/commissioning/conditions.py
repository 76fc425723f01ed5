"""Loads and temperatures of a run: which rows belong to one condition."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.records.table import Table

#: Gap between neighbouring values, as a share of their whole range, that separates two levels.
LEAST_GAP: Final = 0.1
#: Share of all rows below which a level is none and goes to the next one.
FEWEST_ROWS: Final = 0.02
#: Rows of a stretch below which it is passed over: where a level begins or ends, rows stray.
SHORTEST_STRETCH: Final = 20


@dataclass(frozen=True)
class Condition:
    """Rows at one load and temperature.

    Attributes
    ----------
    name : str
        For messages and tables; empty where there is one condition only.
    rows : numpy.ndarray
        Indices of its rows, rising.
    stretches : numpy.ndarray
        Number of the uninterrupted stretch each of them is in.
    load_Nm, temperature_degC : float or None
        Means over the rows, where they were recorded.
    """

    name: str
    rows: NDArray[np.int64]
    stretches: NDArray[np.int64]
    load_Nm: float | None
    temperature_degC: float | None


def conditions_of(table: Table) -> tuple[tuple[Condition, ...], tuple[str, ...]]:
    """Divide a table into conditions: by experiment, or by levels of load and temperature.

    Parameters
    ----------
    table : Table
        With or without columns for ``experiment``, ``load``, ``temperature``.

    Returns
    -------
    tuple
        At least one condition, in order of appearance; and what to say about them.
    """
    said: list[str] = []
    if "experiment" in table.texts:
        labels = np.unique(np.array(table.texts["experiment"]), return_inverse=True)[1]
    else:
        labels = np.zeros(table.rows, dtype=int)
        for key, unit in (("load", "Nm"), ("temperature", "degC")):
            if key not in table.values:
                continue
            levels = _levels(table.values[key])
            if levels.max() == 0:
                low, high = table.values[key].min(), table.values[key].max()
                said.append(
                    f"the {key}, {low:g} to {high:g} {unit}, shows no separate levels and is taken "
                    "as one: hold it at a few levels, or tell them apart with experiment=COLUMN"
                )
            labels = labels * (levels.max() + 1) + levels
    order = [int(label) for label in dict.fromkeys(labels.tolist())]
    found = [
        _condition(table, np.flatnonzero(labels == label), is_one_of_many=len(order) > 1)
        for label in order
    ]
    return tuple(found), tuple(said)


def _levels(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Find the level of each value; levels are apart by gaps."""
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    gap = LEAST_GAP * (ordered[-1] - ordered[0])
    numbers = np.concatenate([[0], np.cumsum((np.diff(ordered) > gap) & (gap > 0))])
    # A few stray rows are no level of their own.
    counts = np.bincount(numbers)
    kept = np.flatnonzero(counts >= FEWEST_ROWS * len(values))
    middles = np.bincount(numbers, ordered) / counts
    nearest = np.argmin(np.abs(middles[numbers][:, np.newaxis] - middles[kept]), axis=1)
    levels = np.empty(len(values), dtype=np.int64)
    levels[order] = nearest
    return levels


def _condition(table: Table, rows: NDArray[np.int64], *, is_one_of_many: bool) -> Condition:
    load = float(table.values["load"][rows].mean()) if "load" in table.values else None
    degrees = (
        float(table.values["temperature"][rows].mean()) if "temperature" in table.values else None
    )
    words = []
    if "experiment" in table.texts:
        words.append(table.texts["experiment"][rows[0]])
    if load is not None:
        words.append(f"{load:.3g} Nm")
    if degrees is not None:
        words.append(f"{degrees:.3g} degC")
    stretches = np.concatenate([[0], np.cumsum(np.diff(rows) > 1)])
    lengths = np.bincount(stretches)[stretches]
    kept = lengths >= min(SHORTEST_STRETCH, lengths.max())
    return Condition(
        name=", ".join(words) if is_one_of_many else "",
        rows=rows[kept],
        stretches=stretches[kept],
        load_Nm=load,
        temperature_degC=degrees,
    )
