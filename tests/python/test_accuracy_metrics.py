"""The accuracy bench's figures against closed forms, from both sides."""

import numpy as np
import pytest

from benchmarks.accuracy import kuka, pass_through
from benchmarks.accuracy.joint import make_joint
from benchmarks.accuracy.methods.catalogue import BY_NAME
from benchmarks.accuracy.methods.interface import Method, Removal
from benchmarks.accuracy.metrics import (
    attenuation_dB,
    error_by_phase,
    even_windows,
    line_powers,
    power_change_outside_dB,
)
from benchmarks.accuracy.recordings import JointRecording, counted_once
from benchmarks.accuracy.ripple import RIGHT
from benchmarks.accuracy.table import kuka_choice
from benchmarks.accuracy.targets import Target


def scaled(log, setting, *, gain=1.0, delay_samples=0):
    torque = gain * np.concatenate(
        [
            np.full(delay_samples, log.torque_Nm[0]),
            log.torque_Nm[: len(log.torque_Nm) - delay_samples],
        ]
    )
    return Removal(torque, log.torque_Nm - torque)


@pytest.fixture
def scaling(monkeypatch):
    monkeypatch.setitem(BY_NAME, "scaled", Method("scaled", scaled))
    return "scaled"


def test_error_of_a_phase_is_its_rms_in_percent():
    phase = np.array(["a"] * 100 + ["b"] * 300)
    error = np.concatenate([np.full(100, 0.4), 0.8 * np.tile([1.0, -1.0], 150)])
    found = error_by_phase(error, phase, ("a", "b"), 40.0)
    assert found == pytest.approx({"a": 1.0, "b": 2.0, "mean": 1.5})


def test_attenuation_of_a_known_share():
    angle = np.linspace(0, 300, 10_000)
    slow = np.linspace(-1, 1, 10_000) ** 2 * 5
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    windows = even_windows(0, 10_000, 2000)
    before = line_powers(ripple + slow, angle, (2, 4), windows, 2)
    np.testing.assert_allclose(np.sqrt(before), [1.6, 0.6], rtol=1e-9)
    after = line_powers(
        0.16 * np.cos(2 * angle) + 0.3 * np.cos(4 * angle), angle, (2, 4), windows, 2
    )
    np.testing.assert_allclose(attenuation_dB(before, after), [20.0, 20 * np.log10(2)], rtol=1e-6)
    assert attenuation_dB(before, np.zeros(2)) == pytest.approx([200.0, 200.0])


def test_windows_are_averaged_in_power():
    angle = np.linspace(0, 200, 2000)
    ripple = np.where(np.arange(2000) < 1000, 1.0, 3.0) * np.cos(2 * angle)
    found = line_powers(ripple, angle, (2,), even_windows(0, 2000, 1000), 1)
    assert found[0] == pytest.approx((1 + 9) / 2, rel=1e-3)


def test_even_windows_leave_out_the_rest():
    assert even_windows(3, 20, 8) == [slice(3, 11), slice(11, 19)]


def test_power_beside_the_lines():
    time_s = np.arange(10_000) / 1000
    noise = np.random.default_rng(1).standard_normal(10_000)
    ripple = 50 * np.cos(2 * np.pi * 50 * time_s)
    given = {"sample_rate_Hz": 1000.0, "turn_Hz": 25.0, "orders": (2, 4)}
    # A line that goes does not count; all else counts.
    total, worst = power_change_outside_dB(noise + ripple, noise, **given)
    assert abs(total) < 0.01
    assert abs(worst) < 0.05
    total, worst = power_change_outside_dB(noise + ripple, 0.5 * noise, **given)
    assert total == pytest.approx(-6.02, abs=0.02)
    assert worst == pytest.approx(-6.02, abs=0.1)
    added = np.cos(2 * np.pi * 160 * time_s)
    total, worst = power_change_outside_dB(noise, noise + 3 * added, **given)
    assert 2 < total < 10
    assert worst > 15


@pytest.mark.parametrize("delay_samples", [0, 1, 7])
def test_gain_and_delay_of_a_known_filter(scaling, delay_samples):
    tuning = {"gain": 0.97, "delay_samples": delay_samples}
    gain, delay_ms = pass_through.pass_through(scaling, tuning, make_joint(RIGHT, 2))
    np.testing.assert_allclose(gain, 0.97, rtol=2e-4)
    # The converter's steps, which a delayed signal does not share with the other, are about 0.01 ms.
    np.testing.assert_allclose(delay_ms, delay_samples, atol=2e-2 if delay_samples else 1e-9)


