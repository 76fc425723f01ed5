"""A test station and its runs: driven, turned, or held and loaded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from strainwave.errors import ConfigurationError
from strainwave.simulate.acquisition import take_rows
from strainwave.simulate.checks import require_integer, require_number
from strainwave.simulate.commands import Command
from strainwave.simulate.description import Bridge, StationDescription
from strainwave.simulate.integration import integrated_motion
from strainwave.simulate.measuring import measure
from strainwave.simulate.motion import Drive, Motion, prescribed_motion
from strainwave.simulate.results import Run
from strainwave.simulate.trajectories import NOTHING, FloatArray, Profile, require_profile

__all__ = ["Bridge", "Station"]

MECHANICS_STEPS_PER_SAMPLE = 4
"""Between these the mechanics is a straight line: at 100 Hz and 4 kHz an error of 0.3 %."""


@dataclass(frozen=True)
class Station(StationDescription):
    """A simulated test station.  Torques count in the motor's sense of rotation.

    Its fields are those of `StationDescription`.
    """

    def drive(
        self,
        command: Command,
        duration_s: float,
        seed: int,
        contact_torque: Profile = NOTHING,
        start_angle_rad: float = 0.0,
    ) -> Run:
        """Simulate the station from rest under a current or a speed controller.

        Parameters
        ----------
        command : CurrentCommand or SpeedCommand
            What drives the motor.
        duration_s : float
            Length of the recording, s.
        seed : int
            Seed of everything random.
        contact_torque : Profile
            Torque that the surroundings put on the output against the motor's sense, Nm.
        start_angle_rad : float
            Motor angle at time 0, rad.

        Returns
        -------
        Run
            Recording and truth.
        """
        if not isinstance(command, Command):
            raise ConfigurationError("command", command, "", "a CurrentCommand or a SpeedCommand")
        require_profile("contact_torque", contact_torque)

        def moved(plant: Drive, time_s: FloatArray) -> Motion:
            return integrated_motion(plant, command, contact_torque, time_s, start_angle_rad)

        return self._recorded(moved, duration_s, seed, start_angle_rad=start_angle_rad)

    def rotate(
        self,
        motor_speed: Profile,
        duration_s: float,
        seed: int,
        contact_torque: Profile = NOTHING,
        start_angle_rad: float = 0.0,
    ) -> Run:
        """Simulate a given rotation with a load that follows rigidly; quick, for long runs.

        Parameters
        ----------
        motor_speed : Profile
            Motor speed, rad/s.
        duration_s : float
            Length of the recording, s.
        seed : int
            Seed of everything random.
        contact_torque : Profile
            Torque that the surroundings put on the output against the motor's sense, Nm.
        start_angle_rad : float
            Motor angle at time 0, rad.

        Returns
        -------
        Run
            Recording and truth.
        """
        require_profile("motor_speed", motor_speed)
        require_profile("contact_torque", contact_torque)

        def moved(plant: Drive, time_s: FloatArray) -> Motion:
            return prescribed_motion(plant, motor_speed, contact_torque, time_s, start_angle_rad)

        return self._recorded(moved, duration_s, seed, start_angle_rad=start_angle_rad)

    def hold(
        self, applied_torque: Profile, duration_s: float, seed: int, position_rad: float = 0.0
    ) -> Run:
        """Simulate loading with the wave generator locked, as by arm and weight.

        Parameters
        ----------
        applied_torque : Profile
            Torque on the output, Nm.
        duration_s : float
            Length of the recording, s.
        seed : int
            Seed of everything random.
        position_rad : float
            Angle at which the wave generator is locked, rad.

        Returns
        -------
        Run
            Recording and truth.
        """
        require_profile("applied_torque", applied_torque)

        def held(plant: Drive, time_s: FloatArray) -> Motion:
            return prescribed_motion(
                plant, NOTHING, applied_torque, time_s, position_rad, locked=True
            )

        return self._recorded(held, duration_s, seed, position_rad=position_rad)

    def _recorded(
        self,
        moved: Callable[[Drive, FloatArray], Motion],
        duration_s: float,
        seed: int,
        **angle_rad: float,
    ) -> Run:
        """Check what all runs have in common, move the mechanics and measure.

        The mechanics runs a little longer than the recording, for jitter and delay.
        """
        rate = self.acquisition.rate_Hz
        require_number("duration_s", duration_s, "s", minimum=2.0 / rate)
        require_integer("seed", seed, "", minimum=0)
        for name, angle in angle_rad.items():
            require_number(name, angle, "rad")
        longer = duration_s + max(0.0, -self.acquisition.angle_to_torque_delay_s) + 1.0 / rate
        fine = rate * MECHANICS_STEPS_PER_SAMPLE
        time_s = np.arange(int(np.ceil(longer * fine)) + 1) / fine
        ratio = float(self.gear.ratio)
        plant = Drive(self.motor, ratio, self.flexspline, self.load, self.mesh_ripple)
        timing, *others = np.random.default_rng(seed).spawn(4)
        rows = take_rows(self.acquisition, duration_s, timing)
        return measure(self, moved(plant, time_s), rows, others)
