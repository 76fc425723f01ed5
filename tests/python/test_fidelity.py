"""Measured fidelity against linear theory: the stationary Kalman gain and its transfer function."""

import numpy as np
import pytest
from scipy import linalg, signal

from strainwave import InputError, OscillatorFilter, OscillatorFilterConfig, oscillator_preset
from strainwave.fidelity import contact_step, pass_through
from strainwave.reproduce.tuning import removes_ripple

SPEED_RAD_S = 156.0
PERIOD_S = 1e-3


def theory(orders: list[float], process_noise: float, frequencies_Hz: np.ndarray) -> np.ndarray:
    """Output over true torque from the algebraic Riccati equation, by SciPy."""
    blocks = []
    for order in orders:
        turn = order * SPEED_RAD_S * PERIOD_S
        blocks.append([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    transition = linalg.block_diag(*blocks)
    output = np.tile([1.0, 0.0], len(orders))[np.newaxis]
    states = 2 * len(orders)
    covariance = linalg.solve_discrete_are(
        transition.T, output.T, process_noise * np.eye(states), np.eye(1)
    )
    gain = transition @ covariance @ output.T / (1 + output @ covariance @ output.T)
    _, response = signal.dfreqresp(
        signal.StateSpace(transition - gain @ output, gain, -output, [[1.0]], dt=PERIOD_S),
        w=2 * np.pi * frequencies_Hz * PERIOD_S,
    )
    return np.asarray(response)


@pytest.mark.parametrize(
    ("preset", "orders"), [("taghirad1999-4", [2, 4]), ("taghirad1999", [2, 4, 0.01])]
)
def test_pass_through_of_the_published_tuning_is_that_of_theory(
    preset: str, orders: list[float]
) -> None:
    frequencies = np.array([1.0, 5.0, 20.0, 70.0])
    measured = pass_through(
        removes_ripple(lambda: oscillator_preset(preset, 100)),
        frequencies,
        motor_speed_rad_s=SPEED_RAD_S,
    )
    expected = theory(orders, 1e3, frequencies)
    assert measured.gain == pytest.approx(np.abs(expected), rel=1e-3)
    above, below = (
        theory(orders, 1e3, 1.005 * frequencies),
        theory(orders, 1e3, 0.995 * frequencies),
    )
    delay = -np.angle(above / below) / (2 * np.pi * 0.01 * frequencies)
    assert measured.delay_s == pytest.approx(delay, rel=1e-2)


def test_figures_of_the_published_tuning() -> None:
    four = pass_through(
        removes_ripple(lambda: oscillator_preset("taghirad1999-4")),
        [1.0, 5.0],
        motor_speed_rad_s=SPEED_RAD_S,
    )
    six = pass_through(
        removes_ripple(lambda: oscillator_preset("taghirad1999", 100)),
        [1.0, 5.0],
        motor_speed_rad_s=SPEED_RAD_S,
    )
    assert four.gain_dB[0] == pytest.approx(-5.5, abs=0.1)
    assert four.delay_s[1] == pytest.approx(4.4e-3, abs=0.1e-3)
    assert six.gain_dB[0] == pytest.approx(-37, abs=0.6)
    assert six.delay_s[1] == pytest.approx(7.8e-3, abs=0.1e-3)


def test_contact_is_swallowed_by_the_published_tuning() -> None:
    response = contact_step(
        removes_ripple(lambda: oscillator_preset("taghirad1999", 100)),
        motor_speed_rad_s=SPEED_RAD_S,
    )
    assert response.at(0.02) == pytest.approx(-0.29, abs=0.02)


@pytest.mark.parametrize(("ratio", "width_Hz"), [(1e-6, 0.226), (1e-4, 2.2)])
def test_notch_width_for_small_process_noise(ratio: float, width_Hz: float) -> None:
    # sqrt(q/(2R))/(pi Ts): where the gain about order 2 passes -3 dB on either side.
    config = OscillatorFilterConfig(orders=[2], process_noise_variance_Nm2=ratio)
    centre_Hz = 2 * SPEED_RAD_S / (2 * np.pi)
    offsets = np.linspace(0.2, 1.2, 41) * width_Hz / 2
    measured = pass_through(
        removes_ripple(lambda: config),
        centre_Hz + offsets,
        motor_speed_rad_s=SPEED_RAD_S,
        settling_s=12.0,
    )
    half = np.interp(np.sqrt(0.5), measured.gain, offsets)
    assert 2 * half == pytest.approx(width_Hz, rel=0.08)


def test_a_filter_that_does_nothing_is_untouched() -> None:
    measured = pass_through(lambda torque, _: torque, [0.5, 7.0, 200.0], motor_speed_rad_s=10.0)
    assert measured.gain == pytest.approx(1.0, abs=1e-9)
    assert measured.delay_s == pytest.approx(0.0, abs=1e-9)


def test_a_delay_is_measured() -> None:
    def three_samples_late(torque, _speed):
        return np.concatenate([np.zeros(3), torque[:-3]])

    measured = pass_through(three_samples_late, [0.5, 7.0, 100.0], motor_speed_rad_s=10.0)
    assert measured.gain == pytest.approx(1.0, abs=1e-6)
    assert measured.delay_s == pytest.approx(3e-3, rel=1e-6)


def untouched(torque, _speed):
    return torque


def test_contact_without_time_before_it_starts_with_the_contact() -> None:
    response = contact_step(untouched, motor_speed_rad_s=1.0, before_s=0.0, after_s=0.003)
    assert response.time_s == pytest.approx([0.0, 0.001, 0.002])
    assert np.all(response.torque_Nm == 10.0)
    short = contact_step(untouched, motor_speed_rad_s=1.0, before_s=0.01, after_s=0.001)
    assert short.time_s[0] == pytest.approx(-0.01)
    usual = contact_step(untouched, motor_speed_rad_s=1.0, contact_torque_Nm=-3.0)
    assert usual.time_s[0] == pytest.approx(-0.02)
    assert usual.torque_Nm[0] == 0.0
    assert usual.at(0.01) == -3.0


def test_the_highest_frequency_leaves_room_for_the_delay() -> None:
    measured = pass_through(untouched, [497.5], motor_speed_rad_s=1.0)
    assert measured.gain == pytest.approx(1.0, abs=1e-9)
    with pytest.raises(InputError, match="below 500 Hz, half the sampling rate"):
        pass_through(untouched, [497.6], motor_speed_rad_s=1.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"frequencies_Hz": [600.0]}, "holds 600 Hz: expected.*half the sampling rate"),
        ({"frequencies_Hz": [1.0, 499.0]}, "holds 499 Hz: expected.*half the sampling rate"),
        ({"frequencies_Hz": [np.nan]}, "half the sampling rate"),
        ({"frequencies_Hz": [0.0]}, "half the sampling rate"),
        ({"frequencies_Hz": []}, "frequencies_Hz is empty"),
        ({"frequencies_Hz": [1e-9]}, "samples: expected at most"),
        ({"sample_period_s": 0.0}, "sample_period_s = 0: expected"),
        ({"sample_period_s": np.nan}, "sample_period_s = nan: expected"),
        ({"motor_speed_rad_s": np.nan}, "motor_speed_rad_s = nan: expected a finite number;"),
        ({"motor_speed_rad_s": "fast"}, "motor_speed_rad_s = 'fast': expected"),
        ({"settling_s": -1.0}, "settling_s = -1: expected a finite number of at least 0"),
        ({"settling_s": 1e9}, "settling_s = 1e.09 s is 1e.12 samples: expected at most"),
    ],
)
def test_bad_input_of_pass_through_gets_one_sentence(options, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        pass_through(untouched, **{"frequencies_Hz": [1.0], "motor_speed_rad_s": 1.0} | options)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"sample_period_s": 0.0}, "sample_period_s = 0: expected"),
        ({"sample_period_s": -1e-3}, "sample_period_s = -0.001: expected"),
        ({"before_s": np.nan}, "before_s = nan: expected"),
        ({"before_s": -1.0}, "before_s = -1: expected a finite number of at least 0"),
        ({"after_s": 0.0}, "after_s = 0: expected a finite number of at least 0.001"),
        ({"after_s": np.inf}, "after_s = inf: expected"),
        ({"after_s": 1e9}, "samples: expected at most"),
        ({"contact_torque_Nm": np.nan}, "contact_torque_Nm = nan: expected"),
        ({"motor_speed_rad_s": None}, "motor_speed_rad_s = a NoneType: expected"),
    ],
)
def test_bad_input_of_contact_step_gets_one_sentence(options, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        contact_step(untouched, **{"motor_speed_rad_s": 1.0} | options)
    assert "\n" not in str(caught.value)


def test_a_filter_that_gives_nonsense_is_refused() -> None:
    for wrong in (lambda torque, _: torque * np.nan, lambda torque, _: torque[1:]):
        with pytest.raises(InputError, match="the filter's output has"):
            pass_through(wrong, [1.0], motor_speed_rad_s=1.0)


def test_filter_is_fresh_at_every_call() -> None:
    run = removes_ripple(lambda: oscillator_preset("taghirad1999-4"))
    torque = np.sin(np.arange(200) / 7)
    speed = np.full(200, 100.0)
    assert np.array_equal(run(torque, speed), run(torque, speed))
    direct = OscillatorFilter(oscillator_preset("taghirad1999-4"))
    assert np.array_equal(
        run(torque, speed), direct.process(torque, motor_speed_rad_s=speed).torque_Nm
    )
