"""Finds the mapped columns in a recording, and says what is near where one is missing."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from strainwave.records.mapping import MappedColumn

_LISTED = 12


@dataclass(frozen=True)
class FoundColumn:
    """A mapped column as it stands in a recording.

    Attributes
    ----------
    index : int
        Its place, from 0.
    label : str
        What messages call it.
    sign : int
        1, or -1 where the column is to be turned round.
    """

    index: int
    label: str
    sign: int


def find_columns(
    mapping: Mapping[str, MappedColumn], names: Sequence[str] | None, count: int, source: str
) -> dict[str, FoundColumn]:
    """Find every mapped column.

    Parameters
    ----------
    mapping : mapping
        Columns by key.
    names : sequence of str or None
        Names of the recording's columns; None where it has none.
    count : int
        Number of the recording's columns.
    source : str
        Name of the recording, for messages.

    Returns
    -------
    dict
        What was found, by key.

    Raises
    ------
    InputError
        If a column is missing, or its name is there twice.
    """
    return {key: _find(key, column, names, count, source) for key, column in mapping.items()}


def _find(
    key: str, mapped: MappedColumn, names: Sequence[str] | None, count: int, source: str
) -> FoundColumn:
    wanted = mapped.column
    if isinstance(wanted, str):
        # A name to the letter comes first: a column may be called "-tau" or "3".
        readings: list[tuple[str | int, int]] = [(wanted, mapped.sign)]
        if not mapped.quoted:
            bare, sign = wanted, int(mapped.sign)
            if wanted.startswith("-") and len(wanted) > 1:
                bare, sign = wanted[1:].strip(), -sign
                readings.append((bare, sign))
            if bare.isascii() and bare.isdigit():
                readings.append((int(bare), sign))
    else:
        readings = [(wanted, mapped.sign)]
    for reading, sign in readings:
        if isinstance(reading, str):
            index = _index_of(key, reading, names, source)
            if index is not None:
                return FoundColumn(index, f"column {reading!r}", sign)
        elif 1 <= reading <= count:
            return FoundColumn(reading - 1, f"column {reading}", sign)
    raise InputError(f"{source}: {_missing(key, wanted, names, count)}")


def _index_of(key: str, name: str, names: Sequence[str] | None, source: str) -> int | None:
    if names is None or name not in names:
        return None
    if list(names).count(name) > 1:
        places = [str(place) for place, other in enumerate(names, 1) if other == name]
        raise InputError(
            f"{source}: the column {name!r} for {key} is there {len(places)} times (columns "
            f"{', '.join(places)}); expected names that differ, so rename one of them or map the "
            "column by its number"
        )
    return list(names).index(name)


def _missing(key: str, wanted: str | int, names: Sequence[str] | None, count: int) -> str:
    if isinstance(wanted, int) or names is None:
        unnamed = "" if names is not None else ", and its columns have no names"
        return (
            f"there is no column {wanted!r} for {key}; the recording has {count} columns{unnamed}; "
            f"expected a number from 1 to {count}, such as --map {key}=1"
        )
    bare = wanted.removeprefix("-")
    lowered = {name.lower(): name for name in names}
    near = [
        lowered[name] for name in difflib.get_close_matches(bare.lower(), lowered, n=3, cutoff=0.5)
    ]
    if near:
        advice = f"did you mean {' or '.join(map(repr, near))}?"
    else:
        shown = ", ".join(map(repr, names[:_LISTED]))
        more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
        advice = f"its columns are {shown}{more}"
    return (
        f"there is no column {wanted!r} for {key}; expected the name of one of its {count} columns; "
        f"{advice}"
    )
