"""The limit that the speed bench computes, against filters that count what they do."""

import numpy as np
import pytest

from benchmarks.speed.bounds import FLOPS, copy_ns, flops_ns
from benchmarks.speed.inputs import make
from benchmarks.speed.reference import default_ripple, published_ripple
from helpers.counted import Counted, LeanDefault, LeanPublished

LIMITS = {
    "operations_per_s": {"v3": {"float": 1e11, "double": 5e10}},
    "bandwidth_bytes_per_s": {"2": {"copy": 2e10, "triad": 2.4e10}},
}


def _run(step, torque, motion) -> tuple[np.ndarray, np.ndarray]:
    """Ripple and operations of every sample."""
    ripple, operations = [], []
    for y, u in zip(torque, motion, strict=True):
        before = Counted.operations
        ripple.append(step(y, u))
        operations.append(Counted.operations - before)
    return np.array(ripple), np.array(operations)


def test_published_filter_takes_hardly_more_than_the_limit_says():
    recording = make(2000, 3)
    ripple, operations = _run(
        LeanPublished().step, recording.torque_Nm, recording.motor_speed_rad_s
    )
    np.testing.assert_allclose(ripple, published_ripple(recording, 2000), atol=1e-11)
    assert FLOPS["published"] <= np.max(operations) <= 1.05 * FLOPS["published"]


def test_default_filter_takes_hardly_more_than_the_limit_says():
    recording = make(2000, 3)
    ripple, operations = _run(LeanDefault().step, recording.torque_Nm, recording.motor_angle_rad)
    assert np.max(np.abs(ripple)) > 1.0
    # Until a pair is hardly known: the lean filter has no rule for that.
    reference = default_ripple(recording, 500, limited=False)
    np.testing.assert_allclose(ripple[:500], reference, atol=1e-6)
    moving = np.abs(recording.motor_speed_rad_s) > 20.0
    assert np.count_nonzero(moving) > 500
    assert FLOPS["default"] <= np.median(operations[moving]) <= 1.25 * FLOPS["default"]


def test_limits_are_quotients():
    assert flops_ns("published", "v3", "float", LIMITS) == pytest.approx(2.12)
    assert flops_ns("default", "v3", "double", LIMITS) == pytest.approx(16.0)
    assert copy_ns(2, LIMITS) == pytest.approx(0.5)
