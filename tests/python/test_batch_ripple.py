"""Ripple filters in lanes against one filter at a time, and a long log against one in sequence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from strainwave import RippleFilter, RippleFilterConfig
from strainwave.batch import available_vector_levels
from strainwave.batch_ripple import RippleBatch, filter_ripple_long
from strainwave.errors import InputError


def config_of(number: int) -> Any:
    """Make a joint that no other number has."""
    return RippleFilterConfig(
        orders=[2, 4, 6] if number % 2 else [2, 4], memory_turns=4.0 + number, torque_noise_Nm=0.04
    )


def log_of(number: int, samples: int) -> tuple[Any, Any, Any]:
    """Make a joint's log: turns both ways, a load, noise, a gap and a missing angle."""
    random = np.random.default_rng(number)
    time = 1e-3 * np.arange(samples)
    time[samples // 2 :] += 0.2
    angle = np.cumsum(1e-3 * (60 + 100 * np.sin(1.3 * time + number)))
    load = 8 * np.sin(2.1 * time + number)
    ripple = 1.5 * np.cos(2 * angle + 0.3) + 0.5 * np.sin(4 * angle)
    torque = load + ripple + 0.04 * random.standard_normal(samples)
    angle[samples // 3] = np.nan
    torque[samples // 4] = np.nan
    return time, angle, torque


@pytest.mark.parametrize("level", available_vector_levels())
def test_each_channel_is_as_one_filter_makes_it(level: Any) -> None:
    configs = [config_of(number) for number in range(21)]
    logs = [log_of(number, 900 + 31 * number) for number in range(21)]
    batch = RippleBatch(configs)
    result = batch.process(
        [log[0] for log in logs],
        [log[1] for log in logs],
        [log[2] for log in logs],
        threads=2,
        level=level,
    )
    for number, (config, log) in enumerate(zip(configs, logs, strict=True)):
        alone = RippleFilter(config)
        expected = alone.process(*log)
        np.testing.assert_allclose(result.torque_Nm[number], expected.torque_Nm, atol=1e-8)
        np.testing.assert_array_equal(result.status[number], expected.status)
        assert batch.counters[number] == alone.counters


def test_chunks_of_a_recording_give_the_same() -> None:
    time, angle, torque = log_of(3, 1000)
    whole = RippleBatch([config_of(3)]).process([time], [angle], [torque])
    batch = RippleBatch([config_of(3)])
    parts = [
        batch.process([time[a:b]], [angle[a:b]], [torque[a:b]]) for a, b in ((0, 333), (333, 1000))
    ]
    joined = np.concatenate([part.torque_Nm[0] for part in parts])
    np.testing.assert_allclose(joined, whole.torque_Nm[0], atol=1e-8)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_long_log_is_as_in_sequence(dtype: Any) -> None:
    log = log_of(1, 150_000)
    sequence = filter_ripple_long(config_of(1), *log, dtype=dtype, in_sequence=True)
    chunks = filter_ripple_long(config_of(1), *log, dtype=dtype, threads=2)
    difference = chunks.torque_Nm - sequence.torque_Nm
    assert sequence.report.chunk_count == 1
    assert chunks.report.chunk_count > 4
    assert chunks.report.largest_ripple_difference_Nm < 1e-4
    assert np.sqrt(np.mean(difference**2)) < 1e-4
    # Something was computed otherwise: the chunks are no copy of the sequence.
    assert np.any(difference != 0)


def test_a_short_warm_up_is_found_out_and_repeated() -> None:
    log = log_of(2, 100_000)
    sequence = filter_ripple_long(config_of(2), *log, in_sequence=True)
    chunks = filter_ripple_long(config_of(2), *log, warm_up_memories=0.2)
    assert chunks.report.repeated_chunks > 0
    np.testing.assert_allclose(chunks.torque_Nm, sequence.torque_Nm, atol=1e-3)


def test_wrong_channels_are_refused() -> None:
    time, angle, torque = log_of(0, 100)
    batch = RippleBatch([config_of(0), config_of(1)])
    with pytest.raises(InputError, match="expected 2, one for each configuration"):
        batch.process([time], [angle], [torque])
    with pytest.raises(InputError, match="motor_angle_rad has"):
        batch.process([time, time], [angle, angle[:-1]], [torque, torque])
    with pytest.raises(InputError, match="RippleFilterConfig"):
        RippleBatch([None])  # type: ignore[list-item]
