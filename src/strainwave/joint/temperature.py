"""The section ``[temperature]``: how zero and gain change with temperature."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from strainwave.joint.base import Unit
from strainwave.joint.provenance import Section

_COLDEST_DEGC = -273.15
_HOTTEST_DEGC = 1000.0


class Temperature(Section):
    """Drift of the sensor against a reference temperature.

    At temperature t, and with d = t - `reference_temperature_degC`, the zero is
    zero_V + zero_drift_V_per_K d and the gain is gain_Nm_per_V (1 + gain_drift_per_K d).
    """

    reference_temperature_degC: Annotated[float, Unit("degC")] = Field(
        ge=_COLDEST_DEGC,
        le=_HOTTEST_DEGC,
        description="Temperature at which torque_calibration holds as it stands",
    )
    zero_drift_V_per_K: Annotated[float, Unit("V/K")] = Field(
        description="Change of the zero with temperature"
    )
    gain_drift_per_K: Annotated[float, Unit("1/K")] = Field(
        description="Relative change of the gain with temperature"
    )
    zero_drift_standard_uncertainty_V_per_K: Annotated[float, Unit("V/K")] | None = Field(
        default=None, ge=0.0, description="Standard uncertainty of zero_drift_V_per_K"
    )
    gain_drift_standard_uncertainty_per_K: Annotated[float, Unit("1/K")] | None = Field(
        default=None, ge=0.0, description="Standard uncertainty of gain_drift_per_K"
    )
    lowest_temperature_degC: Annotated[float, Unit("degC")] | None = Field(
        default=None,
        ge=_COLDEST_DEGC,
        le=_HOTTEST_DEGC,
        description="Lowest temperature at which the drift was measured",
    )
    highest_temperature_degC: Annotated[float, Unit("degC")] | None = Field(
        default=None,
        ge=_COLDEST_DEGC,
        le=_HOTTEST_DEGC,
        description="Highest temperature at which the drift was measured",
    )

    @model_validator(mode="after")
    def _range_is_one(self) -> Temperature:
        low, high = self.lowest_temperature_degC, self.highest_temperature_degC
        if (low is None) != (high is None):
            raise ValueError(
                "gives one end of the temperature range only; expected lowest_temperature_degC "
                "and highest_temperature_degC together, or neither"
            )
        if low is not None and high is not None and low >= high:
            raise ValueError(
                f"has lowest_temperature_degC = {low:g} and highest_temperature_degC = {high:g}; "
                "expected the highest above the lowest, so check whether the two were swapped"
            )
        return self
