"""Puts values into a TOML document and leaves comments and layout as they are."""

from __future__ import annotations

from collections.abc import Mapping, MutableMapping
from datetime import UTC, datetime
from typing import Any

import tomlkit
from tomlkit.items import AoT, Array, InlineTable, Table


def _rank(value: Any) -> int:
    """Order plain values before tables, and those before lists of tables."""
    if isinstance(value, Mapping):
        return 1
    return 2 if _is_list_of_tables(value) else 0


def _is_list_of_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _inline(values: Mapping[str, Any]) -> bool:
    """Tell whether a table is small enough to stand in one line."""
    return len(values) <= 3 and all(not isinstance(v, Mapping | list) for v in values.values())


def new_item(value: Any) -> Any:
    """Return a plain value as an item of a TOML document.

    Small tables are written in one line, larger ones and lists of tables as sections; times with
    a ``Z``.
    """
    if isinstance(value, datetime):
        stamp = value.astimezone(UTC).isoformat().replace("+00:00", "Z")
        return tomlkit.datetime(stamp)
    if isinstance(value, Mapping):
        return _inline_table(value) if _inline(value) else new_table(value)
    if _is_list_of_tables(value):
        if all(_inline(entry) for entry in value):
            array = tomlkit.array()
            for entry in value:
                array.append(_inline_table(entry))
            array.multiline(True)
            return array
        tables = tomlkit.aot()
        for entry in value:
            tables.append(new_table(entry))
        return tables
    return tomlkit.item(value)


def _inline_table(values: Mapping[str, Any]) -> InlineTable:
    table = tomlkit.inline_table()
    for key, value in values.items():
        table.append(key, new_item(value))
    return table


def new_table(values: Mapping[str, Any]) -> Table:
    """Return plain values as a section of a TOML document."""
    table = tomlkit.table()
    for key, value in sorted(values.items(), key=lambda item: _rank(item[1])):
        if key == "provenance":
            table.append(key, new_table(value))
        else:
            table.append(key, new_item(value))
    return table


def _plain(value: Any) -> Any:
    return value.unwrap() if hasattr(value, "unwrap") else value


def _merge_entry(container: Any, key: Any, value: Any) -> None:
    """Give one existing entry of a table or list a new value."""
    old = container[key]
    if _plain(old) == value:
        return
    if isinstance(value, Mapping) and isinstance(old, MutableMapping):
        merge(old, value)
    elif isinstance(value, list) and isinstance(old, AoT | Array) and len(old) == len(value):
        for position, entry in enumerate(value):
            _merge_entry(old, position, entry)
    else:
        container[key] = new_item(value)


def merge(table: MutableMapping[str, Any], values: Mapping[str, Any]) -> None:
    """Make a table of a document hold these values and no others.

    Parameters
    ----------
    table : mutable mapping
        A table of a tomlkit document; changed in place. What already has its value is not
        touched, and a changed value keeps the comment beside it.
    values : mapping
        Plain values.
    """
    for key in [key for key in table if key not in values]:
        del table[key]
    for key, value in sorted(values.items(), key=lambda item: _rank(item[1])):
        if key in table:
            _merge_entry(table, key, value)
        else:
            table[key] = new_table(value) if key == "provenance" else new_item(value)


def set_in_place(
    document: tomlkit.TOMLDocument, name: str, values: Mapping[str, Any] | None
) -> None:
    """Give a section these values and keep its comments and layout.

    Parameters
    ----------
    document : tomlkit.TOMLDocument
        The document; changed in place.
    name : str
        Name of the section.
    values : mapping or None
        Plain values; None removes the section.
    """
    if values is None:
        document.pop(name, None)
    elif name in document:
        merge(document[name], values)
    else:
        document.append(name, new_table(values))


def set_anew(document: tomlkit.TOMLDocument, name: str, values: Mapping[str, Any] | None) -> None:
    """Give a section these values and write it anew; parameters as in `set_in_place`."""
    document.pop(name, None)
    if values is not None:
        document.append(name, new_table(values))


def append_entry(document: tomlkit.TOMLDocument, name: str, values: Mapping[str, Any]) -> None:
    """Add a table to a list of tables, at the end of both list and document.

    Parameters
    ----------
    document : tomlkit.TOMLDocument
        The document; changed in place.
    name : str
        Name of the list, which is begun where it is not there.
    values : mapping
        Plain values.
    """
    if name not in document:
        document.append(name, tomlkit.aot())
    document[name].append(new_table(values))
