"""Channels side by side and long logs in chunks, against one filter at a time."""

import threading
import time
from fractions import Fraction

import numpy as np
import pytest

from strainwave import InputError, OscillatorFilter, OscillatorFilterConfig, oscillator_preset
from strainwave._core import VectorLevel
from strainwave.batch import (
    LongOscillatorFilter,
    OscillatorBatch,
    available_vector_levels,
    filter_long,
)

PRECISIONS = [(np.float64, 1e-9), (np.float32, 1e-3)]


def joints(count):
    """Configurations of joints that differ in their orders, ratios and tuning."""
    kinds = [
        lambda i: oscillator_preset("taghirad1999", 100 + i),
        lambda i: OscillatorFilterConfig(orders=[2, 4, Fraction(2, 161 + 2 * i)]),
        lambda i: OscillatorFilterConfig(orders=[2, 7], process_noise_variance_Nm2=1e-4),
        lambda i: OscillatorFilterConfig(orders=[2, 4, 6, 8, 1, 3, Fraction(1, 50)]),
    ]
    return [kinds[i % len(kinds)](i) for i in range(count)]


def recording(seed, samples, dtype):
    """Torque and speed of a joint that reverses, with samples that have to be refused."""
    rng = np.random.default_rng(seed)
    speed = 30.0 + 100.0 * np.sin(0.002 * np.arange(samples) + seed)
    angle = np.cumsum(speed) * 1e-3
    torque = 3.0 * np.cos(2 * angle) + np.sin(4 * angle) + 0.1 * rng.standard_normal(samples)
    torque[rng.integers(0, samples, 5)] = np.nan
    speed[rng.integers(0, samples, 3)] = np.inf
    return torque.astype(dtype), speed.astype(dtype)


def alone(config, torque, speed, dtype):
    one = OscillatorFilter(config, dtype=dtype)
    return one.process(torque, motor_speed_rad_s=speed), one.counters


@pytest.mark.parametrize(("dtype", "tolerance_Nm"), PRECISIONS)
@pytest.mark.parametrize("level", available_vector_levels(), ids=lambda level: level.name)
def test_channels_come_out_as_alone(dtype, tolerance_Nm, level):
    configs = joints(21)
    logs = [recording(i, 900 + 31 * (i % 5), dtype) for i in range(21)]
    batch = OscillatorBatch(configs, dtype=dtype)
    result = batch.process(
        [torque for torque, _ in logs],
        motor_speed_rad_s=[speed for _, speed in logs],
        ripple=True,
        status=True,
        threads=2,
        level=level,
    )
    for i, (torque, speed) in enumerate(logs):
        expected, counters = alone(configs[i], torque, speed, dtype)
        np.testing.assert_allclose(result.torque_Nm[i], expected.torque_Nm, atol=tolerance_Nm)
        np.testing.assert_allclose(result.ripple_Nm[i], expected.ripple_Nm, atol=tolerance_Nm)
        np.testing.assert_array_equal(result.status[i], expected.status)
        assert batch.counters[i] == counters
        assert result.torque_Nm[i].dtype == dtype


def test_one_array_in_one_array_out_and_chunks_go_on():
    configs = joints(6)
    logs = [recording(i, 640, np.float64) for i in range(6)]
    torque = np.array([each[0] for each in logs])
    speed = np.array([each[1] for each in logs])
    batch = OscillatorBatch(configs)
    whole = batch.process(torque, motor_speed_rad_s=speed)
    assert whole.torque_Nm.shape == (6, 640)
    assert whole.ripple_Nm is None
    assert whole.status is None
    batch.reset()
    parts = [
        batch.process(torque[:, part], motor_speed_rad_s=speed[:, part]).torque_Nm
        for part in (slice(0, 128), slice(128, 301), slice(301, 640))
    ]
    np.testing.assert_allclose(np.hstack(parts), whole.torque_Nm, atol=1e-9)
    assert [each["samples"] for each in batch.counters] == [640] * 6


def test_expected_torque_is_taken_off():
    config = OscillatorFilterConfig(orders=[2, 4])
    torque, speed = recording(1, 500, np.float64)
    expected = 0.5 * np.sin(0.01 * np.arange(500))
    batch = OscillatorBatch([config])
    result = batch.process([torque], motor_speed_rad_s=[speed], expected_torque_Nm=[expected])
    one = OscillatorFilter(config)
    reference = one.process(torque, motor_speed_rad_s=speed, expected_torque_Nm=expected)
    np.testing.assert_allclose(result.torque_Nm[0], reference.torque_Nm, atol=1e-9)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_long_log_is_the_sequence_within_a_tenth_of_a_millinewtonmetre(dtype):
    config = OscillatorFilterConfig(orders=[2, 4, Fraction(1, 20)], process_noise_variance_Nm2=1e-4)
    torque, speed = recording(2, 400_000, dtype)
    sequence, counters = alone(config, torque, speed, dtype)
    exact = filter_long(config, torque, motor_speed_rad_s=speed, dtype=dtype, in_sequence=True)
    np.testing.assert_array_equal(exact.torque_Nm, sequence.torque_Nm)
    assert exact.report.chunk_count == 1
    chunked = filter_long(
        config, torque, motor_speed_rad_s=speed, dtype=dtype, threads=2, ripple=True, status=True
    )
    assert chunked.report.chunk_count > 8
    assert chunked.report.warm_up_samples > 0
    error = chunked.torque_Nm.astype(float) - sequence.torque_Nm
    assert np.sqrt(np.mean(error**2)) < 1e-4
    assert chunked.report.rms_ripple_difference_Nm < 1e-4
    assert chunked.counters["samples"] == counters["samples"]
    assert chunked.counters["faults"] == counters["faults"]


