"""What a report is computed from: envelope, flags, order spectrum, order map, lines."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave import StatusFlag, _core
from strainwave.evidence.envelope import EnvelopeTally
from strainwave.evidence.flags import MEANINGS, NOT_USED_BECAUSE, FlagTally
from strainwave.evidence.lines import order_lines
from strainwave.evidence.motion import Motion, rows_in_motion
from strainwave.evidence.spectra import order_map, order_spectrum
from strainwave.methods.interface import Cleaned
from strainwave.samples import Samples

TURN = 2 * np.pi


def motion_of(time_s: np.ndarray, angle_rad: np.ndarray, *torque_Nm: np.ndarray) -> Motion:
    """Give rows with torque before and after; after is half of before where it is not given."""
    before_Nm, after_Nm = (*torque_Nm, 0.5 * torque_Nm[0])[:2]
    cleaned = Cleaned(after_Nm, before_Nm - after_Nm, np.zeros(len(time_s), np.uint32))
    samples = Samples(time_s, angle_rad, before_Nm, np.zeros(len(time_s)))
    return rows_in_motion(samples, time_s, cleaned)


def drive(turns: float = 60.0, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """A motor whose speed swings between 10 and 30 rad/s, rows with jitter around 2 ms."""
    jitter = np.random.default_rng(seed).uniform(0.5, 1.5, int(turns * TURN / 20 / 0.002))
    time_s = 0.002 * np.cumsum(jitter)
    return time_s, 20.0 * time_s + 10.0 / 1.3 * np.sin(1.3 * time_s)


@settings(max_examples=25, deadline=None)
@given(
    order=st.sampled_from([1.0, 2.0, 2.02, 4.0, 5.5, 7.0, 11.0]),
    amplitude_Nm=st.floats(0.01, 100.0),
    phase_rad=st.floats(-3.0, 3.0),
    seed=st.integers(0, 100),
)
def test_spectrum_reads_a_sine_to_one_percent(
    order: float, amplitude_Nm: float, phase_rad: float, seed: int
) -> None:
    time_s, angle_rad = drive(seed=seed)
    # Slow torque of fifty times the line must not be seen where the line is.
    slow_Nm = 50 * amplitude_Nm * np.sin(0.05 * angle_rad / TURN)
    torque_Nm = amplitude_Nm * np.cos(order * angle_rad + phase_rad) + slow_Nm
    spectrum = order_spectrum(motion_of(time_s, angle_rad, torque_Nm))
    assert spectrum is not None
    place = int(np.argmin(np.abs(spectrum.order - order)))
    assert spectrum.before_Nm[place] == pytest.approx(amplitude_Nm, rel=0.01)
    assert spectrum.after_Nm[place] == pytest.approx(0.5 * amplitude_Nm, rel=0.01)
    near = np.abs(spectrum.order - order) < 2.5 / spectrum.window_turns
    far = ~near & (spectrum.order > 0.5)
    assert np.nanmax(spectrum.before_Nm[far]) < 0.05 * amplitude_Nm


def test_gaps_and_repeated_rows_do_not_change_the_spectrum() -> None:
    time_s, angle_rad = drive(turns=200.0)
    torque_Nm = np.cos(2 * angle_rad) + 0.3 * np.cos(4 * angle_rad)
    missing = (time_s > 20.0) & (time_s < 20.4)
    time_s, angle_rad, torque_Nm = (each[~missing] for each in (time_s, angle_rad, torque_Nm))
    whole = order_spectrum(motion_of(time_s, angle_rad, torque_Nm))
    # Three further rows that only repeat each one.
    times = (time_s[:, None] + [0.0, 1e-4, 2e-4, 3e-4]).ravel()
    motion = motion_of(times, np.repeat(angle_rad, 4), np.repeat(torque_Nm, 4))
    held = order_spectrum(motion)
    assert whole is not None
    assert held is not None
    assert whole.windows_with_gaps == held.windows_with_gaps == 1
    for order, amplitude_Nm in ((2.0, 1.0), (4.0, 0.3)):
        place = int(np.argmin(np.abs(whole.order - order)))
        assert whole.before_Nm[place] == pytest.approx(amplitude_Nm, rel=0.01)
        assert held.before_Nm[place] == pytest.approx(amplitude_Nm, rel=0.01)


def test_orders_that_the_rows_are_too_far_apart_for_are_not_shown() -> None:
    time_s = 0.02 * np.arange(3000)
    angle_rad = 40.0 * time_s  # 0.127 turns a row: up to order 3.5
    spectrum = order_spectrum(motion_of(time_s, angle_rad, np.cos(2 * angle_rad)))
    assert spectrum is not None
    known = np.isfinite(spectrum.before_Nm)
    assert spectrum.order[known].max() == pytest.approx(0.45 * TURN / 0.8, abs=0.02)


def test_map_puts_lines_where_they_are() -> None:
    time_s = 0.001 * np.arange(120_000)
    speed = 20.0 + 0.5 * time_s  # to 80 rad/s
    angle_rad = 20.0 * time_s + 0.25 * time_s**2
    fixed_Hz = 12.0
    torque_Nm = 0.8 * np.cos(2 * angle_rad) + 0.4 * np.cos(TURN * fixed_Hz * time_s)
    found = order_map(motion_of(time_s, angle_rad, torque_Nm))
    assert found is not None
    middle = 0.5 * (found.speed_edges_rad_s[1:] + found.speed_edges_rad_s[:-1])
    assert found.speed_edges_rad_s[0] < speed[0] + 1
    assert found.speed_edges_rad_s[-1] > speed[-1] - 1
    assert found.windows.sum() > 150
    second = int(np.argmin(np.abs(found.order - 2.0)))
    apart = np.abs(fixed_Hz * TURN / middle - 2.0) > 0.6
    np.testing.assert_allclose(found.before_Nm[apart, second], 0.8, rtol=0.02)
    np.testing.assert_allclose(found.after_Nm[apart, second], 0.4, rtol=0.02)
    # What belongs to time bends: its order falls with the speed.
    shown = found.before_Nm.copy()
    shown[:, np.abs(found.order - 2.0) < 0.6] = 0.0
    bends = found.order[np.nanargmax(shown, axis=1)]
    np.testing.assert_allclose(bends[apart], (fixed_Hz * TURN / middle)[apart], atol=0.16)


def test_map_of_one_speed_in_two_directions() -> None:
    time_s = 0.002 * np.arange(20_000)
    angle_rad = 30.0 * np.minimum(time_s, 40.0 - time_s)
    found = order_map(motion_of(time_s, angle_rad, np.cos(2 * angle_rad)))
    assert found is not None
    filled = np.flatnonzero(found.windows)
    middle = 0.5 * (found.speed_edges_rad_s[1:] + found.speed_edges_rad_s[:-1])
    np.testing.assert_allclose(middle[filled], [-30.0, 30.0], atol=1.5)


def test_lines_over_time_and_load() -> None:
    time_s, angle_rad = drive(turns=200.0)
    load_Nm = 10.0 * np.sin(0.02 * angle_rad / TURN)
    amplitude_Nm = 1.0 + 0.05 * load_Nm
    before_Nm = load_Nm + amplitude_Nm * np.cos(2 * angle_rad) + 0.2 * np.cos(angle_rad)
    motion = motion_of(time_s, angle_rad, before_Nm, load_Nm + 0.2 * np.cos(angle_rad))
    second, first = sorted(
        order_lines(motion, [2.0, 1 / 160], [1.0], are_told=True), key=lambda each: -each.order
    )
    assert (second.order, second.is_kept, first.order, first.is_kept) == (2.0, False, 1.0, True)
    expected_Nm = 1.0 + 0.05 * second.load_Nm
    np.testing.assert_allclose(second.before_Nm, expected_Nm, rtol=0.02)
    assert second.after_rms_Nm < 1e-3
    assert second.change_dB is not None
    assert second.change_dB < -60
    assert (first.before_rms_Nm, first.after_rms_Nm) == pytest.approx((0.2, 0.2), rel=0.01)
    assert np.all(np.diff(second.time_s) > 0)


def test_nothing_is_said_where_the_motor_hardly_turns() -> None:
    time_s = 0.001 * np.arange(5000)
    angle_rad = 3.0 * np.sin(2.0 * time_s)
    motion = motion_of(time_s, angle_rad, np.cos(2 * angle_rad))
    assert order_spectrum(motion) is None
    assert order_map(motion) is None
    assert order_lines(motion, [2.0], [], are_told=True) == ()


@settings(max_examples=50, deadline=None)
@given(
    rows=st.integers(1, 300),
    most=st.integers(1, 60),
    cuts=st.lists(st.integers(0, 300), max_size=5),
    seed=st.integers(0, 1000),
)
def test_envelope_loses_no_spike_however_it_is_cut(
    rows: int, most: int, cuts: list[int], seed: int
) -> None:
    generator = np.random.default_rng(seed)
    before_Nm, after_Nm = generator.standard_normal((2, rows))
    before_Nm[generator.random(rows) < 0.1] = np.nan
    status = np.where(generator.random(rows) < 0.1, _core.StatusFlag.torque_not_finite.value, 0)
    status[generator.random(rows) < 0.3] = _core.StatusFlag.sample_repeated.value
    cleaned = Cleaned(after_Nm, np.zeros(rows), status.astype(np.uint32))
    tally = EnvelopeTally(rows, most)
    edges = sorted({0, rows, *(cut for cut in cuts if cut < rows)})
    for start, end in pairwise(edges):
        part = Cleaned(*(each[start:end] for each in vars(cleaned).values()))
        tally.take(np.arange(start, end, dtype=float), before_Nm[start:end], part)
    found = tally.finish()
    assert len(found) <= most
    for shown in (found, found.thinned(7)):
        blocks = [
            slice(n * shown.rows_per_point, (n + 1) * shown.rows_per_point)
            for n in range(len(shown))
        ]
        assert blocks[-1].start < rows <= blocks[-1].stop
        for n, block in enumerate(blocks):
            known = before_Nm[block][np.isfinite(before_Nm[block])]
            expected = (known.min(), known.max()) if len(known) else (np.nan, np.nan)
            np.testing.assert_equal(
                (shown.before_lowest_Nm[n], shown.before_highest_Nm[n]), expected
            )
            assert shown.after_lowest_Nm[n] == after_Nm[block].min()
            assert shown.after_highest_Nm[n] == after_Nm[block].max()
            assert shown.time_s[n] == block.start
            assert shown.is_rejected[n] == (status[block] == 1).any()


def test_every_flag_has_its_meaning() -> None:
    assert set(MEANINGS) == {flag.name for flag in StatusFlag}
    faults = {flag.name for flag in StatusFlag if flag.value & _core.FAULT_MASK}
    assert set(NOT_USED_BECAUSE) == faults - {"sample_repeated"}


@settings(max_examples=50, deadline=None)
@given(
    bears=st.lists(st.booleans(), min_size=1, max_size=60),
    cuts=st.lists(st.integers(0, 60), max_size=5),
)
def test_stretches_of_flags_go_on_across_chunks(bears: list[bool], cuts: list[int]) -> None:
    status = np.where(bears, StatusFlag.at_rest.value, 0).astype(np.uint32)
    tally = FlagTally()
    edges = sorted({0, len(bears), *(cut for cut in cuts if cut < len(bears))})
    for start, end in pairwise(edges):
        tally.take(np.arange(start, end, dtype=float), status[start:end])
    starts = [n for n, each in enumerate(bears) if each and (n == 0 or not bears[n - 1])]
    found = tally.finish()
    if not starts:
        assert found == ()
        return
    (flagged,) = found
    assert (flagged.name, flagged.kind, flagged.rows) == ("at_rest", "remark", sum(bears))
    assert [each.first_row for each in flagged.stretches] == [n + 1 for n in starts[:5]]
    for stretch in flagged.stretches:
        assert all(bears[stretch.first_row - 1 : stretch.last_row])
        assert stretch.last_row == len(bears) or not bears[stretch.last_row]
        assert stretch.first_time_s == stretch.first_row - 1
