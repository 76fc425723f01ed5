"""The section ``[gauges]``: the strain gauges, their bridge, amplifier and converter."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from strainwave.joint.base import FilePart, ListOf, Unit
from strainwave.joint.provenance import Section

Wiring = Literal["half_bridge_each", "full_bridge"]


class Rosette(FilePart):
    """One rosette: two gauges at 90 degrees to each other on one pad."""

    position_rad: Annotated[float, Unit("rad")] = Field(
        ge=-2.0 * math.pi,
        le=2.0 * math.pi,
        description="Place on the flexspline, counted against the wave generator's angle beta: "
        "harmonic i leads by 2 i position_rad, so that gauge j of M equally spaced ones, at "
        "pi (j-1)/M, leads by 2 i pi (j-1)/M",
    )
    radius_m: Annotated[float, Unit("m")] | None = Field(
        default=None, gt=0.0, le=10.0, description="Distance from the flexspline's axis"
    )
    orientation_error_rad: Annotated[float, Unit("rad")] = Field(
        default=0.0,
        ge=-math.pi / 4.0,
        le=math.pi / 4.0,
        description="Rotation of the pad away from its ideal direction, 45 degrees to the radius",
    )
    gauge_factor: Annotated[float, Unit("1")] = Field(
        gt=0.0,
        le=1000.0,
        description="Relative change of resistance per strain, about 2 for metal foil",
    )


class Gauges(Section):
    """Strain gauges on the flexspline and the electronics behind them."""

    wiring: Wiring = Field(
        description="`half_bridge_each`: every rosette is a channel of its own; `full_bridge`: "
        "all rosettes (an even number) form one bridge with one output"
    )
    bridge_supply_V: Annotated[float, Unit("V")] = Field(
        gt=0.0, le=1000.0, description="Supply voltage of the bridge"
    )
    amplifier_gain: Annotated[float, Unit("1")] = Field(
        gt=0.0, le=1e9, description="Voltage gain from the bridge to the converter"
    )
    amplifier_offset_V: Annotated[float, Unit("V")] = Field(
        default=0.0, description="Voltage at the amplifier's output for a balanced bridge"
    )
    converter_bits: Annotated[int, Unit("bit")] | None = Field(
        default=None, ge=1, le=24, description="Resolution of the analogue-to-digital converter"
    )
    converter_minimum_V: Annotated[float, Unit("V")] | None = Field(
        default=None, description="Voltage of the converter's lowest code"
    )
    converter_maximum_V: Annotated[float, Unit("V")] | None = Field(
        default=None,
        description="Upper end of the converter's range, one step above its highest code",
    )
    converter_lowest_code: Annotated[int, Unit("1")] = Field(
        default=0,
        ge=-(2**23),
        le=0,
        description="Code at converter_minimum_V: 0 for straight binary, -2^(bits-1) for two's "
        "complement",
    )
    torn_gauge_rail: Literal["lower", "upper"] | None = Field(
        default=None,
        description="Rail to which a torn gauge drives its amplifier, where the wiring says which",
    )
    rosettes: ListOf[Rosette] = Field(
        min_length=1, description="The rosettes; gauge 1 is the first of them"
    )

    @model_validator(mode="after")
    def _is_consistent(self) -> Gauges:
        converter = {
            "converter_bits": self.converter_bits,
            "converter_minimum_V": self.converter_minimum_V,
            "converter_maximum_V": self.converter_maximum_V,
        }
        missing = [key for key, value in converter.items() if value is None]
        if missing and len(missing) < len(converter):
            raise ValueError(
                f"describes the converter in part, without {' and '.join(missing)}; expected "
                f"{', '.join(converter)} together, or none of them"
            )
        low, high = self.converter_minimum_V, self.converter_maximum_V
        if low is not None and high is not None and low >= high:
            raise ValueError(
                f"has converter_minimum_V = {low:g} and converter_maximum_V = {high:g}; expected "
                "the maximum above the minimum, so check whether the two were swapped"
            )
        if self.wiring == "full_bridge" and len(self.rosettes) % 2:
            raise ValueError(
                f'has wiring = "full_bridge" with {len(self.rosettes)} rosette(s); expected an '
                'even number of them, or wiring = "half_bridge_each"'
            )
        return self

    @property
    def channel_count(self) -> int:
        """Number of separate bridge voltages: the number M of gauges that gains can weigh."""
        return len(self.rosettes) if self.wiring == "half_bridge_each" else 1
