"""Methods in time chunks against the same methods in sequence."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from strainwave import OscillatorFilterConfig, RippleFilterConfig, RippleOrder, RotationSource
from strainwave.identify.ripple_settings import RippleSettings, Terms
from strainwave.methods.published import Published
from strainwave.methods.registry import Setting, build_method
from strainwave.methods.time_chunks import in_time_chunks
from strainwave.samples import Samples

PIECE = 60_000


def _samples(rows: int) -> Samples:
    random = np.random.default_rng(77)
    time_s = 1e-3 * np.arange(rows)
    angle_rad = np.cumsum(1e-3 * (70.0 + 60.0 * np.sin(0.9 * time_s)))
    load_Nm = 6.0 * np.sin(2.1 * time_s)
    ripple_Nm = 2.0 * np.cos(2 * angle_rad + 0.3) + 0.7 * np.sin(4 * angle_rad)
    torque_Nm = load_Nm + ripple_Nm + 0.04 * random.standard_normal(rows)
    return Samples(time_s, angle_rad, torque_Nm, np.zeros(rows))


def _part(samples: Samples, rows: slice) -> Samples:
    return Samples(
        samples.time_s[rows],
        samples.motor_angle_rad[rows],
        samples.torque_Nm[rows],
        samples.expected_torque_Nm[rows],
    )


def _setting(samples: Samples) -> Setting:
    config = RippleFilterConfig(orders=[2, 4, 6], memory_turns=4.0, torque_noise_Nm=0.04)
    settings = RippleSettings(config, Terms(), is_chosen=False)
    excerpt = _part(samples, slice(20_000))
    return Setting(1e-3, Fraction(100), 40.0, excerpt=excerpt, ripple_settings=settings)


@pytest.mark.parametrize("name", ["ripple", "taghirad1999-4"])
def test_pieces_in_chunks_are_as_in_sequence(name: str) -> None:
    samples = _samples(3 * PIECE)
    setting = _setting(samples)
    sequence = build_method(name, setting).process(samples)
    chunked = in_time_chunks(build_method(name, setting))
    assert chunked is not None
    pieces = [
        chunked.process(_part(samples, slice(start, start + PIECE)))
        for start in range(0, 3 * PIECE, PIECE)
    ]
    assert len(chunked.finish()) == 0
    torque_Nm = np.concatenate([piece.torque_Nm for piece in pieces])
    difference_Nm = torque_Nm - sequence.torque_Nm
    # It was computed otherwise, and comes out the same.
    assert 0.0 < math.sqrt(np.mean(difference_Nm**2)) < 1e-4
    np.testing.assert_array_equal(
        np.concatenate([piece.status for piece in pieces]), sequence.status
    )
    ripple_Nm = np.concatenate([piece.ripple_Nm for piece in pieces])
    np.testing.assert_allclose(ripple_Nm, sequence.ripple_Nm, atol=1e-2)
    chunks = chunked.time_chunks
    assert chunks.count > 9
    assert 0 < chunks.warm_up_rows < 3 * PIECE
    assert 0.0 < chunks.rms_difference_Nm <= chunks.largest_difference_Nm < 1e-4
    # The first chunk begins as the sequence does, with what was learned at the start.
    np.testing.assert_allclose(torque_Nm[:500], sequence.torque_Nm[:500], atol=1e-9)


def test_a_memory_that_leaves_no_room_goes_in_sequence() -> None:
    samples = _samples(5_000)
    setting = _setting(samples)
    sequence = build_method("ripple", setting).process(samples)
    chunked = in_time_chunks(build_method("ripple", setting))
    assert chunked is not None
    piece = chunked.process(samples)
    np.testing.assert_array_equal(piece.torque_Nm, sequence.torque_Nm)
    assert chunked.time_chunks.count == 1
    assert chunked.time_chunks.warm_up_rows == 0
    assert chunked.time_chunks.rms_difference_Nm == 0.0


def test_what_has_no_lanes_is_left_as_it_is() -> None:
    setting = Setting(1e-3, Fraction(100), 40.0)
    for name in ("smoother", "notch", "low-pass"):
        assert in_time_chunks(build_method(name, setting)) is None
    by_angle = OscillatorFilterConfig(
        orders=[2],
        process_noise_variance_Nm2=1e-3,
        measurement_noise_variance_Nm2=1.0,
        initial_variance_Nm2=1.0,
        sample_period_s=1e-3,
        rotation_source=RotationSource.angle,
    )
    assert in_time_chunks(Published(by_angle)) is None


@pytest.mark.parametrize(("orders", "fits"), [(5, True), (6, False)])
def test_more_pairs_than_lanes_have_room_for(orders: int, fits: bool) -> None:
    config = RippleFilterConfig(
        orders=[RippleOrder(order, with_load=True) for order in range(2, 2 + orders)]
    )
    settings = RippleSettings(config, Terms(load=True), is_chosen=False)
    method = build_method("ripple", Setting(1e-3, None, 40.0, ripple_settings=settings))
    assert (in_time_chunks(method) is not None) == fits
