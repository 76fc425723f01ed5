"""Whether the wave turns as it is told to: factor m and a delay between angle and gauges.

A wrong factor and a delay both shift the phase of the wave along the run. A grid over blocks of
rows finds where the line of the first harmonic sits; Gauss-Newton steps with amplitudes, phases and
trend fitted anew finish, and the scatter of the blocks says how far the result holds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.fluctuation_run import BLOCKS, wave_columns
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Blocks of rows within which the phase is taken as constant while a line is looked for.
SEARCH_BLOCKS: Final = 512
#: How far from the told factor a line is looked for.
SEARCH_SHARE: Final = 0.1
#: Gauss-Newton steps; a few suffice.
MOST_STEPS: Final = 30
#: Degree of the slow trend beside the wave.
TREND_DEGREE: Final = 5
#: Smallest standard deviation of the speed over its mean from which a delay can be told.
LEAST_SPEED_CHANGE: Final = 0.02


@dataclass(frozen=True)
class WaveTiming:
    """Where the line sits.

    Attributes
    ----------
    factor : float
        m, wave turns per motor turn.
    factor_standard_uncertainty : float
        Of m.
    delay_s : float
        Time by which the gauges lag the angle; the told one where it was not fitted.
    delay_standard_uncertainty_s : float
        Of the delay; 0 where it was not fitted.
    """

    factor: float
    factor_standard_uncertainty: float
    delay_s: float
    delay_standard_uncertainty_s: float


def delayed_angle(
    motor_angle_rad: NDArray[np.float64], time_s: NDArray[np.float64], delay_s: float
) -> NDArray[np.float64]:
    """Angle at the instant of gauges that lag it.

    Parameters
    ----------
    motor_angle_rad, time_s : numpy.ndarray
        Angle, rad, and time, s, shape (samples,); the time rises.
    delay_s : float
        Time by which the gauges lag.

    Returns
    -------
    numpy.ndarray
        Angle at time - delay; at the ends the first or the last one.
    """
    return np.interp(time_s - delay_s, time_s, motor_angle_rad)


def delayed_in_stretches(
    motor_angle_rad: NDArray[np.float64],
    time_s: NDArray[np.float64],
    delay_s: float,
    stretches: NDArray[np.int64],
) -> NDArray[np.float64]:
    """Take a delay out of each uninterrupted stretch by itself.

    Parameters
    ----------
    motor_angle_rad, time_s : numpy.ndarray
        Angle, rad, and time, s, shape (samples,); the time rises within a stretch.
    delay_s : float
        Time by which the gauges lag.
    stretches : numpy.ndarray
        Number of each sample's stretch, shape (samples,).

    Returns
    -------
    numpy.ndarray
        Angle at time - delay, rad, shape (samples,).
    """
    if delay_s == 0:
        return motor_angle_rad
    shifted = np.empty_like(motor_angle_rad)
    for stretch in np.unique(stretches):
        rows = stretches == stretch
        shifted[rows] = delayed_angle(motor_angle_rad[rows], time_s[rows], delay_s)
    return shifted


def fit_timing(
    signals: NDArray[np.float64],
    motor_angle_rad: NDArray[np.float64],
    *,
    harmonics: int,
    wave_factor: float,
    time_s: NDArray[np.float64] | None = None,
    delay_s: float = 0.0,
    fit_delay: bool = False,
) -> WaveTiming:
    """Find the factor m, and a delay where it is asked for, from the wave itself.

    Parameters
    ----------
    signals : numpy.ndarray
        Gauge signals, shape (samples, gauges).
    motor_angle_rad : numpy.ndarray
        Angle as recorded, shape (samples,), rad.
    harmonics : int
        Harmonics of the wave.
    wave_factor : float
        Told factor m; the line is looked for within 10 % of it.
    time_s : numpy.ndarray, optional
        Time of the rows, s, rising; needed for a delay.
    delay_s : float
        Told delay, and the one to start from.
    fit_delay : bool
        Whether the delay is found as well.

    Returns
    -------
    WaveTiming
        Factor and delay with standard uncertainties.

    Raises
    ------
    InputError
        If a delay is asked for and the run cannot tell it.
    """
    speed = None
    if time_s is not None:
        speed = np.gradient(motor_angle_rad, time_s)
    if fit_delay:
        _require_changing_speed(speed)
    started = _angle(motor_angle_rad, time_s, delay_s)
    factor = _searched(signals, started, wave_factor)
    delay = delay_s
    spread = np.zeros((2, 2))
    for _ in range(MOST_STEPS):
        angle = _angle(motor_angle_rad, time_s, delay)
        step, spread = _step(signals, angle, factor, harmonics, speed if fit_delay else None)
        factor += step[0]
        delay += step[1]
        errors = np.sqrt(np.diag(spread))
        if np.all(np.abs(step) <= 1e-3 * errors + 1e-15):
            break
    return WaveTiming(factor, float(errors[0]), delay, float(errors[1]))


def _angle(
    angle_rad: NDArray[np.float64], time_s: NDArray[np.float64] | None, delay_s: float
) -> NDArray[np.float64]:
    if time_s is None or delay_s == 0:
        return angle_rad
    return delayed_angle(angle_rad, time_s, delay_s)


def _require_changing_speed(speed: NDArray[np.float64] | None) -> None:
    if speed is None:
        raise InputError(
            "a delay between angle and gauges is asked for, and there is no time: expected a "
            "column of time, so map it with time=COLUMN"
        )
    smooth = np.convolve(speed, np.ones(9) / 9, mode="valid") if len(speed) > 9 else speed
    if np.std(smooth) < LEAST_SPEED_CHANGE * np.max(np.abs(smooth)):
        raise InputError(
            "the speed hardly changes, and at one speed a delay is a phase: expected a run at "
            "different speeds, so record one or leave the delay out"
        )


def _searched(signals: NDArray[np.float64], angle_rad: NDArray[np.float64], told: float) -> float:
    """Factor with the strongest first harmonic: blocks are turned against each other."""
    rows = len(angle_rad)
    turns = np.ptp(angle_rad) / (2 * np.pi)
    slow = np.polynomial.chebyshev.chebvander(np.linspace(-1, 1, rows), TREND_DEGREE)
    slow = slow[:, : max(1, min(TREND_DEGREE + 1, int(2 * turns)))]
    left = signals - slow @ np.linalg.lstsq(slow, signals, rcond=None)[0]
    blocks = min(SEARCH_BLOCKS, rows)
    edges = np.linspace(0, rows, blocks + 1).astype(int)[:-1]
    turned = left * np.exp(-2j * told * angle_rad)[:, np.newaxis]
    sums = np.add.reduceat(turned, edges, axis=0)
    sizes = np.diff([*edges, rows])[:, np.newaxis]
    middles = np.add.reduceat(angle_rad[:, np.newaxis], edges, axis=0) / sizes
    # A quarter of the line's width a step; beyond the blocks' own resolution nothing shows.
    step = 1.0 / (8 * max(turns, 0.5))
    reach = min(SEARCH_SHARE * told, blocks / (8 * max(turns, 0.5)))
    shifts = step * np.arange(-int(reach / step), int(reach / step) + 1)
    # Ties, as in a run too short to tell, go to the told factor.
    shifts = shifts[np.argsort(np.abs(shifts), kind="stable")]
    powers = np.array(
        [
            np.sum(np.abs(np.sum(sums * np.exp(-2j * shift * middles), axis=0)) ** 2)
            for shift in shifts
        ]
    )
    return told + float(shifts[np.argmax(powers)])


def _step(
    signals: NDArray[np.float64],
    angle_rad: NDArray[np.float64],
    factor: float,
    harmonics: int,
    speed: NDArray[np.float64] | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gauss-Newton step of factor and delay with everything else fitted anew, and covariance."""
    rows = len(angle_rad)
    cycles = factor * np.ptp(angle_rad) / np.pi
    degree = int(np.clip(cycles, 1, TREND_DEGREE))
    trend = np.polynomial.chebyshev.chebvander(np.linspace(-1, 1, rows), degree)
    wave = wave_columns(factor * angle_rad, harmonics)
    orthogonal, triangle = np.linalg.qr(np.column_stack([trend, wave]))
    within = orthogonal.T @ signals
    parameters = np.linalg.lstsq(triangle, within, rcond=None)[0]
    residuals = signals - orthogonal @ within
    parts = parameters[degree + 1 :].reshape(harmonics, 2, -1)
    # d/dphi of s sin(2 i phi) + c cos(2 i phi)
    order = 2.0 * np.arange(1, harmonics + 1)[:, np.newaxis]
    slopes = np.stack([-order * parts[:, 1], order * parts[:, 0]], axis=1)
    slope = wave @ slopes.reshape(2 * harmonics, -1)
    directions = [slope * angle_rad[:, np.newaxis]]
    if speed is not None:
        directions.append(-factor * slope * speed[:, np.newaxis])
    free = [each - orthogonal @ (orthogonal.T @ each) for each in directions]
    information = np.array([[np.sum(a * b) for b in free] for a in free])
    scores = np.array([np.sum(a * residuals, axis=1) for a in free])
    inverse = np.linalg.pinv(information)
    step = inverse @ scores.sum(axis=1)
    centred = [np.sum(a * residuals, axis=1) for a in free]
    edges = np.linspace(0, rows, min(BLOCKS, rows // 8 + 1) + 1).astype(int)[:-1]
    sums = np.add.reduceat(np.array(centred), edges, axis=1)
    sums = sums - sums.mean(axis=1, keepdims=True)
    white = np.sum(residuals**2) / max(1, residuals.size) * inverse
    scattered = inverse @ (sums @ sums.T) @ inverse * len(edges) / max(1, len(edges) - 1)
    larger = np.sqrt(np.maximum(np.diag(scattered), np.diag(white)))
    spread, moved = np.zeros((2, 2)), np.zeros(2)
    spread[: len(larger), : len(larger)] = np.diag(larger**2)
    moved[: len(step)] = step
    return moved, spread
