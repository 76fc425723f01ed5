"""The first pass over a recording: what it holds, before anything is computed from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.arrays import steps
from strainwave.records.moving import Moving, MovingTally
from strainwave.records.timing import Timing, TimingTally

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.records.conversion import Columns
    from strainwave.records.layout import Layout

_TURN_RAD: Final = 2.0 * math.pi
_DEGREES_OF_A_TURN: Final = 360.0
#: A wrapped angle stays within so many turns.
_WIDEST_TURN: Final = 1.005


@dataclass(frozen=True)
class Survey:
    """What a recording holds.

    Attributes
    ----------
    rows : int
        Rows of data.
    timing : Timing
        What the time stamps say.
    moving : Moving
        How the motor moves.
    angle_is_wrapped : bool
        The angle goes back to its start after a turn of the measured side.
    angle_looks_like_degrees : bool
        Mapped as radians, the angle goes back to its start after 360 of them.
    angle_lowest_rad, angle_highest_rad : float or None
        Of the measured side, as recorded, rad; None where a speed is mapped.
    missing_by_key : dict
        Rows without a value, by key of the mapping.
    torque_lowest_Nm, torque_highest_Nm : float or None
        Range of the torque, Nm; None where there is none.
    """

    rows: int
    timing: Timing
    moving: Moving
    angle_is_wrapped: bool
    angle_looks_like_degrees: bool
    angle_lowest_rad: float | None
    angle_highest_rad: float | None
    missing_by_key: dict[str, int]
    torque_lowest_Nm: float | None
    torque_highest_Nm: float | None

    @property
    def largest_torque_Nm(self) -> float:
        """Largest magnitude of the torque, Nm; 0 where there is none."""
        if self.torque_lowest_Nm is None or self.torque_highest_Nm is None:
            return 0.0
        return max(-self.torque_lowest_Nm, self.torque_highest_Nm, 0.0)

    @property
    def share_at_rest(self) -> float:
        """Share of the rows during which the motor does not move, 0 to 1."""
        return 1.0 - self.moving.moving_rows / max(1, self.rows)

    @property
    def share_repeated(self) -> float:
        """Share of the rows in motion that only repeat the row before, 0 to 1."""
        return self.moving.repeated_rows / max(1, self.moving.moving_rows)

    @property
    def sample_period_s(self) -> float:
        """Median interval of the rows, s."""
        assert self.timing.median_interval_s is not None
        return self.timing.median_interval_s


def estimated_rated_torque_Nm(survey: Survey) -> float:
    """Estimate a full scale where none is given: the largest torque, rounded up to two digits.

    Parameters
    ----------
    survey : Survey
        What the recording holds.

    Returns
    -------
    float
        Full scale, Nm; 1 where the torque is 0 throughout.
    """
    largest_Nm = survey.largest_torque_Nm
    if largest_Nm <= 0.0:
        return 1.0
    exponent = math.floor(math.log10(largest_Nm)) - 1
    # A power of ten below 1 is divided by, so that 9.3 comes out as 9.3.
    if exponent < 0:
        return math.ceil(largest_Nm * 10.0**-exponent * (1.0 - 1e-12)) / 10.0**-exponent
    return math.ceil(largest_Nm / 10.0**exponent * (1.0 - 1e-12)) * 10.0**exponent


class Surveyor:
    """Takes a recording chunk by chunk; how it is cut makes no difference.

    Parameters
    ----------
    layout : Layout
        How the recording is read.
    """

    def __init__(self, layout: Layout) -> None:
        gain = layout.motor_turns_per_turn
        self._timing = TimingTally()
        self._is_speed = "speed" in layout.columns
        self._plain = MovingTally(gain, is_speed=self._is_speed)
        self._unwrapped = MovingTally(gain, wrapped=True)
        self._rows = 0
        self._missing: dict[str, int] = {}
        self._last_angle_rad = math.nan
        # Steps of more than half a turn, and of more than half of 360 rad, from row to row.
        self._jumps = {_TURN_RAD: 0, _DEGREES_OF_A_TURN: 0}
        self._angles = _Range()
        self._torques = _Range()

    def take(self, columns: Columns) -> None:
        """Take the next rows.

        Parameters
        ----------
        columns : Columns
            The rows that follow those of the last call.
        """
        self._rows += len(columns)
        value = columns.speed_rad_s if self._is_speed else columns.angle_rad
        assert value is not None
        self._count_missing("time", columns.time_s)
        self._count_missing("speed" if self._is_speed else "angle", value)
        self._count_missing("torque", columns.torque_Nm)
        if columns.expected_torque_Nm is not None:
            self._count_missing("expected-torque", columns.expected_torque_Nm)
        self._torques.take(columns.torque_Nm)
        rows = (columns.time_s, value, columns.torque_Nm)
        usable = self._timing.take(columns)
        if not (usable.all() and _are_finite(value)):
            usable &= np.isfinite(value)
            rows = (columns.time_s[usable], value[usable], columns.torque_Nm[usable])
        self._plain.take(*rows)
        if not self._is_speed:
            self._take_angle(value)
            # What has left the range of a turn goes on, and is not wrapped.
            if self._angles.width <= _WIDEST_TURN * _TURN_RAD:
                self._unwrapped.take(*rows)

    def _count_missing(self, key: str, values: NDArray[np.float64]) -> None:
        missing = 0 if _are_finite(values) else int(np.count_nonzero(~np.isfinite(values)))
        self._missing[key] = self._missing.get(key, 0) + missing

    def _take_angle(self, angle_rad: NDArray[np.float64]) -> None:
        known_rad = _finite(angle_rad)
        if not len(known_rad):
            return
        changes_rad = np.abs(steps(known_rad, self._last_angle_rad))
        for turn in self._jumps:
            self._jumps[turn] += int(np.count_nonzero(changes_rad > 0.5 * turn))
        self._last_angle_rad = float(known_rad[-1])
        self._angles.take(known_rad)

    def finish(self) -> Survey:
        """Say what the recording holds.

        Returns
        -------
        Survey
            Of all rows that were taken.
        """
        lowest, highest = self._angles.ends()
        width = self._angles.width
        # Jumps of more than half a turn in a range of just one turn: nothing else looks like that.
        goes_back_after = [
            turn
            for turn, jumps in self._jumps.items()
            if jumps and 0.9 * turn <= width <= _WIDEST_TURN * turn
        ]
        wrapped = _TURN_RAD in goes_back_after
        torque_lowest, torque_highest = self._torques.ends()
        return Survey(
            self._rows,
            self._timing.finish(),
            (self._unwrapped if wrapped else self._plain).finish(),
            wrapped,
            _DEGREES_OF_A_TURN in goes_back_after,
            lowest,
            highest,
            dict(self._missing),
            torque_lowest,
            torque_highest,
        )


class _Range:
    def __init__(self) -> None:
        self._lowest = math.inf
        self._highest = -math.inf

    def take(self, values: NDArray[np.float64]) -> None:
        known = _finite(values)
        if len(known):
            self._lowest = min(self._lowest, float(known.min()))
            self._highest = max(self._highest, float(known.max()))

    @property
    def width(self) -> float:
        return max(0.0, self._highest - self._lowest)

    def ends(self) -> tuple[float, float] | tuple[None, None]:
        return (self._lowest, self._highest) if self._lowest <= self._highest else (None, None)


def _finite(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return values if _are_finite(values) else values[np.isfinite(values)]


def _are_finite(values: NDArray[np.float64]) -> bool:
    # Both ends of a range are finite only where all of it is: quicker than a look at each value.
    return len(values) == 0 or bool(np.isfinite(values.min()) and np.isfinite(values.max()))
