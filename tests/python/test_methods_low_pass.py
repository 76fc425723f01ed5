"""The low-pass method against Butterworth's closed form."""

import numpy as np
import pytest

from strainwave import InputError, StatusFlag
from strainwave.methods.registry import Setting, build_method
from strainwave.samples import Samples

RATE_HZ = 1000.0
CORNER_HZ = 30.0


def samples(torque_Nm, rate_Hz=RATE_HZ):
    rows = len(torque_Nm)
    return Samples(
        np.arange(rows) / rate_Hz, np.zeros(rows), np.asarray(torque_Nm, float), np.zeros(rows)
    )


def low_pass(rate_Hz=RATE_HZ):
    return build_method("low-pass", Setting(1.0 / rate_Hz, None, 40.0))


def impulse_response(rate_Hz, rows=6000):
    torque_Nm = np.zeros(rows)
    torque_Nm[1] = 1.0  # the first row sets the start
    return low_pass(rate_Hz).process(samples(torque_Nm, rate_Hz)).torque_Nm[1:]


def response(frequency_Hz, rate_Hz=RATE_HZ):
    h = impulse_response(rate_Hz)
    return np.sum(h * np.exp(-2j * np.pi * frequency_Hz / rate_Hz * np.arange(len(h))))


@pytest.mark.parametrize("rate_Hz", [120.0, 400.0, 1000.0, 4000.0])
def test_gain_at_the_corner_is_half_the_power(rate_Hz):
    gain_dB = 20 * np.log10(abs(response(CORNER_HZ, rate_Hz)))
    assert gain_dB == pytest.approx(-3.0103, abs=1e-3)


@pytest.mark.parametrize("frequency_Hz", [0.0, 1.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0])
def test_response_is_butterworths(frequency_Hz):
    # Poles at equal angles on a circle; the bilinear transform takes the corner where it belongs.
    corner = np.tan(np.pi * CORNER_HZ / RATE_HZ)
    s = 1j * np.tan(np.pi * frequency_Hz / RATE_HZ) / corner
    damping = [2 * np.sin(np.pi / 8), 2 * np.sin(3 * np.pi / 8)]
    expected = 1.0 / np.prod([s**2 + d * s + 1 for d in damping])
    assert abs(response(frequency_Hz) - expected) < 1e-9


def test_a_ramp_comes_late_by_the_delay_at_0_hz():
    # Sum of the dampings over the corner's angular frequency: 13.8 ms.
    slope_Nm_per_s = 20.0
    torque_Nm = slope_Nm_per_s * np.arange(1000) / RATE_HZ
    cleaned = low_pass().process(samples(torque_Nm))
    delay_s = (torque_Nm[-1] - cleaned.torque_Nm[-1]) / slope_Nm_per_s
    warped_rad_s = 2 * RATE_HZ * np.tan(np.pi * CORNER_HZ / RATE_HZ)
    expected_s = 2 * (np.sin(np.pi / 8) + np.sin(3 * np.pi / 8)) / warped_rad_s
    assert delay_s == pytest.approx(expected_s, rel=1e-9)
    assert expected_s == pytest.approx(13.8e-3, abs=0.1e-3)


def test_starts_at_the_first_usable_torque_without_a_transient():
    cleaned = low_pass().process(samples([np.nan, np.nan] + 500 * [17.3]))
    np.testing.assert_array_equal(cleaned.torque_Nm[:2], 0.0)
    np.testing.assert_allclose(cleaned.torque_Nm[2:], 17.3, rtol=1e-12)
    np.testing.assert_allclose(cleaned.ripple_Nm, 0.0, atol=1e-11)


def test_unusable_rows_hold_while_the_filter_goes_on():
    torque_Nm = np.sin(np.arange(400) * 0.05)
    held = torque_Nm.copy()
    held[200:220] = torque_Nm[199]
    torque_Nm[200:220:2] = np.nan
    torque_Nm[201:220:2] = -np.inf
    cleaned = low_pass().process(samples(torque_Nm))
    reference = low_pass().process(samples(held))
    np.testing.assert_array_equal(cleaned.torque_Nm[220:], reference.torque_Nm[220:])
    np.testing.assert_array_equal(cleaned.torque_Nm[200:220], cleaned.torque_Nm[199])
    np.testing.assert_array_equal(cleaned.ripple_Nm[200:220], cleaned.ripple_Nm[199])
    bit = StatusFlag.torque_not_finite.value
    np.testing.assert_array_equal(cleaned.status[200:220], bit)
    assert (cleaned.status == bit).sum() == 20


def test_a_recording_sampled_too_slowly_is_refused_and_the_corner_never_moved():
    low_pass(120.0)
    with pytest.raises(InputError, match=r"119 samples a second: expected at least 120"):
        low_pass(119.0)


def test_a_recording_without_any_torque_is_all_flags():
    cleaned = low_pass().process(samples(5 * [np.nan]))
    np.testing.assert_array_equal(cleaned.torque_Nm, 0.0)
    assert (cleaned.status != 0).all()
