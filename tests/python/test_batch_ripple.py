"""Ripple filters in lanes against one filter at a time, and a long log against one in sequence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from strainwave import RippleFilter, RippleFilterConfig
from strainwave.batch import available_vector_levels
from strainwave.batch_ripple import LongRippleFilter, RippleBatch, filter_ripple_long
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


@pytest.mark.parametrize("level", available_vector_levels())
def test_innovations_are_those_of_one_filter(level: Any) -> None:
    log = log_of(4, 2000)
    configs = [config_of(number) for number in (0, 2, 4, 5)]
    found = RippleBatch(configs).innovations(
        *([column] * 4 for column in log), threads=2, level=level
    )
    for number, config in enumerate(configs):
        alone = RippleFilter(config).process(*log)
        np.testing.assert_allclose(found.innovation_Nm[number], alone.innovation_Nm, atol=1e-8)
        variance_Nm2 = found.innovation_variance_Nm2[number]
        np.testing.assert_allclose(variance_Nm2, alone.innovation_variance_Nm2, rtol=1e-7)
        np.testing.assert_array_equal(found.status[number], alone.status)
        # The torque that is missing was not learned from.
        assert np.count_nonzero(variance_Nm2[100:] == 0) >= 1


def test_learned_coefficients_are_started_with() -> None:
    log = log_of(1, 3000)
    before = RippleFilter(config_of(1))
    before.process(*log)
    learned = before.learned()
    expected = RippleFilter(config_of(1), learned=learned).process(*log)
    untaught = RippleFilter(config_of(1)).process(*log)
    batch = RippleBatch([config_of(1)], learned=[learned])
    for _ in range(2):
        found = batch.process(*([column] for column in log))
        np.testing.assert_allclose(found.torque_Nm[0], expected.torque_Nm, atol=1e-8)
        assert np.max(np.abs(found.torque_Nm[0][:50] - untaught.torque_Nm[:50])) > 0.1
        batch.reset()
    long_filter = LongRippleFilter(config_of(1), learned=learned)
    np.testing.assert_array_equal(long_filter.process(*log).torque_Nm, expected.torque_Nm)
    with pytest.raises(InputError, match="learned"):
        RippleBatch([config_of(1), config_of(3)], learned=[learned])
    with pytest.raises(InputError, match="orders"):
        RippleBatch([config_of(0)], learned=[learned])


def test_pieces_of_a_long_log_go_on() -> None:
    log = log_of(1, 150_000)
    expected = RippleFilter(config_of(1)).process(*log)
    exact = LongRippleFilter(config_of(1), in_sequence=True)
    chunks = LongRippleFilter(config_of(1), threads=2)
    for start in range(0, 150_000, 50_000):
        rows = slice(start, start + 50_000)
        piece = [column[rows] for column in log]
        in_sequence, in_chunks = exact.process(*piece), chunks.process(*piece)
        np.testing.assert_array_equal(in_sequence.torque_Nm, expected.torque_Nm[rows])
        difference_Nm = in_chunks.torque_Nm - expected.torque_Nm[rows]
        assert 0.0 < np.sqrt(np.mean(difference_Nm**2)) < 1e-4
        assert in_chunks.report.chunk_count > 1
        assert in_chunks.counters["samples"] == in_sequence.counters["samples"] == rows.stop


def test_wrong_channels_are_refused() -> None:
    time, angle, torque = log_of(0, 100)
    batch = RippleBatch([config_of(0), config_of(1)])
    with pytest.raises(InputError, match="expected 2, one for each configuration"):
        batch.process([time], [angle], [torque])
    with pytest.raises(InputError, match="motor_angle_rad has"):
        batch.process([time, time], [angle, angle[:-1]], [torque, torque])
    with pytest.raises(InputError, match="RippleFilterConfig"):
        RippleBatch([None])  # type: ignore[list-item]
