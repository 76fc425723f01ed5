"""Each order by itself: its amplitude over time and load, before and after."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave.fidelity.scene import lines_apart
from strainwave.identify.moving_rows import travel_windows
from strainwave.identify.orders import SLOW_DEGREE, fit_orders

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.evidence.motion import Motion

#: Motor turns of a window where the recording has enough of them, and at least.
WINDOW_TURNS: Final = 4.0
SHORTEST_TURNS: Final = 3.0
#: Windows beyond which they are made longer.
MOST_WINDOWS: Final = 400


@dataclass(frozen=True)
class OrderLine:
    """One order over a recording.

    Attributes
    ----------
    order : float
        Cycles per motor turn.
    is_kept : bool
        It is learned but left in the torque, as real torque.
    is_told : bool
        Whether the method removes or keeps it because it was told to, and not only looked at.
    time_s, speed_rad_s, load_Nm : numpy.ndarray
        Middle of each window of travel, shape (windows,), s; its motor speed, rad/s; the mean of
        the torque without ripple, Nm.
    before_Nm, after_Nm : numpy.ndarray
        Amplitude, zero to peak, shape (windows,), Nm.
    noise_Nm : float
        Amplitude that is read where there is noise alone, root mean square, Nm.
    window_turns : float
        Motor turns of a window, at least.
    """

    order: float
    is_kept: bool
    is_told: bool
    time_s: NDArray[np.float64]
    speed_rad_s: NDArray[np.float64]
    load_Nm: NDArray[np.float64]
    before_Nm: NDArray[np.float64]
    after_Nm: NDArray[np.float64]
    noise_Nm: float
    window_turns: float

    @property
    def before_rms_Nm(self) -> float:
        """Amplitude before, root mean square over the windows, Nm."""
        return float(np.sqrt(np.mean(self.before_Nm**2)))

    @property
    def after_rms_Nm(self) -> float:
        """Amplitude after, root mean square over the windows, Nm."""
        return float(np.sqrt(np.mean(self.after_Nm**2)))

    @property
    def change_dB(self) -> float | None:
        """Amplitude after over before, dB; negative where there is less. None for 0."""
        if self.before_rms_Nm <= 0.0 or self.after_rms_Nm <= 0.0:
            return None
        return 20.0 * math.log10(self.after_rms_Nm / self.before_rms_Nm)

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name.

        Returns
        -------
        dict
            The order, its amplitudes, and how many windows they are of.
        """
        return {
            "order": self.order,
            "is_kept": self.is_kept,
            "before_Nm": self.before_rms_Nm,
            "after_Nm": self.after_rms_Nm,
            "change_dB": self.change_dB,
            "noise_Nm": self.noise_Nm,
            "windows": len(self.time_s),
        }


def order_lines(
    motion: Motion, orders: Sequence[float], kept: Sequence[float], *, are_told: bool
) -> tuple[OrderLine, ...]:
    """Measure each order in windows of travel, by least squares beside a slow torque.

    Parameters
    ----------
    motion : Motion
        The rows.
    orders, kept : sequence of float
        Orders that are removed, and orders that are learned and left, cycles per motor turn.
    are_told : bool
        Whether the method knows of these orders.

    Returns
    -------
    tuple of OrderLine
        Rising; without those that the windows cannot tell from slow torque or from each other.
    """
    turns = WINDOW_TURNS if motion.turns >= 4 * WINDOW_TURNS else SHORTEST_TURNS
    turns = max(turns, motion.turns / MOST_WINDOWS)
    apart = lines_apart([*orders, *kept], turns)
    windows = travel_windows(motion.angle_rad, 2 * np.pi * turns, 2 * (SLOW_DEGREE + 3))
    rows: dict[float, list[tuple[float, ...]]] = {order: [] for order in apart}
    for window in windows:
        before, after = (
            fit_orders(motion.angle_rad[window], torque_Nm[window], apart, 1.0)
            for torque_Nm in motion.torque_Nm
        )
        where = (
            float(np.mean(motion.time_s[window])),
            float(np.median(motion.speed_rad_s[window])),
            float(np.mean(motion.torque_Nm[1, window])),
        )
        for order in before.keys() & after.keys():
            (first, variance), (second, _) = before[order], after[order]
            rows[order].append((*where, abs(first), abs(second), variance))
    lines = []
    for order, found in rows.items():
        if found:
            time_s, speed, load_Nm, first, second, variance = np.array(found).T
            noise_Nm = float(np.sqrt(np.mean(variance)))
            lines.append(
                OrderLine(
                    order,
                    order in kept,
                    are_told,
                    *(time_s, speed, load_Nm, first, second),
                    noise_Nm,
                    turns,
                )
            )
    return tuple(lines)
