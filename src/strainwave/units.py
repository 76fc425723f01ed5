"""Units in which the columns of a recording may be given, and their conversion."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal

Quantity = Literal[
    "time",
    "angle",
    "speed",
    "acceleration",
    "torque",
    "force",
    "voltage",
    "temperature",
    "number",
]

_TURN_RAD = 2.0 * math.pi
_FACTORS: dict[Quantity, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0, "turn": _TURN_RAD},
    "speed": {
        "rad/s": 1.0,
        "deg/s": math.pi / 180.0,
        "turn/s": _TURN_RAD,
        "turn/min": _TURN_RAD / 60.0,
    },
    "acceleration": {
        "rad/s^2": 1.0,
        "deg/s^2": math.pi / 180.0,
        "turn/s^2": _TURN_RAD,
    },
    "torque": {"Nm": 1.0, "mNm": 1e-3},
    "force": {"N": 1.0, "kN": 1e3},
    "voltage": {"V": 1.0, "mV": 1e-3, "uV": 1e-6},
    "temperature": {"degC": 1.0, "K": 1.0, "degF": 5.0 / 9.0},
    "number": {"1": 1.0},
}
_OFFSETS = {"K": -273.15, "degF": -32.0 * 5.0 / 9.0}
_PATTERNS: dict[Quantity, tuple[str, re.Pattern[str]]] = {
    "angle": ("counts/N (N counts per turn)", re.compile(r"counts/([1-9][0-9]{0,18})")),
    "speed": ("counts/N/s (N counts per turn)", re.compile(r"counts/([1-9][0-9]{0,18})/s")),
}
BASE_UNITS: dict[Quantity, str] = {
    "time": "s",
    "angle": "rad",
    "speed": "rad/s",
    "acceleration": "rad/s^2",
    "torque": "Nm",
    "force": "N",
    "voltage": "V",
    "temperature": "degC",
    "number": "1",
}
"""The unit in which strainwave computes with each quantity."""


@dataclass(frozen=True)
class Conversion:
    """From the unit of a column to the base unit: ``value * factor + offset``."""

    factor: float
    offset: float = 0.0


def allowed_units(quantity: Quantity) -> tuple[str, ...]:
    """Return the units a column of this quantity may have, in words where they are a pattern."""
    units = tuple(_FACTORS[quantity])
    if quantity in _PATTERNS:
        units += (_PATTERNS[quantity][0],)
    if quantity == "voltage":
        units += ("counts (codes of the converter in [gauges])",)
    return units


def check_unit(quantity: Quantity, unit: str) -> str:
    """Return `unit` if a column of this quantity may have it.

    Raises
    ------
    ValueError
        With the units that are allowed.
    """
    known = unit in _FACTORS[quantity] or (quantity == "voltage" and unit == "counts")
    if known or (quantity in _PATTERNS and _PATTERNS[quantity][1].fullmatch(unit)):
        return unit
    raise ValueError(
        f"expected a unit of {quantity}: {', '.join(allowed_units(quantity))}; "
        "write one of these, or convert the column"
    )


def conversion(quantity: Quantity, unit: str) -> Conversion | None:
    """Return how to convert a column of this quantity to its base unit (`BASE_UNITS`).

    Returns
    -------
    Conversion or None
        None for converter codes (``"counts"``), whose volts depend on the converter in
        ``[gauges]``.

    Raises
    ------
    ValueError
        If a column of this quantity cannot have this unit.
    """
    check_unit(quantity, unit)
    if unit == "counts":
        return None
    if unit in _FACTORS[quantity]:
        return Conversion(_FACTORS[quantity][unit], _OFFSETS.get(unit, 0.0))
    match = _PATTERNS[quantity][1].fullmatch(unit)
    assert match is not None
    return Conversion(_TURN_RAD / int(match[1]))
