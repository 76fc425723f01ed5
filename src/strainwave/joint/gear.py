"""The section ``[gear]``: ratio, configuration and rated torque of the strain wave gear."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from strainwave.joint.base import Unit, refuse_boolean
from strainwave.joint.provenance import Section

Configuration = Literal["fixed_circular_spline", "fixed_flexspline"]

RATIO_TOLERANCE = 1e-6
"""Largest relative difference between the ratio given and the one the teeth give."""


def _direction_of(values: dict[str, Any]) -> Literal[1, -1]:
    return -1 if values.get("configuration") == "fixed_circular_spline" else 1


class Gear(Section):
    """The strain wave gear, driven at the wave generator.

    With z_f teeth on the flexspline and z_c on the circular spline, and R = z_f / (z_c - z_f), the
    ratio is R with the output at the flexspline (fixed circular spline) and R + 1 with the output
    at the circular spline (fixed flexspline): Godler et al. 2000, eq. (1) and (2), as magnitudes.
    """

    configuration: Configuration = Field(
        description="The part that is fixed to the housing; the other one drives the output"
    )
    ratio: Annotated[float, Unit("1")] = Field(
        ge=1.0,
        le=1e6,
        description="Motor turns per output turn, as a magnitude (the sign is output_direction)",
    )
    output_direction: Annotated[Literal[1, -1], BeforeValidator(refuse_boolean), Unit("1")] = Field(
        default_factory=_direction_of,
        description="Sense of the output's rotation for positive motor rotation; where left "
        "out, -1 for a fixed circular spline and 1 for a fixed flexspline",
    )
    rated_torque_Nm: Annotated[float, Unit("Nm")] = Field(
        gt=0.0,
        description="Rated torque of the gear at its output: the full scale (FS) of every value "
        "given in percent of it",
    )
    flexspline_teeth: Annotated[int, Unit("1")] | None = Field(
        default=None, ge=1, le=1_000_000, description="Teeth of the flexspline, z_f"
    )
    circular_spline_teeth: Annotated[int, Unit("1")] | None = Field(
        default=None, ge=1, le=1_000_000, description="Teeth of the circular spline, z_c"
    )
    ratio_standard_uncertainty: Annotated[float, Unit("1")] | None = Field(
        default=None, ge=0.0, description="Standard uncertainty of ratio, where it was identified"
    )
    identified_factor_m: Annotated[float, Unit("1")] | None = Field(
        default=None,
        gt=0.0,
        le=10.0,
        description="Factor m found from a recording; replaces the one that follows from "
        "configuration and ratio",
    )

    @model_validator(mode="after")
    def _teeth_agree_with_ratio(self) -> Gear:
        flexspline, circular = self.flexspline_teeth, self.circular_spline_teeth
        if flexspline is None and circular is None:
            return self
        if flexspline is None or circular is None:
            missing = "flexspline_teeth" if flexspline is None else "circular_spline_teeth"
            raise ValueError(
                f"gives the teeth of one spline only; expected both or neither, so add {missing} "
                "or remove the other"
            )
        if circular <= flexspline:
            raise ValueError(
                f"has circular_spline_teeth = {circular} and flexspline_teeth = {flexspline}; "
                "expected more teeth on the circular spline, so check whether the two were swapped"
            )
        turning = flexspline if self.configuration == "fixed_circular_spline" else circular
        ratio = turning / (circular - flexspline)
        if not math.isclose(self.ratio, ratio, rel_tol=RATIO_TOLERANCE):
            raise ValueError(
                f"has ratio = {self.ratio:g}, but its teeth ({flexspline} and {circular}, "
                f"{self.configuration}) give {ratio:.9g}; correct the one that is wrong"
            )
        return self

    @property
    def factor_m(self) -> float:
        """Turns of the wave generator relative to the flexspline, per motor turn (dimensionless).

        The identified value where there is one; otherwise 1 for a fixed flexspline, and
        (ratio + 1) / ratio for a fixed circular spline, where the flexspline turns against the
        wave generator.
        """
        if self.identified_factor_m is not None:
            return self.identified_factor_m
        return 1.0 if self.configuration == "fixed_flexspline" else (self.ratio + 1.0) / self.ratio

    @property
    def exact_factor_m(self) -> Fraction:
        """The factor m of `factor_m` without rounding, for the ratio as it is given."""
        if self.identified_factor_m is not None:
            return Fraction(self.identified_factor_m)
        fixed_flexspline = self.configuration == "fixed_flexspline"
        return Fraction(1) if fixed_flexspline else 1 + 1 / Fraction(self.ratio)
