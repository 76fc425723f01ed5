"""Sampling, encoders, tachometer and failures, recovered from the signals."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import strainwave._core as core
from strainwave.errors import ConfigurationError
from strainwave.simulate import (
    Acquisition,
    Encoder,
    Fault,
    FaultKind,
    PiecewiseLinear,
    Sine,
    Tachometer,
    constant_speed,
    godler2000,
    taghirad1999,
)

TURNING = constant_speed(50.0, 0.0)


def turned(acquisition: Acquisition, duration_s: float = 4.0, seed: int = 5, **changes):
    made = godler2000(3).with_changes(acquisition=acquisition, **changes)
    return made.rotate(TURNING, duration_s, seed, Sine(30.0, 1.0))


def test_clean_recording_has_a_row_a_period():
    run = turned(Acquisition())
    np.testing.assert_allclose(run.time_s, np.arange(4000) / 1000.0)
    np.testing.assert_array_equal(run.sequence, np.arange(4000))
    assert run.codes.dtype == np.int32
    assert run.sequence.dtype == np.uint32
    np.testing.assert_allclose(run.truth.motor_angle_rad, 50.0 * run.time_s, rtol=1e-12)


def test_jitter_moves_samples_and_stamps_by_its_deviation():
    run = turned(Acquisition(jitter_s=1e-4, stamp_jitter_s=5e-5), 20.0)
    nominal = np.arange(20_000) / 1000.0
    moved = run.truth.instant_s - nominal
    assert moved.std() == pytest.approx(1e-4, rel=0.03)
    assert (run.time_s - run.truth.instant_s).std() == pytest.approx(5e-5, rel=0.03)
    assert np.abs(moved).max() < 0.5e-3
    assert np.all(np.diff(run.time_s) >= 0)
    assert abs(np.corrcoef(moved[1:], moved[:-1])[0, 1]) < 0.03
    np.testing.assert_allclose(run.truth.motor_angle_rad, 50.0 * run.truth.instant_s, rtol=1e-9)


def test_repeats_keep_everything_of_the_row_before_but_the_stamp():
    run = turned(Acquisition(repeated_share=0.3, noise_V=0.01))
    repeated = np.flatnonzero(np.diff(run.sequence.astype(int)) == 0) + 1
    assert len(repeated) / 4000 == pytest.approx(0.3, abs=0.03)
    np.testing.assert_array_equal(np.flatnonzero(run.truth.repeated), repeated)
    np.testing.assert_array_equal(run.codes[repeated], run.codes[repeated - 1])
    np.testing.assert_array_equal(run.motor_counts[repeated], run.motor_counts[repeated - 1])
    np.testing.assert_array_equal(run.current_A[repeated], run.current_A[repeated - 1])
    assert np.all(np.diff(run.time_s) > 0)


def test_missing_samples_leave_gaps_in_sequence_and_time():
    run = turned(Acquisition(missing_share=0.1))
    assert len(run.time_s) / 4000 == pytest.approx(0.9, abs=0.02)
    np.testing.assert_allclose(run.time_s, run.sequence / 1000.0)
    assert np.diff(run.sequence.astype(int)).max() >= 2


@pytest.mark.parametrize("delay_s", [-0.003, 0.002, 0.010])
def test_delay_of_torque_to_angle_is_found_by_correlation(delay_s):
    run = turned(Acquisition(angle_to_torque_delay_s=delay_s))
    rows = slice(100, 3900)
    angle = run.truth.motor_angle_rad[rows]
    signal = run.volts[rows, 0] - run.volts[rows, 0].mean()
    # A delay d turns the fluctuation's phase by -2 speed d; the true phase is 0 at angle 0.
    lag = np.angle(np.mean(signal * np.exp(-2j * angle)) * 1j)
    assert -lag / (2 * 50.0) == pytest.approx(delay_s, abs=2e-4)
    lags = np.arange(-15, 16)
    undelayed = turned(Acquisition()).volts[:, 0]
    undelayed = undelayed - undelayed.mean()
    likeness = [signal @ undelayed[100 - k : 3900 - k] for k in lags]
    assert lags[int(np.argmax(likeness))] == round(delay_s * 1000)


def test_noise_has_its_deviation_and_is_white():
    quiet, noisy = turned(Acquisition()), turned(Acquisition(noise_V=0.02))
    noise = noisy.volts - quiet.volts
    np.testing.assert_allclose(noise.std(axis=0), 0.02, rtol=0.05)
    power = np.abs(np.fft.rfft(noise[:, 0])) ** 2
    assert power[1:1000].mean() == pytest.approx(power[1000:-1].mean(), rel=0.15)
    assert abs(np.corrcoef(noise[:, 0], noise[:, 1])[0, 1]) < 0.05


@given(angle=st.floats(-1e4, 1e4), counts=st.integers(1, 2**20))
def test_encoder_is_within_one_count(angle, counts):
    encoder = Encoder(counts)
    shown = encoder.angle_rad(encoder.counts(np.array([angle])))[0]
    assert -1e-9 <= angle - shown <= 2 * math.pi / counts + 1e-9


def test_encoders_count_in_their_own_senses():
    made = godler2000(2)
    run = made.rotate(TURNING, 4.0, 1)
    step = 2 * math.pi / 4096
    assert np.abs(run.motor_angle_rad - run.truth.motor_angle_rad + step / 2).max() <= 0.501 * step
    assert run.motor_counts[-1] > 0
    assert run.output_counts[-1] < 0  # circular spline fixed: the output turns against the motor
    ratio = run.truth.output_angle_rad[-1] / run.truth.motor_angle_rad[-1]
    assert ratio == pytest.approx(-1 / 50, rel=1e-3)
    other = godler2000(3).rotate(TURNING, 4.0, 1)
    assert other.truth.output_angle_rad[-1] / other.truth.motor_angle_rad[-1] == pytest.approx(
        1 / 51, rel=1e-3
    )


def test_tachometer_errors_are_found_in_its_reading():
    tachometer = Tachometer(0.02, 0.5, ripple_share=0.01, ripple_order=14.0, noise_rad_s=0.05)
    run = turned(Acquisition(), tachometer=tachometer)
    assert run.motor_speed_rad_s.mean() == pytest.approx(50.0 * 1.02 + 0.5, abs=0.02)
    swing = run.motor_speed_rad_s - run.motor_speed_rad_s.mean()
    line = 2 * abs(np.mean(swing * np.exp(14j * run.truth.motor_angle_rad)))
    assert line == pytest.approx(50.0 * 1.02 * 0.01, rel=0.05)


def test_same_seed_same_run_and_noise_sources_are_independent():
    acquisition = Acquisition(jitter_s=1e-4, repeated_share=0.1, missing_share=0.1, noise_V=0.01)
    first, second = turned(acquisition), turned(acquisition)
    np.testing.assert_array_equal(first.codes, second.codes)
    np.testing.assert_array_equal(first.time_s, second.time_s)
    assert not np.array_equal(first.codes[:3000], turned(acquisition, seed=6).codes[:3000])
    louder = turned(acquisition, tachometer=Tachometer(noise_rad_s=3.0))
    np.testing.assert_array_equal(first.codes, louder.codes)


def failed(kind, **more):
    made = godler2000(3).with_changes(faults=(Fault(kind, 1, 0.5, 1.0, **more),))
    run = made.rotate(TURNING, 1.5, 2, Sine(30.0, 1.0))
    sound = godler2000(3).rotate(TURNING, 1.5, 2, Sine(30.0, 1.0))
    during = (run.time_s >= 0.5) & (run.time_s < 1.0)
    np.testing.assert_array_equal(run.codes[~during], sound.codes[~during])
    np.testing.assert_array_equal(run.codes[:, [0, 2]], sound.codes[:, [0, 2]])
    np.testing.assert_array_equal(run.truth.faulty[:, 1], during)
    assert not run.truth.faulty[:, [0, 2]].any()
    return run.volts[during, 1], sound.volts[during, 1], run


def test_torn_gauge_drives_the_amplifier_to_its_upper_rail():
    volts, _, run = failed("open")
    assert volts.min() > 9.999
    assert np.all(run.converter.is_saturated(np.ascontiguousarray(run.codes[500:1000, 1])))


def test_saturated_amplifier_is_at_its_lower_rail():
    assert failed(FaultKind.SATURATED)[0].max() < -9.999


def test_shorted_leads_leave_noise_about_zero():
    volts, sound, _ = failed("short")
    assert abs(volts.mean()) < 5e-4
    assert volts.std() == pytest.approx(0.001, rel=0.15)
    assert sound.std() > 0.5


def test_stuck_converter_repeats_its_last_code():
    volts, sound, run = failed("stuck")
    assert len(np.unique(volts)) == 1
    assert run.codes[499, 1] == run.codes[700, 1]
    assert len(np.unique(sound)) > 100


def test_detached_gauge_sees_its_share_of_the_strain():
    volts, sound, _ = failed("detached", remaining=0.25)
    assert np.polyfit(sound, volts, 1)[0] == pytest.approx(0.25, abs=0.002)


def test_one_failed_gauge_fails_the_one_channel_of_a_full_bridge():
    made = taghirad1999().with_changes(faults=(Fault("open", 3),))
    run = made.hold(PiecewiseLinear((0.0,), (1.0,)), 0.1, 1)
    assert run.truth.faulty.all()
    assert run.volts.min() > 9.999


@given(
    jitter=st.floats(0, 2.5e-4),
    repeated=st.floats(0, 0.9),
    missing=st.floats(0, 0.9),
    delay=st.floats(-0.1, 0.1),
    noise=st.floats(0, 100),
    seed=st.integers(0, 2**32),
)
def test_recording_is_whole_for_any_valid_acquisition(
    jitter, repeated, missing, delay, noise, seed
):
    acquisition = Acquisition(1000.0, jitter, jitter, repeated, missing, delay, noise)
    run = turned(acquisition, 0.05, seed)
    lowest, highest = run.converter.lowest_code, run.converter.highest_code
    assert run.codes.min() >= lowest
    assert run.codes.max() <= highest
    for quantity in (*vars(run.truth).values(), run.time_s, run.motor_speed_rad_s, run.current_A):
        assert np.all(np.isfinite(quantity))
        assert len(quantity) == len(run.time_s)
    assert np.all(np.diff(run.sequence.astype(int)) >= 0)
    assert np.all(np.diff(run.time_s) >= 0)


@pytest.mark.parametrize(
    ("build", "parameter"),
    [
        (lambda: Acquisition(rate_Hz=0.0), "rate_Hz"),
        (lambda: Acquisition(jitter_s=1.0), "jitter_s"),
        (lambda: Acquisition(repeated_share=1.0), "repeated_share"),
        (lambda: Acquisition(missing_share=math.nan), "missing_share"),
        (lambda: Acquisition(angle_to_torque_delay_s=2.0), "angle_to_torque_delay_s"),
        (lambda: Acquisition(noise_V=-1.0), "noise_V"),
        (lambda: Encoder(0), "counts_per_turn"),
        (lambda: Encoder(4096.0), "counts_per_turn"),
        (lambda: Tachometer(gain_error=2.0), "gain_error"),
        (lambda: Fault("broken", 0), "kind"),
        (lambda: Fault("open", -1), "gauge"),
        (lambda: Fault("open", 0, 2.0, 1.0), "end_s"),
        (lambda: Fault("open", 0, 0.0, math.nan), "end_s"),
        (lambda: Fault("detached", 0, remaining=2.0), "remaining"),
        (lambda: godler2000(3).with_changes(faults=(Fault("open", 3),)), "gauge"),
    ],
)
def test_impossible_acquisition_is_refused_by_name(build, parameter):
    with pytest.raises(ConfigurationError) as caught:
        build()
    assert caught.value.parameter == parameter


def test_codes_are_the_cores_codes():
    run = turned(Acquisition())
    assert isinstance(run.converter, core.Converter)
    codes = run.converter.to_code(np.ascontiguousarray(run.volts[:, 0]))
    np.testing.assert_array_equal(codes, run.codes[:, 0])
