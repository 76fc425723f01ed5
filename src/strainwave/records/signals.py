"""From columns in base units to the samples that methods take."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Generic, TypeVar

import numpy as np

from strainwave.samples import Samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.records.acceleration import CentredAcceleration
    from strainwave.records.conversion import Columns
    from strainwave.records.gauge_watch import GaugeWatch
    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey

_TURN_RAD: Final = 2.0 * math.pi
Number = TypeVar("Number", bound=np.generic)


@dataclass(frozen=True)
class Rows:
    """Consecutive rows, ready for a method, with the recording's own time beside them.

    Attributes
    ----------
    log_time_s : numpy.ndarray
        Time as the recording counts it, shape (rows,), s.
    samples : Samples
        The rows; their time counts from the recording's first stamp, so that stamps since 1970
        keep their digits.
    gauge_status : numpy.ndarray
        What the watch over the gauges says, bits of `strainwave.StatusFlag`, shape (rows,), uint32;
        0 without a watch.
    """

    log_time_s: NDArray[np.float64]
    samples: Samples
    gauge_status: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.log_time_s)

    def part(self, rows: slice) -> Rows:
        """Take some of the rows.

        Parameters
        ----------
        rows : slice
            Which.

        Returns
        -------
        Rows
            These.
        """
        samples = self.samples
        return Rows(
            self.log_time_s[rows],
            Samples(
                samples.time_s[rows],
                samples.motor_angle_rad[rows],
                samples.torque_Nm[rows],
                samples.expected_torque_Nm[rows],
            ),
            self.gauge_status[rows],
        )


class Unwrapping:
    """Adds whole turns to an angle that goes back to its start after each, as `numpy.unwrap`."""

    def __init__(self) -> None:
        self._last_rad = math.nan
        self._turns = 0.0

    def unwrap(self, angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
        """Unwrap the next rows.

        Parameters
        ----------
        angle_rad : numpy.ndarray
            Angles within a turn, shape (rows,), rad; NaN where not known.

        Returns
        -------
        numpy.ndarray
            The same angles, continued over the turns.
        """
        known = np.isfinite(angle_rad)
        steps = np.diff(angle_rad[known], prepend=self._last_rad)
        steps[~np.isfinite(steps)] = 0.0
        # Whole numbers are added without rounding: how a log is cut makes no difference.
        turns = self._turns - np.cumsum(np.rint(steps / _TURN_RAD))
        unwrapped = angle_rad.copy()
        unwrapped[known] += turns * _TURN_RAD
        if len(turns):
            self._turns = float(turns[-1])
            self._last_rad = float(angle_rad[known][-1])
        return unwrapped


class SpeedIntegration:
    """From speed to angle by trapezoids over the real time stamps; the first known row is at 0.

    A row without speed has no angle, and a row that is no later than one before it adds nothing.
    """

    def __init__(self) -> None:
        self._time_s = -math.inf
        self._speed_rad_s = math.nan
        self._angle_rad = 0.0

    def integrate(
        self, time_s: NDArray[np.float64], speed_rad_s: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Integrate the next rows.

        Parameters
        ----------
        time_s, speed_rad_s : numpy.ndarray
            Time, s, and speed, rad/s, shape (rows,).

        Returns
        -------
        numpy.ndarray
            Angles, rad; NaN where the speed is not known.
        """
        known = np.isfinite(speed_rad_s)
        usable = known & np.isfinite(time_s)
        latest = np.maximum.accumulate(np.append(self._time_s, np.where(usable, time_s, -np.inf)))
        usable &= time_s > latest[:-1]
        times = np.append(self._time_s, time_s[usable])
        speeds = np.append(self._speed_rad_s, speed_rad_s[usable])
        started = math.isfinite(self._time_s)
        travel = np.zeros(len(times) - 1)
        first = 0 if started else 1
        travel[first:] = (0.5 * np.diff(times[first:])) * (speeds[first:-1] + speeds[first + 1 :])
        # Added one after the other from what was there: how a log is cut makes no difference.
        angles = np.cumsum(np.append(self._angle_rad, travel))
        found = angles[np.cumsum(usable)]
        found[~known] = np.nan
        self._angle_rad = float(angles[-1])
        self._time_s, self._speed_rad_s = float(times[-1]), float(speeds[-1])
        return found


class _Zeros(Generic[Number]):
    """Zeros of one memory for all chunks, which nobody writes to."""

    def __init__(self, kind: type[Number]) -> None:
        self._kind = kind
        self._zeros = self._of(0)

    def take(self, count: int) -> NDArray[Number]:
        if count > len(self._zeros):
            self._zeros = self._of(count)
        return self._zeros[:count]

    def _of(self, count: int) -> NDArray[Number]:
        zeros = np.zeros(count, self._kind)
        zeros.setflags(write=False)
        return zeros


