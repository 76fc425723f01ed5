"""The ripple filter under faults: wild numbers, missing angles, stuck torques."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.ripple_runs import (
    WILD,
    NOISE_Nm,
    configured,
    driving,
    has,
)
from strainwave import (
    RippleFilter,
    RippleOrder,
    StatusFlag,
)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.integers(0, 1999),
            st.integers(1, 30),
            st.sampled_from(["time", "angle", "torque", "expected"]),
            st.sampled_from(WILD),
        ),
        min_size=1,
        max_size=25,
    ),
    st.sampled_from([np.float32, np.float64]),
    st.sampled_from([0.0, 0.0023, 0.05, -0.004]),
)
def test_wild_numbers_are_survived(faults, dtype, delay_s):
    n = 12000
    time = np.arange(n) * 1e-3
    angle = 150.0 * time
    ripple = 2.0 * np.cos(2 * (angle - 150.0 * delay_s))
    orders = [RippleOrder(2, with_load=True, with_speed=True), RippleOrder(4, with_direction=True)]
    config = configured(orders=orders, memory_turns=10, angle_to_torque_delay_s=delay_s)
    with np.errstate(over="ignore"):
        arrays = {
            "time": time.copy(),
            "angle": angle.copy(),
            "torque": ripple.astype(dtype),
            "expected": np.zeros(n, dtype),
        }
        for at, count, name, value in faults:
            arrays[name][at : at + count] = value
    ours = RippleFilter(config, dtype=dtype)
    result = ours.process(
        arrays["time"], arrays["angle"], arrays["torque"], expected_torque_Nm=arrays["expected"]
    )
    for name in vars(result):
        assert np.isfinite(getattr(result, name)).all(), name
    states, covariance = ours.state()
    assert np.isfinite(states).all()
    assert np.linalg.eigvalsh(covariance)[0] > -1e-6 * covariance.max()
    # 10 s, 240 turns, 24 memories later nothing is left of it.
    assert np.abs(result.ripple_Nm - ripple)[-500:].max() < 0.02
    assert ours.counters["samples"] == n


def test_faults_have_their_flags_and_hold_the_torque():
    time, angle, true, ripple = driving()
    y = true + ripple
    expected = np.zeros_like(y)
    y[1000:1003] = [np.nan, np.inf, -1e30]
    expected[1500:1502] = [np.nan, 1e30]
    angle[2000:2003] = [np.nan, np.inf, 1e30]
    angle[3000] += 500.0
    result = RippleFilter(configured(orders=[2, 4])).process(
        time, angle, y, expected_torque_Nm=expected
    )
    flagged = {
        StatusFlag.torque_not_finite: [1000, 1001, 1002],
        StatusFlag.expected_torque_not_finite: [1500, 1501],
        StatusFlag.rotation_invalid: [2000, 2001, 2002, 3000, 3001],
    }
    for flag, rows in flagged.items():
        np.testing.assert_array_equal(np.flatnonzero(has(result.status, flag)), rows)
    assert (result.torque_Nm[1000:1003] == result.torque_Nm[999]).all()
    every = sorted(itertools.chain.from_iterable(flagged.values()))
    assert (result.innovation_Nm[every] == 0).all()
    assert (result.innovation_variance_Nm2[every] == 0).all()
    assert (result.innovation_variance_Nm2[4000:] > NOISE_Nm**2).all()
    # Without an angle for three samples the ripple goes on at the last speed.
    assert np.abs((result.ripple_Nm - ripple)[2000:2003]).max() < 0.06
    assert np.abs((result.ripple_Nm - ripple)[3002:]).max() < 0.06


def test_without_any_angle_nothing_is_removed():
    time, angle, true, ripple = driving(2000)
    y = true + ripple
    ours = RippleFilter(configured(orders=[2, 4]))
    result = ours.process(time, np.full_like(angle, np.nan), y)
    np.testing.assert_array_equal(result.torque_Nm, y)
    assert (result.ripple_Nm == 0).all()
    assert has(result.status, StatusFlag.rotation_invalid).all()
    # and when the angle comes, it is learned as from the start
    time2, angle2, true2, ripple2 = driving(8000)
    late = ours.process(time2 + 2.0, angle2, true2 + ripple2)
    assert np.abs((late.ripple_Nm - ripple2)[6000:]).max() < 0.06


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_stuck_torque_is_forgotten(dtype):
    """Two seconds at the rail of a converter: back within a few memories, and bounded meanwhile."""
    time, angle, true, ripple = driving(30000)
    y = (true + ripple).astype(dtype)
    y[8000:10000] = 60.0
    config = configured(orders=[2, 4], memory_turns=20)
    result = RippleFilter(config, dtype=dtype).process(time, angle, y)
    turns = (angle - angle[10000]) / (2 * np.pi)
    error = np.abs(result.ripple_Nm - ripple)
    assert error[:10000][8000:].max() < 10
    assert error[turns > 8 * 20].max() < 0.1
    assert error[7000:8000].max() < 0.1


def test_an_outlier_does_not_shake_the_ripple():
    """The weight: at most 3 scales of an innovation reach the coefficients."""
    time, angle, true, ripple = driving()
    clean = RippleFilter(configured(orders=[2, 4])).process(time, angle, true + ripple)
    y = true + ripple
    y[4000] += 50.0
    spiked = RippleFilter(configured(orders=[2, 4])).process(time, angle, y)
    shaken = np.abs(spiked.ripple_Nm - clean.ripple_Nm)[4001:].max()
    # One sample of 3 scales, 0.2 to 0.5 Nm, through a gain of about 2 dtheta / (2 pi n) an order;
    # T's own answer to the spike, which all samples after it see, is weighted alike.
    assert 1e-5 < shaken < 0.05
