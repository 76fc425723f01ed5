"""The gear's ratio from a recording: by the ripple's line, or by two angles' slope."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.identify.line_search import search_line
from strainwave.identify.moving_rows import travel_windows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.identify.line_search import Line
    from strainwave.identify.moving_rows import MovingRows

#: Lines of order 2 between these are looked for, cycles per output turn: ratios of 25 to 330.
LOWEST_CYCLES: Final = 50.0
HIGHEST_CYCLES: Final = 660.0
#: Windows that are tried, output turns, and how many of them there must be.
WINDOWS_OUTPUT_TURNS: Final = (0.1, 0.05, 0.025, 0.02, 0.0125)
LEAST_WINDOWS: Final = 6
#: Cycles of a line that a window must hold, so that it is told from slow torque.
LEAST_CYCLES: Final = 4.0
#: A ratio that is given is looked for within this share of itself.
TOLD_WITHIN: Final = 0.03
#: A ratio that is given is confirmed where it lies within so many standard uncertainties.
COVERAGE: Final = 3.0
#: The wave's cycles per motor turn lie between these where the ratio is not known.
LOWEST_FACTOR: Final = 0.97
HIGHEST_FACTOR: Final = 1.06
WINDOW_MOTOR_TURNS: Final = 8.0
#: Windows over which two angles are compared.
SLOPE_WINDOWS: Final = 16
#: A slope that is known to no better than this share of itself is none.
LARGEST_UNCERTAINTY: Final = 0.02


@dataclass(frozen=True)
class FoundRatio:
    """A ratio.

    Attributes
    ----------
    ratio : fractions.Fraction
        Motor turns per output turn.
    standard_uncertainty : float
        Of that.
    factor : fractions.Fraction or None
        The factor m that goes with it; None where it is still to be found.
    direction : int
        Sense of the output's rotation for positive motor rotation, 1 or -1; 0 where not known.
    """

    ratio: Fraction
    standard_uncertainty: float
    factor: Fraction | None = None
    direction: int = 0


def output_line(rows: MovingRows, told: Fraction | None) -> Line | None:
    """Find the line of order 2 against the output's angle.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion, with the output's angle.
    told : fractions.Fraction or None
        The ratio, if it is roughly known.

    Returns
    -------
    Line or None
        Its frequency is 2 m R cycles per output turn; None where none stands out.
    """
    within = None
    if told is not None:
        within = (2 * float(told) * (1 - TOLD_WITHIN), 2 * (float(told) + 1) * (1 + TOLD_WITHIN))
    turns = float(np.sum(np.abs(np.diff(rows.angle_rad)))) / (2 * np.pi)
    for window_turns in WINDOWS_OUTPUT_TURNS:
        lowest = max(LOWEST_CYCLES, LEAST_CYCLES / window_turns)
        highest = max(HIGHEST_CYCLES, 2 * lowest)
        if within is not None:
            lowest, highest = min(lowest, 0.7 * within[0]), max(highest, 1.3 * within[1])
        if turns < LEAST_WINDOWS * window_turns:
            continue
        line = search_line(rows, window_turns, lowest, highest, within)
        if line is not None:
            return line
    return None


def ratio_of_line(line: Line, told: Fraction | None) -> FoundRatio:
    """Split the product m R, which is all that an output angle shows.

    Parameters
    ----------
    line : Line
        The line of order 2.
    told : fractions.Fraction or None
        The ratio, if it is roughly known: of R = m R (m = 1) and R = m R - 1 (m = (R + 1)/R) the
        nearer one is taken, without it the first.

    Returns
    -------
    FoundRatio
        Ratio and factor m.
    """
    product, deviation = line.cycles_per_turn / 2, line.standard_uncertainty / 2
    with_wave = told is not None and abs(product - 1 - float(told)) < abs(product - float(told))
    measured = product - 1 if with_wave else product
    agrees = told is not None and abs(measured - float(told)) <= COVERAGE * deviation
    ratio = told if told is not None and agrees else Fraction(repr(measured))
    return FoundRatio(ratio, deviation, 1 + 1 / ratio if with_wave else Fraction(1))


def ratio_of_motor_line(rows: MovingRows) -> FoundRatio | None:
    """Find the ratio from the motor's angle alone, where the ripple turns with the wave.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion, with the motor's angle.

    Returns
    -------
    FoundRatio or None
        1/(m - 1); None where m cannot be told from 1.
    """
    within = (2 * LOWEST_FACTOR, 2 * HIGHEST_FACTOR)
    line = search_line(rows, WINDOW_MOTOR_TURNS, 1.2, 3.2, within)
    if line is None:
        return None
    over, deviation = line.cycles_per_turn / 2 - 1, line.standard_uncertainty / 2
    # A ratio that is known to no better than a tenth is not known.
    if over < 10 * deviation or over < 1e-3:
        return None
    ratio = Fraction(repr(1 / over))
    return FoundRatio(ratio, deviation / over**2, 1 + 1 / ratio)


def ratio_of_angles(
    motor_angle_rad: NDArray[np.float64],
    output_angle_rad: NDArray[np.float64],
    told: Fraction | None,
) -> FoundRatio | None:
    """Find the ratio as the slope of the motor's angle over the output's.

    Parameters
    ----------
    motor_angle_rad, output_angle_rad : numpy.ndarray
        The two angles, shape (rows,), rad.
    told : fractions.Fraction or None
        The ratio, if it is given; it stays where it agrees.

    Returns
    -------
    FoundRatio or None
        None where nothing turns, or the two angles have no common slope.
    """
    known = np.isfinite(motor_angle_rad) & np.isfinite(output_angle_rad)
    motor, output = motor_angle_rad[known], output_angle_rad[known]
    travel = float(np.sum(np.abs(np.diff(motor)))) if len(motor) else 0.0
    windows = travel_windows(motor, travel / SLOPE_WINDOWS, 8) if travel > 0.0 else []
    slopes, weights = [], []
    for window in windows:
        away = motor[window] - motor[window].mean()
        squares = float(away @ away)
        slopes.append(float(away @ (output[window] - output[window].mean())) / squares)
        weights.append(squares)
    if len(slopes) < 3:
        return None
    slope = np.array(slopes)
    weight = np.array(weights) / sum(weights)
    mean = float(np.sum(weight * slope))
    scatter = float(np.sum(weight**2 * (slope - mean) ** 2)) * len(slope) / (len(slope) - 1)
    if mean == 0.0 or not 1.0 <= abs(1 / mean) <= 1e6:
        return None
    measured, deviation = abs(1 / mean), float(np.sqrt(scatter)) / mean**2
    if deviation > LARGEST_UNCERTAINTY * measured:
        return None
    agrees = told is not None and abs(measured - float(told)) <= COVERAGE * deviation
    ratio = told if told is not None and agrees else Fraction(repr(measured))
    return FoundRatio(ratio, deviation, None, 1 if mean > 0 else -1)
