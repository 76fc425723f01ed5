"""From recorded columns to base units; time counts from the first stamp, exactly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave.records.mapping import gauge_key, is_gauge_key, quantity_of
from strainwave.units import conversion

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from strainwave.records.columns import FoundColumn
    from strainwave.records.layout import Layout
    from strainwave.records.raw import RawChunk, Stamps

LARGEST_USABLE: Final = 1e15
"""A value beyond this counts as missing, as in the core."""
_LARGEST_DIFFERENCE: Final = 2.0**62


@dataclass(frozen=True)
class Columns:
    """Consecutive rows in base units, otherwise as recorded.

    Attributes
    ----------
    first_row : int
        Number of the first of these rows, from 1.
    log_time_s : numpy.ndarray
        Time as the recording counts it, shape (rows,), s.
    time_s : numpy.ndarray
        Time since the recording's first stamp, shape (rows,), s.
    angle_rad : numpy.ndarray or None
        Angle of the measured side, shape (rows,), rad.
    speed_rad_s : numpy.ndarray or None
        Speed of the measured side, shape (rows,), rad/s; there where the angle is not.
    torque_Nm : numpy.ndarray
        Torque, shape (rows,), Nm.
    expected_torque_Nm : numpy.ndarray or None
        Expected torque, shape (rows,), Nm.
    gauges_V : numpy.ndarray or None
        Voltage of every gauge, shape (rows, gauges), V; where it is there, the torque is made of
        it.
    temperature_degC : numpy.ndarray or None
        Temperature of the flexspline, shape (rows,), degC.
    """

    first_row: int
    log_time_s: NDArray[np.float64]
    time_s: NDArray[np.float64]
    angle_rad: NDArray[np.float64] | None
    speed_rad_s: NDArray[np.float64] | None
    torque_Nm: NDArray[np.float64]
    expected_torque_Nm: NDArray[np.float64] | None
    gauges_V: NDArray[np.float64] | None = None
    temperature_degC: NDArray[np.float64] | None = None

    def __len__(self) -> int:
        return len(self.torque_Nm)


class Converter:
    """Converts chunk after chunk.

    Parameters
    ----------
    layout : Layout
        How the recording is read.
    found : mapping
        Its columns, by key.
    """

    def __init__(self, layout: Layout, found: Mapping[str, FoundColumn]) -> None:
        self._layout = layout
        self._found = found
        self._rows = 0
        self._origin: np.int64 | np.float64 | None = None

    def convert(self, chunk: RawChunk) -> Columns:
        """Convert the next rows.

        Parameters
        ----------
        chunk : RawChunk
            The rows that follow those of the last call.

        Returns
        -------
        Columns
            The same rows.
        """
        first_row = self._rows + 1
        if chunk.time is not None:
            log_time_s, time_s = self._times(chunk.time)
        else:
            assert self._layout.rate_Hz is not None
            rows = np.arange(self._rows, self._rows + chunk.rows, dtype=np.float64)
            log_time_s = time_s = rows / self._layout.rate_Hz
        self._rows += chunk.rows
        signals = {key: self._signal(key, values) for key, values in chunk.values.items()}
        gauges_V = self._gauges(signals)
        return Columns(
            first_row,
            log_time_s,
            time_s,
            signals.get("angle"),
            signals.get("speed"),
            signals["torque"] if gauges_V is None else self._torque(gauges_V, signals),
            signals.get("expected-torque"),
            gauges_V,
            signals.get("temperature"),
        )

    def _gauges(self, signals: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64] | None:
        count = sum(is_gauge_key(key) for key in signals)
        if self._layout.chain is None or count == 0:
            return None
        return np.column_stack([signals[gauge_key(number)] for number in range(1, count + 1)])

    def _torque(
        self, gauges_V: NDArray[np.float64], signals: Mapping[str, NDArray[np.float64]]
    ) -> NDArray[np.float64]:
        assert self._layout.chain is not None
        return self._layout.chain.torque_Nm(gauges_V, signals.get("temperature"))

    def _signal(self, key: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
        unit = conversion(quantity_of(key), self._layout.columns[key].unit)
        sign = self._found[key].sign
        if unit is None:
            # Converter codes, which only gauges have.
            assert self._layout.chain is not None
            converted = sign * self._layout.chain.volts(values)
        else:
            factor = sign * unit.factor
            scaled = values if factor == 1.0 else values * factor
            converted = scaled + unit.offset if unit.offset else scaled
        if _within(converted, LARGEST_USABLE):
            return converted
        # What the core would reject is not there: nothing that follows has to think of overflow.
        return np.where(np.abs(converted) <= LARGEST_USABLE, converted, np.nan)

    def _times(self, stamps: Stamps) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        unit = conversion("time", stamps.unit or self._layout.columns["time"].unit)
        assert unit is not None
        sign = self._found["time"].sign
        # Divided, because 3 ms / 1000 is 0.003 and 3 ms * 0.001 is not.
        per_second = sign * float(round(1.0 / unit.factor))
        log_time_s = _divided(stamps.values, per_second)
        # The second limit is that of differences of whole numbers.
        largest = min(LARGEST_USABLE, 0.5 * _LARGEST_DIFFERENCE / abs(per_second))
        if self._origin is not None and _within(log_time_s, largest) and not stamps.missing.any():
            return log_time_s, _divided(stamps.values - self._origin, per_second)
        usable = (np.abs(log_time_s) <= LARGEST_USABLE) & (
            np.abs(log_time_s * per_second) < _LARGEST_DIFFERENCE
        )
        usable &= ~stamps.missing
        if self._origin is None and usable.any():
            self._origin = stamps.values[int(np.argmax(usable))]
        origin = self._origin if self._origin is not None else np.int64(0)
        # What is missing is replaced first, so that no difference overflows.
        known = np.where(usable, stamps.values, origin) - origin
        return np.where(usable, log_time_s, np.nan), np.where(usable, known / per_second, np.nan)


def _divided(values: NDArray[Any], divisor: float) -> NDArray[np.float64]:
    found = np.asarray(values, dtype=np.float64)
    return found if divisor == 1.0 else found / divisor


def _within(values: NDArray[np.float64], largest: float) -> bool:
    """Whether all values lie within a limit; what is not a number does not."""
    return len(values) == 0 or bool(values.max() <= largest and values.min() >= -largest)
