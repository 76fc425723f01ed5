"""The ripple filter under delays, jitter, gaps, held rows and clocks that go wrong."""

import itertools

import numpy as np
import pytest

from helpers.ripple_runs import (
    FAULTS,
    STRUCTURES,
    NOISE_Nm,
    busy_day,
    configured,
    counts,
    delayed_run,
    driving,
    has,
)
from strainwave import (
    RippleFilter,
    RippleOrder,
    StatusFlag,
)


@pytest.mark.parametrize(("rate_Hz", "jitter"), [(1000, 0.0), (8000, 0.0), (1000, 0.5)])
@pytest.mark.parametrize("delay_s", [0.0023, 0.0101])
def test_a_delay_is_compensated_while_the_speed_changes(rate_Hz, jitter, delay_s):
    right = delayed_run(rate_Hz, jitter, delay_s, delay_s)
    none = delayed_run(rate_Hz, jitter, delay_s, 0.0)
    floor = delayed_run(rate_Hz, jitter, 0.0, 0.0)
    assert none > 20 * right
    assert 0.05 < none < 2.0
    assert right < 1.2 * floor + 1e-3
    assert floor > 3e-5


@pytest.mark.parametrize("rate_Hz", [1000, 8000])
def test_a_lead_is_compensated(rate_Hz):
    right = delayed_run(rate_Hz, 0.0, -0.002, -0.002)
    none = delayed_run(rate_Hz, 0.0, -0.002, 0.0)
    assert none > 5 * right  # the speed is that of 10 ms ago: at 120 rad/s^2 it is behind
    assert 0.05 < none < 2.0


def test_longest_delay_at_the_highest_rate():
    right = delayed_run(20000, 0.0, 0.05, 0.05)
    assert right < 0.02  # points 4 ms apart: 120 rad/s^2 bends the angle by 0.5 mrad between them
    assert right > 1e-4


def test_longest_delay_at_the_speed_of_a_fast_motor():
    """50 ms at 10,000 rpm are 52 rad; the ripple is removed there as anywhere."""
    time = np.arange(8000) / 4000.0
    angle = 1047.0 * time
    ripple = 1.6 * np.cos(2 * (angle - 1047.0 * 0.05))
    config = configured(orders=[2], angle_to_torque_delay_s=0.05, memory_turns=10)
    result = RippleFilter(config).process(time, angle, ripple)
    late = time > 1
    assert np.sqrt(np.mean((result.ripple_Nm - ripple)[late] ** 2)) < 0.01
    assert np.ptp(result.ripple_Nm[late]) > 3


def test_jitter_costs_nothing():
    rng = np.random.default_rng(1)
    time = np.cumsum(1e-3 * rng.uniform(0.3, 1.7, 20000))
    angle = counts(150 * time)
    ripple = 1.6 * np.cos(2 * angle + 0.3)
    noise = NOISE_Nm * rng.standard_normal(len(time))
    rms = []
    for t, a in ((time, angle), (np.arange(20000) * 1e-3, counts(0.15 * np.arange(20000)))):
        r = 1.6 * np.cos(2 * a + 0.3)
        out = RippleFilter(configured(orders=[2])).process(t, a, noise + r)
        assert out.status[1:].sum() == 0
        rms.append(np.sqrt(np.mean((out.ripple_Nm - r)[10000:] ** 2)))
    assert rms[0] == pytest.approx(rms[1], rel=0.3)
    assert ripple.std() > 1


def test_a_gap_while_moving_is_bridged_and_said():
    time, angle, true, ripple = driving()
    keep = (np.arange(len(time)) < 3000) | (np.arange(len(time)) >= 4000)
    result = RippleFilter(configured(orders=[2, 4])).process(
        time[keep], angle[keep], (true + ripple)[keep]
    )
    error = (result.ripple_Nm - ripple[keep])[2800:]
    assert np.abs(error[:1200]).max() < 0.06
    missing = np.flatnonzero(has(result.status, StatusFlag.samples_missing))
    np.testing.assert_array_equal(missing, [3000])
    assert not (result.status & FAULTS).any()


def test_stamps_that_are_older_are_refused_named_and_forgotten():
    time, angle, true, ripple = driving()
    y = true + ripple
    config = configured(orders=[2, 4])
    bad = time.copy()
    bad[2000] = bad[1999]  # the same
    bad[2500] = 3.0  # older
    bad[3000] = np.nan
    bad[3500] = -np.inf
    ours = RippleFilter(config)
    result = ours.process(bad, angle, y)
    late = has(result.status, StatusFlag.sample_out_of_order)
    np.testing.assert_array_equal(np.flatnonzero(late), [2000, 2500])
    unknown = has(result.status, StatusFlag.time_not_finite)
    np.testing.assert_array_equal(np.flatnonzero(unknown), [3000, 3500])
    np.testing.assert_array_equal(np.flatnonzero(result.status & FAULTS), [2000, 2500, 3000, 3500])
    for k in (2000, 2500, 3000, 3500):
        assert result.torque_Nm[k] == result.torque_Nm[k - 1]
    # A refused row is a row that was not there.
    there = np.setdiff1d(np.arange(len(time)), [2000, 2500, 3000, 3500])
    without = RippleFilter(config).process(time[there], angle[there], y[there])
    np.testing.assert_array_equal(result.ripple_Nm[there], without.ripple_Nm)
    assert ours.counters["sample_out_of_order"] == ours.counters["time_not_finite"] == 2
    assert ours.counters["faults"] == 4
    assert ours.counters["samples"] == len(time)


