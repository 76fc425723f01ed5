"""Which orders a recording holds: least squares in windows of travel, and an information criterion.

In each window the torque is a polynomial and a cosine and a sine of every candidate. Over the
windows an order's amplitude is averaged with its phase, so that what comes by chance cancels, and
its uncertainty is the larger of the scatter from window to window and of what the noise within them
makes. An order is present where the likelihood it gains pays for its two coefficients (Schwarz's
criterion, BIC).

On many real joints a ripple's phase wanders, or turns over with the load's sign, so that its mean
says little. The second evidence needs no phase: window by window, the order's power against that
half an order below and above it, whose ratio has a known distribution where there is no line.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.identify.moving_rows import MovingRows, travel_windows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: Motor turns of a window, where the recording has enough of them, and at least.
WINDOW_TURNS: Final = 8.0
LEAST_WINDOW_TURNS: Final = 3.0
#: Windows that are wished for.
WISHED_WINDOWS: Final = 8
#: Degree of the slow torque in a window.
SLOW_DEGREE: Final = 5
MOST_CYCLES_PER_ROW: Final = 0.45
#: A window that tells two columns apart no better than this cannot show its orders.
LEAST_PIVOT: Final = 1e-6
#: Windows below this number say nothing of a scatter.
LEAST_WINDOWS: Final = 4
#: Mean and standard deviation of the logarithm of F(2, 4): one power over the mean of two others.
MEAN_LOG_RATIO: Final = -0.3070
DEVIATION_LOG_RATIO: Final = 1.5132


@dataclass(frozen=True)
class FoundOrder:
    """An order of the ripple.

    Attributes
    ----------
    order : float
        Multiple of the wave's turns: cycles per motor turn over the factor m.
    amplitude_Nm : float
        Mean amplitude, zero to peak, Nm; where the phase wanders, root mean square over windows.
    phase_rad : float
        The ripple is amplitude x cos(order x m x motor angle - phase), rad.
    amplitude_standard_uncertainty_Nm : float
        Standard uncertainty of the amplitude, Nm.
    evidence : float
        Logarithm of the likelihood gained, beyond what its coefficients cost.
    is_present : bool
        Whether the evidence is positive.
    is_steady : bool
        Whether amplitude and phase are those of one cosine over the recording; False where the
        order is seen by its power alone.
    """

    order: float
    amplitude_Nm: float
    phase_rad: float
    amplitude_standard_uncertainty_Nm: float
    evidence: float
    is_present: bool
    is_steady: bool


def find_orders(
    rows: MovingRows, candidates: Sequence[int], factor: float, delay_s: float = 0.0
) -> list[FoundOrder]:
    """Measure candidate orders, and tell which are there.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion, angles and speeds of the motor.
    candidates : sequence of int
        Orders to look at, cycles per turn of the wave.
    factor : float
        Turns of the wave per motor turn, m.
    delay_s : float
        Time by which torque lags the angle.

    Returns
    -------
    list of FoundOrder
        One for each candidate that the recording can show; empty where it is too short.
    """
    angle_rad = rows.angle_rad - delay_s * rows.speed_rad_s
    windows = order_windows(angle_rad)
    amplitudes: dict[float, list[tuple[complex, float]]] = {order: [] for order in candidates}
    ratios: dict[float, list[float]] = {order: [] for order in candidates}
    between = sorted({order + side for order in candidates for side in (-0.5, 0.5)})
    used = 0
    for window in windows:
        angle, torque = angle_rad[window], rows.torque_Nm[window]
        found = fit_orders(angle, torque, candidates, factor)
        used += len(angle) if found else 0
        for order, fitted in found.items():
            amplitudes[order].append(fitted)
        everything = fit_orders(angle, torque, [*candidates, *between], factor)
        for order in candidates:
            if {order - 0.5, order, order + 0.5} <= everything.keys():
                power = [abs(everything[order + side][0]) ** 2 for side in (-0.5, 0.0, 0.5)]
                # A torque that does not change has no power anywhere.
                if min(power) > 0.0:
                    ratios[order].append(float(np.log(2 * power[1] / (power[0] + power[2]))))
    return [
        _measure(order, amplitudes[order], ratios[order], used)
        for order in candidates
        if len(amplitudes[order]) >= LEAST_WINDOWS
    ]


def order_windows(angle_rad: NDArray[np.float64]) -> list[slice]:
    """Cut rows into the windows of travel in which orders are measured.

    Parameters
    ----------
    angle_rad : numpy.ndarray
        Motor angles, shape (rows,), rad.

    Returns
    -------
    list of slice
        Windows of one direction each.
    """
    turns = float(np.sum(np.abs(np.diff(angle_rad)))) / (2 * np.pi)
    length = min(WINDOW_TURNS, max(LEAST_WINDOW_TURNS, turns / WISHED_WINDOWS))
    return travel_windows(angle_rad, 2 * np.pi * length, 2 * (SLOW_DEGREE + 3))


def window_basis(
    angle_rad: NDArray[np.float64], candidates: Sequence[float], factor: float
) -> tuple[list[float], NDArray[np.float64]] | None:
    """Build what a window's torque is made of: orders, and a polynomial of the angle.

    Parameters
    ----------
    angle_rad : numpy.ndarray
        Motor angles of a window, shape (rows,), rad.
    candidates : sequence of float
        Orders, cycles per turn of the wave.
    factor : float
        Turns of the wave per motor turn, m.

    Returns
    -------
    tuple or None
        The orders that the window can show, and columns: their cosines, their sines, and Chebyshev
        polynomials up to `SLOW_DEGREE`. None where the window shows none.
    """
    per_row = float(np.quantile(np.abs(np.diff(angle_rad)), 0.9)) / (2 * np.pi)
    visible = [order for order in candidates if order * factor * per_row < MOST_CYCLES_PER_ROW]
    if not visible or len(angle_rad) < 2 * (2 * len(visible) + SLOW_DEGREE + 1):
        return None
    low, high = float(angle_rad.min()), float(angle_rad.max())
    scaled = (2 * angle_rad - low - high) / (high - low)
    turned = np.outer(factor * angle_rad, np.array(visible, float))
    slow = np.polynomial.chebyshev.chebvander(scaled, SLOW_DEGREE)
    return visible, np.column_stack([np.cos(turned), np.sin(turned), slow])


def fit_orders(
    angle_rad: NDArray[np.float64],
    torque_Nm: NDArray[np.float64],
    candidates: Sequence[float],
    factor: float,
) -> dict[float, tuple[complex, float]]:
    """Fit a window by least squares.

    Parameters
    ----------
    angle_rad, torque_Nm : numpy.ndarray
        Motor angles and torques of a window, shape (rows,), rad and Nm.
    candidates : sequence of float
        Orders, cycles per turn of the wave.
    factor : float
        Turns of the wave per motor turn, m.

    Returns
    -------
    dict
        By order, for those that the window can show: complex amplitude, Nm, of
        exp(i x order x m x motor angle), and its variance, Nm^2, both components together.
    """
    built = window_basis(angle_rad, candidates, factor)
    if built is None:
        return {}
    visible, basis = built
    # Columns are scaled alike, and what is left out below is far from losing the digits that the
    # normal equations do; many small decompositions of a tall matrix take most of the time.
    normal = basis.T @ basis
    try:
        diagonal = np.diag(np.linalg.cholesky(normal))
    except np.linalg.LinAlgError:
        return {}
    if diagonal.min() <= LEAST_PIVOT * diagonal.max():
        return {}
    inverse = np.linalg.inv(normal)
    solution = inverse @ (basis.T @ torque_Nm)
    left = torque_Nm - basis @ solution
    variance = float(left @ left) / max(1, len(left) - basis.shape[1])
    spread = np.diag(inverse) * variance
    count = len(visible)
    return {
        order: (
            complex(solution[place], -solution[count + place]),
            float(spread[place] + spread[count + place]),
        )
        for place, order in enumerate(visible)
    }


def _measure(
    order: float, fitted: list[tuple[complex, float]], ratios: list[float], rows: int
) -> FoundOrder:
    values = np.array([value for value, _ in fitted])
    variances = np.maximum(np.array([variance for _, variance in fitted]), 1e-24)
    # Between windows of equal noise and windows of equal scatter; noisy ones count for less.
    weights = 1.0 / (variances + float(np.median(variances)))
    weights /= weights.sum()
    mean = complex(np.sum(weights * values))
    away = np.abs(values - mean) ** 2
    scatter = float(np.sum(weights**2 * away)) * len(values) / (len(values) - 1)
    noise = float(np.sum(weights**2 * variances))
    # Of the two components together; one of them has half.
    variance = max(scatter, noise)
    # Few windows know their own scatter badly: Student's t takes the place of the normal.
    freedom = 2 * (len(values) - 1)
    gain = 0.5 * (freedom + 2) * float(np.log1p(2 * abs(mean) ** 2 / variance / freedom))
    cost = float(np.log(max(rows, 2)))
    steady, wandering = gain - cost, _gain_of_power(ratios) - cost
    is_steady = steady > 0.0 or wandering <= 0.0
    power = float(np.sum(weights * (np.abs(values) ** 2 - variances)))
    return FoundOrder(
        float(order),
        abs(mean) if is_steady else float(np.sqrt(max(power, 0.0))),
        float(np.angle(mean.conjugate())),
        float(np.sqrt(variance / 2)),
        max(steady, wandering),
        max(steady, wandering) > 0.0,
        is_steady,
    )


def _gain_of_power(ratios: list[float]) -> float:
    """Logarithm of the likelihood that more power than half an order beside gains."""
    if len(ratios) < LEAST_WINDOWS:
        return 0.0
    excess = float(np.mean(ratios)) - MEAN_LOG_RATIO
    return 0.5 * len(ratios) * (max(excess, 0.0) / DEVIATION_LOG_RATIO) ** 2
