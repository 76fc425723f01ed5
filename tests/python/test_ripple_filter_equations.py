"""The ripple filter against its equations, written anew in dense form."""

from fractions import Fraction

import numpy as np
import pytest

from helpers.ripple_runs import FAULTS, STRUCTURES, Dense, busy_day, configured, has
from strainwave import (
    RippleFilter,
    RippleOrder,
    StatusFlag,
)


@pytest.mark.parametrize("orders", STRUCTURES.values(), ids=STRUCTURES)
@pytest.mark.parametrize("memory_turns", [3.0, 30.0])
def test_double_is_the_dense_form(orders, memory_turns):
    config = configured(orders=orders, memory_turns=memory_turns)
    arrays = busy_day()
    dense = Dense(config)
    removed, everything = dense.run(*arrays)
    ours = RippleFilter(config)
    time, angle, torque, expected = arrays
    result = ours.process(time, angle, torque, expected_torque_Nm=expected)
    # Process noise is a polynomial of the rotation, right to 6e-6 of itself; how little a pair is
    # known is judged in the frame; the phase of an order that is no whole number is rounded to
    # 2^-32 cycle.
    with_terms = any(isinstance(o, RippleOrder) for o in orders)
    tolerance = 1e-5 if with_terms else 1e-6 if Fraction(7, 3) in orders else 2e-7
    assert np.abs(result.ripple_Nm - removed).max() < tolerance
    assert np.abs(torque - result.torque_all_removed_Nm - everything).max() < tolerance
    np.testing.assert_array_equal(result.torque_Nm, torque - result.ripple_Nm)
    states, covariance = ours.state()
    assert np.abs(states - dense.x).max() < 5 * tolerance
    assert np.abs(covariance - dense.P).max() < 5 * tolerance * np.abs(dense.P).max()
    np.testing.assert_array_equal(covariance, covariance.T)
    # The run is one in which weights act, learning stops, and ripple is there to be found.
    weights = np.array(dense.weights)
    assert 0.003 < np.mean(weights[~np.isnan(weights)] < 1) < 0.3
    assert 0.1 < np.isnan(weights).mean() < 0.4
    assert has(result.status, StatusFlag.samples_missing).sum() == 1
    assert not (result.status & FAULTS).any()


@pytest.mark.parametrize("delay_s", [0.0023, 0.001, 0.0066, -0.002])
def test_double_is_the_dense_form_with_a_delay(delay_s):
    orders = [2, RippleOrder(4, with_speed=True)]
    config = configured(orders=orders, angle_to_torque_delay_s=delay_s)
    # Before the gap; with a lead before the rest, where the speed fades in steps below a phase's unit.
    rows = 3500 if delay_s < 0 else 6000
    time, angle, torque, expected = (a[:rows] for a in busy_day())
    removed, _ = Dense(config).run(time, angle, torque, expected)
    result = RippleFilter(config).process(time, angle, torque, expected_torque_Nm=expected)
    # The offset is rounded to a phase; a sample of delay too much would be 0.3 Nm.
    assert np.abs(result.ripple_Nm - removed).max() < 1e-6


@pytest.mark.parametrize("name", STRUCTURES)
def test_float_is_the_dense_form(name):
    config = configured(orders=STRUCTURES[name])
    time, angle, torque, expected = busy_day()
    torque, expected = torque.astype(np.float32), expected.astype(np.float32)
    removed, _ = Dense(config).run(
        time, angle, torque.astype(np.float64), expected.astype(np.float64)
    )
    result = RippleFilter(config, dtype=np.float32).process(
        time, angle, torque, expected_torque_Nm=expected
    )
    assert result.ripple_Nm.dtype == np.float32
    difference = result.ripple_Nm - removed
    # Where two pairs cannot be told apart for a while, float splits their sum a little differently.
    assert 1e-8 < np.sqrt(np.mean(difference**2)) < 1e-4
    assert np.abs(difference).max() < 2e-3
