"""The tracking notch as a method: scipy's notches at constant speed, nothing at standstill."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.signal import iirnotch, lfilter

from helpers.joint_sections import OSCILLATOR, PROVENANCE
from strainwave import ConfigurationError, InputError, StatusFlag, _core
from strainwave.joint import Joint
from strainwave.methods.notch import Notch
from strainwave.methods.registry import Setting, build_method
from strainwave.samples import Samples

RATE_HZ = 1000.0
SETTING = Setting(1.0 / RATE_HZ, Fraction(100), 40.0)


def recording(speed_rad_s, torque_Nm):
    rows = len(torque_Nm)
    time_s = np.arange(rows) / RATE_HZ
    return Samples(time_s, np.broadcast_to(speed_rad_s, rows) * time_s, torque_Nm, np.zeros(rows))


def noise(rows=5000, seed=2):
    torque_Nm = 3.0 + np.random.default_rng(seed).standard_normal(rows)
    torque_Nm[0] = 0.0  # the speed is known from the second row on
    return torque_Nm


def scipy_notches(torque_Nm, speed_rad_s, orders, bandwidth_Hz):
    for order in orders:
        centre_Hz = float(order) * abs(speed_rad_s) / (2 * np.pi)
        torque_Nm = lfilter(*iirnotch(centre_Hz, centre_Hz / bandwidth_Hz, fs=RATE_HZ), torque_Nm)
    return torque_Nm


@pytest.mark.parametrize("bandwidth_Hz", [0.3, 1.0, 8.0])
@pytest.mark.parametrize("speed_rad_s", [80.0, -80.0, 333.3, 700.0])
def test_constant_speed_is_scipys_notches_in_series(speed_rad_s, bandwidth_Hz):
    torque_Nm = noise()
    cleaned = Notch(SETTING, bandwidth_Hz).process(recording(speed_rad_s, torque_Nm))
    expected_Nm = scipy_notches(torque_Nm, speed_rad_s, (2, 4), bandwidth_Hz)
    np.testing.assert_allclose(cleaned.torque_Nm, expected_Nm, atol=1e-6)
    np.testing.assert_allclose(cleaned.torque_Nm + cleaned.ripple_Nm, torque_Nm, atol=1e-12)
    assert not cleaned.status.any()


def test_orders_are_the_joint_files_where_it_has_some():
    section = {**OSCILLATOR, "orders": [1, "7/2"], "provenance": PROVENANCE}
    joint = Joint.model_validate({"joint": {"name": "elbow"}, "ripple_filter": section})
    notch = build_method("notch", Setting(1.0 / RATE_HZ, None, 40.0, joint))
    torque_Nm = noise()
    np.testing.assert_allclose(
        notch.process(recording(150.0, torque_Nm)).torque_Nm,
        scipy_notches(torque_Nm, 150.0, (1, 3.5), 1.0),
        atol=1e-6,
    )


def test_orders_are_the_wave_generators_where_no_oscillators_are_tuned():
    # Fixed circular spline, ratio 100: it turns 1.01 times a motor turn relative to the flexspline.
    setting = Setting(1.0 / RATE_HZ, None, 40.0, wave_factor=Fraction(101, 100))
    torque_Nm = noise()
    np.testing.assert_allclose(
        build_method("notch", setting).process(recording(150.0, torque_Nm)).torque_Nm,
        scipy_notches(torque_Nm, 150.0, (2.02, 4.04), 1.0),
        atol=1e-6,
    )


def test_ripple_goes_at_any_speed_and_true_torque_at_rest_stays():
    time_s = np.arange(12_000) / RATE_HZ
    speed_rad_s = np.where(time_s < 6.0, 60.0 + 20.0 * np.sin(time_s), 0.0)
    angle_rad = np.cumsum(speed_rad_s) / RATE_HZ
    ripple_Nm = np.cos(2 * angle_rad) + 0.5 * np.sin(4 * angle_rad + 1.0)
    contact_Nm = np.where(time_s > 8.0, 10.0, 0.0)
    cleaned = build_method("notch", SETTING).process(
        Samples(time_s, angle_rad, ripple_Nm + contact_Nm, np.zeros(len(time_s)))
    )
    moving = (time_s > 3.0) & (time_s < 6.0)
    assert np.std(cleaned.torque_Nm[moving]) < 0.01
    resting = time_s > 6.5
    np.testing.assert_array_equal(cleaned.ripple_Nm[resting], 0.0)
    np.testing.assert_array_equal(cleaned.torque_Nm[resting], (ripple_Nm + contact_Nm)[resting])


def test_time_stamps_do_not_move_the_notch():
    torque_Nm = noise()
    even = recording(80.0, torque_Nm)
    jitter_s = 3e-4 * np.random.default_rng(1).random(len(torque_Nm))
    uneven = Samples(
        even.time_s + jitter_s, even.motor_angle_rad, torque_Nm, even.expected_torque_Nm
    )
    np.testing.assert_array_equal(
        Notch(SETTING).process(uneven).torque_Nm, Notch(SETTING).process(even).torque_Nm
    )


def test_above_nyquist_the_order_is_left_alone_and_flagged():
    torque_Nm = noise()
    cleaned = Notch(SETTING).process(recording(900.0, torque_Nm))  # order 4: 3.6 rad a row
    assert (cleaned.status[1:] == StatusFlag.order_above_nyquist.value).all()
    expected_Nm = scipy_notches(torque_Nm, 900.0, (2,), 1.0)
    np.testing.assert_allclose(cleaned.torque_Nm, expected_Nm, atol=1e-6)


@pytest.mark.parametrize("bandwidth_Hz", [0.0, -1.0, 126.0, float("nan"), 5e-4])
def test_an_unusable_bandwidth_is_refused(bandwidth_Hz):
    with pytest.raises(ConfigurationError, match="bandwidth_Hz = "):
        Notch(SETTING, bandwidth_Hz)


def test_the_core_refuses_orders_and_arrays_that_do_not_fit():
    with pytest.raises(InputError, match="orders has 0 elements"):
        _core.TrackingNotch(orders=[], sample_period_s=1e-3)
    with pytest.raises(InputError, match="orders has 33 elements"):
        _core.TrackingNotch(orders=list(range(1, 34)), sample_period_s=1e-3)
    with pytest.raises(InputError, match="orders"):
        _core.TrackingNotch(orders=[2, 2], sample_period_s=1e-3)
    with pytest.raises(InputError, match="orders"):
        _core.TrackingNotch(orders=[-2], sample_period_s=1e-3)
    notch = _core.TrackingNotch(orders=[2], sample_period_s=1e-3)
    with pytest.raises(InputError, match="motor_angle_rad has 2 elements: expected 3"):
        notch.process(np.zeros(3), np.zeros(2))


def test_kept_orders_pass():
    section = {
        "method": "ripple",
        "orders": [2, 4],
        "kept_orders": [4],
        "memory_turns": 10.0,
        "torque_noise_Nm": 0.04,
        "torque_walk_Nm_per_sqrt_s": 1.0,
        "provenance": PROVENANCE,
    }
    parts = {"joint": {"name": "elbow"}, "ripple_filter": section}
    torque_Nm = noise()

    def cleaned():
        setting = Setting(1.0 / RATE_HZ, None, 40.0, Joint.model_validate(parts))
        return build_method("notch", setting).process(recording(150.0, torque_Nm)).torque_Nm

    expected_Nm = scipy_notches(torque_Nm, 150.0, (2,), 1.0)
    np.testing.assert_allclose(cleaned(), expected_Nm, atol=1e-6)
    section["kept_orders"] = [2, 4]
    with pytest.raises(InputError, match="every order is in kept_orders"):
        cleaned()
