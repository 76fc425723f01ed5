"""The ripple filter at standstill, through reversals and from rest to speed."""

import numpy as np
import pytest

from helpers.ripple_runs import (
    FS_Nm,
    NOISE_Nm,
    angle_of,
    configured,
    drive_and_stop,
    flattened,
    has,
    walk,
)
from strainwave import (
    RippleFilter,
    RippleOrder,
    StatusFlag,
)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("dither", [False, True])
def test_contact_at_standstill_passes_bit_by_bit(dither, dtype):
    orders = [2, RippleOrder(4, with_speed=True, with_direction=True)]
    config = configured(orders=orders)
    ripples, states = [], []
    for contact_Nm in (0.0, 10.0):
        time, angle, torque, _ = drive_and_stop(contact_Nm, 0.0, encoder_counts=4096, dither=dither)
        y = torque + 1.6 * np.cos(2 * angle) + 0.6 * np.sin(4 * angle)
        ours = RippleFilter(config, dtype=dtype)
        result = ours.process(time, angle, y.astype(dtype))
        ripples.append(result.ripple_Nm)
        states.append(ours.state()[0][1:])
        rest = (time > 20.5) & (time < 23)
        assert has(result.status[rest], StatusFlag.at_rest).all()
        if not dither:
            # |speed| and direction are still fading in the first tenths of a second
            assert np.ptp(result.ripple_Nm[(time > 20.9) & (time < 23)]) == pytest.approx(
                0.0, abs=1e-6
            )
    assert ripples[0].tobytes() == ripples[1].tobytes()
    np.testing.assert_array_equal(states[0], states[1])
    assert 0.1 < np.abs(ripples[0]).max() < 3


def test_contact_at_standstill_with_load_terms_is_within_a_thousandth():
    orders = [RippleOrder(2, with_load=True), RippleOrder(4, with_load=True)]
    config = configured(orders=orders, rated_torque_Nm=FS_Nm)
    time, angle, torque, contact = drive_and_stop(10.0, 0.0)
    smooth = 8 * np.sin(0.9 * time) * (time < 19.5) + contact
    y = torque + (1.6 + 0.8 * flattened(smooth)) * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    result = RippleFilter(config).process(time, angle, y)
    error = result.torque_Nm - torque
    settled = (time > 21.1) & (time < 22)  # the load is low-passed at 15 Hz
    before = (time > 20.5) & (time < 21)
    assert abs(error[settled].mean() - error[before].mean()) < 1e-3 * FS_Nm
    # Without load terms it would be 0.16 Nm times the cosine, which must not be near 0 here.
    cosine = np.cos(2 * angle[before][0] + 0.3)
    assert abs(0.8 * flattened(10.0) * cosine) > 1e-3 * FS_Nm


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_no_bump_from_standstill_to_speed(dtype):
    config = configured(orders=[2, 4])
    time, angle, torque, _ = drive_and_stop(10.0, 100.0)
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    result = RippleFilter(config, dtype=dtype).process(time, angle, (torque + ripple).astype(dtype))
    error = result.ripple_Nm - ripple

    def rms(begin, end):
        return np.sqrt(np.mean(error[(time >= begin) & (time < end)] ** 2))

    assert rms(23.0, 23.5) < 2 * rms(15.0, 19.0)
    assert np.abs(error[(time >= 23) & (time < 23.5)]).max() < 0.03
    assert 1e-4 < rms(15.0, 19.0) < 0.02


def test_reversal_leaves_no_ripple():
    rng = np.random.default_rng(8)
    time = np.arange(40000) * 1e-3
    angle = angle_of(100 * np.sin(1.5 * time), time)
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    torque = walk(rng, len(time), 1e-3, 0.3) + NOISE_Nm * rng.standard_normal(len(time))
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, torque + ripple)
    late = time > 20
    rms = np.sqrt(np.mean((result.ripple_Nm - ripple)[late] ** 2))
    assert 1e-3 < rms < 0.02
