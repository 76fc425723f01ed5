"""The section ``[gains]``: weights of the gauges that cancel the signal fluctuation."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from strainwave.joint.base import FilePart, ListOf, Unit
from strainwave.joint.provenance import Section


class GainsWithoutGauge(FilePart):
    """The gains to use when one gauge has failed."""

    gauge: Annotated[int, Unit("1")] = Field(
        ge=1, description="Number of the gauge that has failed, counted from 1"
    )
    gains: ListOf[Annotated[float, Unit("1")]] = Field(
        min_length=2, description="A gain for every gauge, 0 for the one that has failed"
    )
    noise_factor: Annotated[float, Unit("1")] | None = Field(
        default=None, gt=0.0, description="As noise_factor of the section, for these gains"
    )
    residual_fluctuation_V: Annotated[float, Unit("V")] | None = Field(
        default=None, ge=0.0, description="As residual_fluctuation_V of the section, for these"
    )

    @model_validator(mode="after")
    def _failed_gauge_has_no_weight(self) -> GainsWithoutGauge:
        if self.gauge > len(self.gains):
            raise ValueError(
                f"has gauge = {self.gauge}, but {len(self.gains)} gains; expected a gauge from 1 "
                f"to {len(self.gains)}"
            )
        if self.gains[self.gauge - 1] != 0.0:
            raise ValueError(
                f"gives the failed gauge {self.gauge} the gain {self.gains[self.gauge - 1]:g}; "
                "expected 0"
            )
        return self


class Gains(Section):
    """Gain of every gauge; the sensor voltage is the sum of gain times gauge voltage.

    Godler et al. 2000, eq. (6)-(11).
    """

    gains: ListOf[Annotated[float, Unit("1")]] = Field(
        min_length=1, description="One gain for each gauge, in the order of gauges.rosettes"
    )
    torque_sensitivities: ListOf[Annotated[float, Unit("1")]] | None = Field(
        default=None,
        description="Relative torque sensitivity of each gauge; only their ratios count",
    )
    harmonics: ListOf[Annotated[int, Unit("1")]] | None = Field(
        default=None,
        description="Harmonics i of the fluctuation that the gains cancel; harmonic i has "
        "2 i m cycles per motor turn",
    )
    noise_factor: Annotated[float, Unit("1")] | None = Field(
        default=None,
        ge=1.0,
        description="Noise power against equal gains, M sum(g^2) / (sum g)^2: 1 is the least",
    )
    condition_number: Annotated[float, Unit("1")] | None = Field(
        default=None,
        ge=1.0,
        description="Condition number of the equations the gains were solved from",
    )
    residual_fluctuation_V: Annotated[float, Unit("V")] | None = Field(
        default=None,
        ge=0.0,
        description="Root mean square of the fluctuation left in the weighted sum",
    )
    without_gauge: ListOf[GainsWithoutGauge] = Field(
        default=(), description="Gains solved beforehand for the loss of one gauge"
    )

    @model_validator(mode="after")
    def _lists_agree(self) -> Gains:
        count = len(self.gains)
        if not any(self.gains):
            raise ValueError("has no gain other than 0; expected at least one, so solve them again")
        if self.torque_sensitivities is not None and len(self.torque_sensitivities) != count:
            raise ValueError(
                f"has {count} gains but {len(self.torque_sensitivities)} torque_sensitivities; "
                "expected one for each gauge"
            )
        if self.harmonics is not None and (
            min(self.harmonics, default=0) < 1 or len(set(self.harmonics)) < len(self.harmonics)
        ):
            raise ValueError(
                f"has harmonics = {list(self.harmonics)}; expected different whole numbers from 1"
            )
        lost = [entry.gauge for entry in self.without_gauge]
        if len(set(lost)) < len(lost):
            raise ValueError("has two entries of without_gauge for one gauge; remove one of them")
        for entry in self.without_gauge:
            if len(entry.gains) != count:
                raise ValueError(
                    f"has {count} gains but {len(entry.gains)} in the entry of without_gauge for "
                    f"gauge {entry.gauge}; expected one for each gauge, 0 for the failed one"
                )
        return self
