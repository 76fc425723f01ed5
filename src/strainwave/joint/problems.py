"""Turns what the models object to into one clear sentence."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Mapping, Sequence

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from strainwave.errors import InputError
from strainwave.joint.fields import (
    Place,
    choices_of,
    discriminator_of,
    key_of,
    kind_of,
    place_at,
    range_of,
    unit_of,
)

Location = Sequence[str | int]
_WRONG_KIND = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "string_type": "a text in quotation marks",
    "tuple_type": "a list in square brackets",
    "list_type": "a list in square brackets",
    "model_type": "a table of keys and values",
    "model_attributes_type": "a table of keys and values",
    "dict_type": "a table of keys and values",
    "finite_number": "a finite number",
    "string_too_short": "a text that is not empty",
    "string_unicode": "a text of valid characters",
    "string_pattern_mismatch": "64 hexadecimal digits",
}
_RANGE = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
_WRONG_CHOICE = ("union_tag_not_found", "union_tag_invalid")
_LONGEST_SHOWN = 60
_CONSEQUENCE = "default_factory_not_called"
"""Reported for a default that depends on a field which is itself in error."""


def shown(value: object) -> str:
    """Return a value as it stands in a TOML file, cut where it is long."""
    if isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, str):
        text = json.dumps(value, ensure_ascii=False).encode("utf-8", "backslashreplace").decode()
    elif isinstance(value, int) and abs(value) >= 10**_LONGEST_SHOWN:
        text = f"a number of more than {_LONGEST_SHOWN} digits"
    elif isinstance(value, Mapping):
        text = "a table"
    elif isinstance(value, list | tuple):
        text = f"[{', '.join(shown(item) for item in value)}]"
    elif hasattr(value, "isoformat"):
        text = value.isoformat()
    else:
        text = repr(value)
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


def place(location: Location, *, table: bool = False) -> str:
    """Return a location in words: ``[gauges.rosettes] entry 2, radius_m``.

    Parameters
    ----------
    location : sequence of str or int
        Keys, and positions in lists counted from 0.
    table : bool
        True where the location is that of a table, False where it is that of a value.

    Returns
    -------
    str
        Empty for the file as a whole.
    """
    if not location:
        return ""
    keys = [position for position, step in enumerate(location) if isinstance(step, str)]
    last = len(location) if table or len(keys) == 1 else keys[-1]
    path = ".".join(str(step) for step in location[:last] if isinstance(step, str))
    rest = [f"entry {step + 1}" for step in location[:last] if isinstance(step, int)]
    rest += [f"entry {step + 1}" if isinstance(step, int) else step for step in location[last:]]
    return f"[{path}] {', '.join(rest)}".rstrip()


def _value_place(at: Place) -> str:
    """As `place`; a key outside the sections stands without their brackets."""
    key, *entries = at.location or ("",)
    if at.field is None or at.models or not all(isinstance(each, int) for each in entries):
        return place(at.location)
    return ", ".join([str(key), *(f"entry {int(each) + 1}" for each in entries)])


def _missing(at: Place) -> str:
    *table_location, key = at.location
    if not table_location and not at.models:
        return f'the key "{key}" is missing{_about(at.field)}; add it'
    if not table_location:
        return f"the section {place(at.location)} is missing{_about(at.field)}; add it"
    return f'{place(table_location, table=True)} lacks the key "{key}"{_about(at.field)}; add it'


def _unknown_key(error: ErrorDetails, model: type[BaseModel], location: Location) -> str:
    *table_location, key = location
    table = place_at(model, table_location)
    known = {
        key_of(*item).lower(): key_of(*item)
        for each in table.models
        for item in each.model_fields.items()
    }
    close = difflib.get_close_matches(str(key).lower(), list(known), n=1)
    if close:
        advice = f'(did you mean "{known[close[0]]}"?); rename or remove it'
    else:
        advice = f"(known are {', '.join(known.values())}); remove it"
    table_place = place(table.location, table=True)
    if table_place:
        return f"{table_place} has the unknown key {shown(key)} {advice}"
    if isinstance(error["input"], Mapping):
        return f"[{key}] is not a section of a joint file {advice}"
    return f"the key {shown(key)} outside the sections is unknown {advice}"


def _wrong_choice(error: ErrorDetails, at: Place) -> str:
    """Say that a table does not tell, or tells wrongly, which of several models it is of."""
    key = None if at.field is None else discriminator_of(at.field)
    assert key is not None
    fields = [model.model_fields[key] for model in at.models]
    known = " or ".join(shown(choice) for field in fields for choice in choices_of(field))
    table_place, about = place(at.location, table=True), _about(fields[0])
    if error["type"] == "union_tag_not_found":
        return f'{table_place} lacks the key "{key}"{about}; add it as {known}'
    value = shown(error["input"][key])
    return f"{table_place} {key} = {value}: expected {known}{about}; correct this value"


def _expected(error: ErrorDetails, field: FieldInfo | None) -> str:
    kind = error["type"]
    context = error.get("ctx", {})
    if kind.startswith(("datetime", "timezone")):
        text = "a date and time with time zone, such as 2026-11-01T12:00:00Z"
    elif kind == "literal_error" and field is not None:
        text = " or ".join(shown(choice) for choice in choices_of(field))
    elif kind in _RANGE and field is not None:
        text = f"a {kind_of(field).removeprefix('list, each ')} {range_of(field)}"
    elif kind == "float_type" and isinstance(error["input"], int) and abs(error["input"]) > 1:
        text = "a number of double precision, at most 1.8e308 in magnitude"
    elif kind == "too_short":
        text = f"a list of at least {context['min_length']}"
    elif kind == "too_long":
        text = f"a list of at most {context['max_length']}"
    elif kind == "string_too_long":
        text = f"a text of at most {context['max_length']} characters"
    else:
        text = _WRONG_KIND.get(kind, error["msg"].lower())
    unit = None if field is None else unit_of(field)
    if unit not in (None, "1"):
        text += f", in {unit}"
    return text


def _about(field: FieldInfo | None) -> str:
    """Return the first clause of the field's description, in parentheses."""
    if field is None or not field.description:
        return ""
    clause = re.split(r"[;:(]", field.description)[0].strip().replace("`", "")
    starts_with_word = clause[1:2].islower() or clause[1:2] == " "
    return f" ({clause[0].lower() if starts_with_word else clause[0]}{clause[1:]})"


