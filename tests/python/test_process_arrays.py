"""What `process` does with memory and with the interpreter, and that `step` is one sample of it."""

import sys
import threading
import tracemalloc
from dataclasses import fields, replace

import numpy as np
import pytest

from strainwave import (
    Converter,
    Gains,
    InputError,
    OscillatorFilter,
    OscillatorFilterConfig,
    RippleFilter,
    RippleFilterConfig,
    RotationSource,
    TorqueCalibration,
    TorqueSensor,
    TorqueSensorConfig,
    _core,
)

BY_SPEED = OscillatorFilterConfig(orders=[2, 4], rotation_source=RotationSource.speed)
BY_ANGLE = OscillatorFilterConfig(orders=[2, 4], rotation_source=RotationSource.angle)
RIPPLE = RippleFilterConfig(orders=[2, 4])


def samples(rows, dtype=np.float64):
    """Time, angle, speed and torque of a motor that speeds up and turns back."""
    time_s = 1e-3 * np.arange(rows)
    speed_rad_s = 40.0 * np.sin(3.0 * time_s)
    angle_rad = 1e-3 * np.cumsum(speed_rad_s)
    torque_Nm = 2.0 * np.cos(2.0 * angle_rad) + np.random.default_rng(5).normal(0.0, 0.1, rows)
    return time_s, angle_rad, speed_rad_s.astype(dtype), torque_Nm.astype(dtype)


def oscillator(dtype, rows):
    _, _, speed_rad_s, torque_Nm = samples(rows, dtype)
    made = OscillatorFilter(BY_SPEED, dtype=dtype)
    return made, (torque_Nm,), {"motor_speed_rad_s": speed_rad_s}


def ripple(dtype, rows):
    time_s, angle_rad, _, torque_Nm = samples(rows, dtype)
    return RippleFilter(RIPPLE, dtype=dtype), (time_s, angle_rad, torque_Nm), {}


def sensor(dtype, rows):
    time_s, angle_rad, _, torque_Nm = samples(rows)
    codes = np.rint(np.outer(100.0 * torque_Nm, [1.0, 0.5])).astype(np.int32)
    config = TorqueSensorConfig(
        converter=Converter(bits=16, minimum_V=-10.0, maximum_V=10.0, lowest_code=-32768),
        gains=Gains([0.5, 0.5]),
        calibration=TorqueCalibration(gain_Nm_per_V=10.0),
        filter=RIPPLE,
    )
    return (
        TorqueSensor(config, dtype=dtype),
        (codes,),
        {"motor_angle_rad": angle_rad, "time_s": time_s},
    )


OBJECTS = pytest.mark.parametrize("build", [oscillator, ripple, sensor])
PRECISIONS = pytest.mark.parametrize("dtype", [np.float64, np.float32])


def assert_same(first, second):
    for field in fields(first):
        np.testing.assert_array_equal(getattr(first, field.name), getattr(second, field.name))


@OBJECTS
@PRECISIONS
def test_results_are_written_where_they_are_wanted(build, dtype):
    made, given, named = build(dtype, 500)
    expected = made.process(*given, **named)
    made.reset()
    out = replace(
        expected, **{f.name: np.ones_like(getattr(expected, f.name)) for f in fields(expected)}
    )
    arrays = [getattr(out, field.name) for field in fields(out)]
    assert made.process(*given, **named, out=out) is out
    assert all(
        getattr(out, field.name) is each for field, each in zip(fields(out), arrays, strict=True)
    )
    assert_same(out, expected)


@OBJECTS
@PRECISIONS
def test_nothing_is_copied(build, dtype):
    made, given, named = build(dtype, 100_000)
    for array in (*given, *named.values()):
        array.flags.writeable = False
    out = made.process(*given, **named)
    tracemalloc.start()
    try:
        made.process(*given, **named, out=out)
        _, peak_bytes = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # A copy of the smallest array would take a tenth of a megabyte.
    assert peak_bytes < 20_000


@OBJECTS
def test_other_layouts_give_the_same(build):
    made, given, named = build(np.float64, 400)
    expected = made.process(*given, **named)
    made.reset()
    scattered = [np.repeat(array, 2, axis=0)[::2] for array in (*given, *named.values())]
    assert not any(array.flags.c_contiguous for array in scattered)
    found = made.process(
        *scattered[: len(given)], **dict(zip(named, scattered[len(given) :], strict=True))
    )
    assert_same(found, expected)


@OBJECTS
@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda array: array[:-1], "status cannot take the results"),
        (lambda array: array.astype(np.int64), "expected a contiguous, writable array of uint32"),
        (lambda array: np.repeat(array, 2)[::2], "status cannot take the results"),
        (lambda array: np.frombuffer(array.tobytes(), array.dtype), "status cannot take"),
        (lambda array: array.tolist(), "status cannot take the results"),
    ],
)
def test_arrays_that_cannot_take_the_results_are_refused(build, spoil, words):
    made, given, named = build(np.float64, 50)
    out = made.process(*given, **named)
    made.reset()
    with pytest.raises(InputError, match=words):
        made.process(*given, **named, out=replace(out, status=spoil(out.status)))
    assert made.counters["samples"] == 0


