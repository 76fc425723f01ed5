"""Recorded gauges through the core's chain with its watch: torque that goes on without a lost one."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave import _core
from strainwave.configuration import (
    calibration_of,
    converter_of,
    gains_of,
    gauge_monitor_of,
    gear_of,
)
from strainwave.records.mapping import is_gauge_key
from strainwave.sensor import TorqueSensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from strainwave.joint import Joint
    from strainwave.records.columns import FoundColumn
    from strainwave.records.conversion import Columns
    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey

_FLAGS: Final = _core.StatusFlag
#: What the watch says of a row; the rest of a sensor's status is said by the method that follows.
OF_GAUGES: Final = np.uint32(
    _FLAGS.gauge_saturated
    | _FLAGS.gauges_insufficient
    | _FLAGS.gauge_lost
    | _FLAGS.gauge_suspected
    | _FLAGS.gauges_disagree
)
#: Where these are set there is no torque: the sensor holds its last one.
WITHOUT_TORQUE: Final = np.uint32(_FLAGS.gauge_saturated | _FLAGS.gauges_insufficient)


@dataclass(frozen=True)
class LostGauge:
    """A gauge that was lost in a recording.

    Attributes
    ----------
    gauge : int
        Its number, from 1.
    fault : str
        "open", "shorted", "stuck", "saturated" or "inconsistent".
    row : int
        Row from which it is lost for good, from 1.
    log_time_s : float or None
        Time of that row as the recording counts it, s; None where it has none.
    left_out_from_row : int
        Row from which on the torque does without it.
    goes_on : bool
        Whether gains do without it.
    residual_before_Nm, residual_Nm : float or None
        Root mean square of the fluctuation that the gains leave, with the gauge and without it, as
        the joint file states it; None where it does not, or no gains do without.
    """

    gauge: int
    fault: str
    row: int
    log_time_s: float | None
    left_out_from_row: int
    goes_on: bool
    residual_before_Nm: float | None
    residual_Nm: float | None


@dataclass(frozen=True)
class WatchedGauges:
    """What the watch over the gauges of a recording found.

    Attributes
    ----------
    lost : LostGauge or None
        The gauge that was lost.
    rows_suspected, rows_insufficient, rows_disagree : int
        Rows in which a gauge was left out before it was lost, or for the moment; in which there is
        no torque; in which it is not one gauge alone that is wrong.
    """

    lost: LostGauge | None
    rows_suspected: int
    rows_insufficient: int
    rows_disagree: int

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name.

        Returns
        -------
        dict
            For JSON.
        """
        return asdict(self)


