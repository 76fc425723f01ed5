"""The gear's factor m from a recording: whether the ripple turns with the motor or with the wave.

Gauges on a flexspline that turns see the wave (R + 1)/R times per motor turn, sensors that stand
see it once (Godler 2000, section III). The two orders 2 m lie 2/R apart: over three tenths of an
output turn they part by 0.6 cycles, and a line at one has a quarter of its power at the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: One candidate must have this many times the power of the other.
LEAST_CONTRAST: Final = 2.0
#: Its power must be this many times what white noise of the residual's variance gives on average.
LEAST_EVIDENCE: Final = 10.0
#: Length of a window.
WINDOW_OUTPUT_TURNS: Final = 0.3
#: Slow torque within a window is a polynomial of this degree.
SLOW_DEGREE: Final = 5


@dataclass(frozen=True)
class WaveFactor:
    """What was found.

    Attributes
    ----------
    factor : fractions.Fraction
        Turns of the wave against the sensing elements per motor turn; 1 where it is not decided.
    is_decided : bool
        False where the recording does not tell.
    windows : int
        Stretches of 0.3 output turns that were looked at.
    """

    factor: Fraction
    is_decided: bool
    windows: int


def find_wave_factor(
    motor_angle_rad: NDArray[np.float64],
    torque_Nm: NDArray[np.float64],
    ratio: Fraction | None,
    *,
    order: int = 2,
) -> WaveFactor:
    """Compare the ripple's power at order and at order x (R + 1)/R.

    Parameters
    ----------
    motor_angle_rad, torque_Nm : numpy.ndarray
        Consecutive rows of a recording, shape (rows,), rad and Nm; NaN rows are passed over.
    ratio : fractions.Fraction or None
        Motor turns per output turn, R; None leaves it undecided.
    order : int
        Cycles per turn of the wave.

    Returns
    -------
    WaveFactor
        1 or (R + 1)/R.
    """
    undecided = WaveFactor(Fraction(1), is_decided=False, windows=0)
    if ratio is None:
        return undecided
    usable = np.isfinite(motor_angle_rad) & np.isfinite(torque_Nm)
    angle_rad, torque_Nm = motor_angle_rad[usable], torque_Nm[usable]
    turning = (ratio + 1) / ratio
    powers, noise = np.zeros(2), np.zeros(2)
    windows = 0
    for rows in _monotonic_windows(angle_rad, WINDOW_OUTPUT_TURNS * 2 * np.pi * float(ratio)):
        windows += 1
        for index, factor in enumerate((1.0, float(turning))):
            line, left = _line_power(angle_rad[rows], torque_Nm[rows], order * factor)
            powers[index] += line
            noise[index] += left
    best = int(np.argmax(powers))
    clear = powers[best] > LEAST_CONTRAST * powers[1 - best]
    if not clear or powers[best] <= LEAST_EVIDENCE * noise[best]:
        return undecided
    return WaveFactor(turning if best else Fraction(1), is_decided=True, windows=windows)


def _monotonic_windows(angle_rad: NDArray[np.float64], length_rad: float) -> list[slice]:
    """Stretches of one direction and a length, without overlap, in rows."""
    if len(angle_rad) < 2:
        return []
    direction = np.sign(np.diff(angle_rad))
    # Rows in which an encoder stands belong to the motion around them.
    standing = direction == 0
    last = np.maximum.accumulate(np.where(standing, 0, np.arange(len(direction))))
    direction = direction[last]
    starts = np.concatenate([[0], np.flatnonzero(np.diff(direction)) + 1, [len(direction)]])
    windows = []
    for start, end in pairwise(starts):
        travelled = np.abs(angle_rad[start : end + 1] - angle_rad[start])
        for window in range(int(travelled[-1] // length_rad)):
            first, past = np.searchsorted(
                travelled, [window * length_rad, (window + 1) * length_rad]
            )
            if past - first > 10 * (SLOW_DEGREE + 3):
                windows.append(slice(int(start + first), int(start + past)))
    return windows


def _line_power(
    angle_rad: NDArray[np.float64], torque_Nm: NDArray[np.float64], order: float
) -> tuple[float, float]:
    """Power of one order beside a slow torque by least squares, and of noise in it, Nm^2 x rows."""
    middle, half = (angle_rad[0] + angle_rad[-1]) / 2, (angle_rad[-1] - angle_rad[0]) / 2
    slow = np.polynomial.chebyshev.chebvander((angle_rad - middle) / half, SLOW_DEGREE)
    basis = np.column_stack([np.cos(order * angle_rad), np.sin(order * angle_rad), slow])
    coefficients = np.linalg.lstsq(basis, torque_Nm, rcond=None)[0]
    left = torque_Nm - basis @ coefficients
    # Each of the two coefficients has the variance 2 sigma^2 / rows where there is noise alone.
    noise = 4.0 * float(left @ left) / (len(left) - basis.shape[1])
    return float(len(left) * (coefficients[0] ** 2 + coefficients[1] ** 2)), noise
