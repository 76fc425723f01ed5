"""Errors, attenuation and collateral power, each from arrays alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.signal import detrend, get_window

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Half width of what belongs to a line, in orders.
LINE_HALF_WIDTH: Final = 0.3
#: Below this the joint's own load moves; it is neither ripple nor noise.
LOWEST_HZ: Final = 1.0


def rms(values: NDArray[np.float64]) -> float:
    """Root of the mean square.

    Parameters
    ----------
    values : numpy.ndarray
        Values.

    Returns
    -------
    float
        Their rms.
    """
    return float(np.sqrt(np.mean(np.square(values))))


def error_by_phase(
    error_Nm: NDArray[np.float64],
    phase: NDArray[np.str_],
    phases: Sequence[str],
    full_scale_Nm: float,
) -> dict[str, float]:
    """RMS error of each phase, and their mean.

    Parameters
    ----------
    error_Nm : numpy.ndarray
        Output minus true torque, shape (samples,), Nm.
    phase : numpy.ndarray
        Phase of each sample.
    phases : sequence of str
        The phases that count.
    full_scale_Nm : float
        Rated torque.

    Returns
    -------
    dict of str to float
        Error by phase and ``"mean"``, the mean of these, in percent of full scale.
    """
    errors = {name: 100 * rms(error_Nm[phase == name]) / full_scale_Nm for name in phases}
    return errors | {"mean": float(np.mean(list(errors.values())))}


def line_powers(
    values: NDArray[np.float64],
    angle_rad: NDArray[np.float64],
    orders: Sequence[float],
    windows: Sequence[slice],
    polynomial_degree: int,
) -> NDArray[np.float64]:
    """Power of lines, least squares in each window with a polynomial, averaged over the windows.

    Parameters
    ----------
    values : numpy.ndarray
        Torque or ripple, shape (samples,).
    angle_rad : numpy.ndarray
        Angle per turn of which the orders count, shape (samples,), rad.
    orders : sequence of float
        Orders fitted together.
    windows : sequence of slice
        Where.
    polynomial_degree : int
        Degree of the slow part, in samples.

    Returns
    -------
    numpy.ndarray
        Squared amplitude of each order, shape (orders,).
    """
    powers = np.zeros((len(windows), len(orders)))
    for n, window in enumerate(windows):
        turned = np.multiply.outer(angle_rad[window] - angle_rad[window][0], orders)
        slow = np.polynomial.legendre.legvander(np.linspace(-1, 1, len(turned)), polynomial_degree)
        basis = np.concatenate([np.cos(turned), np.sin(turned), slow], axis=1)
        fit = np.linalg.lstsq(basis, values[window], rcond=None)[0]
        powers[n] = fit[: len(orders)] ** 2 + fit[len(orders) : 2 * len(orders)] ** 2
    return powers.mean(axis=0)


def attenuation_dB(before: NDArray[np.float64], after: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ratio of powers in decibels, positive where power was removed.

    Parameters
    ----------
    before, after : numpy.ndarray
        Powers.

    Returns
    -------
    numpy.ndarray
        Attenuation, dB; at most 200.
    """
    return 10 * np.log10(before / np.maximum(after, 1e-20 * before))


def even_windows(first: int, last: int, length: int) -> list[slice]:
    """Cut a range into windows of equal length.

    Parameters
    ----------
    first, last : int
        The range, last exclusive.
    length : int
        Samples per window; what remains at the end is left out.

    Returns
    -------
    list of slice
        The windows.
    """
    return [slice(start, start + length) for start in range(first, last - length + 1, length)]


def power_change_outside_dB(
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    *,
    sample_rate_Hz: float,
    turn_Hz: float,
    orders: Sequence[float],
) -> tuple[float, float]:
    """Change of power more than 0.3 order beside the removed lines, at one speed.

    Parameters
    ----------
    before, after : numpy.ndarray
        Torque before and after, shape (samples,).
    sample_rate_Hz : float
        Sampling rate.
    turn_Hz : float
        Turns of the wave per second.
    orders : sequence of float
        Removed orders.

    Returns
    -------
    total_dB : float
        Change of the whole power there, from 1 Hz upwards; below, load moves.
    worst_dB : float
        The largest change in a band of half an order, of either sign.
    """
    shape = get_window("blackmanharris", len(before))
    frequency_Hz = np.fft.rfftfreq(len(before), 1 / sample_rate_Hz)
    powers = [np.abs(np.fft.rfft(shape * detrend(values))) ** 2 for values in (before, after)]
    order = frequency_Hz / turn_Hz
    outside = frequency_Hz >= LOWEST_HZ
    for line in orders:
        outside &= np.abs(order - line) > LINE_HALF_WIDTH
    total_dB = _change_dB(powers[0][outside], powers[1][outside])
    bands = np.floor(2 * order).astype(int)
    changes = [
        _change_dB(powers[0][outside & (bands == band)], powers[1][outside & (bands == band)])
        for band in np.unique(bands[outside])
    ]
    return total_dB, max(changes, key=abs)


def _change_dB(before: NDArray[np.float64], after: NDArray[np.float64]) -> float:
    return float(10 * np.log10(max(after.sum(), 1e-30) / max(before.sum(), 1e-30)))
