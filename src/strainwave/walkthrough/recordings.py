"""Two recordings of one simulated joint: one to identify it on, and one of work."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.atomic import write_atomically
from strainwave.simulate.driving import step
from strainwave.simulate.presets.taghirad1999 import taghirad1999
from strainwave.simulate.trajectories import PiecewiseLinear, Sine, Sum

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave.simulate.results import Run
    from strainwave.simulate.station import Station

RATIO: Final = 100
RATED_TORQUE_NM: Final = 40.0
#: The torque comes later than the angle, as in real joints' recordings, and rows are not even.
DELAY_S: Final = 2e-3
JITTER_S: Final = 1e-4
MAP: Final = "time=time_s,angle=motor_angle_rad,torque=torque_Nm"


@dataclass(frozen=True)
class Touch:
    """Something pushes on the output.

    Attributes
    ----------
    height_Nm : float
        Torque, Nm.
    from_s, to_s : float
        When it begins and when it ends, s.
    """

    height_Nm: float
    from_s: float
    to_s: float

    def profile(self) -> PiecewiseLinear:
        """Return it as a torque over time."""
        return step(self.height_Nm, self.from_s, self.to_s, rise_s=RISE_S)


RISE_S: Final = 0.01
TOUCH_IN_MOTION: Final = Touch(10.0, 4.0, 5.5)
TOUCH_BACKWARDS: Final = Touch(6.0, 11.0, 12.0)
TOUCH_AT_REST: Final = Touch(10.0, 17.0, 18.0)
#: Phases of the recording of work, s.
STEADY: Final = "constant speed, 120 rad/s"
PHASES: Final = {
    STEADY: (2.5, 4.0),
    "touched by 10 Nm in motion": (4.0, 5.6),
    "reversal": (8.0, 10.0),
    "touched by 6 Nm, backwards": (11.0, 12.1),
    "touched by 10 Nm at rest": (17.0, 18.1),
}


def joint() -> Station:
    """Return the joint: the motor, gear and gauges of Taghirad & Belanger 1999, mounted straight.

    Returns
    -------
    Station
        A simulated station.
    """
    station = taghirad1999(misalignment="none")
    return replace(
        station,
        acquisition=replace(
            station.acquisition, angle_to_torque_delay_s=DELAY_S, jitter_s=JITTER_S
        ),
    )


def ordinary_run() -> Run:
    """Return 40 s of an ordinary motion: rest, four speeds, both directions, changing load.

    Returns
    -------
    Run
        Recording and truth.
    """
    speed_rad_s = PiecewiseLinear(
        (0, 2, 3, 10, 11, 18, 19, 20, 21, 28, 29, 35, 36, 40),
        (0, 0, 60, 60, 150, 150, 0, 0, -100, -100, -40, -40, 0, 0),
    )
    load_Nm = Sum((Sine(6.0, 0.2), step(8.0, 5.0, 6.0, 0.02), step(-10.0, 24.0, 26.0, 0.02)))
    return joint().rotate(speed_rad_s, 40.0, 1, contact_torque=load_Nm)


def run_of_work() -> Run:
    """Return 20 s of another motion of the same joint, touched in motion and at rest.

    Returns
    -------
    Run
        Recording and truth.
    """
    speed_rad_s = PiecewiseLinear((0, 1, 2, 8, 10, 14, 15, 20), (0, 0, 120, 120, -120, -120, 0, 0))
    touches = (TOUCH_IN_MOTION, TOUCH_BACKWARDS, TOUCH_AT_REST)
    load_Nm = Sum(tuple(touch.profile() for touch in touches))
    return joint().rotate(speed_rad_s, 20.0, 2, contact_torque=load_Nm)


def write_recording(run: Run, path: Path) -> None:
    """Write what a joint's own electronics would record.

    Parameters
    ----------
    run : Run
        A run.
    path : Path
        The file: CSV with time, motor angle and torque with its ripple.
    """
    columns = np.column_stack([run.time_s, run.motor_angle_rad, run.raw_torque_Nm])
    lines = ["time_s,motor_angle_rad,torque_Nm"]
    lines += [",".join(f"{value:.7g}" for value in row) for row in columns]
    write_atomically(path, ("\n".join(lines) + "\n").encode())
