"""The tables of the joint file's reference, made from the models."""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from strainwave.joint.fields import key_of, kind_of, length_of, model_of, range_of, unit_of
from strainwave.joint.model import SECTION_MODELS, Identity
from strainwave.joint.provenance import Provenance
from strainwave.joint.signals import Column
from strainwave.joint.units import BASE_UNITS, Quantity, allowed_units


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
        inner = model_of(field)
        if inner is None or issubclass(inner, Column | Provenance):
            continue
        yield f"`[[{name}.{key}]]`", inner


def field_tables() -> str:
    """Return the tables of all sections in Markdown: key, value, unit, default, meaning."""
    lines = [*_table("`[joint]`", Identity)]
    for name, model in SECTION_MODELS.items():
        lines += _table(f"`[{name}]`", model)
        if name == "signals":
            lines += _table("A column, such as `signals.torque`", Column)
            lines += ["| quantity | units of a column | computed in |", "|---|---|---|"]
            for quantity in get_args(Quantity):
                units = ", ".join(allowed_units(quantity))
                lines.append(f"| {quantity} | {units} | {BASE_UNITS[quantity]} |")
            lines.append("")
        for title, inner in _lists(name, model):
            lines += _table(title, inner)
    lines += _table("`[SECTION.provenance]`", Provenance)
    return "\n".join(lines).rstrip() + "\n"
