"""What a person says of the load's weight."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from strainwave.errors import InputError

STANDARD_GRAVITY_M_S2: Final = 9.80665


@dataclass(frozen=True)
class Payload:
    """A mass on an arm; None where it was not given.

    Attributes
    ----------
    mass_kg : float or None
        Mass.
    lever_arm_m : float or None
        Distance of its centre from the joint's axis.
    gravity_m_s2 : float
        Acceleration of free fall.
    axis_tilt_deg : float
        Angle of the joint's axis against the horizontal: 0 for a horizontal axis, 90 for a vertical
        one, where weight makes no torque.
    horizontal_angle_deg : float or None
        Angle of the output at which the arm is horizontal and weight pulls against a positive
        torque: where its torque is largest.
    """

    mass_kg: float | None = None
    lever_arm_m: float | None = None
    gravity_m_s2: float = STANDARD_GRAVITY_M_S2
    axis_tilt_deg: float = 0.0
    horizontal_angle_deg: float | None = None

    def __post_init__(self) -> None:
        _in_range("--payload-mass", self.mass_kg, "kg", 0.0, 1e5)
        _in_range("--lever-arm", self.lever_arm_m, "m", 0.0, 1e3)
        _in_range("--gravity", self.gravity_m_s2, "m/s^2", 0.0, 100.0)
        _in_range("--axis-tilt-deg", self.axis_tilt_deg, "degrees", -90.0, 90.0)
        _in_range("--horizontal-angle-deg", self.horizontal_angle_deg, "degrees", -1e6, 1e6)
        if (self.mass_kg is None) != (self.lever_arm_m is None):
            given, lacking = "--payload-mass", "--lever-arm"
            if self.mass_kg is None:
                given, lacking = lacking, given
            raise InputError(f"{given} is given without {lacking}; expected both, so add {lacking}")

    @property
    def is_given(self) -> bool:
        """Whether mass and lever arm are there."""
        return self.mass_kg is not None

    @property
    def torque_per_mass_Nm_kg(self) -> float:
        """Largest torque of a kilogram."""
        assert self.lever_arm_m is not None
        # The cosine of exactly 90 degrees is 0.
        upright = abs(self.axis_tilt_deg) == 90.0
        share = 0.0 if upright else math.cos(math.radians(self.axis_tilt_deg))
        return self.gravity_m_s2 * self.lever_arm_m * share

    @property
    def largest_torque_Nm(self) -> float:
        """Largest torque of the weight, at the output."""
        assert self.mass_kg is not None
        return self.mass_kg * self.torque_per_mass_Nm_kg


def _in_range(option: str, value: float | None, what: str, least: float, most: float) -> None:
    if value is not None and not least <= value <= most:
        raise InputError(
            f"{option} {value:g}: expected a number of {what} from {least:g} to {most:g}; correct "
            "this value"
        )
