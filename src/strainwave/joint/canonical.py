"""The canonical form of a joint and its hash.

The canonical form is the JSON Canonicalization Scheme, RFC 8785, applied to the values of the
joint: see the reference of the joint file.
"""

from __future__ import annotations

import hashlib
import json
import math
from datetime import UTC, datetime
from typing import Any

from strainwave.errors import InputError
from strainwave.joint.model import SECTION_NAMES, Joint
from strainwave.joint.provenance import Section


def canonical_number(value: float) -> str:
    """Write a finite number as ECMAScript does (RFC 8785, section 3.2.2.3)."""
    if not math.isfinite(value):
        raise ValueError(f"{value} has no canonical form; expected a finite number")
    if value == 0.0:
        return "0"
    mantissa, _, exponent = f"{float(value)!r}".lstrip("-").partition("e")
    whole, _, fraction = mantissa.partition(".")
    digits = whole + fraction
    point = len(whole) + int(exponent or 0)
    leading_zeros = len(digits) - len(digits.lstrip("0"))
    digits = digits.strip("0")
    point -= leading_zeros
    sign = "-" if value < 0 else ""
    if len(digits) <= point <= 21:
        return sign + digits + "0" * (point - len(digits))
    if 0 < point <= 21:
        return f"{sign}{digits[:point]}.{digits[point:]}"
    if -6 < point <= 0:
        return f"{sign}0.{'0' * -point}{digits}"
    tail = f".{digits[1:]}" if len(digits) > 1 else ""
    return f"{sign}{digits[0]}{tail}e{point - 1:+d}"


def canonical_json(value: Any) -> str:
    """Write plain values in the canonical form of RFC 8785.

    Parameters
    ----------
    value : mapping, sequence, datetime, str, int or float
        Keys are ASCII, numbers finite; a time is written as text, in UTC to the microsecond.

    Returns
    -------
    str
        JSON.

    Raises
    ------
    TypeError
        If a value is of another kind.
    ValueError
        If a number is not finite.
    """
    if isinstance(value, dict):
        # The keys are ASCII, so that their order by code point is that of UTF-16.
        return (
            "{" + ",".join(f'"{key}":{canonical_json(value[key])}' for key in sorted(value)) + "}"
        )
    if isinstance(value, list | tuple):
        return "[" + ",".join(canonical_json(item) for item in value) + "]"
    if isinstance(value, datetime):
        return f'"{value.astimezone(UTC):%Y-%m-%dT%H:%M:%S.%f}Z"'
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return canonical_number(value)
    raise TypeError(f"{type(value).__name__} has no canonical form")


def _without_provenance(values: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in values.items() if key != "provenance"}


def canonical_form(joint: Joint, *, include_provenance: bool = True) -> str:
    """Return the text whose SHA-256 is the canonical hash.

    Parameters
    ----------
    joint : Joint
        The joint.
    include_provenance : bool
        False leaves the provenance of every section and the history out, to compare the values
        alone.

    Returns
    -------
    str
        JSON in the canonical form of RFC 8785.
    """
    values = joint.model_dump(by_alias=True, exclude_none=True)
    if not include_provenance:
        values.pop("history", None)
        values = {key: _without_provenance(part) for key, part in values.items()}
    return canonical_json(values)


def canonical_hash(joint: Joint, *, include_provenance: bool = True) -> str:
    """Return the SHA-256 of what a joint file says, independent of how it says it.

    Comments, layout, the order of keys, ``1`` or ``1.0`` and defaults written out or left out
    make no difference; every value does.

    Parameters
    ----------
    joint : Joint
        The joint.
    include_provenance : bool
        False leaves the provenance of every section and the history out, to compare the values
        alone.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    text = canonical_form(joint, include_provenance=include_provenance)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def section_hash(joint: Joint, name: str, *, include_provenance: bool = True) -> str:
    """Return the SHA-256 of one section, formed like the canonical hash.

    Parameters
    ----------
    joint : Joint
        The joint.
    name : str
        Name of the section, one of `SECTION_NAMES`.
    include_provenance : bool
        False leaves the provenance out.

    Returns
    -------
    str
        64 hexadecimal digits.

    Raises
    ------
    InputError
        If there is no such section in this joint.
    """
    section = getattr(joint, name, None) if name in SECTION_NAMES else None
    if not isinstance(section, Section):
        present = [key for key in SECTION_NAMES if getattr(joint, key) is not None]
        raise InputError(
            f'joint "{joint.identity.name}": there is no section [{name}] to hash; expected one of '
            f"those it has ({', '.join(present) or 'none'})"
        )
    values = section.model_dump(by_alias=True, exclude_none=True)
    if not include_provenance:
        values = _without_provenance(values)
    return hashlib.sha256(canonical_json(values).encode("utf-8")).hexdigest()
