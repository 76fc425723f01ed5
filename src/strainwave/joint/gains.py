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


class GaugeSignal(FilePart):
    """What one gauge's signal is made of besides torque: its zero and its fluctuation."""

    zero_V: Annotated[float, Unit("V")] = Field(
        description="Signal without torque, the fluctuation taken out"
    )
    amplitudes_V: ListOf[Annotated[float, Unit("V")]] = Field(
        max_length=4, description="Amplitude of the fluctuation's harmonics i = 1, 2, ..."
    )
    phases_rad: ListOf[Annotated[float, Unit("rad")]] = Field(
        max_length=4,
        description="Phase of each: the fluctuation is the sum of amplitude times "
        "sin(2 i m beta + phase), the gauge's position included",
    )

    @model_validator(mode="after")
    def _has_a_phase_an_amplitude(self) -> GaugeSignal:
        if len(self.phases_rad) != len(self.amplitudes_V):
            raise ValueError(
                f"has {len(self.amplitudes_V)} amplitudes_V but {len(self.phases_rad)} phases_rad; "
                "expected one phase an amplitude"
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
    gauge_signals: ListOf[GaugeSignal] | None = Field(
        default=None,
        description="What each gauge reads besides torque, so that one that fails is found",
    )
    noise_V: Annotated[float, Unit("V")] | None = Field(
        default=None, gt=0.0, description="Standard deviation of the noise of one gauge"
    )
    consistency_limit_V: Annotated[float, Unit("V")] | None = Field(
        default=None,
        gt=0.0,
        description="Length of what sound gauges leave beside torque and fluctuation, at most, "
        "without torque",
    )
    consistency_limit_share: Annotated[float, Unit("1")] | None = Field(
        default=None,
        ge=0.0,
        description="By how much that length grows with that of the torque in the gauges' signals; "
        "gauges are held against each other only where both are given",
    )
    detection_time_s: Annotated[float, Unit("s")] | None = Field(
        default=None,
        gt=0.0,
        le=10.0,
        description="For how long a gauge is seen to be wrong until it is lost for good; where left "
        "out, 0.01",
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

    @model_validator(mode="after")
    def _gauge_signals_agree(self) -> Gains:
        if self.gauge_signals is None:
            return self
        count = len(self.gains)
        if len(self.gauge_signals) != count:
            raise ValueError(
                f"has {count} gains but {len(self.gauge_signals)} gauge_signals; expected one for "
                "each gauge, or none"
            )
        if len({len(signal.amplitudes_V) for signal in self.gauge_signals}) > 1:
            raise ValueError(
                "has gauge_signals of different numbers of harmonics; expected as many "
                "amplitudes_V for every gauge"
            )
        return self
