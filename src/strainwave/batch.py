"""Many channels at once, and one long log: the published filter in vector lanes and threads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous, precision
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, DTypeLike, NDArray

#: What a channel's samples are in: one array a channel, or the rows of one array.
Rows = Any


@dataclass(frozen=True)
class BatchResult:
    """What the filters make of their channels.

    Each is an array of shape (channels, samples) where the torque was given as one, and else a
    list of one array a channel.

    Attributes
    ----------
    torque_Nm : numpy.ndarray or list of numpy.ndarray
        Measured torque minus predicted ripple, Nm. A rejected sample holds the last good value.
    ripple_Nm : numpy.ndarray or list of numpy.ndarray or None
        Ripple as predicted from the samples before, Nm; None where not asked for.
    status : numpy.ndarray or list of numpy.ndarray or None
        Bits of `strainwave.StatusFlag`, uint32; None where not asked for.
    """

    torque_Nm: Rows
    ripple_Nm: Rows | None
    status: Rows | None


@dataclass(frozen=True)
class LongResult:
    """What the filter makes of a long log, and how far it is from filtering in sequence.

    Attributes
    ----------
    torque_Nm : numpy.ndarray
        Measured torque minus predicted ripple, shape (samples,), Nm.
    ripple_Nm : numpy.ndarray or None
        Ripple as predicted from the samples before, Nm; None where not asked for.
    status : numpy.ndarray or None
        Bits of `strainwave.StatusFlag`, uint32; None where not asked for.
    counters : dict of str to int
        How many samples there were, and how often each status flag was raised.
    report : LongReport
        Chunks, and the differences at their boundaries.
    """

    torque_Nm: NDArray[Any]
    ripple_Nm: NDArray[Any] | None
    status: NDArray[np.uint32] | None
    counters: dict[str, int]
    report: _core.LongReport


def available_vector_levels() -> list[_core.VectorLevel]:
    """List the vector levels of this processor.

    Returns
    -------
    list of VectorLevel
        From ``one_by_one`` to the highest one.
    """
    return [level for level in _core.VectorLevel if _core.is_available(level)]


class OscillatorBatch:
    """Published filters side by side: a robot's joints, or a fleet's logs.

    Parameters
    ----------
    configs : sequence of OscillatorFilterConfig
        One for each channel; they may differ in everything, and must turn by speed.
    dtype : dtype_like
        float64, or float32, twice as fast.
    """

    def __init__(
        self,
        configs: Sequence[_core.OscillatorFilterConfig],
        *,
        dtype: DTypeLike = np.float64,
    ) -> None:
        self._configs = _configs(configs)
        self._dtype: type[Any] = precision(dtype)
        self._batch = _batch_type(self._dtype)(self._configs)

    @property
    def counters(self) -> list[dict[str, int]]:
        """For each channel: how many samples there were, and how often each flag was raised."""
        return [dict(each) for each in self._batch.counters]

    def reset(self) -> None:
        """Go back to x(0) and P(0) in every channel."""
        self._batch.reset()

    def process(
        self,
        torque_Nm: Rows,
        *,
        motor_speed_rad_s: Rows,
        expected_torque_Nm: Rows | None = None,
        ripple: bool = False,
        status: bool = False,
        threads: int = 1,
        level: _core.VectorLevel | None = None,
    ) -> BatchResult:
        """Remove the ripple from every channel's samples; the states go on to the next call.

        Each channel comes out as `strainwave.OscillatorFilter` would make it, to rounding. Rows
        that are contiguous and of the batch's precision are read where they are.

        Parameters
        ----------
        torque_Nm : array_like of shape (channels, samples) or sequence of array_like
            Measured torque, Nm; channels of different lengths as a sequence of arrays.
        motor_speed_rad_s : array_like or sequence of array_like
            Motor speed in the same form, rad/s.
        expected_torque_Nm : array_like or sequence of array_like, optional
            T_exp of section V in the same form, Nm; 0 without.
        ripple : bool
            Whether to return the predicted ripple.
        status : bool
            Whether to return each sample's status; `counters` have the sums in any case.
        threads : int
            Threads that share the channels.
        level : VectorLevel, optional
            One of `available_vector_levels`; the highest one without.

        Returns
        -------
        BatchResult
            Torque, and ripple and status if asked for.

        Raises
        ------
        InputError
            If channels or samples do not agree, or a value is of the wrong kind.
        """
        channels = len(self._configs)
        torque = _rows("torque_Nm", torque_Nm, self._dtype, channels)
        lengths = [len(row) for row in torque]
        speed = _rows("motor_speed_rad_s", motor_speed_rad_s, self._dtype, channels, lengths)
        expected = (
            None
            if expected_torque_Nm is None
            else _rows("expected_torque_Nm", expected_torque_Nm, self._dtype, channels, lengths)
        )
        as_array = isinstance(torque_Nm, np.ndarray)
        clean = _new_rows(lengths, self._dtype, as_array)
        predicted = _new_rows(lengths, self._dtype, as_array) if ripple else None
        flags = _new_rows(lengths, np.uint32, as_array) if status else None
        self._batch.process(
            torque,
            speed,
            expected,
            list(clean),
            None if predicted is None else list(predicted),
            None if flags is None else list(flags),
            _level(level),
            _threads(threads),
        )
        return BatchResult(clean, predicted, flags)


class LongOscillatorFilter:
    """One long log through the published filter in time chunks; the state goes on from call to call.

    Parameters
    ----------
    config : OscillatorFilterConfig
        The filter's configuration; it must turn by speed.
    dtype : dtype_like
        float64, or float32, twice as fast.
    threads : int
        Threads that share the chunks.
    level : VectorLevel, optional
        One of `available_vector_levels`; the highest one without.
    in_sequence : bool
        Exactly as `strainwave.OscillatorFilter` does it, sample after sample.
    warm_up_memories : float
        Memories of the filter by which a chunk starts early, by time and by travelled angle.
    tolerance_Nm : float
        Difference at a boundary beyond which the chunk after it is filtered again in sequence, Nm.
    """

    def __init__(
        self,
        config: _core.OscillatorFilterConfig,
        *,
        dtype: DTypeLike = np.float64,
        threads: int = 1,
        level: _core.VectorLevel | None = None,
        in_sequence: bool = False,
        warm_up_memories: float = 16.0,
        tolerance_Nm: float = 1e-4,
    ) -> None:
        self._dtype: type[Any] = precision(dtype)
        self._batch = _batch_type(self._dtype)(_configs([config]))
        self._options = (
            _level(level),
            _threads(threads),
            in_sequence,
            _positive("warm_up_memories", warm_up_memories),
            _positive("tolerance_Nm", tolerance_Nm),
        )

    def process(
        self,
        torque_Nm: ArrayLike,
        *,
        motor_speed_rad_s: ArrayLike,
        expected_torque_Nm: ArrayLike | None = None,
        ripple: bool = False,
        status: bool = False,
    ) -> LongResult:
        """Remove the ripple from the next samples, a long piece of the log.

        Parameters
        ----------
        torque_Nm, motor_speed_rad_s, expected_torque_Nm
            As in `filter_long`.
        ripple : bool
            Whether to return the predicted ripple.
        status : bool
            Whether to return each sample's status.

        Returns
        -------
        LongResult
            Torque, ripple and status if asked for, the differences at the boundaries within the
            piece, and the counters of all pieces so far.

        Raises
        ------
        InputError
            If an array is missing or of another length or kind.
        """
        real = self._dtype
        torque = contiguous("torque_Nm", torque_Nm, real)
        sizes = [len(torque)]
        (speed,) = _rows("motor_speed_rad_s", [motor_speed_rad_s], real, 1, sizes)
        expected = None
        if expected_torque_Nm is not None:
            (expected,) = _rows("expected_torque_Nm", [expected_torque_Nm], real, 1, sizes)
        clean = np.empty(len(torque), dtype=real)
        predicted = np.empty(len(torque), dtype=real) if ripple else None
        flags = np.empty(len(torque), dtype=np.uint32) if status else None
        report = self._batch.process_long(
            torque, speed, expected, clean, predicted, flags, *self._options
        )
        return LongResult(clean, predicted, flags, dict(self._batch.counters[0]), report)


def filter_long(
    config: _core.OscillatorFilterConfig,
    torque_Nm: ArrayLike,
    *,
    motor_speed_rad_s: ArrayLike,
    expected_torque_Nm: ArrayLike | None = None,
    dtype: DTypeLike = np.float64,
    ripple: bool = False,
    status: bool = False,
    threads: int = 1,
    level: _core.VectorLevel | None = None,
    in_sequence: bool = False,
    warm_up_memories: float = 16.0,
    tolerance_Nm: float = 1e-4,
) -> LongResult:
    """Remove the ripple from one long log in time chunks, each warmed up on the samples before.

    Parameters
    ----------
    config : OscillatorFilterConfig
        The filter's configuration; it must turn by speed.
    torque_Nm : array_like
        Measured torque, shape (samples,), Nm.
    motor_speed_rad_s : array_like
        Motor speed, rad/s.
    expected_torque_Nm : array_like, optional
        T_exp of section V, Nm; 0 without.
    dtype : dtype_like
        float64, or float32, twice as fast.
    ripple : bool
        Whether to return the predicted ripple.
    status : bool
        Whether to return each sample's status.
    threads : int
        Threads that share the chunks.
    level : VectorLevel, optional
        One of `available_vector_levels`; the highest one without.
    in_sequence : bool
        Exactly as `strainwave.OscillatorFilter` does it, sample after sample.
    warm_up_memories : float
        Memories of the filter by which a chunk starts early, by time and by travelled angle.
    tolerance_Nm : float
        Difference at a boundary beyond which the chunk after it is filtered again in sequence, Nm.

    Returns
    -------
    LongResult
        Torque, ripple and status if asked for, counters, and the differences at the boundaries.

    Raises
    ------
    InputError
        If an array is missing or of another length or kind, or an option cannot be.
    """
    long_filter = LongOscillatorFilter(
        config,
        dtype=dtype,
        threads=threads,
        level=level,
        in_sequence=in_sequence,
        warm_up_memories=warm_up_memories,
        tolerance_Nm=tolerance_Nm,
    )
    return long_filter.process(
        torque_Nm,
        motor_speed_rad_s=motor_speed_rad_s,
        expected_torque_Nm=expected_torque_Nm,
        ripple=ripple,
        status=status,
    )


def _batch_type(
    dtype: type[Any],
) -> type[_core.OscillatorBatchFloat32] | type[_core.OscillatorBatchFloat64]:
    return _core.OscillatorBatchFloat32 if dtype is np.float32 else _core.OscillatorBatchFloat64


def _configs(configs: object) -> list[_core.OscillatorFilterConfig]:
    listed: list[Any] = list(configs) if isinstance(configs, list | tuple) else [configs]
    for index, config in enumerate(listed):
        if not isinstance(config, _core.OscillatorFilterConfig):
            raise InputError(
                f"configs[{index}] is of type {type(config).__name__}: expected an "
                "OscillatorFilterConfig; give a list with one for each channel"
            )
    return listed


def _rows(
    name: str, rows: Rows, dtype: type[Any], channels: int, lengths: list[int] | None = None
) -> list[NDArray[Any]]:
    """One contiguous array a channel; a row of the caller's own array where it has that form."""
    if isinstance(rows, np.ndarray) and rows.ndim != 2:
        raise InputError(
            f"{name} has the shape {rows.shape}: expected (channels, samples); reshape the array"
        )
    if not isinstance(rows, np.ndarray | list | tuple):
        raise InputError(
            f"{name} is of type {type(rows).__name__}: expected an array of shape (channels, "
            "samples) or a list of arrays; give one"
        )
    if len(rows) != channels:
        raise InputError(
            f"{name} has {len(rows)} channels: expected {channels}, one for each configuration; "
            "give as many"
        )
    arrays = [contiguous(f"{name}[{index}]", row, dtype) for index, row in enumerate(rows)]
    for index, array in enumerate(arrays):
        if lengths is not None and len(array) != lengths[index]:
            raise InputError(
                f"{name}[{index}] has {len(array)} samples: expected {lengths[index]} as in "
                f"torque_Nm[{index}]; give arrays of one length"
            )
    return arrays


def _new_rows(lengths: list[int], dtype: type[Any], as_array: bool) -> Rows:
    if as_array:
        return np.empty((len(lengths), lengths[0] if lengths else 0), dtype=dtype)
    return [np.empty(length, dtype=dtype) for length in lengths]


def _level(level: object) -> _core.VectorLevel:
    if level is None:
        return _core.best_vector_level()
    if not isinstance(level, _core.VectorLevel) or not _core.is_available(level):
        raise InputError(
            f"level = {level!r}: this processor does not have it; leave it out, or take one of "
            "available_vector_levels()"
        )
    return level


def _threads(threads: object) -> int:
    if isinstance(threads, bool) or not isinstance(threads, int) or not 1 <= threads <= 1024:
        raise InputError(
            f"threads = {threads!r}: expected a whole number from 1 to 1024; correct this value"
        )
    return threads


def _positive(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value < np.inf:
        raise InputError(
            f"{name} = {value!r}: expected a finite number above 0; correct this value"
        )
    return float(value)