def sentence(error: ErrorDetails, model: type[BaseModel], prefix: Sequence[str] = ()) -> str:
    """Say what one of pydantic's errors means for the file.

    Parameters
    ----------
    error : ErrorDetails
        One of ``ValidationError.errors()``.
    model : type
        The model of the file as a whole.
    prefix : sequence of str
        Location in the file of what was validated.

    Returns
    -------
    str
        Place, value, what was expected, what to do; without the file and without a full stop.
    """
    location = (*prefix, *error["loc"])
    at = place_at(model, location)
    where = _value_place(at)
    kind = error["type"]
    if kind == "missing":
        return _missing(at)
    if kind == "extra_forbidden":
        return _unknown_key(error, model, location)
    if kind in _WRONG_CHOICE:
        return _wrong_choice(error, at)
    if kind == "value_error":
        message = str(error.get("ctx", {}).get("error", error["msg"]))
        if isinstance(error["input"], Mapping | BaseModel):
            return f"{place(at.location, table=True)} {message}".strip()
        advice = "" if ";" in message else "; correct this value"
        return f"{where} = {shown(error['input'])}: {message}{advice}"
    return (
        f"{where} = {shown(error['input'])}: expected {_expected(error, at.field)}"
        f"{_about(at.field)}; correct this value"
    )


def input_error(
    error: ValidationError, source: str, model: type[BaseModel], prefix: Sequence[str] = ()
) -> InputError:
    """Return the error to raise for values that a model does not take.

    Parameters
    ----------
    error : ValidationError
        What pydantic says.
    source : str
        File (or other place) the values come from.
    model : type
        The model of the file as a whole.
    prefix : sequence of str
        Location in the file of what was validated.

    Returns
    -------
    InputError
        With one sentence about the first problem, and the number of further ones.
    """
    details: list[ErrorDetails] = [
        item for item in error.errors(include_url=False) if item["type"] != _CONSEQUENCE
    ]
    # A misspelt key is also a missing one: the spelling is what helps.
    details.sort(key=lambda item: item["type"] != "extra_forbidden")
    text = f"{source}: {sentence(details[0], model, prefix)}"
    if len(details) > 1:
        text += f" ({len(details) - 1} more problem{'s' if len(details) > 2 else ''} after this)"
    return InputError(text)
