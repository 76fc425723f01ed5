"""Amplitude against order, over the whole recording and by speed.

The torque is looked at in windows of travel in one direction, because ripple belongs to the angle
and not to time. In each, a parabola is taken off, and a Fourier integral over the angle is summed
over the rows as they lie, with a Hann window; nothing is resampled. Over the windows the root mean
square is taken, so that a phase that wanders takes nothing away.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.identify.moving_rows import travel_windows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.evidence.motion import Motion

HIGHEST_ORDER: Final = 12.0
#: Motor turns of a window of the spectrum, at most and at least, and windows that are wished for.
LONGEST_TURNS: Final = 20.0
SHORTEST_TURNS: Final = 3.0
WISHED_WINDOWS: Final = 6
#: Cycles within a window below which slow torque and ripple are not told apart.
LEAST_CYCLES: Final = 3.0
#: Orders per inverse turn of the window: a line between two of them loses less than 1 %.
POINTS_PER_LINE: Final = 8
#: Windows of the map: short, so that the speed is one speed.
MAP_TURNS: Final = 4.0
MAP_SPEEDS: Final = 24
SLOW_DEGREE: Final = 2
#: Orders above this many cycles from row to row are not shown.
MOST_CYCLES_PER_ROW: Final = 0.45
#: A step of the angle within a window that is a gap: motor turns, and in steps of the usual size.
GAP_TURNS: Final = 0.1
GAP_STEPS: Final = 5.0


@dataclass(frozen=True)
class OrderSpectrum:
    """Amplitude against order.

    Attributes
    ----------
    order : numpy.ndarray
        Cycles per motor turn, shape (orders,).
    before_Nm, after_Nm : numpy.ndarray
        Amplitude, zero to peak, root mean square over the windows, shape (orders,), Nm; NaN where
        the rows are too far apart.
    window_turns : float
        Motor turns of a window, at least.
    windows : int
        Windows that were used.
    windows_with_gaps : int
        Windows left out because the angle jumps in them.
    """

    order: NDArray[np.float64]
    before_Nm: NDArray[np.float64]
    after_Nm: NDArray[np.float64]
    window_turns: float
    windows: int
    windows_with_gaps: int


@dataclass(frozen=True)
class OrderMap:
    """Amplitude against motor speed and order.

    Attributes
    ----------
    speed_edges_rad_s : numpy.ndarray
        Edges of the bins of motor speed, shape (bins + 1,), rad/s.
    order : numpy.ndarray
        Cycles per motor turn, shape (orders,).
    before_Nm, after_Nm : numpy.ndarray
        Amplitude, root mean square over the windows of a bin, shape (bins, orders), Nm; NaN where
        there is none.
    windows : numpy.ndarray
        Windows of each bin, shape (bins,).
    window_turns : float
        Motor turns of a window, at least.
    """

    speed_edges_rad_s: NDArray[np.float64]
    order: NDArray[np.float64]
    before_Nm: NDArray[np.float64]
    after_Nm: NDArray[np.float64]
    windows: NDArray[np.int64]
    window_turns: float


def order_spectrum(motion: Motion) -> OrderSpectrum | None:
    """Compute amplitude against order over all rows in motion.

    Parameters
    ----------
    motion : Motion
        The rows.

    Returns
    -------
    OrderSpectrum or None
        None where the motor does not turn far enough in one direction.
    """
    turns = float(np.clip(motion.turns / WISHED_WINDOWS, SHORTEST_TURNS, LONGEST_TURNS))
    windows, gaps = _windows(motion, turns)
    if not windows:
        return None
    order = _orders(turns)
    power = np.stack([_amplitudes(motion, window, order) ** 2 for window in windows])
    before_Nm, after_Nm = np.sqrt(_mean(power))
    return OrderSpectrum(order, before_Nm, after_Nm, turns, len(windows), gaps)


def order_map(motion: Motion) -> OrderMap | None:
    """Compute amplitude against speed and order.

    Parameters
    ----------
    motion : Motion
        The rows.

    Returns
    -------
    OrderMap or None
        None where the motor does not turn far enough in one direction.
    """
    turns = MAP_TURNS if motion.turns >= 4 * MAP_TURNS else SHORTEST_TURNS
    windows, _ = _windows(motion, turns)
    if not windows:
        return None
    order = _orders(turns)
    speeds = np.array([float(np.median(motion.speed_rad_s[window])) for window in windows])
    power = np.stack([_amplitudes(motion, window, order) ** 2 for window in windows])
    # Half a bin to spare on both sides; a recording at one speed has one bin.
    low, high = float(speeds.min()), float(speeds.max())
    width = max((high - low) / (MAP_SPEEDS - 1), 0.02 * max(abs(low), abs(high)))
    count = round((high - low) / width) + 1
    edges = np.asarray(low - 0.5 * width + width * np.arange(count + 1), np.float64)
    bins = np.clip(np.searchsorted(edges, speeds, side="right") - 1, 0, count - 1)
    amplitude = np.full((2, count, len(order)), np.nan)
    for n in np.unique(bins):
        amplitude[:, n] = np.sqrt(_mean(power[bins == n]))
    return OrderMap(
        edges, order, amplitude[0], amplitude[1], np.bincount(bins, minlength=count), turns
    )


def _orders(turns: float) -> NDArray[np.float64]:
    step = 1.0 / (POINTS_PER_LINE * turns)
    # Steps of which a whole order has a whole number: its amplitude is read at its place.
    step = 1.0 / np.ceil(1.0 / step)
    first = np.ceil(LEAST_CYCLES / turns / step)
    return np.asarray(step * np.arange(first, np.floor(HIGHEST_ORDER / step + 1e-9) + 1))


def _windows(motion: Motion, turns: float) -> tuple[list[slice], int]:
    found = travel_windows(motion.angle_rad, 2 * np.pi * turns, 4 * (SLOW_DEGREE + 1))
    whole = []
    for window in found:
        steps = np.abs(np.diff(motion.angle_rad[window])) / (2 * np.pi)
        if steps.max() <= max(GAP_TURNS, GAP_STEPS * float(np.median(steps))):
            whole.append(window)
    return whole, len(found) - len(whole)


def _amplitudes(motion: Motion, window: slice, order: NDArray[np.float64]) -> NDArray[np.float64]:
    """Amplitude before and after at every order, shape (2, orders), Nm."""
    by_angle = np.argsort(motion.angle_rad[window], kind="stable")
    turned = motion.angle_rad[window][by_angle]
    torque_Nm = motion.torque_Nm[:, window][:, by_angle]
    length = turned[-1] - turned[0]
    scaled = 2.0 * (turned - turned[0]) / length - 1.0
    # What a row stands for: half the way to either neighbour, under the Hann window.
    weights = np.gradient(turned) * (1.0 + np.cos(np.pi * scaled))
    slow = np.polynomial.chebyshev.chebvander(scaled, SLOW_DEGREE)
    roots = np.sqrt(np.maximum(weights, 0.0))[:, None]
    solution = np.linalg.lstsq(roots * slow, roots * torque_Nm.T, rcond=None)[0]
    weighted = (torque_Nm - (slow @ solution).T) * weights * (2.0 / weights.sum())
    # From one order to the next by one multiplication: orders are equally spaced.
    turning = np.exp(-1j * order[0] * turned)
    further = np.exp(-1j * (order[1] - order[0]) * turned)
    amplitudes = np.empty((2, len(order)))
    for n in range(len(order)):
        amplitudes[:, n] = np.abs(weighted @ turning)
        turning *= further
    per_row = float(np.quantile(np.diff(turned), 0.9)) / (2 * np.pi)
    amplitudes[:, order * per_row > MOST_CYCLES_PER_ROW] = np.nan
    return amplitudes


def _mean(power: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean over windows of what they show, shape (2, orders)."""
    shown = np.isfinite(power)
    count = shown.sum(axis=0)
    total = np.where(shown, power, 0.0).sum(axis=0)
    mean = np.full(total.shape, np.nan)
    np.divide(total, count, out=mean, where=count > 0)
    return mean