@dataclass
class GaugeWatch:
    """The core's chain with its watch, chunk after chunk; how a log is cut makes no difference.

    Parameters
    ----------
    joint : Joint
        A joint that `can_watch`.
    sample_period_s : float
        Time from row to row, s.
    is_referenced : bool
        Whether the motor's angle counts from where it did when the gauges were calibrated.
    """

    joint: Joint
    sample_period_s: float
    is_referenced: bool
    _rows: int = field(default=0, init=False)
    _left_out: tuple[int, int] = field(default=(0, 0), init=False)
    _lost: LostGauge | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self._counts = dict.fromkeys(_FLAGS, 0)
        self._converter = converter_of(self.joint)
        self._calibration = calibration_of(self.joint)
        monitor = gauge_monitor_of(self.joint, self.sample_period_s)
        assert monitor is not None
        self._monitor = monitor
        self._sensor = TorqueSensor(
            _core.TorqueSensorConfig(
                converter=self._converter,
                gains=gains_of(self.joint),
                calibration=self._calibration,
                # Only the measured torque is taken; the method that follows removes the ripple.
                filter=_core.RippleFilterConfig(orders=[2]),
                sample_period_s=self.sample_period_s,
                monitor=monitor,
            )
        )

    def take(
        self, columns: Columns, motor_angle_rad: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
        """Take the next rows.

        Parameters
        ----------
        columns : Columns
            The rows that follow those of the last call, with gauges.
        motor_angle_rad : numpy.ndarray
            Motor angle, shape (rows,), rad; NaN where not known.

        Returns
        -------
        tuple
            Torque, shape (rows,), Nm, NaN where there is none; and what the watch says of each row,
            bits of `strainwave.StatusFlag`.
        """
        assert columns.gauges_V is not None
        torque_Nm = np.full(len(columns), np.nan)
        status = np.zeros(len(columns), np.uint32)
        # A row in which a voltage is missing has no codes, and no torque.
        known = np.isfinite(columns.gauges_V).all(axis=1)
        if known.any():
            degrees = columns.temperature_degC
            reference = self._calibration.reference_temperature_degC
            found = self._sensor.process(
                self._codes(columns.gauges_V[known]),
                motor_angle_rad=motor_angle_rad[known],
                temperature_degC=(
                    None
                    if degrees is None
                    else np.where(np.isfinite(degrees), degrees, reference)[known]
                ),
                angle_referenced=self.is_referenced,
            )
            said = found.status & OF_GAUGES
            status[known] = said
            usable = (said & WITHOUT_TORQUE) == 0
            torque_Nm[known] = np.where(usable, found.torque_measured_Nm, np.nan)
            self._note(columns, np.flatnonzero(known), said, found.left_out_gauge)
        self._rows += len(columns)
        return torque_Nm, status

    def result(self) -> WatchedGauges:
        """Say what was found in the rows taken so far.

        Returns
        -------
        WatchedGauges
            Lost gauge and rows.
        """
        return WatchedGauges(
            self._lost,
            self._counts[_FLAGS.gauge_suspected],
            self._counts[_FLAGS.gauges_insufficient],
            self._counts[_FLAGS.gauges_disagree],
        )

    def _codes(self, gauges_V: NDArray[np.float64]) -> NDArray[np.int32]:
        columns = [self._converter.to_code(np.ascontiguousarray(each)) for each in gauges_V.T]
        return np.stack(columns, axis=1)

    def _note(
        self,
        columns: Columns,
        places: NDArray[np.intp],
        status: NDArray[np.uint32],
        left_out: NDArray[np.uint8],
    ) -> None:
        for flag in self._counts:
            self._counts[flag] += int(np.count_nonzero(status & np.uint32(flag)))
        gauge, since = self._left_out
        changes = np.flatnonzero(np.diff(left_out, prepend=np.uint8(gauge)) != 0)
        lost = np.flatnonzero(status & np.uint32(_FLAGS.gauge_lost))
        if self._lost is None and len(lost):
            first = int(lost[0])
            before = changes[changes <= first]
            if len(before):
                since = self._rows + int(places[before[-1]]) + 1
            self._lost = self._lost_gauge(columns, int(places[first]), since)
        if len(changes):
            since = self._rows + int(places[changes[-1]]) + 1
        self._left_out = (int(left_out[-1]), since)

    def _lost_gauge(self, columns: Columns, place: int, since: int) -> LostGauge:
        assert self.joint.gains is not None
        number = self._sensor.lost_gauge
        gain = abs(self._calibration.gain_Nm_per_V)
        without = [each for each in self._monitor.without if each.gauge == number]
        before_V = self.joint.gains.residual_fluctuation_V
        time_s = float(columns.log_time_s[place])
        return LostGauge(
            gauge=number,
            fault=self._sensor.gauge_fault.name,
            row=self._rows + place + 1,
            log_time_s=time_s if np.isfinite(time_s) else None,
            left_out_from_row=since or self._rows + place + 1,
            goes_on=bool(without),
            residual_before_Nm=None if before_V is None else gain * before_V,
            residual_Nm=gain * without[0].residual_fluctuation_V if without else None,
        )


def can_watch(joint: Joint) -> bool:
    """Whether a joint file has what the watch over the gauges needs.

    Parameters
    ----------
    joint : Joint
        The joint.

    Returns
    -------
    bool
        True with a converter in ``[gauges]`` and ``gauge_signals`` or ``without_gauge`` in
        ``[gains]``.
    """
    gains, gauges = joint.gains, joint.gauges
    if gains is None or gauges is None or gauges.converter_bits is None:
        return False
    return len(gains.gains) > 1 and bool(gains.without_gauge or gains.gauge_signals)


def gauge_watch_of(
    layout: Layout, survey: Survey, found: Mapping[str, FoundColumn]
) -> GaugeWatch | None:
    """Begin a watch over the gauges of a recording.

    Parameters
    ----------
    layout : Layout
        How it is read.
    survey : Survey
        What it holds.
    found : mapping
        Its columns, by key.

    Returns
    -------
    GaugeWatch or None
        None where no gauges are mapped, one is mapped with a minus (a converter has no codes for
        it), or the joint file has not what it needs.
    """
    if layout.chain is None or not can_watch(layout.chain.joint) or turned_gauges(found):
        return None
    joint = layout.chain.joint
    is_motor = layout.angle_side == "motor" and "angle" in layout.columns
    # After whole turns of the motor a wave that turns faster is somewhere else.
    is_unwrapped = survey.angle_is_wrapped and _wave_factor(joint) != 1.0
    return GaugeWatch(joint, survey.sample_period_s, is_motor and not is_unwrapped)


def turned_gauges(found: Mapping[str, FoundColumn]) -> list[str]:
    """Name the gauges that are mapped with a minus.

    Parameters
    ----------
    found : mapping
        Columns, by key.

    Returns
    -------
    list of str
        Their keys.
    """
    return [key for key, each in found.items() if is_gauge_key(key) and each.sign < 0]


def joined_status(status: NDArray[np.uint32], of_gauges: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Put together what a method and the watch say of rows.

    Parameters
    ----------
    status : numpy.ndarray
        What the method says, shape (rows,): of a row without torque that it has none.
    of_gauges : numpy.ndarray
        What the watch says, shape (rows,).

    Returns
    -------
    numpy.ndarray
        Both; where the gauges are why there is no torque, they alone say so, as in the sensor.
    """
    if not of_gauges.any():
        return status
    by_gauges = (of_gauges & WITHOUT_TORQUE) != 0
    missing = np.where(by_gauges, np.uint32(_FLAGS.torque_not_finite), np.uint32(0))
    return np.asarray((status & ~missing) | of_gauges, dtype=np.uint32)


def _wave_factor(joint: Joint) -> float:
    factor = gear_of(joint).wave_factor
    return factor.numerator / factor.denominator
