"""The section ``[misalignment]``: torque that repeats with the output's angle."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from strainwave.joint.base import FilePart, ListOf, Unit
from strainwave.joint.provenance import Section


class MisalignmentTerm(FilePart):
    """One component of the misalignment torque."""

    cycles_per_output_turn: Annotated[int, Unit("1")] = Field(
        ge=1, le=1000, description="Number n of periods in one turn of the output"
    )
    cosine_Nm: Annotated[float, Unit("Nm")] = Field(description="Amplitude of the cosine, a_n")
    sine_Nm: Annotated[float, Unit("Nm")] = Field(description="Amplitude of the sine, b_n")
    standard_uncertainty_Nm: Annotated[float, Unit("Nm")] | None = Field(
        default=None, ge=0.0, description="Standard uncertainty of the amplitude"
    )


class Misalignment(Section):
    """Misalignment torque that the sensor reports in addition to the true torque.

    It is the sum over the terms of a_n cos(n gamma) + b_n sin(n gamma), with gamma the output
    angle less `zero_of_output_angle_rad`; the corrected torque is the measured one less this sum.
    """

    zero_of_output_angle_rad: Annotated[float, Unit("rad")] = Field(
        default=0.0, description="Output angle from which the terms are counted"
    )
    terms: ListOf[MisalignmentTerm] = Field(
        min_length=1, description="The components, each number of cycles once"
    )
    lowest_output_angle_rad: Annotated[float, Unit("rad")] | None = Field(
        default=None,
        description="Lowest output angle at which the terms were measured; absent where it was a "
        "whole turn",
    )
    highest_output_angle_rad: Annotated[float, Unit("rad")] | None = Field(
        default=None, description="Highest output angle at which the terms were measured"
    )

    @model_validator(mode="after")
    def _range_is_one(self) -> Misalignment:
        low, high = self.lowest_output_angle_rad, self.highest_output_angle_rad
        if (low is None) != (high is None):
            raise ValueError(
                "gives one end of the range of angles only; expected lowest_output_angle_rad and "
                "highest_output_angle_rad together, or neither"
            )
        if low is not None and high is not None and low >= high:
            raise ValueError(
                f"has lowest_output_angle_rad = {low:g} and highest_output_angle_rad = {high:g}; "
                "expected the highest above the lowest, so check whether the two were swapped"
            )
        return self

    @model_validator(mode="after")
    def _terms_differ(self) -> Misalignment:
        cycles = [term.cycles_per_output_turn for term in self.terms]
        for number in cycles:
            if cycles.count(number) > 1:
                raise ValueError(
                    f"has two terms with cycles_per_output_turn = {number}; add them up or "
                    "remove one of them"
                )
        return self
