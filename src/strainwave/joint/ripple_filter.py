"""The section ``[ripple_filter]``: what is removed from the torque, and how."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from strainwave.joint.base import ListOf, Unit
from strainwave.joint.provenance import Section

_FRACTION = re.compile(r"([1-9][0-9]{0,8})/([1-9][0-9]{0,8}|R)")


def _check_order(value: Any) -> Any:
    """Take a number for a float, and leave a fraction as it is written."""
    if isinstance(value, str) and _FRACTION.fullmatch(value):
        return value
    if isinstance(value, int | float) and not isinstance(value, bool) and 0 < value <= 1000:
        return float(value)
    raise ValueError(
        'expected a number of cycles per motor turn above 0 and up to 1000, or a fraction such as "1/100" or '
        '"1/R" (R: ratio of the gear)'
    )


Order = Annotated[float | str, BeforeValidator(_check_order), Unit("cycles per motor turn")]


def order_value(order: float | str, ratio: float | None) -> float | Fraction:
    """Return an order as cycles per motor turn.

    Parameters
    ----------
    order : float or str
        A number, a fraction such as ``"1/100"``, or ``"n/R"``: n cycles per output turn.
    ratio : float or None
        Motor turns per output turn; needed for ``"n/R"`` only.

    Returns
    -------
    float or Fraction
        Cycles per motor turn; exact for fractions.

    Raises
    ------
    ValueError
        If the order is not one, or is ``"n/R"`` and there is no ratio.
    """
    order = _check_order(order)
    if isinstance(order, float):
        return order
    numerator, denominator = order.split("/")
    if denominator != "R":
        return Fraction(int(numerator), int(denominator))
    if ratio is None:
        raise ValueError(f'the order "{order}" needs the ratio of the gear')
    return int(numerator) / Fraction(ratio)


def repeated_order(orders: tuple[float | str, ...], ratio: float | None) -> float | str | None:
    """Return the first order that equals an earlier one to rounding, or None.

    Orders ``"n/R"`` are compared only where the ratio is known.
    """
    seen: list[float] = []
    for order in orders:
        if ratio is None and isinstance(order, str) and order.endswith("R"):
            continue
        value = float(order_value(order, ratio))
        if any(math.isclose(value, other, rel_tol=1e-9) for other in seen):
            return order
        seen.append(value)
    return None


class RippleFilter(Section):
    """The oscillator filter: a Kalman filter whose oscillators turn with the motor.

    Taghirad and Belanger 1999, eq. (9)-(14). Each order has two states, both in Nm.
    """

    method: Literal["oscillator"] = Field(description="The filter these values belong to")
    orders: ListOf[Order] = Field(
        min_length=1,
        description='What is removed: numbers, fractions such as "1/100", or "n/R" for n cycles '
        "per output turn (R: ratio of the gear)",
    )
    process_noise_variances_Nm2: ListOf[Annotated[float, Field(ge=0.0), Unit("Nm^2")]] = Field(
        min_length=1,
        description="Variance that each state of an order gains per sample (Q): one for all "
        "orders, or one for each",
    )
    measurement_noise_variance_Nm2: Annotated[float, Unit("Nm^2")] = Field(
        gt=0.0, description="Variance of the measured less the expected torque (R)"
    )
    initial_variance_Nm2: Annotated[float, Unit("Nm^2")] = Field(
        gt=0.0, description="Variance of each state at the start (P(0))"
    )
    sample_period_s: Annotated[float, Unit("s")] = Field(
        gt=0.0, le=1.0, description="Time between two samples"
    )
    rotation_source: Literal["speed", "angle"] = Field(
        default="speed",
        description="What turns the oscillators: speed times sample period, as published, or the "
        "difference of motor angles",
    )
    minimum_travel_rad: Annotated[float, Unit("rad")] | None = Field(
        default=None,
        ge=0.0,
        le=1.0,
        description="Motor angle without which nothing is learned; 0 is off, left out is the "
        "filter's own",
    )
    minimum_speed_rad_s: Annotated[float, Unit("rad/s")] | None = Field(
        default=None,
        ge=0.0,
        le=100.0,
        description="Motor speed below which nothing is learned; 0 is off, left out is the "
        "filter's own",
    )
    variance_limit_ratio: Annotated[float, Unit("1")] | None = Field(
        default=None,
        ge=0.0,
        description="Largest variance as a multiple of the process noise; 0 is off, left out is "
        "the filter's own",
    )

    @model_validator(mode="after")
    def _orders_differ(self) -> RippleFilter:
        repeated = repeated_order(self.orders, None)
        if repeated is not None:
            raise ValueError(f"has the order {repeated} twice in orders; remove one of them")
        given = len(self.process_noise_variances_Nm2)
        if given not in (1, len(self.orders)):
            raise ValueError(
                f"has {given} process_noise_variances_Nm2 and {len(self.orders)} orders; expected "
                "one variance for all orders, or one for each"
            )
        return self
