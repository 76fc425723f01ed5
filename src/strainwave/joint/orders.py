"""Orders as the joint file writes them: cycles per motor turn."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Annotated, Any

from pydantic import BeforeValidator

from strainwave.joint.base import Unit
from strainwave.joint.gear import Gear

_FRACTION = re.compile(r"([1-9][0-9]{0,8})/([1-9][0-9]{0,8}|R)")
_OF_FACTOR_M = re.compile(r"([1-9][0-9]{0,2})m")
_BESIDE = re.compile(r"([1-9][0-9]{0,2})(m?)([+-])([1-9][0-9]{0,2})/R")
_TEXTS = (_FRACTION, _OF_FACTOR_M, _BESIDE)


def _check_order(value: Any) -> Any:
    """Take a number for a float, and leave a text as it is written."""
    if isinstance(value, str) and any(text.fullmatch(value) for text in _TEXTS):
        return value
    if isinstance(value, int | float) and not isinstance(value, bool) and 0 < value <= 1000:
        return float(value)
    raise ValueError(
        "expected a number of cycles per motor turn above 0 and up to 1000, or a text such as "
        '"1/100", "1/R" (R: ratio of the gear), "2m" (m: factor m of the gear) or "2m+1/R"'
    )


Order = Annotated[float | str, BeforeValidator(_check_order), Unit("cycles per motor turn")]

ORDERS_IN_WORDS = (
    'numbers, fractions such as "1/100", "n/R" for n cycles per output turn (R: ratio of the gear), '
    '"nm" such as "2m" for n times the gear\'s factor m, or "2m+1/R" and "2m-1/R" for the two '
    "orders beside it that a change over the output turn makes"
)
"""How an order may be written, for descriptions of keys."""


def needs_gear(order: float | str) -> bool:
    """Tell whether an order is given by the gear's ratio or factor m."""
    return isinstance(order, str) and order.endswith(("R", "m"))


def order_text(order: float | str) -> str:
    """Return an order as it may stand in the file."""
    return f'"{order}"' if isinstance(order, str) else f"{order:g}"


def order_value(order: float | str, gear: Gear | None) -> float | Fraction:
    """Return an order as cycles per motor turn.

    Parameters
    ----------
    order : float or str
        A number, a fraction such as ``"1/100"``, ``"n/R"``: n cycles per output turn, ``"nm"``:
        n times the gear's factor m, or a sum such as ``"2m+1/R"``.
    gear : Gear or None
        The gear; needed for ``"n/R"``, ``"nm"`` and sums only.

    Returns
    -------
    float or Fraction
        Cycles per motor turn; exact for texts.

    Raises
    ------
    ValueError
        If the order is not one, or is given by the gear and there is none.
    """
    order = _check_order(order)
    if isinstance(order, float):
        return order
    if needs_gear(order) and gear is None:
        raise ValueError(f'the order "{order}" needs the gear')
    beside = _BESIDE.fullmatch(order)
    if gear is not None and beside is not None:
        wave = gear.exact_factor_m if beside[2] else Fraction(1)
        sign = 1 if beside[3] == "+" else -1
        return int(beside[1]) * wave + sign * int(beside[4]) / Fraction(gear.ratio)
    if gear is not None and order.endswith("m"):
        return int(order.removesuffix("m")) * gear.exact_factor_m
    numerator, denominator = order.split("/")
    if gear is not None and denominator == "R":
        return int(numerator) / Fraction(gear.ratio)
    return Fraction(int(numerator), int(denominator))


def repeated_order(orders: tuple[float | str, ...], gear: Gear | None) -> float | str | None:
    """Return the first order that equals an earlier one to rounding, or None.

    Orders ``"n/R"`` and ``"nm"`` are compared only where the gear is known.
    """
    seen: list[float] = []
    for order in orders:
        if gear is None and needs_gear(order):
            continue
        value = float(order_value(order, gear))
        if any(math.isclose(value, other, rel_tol=1e-9) for other in seen):
            return order
        seen.append(value)
    return None


def check_orders_differ(orders: tuple[float | str, ...]) -> None:
    """Refuse orders of which two are equal whatever the gear.

    Raises
    ------
    ValueError
        If an order is there twice.
    """
    repeated = repeated_order(orders, None)
    if repeated is not None:
        raise ValueError(f"has the order {repeated} twice in orders; remove one of them")
