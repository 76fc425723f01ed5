"""Named trajectories: the runs a sensor is tried on, each a profile of trajectories.py."""

from __future__ import annotations

from collections.abc import Sequence

from strainwave.simulate.checks import require_integer, require_number
from strainwave.simulate.trajectories import NOTHING, PiecewiseLinear, Profile

STANDSTILL: Profile = NOTHING
"""A motor that does not turn."""


def constant_speed(speed_rad_s: float, acceleration_time_s: float = 0.5) -> PiecewiseLinear:
    """Return a speed profile that accelerates evenly and then stays.

    Parameters
    ----------
    speed_rad_s : float
        Final motor speed, rad/s; a crawl is a small one.
    acceleration_time_s : float
        Time to reach it, s; 0 turns at the final speed from the start.

    Returns
    -------
    PiecewiseLinear
        Motor speed, rad/s.
    """
    require_number("speed_rad_s", speed_rad_s, "rad/s")
    require_number("acceleration_time_s", acceleration_time_s, "s", minimum=0.0)
    if acceleration_time_s == 0.0:
        return PiecewiseLinear((0.0,), (speed_rad_s,))
    return PiecewiseLinear((0.0, acceleration_time_s), (0.0, speed_rad_s))


def reversals(speed_rad_s: float, dwell_s: float, reversal_s: float, count: int) -> PiecewiseLinear:
    """Return a speed profile that turns back and forth.

    Parameters
    ----------
    speed_rad_s : float
        Motor speed between reversals, rad/s; first in this direction.
    dwell_s : float
        Time at each speed, s.
    reversal_s : float
        Time of each reversal, s.
    count : int
        Number of reversals.

    Returns
    -------
    PiecewiseLinear
        Motor speed, rad/s, starting at standstill.
    """
    require_number("speed_rad_s", speed_rad_s, "rad/s")
    require_number("dwell_s", dwell_s, "s", above=0.0)
    require_number("reversal_s", reversal_s, "s", above=0.0)
    require_integer("count", count, "", minimum=1)
    times, speeds = [0.0], [0.0]
    speed = speed_rad_s
    for _ in range(count + 1):
        times.append(times[-1] + reversal_s)
        speeds.append(speed)
        times.append(times[-1] + dwell_s)
        speeds.append(speed)
        speed = -speed
    return PiecewiseLinear(tuple(times), tuple(speeds))


def step(value: float, start_s: float, end_s: float, rise_s: float = 1e-3) -> PiecewiseLinear:
    """Return a profile that is ``value`` from start to end and zero before and after.

    Parameters
    ----------
    value : float
        Height: contact torque in Nm, current in A.
    start_s, end_s : float
        When it begins to rise and when it begins to fall, s.
    rise_s : float
        Time of each edge, s: nothing that has mass makes a step in no time.

    Returns
    -------
    PiecewiseLinear
        The step.
    """
    require_number("value", value, "")
    require_number("start_s", start_s, "s", minimum=0.0)
    require_number("rise_s", rise_s, "s", above=0.0)
    require_number("end_s", end_s, "s", above=start_s + rise_s)
    return PiecewiseLinear(
        (start_s, start_s + rise_s, end_s, end_s + rise_s), (0.0, value, value, 0.0)
    )


def loading_sequence(
    torques_Nm: Sequence[float], dwell_s: float = 0.4, change_s: float = 0.1
) -> PiecewiseLinear:
    """Return weights hung on an arm one after another: a torque profile with a dwell at each.

    Parameters
    ----------
    torques_Nm : sequence of float
        Torque at each dwell, Nm, in the order of loading.
    dwell_s : float
        Time at each torque, s.
    change_s : float
        Time between two, s.

    Returns
    -------
    PiecewiseLinear
        Applied torque, Nm.
    """
    require_number("dwell_s", dwell_s, "s", above=0.0)
    require_number("change_s", change_s, "s", above=0.0)
    times: list[float] = []
    values: list[float] = []
    for k, torque in enumerate(torques_Nm):
        require_number("torques_Nm", torque, "Nm")
        begin = k * (dwell_s + change_s)
        times += [begin, begin + dwell_s]
        values += [torque, torque]
    return PiecewiseLinear(tuple(times), tuple(values))


def up_and_down(largest_Nm: float, steps: int, *, both_directions: bool = False) -> list[float]:
    """Return torques of increasing and then decreasing weights.

    Parameters
    ----------
    largest_Nm : float
        Largest torque, Nm; its sign is the direction.
    steps : int
        Number of weights up to the largest.
    both_directions : bool
        Whether the same follows in the other direction.

    Returns
    -------
    list of float
        Torques in the order of loading, Nm, beginning and ending at zero.
    """
    require_number("largest_Nm", largest_Nm, "Nm")
    require_integer("steps", steps, "", minimum=1)
    rise = [largest_Nm * k / steps for k in range(steps + 1)]
    one_way = rise + rise[-2::-1]
    return one_way + [-torque for torque in one_way[1:]] if both_directions else one_way