def test_where_nothing_passes_there_is_no_delay(scaling):
    gain, delay_ms = pass_through.pass_through(scaling, {"gain": 1e-4}, make_joint(RIGHT, 2))
    np.testing.assert_allclose(gain, 1e-4, rtol=1e-2)
    assert np.all(np.isnan(delay_ms))


def test_a_contact_that_is_taken_for_ripple_is_found(scaling):
    found = pass_through.fidelity(scaling, {"gain": 0.9})
    # A tenth of 10 Nm of 40 Nm; its mesh adds a tenth of the ripple's growth at most.
    assert found.injected_error_percent == pytest.approx(2.5, abs=0.02)
    assert 2.3 < found.contact_error_percent < 2.8
    assert not found.bit_exact
    untouched = pass_through.fidelity("raw", {})
    assert untouched.injected_error_percent == 0
    assert untouched.bit_exact
    # The ripple's own growth under 10 Nm is an error of raw torque.
    assert 0.0 < untouched.contact_error_percent < 1.0


def med7_like():
    time_s = np.arange(0, 30, 0.01)
    angle = 160 * 0.2 * time_s
    random = np.random.default_rng(2)
    torque = 5 + 0.1 * time_s + 0.9 * np.cos(2 * angle) + 0.004 * random.standard_normal(3000)
    return JointRecording(time_s, angle, torque, 160.0)


def test_injected_error_and_attenuation_on_a_made_up_med7():
    found = kuka.score_on_kuka(Method("scaled", scaled), {"gain": 0.95}, med7_like(), 1)
    assert found.attenuation_dB[0] == pytest.approx(-20 * np.log10(0.95), rel=1e-6)
    assert found.injection_error_percent == pytest.approx(5.0, rel=1e-6)
    assert found.outside_dB == pytest.approx(20 * np.log10(0.95), rel=1e-3)


def test_the_injected_torque_is_a_step_and_a_sine():
    time_s = np.arange(0, 30, 0.001)
    torque = kuka.injected_torque_Nm(time_s)
    assert np.all(torque[(time_s < 24) | ((time_s >= 26) & (time_s < 27)) | (time_s >= 29)] == 0)
    assert np.all(torque[(time_s >= 24) & (time_s < 26)] == 3)
    sine = torque[(time_s >= 27) & (time_s < 29)]
    assert np.max(np.abs(sine)) == pytest.approx(2.0, rel=1e-4)
    assert np.sum(np.diff(np.sign(sine)) != 0) in {11, 12, 13}


def test_noise_at_rest_is_found():
    like = med7_like()
    quiet = np.random.default_rng(3).normal(0.0, 0.02, len(like.time_s))
    recording = JointRecording(like.time_s, like.motor_angle_rad, quiet, like.ratio)
    setting = kuka.setting_of(recording, 176.0)
    assert setting.torque_noise_Nm == pytest.approx(0.02, rel=0.1)
    assert setting.sample_period_s == pytest.approx(0.01)


def test_rows_that_repeat_are_counted_once():
    angle = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 2.0])
    torque = np.array([5.0, 5.0, 5.0, 6.0, 6.0, 6.0])
    once = counted_once(JointRecording(np.arange(6.0), angle, torque, 1.0))
    np.testing.assert_array_equal(once.time_s, [0, 2, 3, 5])


def test_targets_have_two_sides():
    assert Target("error", 0.10, 0.11, at_least=False).met
    assert not Target("error", 0.12, 0.11, at_least=False).met
    assert Target("down", 56.0, 55.0, at_least=True).met
    assert not Target("down", 54.0, 55.0, at_least=True).met


def test_the_med7_shows_the_strongest_gentle_tuning():
    def one(tuning, dB, percent):
        return {
            "method": "m",
            "tuning": tuning,
            "joint": 1,
            "attenuation_dB": [dB, 0.0],
            "injection_error_percent": percent,
        }

    scores = [one("weak", 5.0, 1.0), one("good", 15.0, 8.0), one("wild", 30.0, 50.0)]
    assert kuka_choice(scores, "m") == [scores[1]]
    assert kuka_choice(scores[2:], "m") == [scores[2]]
    assert kuka_choice(scores, "other") is None
