"""The section ``[torque_calibration]``: from the sensor voltage to torque."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from strainwave.joint.base import ListOf, Unit
from strainwave.joint.provenance import Section


class TorqueCalibration(Section):
    """Gain, zero and linearisation of the sensor, and how well they are known.

    With u = gain_Nm_per_V (voltage - zero_V) and FS = gear.rated_torque_Nm,
    torque = u + FS sum over n = 2 to 5 of c_n (u / FS)^n, where the c_n are `linearisation`. Side
    loads are not among what it takes: where they are measured, the sensitivities say what they add.
    """

    gain_Nm_per_V: Annotated[float, Unit("Nm/V")] = Field(
        description="Torque per sensor voltage; negative where the voltage falls with torque"
    )
    zero_V: Annotated[float, Unit("V")] = Field(
        default=0.0, description="Sensor voltage without torque"
    )
    linearisation: ListOf[Annotated[float, Unit("1")]] = Field(
        default=(),
        max_length=4,
        description="Coefficients c_2 to c_5, in this order; absent ones are 0",
    )
    gain_standard_uncertainty_Nm_per_V: Annotated[float, Unit("Nm/V")] | None = Field(
        default=None, ge=0.0, description="Standard uncertainty of gain_Nm_per_V"
    )
    consistency: Annotated[float, Unit("1")] | None = Field(
        default=None,
        ge=0.0,
        description="Consistency measure: standard deviation of the gain over the experiments, "
        "divided by its mean",
    )
    experiment_count: Annotated[int, Unit("1")] | None = Field(
        default=None, ge=1, description="Number of experiments behind gain and consistency"
    )
    hysteresis_percent_of_rated_torque: Annotated[float, Unit("%FS")] | None = Field(
        default=None,
        ge=0.0,
        description="Largest difference between increasing and decreasing load",
    )
    linearity_error_percent_of_rated_torque: Annotated[float, Unit("%FS")] | None = Field(
        default=None, ge=0.0, description="Largest distance from the straight line, as a magnitude"
    )
    lowest_torque_Nm: Annotated[float, Unit("Nm")] | None = Field(
        default=None, description="Lowest torque applied during calibration"
    )
    highest_torque_Nm: Annotated[float, Unit("Nm")] | None = Field(
        default=None, description="Highest torque applied during calibration"
    )

    axial_force_sensitivity_Nm_per_N: Annotated[float, Unit("Nm/N")] | None = Field(
        default=None,
        description="Torque shown per axial force; sensitivity times force is to be subtracted",
    )
    radial_force_sensitivity_Nm_per_N: Annotated[float, Unit("Nm/N")] | None = Field(
        default=None,
        description="Torque shown per radial force; sensitivity times force is to be subtracted",
    )
    tilting_moment_sensitivity: Annotated[float, Unit("1")] | None = Field(
        default=None,
        description="Torque shown per tilting moment; sensitivity times moment is to be subtracted",
    )

    @model_validator(mode="after")
    def _is_consistent(self) -> TorqueCalibration:
        if self.gain_Nm_per_V == 0.0:
            raise ValueError("has gain_Nm_per_V = 0; expected a gain other than 0")
        low, high = self.lowest_torque_Nm, self.highest_torque_Nm
        if (low is None) != (high is None):
            raise ValueError(
                "gives one end of the calibrated range only; expected lowest_torque_Nm and "
                "highest_torque_Nm together, or neither"
            )
        if low is not None and high is not None and low >= high:
            raise ValueError(
                f"has lowest_torque_Nm = {low:g} and highest_torque_Nm = {high:g}; expected the "
                "highest above the lowest, so check whether the two were swapped"
            )
        return self
