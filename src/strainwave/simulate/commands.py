"""What drives the motor of an integrated motion: a current, or a speed controller."""

from __future__ import annotations

from dataclasses import dataclass

from strainwave.simulate.checks import require_number
from strainwave.simulate.trajectories import Profile, require_profile


@dataclass(frozen=True)
class CurrentCommand:
    """The current is given: the motor runs as it will.

    Parameters
    ----------
    current : Profile
        Motor current, A; limited to what the motor can carry.
    """

    current: Profile

    def __post_init__(self) -> None:
        require_profile("current", self.current)


@dataclass(frozen=True)
class SpeedCommand:
    """A speed controller, proportional and integral, sets the current.

    Parameters
    ----------
    motor_speed : Profile
        Speed to follow, rad/s.
    proportional_A_s_per_rad : float
        Current per speed error, at least 0.
    integral_A_per_rad : float
        Current per integrated speed error, at least 0.
    feedforward_A_s2_per_rad : float
        Current per wanted acceleration, at least 0.
    """

    motor_speed: Profile
    proportional_A_s_per_rad: float = 0.1
    integral_A_per_rad: float = 1.0
    feedforward_A_s2_per_rad: float = 0.0

    def __post_init__(self) -> None:
        require_profile("motor_speed", self.motor_speed)
        require_number(
            "proportional_A_s_per_rad", self.proportional_A_s_per_rad, "A s/rad", minimum=0.0
        )
        require_number("integral_A_per_rad", self.integral_A_per_rad, "A/rad", minimum=0.0)
        require_number(
            "feedforward_A_s2_per_rad", self.feedforward_A_s2_per_rad, "A s^2/rad", minimum=0.0
        )


Command = CurrentCommand | SpeedCommand
