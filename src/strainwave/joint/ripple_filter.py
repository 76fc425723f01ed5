"""The section ``[ripple_filter]`` of method ``ripple``: strainwave's own filter."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from strainwave.joint.base import ListOf, Unit
from strainwave.joint.orders import ORDERS_IN_WORDS, Order, check_orders_differ, order_text
from strainwave.joint.provenance import Section

SUBSETS = ("load_orders", "speed_orders", "direction_orders", "kept_orders")
"""Keys that name some of the orders again; all but the last bring a pair of coefficients each."""

Coefficient = Annotated[float, Field(ge=-1e9, le=1e9), Unit("Nm")]
Deviation = Annotated[float, Field(ge=0.0, le=1e9), Unit("Nm")]


class RippleFilter(Section):
    """The ripple filter: a Kalman filter on true torque and on coefficients of the motor's angle.

    Each order has a cosine and a sine of order times motor angle, and further such pairs where its
    ripple grows with load or speed or differs with the direction of motion. The coefficients in
    `learned_coefficients_Nm` count from the zero of the motor angle with which they were learned.
    """

    method: Literal["ripple"] = Field(description="The filter these values belong to")
    orders: ListOf[Order] = Field(
        min_length=1,
        description=f"What is learned, and removed unless it is in kept_orders: {ORDERS_IN_WORDS}",
    )
    load_orders: ListOf[Order] = Field(
        default=(),
        description="Those of orders that also have a pair times the load, that is torque over "
        "gear.rated_torque_Nm; written as in orders",
    )
    speed_orders: ListOf[Order] = Field(
        default=(),
        description="Those of orders that also have a pair times motor speed, as a magnitude, over "
        "reference_speed_rad_s",
    )
    direction_orders: ListOf[Order] = Field(
        default=(),
        description="Those of orders that also have a pair times the direction of motion, 1 or -1",
    )
    kept_orders: ListOf[Order] = Field(
        default=(),
        description="Those of orders that are learned but left in the torque, because they are "
        "real torque",
    )
    memory_turns: Annotated[float, Unit("1")] = Field(
        ge=0.1,
        le=1e6,
        description="Memory in motor turns: ripple that changes within fewer turns is not "
        "followed, torque that repeats over more turns is taken for ripple",
    )
    torque_noise_Nm: Annotated[float, Unit("Nm")] = Field(
        ge=1e-9, le=1e9, description="Standard deviation of the noise of one sample"
    )
    torque_walk_Nm_per_sqrt_s: Annotated[float, Unit("Nm/sqrt(s)")] = Field(
        ge=1e-9,
        le=1e9,
        description="How fast true torque wanders: its standard deviation after one second",
    )
    initial_amplitude_Nm: Annotated[float, Unit("Nm")] | None = Field(
        default=None,
        ge=1e-9,
        le=1e9,
        description="Standard deviation of each coefficient before anything is learned; left out "
        "is the filter's own",
    )
    reference_speed_rad_s: Annotated[float, Unit("rad/s")] | None = Field(
        default=None,
        ge=1e-3,
        le=1e6,
        description="Motor speed at which the pairs of speed_orders count once; left out is the "
        "filter's own",
    )
    minimum_speed_rad_s: Annotated[float, Unit("rad/s")] | None = Field(
        default=None,
        ge=0.0,
        le=100.0,
        description="Motor speed below which nothing is learned; 0 is off, left out is the "
        "filter's own",
    )
    learned_coefficients_Nm: ListOf[Coefficient] | None = Field(
        default=None,
        description="Coefficients to start with: cosine and sine of each pair, pairs in the order "
        "of orders and, within one, constant, load, speed, direction",
    )
    learned_standard_deviations_Nm: ListOf[Deviation] | None = Field(
        default=None,
        description="Standard deviation of each of learned_coefficients_Nm, in the same order",
    )
    learned_innovation_scale_Nm: Annotated[float, Unit("Nm")] | None = Field(
        default=None,
        ge=0.0,
        le=1e9,
        description="Size of the innovations when the coefficients were learned; left out is the "
        "filter's own",
    )

    @property
    def coefficient_count(self) -> int:
        """Number of coefficients: cosine and sine of every pair of every order."""
        with_further_pairs = (self.load_orders, self.speed_orders, self.direction_orders)
        return 2 * (len(self.orders) + sum(len(orders) for orders in with_further_pairs))

    @model_validator(mode="after")
    def _orders_agree(self) -> RippleFilter:
        check_orders_differ(self.orders)
        for key in SUBSETS:
            subset: tuple[float | str, ...] = getattr(self, key)
            for position, order in enumerate(subset):
                if order not in self.orders:
                    known = ", ".join(order_text(each) for each in self.orders)
                    raise ValueError(
                        f"has the order {order_text(order)} in {key}, but not in orders; expected "
                        f"some of {known}, written as there, so add it to orders or remove it"
                    )
                if order in subset[:position]:
                    raise ValueError(
                        f"has the order {order_text(order)} twice in {key}; remove one of them"
                    )
        return self

    @model_validator(mode="after")
    def _what_was_learned_is_whole(self) -> RippleFilter:
        lists = {
            key: values
            for key in ("learned_coefficients_Nm", "learned_standard_deviations_Nm")
            if (values := getattr(self, key)) is not None
        }
        if len(lists) == 1 or (not lists and self.learned_innovation_scale_Nm is not None):
            raise ValueError(
                "gives only a part of what was learned; expected learned_coefficients_Nm and "
                "learned_standard_deviations_Nm together, with or without "
                "learned_innovation_scale_Nm, so add what is missing or remove them all"
            )
        for key, values in lists.items():
            if len(values) != self.coefficient_count:
                raise ValueError(
                    f"has {len(values)} {key}; expected {self.coefficient_count}, a cosine and a "
                    "sine of each pair (one for every entry of orders, load_orders, speed_orders "
                    "and direction_orders), so learn them again with these orders or remove them"
                )
        return self
