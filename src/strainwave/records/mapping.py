"""The option ``--map``: which column of a recording holds which signal, and in which unit."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal

from strainwave.errors import InputError
from strainwave.joint.units import BASE_UNITS, Quantity, allowed_units, check_unit

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

QUANTITIES: Final[dict[str, Quantity]] = {
    "time": "time",
    "angle": "angle",
    "motor-angle": "angle",
    "speed": "speed",
    "torque": "torque",
    "expected-torque": "torque",
}
"""What can be mapped, and the quantity that decides on the units."""

_RESERVED = ',+:="'
_QUOTED = re.compile(r'"((?:[^"]|"")*)"')
_EXAMPLE = "--map time=t_s,angle=q:deg,torque=tau_Nm"


@dataclass(frozen=True)
class MappedColumn:
    """Where a signal is found in a recording.

    Attributes
    ----------
    column : str or int
        Name of the column, or its number counted from 1.
    unit : str
        Unit of the column, one of `strainwave.joint.units.allowed_units`.
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


def parse_mapping(texts: Iterable[str]) -> dict[str, MappedColumn]:
    """Read what follows ``--map``: ``key=column[:unit]`` pairs by commas.

    Parameters
    ----------
    texts : iterable of str
        The option's values, in order.

    Returns
    -------
    dict
        Columns by key; the keys are those of `QUANTITIES`.

    Raises
    ------
    InputError
        If a pair cannot be read, or a key is unknown or given twice.
    """
    mapping: dict[str, MappedColumn] = {}
    for text in texts:
        for key, column in _pairs(text):
            if key in mapping:
                raise InputError(
                    f"--map {text}: {key} is mapped twice; expected one column for each signal, so "
                    "remove one of them"
                )
            mapping[key] = column
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
    return ",".join(f"{key}={_format_column(column)}" for key, column in mapping.items())


def _format_column(column: MappedColumn) -> str:
    name = str(column.column)
    needs_quotes = any(character in name for character in _RESERVED) or name != name.strip()
    if column.quoted or needs_quotes or not name:
        name = '"' + name.replace('"', '""') + '"'
    return f"{'-' if column.sign < 0 else ''}{name}:{column.unit}"


def _pairs(text: str) -> Iterable[tuple[str, MappedColumn]]:
    position = 0
    while True:
        key, position = _read_key(text, position)
        name, sign, quoted, position = _read_column(text, position, key)
        unit, position = _read_unit(text, position, key)
        yield key, MappedColumn(name, unit, sign, quoted)
        if position == len(text):
            return
        position += 1


def _read_key(text: str, start: int) -> tuple[str, int]:
    end = text.find("=", start)
    rest = text[start:]
    if end < 0 or "," in text[start:end]:
        raise InputError(
            f"--map {text}: {rest!r} is no pair; expected key=column pairs by commas, such as "
            f"{_EXAMPLE}, so add the missing part"
        )
    key = text[start:end].strip()
    if key not in QUANTITIES:
        near = difflib.get_close_matches(key, QUANTITIES, n=1)
        advice = f"did you mean {near[0]}?" if near else "use one of these"
        raise InputError(
            f"--map {text}: {key!r} is no signal; expected one of {', '.join(QUANTITIES)}; {advice}"
        )
    return key, end + 1


def _read_column(text: str, start: int, key: str) -> tuple[str, Literal[1, -1], bool, int]:
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
        if end < len(text) and text[end] not in ",:":
            raise InputError(
                f"--map {text}: {text[end:]!r} follows the quoted column of {key}; expected a "
                "comma, a colon with a unit, or the end"
            )
        return name, sign, True, end
    end = start
    while end < len(text) and text[end] not in _RESERVED:
        end += 1
    name = text[start:end].strip()
    if end < len(text) and text[end] not in ",:":
        raise InputError(
            f"--map {text}: the column of {key} contains {text[end]!r}; a name with , + : = or a "
            "double quote in it is written in double quotes, such as --map 'torque=\"a,b\":mNm', "
            "or mapped in the joint file"
        )
    if not name:
        raise InputError(
            f"--map {text}: no column follows {key}=; expected the name of a column, such as "
            f"{_EXAMPLE}"
        )
    return name, sign, False, end


def _read_unit(text: str, start: int, key: str) -> tuple[str, int]:
    quantity = QUANTITIES[key]
    if start == len(text) or text[start] == ",":
        return BASE_UNITS[quantity], start
    end = text.find(",", start)
    end = len(text) if end < 0 else end
    unit = text[start + 1 : end].strip()
    try:
        return check_unit(quantity, unit), end
    except ValueError as error:
        raise InputError(
            f"--map {text}: the unit {unit!r} of {key} is unknown; expected one of "
            f"{', '.join(allowed_units(quantity))}; a column name with a colon is quoted"
        ) from error
