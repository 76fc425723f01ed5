"""Where the wave generator was locked: what of the fluctuation passes for gain and zero.

Harmonic i of the fluctuation makes 2 i cycles a turn of the wave generator. In readings at locked
positions it is a constant that enters zero and gain, and averages out over positions that are
spread equally over 180 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.checks import whole_number
from strainwave.calibrate.fluctuation import minimum_gauges
from strainwave.calibrate.torque import least_squares
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Angles nearer to each other than this, over 180 degrees, are one position: 1 degree.
SAME_POSITION_RAD: Final = np.radians(1.0)


@dataclass(frozen=True)
class PositionDependence:
    """Amplitudes of one harmonic of zero and gain over the wave-generator angle.

    Attributes
    ----------
    harmonic : int
        i: 2 i cycles a turn.
    gain_amplitude : float
        Relative to the mean gain.
    zero_amplitude_V : float
        Zero to peak, V.
    gain_standard_error, zero_standard_error_V : float
        Standard errors of both; NaN without degrees of freedom.
    """

    harmonic: int
    gain_amplitude: float
    gain_standard_error: float
    zero_amplitude_V: float
    zero_standard_error_V: float


def count_positions(positions_rad: ArrayLike) -> int:
    """Count positions that differ, on the half turn over which the fluctuation repeats.

    Parameters
    ----------
    positions_rad : array_like
        Wave-generator angles, shape (experiments,), rad.

    Returns
    -------
    int
        How many differ by more than `SAME_POSITION_RAD`.
    """
    angles = np.sort(np.mod(np.asarray(positions_rad, np.float64), np.pi))
    if len(angles) == 0:
        return 0
    gaps = np.diff(np.append(angles, angles[0] + np.pi))
    return max(1, int(np.count_nonzero(gaps > SAME_POSITION_RAD)))


def alias_shares(positions_rad: ArrayLike, harmonics: int) -> NDArray[np.float64]:
    """Share of each harmonic that remains in the mean over the positions.

    Parameters
    ----------
    positions_rad : array_like
        Wave-generator angle of each experiment, shape (experiments,), rad.
    harmonics : int
        N, at least 1.

    Returns
    -------
    numpy.ndarray
        abs(mean of exp(2 j i beta)) for i = 1 to N: 1 where all of it enters zero and gain, 0 where
        none does.
    """
    angles = np.asarray(positions_rad, np.float64)
    number = np.arange(1, whole_number("harmonics", harmonics) + 1)
    return np.asarray(np.abs(np.mean(np.exp(2j * np.outer(number, angles)), axis=1)))


def planned_positions_rad(harmonics: int, count: int | None = None) -> NDArray[np.float64]:
    """Positions equally spread over 180 degrees, at least 2 N + 1 of them.

    Parameters
    ----------
    harmonics : int
        N, at least 1.
    count : int, optional
        Number of positions, 2 N + 1 without.

    Returns
    -------
    numpy.ndarray
        Shape (count,), rad.

    Raises
    ------
    InputError
        If there are fewer than 2 N + 1.
    """
    fewest = minimum_gauges(harmonics)
    number = fewest if count is None else whole_number("positions", count)
    if number < fewest:
        raise InputError(
            f"positions = {number}: expected at least {fewest}, which is 2 N + 1 for N = "
            f"{harmonics} harmonics, so that the fluctuation does not pass for gain or zero; plan "
            "more positions or fewer harmonics"
        )
    return np.pi * np.arange(number) / number


def position_dependence(
    positions_rad: ArrayLike, gains: ArrayLike, zeros_V: ArrayLike, harmonics: int
) -> tuple[PositionDependence, ...]:
    """Fit the harmonics of gain and zero over the positions.

    Parameters
    ----------
    positions_rad : array_like
        Wave-generator angle of each experiment, shape (experiments,), rad.
    gains : array_like
        Gain of each, shape (experiments,).
    zeros_V : array_like
        Zero of each, shape (experiments,), V.
    harmonics : int
        N, at least 1.

    Returns
    -------
    tuple of PositionDependence
        For every harmonic; empty where the positions cannot tell 2 N + 1 parameters apart.
    """
    angles = np.asarray(positions_rad, np.float64)
    fewest = minimum_gauges(harmonics)
    if count_positions(angles) < fewest:
        return ()
    phases = 2.0 * np.outer(angles, np.arange(1, harmonics + 1))
    matrix = np.column_stack([np.ones(len(angles)), np.cos(phases), np.sin(phases)])
    if np.linalg.cond(matrix) > 1e3:
        return ()
    gain = least_squares(matrix, np.asarray(gains, np.float64))
    zero = least_squares(matrix, np.asarray(zeros_V, np.float64))
    mean = abs(float(gain.parameters[0]))
    found = []
    for i in range(1, harmonics + 1):
        pair = [i, i + harmonics]
        found.append(
            PositionDependence(
                i,
                float(np.hypot(*gain.parameters[pair])) / mean,
                float(np.mean(gain.standard_errors[pair])) / mean,
                float(np.hypot(*zero.parameters[pair])),
                float(np.mean(zero.standard_errors[pair])),
            )
        )
    return tuple(found)
