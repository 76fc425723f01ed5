"""The tables of the joint file's reference, made from the models."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from strainwave.joint.fields import (
    choices_of,
    discriminator_of,
    key_of,
    kind_of,
    length_of,
    models_of,
    range_of,
    unit_of,
)
from strainwave.joint.history import HistoryEntry
from strainwave.joint.model import SECTION_MODELS, Identity, Joint
from strainwave.joint.provenance import Provenance
from strainwave.joint.signals import Column
from strainwave.units import BASE_UNITS, Quantity, allowed_units

#: Quantities of tables that calibrations read, which have no column in `[signals]`.
_NOT_IN_A_JOINT_FILE: Final = ("acceleration", "force", "number")


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    if field.default_factory is not None:
        return "see right"
    if field.default is None:
        return ""
    if field.default == ():
        return "empty list"
    return f"`{field.default}`"


def _rows(model: type[BaseModel]) -> Iterator[str]:
    for name, field in model.model_fields.items():
        if name == "provenance":
            continue
        words = ", ".join(filter(None, (kind_of(field), range_of(field), length_of(field))))
        unit = unit_of(field)
        yield (
            f"| `{key_of(name, field)}` | {words} | {unit or ''} "
            f"| {_default(field)} | {field.description} |"
        )


def _table(title: str, model: type[BaseModel]) -> Iterator[str]:
    yield f"### {title}"
    yield ""
    if model.__doc__:
        summary = model.__doc__.strip().split("\n\n")
        for paragraph in summary:
            yield " ".join(paragraph.split())
            yield ""
    yield "| key | value | unit | default | meaning |"
    yield "|---|---|---|---|---|"
    yield from _rows(model)
    yield ""


def _lists(name: str, model: type[BaseModel]) -> Iterator[tuple[str, type[BaseModel]]]:
    for key, field in model.model_fields.items():
        for inner in models_of(field):
            if not issubclass(inner, Column | Provenance):
                yield f"`[[{name}.{key}]]`", inner


def _title(name: str, model: type[BaseModel]) -> str:
    """Return the heading of a section, with what tells its models apart where it has several."""
    key = discriminator_of(Joint.model_fields[name])
    if key is None:
        return f"`[{name}]`"
    (choice,) = choices_of(model.model_fields[key])
    return f'`[{name}]` with `{key} = "{choice}"`'


def field_tables() -> str:
    """Return the tables of all sections in Markdown: key, value, unit, default, meaning."""
    lines = [*_table("`[joint]`", Identity)]
    for name, models in SECTION_MODELS.items():
        for model in models:
            lines += _table(_title(name, model), model)
            if name == "signals":
                lines += _columns()
            for title, inner in _lists(name, model):
                lines += _table(title, inner)
    lines += _table("`[SECTION.provenance]`", Provenance)
    lines += _table("`[[history]]`", HistoryEntry)
    return "\n".join(lines).rstrip() + "\n"


def _columns() -> Iterator[str]:
    yield from _table("A column, such as `signals.torque`", Column)
    yield from ("| quantity | units of a column | computed in |", "|---|---|---|")
    for quantity in get_args(Quantity):
        if quantity in _NOT_IN_A_JOINT_FILE:
            continue
        units = ", ".join(allowed_units(quantity))
        yield f"| {quantity} | {units} | {BASE_UNITS[quantity]} |"
    yield ""
