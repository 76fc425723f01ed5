"""What the models say of a field: its unit, its range, its type, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

import annotated_types
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from strainwave.joint.base import Unit


def _parts(annotation: Any) -> Iterator[Any]:
    """Yield an annotation and everything inside it."""
    yield annotation
    for inner in get_args(annotation):
        yield from _parts(inner)


def _everything(field: FieldInfo) -> Iterator[Any]:
    yield from field.metadata
    yield from _parts(field.annotation)


def unit_of(field: FieldInfo) -> str | None:
    """Return the unit of a field, ``"1"`` where it is dimensionless, None where it has none."""
    for part in _everything(field):
        if isinstance(part, Unit):
            return part.symbol
        if isinstance(part, FieldInfo):
            for inner in part.metadata:
                if isinstance(inner, Unit):
                    return inner.symbol
    return None


def models_of(field: FieldInfo) -> tuple[type[BaseModel], ...]:
    """Return the models of a field that holds a table or a list of tables, or nothing.

    There are several where one key of the table, its discriminator, tells which one it is.
    """
    return tuple(
        part
        for part in _parts(field.annotation)
        if isinstance(part, type) and issubclass(part, BaseModel)
    )


def discriminator_of(field: FieldInfo) -> str | None:
    """Return the key that tells which of several models a table is of, None where there is one."""
    for part in _everything(field):
        if isinstance(part, FieldInfo) and isinstance(part.discriminator, str):
            return part.discriminator
    return None


def is_list(field: FieldInfo) -> bool:
    """Tell whether a field holds a list."""
    return any(get_origin(part) is tuple for part in _parts(field.annotation))


def range_of(field: FieldInfo) -> str:
    """Return the range of the numbers of a field, or of its list, in words; ``""`` for any."""
    low, high = "", ""
    inner = [
        item for part in _everything(field) if isinstance(part, FieldInfo) for item in part.metadata
    ]
    for part in (*field.metadata, *inner):
        if isinstance(part, annotated_types.Gt):
            low = f"greater than {part.gt:.10g}"
        elif isinstance(part, annotated_types.Ge):
            low = f"at least {part.ge:.10g}"
        elif isinstance(part, annotated_types.Le):
            high = f"at most {part.le:.10g}"
    return f"{low} and {high}" if low and high else low or high


def length_of(field: FieldInfo) -> str:
    """Return the allowed number of entries of a list in words, ``""`` where any goes."""
    words = [
        f"at {'least' if isinstance(part, annotated_types.MinLen) else 'most'} {length}"
        for part in field.metadata
        if is_list(field)
        for length in (getattr(part, "min_length", None), getattr(part, "max_length", None))
        if length is not None
    ]
    return f"{' and '.join(words)} of them" if words else ""


def choices_of(field: FieldInfo) -> tuple[Any, ...]:
    """Return the values a field can choose from, empty where it is not a choice."""
    for part in _parts(field.annotation):
        if get_origin(part) is Literal:
            return get_args(part)
    return ()


def kind_of(field: FieldInfo) -> str:
    """Return what kind of value a field holds, in words."""
    if models_of(field):
        return "list of tables" if is_list(field) else "table"
    choices = choices_of(field)
    if choices:
        return " or ".join(f'"{item}"' if isinstance(item, str) else f"{item}" for item in choices)
    parts = list(_parts(field.annotation))
    names = {
        "datetime": "date and time",
        "float": "number",
        "int": "whole number",
        "str": "text",
    }
    kinds = [
        word
        for name, word in names.items()
        if any(isinstance(part, type) and part.__name__ == name for part in parts)
    ]
    kind = " or ".join(kinds)
    return f"list, each {kind}" if is_list(field) else kind


def key_of(name: str, field: FieldInfo) -> str:
    """Return the key of a field in the file."""
    return field.alias or name


@dataclass(frozen=True)
class Place:
    """A place in the file, found by a location as the models give it.

    Attributes
    ----------
    location : tuple of str or int
        Keys, and positions in lists: the location without the tags of the models in between.
    models : tuple of types
        The models that the table there may have; empty where it is no table.
    field : FieldInfo or None
        The field there, None where it is not known.
    """

    location: tuple[str | int, ...]
    models: tuple[type[BaseModel], ...]
    field: FieldInfo | None


def _tagged(
    models: Sequence[type[BaseModel]], key: str, tag: str | int
) -> tuple[type[BaseModel], ...]:
    return tuple(model for model in models if tag in choices_of(model.model_fields[key]))


def place_at(model: type[BaseModel], location: Sequence[str | int]) -> Place:
    """Follow a location through the models.

    Parameters
    ----------
    model : type
        The model the location starts from.
    location : sequence of str or int
        Keys, and positions in lists; after a table of one of several models, which one it is of.

    Returns
    -------
    Place
        What is there.
    """
    models: tuple[type[BaseModel], ...] = (model,)
    field: FieldInfo | None = None
    passed: list[str | int] = []
    for step in location:
        if len(models) > 1 and field is not None:
            key = discriminator_of(field)
            chosen = () if key is None else _tagged(models, key, step)
            if chosen:
                models = chosen
                continue
        passed.append(step)
        if isinstance(step, int):
            continue
        known = {
            key_of(name, item): item for each in models for name, item in each.model_fields.items()
        }
        if models:
            field = known.get(step)
        models = () if field is None else models_of(field)
    return Place(tuple(passed), models, field)
