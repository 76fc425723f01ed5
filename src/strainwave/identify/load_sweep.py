"""Torque or artefact without a reference: how an order changes with load and speed.

What physics says, and no more:

- A joint without load, that hardly moves, carries no torque at the mesh's frequency if its output is
  free to move: the gear's kinematic error accelerates what hangs on the output, and that torque goes
  with the square of the speed. What is left where load and speed vanish is the gauges' own: the wave
  deforms the flexspline whatever the load. This holds below the resonance of gear and load only;
  above it the output stands still, and the gear's spring makes torque of the same error at any
  speed. So vanishing speed means that the order is at `SLOW_HZ` or below.
- What goes with the square of the speed is torque.
- What goes with the load is either: gauges whose gain turns with the wave, or teeth that yield. It
  counts for neither side.

The complex amplitudes of the windows are fitted by a + b load in the slow windows, where a is the
artefact, and by a + b load + c speed^2 in all windows, where the last term is torque.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.identify.order_phasors import phasors_of, window_speeds_rad_s
from strainwave.identify.orders import order_windows
from strainwave.identify.torque_or_artefact import (
    EVEN_SHARE,
    LEAST_WINDOWS,
    UNDECIDABLE,
    OrderVerdict,
    Share,
    TorqueOrArtefact,
    weights_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from strainwave.identify.moving_rows import MovingRows
    from strainwave.identify.order_phasors import OrderPhasors

#: An order at or below this frequency is where speed vanishes; resonances of robot joints are above.
SLOW_HZ: Final = 5.0
#: Loads of the windows have to span this share of the rated torque, from 5 to 95 % of them.
LEAST_LOAD_SPAN: Final = 0.2
#: Speeds of the windows have to span this ratio, from 5 to 95 % of them.
LEAST_SPEED_RATIO: Final = 3.0
_ADVICE: Final = (
    "a reference torque sensor (--reference COLUMN) decides it, and so may a recording in free motion "
    "with slow and fast stretches under loads that differ"
)


@dataclass(frozen=True)
class _Windows:
    """One order in the windows that show it."""

    amplitude_Nm: NDArray[np.complex128]
    variance_Nm2: NDArray[np.float64]
    noise_power_Nm2: NDArray[np.float64]
    load: NDArray[np.float64]
    speed_square: NDArray[np.float64]
    is_slow: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.load)

    def without(self, window: int) -> _Windows:
        """Leave one window out."""
        kept = np.arange(len(self)) != window
        return _Windows(
            self.amplitude_Nm[kept],
            self.variance_Nm2[kept],
            self.noise_power_Nm2[kept],
            self.load[kept],
            self.speed_square[kept],
            self.is_slow[kept],
        )


def decide_by_load_sweep(
    rows: MovingRows,
    orders: Sequence[float],
    candidates: Sequence[float],
    factor: float,
    delay_s: float | None,
    rated_torque_Nm: float,
) -> TorqueOrArtefact:
    """Decide for each order whether it is torque, by how it changes with load and speed.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion, angles of the motor.
    orders : sequence of float
        Orders that are there, cycles per turn of the wave.
    candidates : sequence of float
        All orders that are kept apart.
    factor : float
        Turns of the wave per motor turn, m.
    delay_s : float or None
        Time by which the torque lags the angle; None where it is not known.
    rated_torque_Nm : float
        Full scale, Nm.

    Returns
    -------
    TorqueOrArtefact
        A verdict on each order; most recordings decide nothing.
    """
    angle_rad = rows.angle_rad - (delay_s or 0.0) * rows.speed_rad_s
    windows = order_windows(angle_rad)
    speeds = window_speeds_rad_s(rows, windows)
    loads = np.array([float(np.mean(rows.torque_Nm[each])) for each in windows]) / rated_torque_Nm
    phasors = phasors_of(angle_rad, rows.torque_Nm, windows, candidates, factor)
    verdicts = tuple(
        _verdict(order, phasors[order], speeds, loads, factor, delay_s) for order in orders
    )
    open_ones = [each for each in verdicts if each.decision == UNDECIDABLE]
    reasons = dict.fromkeys(each.reason for each in open_ones)
    says = []
    for reason in reasons:
        names = ", ".join(f"{each.order:g}" for each in open_ones if each.reason == reason)
        says.append(
            f"torque or artefact, order {names}: {UNDECIDABLE}: {reason}; removed as an artefact; "
            f"{_ADVICE}"
        )
    return TorqueOrArtefact(verdicts, None, tuple(says))


def _verdict(
    order: float,
    phasors: OrderPhasors,
    speeds_rad_s: NDArray[np.float64],
    loads: NDArray[np.float64],
    factor: float,
    delay_s: float | None,
) -> OrderVerdict:
    speed, load = speeds_rad_s[phasors.window], loads[phasors.window]
    missing = _missing(speed, load, delay_s)
    if missing:
        return OrderVerdict(order, UNDECIDABLE, reason=missing)
    slow = order * factor * speed / (2 * np.pi) <= SLOW_HZ
    square = (speed / float(np.max(speed))) ** 2
    windows = _Windows(
        phasors.amplitude_Nm, phasors.variance_Nm2, phasors.noise_power_Nm2, load, square, slow
    )
    inertial = _with_uncertainty(_inertial_share, windows, len(windows) - 3)
    if inertial is not None and inertial.interval[0] > EVEN_SHARE:
        return OrderVerdict(order, "keep", inertial, basis="load sweep")
    if int(np.count_nonzero(slow)) < LEAST_WINDOWS:
        reason = (
            f"its growth with speed does not make it torque, and hardly any of the motion is slow "
            f"enough ({SLOW_HZ:g} Hz of this order) to show what is left without acceleration"
        )
        return OrderVerdict(order, UNDECIDABLE, reason=reason)
    constant = _with_uncertainty(_constant_share, windows, int(np.count_nonzero(slow)) - 2)
    if constant is not None and constant.interval[0] > EVEN_SHARE:
        # What is not shown to be an artefact is counted as torque.
        rest = Share(1.0 - constant.value, constant.standard_uncertainty, constant.freedom)
        return OrderVerdict(order, "remove", rest, basis="load sweep")
    return OrderVerdict(
        order,
        UNDECIDABLE,
        reason="neither the part that needs neither load nor speed nor the part that goes with the "
        "square of the speed is clearly more than half of it",
    )


def _missing(
    speed_rad_s: NDArray[np.float64], load: NDArray[np.float64], delay_s: float | None
) -> str:
    """Say what the recording lacks; nothing where load and speed change enough."""
    if len(speed_rad_s) < 2 * LEAST_WINDOWS:
        return f"only {len(speed_rad_s)} windows of travel show it, of {2 * LEAST_WINDOWS} needed"
    low, high = np.quantile(speed_rad_s, (0.05, 0.95))
    lowest, highest = np.quantile(load, (0.05, 0.95))
    lacks = []
    if high < LEAST_SPEED_RATIO * low:
        lacks.append(f"the speed changes by a factor of {high / low:.2g} only")
    if highest - lowest < LEAST_LOAD_SPAN:
        lacks.append(f"the load changes by {highest - lowest:.2g} of the rated torque only")
    if delay_s is None and not lacks:
        lacks.append("the delay between angle and torque is not known")
    return " and ".join(lacks)


def _constant_share(windows: _Windows) -> float:
    """Share of what is left in slow windows at no load."""
    slow = windows.is_slow
    columns = np.column_stack([np.ones(int(slow.sum())), windows.load[slow]])
    fitted = _fit(columns, windows.amplitude_Nm[slow], windows.variance_Nm2[slow])
    return _share_of(np.full(len(windows), fitted[0]), windows)


def _inertial_share(windows: _Windows) -> float:
    """Share of what goes with the square of the speed."""
    columns = np.column_stack([np.ones(len(windows)), windows.load, windows.speed_square])
    fitted = _fit(columns, windows.amplitude_Nm, windows.variance_Nm2)
    return _share_of(fitted[2] * windows.speed_square, windows)


def _fit(
    columns: NDArray[np.float64],
    amplitude_Nm: NDArray[np.complex128],
    variance_Nm2: NDArray[np.float64],
) -> NDArray[np.complex128]:
    scale = np.sqrt(weights_of(variance_Nm2))
    solution = np.linalg.lstsq(columns * scale[:, None], amplitude_Nm * scale, rcond=None)[0]
    return np.asarray(solution, np.complex128)


def _share_of(part_Nm: NDArray[np.complex128], windows: _Windows) -> float:
    weights = weights_of(windows.variance_Nm2)
    together = np.real(part_Nm * np.conj(windows.amplitude_Nm))
    power = np.abs(windows.amplitude_Nm) ** 2 - windows.noise_power_Nm2
    whole = float(np.sum(weights * power))
    return float(np.sum(weights * together)) / whole if whole > 0.0 else float("nan")


def _with_uncertainty(
    share_of: Callable[[_Windows], float], windows: _Windows, freedom: int
) -> Share | None:
    """Give a share with the uncertainty of the jackknife: every window left out once."""
    value = share_of(windows)
    count = len(windows)
    without = np.array([share_of(windows.without(window)) for window in range(count)])
    variance = float(np.sum((without - without.mean()) ** 2)) * (count - 1) / count
    if not np.isfinite(value + variance):
        return None
    return Share(value, float(np.sqrt(variance)), max(1, freedom))