class SampleBuilder:
    """Makes samples of columns, chunk by chunk; how the log is cut makes no difference.

    Parameters
    ----------
    layout : Layout
        How the recording is read.
    survey : Survey
        What it holds.
    watch : GaugeWatch, optional
        Makes the torque of the gauges and watches over them.
    """

    def __init__(self, layout: Layout, survey: Survey, watch: GaugeWatch | None = None) -> None:
        self._watch = watch
        self._gain = layout.motor_turns_per_turn
        self._unwrapping = Unwrapping() if survey.angle_is_wrapped else None
        self._integration = SpeedIntegration()
        self._acceleration: CentredAcceleration | None = None
        self._torque_per_acceleration = 0.0
        if layout.load_inertia_kg_m2 is not None:
            # Who has no load inertia does not wait for the library.
            from strainwave.records.acceleration import CentredAcceleration  # noqa: PLC0415

            self._acceleration = CentredAcceleration(survey.sample_period_s, survey.rows)
            # From the motor's acceleration; an output angle is taken in its own direction.
            ratio = self._gain
            if layout.angle_side == "motor":
                assert layout.ratio is not None
                ratio = float(layout.ratio) * layout.output_direction
            self._torque_per_acceleration = layout.load_inertia_kg_m2 / ratio
        self._held: list[Rows] = []
        self._no_torque_Nm = _Zeros(np.float64)
        self._no_status = _Zeros(np.uint32)

    def take(self, columns: Columns) -> Rows:
        """Take the next rows.

        Parameters
        ----------
        columns : Columns
            The rows that follow those of the last call.

        Returns
        -------
        Rows
            What is ready: the same rows, or some rows earlier where the expected torque follows
            from an acceleration.
        """
        angle_rad = self._motor_angle(columns)
        expected_Nm = columns.expected_torque_Nm
        if expected_Nm is None:
            expected_Nm = self._no_torque_Nm.take(len(columns))
        torque_Nm, status = columns.torque_Nm, self._no_status.take(len(columns))
        if self._watch is not None:
            torque_Nm, status = self._watch.take(columns, angle_rad)
        samples = Samples(columns.time_s, angle_rad, torque_Nm, expected_Nm)
        rows = Rows(columns.log_time_s, samples, status)
        if self._acceleration is None:
            return rows
        self._held.append(rows)
        return self._release(self._acceleration.push(angle_rad))

    def finish(self) -> Rows:
        """Hand out the rows held back.

        Returns
        -------
        Rows
            The rest; often no rows.
        """
        ready = np.empty(0) if self._acceleration is None else self._acceleration.finish()
        return self._release(ready)

    def _motor_angle(self, columns: Columns) -> NDArray[np.float64]:
        if columns.angle_rad is None:
            assert columns.speed_rad_s is not None
            angle_rad = self._integration.integrate(columns.time_s, columns.speed_rad_s)
        elif self._unwrapping is not None:
            angle_rad = self._unwrapping.unwrap(columns.angle_rad)
        else:
            angle_rad = columns.angle_rad
        return angle_rad if self._gain == 1.0 else angle_rad * self._gain

    def _release(self, accelerations: NDArray[np.float64]) -> Rows:
        held = joined_rows(self._held)
        count = len(accelerations)
        self._held = [held.part(slice(count, None))]
        ready = held.part(slice(count))
        expected_Nm = accelerations * self._torque_per_acceleration
        return replace(ready, samples=replace(ready.samples, expected_torque_Nm=expected_Nm))


def joined_rows(parts: list[Rows]) -> Rows:
    """Put consecutive rows together.

    Parameters
    ----------
    parts : list of Rows
        Rows in order.

    Returns
    -------
    Rows
        All of them; the only part that has any as it is.
    """
    parts = [part for part in parts if len(part)]
    if len(parts) == 1:
        return parts[0]
    nothing = np.empty(0)
    none = Rows(nothing, Samples(nothing, nothing, nothing, nothing), np.empty(0, np.uint32))
    listed = [*parts, none]
    return Rows(
        np.concatenate([part.log_time_s for part in listed]),
        Samples(
            np.concatenate([part.samples.time_s for part in listed]),
            np.concatenate([part.samples.motor_angle_rad for part in listed]),
            np.concatenate([part.samples.torque_Nm for part in listed]),
            np.concatenate([part.samples.expected_torque_Nm for part in listed]),
        ),
        np.concatenate([part.gauge_status for part in listed]),
    )
