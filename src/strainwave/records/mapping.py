"""The option ``--map``: which column of a recording holds which signal, and in which unit."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal

from strainwave.errors import InputError
from strainwave.units import BASE_UNITS, Quantity, allowed_units, check_unit

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

QUANTITIES: Final[dict[str, Quantity]] = {
    "time": "time",
    "angle": "angle",
    "motor-angle": "angle",
    "speed": "speed",
    "torque": "torque",
    "expected-torque": "torque",
    "temperature": "temperature",
}
"""What can be mapped, and the quantity that decides on the units."""

_EXAMPLE: Final = "--map time=t_s,angle=q:deg,torque=tau_Nm"
_RESERVED = ',+:="'
_QUOTED = re.compile(r'"((?:[^"]|"")*)"')


@dataclass(frozen=True)
class MappedColumn:
    """Where a signal is found in a recording.

    Attributes
    ----------
    column : str or int
        Name of the column, or its number counted from 1.
    unit : str
        Unit of the column, one of `strainwave.units.allowed_units`.
    sign : {1, -1}
        -1 where the column counts against the positive direction.
    quoted : bool
        The name is meant to the letter: neither a leading minus nor digits are read as anything
        else.
    """

    column: str | int
    unit: str
    sign: Literal[1, -1] = 1
    # Two columns are the same one whether or not quotes stood around the name.
    quoted: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class MapKeys:
    """What a command lets a person map.

    Attributes
    ----------
    quantities : mapping
        The quantity that decides on the units, by key; None where the column holds texts.
    lists : frozenset of str
        Keys that take several columns, written with plus signs between them.
    example : str
        A mapping that can be shown in a message.
    """

    quantities: Mapping[str, Quantity | None]
    lists: frozenset[str] = frozenset()
    example: str = _EXAMPLE


GAUGES: Final = "gauges"
LOG_KEYS: Final = MapKeys({**QUANTITIES, GAUGES: "voltage"}, lists=frozenset({GAUGES}))
"""The keys of a recording."""
_GAUGE = re.compile(r"gauge [1-9][0-9]*")


def gauge_key(number: int) -> str:
    """Name the column of one of the gauges, which are mapped together.

    Parameters
    ----------
    number : int
        Its number, from 1.

    Returns
    -------
    str
        The key.
    """
    return f"gauge {number}"


def is_gauge_key(key: str) -> bool:
    """Tell whether a key is that of a gauge.

    Parameters
    ----------
    key : str
        A key.

    Returns
    -------
    bool
        True for what `gauge_key` makes.
    """
    return _GAUGE.fullmatch(key) is not None


def quantity_of(key: str) -> Quantity:
    """Return what a column of a recording measures.

    Parameters
    ----------
    key : str
        One of `QUANTITIES`, or from `gauge_key`.

    Returns
    -------
    str
        The quantity.
    """
    return "voltage" if is_gauge_key(key) else QUANTITIES[key]


def parse_mapping(texts: Iterable[str]) -> dict[str, MappedColumn]:
    """Read what follows ``--map``: ``key=column[:unit]`` pairs by commas.

    Parameters
    ----------
    texts : iterable of str
        The option's values, in order.

    Returns
    -------
    dict
        Columns by key: those of `QUANTITIES`, and one from `gauge_key` for each gauge.

    Raises
    ------
    InputError
        If a pair cannot be read, or a key is unknown or given twice.
    """
    return gauge_by_gauge(parse_columns(texts, LOG_KEYS))


def gauge_by_gauge(
    mapping: Mapping[str, tuple[MappedColumn, ...]],
) -> dict[str, MappedColumn]:
    """Give each of the gauges a key of its own.

    Parameters
    ----------
    mapping : mapping
        Columns by key, from `parse_columns`.

    Returns
    -------
    dict
        One column a key, with `gauge_key` for each gauge.
    """
    found: dict[str, MappedColumn] = {}
    for key, columns in mapping.items():
        if key == GAUGES:
            found |= {gauge_key(number): each for number, each in enumerate(columns, 1)}
        else:
            found[key] = columns[0]
    return found


def parse_columns(texts: Iterable[str], keys: MapKeys) -> dict[str, tuple[MappedColumn, ...]]:
    """Read what follows ``--map`` where keys may have several columns.

    Parameters
    ----------
    texts : iterable of str
        The option's values, in order.
    keys : MapKeys
        What may be mapped.

    Returns
    -------
    dict
        Columns by key: one, or for a list as many as there are between plus signs. A unit after
        the last one is that of all.

    Raises
    ------
    InputError
        If a pair cannot be read, or a key is unknown or given twice.
    """
    mapping: dict[str, tuple[MappedColumn, ...]] = {}
    for text in texts:
        for key, columns in _pairs(text, keys):
            if key in mapping:
                raise InputError(
                    f"--map {text}: {key} is mapped twice; expected one column for each signal, so "
                    "remove one of them"
                )
            mapping[key] = columns
    return mapping


def format_mapping(mapping: Mapping[str, MappedColumn]) -> str:
    """Write a mapping the way `parse_mapping` reads it.

    Parameters
    ----------
    mapping : mapping
        Columns by key.

    Returns
    -------
    str
        ``key=column:unit`` pairs by commas.
    """
    pairs = [
        f"{key}={_format_name(column)}:{column.unit}"
        for key, column in mapping.items()
        if not is_gauge_key(key)
    ]
    gauges = [column for key, column in mapping.items() if is_gauge_key(key)]
    if gauges:
        names = "+".join(_format_name(column) for column in gauges)
        pairs.append(f"{GAUGES}={names}:{gauges[0].unit}")
    return ",".join(pairs)


def _format_name(column: MappedColumn) -> str:
    name = str(column.column)
    needs_quotes = any(character in name for character in _RESERVED) or name != name.strip()
    if column.quoted or needs_quotes or not name:
        name = '"' + name.replace('"', '""') + '"'
    return f"{'-' if column.sign < 0 else ''}{name}"


def _pairs(text: str, keys: MapKeys) -> Iterable[tuple[str, tuple[MappedColumn, ...]]]:
    position = 0
    while True:
        key, position = _read_key(text, position, keys)
        ends = ",:+" if key in keys.lists else ",:"
        named = []
        while True:
            name, sign, quoted, position = _read_column(text, position, key, keys, ends)
            named.append((name, sign, quoted))
            if not text.startswith("+", position):
                break
            position += 1
        unit, position = _read_unit(text, position, key, keys)
        yield key, tuple(MappedColumn(name, unit, sign, quoted) for name, sign, quoted in named)
        if position == len(text):
            return
        position += 1


def _read_key(text: str, start: int, keys: MapKeys) -> tuple[str, int]:
    end = text.find("=", start)
    rest = text[start:]
    if end < 0 or "," in text[start:end]:
        raise InputError(
            f"--map {text}: {rest!r} is no pair; expected key=column pairs by commas, such as "
            f"{keys.example}, so add the missing part"
        )
    key = text[start:end].strip()
    if key not in keys.quantities:
        near = difflib.get_close_matches(key, keys.quantities, n=1)
        advice = f"did you mean {near[0]}?" if near else "use one of these"
        raise InputError(
            f"--map {text}: {key!r} is no signal; expected one of {', '.join(keys.quantities)}; "
            f"{advice}"
        )
    return key, end + 1


def _read_column(
    text: str, start: int, key: str, keys: MapKeys, ends: str
) -> tuple[str, Literal[1, -1], bool, int]:
    while text[start : start + 1].isspace():
        start += 1
    sign: Literal[1, -1] = 1
    if text.startswith('-"', start):
        sign, start = -1, start + 1
    if text.startswith('"', start):
        match = _QUOTED.match(text, start)
        if match is None:
            raise InputError(
                f"--map {text}: the quoted column of {key} does not end; expected a closing "
                'double quote, and "" for a double quote within the name'
            )
        name, end = match[1].replace('""', '"'), match.end()
        while text[end : end + 1].isspace():
            end += 1
        if end < len(text) and text[end] not in ends:
            raise InputError(
                f"--map {text}: {text[end:]!r} follows the quoted column of {key}; expected a "
                "comma, a colon with a unit, or the end"
            )
        return name, sign, True, end
    end = start
    while end < len(text) and text[end] not in _RESERVED:
        end += 1
    name = text[start:end].strip()
    if end < len(text) and text[end] not in ends:
        raise InputError(
            f"--map {text}: the column of {key} contains {text[end]!r}; a name with , + : = or a "
            "double quote in it is written in double quotes, such as --map 'torque=\"a,b\":mNm', "
            "or mapped in the joint file"
        )
    if not name:
        raise InputError(
            f"--map {text}: no column follows {key}=; expected the name of a column, such as "
            f"{keys.example}"
        )
    return name, sign, False, end


def _read_unit(text: str, start: int, key: str, keys: MapKeys) -> tuple[str, int]:
    quantity = keys.quantities[key]
    if start == len(text) or text[start] == ",":
        return "" if quantity is None else BASE_UNITS[quantity], start
    end = text.find(",", start)
    end = len(text) if end < 0 else end
    unit = text[start + 1 : end].strip()
    if quantity is None:
        raise InputError(
            f"--map {text}: the unit {unit!r} follows the column of {key}, which holds texts; "
            "expected no unit, so remove it; a column name with a colon is quoted"
        )
    try:
        return check_unit(quantity, unit), end
    except ValueError as error:
        raise InputError(
            f"--map {text}: the unit {unit!r} of {key} is unknown; expected one of "
            f"{', '.join(allowed_units(quantity))}; a column name with a colon is quoted"
        ) from error
