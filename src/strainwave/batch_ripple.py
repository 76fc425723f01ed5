"""The ripple filter for many channels at once, and for one long log, in vector lanes and threads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous, optional_contiguous, precision
from strainwave.batch import BatchResult, LongResult, _level, _positive, _threads
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, DTypeLike

#: State differences are held to so many times the tolerance of the ripple.
STATE_TOLERANCE_RATIO = 100.0


class RippleBatch:
    """Ripple filters side by side: a robot's joints, or a fleet's logs.

    Parameters
    ----------
    configs : sequence of RippleFilterConfig
        One for each channel; they may differ in everything. Channels whose orders depend on the
        same things share vector registers.
    dtype : dtype_like
        float64, or float32, twice as fast.
    """

    def __init__(
        self,
        configs: Sequence[_core.RippleFilterConfig],
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
        """Go back to the start in every channel."""
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
        columns = {"time_s": time_s, "motor_angle_rad": motor_angle_rad, "torque_Nm": torque_Nm}
        if expected_torque_Nm is not None:
            columns["expected_torque_Nm"] = expected_torque_Nm
        for name, column in columns.items():
            if len(column) != len(self._configs):
                raise InputError(
                    f"{name} has {len(column)} channels: expected {len(self._configs)}, one for "
                    "each configuration; give as many"
                )
        rows = [
            _row(
                time_s[index],
                motor_angle_rad[index],
                torque_Nm[index],
                None if expected_torque_Nm is None else expected_torque_Nm[index],
                self._dtype,
            )
            for index in range(len(self._configs))
        ]
        given = self._batch.process(rows, bool(angle_referenced), _level(level), _threads(threads))
        torque, ripple, status = ([each[part] for each in given] for part in range(3))
        return BatchResult(torque, ripple, status)


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
    warm_up_memories: float = 16.0,
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
    real: type[Any] = precision(dtype)
    batch = _batch_type(real)(_configs([config]))
    tolerance = _positive("tolerance_Nm", tolerance_Nm)
    (torque, ripple, status), report = batch.process_long(
        [_row(time_s, motor_angle_rad, torque_Nm, expected_torque_Nm, real)],
        bool(angle_referenced),
        _level(level),
        _threads(threads),
        in_sequence,
        _positive("warm_up_memories", warm_up_memories),
        tolerance,
        STATE_TOLERANCE_RATIO * tolerance,
    )
    return LongResult(torque, ripple, status, dict(batch.counters[0]), report)


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
