"""When the motor of a recording moves, how fast, and which rows only repeat the one before."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave.arrays import steps
from strainwave.records.histogram import LogHistogram

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOVING_RAD_S: Final = 0.5
"""The motor moves where it is faster than this, 5 turns a minute."""
LARGEST_MOTOR_SPEED_RAD_S: Final = 1500.0
"""No strain wave gear is driven faster than this, 14300 turns a minute."""
_TURN_RAD = 2.0 * math.pi
_CHANGES_PER_SPEED = 8
# Stamps closer than this say nothing of a speed.
_SHORTEST_S = 1e-12


@dataclass(frozen=True)
class Moving:
    """How the motor moves.

    Attributes
    ----------
    largest_speed_rad_s, typical_speed_rad_s, speed_99th_percentile_rad_s : float or None
        Of the motor while it moves (typical: the median), rad/s; None where it never does.
    moving_rows : int
        Rows while it moves.
    repeated_rows : int
        Rows that repeat angle and torque of the row before while it moves.
    rest_torque_noise_Nm : float or None
        Standard deviation of the torque's noise from row to row at rest, Nm; None without rest.
    """

    largest_speed_rad_s: float | None
    typical_speed_rad_s: float | None
    speed_99th_percentile_rad_s: float | None
    moving_rows: int
    repeated_rows: int
    rest_torque_noise_Nm: float | None


@dataclass
class _Since:
    """What happened since the value last changed."""

    rows: int = 0
    repeated: int = 0
    squares: float = 0.0

    def add(self, value_steps: NDArray[np.float64], torque_steps: NDArray[np.float64]) -> None:
        self.rows += len(value_steps)
        self.repeated += _repeated(value_steps, torque_steps)
        self.squares += _squares(torque_steps)


def _repeated(value_steps: NDArray[np.float64], torque_steps: NDArray[np.float64]) -> int:
    return int(np.count_nonzero((value_steps == 0.0) & (torque_steps == 0.0)))


def _squares(torque_steps: NDArray[np.float64]) -> float:
    return float(np.sum(np.where(np.isfinite(torque_steps), torque_steps**2, 0.0)))


class MovingTally:
    """Takes angles or speeds of rows in order, chunk by chunk.

    The speed between two changes of the angle counts for all rows between them, so that samples
    which are held for several rows make nothing look faster than it is. It is taken over eight
    changes, so that stamps which come in bursts make nothing look fast either.

    Parameters
    ----------
    gain : float
        Motor turns for one turn of the measured side.
    is_speed : bool
        Speeds are taken instead of angles.
    wrapped : bool
        Angles go back to their start after a turn.
    """

    def __init__(self, gain: float, *, is_speed: bool = False, wrapped: bool = False) -> None:
        self._gain = gain
        self._is_speed = is_speed
        self._wrapped = wrapped
        self._speeds = LogHistogram()
        self._last_row: tuple[float, float, float] | None = None
        self._last_change: tuple[float, float] = (0.0, 0.0)
        self._since = _Since()
        self._group: tuple[NDArray[np.float64], NDArray[np.float64]] = (np.empty(0), np.empty(0))
        self._moving = 0
        self._repeated = 0
        self._rest_rows = 0
        self._rest_squares = 0.0

    def take(
        self,
        time_s: NDArray[np.float64],
        value: NDArray[np.float64],
        torque_Nm: NDArray[np.float64],
    ) -> None:
        """Take the next rows, each later than the last.

        Parameters
        ----------
        time_s, value, torque_Nm : numpy.ndarray
            Time, s, angle, rad (or speed, rad/s), and torque, Nm, of shape (rows,); time and value
            are finite.
        """
        if not len(time_s):
            return
        if self._last_row is None:
            self._last_row = (float(time_s[0]), float(value[0]), float(torque_Nm[0]))
            self._last_change = self._last_row[:2]
            time_s, value, torque_Nm = time_s[1:], value[1:], torque_Nm[1:]
            if not len(time_s):
                return
        _, last_value, last_torque_Nm = self._last_row
        value_steps = steps(value, last_value)
        if self._moves_on(time_s, value, value_steps):
            self._last_row = (float(time_s[-1]), float(value[-1]), float(torque_Nm[-1]))
            return
        torque_steps = steps(torque_Nm, last_torque_Nm)
        # A mapped speed says for every row by itself how fast the motor is.
        changed = np.ones(len(value), np.bool_) if self._is_speed else value_steps != 0.0
        self._count(time_s, value, value_steps, torque_steps, changed)
        self._last_row = (float(time_s[-1]), float(value[-1]), float(torque_Nm[-1]))

    def _moves_on(
        self,
        time_s: NDArray[np.float64],
        value: NDArray[np.float64],
        value_steps: NDArray[np.float64],
    ) -> bool:
        """Take rows in all of which the motor moves; else take nothing, and return False."""
        assert self._last_row is not None
        if self._is_speed or self._last_change != self._last_row[:2] or not value_steps.all():
            return False
        travels = value_steps
        if self._wrapped:
            travels = value_steps - _TURN_RAD * np.rint(value_steps / _TURN_RAD)
        times = steps(time_s, self._last_change[0])
        np.maximum(times, _SHORTEST_S, out=times)
        if not (self._speeds_of(travels, times) > MOVING_RAD_S).all():
            return False
        self._moving += len(travels)
        self._add_speeds(travels, times)
        self._last_change = (float(time_s[-1]), float(value[-1]))
        return True

    def _speeds_of(
        self, travels: NDArray[np.float64], times: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        speeds = travels / times
        np.abs(speeds, out=speeds)
        speeds *= self._gain
        return speeds

    def _count(
        self,
        time_s: NDArray[np.float64],
        value: NDArray[np.float64],
        value_steps: NDArray[np.float64],
        torque_steps: NDArray[np.float64],
        changed: NDArray[np.bool_],
    ) -> None:
        held = np.flatnonzero(~changed)
        if len(held) == len(value):
            self._since.add(value_steps, torque_steps)
            return
        ends: Any = np.flatnonzero(changed) if len(held) else slice(None)
        travels = value_steps[ends]
        if self._wrapped:
            travels = travels - _TURN_RAD * np.rint(travels / _TURN_RAD)
        times = steps(time_s[ends], self._last_change[0])
        np.maximum(times, _SHORTEST_S, out=times)
        speeds = np.abs(value) * self._gain if self._is_speed else self._speeds_of(travels, times)
        moving = speeds > MOVING_RAD_S
        self._moving += int(np.count_nonzero(moving))
        at_rest = torque_steps[ends][~moving]
        self._rest_rows += len(at_rest)
        self._rest_squares += _squares(at_rest)
        if self._is_speed:
            self._repeated += _repeated(value_steps[moving], torque_steps[moving])
            self._speeds.add(speeds[moving])
        else:
            self._add_speeds(travels, times)
        last = len(value) - 1
        if len(held):
            last = int(ends[-1])
            self._count_held(held[: np.searchsorted(held, last)], ends, moving, torque_steps)
        self._close_since(moves=bool(moving[0]))
        self._last_change = (float(time_s[last]), float(value[last]))
        self._since.add(value_steps[last + 1 :], torque_steps[last + 1 :])

    def _count_held(
        self,
        held: NDArray[np.intp],
        ends: NDArray[np.intp],
        moving: NDArray[np.bool_],
        torque_steps: NDArray[np.float64],
    ) -> None:
        # A row in which the angle did not change belongs to the change after it.
        moves = moving[np.searchsorted(ends, held)]
        self._moving += int(np.count_nonzero(moves))
        self._repeated += int(np.count_nonzero(torque_steps[held[moves]] == 0.0))
        at_rest = torque_steps[held[~moves]]
        self._rest_rows += len(at_rest)
        self._rest_squares += _squares(at_rest)

    def _close_since(self, *, moves: bool) -> None:
        since, self._since = self._since, _Since()
        if moves:
            self._moving += since.rows
            self._repeated += since.repeated
        else:
            self._rest_rows += since.rows
            self._rest_squares += since.squares

    def _add_speeds(self, travels: NDArray[np.float64], times: NDArray[np.float64]) -> None:
        travels = np.concatenate([self._group[0], travels])
        times = np.concatenate([self._group[1], times])
        whole = len(travels) - len(travels) % _CHANGES_PER_SPEED
        self._add_groups(_sums_of_groups(travels[:whole]), _sums_of_groups(times[:whole]))
        self._group = (travels[whole:], times[whole:])

    def _add_groups(self, travels: NDArray[np.float64], times: NDArray[np.float64]) -> None:
        speeds = self._speeds_of(travels, times)
        self._speeds.add(speeds[speeds > MOVING_RAD_S])

    def finish(self) -> Moving:
        """Say how the motor moved.

        Returns
        -------
        Moving
            Of all rows that were taken.
        """
        travels, times = self._group
        if len(travels):
            self._add_groups(travels.sum(keepdims=True), times.sum(keepdims=True))
            self._group = (np.empty(0), np.empty(0))
        rest_rows = self._rest_rows + self._since.rows
        rest_squares = self._rest_squares + self._since.squares
        some = self._speeds.count > 0
        return Moving(
            self._speeds.largest if some else None,
            self._speeds.quantile(0.5),
            self._speeds.quantile(0.99),
            self._moving,
            self._repeated,
            # The difference of two rows has twice the variance of one.
            math.sqrt(0.5 * rest_squares / rest_rows) if rest_rows else None,
        )


def _sums_of_groups(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Add up groups of `_CHANGES_PER_SPEED`, a power of two, by pairs of pairs."""
    for _ in range(_CHANGES_PER_SPEED.bit_length() - 1):
        values = values[0::2] + values[1::2]
    return values
