"""Synthetic recordings on which a method is measured: ripple, noise and a slow load.

The load swings about nothing, so that a filter whose ripple grows with load can learn how.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.errors import InputError
from strainwave.fidelity.checks import MOST_SAMPLES
from strainwave.samples import Samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.fidelity.subject import Subject

SEED: Final = 1999
#: Before anything is measured, the method has this long and this many motor turns, whichever ends
#: later. The ripple filter's turns are six of its memories, within these limits.
SETTLING_S: Final = 8.0
SETTLING_TURNS: Final = 60.0
MOST_SETTLING_TURNS: Final = 300.0
#: Amplitude of the strongest line, of the rated torque; the next ones have a half, a third...
RIPPLE: Final = 0.02
#: Amplitude and frequency of the slow load, of the rated torque and Hz.
LOAD: Final = 0.2
LOAD_HZ: Final = 0.3
#: Two lines are told apart where they part by this many periods while they are measured.
LEAST_PERIODS: Final = 1.5


def settling_s(subject: Subject, motor_speed_rad_s: float) -> float:
    """Time a method is given before it is measured.

    Parameters
    ----------
    subject : Subject
        The method under test.
    motor_speed_rad_s : float
        Motor speed, above 0, rad/s.

    Returns
    -------
    float
        Time, s.
    """
    turns = min(max(SETTLING_TURNS, 6.0 * subject.memory_turns), MOST_SETTLING_TURNS)
    return max(SETTLING_S, turns * 2 * math.pi / motor_speed_rad_s)


def rows_of(subject: Subject, time_s: float) -> int:
    """Count the rows of a stretch of time.

    Parameters
    ----------
    subject : Subject
        The method under test.
    time_s : float
        Length, s.

    Returns
    -------
    int
        Rows, at least one.

    Raises
    ------
    InputError
        If there are more than fit into memory.
    """
    rows = time_s / subject.sample_period_s
    if rows > MOST_SAMPLES / 10:
        raise InputError(
            f"the sample period is {subject.sample_period_s:g} s, so that {time_s:g} s are "
            f"{rows:.3g} rows: expected at most {MOST_SAMPLES // 10}; give a lower sampling_rate_Hz"
        )
    return max(1, math.ceil(rows - 1e-9))


def lines_apart(orders: Sequence[float], turns: float) -> tuple[float, ...]:
    """Choose the lines that a stretch of motion can tell from each other and from slow torque.

    Parameters
    ----------
    orders : sequence of float
        Cycles per motor turn.
    turns : float
        Motor turns of the stretch.

    Returns
    -------
    tuple of float
        Orders at least `LEAST_PERIODS` periods from 0 and from each other.
    """
    chosen: list[float] = []
    # Whole orders first: side orders are seen where there is time for them.
    for order in sorted(orders, key=lambda each: (abs(each - round(each)) > 0.1, each)):
        if all(turns * abs(order - other) >= LEAST_PERIODS for other in [0.0, *chosen]):
            chosen.append(order)
    return tuple(sorted(chosen))


def ripple_recording(
    subject: Subject, motor_speed_rad_s: NDArray[np.float64], orders: Sequence[float]
) -> Samples:
    """Make a recording of ripple, noise and a slow load.

    Parameters
    ----------
    subject : Subject
        The method under test.
    motor_speed_rad_s : numpy.ndarray
        Motor speed, shape (rows,), rad/s.
    orders : sequence of float
        Lines of the ripple, cycles per motor turn.

    Returns
    -------
    Samples
        The recording; the same at every call.
    """
    rows = len(motor_speed_rad_s)
    period_s = subject.sample_period_s
    turned = np.concatenate([[0.0], np.cumsum(motor_speed_rad_s[:-1])])
    angle_rad = np.asarray(period_s * turned, dtype=np.float64)
    torque_Nm = subject.noise_Nm * np.random.default_rng(SEED).standard_normal(rows)
    for n, order in enumerate(orders):
        amplitude_Nm = RIPPLE * subject.rated_torque_Nm / (n + 1)
        torque_Nm += amplitude_Nm * np.cos(order * angle_rad + 1.0 + n)
    time_s = period_s * np.arange(rows, dtype=np.float64)
    torque_Nm += LOAD * subject.rated_torque_Nm * np.sin(2 * np.pi * LOAD_HZ * time_s)
    return Samples(time_s, angle_rad, torque_Nm, np.zeros(rows))


def with_torque(samples: Samples, added_Nm: NDArray[np.float64]) -> Samples:
    """Add true torque to a recording.

    Parameters
    ----------
    samples : Samples
        The recording.
    added_Nm : numpy.ndarray
        True torque, shape (rows,), Nm.

    Returns
    -------
    Samples
        The recording with it.
    """
    return Samples(
        samples.time_s,
        samples.motor_angle_rad,
        samples.torque_Nm + added_Nm,
        samples.expected_torque_Nm,
    )
