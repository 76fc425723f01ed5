"""The core's default filter against the independent implementation that the bench keeps."""

import numpy as np
import pytest

import strainwave
from benchmarks.accuracy.evaluation import log_of
from benchmarks.accuracy.joint import FULL_SCALE_NM, make_joint, simulate
from benchmarks.accuracy.methods.reference_filter import (
    ReferenceSettings,
    process_variance,
    reference_filter,
)
from benchmarks.accuracy.metrics import error_by_phase, rms
from benchmarks.accuracy.motion import PHASES
from benchmarks.accuracy.ripple import MISMATCH, RIGHT

TERMS = [(2, "constant"), (4, "constant"), (6, "constant")] + [
    (order, kind) for kind in ("load", "speed") for order in (2, 4)
]
#: Values of the core that its configuration does not hold.
AS_THE_CORE = {
    "contact_rule": "jump",
    "scale_rate_per_rad": 0.06,
    "load_flattens": True,
    "variance_limited": True,
    "noise_shared": True,
    "noise_after": True,
    "gaps_bridged": True,
    "rest_is_exact": True,
}


@pytest.mark.parametrize(("scenario", "memory_turns"), [(RIGHT, 30.0), (MISMATCH, 5.0)])
def test_the_core_is_the_reference_but_for_rounding(scenario, memory_turns):
    run = simulate(make_joint(scenario, 4))
    log = log_of(run)
    config = strainwave.RippleFilterConfig(
        orders=[
            strainwave.RippleOrder(2, with_load=True, with_speed=True),
            strainwave.RippleOrder(4, with_load=True, with_speed=True),
            6,
        ],
        memory_turns=memory_turns,
    )
    core = strainwave.RippleFilter(config).process(log.time_s, log.wave_angle_rad, log.torque_Nm)
    reference = reference_filter(
        ReferenceSettings(
            TERMS,
            memory_turns=memory_turns,
            torque_noise_Nm=config.torque_noise_Nm,
            torque_walk_Nm_per_sqrt_s=config.torque_walk_Nm_per_sqrt_s,
            initial_amplitude_Nm=config.initial_amplitude_Nm,
            rated_torque_Nm=config.rated_torque_Nm,
            reference_speed_rad_s=config.reference_speed_rad_s,
            minimum_speed_rad_s=config.minimum_speed_rad_s,
            **AS_THE_CORE,
        ),
        log.time_s,
        log.wave_angle_rad,
        log.torque_Nm,
    )
    difference = core.ripple_Nm - reference.ripple_Nm
    # Rounding until the scale's tracking, which asks whether an innovation is beyond it, is asked
    # at an innovation within rounding of it; from there on the two scales are apart by a step.
    moved = int(np.argmax(run.motion.speed_rad_s != 0))
    assert np.max(np.abs(difference[: moved + 1000])) < 1e-5
    assert rms(difference) < 1e-4
    assert np.max(np.abs(difference)) < 5e-3


@pytest.mark.parametrize("rule", ["weighted", "jump"])
def test_the_reference_reaches_the_figures_of_the_study(rule):
    # An independent study: mean error 0.105 %FS at a noise floor of 0.10.
    run = simulate(make_joint(RIGHT, 1))
    log = log_of(run)
    settings = ReferenceSettings(TERMS, contact_rule=rule)
    found = reference_filter(settings, log.time_s, log.wave_angle_rad, log.torque_Nm)
    error = error_by_phase(
        found.torque_Nm - run.true_torque_Nm, run.motion.phase, PHASES, FULL_SCALE_NM
    )
    assert 0.098 < error["mean"] < 0.108


def test_process_noise_has_its_limits():
    orders = np.array([2.0, 4.0])
    # No walk: white noise alone, the same for every order.
    np.testing.assert_allclose(process_variance(orders, 0.1, 1e-3, 2.0, 0.0), 2 * 2.0 * 0.01)
    # Slow: q_T dt / (2 - 2 cos(k x)) goes to q_T dt / (k x)^2.
    slow = process_variance(orders, 1e-3, 1e-3, 0.0, 5.0)
    np.testing.assert_allclose(slow, 2 * 5e-3 / orders**2, rtol=1e-5)
    # Beyond half a cycle per sample: the white level of a walk's steps.
    fast = process_variance(orders, 3.0, 1e-3, 0.0, 5.0)
    np.testing.assert_allclose(fast, 2 * 5e-3 * 9.0 / 4)
