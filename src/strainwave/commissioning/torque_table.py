"""Reads a table of loads and volts: mapped columns, or a sheet of `strainwave calibrate plan`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.loadings import Loadings, paths
from strainwave.commissioning.loading_plan import PRELOAD, SHEET_MAP, TEMPERATURE, is_sheet
from strainwave.errors import InputError
from strainwave.records.mapping import MapKeys, parse_columns
from strainwave.records.opening import open_recording
from strainwave.records.table import Table, read_columns

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.records.raw import Recording
    from strainwave.records.table import CodesToVolts

SIDE_LOADS: Final = ("axial-force", "radial-force", "tilting-moment")

LOAD_KEYS: Final = MapKeys(
    {
        "load": "torque",
        "voltage": "voltage",
        "experiment": None,
        "position": "angle",
        "temperature": "temperature",
        "direction": None,
        "mounting": None,
        "phase": None,
        "axial-force": "force",
        "radial-force": "force",
        "tilting-moment": "torque",
    },
    example="--map load=load_Nm,voltage=bridge_V,experiment=run",
)
"""What a table of loads may hold."""

_REQUIRED: Final = ("load", "voltage", "experiment")
#: Words in the column of directions: how the load was reached, or its sense.
_HOW: Final = {
    "up": 1,
    "increasing": 1,
    "loading": 1,
    "down": -1,
    "decreasing": -1,
    "unloading": -1,
}
_SENSE: Final = {"+": 1, "+1": 1, "1": 1, "positive": 1, "-": -1, "-1": -1, "negative": -1}
_LARGEST_TURN_IN_ONE: Final = np.radians(2.0)
_LISTED: Final = 8


@dataclass(frozen=True)
class LoadTable:
    """A table of loads.

    Attributes
    ----------
    loadings : Loadings
        Its experiments.
    rows : numpy.ndarray
        Row of the table of each of theirs, counted from 1, shape (rows,).
    is_sheet : bool
        Whether it is a filled sheet of `strainwave calibrate plan`.
    remarks : tuple of str
        What a person should know of how it was read.
    position_unit : str
        Unit in which positions were mapped; "" without.
    temperature_span_K : float
        Largest change of temperature within an experiment; 0 where none is mapped.
    """

    loadings: Loadings
    rows: NDArray[np.intp]
    is_sheet: bool
    remarks: tuple[str, ...]
    position_unit: str
    temperature_span_K: float


def read_load_table(
    path: Path, texts: Sequence[str], codes_to_volts: CodesToVolts | None = None
) -> LoadTable:
    """Read a table of loads.

    Parameters
    ----------
    path : Path
        CSV or Parquet.
    texts : sequence of str
        What followed ``--map``; nothing for a sheet of `strainwave calibrate plan`.
    codes_to_volts : callable, optional
        Converts volts given in ``counts``.

    Returns
    -------
    LoadTable
        Its experiments.

    Raises
    ------
    InputError
        If nothing is mapped and it is no such sheet, a row is not complete, or rows contradict each
        other.
    """
    recording = open_recording(path)
    sheet = not texts and is_sheet(recording.names)
    if not texts and not sheet:
        raise InputError(
            f"{recording.source}: nothing is mapped, and it is no sheet of `strainwave calibrate "
            f"plan`; expected --map with {', '.join(_REQUIRED)}, such as {LOAD_KEYS.example}"
        )
    columns = parse_columns(SHEET_MAP if sheet else texts, LOAD_KEYS)
    table = read_columns(
        recording, columns, LOAD_KEYS, required=_REQUIRED, codes_to_volts=codes_to_volts
    )
    remarks: list[str] = []
    kept = _measured_rows(table)
    if sheet:
        kept, has_temperature = _filled_rows(recording, table, kept, remarks)
        if not has_temperature:
            table.values.pop("temperature", None)
            table.columns.pop("temperature", None)
    if not kept.any():
        raise InputError(
            f"{table.source}: none of its {table.rows} rows is a measurement; expected rows with "
            "load, voltage and experiment, so fill them in"
        )
    table = _only(table, kept)
    table.require_complete(key for key in table.columns if key != "phase")
    return _loads(table, np.flatnonzero(kept) + 1, remarks, is_filled_sheet=sheet)


def _measured_rows(table: Table) -> NDArray[np.bool_]:
    if "phase" not in table:
        return np.ones(table.rows, np.bool_)
    return np.array([text.lower() != PRELOAD for text in table.texts["phase"]], np.bool_)


def _filled_rows(
    recording: Recording, table: Table, kept: NDArray[np.bool_], remarks: list[str]
) -> tuple[NDArray[np.bool_], bool]:
    """Rows of experiments that are filled in, and whether temperatures are."""
    empty = kept & ~np.isfinite(table.values["voltage"])
    names = np.array(table.texts["experiment"])
    begun = {str(name) for name in names[kept & ~empty]}
    unfinished = np.flatnonzero(empty & np.isin(names, list(begun)))
    if not begun:
        raise InputError(
            f"{recording.source}: no voltage is filled in; expected volts in the column voltage_V "
            "of every row to be measured, so fill in the sheet"
        )
    if len(unfinished):
        raise InputError(
            f"{recording.source}: experiment {names[unfinished[0]]} is not filled in to its end, "
            f"voltage_V is empty in {_listed(unfinished + 1)}; expected volts in all rows of an "
            "experiment or in none, so complete these rows, or empty the others to leave it out"
        )
    left_out = [str(name) for name in dict.fromkeys(names[kept]) if str(name) not in begun]
    if left_out:
        remarks.append(
            f"experiment {', '.join(left_out)} of the sheet is not filled in and was left out"
            if len(left_out) == 1
            else f"experiments {', '.join(left_out)} of the sheet are not filled in and were left "
            "out"
        )
    kept = kept & np.isin(names, list(begun))
    told = np.isfinite(table.values[TEMPERATURE])
    if np.any(told & kept) and not np.all(told[kept]):
        missing = np.flatnonzero(kept & ~told) + 1
        raise InputError(
            f"{recording.source}: temperature_degC is filled in for some rows and empty in "
            f"{_listed(missing)}; expected it in every measured row or in none, so complete it"
        )
    return kept, bool(np.all(told[kept]))


def _listed(rows: NDArray[np.intp]) -> str:
    shown = ", ".join(str(row) for row in rows[:_LISTED])
    more = f" and {len(rows) - _LISTED} more" if len(rows) > _LISTED else ""
    return f"row{'s' if len(rows) > 1 else ''} {shown}{more}"


def _only(table: Table, kept: NDArray[np.bool_]) -> Table:
    return Table(
        table.source,
        int(np.count_nonzero(kept)),
        {key: values[kept] for key, values in table.values.items()},
        {
            key: tuple(text for text, stays in zip(texts, kept, strict=True) if stays)
            for key, texts in table.texts.items()
        },
        table.columns,
        table.labels,
    )


def _loads(
    table: Table, rows: NDArray[np.intp], remarks: list[str], *, is_filled_sheet: bool
) -> LoadTable:
    texts = table.texts["experiment"]
    names = tuple(dict.fromkeys(texts))
    experiment = np.array([names.index(text) for text in texts], np.intp)
    load = table.values["load"]
    if not np.any(load):
        raise InputError(
            f"{table.source}: {table.labels['load'][0]} for load is 0 in all rows; expected known "
            "torques, so check the column"
        )
    increasing, load = _directions(table, load, rows)
    path = np.empty(len(load), np.int8)
    for index in range(len(names)):
        mine = experiment == index
        path[mine] = paths(load[mine], None if increasing is None else increasing[mine])
    temperature, span = None, 0.0
    if "temperature" in table.values:
        temperature, span = _temperatures(table.values["temperature"], experiment, len(names))
    loadings = Loadings(
        names,
        experiment,
        load,
        table.values["voltage"],
        path,
        _positions(table, names, experiment),
        temperature,
        _mountings(table, names, experiment),
        {name: table.values[name] for name in SIDE_LOADS if name in table},
    )
    unit = table.columns["position"][0].unit if "position" in table else ""
    return LoadTable(loadings, rows, is_filled_sheet, tuple(remarks), unit, span)


def _directions(
    table: Table, load: NDArray[np.float64], rows: NDArray[np.intp]
) -> tuple[NDArray[np.int8] | None, NDArray[np.float64]]:
    if "direction" not in table:
        return None, load
    words = [text.lower() for text in table.texts["direction"]]
    for known in (_HOW, _SENSE):
        if words[0] in known:
            break
    else:
        known = _HOW
    for row, word in zip(rows, words, strict=True):
        if word not in known:
            other = "" if words[0] not in known else f" as in row {rows[0]}"
            expected = known if other else [*_HOW, *_SENSE]
            raise InputError(
                f"{table.source}: row {row}, {table.labels['direction'][0]} for direction is "
                f"{word!r}; expected one of {', '.join(expected)}{other}: how the load was "
                "reached, or the sense of the torque; correct the column"
            )
    told = np.array([known[word] for word in words], np.int8)
    if known is _HOW:
        return told, load
    if np.any(load < 0):
        wrong = np.flatnonzero(load * told < 0)
        if len(wrong):
            raise InputError(
                f"{table.source}: row {rows[wrong[0]]} has the load {load[wrong[0]]:g} Nm and the "
                f"direction {words[wrong[0]]!r}; expected loads with the sign of the direction, or "
                "magnitudes in all rows, so correct one of them"
            )
        return None, load
    return None, load * told


def _temperatures(
    values: NDArray[np.float64], experiment: NDArray[np.intp], count: int
) -> tuple[NDArray[np.float64], float]:
    means = np.bincount(experiment, values) / np.bincount(experiment)
    span = max(float(np.ptp(values[experiment == index])) for index in range(count))
    return means, span


def _positions(
    table: Table, names: tuple[str, ...], experiment: NDArray[np.intp]
) -> NDArray[np.float64] | None:
    if "position" not in table:
        return None
    values = table.values["position"]
    for index, name in enumerate(names):
        mine = values[experiment == index]
        if np.ptp(mine) > _LARGEST_TURN_IN_ONE:
            raise InputError(
                f"{table.source}: experiment {name} has positions from {np.degrees(mine.min()):g} "
                f"to {np.degrees(mine.max()):g} deg; expected the wave generator locked at one "
                "position during an experiment, so give what was measured at another position a "
                "name of its own"
            )
    return np.asarray(np.bincount(experiment, values) / np.bincount(experiment))


def _mountings(
    table: Table, names: tuple[str, ...], experiment: NDArray[np.intp]
) -> tuple[str, ...] | None:
    if "mounting" not in table:
        return None
    texts = np.array(table.texts["mounting"])
    found = []
    for index, name in enumerate(names):
        mine = np.unique(texts[experiment == index])
        if len(mine) > 1:
            raise InputError(
                f"{table.source}: experiment {name} has the mountings {mine[0]} and {mine[1]}; "
                "expected one mounting in each experiment, so give what was measured after a new "
                "mounting a name of its own"
            )
        found.append(str(mine[0]))
    return tuple(found)