def test_pieces_of_a_long_log_go_on():
    config = OscillatorFilterConfig(orders=[2, 4, Fraction(1, 20)], process_noise_variance_Nm2=1e-4)
    torque, speed = recording(4, 300_000, np.float64)
    sequence, _ = alone(config, torque, speed, np.float64)
    exact = LongOscillatorFilter(config, in_sequence=True)
    chunks = LongOscillatorFilter(config, threads=2)
    for start in range(0, 300_000, 100_000):
        rows = slice(start, start + 100_000)
        piece = {"torque_Nm": torque[rows], "motor_speed_rad_s": speed[rows]}
        np.testing.assert_array_equal(exact.process(**piece).torque_Nm, sequence.torque_Nm[rows])
        found = chunks.process(**piece, ripple=True, status=True)
        error_Nm = found.torque_Nm - sequence.torque_Nm[rows]
        assert 0.0 < np.sqrt(np.mean(error_Nm**2)) < 1e-4
        np.testing.assert_array_equal(found.status, sequence.status[rows])
        assert found.report.chunk_count > 1
        assert found.counters["samples"] == rows.stop


def test_too_short_a_warm_up_is_found_and_repeated():
    config = OscillatorFilterConfig(orders=[2, 4, Fraction(1, 20)])
    torque, speed = recording(3, 60_000, np.float64)
    sequence, _ = alone(config, torque, speed, np.float64)
    result = filter_long(config, torque, motor_speed_rad_s=speed, warm_up_memories=0.3)
    assert result.report.repeated_chunks == result.report.chunk_count - 1 > 0
    assert np.max(np.abs(result.torque_Nm - sequence.torque_Nm)) < 1e-3


def test_other_threads_of_python_run_meanwhile():
    config = oscillator_preset("taghirad1999-4")
    torque = np.zeros(3_000_000)
    seen = []
    done = threading.Event()

    def watch():
        while not done.is_set():
            seen.append(time.monotonic())
            time.sleep(0.001)

    watcher = threading.Thread(target=watch)
    watcher.start()
    start = time.monotonic()
    filter_long(config, torque, motor_speed_rad_s=torque + 100.0, in_sequence=True)
    end = time.monotonic()
    done.set()
    watcher.join()
    assert sum(start < moment < end for moment in seen) > 2


CONFIG = OscillatorFilterConfig(orders=[2, 4])
ONE = np.zeros(10)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: OscillatorBatch([1]), r"configs\[0\] is of type int"),
        (
            lambda: OscillatorBatch([OscillatorFilterConfig(orders=[2], rotation_source="angle")]),
            "turn by angle",
        ),
        (lambda: OscillatorBatch([CONFIG], dtype=np.int32), "expected float64 or float32"),
        (
            lambda: OscillatorBatch([CONFIG]).process(ONE, motor_speed_rad_s=ONE),
            r"torque_Nm has the shape \(10,\)",
        ),
        (
            lambda: OscillatorBatch([CONFIG]).process([ONE, ONE], motor_speed_rad_s=[ONE]),
            "torque_Nm has 2 channels: expected 1",
        ),
        (
            lambda: OscillatorBatch([CONFIG]).process([ONE], motor_speed_rad_s=[ONE[:5]]),
            r"motor_speed_rad_s\[0\] has 5 samples: expected 10",
        ),
        (
            lambda: OscillatorBatch([CONFIG]).process([["a"]], motor_speed_rad_s=[ONE]),
            r"torque_Nm\[0\] holds",
        ),
        (
            lambda: OscillatorBatch([CONFIG]).process("ab", motor_speed_rad_s=[ONE]),
            "torque_Nm is of type str",
        ),
        (
            lambda: OscillatorBatch([CONFIG]).process([ONE], motor_speed_rad_s=[ONE], threads=0),
            "threads = 0",
        ),
        (
            lambda: OscillatorBatch([CONFIG]).process([ONE], motor_speed_rad_s=[ONE], level="v4"),
            "level = 'v4'",
        ),
        (
            lambda: filter_long(CONFIG, ONE, motor_speed_rad_s=ONE, warm_up_memories=-1),
            "warm_up_memories = -1",
        ),
        (
            lambda: filter_long(CONFIG, ONE, motor_speed_rad_s=ONE, tolerance_Nm=np.nan),
            "tolerance_Nm = nan",
        ),
        (
            lambda: filter_long(CONFIG, ONE, motor_speed_rad_s=ONE[:3]),
            r"motor_speed_rad_s\[0\] has 3 samples",
        ),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(call, sentence):
    with pytest.raises(InputError, match=sentence):
        call()


def test_the_best_level_is_the_last_of_those_available():
    levels = available_vector_levels()
    assert levels[0] == VectorLevel.one_by_one
    assert len(levels) >= 2
