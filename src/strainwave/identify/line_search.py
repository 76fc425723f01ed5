"""Cycles per turn of the strongest line: a robust periodogram in angle, then the phases' slope.

In each window of travel the slow torque is a polynomial, and a line is a cosine and a sine beside
it. Windows add up their likelihoods, each with its own noise, so that a disturbance in one of them
counts for no more than the others. The line that is found is then followed over the whole recording
by its phase, which a delay between angle and torque shifts in proportion to the speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.ndimage import median_filter

from strainwave.identify.moving_rows import MovingRows, travel_windows

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Degree of the slow torque in a window.
SLOW_DEGREE: Final = 7
LEAST_ROWS: Final = 40
#: A line has at most so many cycles from row to row.
MOST_CYCLES_PER_ROW: Final = 0.45
#: Rows further out than so many robust deviations are clipped to them.
CLIP: Final = 4.0
#: Steps of the scan within the resolution of a window.
STEPS: Final = 6
#: The line's likelihood must exceed the background's by this factor and by this much.
LEAST_CONTRAST: Final = 2.5
LEAST_GAIN: Final = 12.0
#: A line at half the frequency is the fundamental from this share of the strongest amplitude on.
LEAST_FUNDAMENTAL: Final = 0.3
#: |speed| must vary by this share within a direction for a delay to be told from a slope.
LEAST_SPEED_SPREAD: Final = 0.15
#: Delays that are looked at, s.
DELAYS_S: Final = (-0.005, 0.05)


@dataclass(frozen=True)
class Line:
    """A line that was found.

    Attributes
    ----------
    cycles_per_turn : float
        Its frequency in angle.
    standard_uncertainty : float
        Of that, cycles per turn.
    contrast : float
        Its likelihood over that of the background around it.
    windows : int
        Windows that it was followed over.
    """

    cycles_per_turn: float
    standard_uncertainty: float
    contrast: float
    windows: int


@dataclass(frozen=True)
class _Window:
    """A window without its slow torque."""

    angle_rad: NDArray[np.float64]
    slow: NDArray[np.float64]
    rest_Nm: NDArray[np.float64]
    angle_per_row_rad: float
    middle_rad: float
    speed_rad_s: float

    def waves(self, cycles: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Waves of these frequencies beside the slow torque, shape (rows, frequencies)."""
        waves: NDArray[np.complex128] = np.exp(
            -1j * np.outer(self.angle_rad - self.middle_rad, cycles)
        )
        waves -= self.slow @ (self.slow.T @ waves)
        return waves


