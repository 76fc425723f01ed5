"""The core's two filters behind one interface: alone, side by side, and in time chunks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

import strainwave
from benchmarks.accuracy.methods.ours import OURS, config_of
from benchmarks.accuracy.methods.published import PUBLISHED_TUNED, tuned_config
from benchmarks.accuracy.methods.speed import difference_speed_rad_s
from strainwave.batch import OscillatorBatch, filter_long
from strainwave.batch_ripple import RippleBatch, filter_ripple_long

if TYPE_CHECKING:
    from numpy.typing import DTypeLike, NDArray

    from benchmarks.accuracy.methods.interface import Log, Setting


@dataclass(frozen=True)
class Outcome:
    """What a filter makes of a log.

    Attributes
    ----------
    torque_Nm : numpy.ndarray
        Torque without ripple, shape (samples,), Nm.
    status : numpy.ndarray
        Bits of `strainwave.StatusFlag`, shape (samples,).
    """

    torque_Nm: NDArray[Any]
    status: NDArray[np.uint32]


@dataclass(frozen=True)
class PathFilter:
    """A filter that the core has alone, side by side and in chunks.

    Attributes
    ----------
    config : callable
        Configures it: (setting, **tuning) -> configuration.
    alone : callable
        Sample after sample: (configuration, log, dtype) -> outcome.
    side_by_side : callable
        Channels in lanes: (configurations, logs, dtype, threads=, level=) -> outcomes.
    in_chunks : callable
        One log in time chunks: (configuration, log, dtype, threads=) -> outcome and report.
    """

    config: Callable[..., Any]
    alone: Callable[..., Outcome]
    side_by_side: Callable[..., list[Outcome]]
    in_chunks: Callable[..., tuple[Outcome, Any]]


def _outcomes(result: Any) -> list[Outcome]:
    return [Outcome(*each) for each in zip(result.torque_Nm, result.status, strict=True)]


def _ripple_alone(config: Any, log: Log, dtype: DTypeLike) -> Outcome:
    found = strainwave.RippleFilter(config, dtype=dtype).process(
        log.time_s, log.wave_angle_rad, log.torque_Nm.astype(dtype)
    )
    return Outcome(found.torque_Nm, found.status)


def _ripples(
    configs: Sequence[Any], logs: Sequence[Log], dtype: DTypeLike, **options: Any
) -> list[Outcome]:
    found = RippleBatch(configs, dtype=dtype).process(
        [log.time_s for log in logs],
        [log.wave_angle_rad for log in logs],
        [log.torque_Nm.astype(dtype) for log in logs],
        **options,
    )
    return _outcomes(found)


def _ripple_in_chunks(
    config: Any, log: Log, dtype: DTypeLike, **options: Any
) -> tuple[Outcome, Any]:
    found = filter_ripple_long(
        config,
        log.time_s,
        log.wave_angle_rad,
        log.torque_Nm.astype(dtype),
        dtype=dtype,
        **options,
    )
    assert found.status is not None
    return Outcome(found.torque_Nm, found.status), found.report


def _published_alone(config: Any, log: Log, dtype: DTypeLike) -> Outcome:
    found = strainwave.OscillatorFilter(config, dtype=dtype).process(
        log.torque_Nm.astype(dtype), motor_speed_rad_s=_speed(log, dtype)
    )
    return Outcome(found.torque_Nm, found.status)


def _publisheds(
    configs: Sequence[Any], logs: Sequence[Log], dtype: DTypeLike, **options: Any
) -> list[Outcome]:
    found = OscillatorBatch(configs, dtype=dtype).process(
        [log.torque_Nm.astype(dtype) for log in logs],
        motor_speed_rad_s=[_speed(log, dtype) for log in logs],
        status=True,
        **options,
    )
    return _outcomes(found)


def _published_in_chunks(
    config: Any, log: Log, dtype: DTypeLike, **options: Any
) -> tuple[Outcome, Any]:
    found = filter_long(
        config,
        log.torque_Nm.astype(dtype),
        motor_speed_rad_s=_speed(log, dtype),
        dtype=dtype,
        status=True,
        **options,
    )
    assert found.status is not None
    return Outcome(found.torque_Nm, found.status), found.report


def _speed(log: Log, dtype: DTypeLike) -> NDArray[Any]:
    return difference_speed_rad_s(log).astype(dtype)


#: By the names of the methods that they are.
PATH_FILTERS: Final[Mapping[str, PathFilter]] = {
    OURS.name: PathFilter(config_of, _ripple_alone, _ripples, _ripple_in_chunks),
    PUBLISHED_TUNED.name: PathFilter(
        tuned_config, _published_alone, _publisheds, _published_in_chunks
    ),
}


def configure(name: str, setting: Setting, tuning: Mapping[str, Any]) -> Any:
    """Configure a filter of `PATH_FILTERS`.

    Parameters
    ----------
    name : str
        The method.
    setting : Setting
        What is known of the joint.
    tuning : mapping
        The method's tuning.

    Returns
    -------
    OscillatorFilterConfig or RippleFilterConfig
        The configuration.
    """
    return PATH_FILTERS[name].config(setting, **tuning)
