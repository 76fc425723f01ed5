"""The joint: everything a joint file says, checked across its sections."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import Field, ValidationInfo, field_validator, model_validator

from strainwave.joint.base import FilePart, Line, Lines, ListOf
from strainwave.joint.fields import models_of
from strainwave.joint.gains import Gains
from strainwave.joint.gauges import Gauges
from strainwave.joint.gear import Gear
from strainwave.joint.history import HistoryEntry
from strainwave.joint.misalignment import Misalignment
from strainwave.joint.orders import needs_gear, repeated_order
from strainwave.joint.oscillator_filter import OscillatorFilter
from strainwave.joint.provenance import Section
from strainwave.joint.ripple_filter import RippleFilter
from strainwave.joint.signals import Signals
from strainwave.joint.temperature import Temperature
from strainwave.joint.torque_calibration import TorqueCalibration


class Identity(FilePart):
    """Which joint the file is about: the section ``[joint]``."""

    name: Line = Field(description="Name of the joint")
    serial: Line | None = Field(default=None, description="Serial number of the joint or gear")
    notes: Lines | None = Field(default=None, description="Anything a reader should know")


class Joint(FilePart):
    """What is known of a joint.

    Every section but ``[joint]`` is optional; one that is there has its provenance.
    """

    identity: Identity = Field(alias="joint", description="Which joint the file is about")
    gear: Gear | None = Field(default=None, description="The strain wave gear")
    signals: Signals | None = Field(
        default=None, description="How a recording of this joint is read"
    )
    gauges: Gauges | None = Field(default=None, description="Strain gauges and electronics")
    gains: Gains | None = Field(default=None, description="Gain of every gauge")
    torque_calibration: TorqueCalibration | None = Field(
        default=None, description="From sensor voltage to torque"
    )
    ripple_filter: (
        Annotated[OscillatorFilter | RippleFilter, Field(discriminator="method")] | None
    ) = Field(default=None, description="What is removed from the torque, and how")
    misalignment: Misalignment | None = Field(
        default=None, description="Torque that repeats with the output's angle"
    )
    temperature: Temperature | None = Field(default=None, description="Drift with temperature")
    history: ListOf[HistoryEntry] | None = Field(
        default=None,
        min_length=1,
        description="What was replaced or removed since the file began, in the order of the changes",
    )

    @field_validator(
        "gear",
        "signals",
        "gauges",
        "gains",
        "torque_calibration",
        "ripple_filter",
        "misalignment",
        "temperature",
        mode="after",
    )
    @classmethod
    def _has_provenance(cls, section: Section | None, info: ValidationInfo) -> Section | None:
        if section is not None and section.provenance is None:
            raise ValueError(
                f"lacks the section [{info.field_name}.provenance], which says where the values "
                "come from; add it with the keys input, created and version"
            )
        return section

    @model_validator(mode="after")
    def _gauges_agree(self) -> Joint:
        if self.gauges is None:
            return self
        count = self.gauges.channel_count
        wiring = f'{count} channel(s): {len(self.gauges.rosettes)} rosette(s) wired as "{{}}"'
        wiring = wiring.format(self.gauges.wiring)
        if self.gains is not None and len(self.gains.gains) != count:
            raise ValueError(
                f"[gains] has {len(self.gains.gains)} gains, but [gauges] has {wiring}; expected "
                "one gain for each channel, so identify the gains again or correct [gauges]"
            )
        if self.signals is not None and len(self.signals.gauges) not in (0, count):
            raise ValueError(
                f"[signals] has {len(self.signals.gauges)} gauge columns, but [gauges] has "
                f"{wiring}; expected one column for each channel, or none"
            )
        return self

    @model_validator(mode="after")
    def _converter_codes_can_be_read(self) -> Joint:
        columns = () if self.signals is None else self.signals.gauges
        if self.signals is not None and self.signals.sensor_voltage is not None:
            columns += (self.signals.sensor_voltage,)
        in_codes = any(column.unit == "counts" for column in columns)
        if in_codes and self.gauges is not None and self.gauges.converter_bits is None:
            raise ValueError(
                '[signals] has a column in "counts", but [gauges] does not describe the converter; '
                "add converter_bits, converter_minimum_V and converter_maximum_V to [gauges]"
            )
        return self

    @model_validator(mode="after")
    def _gear_is_there_where_it_is_needed(self) -> Joint:
        linearised = self.torque_calibration is not None and self.torque_calibration.linearisation
        if linearised and self.gear is None:
            raise ValueError(
                "[torque_calibration] has a linearisation, which is relative to the rated torque, "
                "but there is no section [gear]; add [gear] with rated_torque_Nm"
            )
        loaded = isinstance(self.ripple_filter, RippleFilter) and self.ripple_filter.load_orders
        if loaded and self.gear is None:
            raise ValueError(
                "[ripple_filter] has load_orders, whose load is relative to the rated torque, but "
                "there is no section [gear]; add [gear] with rated_torque_Nm"
            )
        return self

    @model_validator(mode="after")
    def _orders_suit_the_gear(self) -> Joint:
        if self.ripple_filter is None:
            return self
        orders = self.ripple_filter.orders
        if self.gear is None:
            for order in orders:
                if needs_gear(order):
                    symbol, meaning = ("R", "ratio") if "R" in str(order) else ("m", "factor m")
                    raise ValueError(
                        f'[ripple_filter] has the order "{order}", where {symbol} is the {meaning} '
                        "of the gear, but there is no section [gear]; add [gear], or write the "
                        "order as a number"
                    )
            return self
        repeated = repeated_order(orders, self.gear)
        if repeated is not None:
            raise ValueError(
                f"[ripple_filter] has the order {repeated} twice in orders, for the ratio "
                f"{self.gear.ratio:g} and the factor m {self.gear.factor_m:g} of [gear]; remove "
                "one of them"
            )
        return self


def _section_models() -> dict[str, tuple[type[Section], ...]]:
    models: dict[str, tuple[type[Section], ...]] = {}
    for name, field in Joint.model_fields.items():
        sections = tuple(model for model in models_of(field) if issubclass(model, Section))
        if sections:
            models[name] = sections
    return models


SECTION_MODELS: Final[dict[str, tuple[type[Section], ...]]] = _section_models()
"""The models of each section that commands fill, by its name in the file.

It is one model, but for ``ripple_filter``, which has one for each ``method``.
"""

SECTION_NAMES: Final[tuple[str, ...]] = tuple(SECTION_MODELS)
"""Names of the sections that commands fill, in the order of the file."""