def search_line(
    rows: MovingRows,
    window_turns: float,
    lowest: float,
    highest: float,
    within: tuple[float, float] | None = None,
) -> Line | None:
    """Find the strongest line between two frequencies.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion.
    window_turns : float
        Length of the windows, in turns of the measured side.
    lowest, highest : float
        Cycles per turn between which it lies, and between which the background is taken.
    within : tuple of float, optional
        Cycles per turn, where it is known better than that; a window's resolution is allowed for.

    Returns
    -------
    Line or None
        The line; None where none stands out.
    """
    windows = _windows(rows, window_turns)
    if len(windows) < 2:
        return None
    step = 1.0 / (STEPS * window_turns)
    cycles = np.arange(lowest, highest + step, step)
    gain = sum((_gain(window, cycles) for window in windows), np.zeros(len(cycles)))
    around = min(len(cycles), 2 * (len(cycles) // 8) + 12 * STEPS + 1)
    background = median_filter(gain, size=around, mode="nearest")
    over = gain - background
    if within is not None:
        reach = 1.0 / window_turns
        over[(cycles < within[0] - reach) | (cycles > within[1] + reach)] = -np.inf
    best = int(np.argmax(over))
    contrast = float(gain[best] / max(background[best], 1e-9))
    if over[best] < LEAST_GAIN or contrast < LEAST_CONTRAST:
        return None
    if within is None:
        best = _fundamental(windows, cycles, over, best)
    found = _follow(windows, float(cycles[best]), window_turns)
    for _ in range(2):
        found = _follow(windows, found[0], window_turns)
    if within is not None and not within[0] <= found[0] <= within[1]:
        return None
    return Line(found[0], found[1], contrast, len(windows))


def _fundamental(
    windows: list[_Window], cycles: NDArray[np.float64], over: NDArray[np.float64], best: int
) -> int:
    """Step down to the line at half the frequency, where one is there that is no mere trace."""
    near = np.abs(cycles - cycles[best] / 2) < STEPS * (cycles[1] - cycles[0]) / 2
    if not near.any():
        return best
    half = int(np.flatnonzero(near)[np.argmax(over[near])])
    sizes = [
        float(np.median(np.abs(_amplitudes(windows, float(cycles[place]))[0])))
        for place in (half, best)
    ]
    is_line = over[half] > LEAST_GAIN and sizes[0] > LEAST_FUNDAMENTAL * sizes[1]
    return half if is_line else best


def _windows(rows: MovingRows, window_turns: float) -> list[_Window]:
    windows = []
    for part in travel_windows(rows.angle_rad, 2 * np.pi * window_turns, LEAST_ROWS):
        angle, torque = rows.angle_rad[part], rows.torque_Nm[part]
        low, high = float(angle.min()), float(angle.max())
        scaled = (2 * angle - low - high) / (high - low)
        slow = np.linalg.qr(np.polynomial.chebyshev.chebvander(scaled, SLOW_DEGREE))[0]
        rest = torque - slow @ (slow.T @ torque)
        deviation = 1.4826 * float(np.median(np.abs(rest)))
        rest = np.clip(rest, -CLIP * deviation, CLIP * deviation)
        if deviation > 0.0:
            per_row = float(np.quantile(np.abs(np.diff(angle)), 0.8))
            speed = float(np.median(rows.speed_rad_s[part]))
            windows.append(_Window(angle, slow, rest, per_row, (low + high) / 2, speed))
    return windows


def _gain(window: _Window, cycles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Logarithm of the likelihood that a line at each frequency gains."""
    waves = window.waves(cycles)
    power = 2 * np.abs(waves.T @ window.rest_Nm) ** 2 / np.sum(np.abs(waves) ** 2, axis=0)
    share = np.clip(power / float(window.rest_Nm @ window.rest_Nm), 0.0, 0.999)
    gain: NDArray[np.float64] = -0.5 * len(window.rest_Nm) * np.log1p(-share)
    gain[cycles * window.angle_per_row_rad > MOST_CYCLES_PER_ROW * 2 * np.pi] = 0.0
    return gain


def _follow(windows: list[_Window], cycles: float, window_turns: float) -> tuple[float, float]:
    """Follow a line's phase from window to window; its frequency and standard uncertainty."""
    amplitudes, weights = _amplitudes(windows, cycles)
    middle = np.array([window.middle_rad for window in windows])
    speed = np.array([window.speed_rad_s for window in windows])
    middle = middle - middle.mean()
    forward = speed > 0
    columns = [middle]
    both = min(forward.sum(), (~forward).sum()) >= 4
    if _speed_varies(speed, weights):
        columns.append(-speed * cycles)
    unit = amplitudes / np.maximum(np.abs(amplitudes), 1e-300)
    start = _coarse(unit * np.sqrt(weights), columns, window_turns)
    basis = np.column_stack(
        [*columns, forward, ~forward] if both else [*columns, np.ones(len(middle))]
    )
    solution = np.concatenate([start, np.zeros(basis.shape[1] - len(start))])
    phase0 = np.angle(np.sum(np.sqrt(weights) * unit * np.exp(-1j * basis @ solution)))
    solution[len(start) :] = phase0
    for _ in range(10):
        left = np.angle(unit * np.exp(-1j * (basis @ solution)))
        scale = 1.4826 * float(np.median(np.abs(left))) + 1e-9
        robust = weights / np.maximum(1.0, np.abs(left) / (1.5 * scale))
        normal = basis.T @ (robust[:, None] * basis)
        solution = solution + np.linalg.lstsq(normal, basis.T @ (robust * left), rcond=None)[0]
    left = np.angle(unit * np.exp(-1j * (basis @ solution)))
    # Scatter of the phases as it is, not as noise alone would make it.
    inverse = np.linalg.pinv(normal)
    scores = (basis * (robust * left)[:, None]) @ inverse
    freedom = max(1, len(left) - basis.shape[1])
    deviation = float(np.sqrt(np.sum(scores[:, 0] ** 2) * len(left) / freedom))
    deviation *= _wandering(left[np.abs(left) < np.pi / 2])
    noise = np.linalg.pinv(basis.T @ (np.maximum(weights, 1e-12)[:, None] * basis))
    return cycles + float(solution[0]), max(deviation, float(np.sqrt(max(noise[0, 0], 0.0))))


def _wandering(left_rad: NDArray[np.float64]) -> float:
    """Factor by which phases that wander from window to window know less than independent ones."""
    if len(left_rad) < 3:
        return 1.0
    squares = max(float(left_rad @ left_rad), 1e-300)
    alike = float(left_rad[1:] @ left_rad[:-1]) / squares
    # What is left of a fit looks less alike than what was fitted.
    alike = float(np.clip(alike + 2.0 / len(left_rad), 0.0, 0.8))
    return float(np.sqrt((1 + alike) / (1 - alike)))


def _amplitudes(
    windows: list[_Window], cycles: float
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Complex amplitude of a line in each window, and the weight of its phase."""
    amplitudes, weights = [], []
    for window in windows:
        wave = window.waves(np.array([cycles]))[:, 0]
        squares = float(np.sum(np.abs(wave) ** 2))
        product = complex(wave @ window.rest_Nm)
        # Against the turn's own zero, not the window's middle.
        amplitudes.append(2 * product / squares * np.exp(-1j * cycles * window.middle_rad))
        line = 2 * abs(product) ** 2 / squares
        left = max(float(window.rest_Nm @ window.rest_Nm) - line, 1e-12)
        visible = cycles * window.angle_per_row_rad < MOST_CYCLES_PER_ROW * 2 * np.pi
        weights.append(visible * line / left * len(window.rest_Nm))
    # No window decides alone.
    found = np.array(weights)
    return np.array(amplitudes), np.minimum(found, 3 * np.median(found) + 1e-12)


def _speed_varies(speed: NDArray[np.float64], weights: NDArray[np.float64]) -> bool:
    for forward in (speed > 0, speed < 0):
        if forward.sum() >= 6:
            values, share = np.abs(speed[forward]), weights[forward]
            mean = float(np.average(values, weights=share + 1e-12))
            spread = float(np.sqrt(np.average((values - mean) ** 2, weights=share + 1e-12)))
            if spread > LEAST_SPEED_SPREAD * mean:
                return True
    return False


def _coarse(
    amplitudes: NDArray[np.complex128],
    columns: list[NDArray[np.float64]],
    window_turns: float,
) -> NDArray[np.float64]:
    """Try slopes, and delays where there is a column for them; the most coherent are returned."""
    span = max(float(np.ptp(columns[0])), 1e-9)
    reach = 1.0 / window_turns / 2
    steps = int(np.clip(np.ceil(reach * span / 0.5), 1, 3000))
    slopes = np.linspace(-reach, reach, 2 * steps + 1)
    turned = np.exp(-1j * np.outer(slopes, columns[0])) * amplitudes
    if len(columns) == 1:
        return np.array([slopes[int(np.argmax(np.abs(turned.sum(axis=1))))]])
    fastest = float(np.max(np.abs(columns[1])))
    count = int(np.clip(np.ceil((DELAYS_S[1] - DELAYS_S[0]) * fastest / 0.5), 2, 400))
    delays = np.linspace(*DELAYS_S, count)
    found = np.abs(turned @ np.exp(-1j * np.outer(columns[1], delays)))
    slope, delay = np.unravel_index(int(np.argmax(found)), found.shape)
    return np.array([slopes[slope], delays[delay]])