@OBJECTS
def test_results_may_not_overwrite_what_they_are_computed_from(build):
    made, given, named = build(np.float64, 50)
    out = made.process(*given, **named)
    with pytest.raises(InputError, match="ripple_Nm shares memory with another array"):
        made.process(*given, **named, out=replace(out, ripple_Nm=out.torque_Nm))
    angle_rad = named.get("motor_angle_rad", given[1] if len(given) > 1 else given[0])
    with pytest.raises(InputError, match="torque_Nm shares memory with another array"):
        made.process(*given, **named, out=replace(out, torque_Nm=angle_rad))


def tracking_notch(_dtype, rows):
    _, angle_rad, _, torque_Nm = samples(rows)
    made = _core.TrackingNotch(orders=[2], sample_period_s=1e-3)
    return made, (torque_Nm, angle_rad), {}


def smoother(_dtype, rows):
    time_s, angle_rad, _, torque_Nm = samples(rows)
    made = _core.RippleSmoother(RIPPLE)
    return made, (time_s, angle_rad, torque_Nm, np.zeros(rows), rows), {}


@pytest.fixture
def _no_turns():
    """Let a thread of Python go on until it gives up the interpreter by itself."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e6)
    yield
    sys.setswitchinterval(before)


def _goes_on_during(work, rounds):
    """Whether another thread of Python gets a turn while this one does some work, over and over."""
    begin, has_run = threading.Lock(), []

    def wait_for_a_turn():
        with begin:
            has_run.append(True)

    begin.acquire()
    other = threading.Thread(target=wait_for_a_turn)
    other.start()
    begin.release()
    for _ in range(rounds):
        work()
        if has_run:
            break
    found = bool(has_run)
    other.join()
    return found


@pytest.mark.usefixtures("_no_turns")
@pytest.mark.parametrize("build", [oscillator, ripple, sensor, tracking_notch, smoother])
def test_python_goes_on_while_samples_are_processed(build):
    made, given, named = build(np.float64, 5000)
    assert _goes_on_during(lambda: made.process(*given, **named), rounds=2000)


@pytest.mark.usefixtures("_no_turns")
def test_python_does_not_go_on_during_a_step():
    made, _, _ = oscillator(np.float64, 1)
    assert not _goes_on_during(lambda: made.step(1.0, 2.0), rounds=500_000)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("config", [BY_SPEED, BY_ANGLE])
def test_a_step_of_the_oscillator_filter_is_one_sample(config, dtype):
    _, angle_rad, speed_rad_s, torque_Nm = samples(400, dtype)
    torque_Nm[7] = np.nan
    motion, name = (
        (speed_rad_s, "motor_speed_rad_s") if config is BY_SPEED else (angle_rad, "motor_angle_rad")
    )
    expected = OscillatorFilter(config, dtype=dtype).process(torque_Nm, **{name: motion})
    made = OscillatorFilter(config, dtype=dtype)
    for k in range(400):
        if k == 200:
            made = made.copy()
        assert made.step(float(torque_Nm[k]), float(motion[k])) == expected.torque_Nm[k]
        assert made.last_step == (expected.ripple_Nm[k], expected.status[k])
    assert made.counters["samples"] == 400
    assert expected.status[7] != 0


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_step_of_the_ripple_filter_is_one_sample(dtype):
    time_s, angle_rad, _, torque_Nm = samples(400, dtype)
    angle_rad[9] = np.nan
    expected = RippleFilter(RIPPLE, dtype=dtype).process(time_s, angle_rad, torque_Nm)
    made = RippleFilter(RIPPLE, dtype=dtype)
    for k, row in enumerate(
        zip(time_s.tolist(), angle_rad.tolist(), torque_Nm.tolist(), strict=True)
    ):
        if k == 200:
            made = made.copy()
        assert made.step(*row) == expected.torque_Nm[k]
        assert made.last_step == (expected.ripple_Nm[k], expected.status[k])
    assert expected.status[9] != 0


def test_a_copy_steps_on_its_own():
    made, _, _ = oscillator(np.float64, 1)
    made.step(1.0, 2.0)
    twin = made.copy()
    twin.step(5.0, 2.0)
    assert (made.counters["samples"], twin.counters["samples"]) == (1, 2)


def test_a_step_waits_for_the_samples_that_are_processed():
    made, given, named = oscillator(np.float64, 400_000)
    runner = threading.Thread(target=lambda: made.process(*given, **named))
    runner.start()
    steps = 0
    while runner.is_alive():
        made.step(1.0, 2.0)
        steps += 1
    runner.join()
    assert made.counters["samples"] == 400_000 + steps
