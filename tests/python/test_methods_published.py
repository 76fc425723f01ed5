"""The published filter as a method is the filter, turned by the recording's own motion."""

from fractions import Fraction

import numpy as np
import pytest

from helpers.joint_sections import OSCILLATOR, PROVENANCE, gear
from strainwave import InputError, OscillatorFilter, OscillatorFilterConfig
from strainwave.joint import Joint
from strainwave.methods.motion import BackwardDifference
from strainwave.methods.registry import Setting, build_method
from strainwave.samples import Samples

PERIOD_S = 2.5e-3
ROWS = 3000


def published(orders):
    return OscillatorFilterConfig(
        orders=orders,
        process_noise_variance_Nm2=1e3,
        measurement_noise_variance_Nm2=1.0,
        initial_variance_Nm2=1e3,
        sample_period_s=PERIOD_S,
        minimum_travel_rad=0.0,
        minimum_speed_rad_s=0.0,
        variance_limit_ratio=0.0,
    )


def recording():
    rng = np.random.default_rng(8)
    time_s = np.arange(ROWS) * PERIOD_S + 2e-4 * rng.random(ROWS)
    angle_rad = 30.0 * np.sin(2.0 * time_s)
    torque_Nm = np.cos(2 * angle_rad) + 0.4 * np.sin(4 * angle_rad) + np.sin(angle_rad / 51)
    expected_Nm = 0.3 * np.cos(2.0 * time_s)
    return Samples(time_s, angle_rad, torque_Nm + expected_Nm, expected_Nm)


def joint(section=None):
    if section is not None:
        section = {**section, "provenance": PROVENANCE}
    return Joint.model_validate(
        {"joint": {"name": "elbow"}, "gear": gear(), "ripple_filter": section}
    )


TUNED = {**OSCILLATOR, "orders": [2, 4, "1/R"], "sample_period_s": PERIOD_S}


@pytest.mark.parametrize(
    ("name", "orders"),
    [("taghirad1999", [2, 4, Fraction(2, 101)]), ("taghirad1999-4", [2, 4])],
)
def test_published_methods_are_the_filter_called_directly(name, orders):
    samples = recording()
    speed_rad_s = np.zeros(ROWS)
    for k in range(1, ROWS):
        travel_rad = samples.motor_angle_rad[k] - samples.motor_angle_rad[k - 1]
        speed_rad_s[k] = travel_rad / (samples.time_s[k] - samples.time_s[k - 1])
    direct = OscillatorFilter(published(orders)).process(
        samples.torque_Nm,
        motor_speed_rad_s=speed_rad_s,
        expected_torque_Nm=samples.expected_torque_Nm,
    )
    cleaned = build_method(name, Setting(PERIOD_S, Fraction(101, 2), 40.0)).process(samples)
    np.testing.assert_array_equal(cleaned.torque_Nm, direct.torque_Nm)
    np.testing.assert_array_equal(cleaned.ripple_Nm, direct.ripple_Nm)
    np.testing.assert_array_equal(cleaned.status, direct.status)


@pytest.mark.parametrize("source", ["speed", "angle"])
def test_oscillator_is_the_joint_files_filter(source):
    samples = recording()
    known = joint({**TUNED, "rotation_source": source})
    cleaned = build_method("oscillator", Setting(PERIOD_S, None, 40.0, known)).process(samples)
    config = OscillatorFilterConfig(
        orders=[2, 4, Fraction(1, 100)],
        process_noise_variance_Nm2=1e3,
        measurement_noise_variance_Nm2=1.0,
        initial_variance_Nm2=1.0,
        sample_period_s=PERIOD_S,
        rotation_source=source,
    )
    direct = OscillatorFilter(config).process(
        samples.torque_Nm,
        motor_speed_rad_s=BackwardDifference().speeds(samples.time_s, samples.motor_angle_rad),
        motor_angle_rad=samples.motor_angle_rad,
        expected_torque_Nm=samples.expected_torque_Nm,
    )
    np.testing.assert_array_equal(cleaned.torque_Nm, direct.torque_Nm)
    np.testing.assert_array_equal(cleaned.status, direct.status)


def test_oscillator_turns_by_the_recordings_period_where_the_files_is_rounded():
    samples = recording()
    rounded = joint({**TUNED, "sample_period_s": 2.4e-3})
    exact = joint(TUNED)
    setting = Setting(PERIOD_S, None, 40.0, rounded)
    np.testing.assert_array_equal(
        build_method("oscillator", setting).process(samples).torque_Nm,
        build_method("oscillator", Setting(PERIOD_S, None, 40.0, exact)).process(samples).torque_Nm,
    )


def test_without_the_ratio_order_1_over_r_cannot_be_removed():
    with pytest.raises(InputError, match="taghirad1999 needs the ratio"):
        build_method("taghirad1999", Setting(PERIOD_S, None, 40.0))
    build_method("taghirad1999-4", Setting(PERIOD_S, None, 40.0))


@pytest.mark.parametrize(
    ("known", "sentence"),
    [
        (None, "takes its values from a joint file"),
        (joint(), r'joint "elbow": there is no section \[ripple_filter\]'),
        (joint({**TUNED, "sample_period_s": 1e-3}), r"tuned for sample_period_s = 0\.001 s"),
    ],
)
def test_oscillator_without_a_fitting_section_is_refused(known, sentence):
    with pytest.raises(InputError, match=sentence):
        build_method("oscillator", Setting(PERIOD_S, Fraction(100), 40.0, known))


def test_speed_is_right_through_jitter_gaps_and_unknown_rows():
    time_s = np.array([0.0, 0.1, 0.25, 0.3, 0.4, 1.4, 1.5, 1.5, 1.45, 1.6])
    angle_rad = 7.0 * time_s
    angle_rad[3] = np.nan
    time_s[8] = np.inf
    speeds = BackwardDifference().speeds(time_s, angle_rad)
    unknown = [3, 7, 8]  # no angle, no time since the last row, no time
    assert np.isnan(speeds[unknown]).all()
    assert speeds[0] == 0.0
    np.testing.assert_allclose(np.delete(speeds, [0, *unknown]), 7.0, rtol=1e-12)


def test_speed_before_the_first_angle_is_not_known():
    speeds = BackwardDifference().speeds(np.arange(4.0), np.array([np.nan, np.inf, 1.0, 3.0]))
    np.testing.assert_array_equal(speeds, [np.nan, np.nan, 0.0, 2.0])
    assert len(BackwardDifference().speeds(np.empty(0), np.empty(0))) == 0


def test_angles_beyond_all_reach_are_the_cores_to_flag():
    speeds = BackwardDifference().speeds(np.arange(3.0), np.array([-1e308, 1e308, 0.0]))
    assert speeds[1] == np.inf
