"""The section ``[ripple_filter]`` of method ``oscillator``: the filter as it was published."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from strainwave.joint.base import ListOf, Unit
from strainwave.joint.orders import ORDERS_IN_WORDS, Order, check_orders_differ
from strainwave.joint.provenance import Section


class OscillatorFilter(Section):
    """The oscillator filter: a Kalman filter whose oscillators turn with the motor.

    Taghirad and Belanger 1999, eq. (9)-(14). Each order has two states, both in Nm.
    """

    method: Literal["oscillator"] = Field(description="The filter these values belong to")
    orders: ListOf[Order] = Field(
        min_length=1,
        description=f"What is removed: {ORDERS_IN_WORDS}",
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
    def _orders_differ(self) -> OscillatorFilter:
        check_orders_differ(self.orders)
        given = len(self.process_noise_variances_Nm2)
        if given not in (1, len(self.orders)):
            raise ValueError(
                f"has {given} process_noise_variances_Nm2 and {len(self.orders)} orders; expected "
                "one variance for all orders, or one for each"
            )
        return self
