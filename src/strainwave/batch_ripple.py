"""The ripple filter for many channels at once, and for one long log, in vector lanes and threads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous, optional_contiguous, precision
from strainwave.batch import BatchResult, LongResult, _level, _positive, _threads
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, DTypeLike, NDArray

#: State differences are held to so many times the tolerance of the ripple.
STATE_TOLERANCE_RATIO = 100.0
#: Memories by which a chunk of a long log begins early, where no other number is asked for.
WARM_UP_MEMORIES = 16.0


@dataclass(frozen=True)
class BatchInnovations:
    """How well each sample of each channel was predicted; lists of one array a channel.

    Attributes
    ----------
    innovation_Nm : list of numpy.ndarray
        Measured torque minus what was predicted of it, Nm.
    innovation_variance_Nm2 : list of numpy.ndarray
        The variance that the filter expects of it, Nm^2; 0 where the sample was rejected.
    status : list of numpy.ndarray
        Bits of `strainwave.StatusFlag`, uint32.
    """

    innovation_Nm: list[NDArray[Any]]
    innovation_variance_Nm2: list[NDArray[Any]]
    status: list[NDArray[np.uint32]]


class RippleBatch:
    """Ripple filters side by side: a robot's joints, or a fleet's logs.

    Parameters
    ----------
    configs : sequence of RippleFilterConfig
        One for each channel; they may differ in everything. Channels whose orders depend on the
        same things share vector registers.
    learned : sequence of LearnedRipple, optional
        Coefficients to start with, for each channel; from nothing without.
    dtype : dtype_like
        float64, or float32, twice as fast.
    """

    def __init__(
        self,
        configs: Sequence[_core.RippleFilterConfig],
        *,
        learned: Sequence[_core.LearnedRipple] | None = None,
        dtype: DTypeLike = np.float64,
    ) -> None:
        self._configs = _configs(configs)
        self._dtype: type[Any] = precision(dtype)
        self._batch = _batch_type(self._dtype)(self._configs, list(learned or ()))

    @property
    def counters(self) -> list[dict[str, int]]:
        """For each channel: how many samples there were, and how often each flag was raised."""
        return [dict(each) for each in self._batch.counters]

    def reset(self) -> None:
        """Go back to the start in every channel, with the coefficients given there."""
        self._batch.reset()

    def process(
        self,
        time_s: Sequence[ArrayLike],
        motor_angle_rad: Sequence[ArrayLike],
        torque_Nm: Sequence[ArrayLike],
        *,
        expected_torque_Nm: Sequence[ArrayLike] | None = None,
        angle_referenced: bool = True,
        threads: int = 1,
        level: _core.VectorLevel | None = None,
    ) -> BatchResult:
        """Remove the ripple from every channel's samples; the states go on to the next call.

        Each channel comes out as `strainwave.RippleFilter` would make it, to rounding. Contiguous
        arrays of the batch's precision (times and angles: float64) are read where they are.

        Parameters
        ----------
        time_s : sequence of array_like
            Time stamps of each channel, s.
        motor_angle_rad : sequence of array_like
            Motor angle of each channel, rad, not wrapped; NaN where it is not known.
        torque_Nm : sequence of array_like
            Measured torque of each channel, Nm; channels may differ in length.
        expected_torque_Nm : sequence of array_like, optional
            Part of the true torque that is known, Nm.
        angle_referenced : bool
            False where the angles count from an unknown zero: frozen terms then wait.
        threads : int
            Threads that share the channels.
        level : VectorLevel, optional
            One of `strainwave.batch.available_vector_levels`; the highest one without.

        Returns
        -------
        BatchResult
            Torque, ripple and status: lists of one array a channel.

        Raises
        ------
        InputError
            If channels or samples do not agree, or a value is of the wrong kind.
        """
        rows = self._rows(time_s, motor_angle_rad, torque_Nm, expected_torque_Nm)
        given = self._batch.process(rows, bool(angle_referenced), _level(level), _threads(threads))
        torque, ripple, status = ([each[part] for each in given] for part in range(3))
        return BatchResult(torque, ripple, status)

    def innovations(
        self,
        time_s: Sequence[ArrayLike],
        motor_angle_rad: Sequence[ArrayLike],
        torque_Nm: Sequence[ArrayLike],
        *,
        expected_torque_Nm: Sequence[ArrayLike] | None = None,
        angle_referenced: bool = True,
        threads: int = 1,
        level: _core.VectorLevel | None = None,
    ) -> BatchInnovations:
        """Filter as `process` does, and tell how well each sample was predicted.

        Parameters
        ----------
        time_s, motor_angle_rad, torque_Nm, expected_torque_Nm
            As in `process`.
        angle_referenced : bool
            As in `process`.
        threads : int
            Threads that share the channels.
        level : VectorLevel, optional
            One of `strainwave.batch.available_vector_levels`; the highest one without.

        Returns
        -------
        BatchInnovations
            Innovation, its variance and status: lists of one array a channel.

        Raises
        ------
        InputError
            As `process`.
        """
        rows = self._rows(time_s, motor_angle_rad, torque_Nm, expected_torque_Nm)
        given = self._batch.innovations(
            rows, bool(angle_referenced), _level(level), _threads(threads)
        )
        found: list[list[Any]] = [[each[part] for each in given] for part in range(3)]
        return BatchInnovations(*found)

    def _rows(
        self,
        time_s: Sequence[ArrayLike],
        motor_angle_rad: Sequence[ArrayLike],
        torque_Nm: Sequence[ArrayLike],
        expected_torque_Nm: Sequence[ArrayLike] | None,
    ) -> list[tuple[Any, Any, Any, Any]]:
        columns = {"time_s": time_s, "motor_angle_rad": motor_angle_rad, "torque_Nm": torque_Nm}
        if expected_torque_Nm is not None:
            columns["expected_torque_Nm"] = expected_torque_Nm
        for name, column in columns.items():
            if len(column) != len(self._configs):
                raise InputError(
                    f"{name} has {len(column)} channels: expected {len(self._configs)}, one for "
                    "each configuration; give as many"
                )
        return [
            _row(
                time_s[index],
                motor_angle_rad[index],
                torque_Nm[index],
                None if expected_torque_Nm is None else expected_torque_Nm[index],
                self._dtype,
            )
            for index in range(len(self._configs))
        ]


class LongRippleFilter:
    """One long log through the ripple filter in time chunks; the state goes on from call to call.

    Parameters
    ----------
    config : RippleFilterConfig
        The filter's configuration.
    learned : LearnedRipple, optional
        Coefficients to start with; from nothing without.
    dtype : dtype_like
        float64, or float32, twice as fast.
    threads : int
        Threads that share the chunks.
    level : VectorLevel, optional
        One of `strainwave.batch.available_vector_levels`; the highest one without.
    in_sequence : bool
        Exactly as `strainwave.RippleFilter` does it, sample after sample.
    warm_up_memories : float
        Memories of the filter, in travelled angle, by which a chunk starts early; twelve times as
        many where orders depend on load, speed or direction.
    tolerance_Nm : float
        Difference of the ripple at a boundary, at whatever angle, beyond which the chunk after it
        is filtered again in sequence, Nm. Single coefficients may differ by a hundred times this.
    """

    def __init__(
        self,
        config: _core.RippleFilterConfig,
        *,
        learned: _core.LearnedRipple | None = None,
        dtype: DTypeLike = np.float64,
        threads: int = 1,
        level: _core.VectorLevel | None = None,
        in_sequence: bool = False,
        warm_up_memories: float = WARM_UP_MEMORIES,
        tolerance_Nm: float = 1e-4,
    ) -> None:
        self._dtype: type[Any] = precision(dtype)
        kept = [] if learned is None else [learned]
        self._batch = _batch_type(self._dtype)(_configs([config]), kept)
        tolerance = _positive("tolerance_Nm", tolerance_Nm)
        self._options = (
            _level(level),
            _threads(threads),
            in_sequence,
            _positive("warm_up_memories", warm_up_memories),
            tolerance,
            STATE_TOLERANCE_RATIO * tolerance,
        )

    def process(
        self,
        time_s: ArrayLike,
        motor_angle_rad: ArrayLike,
        torque_Nm: ArrayLike,
        *,
        expected_torque_Nm: ArrayLike | None = None,
        angle_referenced: bool = True,
    ) -> LongResult:
        """Remove the ripple from the next samples, a long piece of the log.

        Parameters
        ----------
        time_s, motor_angle_rad, torque_Nm, expected_torque_Nm
            As in `filter_ripple_long`.
        angle_referenced : bool
            False where the angle counts from an unknown zero: frozen terms then wait.

        Returns
        -------
        LongResult
            Torque, ripple, status, the differences at the boundaries within the piece, and the
            counters of all pieces so far.

        Raises
        ------
        InputError
            If an array is of another length or kind.
        """
        row = _row(time_s, motor_angle_rad, torque_Nm, expected_torque_Nm, self._dtype)
        (torque, ripple, status), report = self._batch.process_long(
            [row], bool(angle_referenced), *self._options
        )
        return LongResult(torque, ripple, status, dict(self._batch.counters[0]), report)


def filter_ripple_long(
    config: _core.RippleFilterConfig,
    time_s: ArrayLike,
    motor_angle_rad: ArrayLike,
    torque_Nm: ArrayLike,
    *,
    expected_torque_Nm: ArrayLike | None = None,
    angle_referenced: bool = True,
    dtype: DTypeLike = np.float64,
    threads: int = 1,
    level: _core.VectorLevel | None = None,
    in_sequence: bool = False,
    warm_up_memories: float = WARM_UP_MEMORIES,
    tolerance_Nm: float = 1e-4,
) -> LongResult:
    """Remove the ripple from one long log in time chunks, each warmed up on the samples before.

    Parameters
    ----------
    config : RippleFilterConfig
        The filter's configuration.
    time_s : array_like
        Time stamps as recorded, shape (samples,), s.
    motor_angle_rad : array_like
        Motor angle, shape (samples,), rad, not wrapped; NaN where it is not known.
    torque_Nm : array_like
        Measured torque, shape (samples,), Nm.
    expected_torque_Nm : array_like, optional
        Part of the true torque that is known, Nm.
    angle_referenced : bool
        False where the angle counts from an unknown zero: frozen terms then wait.
    dtype : dtype_like
        float64, or float32, twice as fast.
    threads : int
        Threads that share the chunks.
    level : VectorLevel, optional
        One of `strainwave.batch.available_vector_levels`; the highest one without.
    in_sequence : bool
        Exactly as `strainwave.RippleFilter` does it, sample after sample.
    warm_up_memories : float
        Memories of the filter, in travelled angle, by which a chunk starts early; twelve times as
        many where orders depend on load, speed or direction.
    tolerance_Nm : float
        Difference of the ripple at a boundary, at whatever angle, beyond which the chunk after it
        is filtered again in sequence, Nm. Single coefficients may differ by a hundred times this.

    Returns
    -------
    LongResult
        Torque, ripple, status, counters, and the differences at the boundaries.

    Raises
    ------
    InputError
        If an array is of another length or kind, or an option cannot be.
    """
    long_filter = LongRippleFilter(
        config,
        dtype=dtype,
        threads=threads,
        level=level,
        in_sequence=in_sequence,
        warm_up_memories=warm_up_memories,
        tolerance_Nm=tolerance_Nm,
    )
    return long_filter.process(
        time_s,
        motor_angle_rad,
        torque_Nm,
        expected_torque_Nm=expected_torque_Nm,
        angle_referenced=angle_referenced,
    )


def warm_up_turns(config: _core.RippleFilterConfig) -> float:
    """Tell by how many motor turns a chunk of a long log begins early.

    Parameters
    ----------
    config : RippleFilterConfig
        The filter's configuration.

    Returns
    -------
    float
        `WARM_UP_MEMORIES`, and more where orders depend on load, speed or direction.
    """
    has_further = pairs_of(config) > len(config.orders)
    slowness = _core.SLOWNESS_OF_FURTHER_PAIRS if has_further else 1.0
    return WARM_UP_MEMORIES * slowness * config.memory_turns


def pairs_of(config: _core.RippleFilterConfig) -> int:
    """Count the pairs of coefficients; lanes have room for `strainwave._core.MOST_LANE_PAIRS`.

    Parameters
    ----------
    config : RippleFilterConfig
        The filter's configuration.

    Returns
    -------
    int
        One for each order, and one for each thing that an order depends on.
    """
    return sum(
        1 + order.with_load + order.with_speed + order.with_direction for order in config.orders
    )


def _row(
    time_s: ArrayLike,
    motor_angle_rad: ArrayLike,
    torque_Nm: ArrayLike,
    expected_torque_Nm: ArrayLike | None,
    dtype: type[Any],
) -> tuple[Any, Any, Any, Any]:
    return (
        contiguous("time_s", time_s, np.float64),
        contiguous("motor_angle_rad", motor_angle_rad, np.float64),
        contiguous("torque_Nm", torque_Nm, dtype),
        optional_contiguous("expected_torque_Nm", expected_torque_Nm, dtype),
    )


def _batch_type(
    dtype: type[Any],
) -> type[_core.RippleBatchFloat32] | type[_core.RippleBatchFloat64]:
    return _core.RippleBatchFloat32 if dtype is np.float32 else _core.RippleBatchFloat64


def _configs(configs: object) -> list[_core.RippleFilterConfig]:
    listed: list[Any] = list(configs) if isinstance(configs, list | tuple) else [configs]
    for index, config in enumerate(listed):
        if not isinstance(config, _core.RippleFilterConfig):
            raise InputError(
                f"configs[{index}] is of type {type(config).__name__}: expected a "
                "RippleFilterConfig; give a list with one for each channel"
            )
    return listed
