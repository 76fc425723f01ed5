"""Reads a table of measurements: mapped columns in base units, and texts such as a run's name."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from strainwave.errors import InputError
from strainwave.records.columns import find_columns
from strainwave.records.mapping import parse_columns
from strainwave.records.opening import open_recording
from strainwave.units import conversion

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.records.columns import FoundColumn
    from strainwave.records.mapping import MapKeys, MappedColumn
    from strainwave.records.raw import RawChunk, Recording
    from strainwave.units import Quantity

    CodesToVolts = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class Table:
    """A table of measurements.

    Attributes
    ----------
    source : str
        Name for messages.
    rows : int
        How many.
    values : dict
        Columns of numbers by key, in base units, shape (rows,); of keys that take several columns
        shape (rows, columns). NaN where a field is empty.
    texts : dict
        Columns of texts by key, a text for every row; empty where there is none.
    columns : dict
        What was mapped, by key.
    labels : dict
        What messages call the columns, by key.
    """

    source: str
    rows: int
    values: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    texts: dict[str, tuple[str, ...]] = field(default_factory=dict)
    columns: dict[str, tuple[MappedColumn, ...]] = field(default_factory=dict)
    labels: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def __contains__(self, key: object) -> bool:
        return key in self.columns

    def require_complete(self, keys: Iterable[str]) -> None:
        """Refuse a table with an empty field.

        Parameters
        ----------
        keys : iterable of str
            Keys of the columns that have to be complete; those that are not mapped are passed
            over.

        Raises
        ------
        InputError
            If a field is empty or not finite, with its row and column.
        """
        for key in keys:
            if key in self.texts:
                gaps = np.array([not text for text in self.texts[key]])[:, np.newaxis]
            elif key in self.values:
                gaps = ~np.isfinite(self.values[key].reshape(self.rows, -1))
            else:
                continue
            if gaps.any():
                row, column = np.argwhere(gaps)[0]
                what = "a text" if key in self.texts else "a number"
                raise InputError(
                    f"{self.source}: row {row + 1}, {self.labels[key][column]} for {key} is empty "
                    f"or no finite number; expected {what} in every row, so complete the row or "
                    "remove it"
                )


def read_table(
    path: Path,
    texts: Iterable[str],
    keys: MapKeys,
    *,
    required: Collection[str] = (),
    codes_to_volts: CodesToVolts | None = None,
) -> Table:
    """Read the mapped columns of a table, whole.

    Parameters
    ----------
    path : Path
        CSV or Parquet.
    texts : iterable of str
        What followed ``--map``, see `strainwave.records.mapping.parse_columns`.
    keys : MapKeys
        What may be mapped. Time is given in seconds since the first row.
    required : collection of str
        Keys without which nothing can be done.
    codes_to_volts : callable, optional
        Converts columns in ``counts``; without it they are refused.

    Returns
    -------
    Table
        The columns.

    Raises
    ------
    InputError
        If something required is not mapped, a column is missing or holds no numbers.
    """
    columns = parse_columns(texts, keys)
    return read_columns(
        open_recording(path), columns, keys, required=required, codes_to_volts=codes_to_volts
    )


def read_columns(
    recording: Recording,
    columns: dict[str, tuple[MappedColumn, ...]],
    keys: MapKeys,
    *,
    required: Collection[str] = (),
    codes_to_volts: CodesToVolts | None = None,
) -> Table:
    """Read columns that were mapped already; as `read_table`.

    Parameters
    ----------
    recording : Recording
        The table.
    columns : dict
        Columns by key.
    keys : MapKeys
        What may be mapped.
    required : collection of str
        Keys without which nothing can be done.
    codes_to_volts : callable, optional
        Converts columns in ``counts``.

    Returns
    -------
    Table
        The columns.

    Raises
    ------
    InputError
        As `read_table`.
    """
    for key in required:
        if key not in columns:
            raise InputError(
                f"--map: nothing is mapped for {key}; expected {key}=COLUMN, such as {keys.example}"
            )
    # A key with several columns is read column by column, under names that no key has.
    single = {
        (key, place): column
        for key, several in columns.items()
        for place, column in enumerate(several)
    }
    found = {
        name: find_columns(
            {name[0]: column}, recording.names, recording.column_count, recording.source
        )[name[0]]
        for name, column in single.items()
    }
    _refuse_twice(recording.source, found)
    numbers = {name: each for name, each in found.items() if keys.quantities[name[0]] is not None}
    texts = {key: recording.texts(found[key, 0]) for key in columns if keys.quantities[key] is None}
    time_unit = columns["time"][0].unit if "time" in columns else ""
    read, rows = _read_numbers(recording, numbers, time_unit)
    if not numbers and texts:
        rows = len(next(iter(texts.values())))
    values: dict[str, NDArray[np.float64]] = {}
    for key, several in columns.items():
        quantity = keys.quantities[key]
        if quantity is None:
            continue
        converted = [
            read[key, place] * found[key, place].sign
            if key == "time"
            else _converted(
                key, quantity, each, found[key, place].sign, read[key, place], codes_to_volts
            )
            for place, each in enumerate(several)
        ]
        values[key] = np.column_stack(converted) if key in keys.lists else converted[0]
    labels = {
        key: tuple(found[key, place].label for place in range(len(several)))
        for key, several in columns.items()
    }
    return Table(recording.source, rows, values, texts, dict(columns), labels)


def _refuse_twice(source: str, found: dict[tuple[str, int], FoundColumn]) -> None:
    seen: dict[int, tuple[str, int]] = {}
    for name, column in found.items():
        if column.index in seen:
            first = seen[column.index][0]
            keys = f"twice for {first}" if first == name[0] else f"for {first} and for {name[0]}"
            raise InputError(
                f"{source}: {column.label} is mapped {keys}; expected columns that differ, so "
                "correct --map"
            )
        seen[column.index] = name


def _read_numbers(
    recording: Recording, found: dict[tuple[str, int], FoundColumn], time_unit: str
) -> tuple[dict[tuple[str, int], NDArray[np.float64]], int]:
    if not found:
        return {}, 0
    names = {f"{key}+{place}" if place else key: (key, place) for key, place in found}
    parts: dict[tuple[str, int], list[NDArray[np.float64]]] = {name: [] for name in found}
    rows = 0
    origin: float | int | None = None
    for chunk, _ in recording.chunks({name: found[place] for name, place in names.items()}):
        rows += chunk.rows
        for name, place in names.items():
            if name == "time":
                stamps, origin = _since_first(chunk, origin, time_unit)
                parts[place].append(stamps)
            else:
                parts[place].append(chunk.values[name])
    return {name: np.concatenate(values) for name, values in parts.items()}, rows


def _since_first(
    chunk: RawChunk, origin: float | int | None, mapped_unit: str
) -> tuple[NDArray[np.float64], float | int | None]:
    """Seconds since the first stamp; stamps are subtracted before they lose digits."""
    assert chunk.time is not None
    stamps = chunk.time
    usable = ~stamps.missing
    if origin is None and usable.any():
        origin = stamps.values[int(np.argmax(usable))]
    since = np.where(usable, stamps.values, origin or 0) - (origin or 0)
    unit = conversion("time", stamps.unit or mapped_unit)
    assert unit is not None
    # Divided, because 3 ms / 1000 is 0.003 and 3 ms * 0.001 is not.
    return np.where(usable, since / float(round(1.0 / unit.factor)), np.nan), origin


def _converted(
    key: str,
    quantity: Quantity,
    column: MappedColumn,
    sign: int,
    values: NDArray[np.float64],
    codes_to_volts: CodesToVolts | None,
) -> NDArray[np.float64]:
    unit = conversion(quantity, column.unit)
    if unit is None:
        if codes_to_volts is None:
            raise InputError(
                f"--map: {key} is in counts, and nothing says what a count is; expected [gauges] "
                "with a converter in the joint file, so give --joint, or convert the column to V"
            )
        return sign * codes_to_volts(values)
    return sign * values * unit.factor + unit.offset