def test_a_clock_that_is_set_back_is_followed_after_ten_rows():
    time, angle, true, ripple = driving()
    set_back = np.where(np.arange(len(time)) < 3000, time, time - 50.0)
    result = RippleFilter(configured(orders=[2, RippleOrder(4, with_speed=True)])).process(
        set_back, angle, true + ripple
    )
    late = has(result.status, StatusFlag.sample_out_of_order)
    np.testing.assert_array_equal(np.flatnonzero(late), np.arange(3000, 3010))
    assert has(result.status[3010], StatusFlag.samples_missing)
    assert not (result.status[3010:] & FAULTS).any()
    # The step back is as long as the rows that were refused: no leap of the speed, none of the ripple.
    assert np.abs((result.ripple_Nm - ripple)[3010:]).max() < 0.1


@pytest.mark.parametrize(("stamp_s", "first_refused"), [(1e9, 3000), (9e5, 3001)])
def test_one_stamp_of_the_far_future_costs_eleven_rows(stamp_s, first_refused):
    """Beyond 1e6 s the interval itself is refused; then the clock is 'set back' in any case."""
    time, angle, true, ripple = driving()
    time[3000] = stamp_s
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, true + ripple)
    refused = np.flatnonzero(result.status & FAULTS)
    np.testing.assert_array_equal(refused, np.arange(first_refused, 3011))
    unknown = np.flatnonzero(has(result.status, StatusFlag.time_not_finite))
    np.testing.assert_array_equal(unknown, [3000] if first_refused == 3000 else [])
    assert np.abs((result.ripple_Nm - ripple)[3011:]).max() < 0.1


def test_a_log_that_begins_without_time_loses_no_good_row():
    time, angle, true, ripple = driving(2000)
    time[:3] = np.nan
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, true + ripple)
    np.testing.assert_array_equal(
        np.flatnonzero(has(result.status, StatusFlag.time_not_finite)), [0, 1, 2]
    )
    np.testing.assert_array_equal(np.flatnonzero(result.status & FAULTS), [0, 1, 2])


def test_constant_time_changes_nothing():
    _, angle, true, ripple = driving(500)
    ours = RippleFilter(configured(orders=[2]))
    result = ours.process(np.full(500, 7.0), angle, true + ripple)
    assert has(result.status[1:], StatusFlag.sample_out_of_order).all()
    assert (result.torque_Nm == result.torque_Nm[0]).all()
    np.testing.assert_array_equal(ours.state()[0][1:], [0.0, 0.0])


@pytest.mark.parametrize(
    "orders",
    [[2, 4], [2, RippleOrder(4, with_speed=True)], [RippleOrder(2, with_load=True), 4]],
    ids=["constant", "speed", "load"],
)
@pytest.mark.parametrize("delay_s", [0.0, 0.0063])
def test_held_rows_count_once(orders, delay_s):
    """Three rows of four repeat the last: as if they were not there."""
    time, angle, true, ripple = driving(4000, dt=4e-3)
    y = true + ripple
    config = configured(orders=orders, angle_to_torque_delay_s=delay_s)
    start = 500  # before, nothing repeats: the first rows do not know yet that the motor turns
    fine = np.arange(4 * (len(time) - start))
    held_time = np.concatenate([time[:start], time[start] + fine * 1e-3])
    row = np.concatenate([np.arange(start), start + fine // 4])
    ours = RippleFilter(config)
    held = ours.process(held_time, angle[row], y[row])
    alone = RippleFilter(config).process(time, angle, y)
    fresh = np.concatenate([[True], np.diff(row) > 0])
    np.testing.assert_array_equal(has(held.status, StatusFlag.sample_repeated), ~fresh)
    assert ours.counters["sample_repeated"] == 3 * (len(time) - start)
    assert np.abs(held.ripple_Nm[fresh] - alone.ripple_Nm).max() < 1e-9
    for k in range(1, 4):
        again = held.torque_Nm[start + k :: 4]
        np.testing.assert_array_equal(again, held.torque_Nm[start::4][: len(again)])


def test_equal_torques_of_a_coarse_converter_are_not_held_rows():
    time, angle, true, ripple = driving()
    coarse = np.round((true + ripple) / 2.0) * 2.0
    assert (np.diff(coarse) == 0).mean() > 0.5
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, coarse)
    assert not has(result.status, StatusFlag.sample_repeated).any()


def test_standing_with_the_same_torque_is_not_held():
    n = 1000
    result = RippleFilter(configured(orders=[2])).process(
        np.arange(n) * 1e-3, np.full(n, 3.0), np.full(n, 5.0)
    )
    assert not (result.status & FAULTS).any()
    assert has(result.status, StatusFlag.at_rest).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_chunks_equal_one_call_to_the_last_bit(dtype):
    time, angle, torque, expected = busy_day()
    time, angle = time.copy(), angle.copy()
    torque, expected = torque.astype(dtype), expected.astype(dtype)
    torque[[100, 999, 1000, 2500]] = np.nan
    angle[[1200, 1201]] = np.nan
    time[3000] = time[2990]
    config = configured(orders=STRUCTURES["load and speed"], angle_to_torque_delay_s=0.0023)
    whole = RippleFilter(config, dtype=dtype)
    one = whole.process(time, angle, torque, expected_torque_Nm=expected)
    pieces = RippleFilter(config, dtype=dtype)
    cuts = [0, 1, 1, 17, 1000, 1001, 1201, 3000, 6001, len(time)]
    parts = [
        pieces.process(time[a:b], angle[a:b], torque[a:b], expected_torque_Nm=expected[a:b])
        for a, b in itertools.pairwise(cuts)
    ]
    for name in vars(one):
        joined = np.concatenate([getattr(part, name) for part in parts])
        assert joined.tobytes() == getattr(one, name).tobytes(), name
    assert pieces.counters == whole.counters
