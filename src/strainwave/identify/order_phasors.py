"""Complex amplitudes of the ripple's orders, window by window, with speed and load beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave.identify.orders import fit_orders

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.identify.moving_rows import MovingRows


@dataclass(frozen=True)
class OrderPhasors:
    """One order in the windows that show it.

    Attributes
    ----------
    window : numpy.ndarray
        Numbers of the windows, shape (n,).
    amplitude_Nm : numpy.ndarray
        Complex amplitudes, shape (n,), Nm.
    variance_Nm2 : numpy.ndarray
        Their variances, both components together, shape (n,), Nm^2, if what is left in a window is
        white; good for weights.
    beside_Nm : numpy.ndarray
        Complex amplitudes half an order below and above, shape (n, 2), Nm: noise near the order's
        frequency, also where contacts leave something in the window that is not white. NaN where
        the window does not show both.
    """

    window: NDArray[np.int64]
    amplitude_Nm: NDArray[np.complex128]
    variance_Nm2: NDArray[np.float64]
    beside_Nm: NDArray[np.complex128]

    def __len__(self) -> int:
        return len(self.window)

    @property
    def noise_power_Nm2(self) -> NDArray[np.float64]:
        """Power of the noise in the amplitudes, shape (n,), Nm^2."""
        return noise_power_Nm2(self.beside_Nm, self.beside_Nm, self.variance_Nm2)


def noise_power_Nm2(
    first_Nm: NDArray[np.complex128],
    second_Nm: NDArray[np.complex128],
    otherwise_Nm2: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute the power that the noise of two signals has in common.

    Parameters
    ----------
    first_Nm, second_Nm : numpy.ndarray
        Complex amplitudes half an order below and above, shape (n, 2), Nm.
    otherwise_Nm2 : numpy.ndarray
        What is taken where there are none, shape (n,), Nm^2.

    Returns
    -------
    numpy.ndarray
        Shape (n,), Nm^2; of one signal with itself its noise.
    """
    power = np.mean(np.real(first_Nm * np.conj(second_Nm)), axis=1)
    return np.where(np.isfinite(power), power, otherwise_Nm2)


def phasors_of(
    angle_rad: NDArray[np.float64],
    torque_Nm: NDArray[np.float64],
    windows: Sequence[slice],
    candidates: Sequence[float],
    factor: float,
) -> dict[float, OrderPhasors]:
    """Measure every order in every window.

    Parameters
    ----------
    angle_rad, torque_Nm : numpy.ndarray
        Motor angles and torques, shape (rows,), rad and Nm.
    windows : sequence of slice
        From `strainwave.identify.orders.order_windows`.
    candidates : sequence of float
        Orders, cycles per turn of the wave.
    factor : float
        Turns of the wave per motor turn, m.

    Returns
    -------
    dict
        By order.
    """
    found: dict[float, list[tuple[int, complex, float, list[complex]]]]
    found = {order: [] for order in candidates}
    between = sorted({order + side for order in candidates for side in (-0.5, 0.5)})
    for number, window in enumerate(windows):
        rows = (angle_rad[window], torque_Nm[window])
        fitted = fit_orders(*rows, candidates, factor)
        beside = fit_orders(*rows, [*candidates, *between], factor)
        for order, (amplitude, variance) in fitted.items():
            sides = [order + side for side in (-0.5, 0.5)]
            shown = all(side in beside for side in sides)
            noise = [beside[side][0] if shown else complex(np.nan) for side in sides]
            found[order].append((number, amplitude, variance, noise))
    return {
        order: OrderPhasors(
            np.array([each[0] for each in listed], np.int64),
            np.array([each[1] for each in listed], np.complex128),
            np.array([each[2] for each in listed], np.float64),
            np.array([each[3] for each in listed], np.complex128).reshape(-1, 2),
        )
        for order, listed in found.items()
    }


def window_speeds_rad_s(rows: MovingRows, windows: Sequence[slice]) -> NDArray[np.float64]:
    """Give the high speed of every window.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion, angles of the motor.
    windows : sequence of slice
        The windows.

    Returns
    -------
    numpy.ndarray
        The speed that a tenth of a window's rows exceed, shape (windows,), rad/s.
    """
    return np.array(
        [float(np.quantile(np.abs(rows.speed_rad_s[window]), 0.9)) for window in windows]
    )


def block_sums(values: NDArray[np.float64], blocks: int) -> NDArray[np.float64]:
    """Add up consecutive windows, so that what lasts longer than one is not taken for chance.

    Parameters
    ----------
    values : numpy.ndarray
        One value or row of values for each window, shape (windows, ...).
    blocks : int
        How many sums at most.

    Returns
    -------
    numpy.ndarray
        Shape (sums, ...).
    """
    parts = np.array_split(values, min(blocks, len(values)))
    return np.array([np.sum(part, axis=0) for part in parts])
