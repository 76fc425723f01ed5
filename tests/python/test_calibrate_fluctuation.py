"""Gains against the paper's data, the closed form for three gauges, and theory."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strainwave import Gains, GaugeFluctuation
from strainwave.calibrate.fluctuation import (
    compensation_conditions,
    enough_gauges,
    equally_spaced_positions_rad,
    fit_fluctuation,
    minimum_gauges,
)
from strainwave.calibrate.gains import compensating_gains
from strainwave.errors import InputError

AMPLITUDES = [[1.0, 1.07, 1.15]]
PHASES_RAD = np.deg2rad([[0.0, -1.5, -0.4]])


def gains_of(amplitudes, phases, gauges):
    positions = equally_spaced_positions_rad(gauges)
    return compensating_gains(compensation_conditions(amplitudes, phases, positions))


def test_gains_of_godlers_three_gauges() -> None:
    result = gains_of(AMPLITUDES, PHASES_RAD, 3)
    assert result.gains == pytest.approx([1.0586, 0.9966, 0.9448], abs=5e-5)
    assert result.exact
    assert result.residuals == pytest.approx([0.0], abs=1e-14)
    assert result.residuals_equal_gains == pytest.approx([0.1059], abs=5e-5)
    assert result.noise_factor == pytest.approx(1.002, abs=5e-4)


def test_closed_form_for_three_gauges() -> None:
    # g_1 ~ sin(phi_3 - phi_2)/a_1 and cyclic, phi the angle of each phasor.
    rng = np.random.default_rng(3)
    for _ in range(50):
        amplitude = rng.uniform(0.8, 1.2, 3)
        phase = rng.normal(0, 0.1, 3)
        angle = 2 * equally_spaced_positions_rad(3) + phase
        form = np.sin(np.roll(angle, -2) - np.roll(angle, -1)) / amplitude
        result = gains_of([amplitude], [phase], 3)
        # A position is resolved to 2^-32 turn, 1.5e-9 rad.
        assert result.gains == pytest.approx(form * 3 / form.sum(), rel=1e-8)


def test_minimum_number_of_gauges() -> None:
    assert [minimum_gauges(n) for n in (1, 2, 3, 4)] == [3, 5, 7, 9]
    assert enough_gauges(3, 1)
    assert not enough_gauges(2, 1)
    assert not enough_gauges(4, 2)
    assert enough_gauges(5, 2)


@pytest.mark.parametrize("harmonics", [1, 2, 3])
def test_null_space_exists_from_2n_plus_1_gauges_on_and_not_before(harmonics: int) -> None:
    rng = np.random.default_rng(17 + harmonics)
    for gauges in range(2, 10):
        amplitudes = rng.uniform(0.7, 1.3, (harmonics, gauges))
        phases = rng.normal(0, 0.3, (harmonics, gauges))
        matrix = compensation_conditions(amplitudes, phases, equally_spaced_positions_rad(gauges))
        nullity = gauges - np.linalg.matrix_rank(matrix)
        assert (nullity > 0) == enough_gauges(gauges, harmonics)


def test_spare_gauges_are_used_for_the_least_noise() -> None:
    rng = np.random.default_rng(9)
    amplitudes = rng.uniform(0.8, 1.2, (1, 6))
    phases = rng.normal(0, 0.2, (1, 6))
    matrix = compensation_conditions(amplitudes, phases, equally_spaced_positions_rad(6))
    result = compensating_gains(matrix)
    null_space = np.linalg.svd(matrix)[2][2:]
    for _ in range(200):
        other = null_space.T @ rng.normal(size=4)
        other *= 6 / other.sum()
        assert result.noise_factor <= 6 * np.sum(other**2) / 36 + 1e-12


def test_too_few_gauges_reach_the_least_residual() -> None:
    result = gains_of([[1.0, 1.07]], np.deg2rad([[0.0, -1.5]]), 2)
    assert not result.exact
    # Two nearly opposite phasors: brute force over the one free ratio.
    lean = np.linspace(0.5, 1.5, 200001)
    phasors = np.exp(1j * np.array([0.0, np.pi + np.deg2rad(-1.5)])) * [1.0, 1.07]
    left = np.abs(lean * phasors[0] + (2 - lean) * phasors[1])
    assert result.residuals[0] == pytest.approx(left.min(), rel=1e-6)
    assert result.gains[0] == pytest.approx(lean[left.argmin()], abs=1e-4)


def test_gauges_on_a_line_through_zero_are_refused() -> None:
    # Three phasors in one direction cancel only with gains that add up to nothing.
    with pytest.raises(InputError, match="cancel the torque as well"):
        compensating_gains([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]])


def test_harmonic_that_looks_like_torque_is_refused() -> None:
    # Harmonic i = M has the same phase on every gauge.
    with pytest.raises(InputError, match="cancel the torque as well"):
        gains_of([[0, 0, 0], [0, 0, 0], [1, 1, 1]], np.zeros((3, 3)), 3)


def test_fit_recovers_amplitudes_and_phases_within_their_errors() -> None:
    rng = np.random.default_rng(21)
    positions = equally_spaced_positions_rad(3)
    amplitudes = np.array([[1.0, 1.07, 1.15], [0.05, 0.04, 0.06]])
    phases = np.array([[0.0, -0.026, -0.007], [0.4, -1.2, 2.0]])
    angle = np.linspace(0, 40.0, 8000)
    signals = np.column_stack(
        [
            GaugeFluctuation(
                amplitudes=amplitudes[:, j],
                phase_errors_rad=phases[:, j],
                position_rad=positions[j],
            ).signal(angle)
            for j in range(3)
        ]
    )
    signals += rng.normal(0, 0.02, signals.shape) + 0.3
    fit = fit_fluctuation(signals, angle, positions_rad=positions, harmonics=2)
    scatter = (fit.amplitudes - amplitudes) / fit.amplitude_standard_errors
    assert 0.3 < np.sqrt(np.mean(scatter**2)) < 2.0
    turned = np.angle(np.exp(1j * (fit.phase_errors_rad - phases)))
    assert np.all(np.abs(turned) < 4 * fit.phase_standard_errors_rad)
    # sigma sqrt(2/n) of a sine fitted to white noise
    assert fit.amplitude_standard_errors == pytest.approx(0.02 * np.sqrt(2 / 8000), rel=0.05)


def three_phasors(degrees):
    angle = np.deg2rad(degrees)
    return np.array([np.cos(angle), np.sin(angle)])


def test_degenerate_gains_are_refused_with_the_reason() -> None:
    conditions = three_phasors([0.0, 20.0, 50.0])
    with pytest.raises(InputError, match=r"expected at most 10 times, because gauges") as caught:
        compensating_gains(conditions)
    assert "move the gauges apart" in str(caught.value)
    assert "\n" not in str(caught.value)
    accepted = compensating_gains(conditions, most_noise=np.inf)
    assert accepted.noise_factor > 10
    assert accepted.negative == (2,)
    assert accepted.gains.sum() == pytest.approx(3)
    assert compensating_gains(conditions, most_noise=accepted.noise_factor * (1 + 1e-6)).exact
    with pytest.raises(InputError, match="raise most_noise"):
        compensating_gains(conditions, most_noise=accepted.noise_factor * (1 - 1e-6))


def test_gains_say_what_is_unusual_about_them() -> None:
    usual = gains_of(AMPLITUDES, PHASES_RAD, 3)
    assert usual.negative == ()
    assert usual.warnings == ()
    # Phasors within half a turn need a negative gain.
    unusual = compensating_gains(three_phasors([0.0, 80.0, 160.0]))
    assert unusual.negative == (2,)
    assert unusual.warnings[0].startswith("Gauges with a negative gain, 2 of 3,")
    noisy = compensating_gains(three_phasors([0.0, 80.0, 160.0]), most_noise=100)
    assert noisy.noise_factor == pytest.approx(3 * np.mean(noisy.gains**2) / 3)
    assert len(unusual.warnings) == 1 + (unusual.noise_factor > 2)
    left = gains_of([[1.0, 1.07]], np.deg2rad([[0.0, -1.5]]), 2)
    assert left.warnings[0].startswith("The fluctuation does not vanish")


def test_noise_factor_is_the_cores_for_equal_sensitivities() -> None:
    result = gains_of(AMPLITUDES, PHASES_RAD, 3)
    assert result.noise_factor == pytest.approx(Gains(result.gains).noise_factor, rel=1e-12)


def test_two_ideal_gauges_cancel_exactly() -> None:
    result = gains_of([[1.0, 1.0]], np.zeros((1, 2)), 2)
    assert result.exact
    assert result.gains == pytest.approx([1.0, 1.0], abs=1e-12)
    assert result.warnings == ()


def test_phasors_apart_by_rounding_of_angles_alone_count_as_dependent() -> None:
    # Three ideal gauges: the second harmonic mirrors the first, so that five are not needed.
    result = gains_of(np.ones((2, 3)), np.zeros((2, 3)), 3)
    assert result.exact
    assert result.gains == pytest.approx(np.ones(3), abs=1e-7)
    assert result.condition == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("scale", [1e-300, 1e-170, 1.0, 1e170])
@pytest.mark.parametrize("gauges", [2, 3])
def test_gains_have_no_unit(scale: float, gauges: int) -> None:
    conditions = compensation_conditions(
        np.array(AMPLITUDES)[:, :gauges],
        PHASES_RAD[:, :gauges],
        equally_spaced_positions_rad(gauges),
    )
    plain = compensating_gains(conditions)
    scaled = compensating_gains(conditions * scale)
    assert scaled.gains == pytest.approx(plain.gains, rel=1e-9)
    assert scaled.condition == pytest.approx(plain.condition, rel=1e-9)
    assert scaled.exact == plain.exact


@given(
    st.lists(st.floats(0.5, 2.0), min_size=5, max_size=9),
    st.integers(0, 2**31),
)
def test_gains_keep_the_torque_and_cancel_the_wave(first: list[float], seed: int) -> None:
    gauges = len(first)
    rng = np.random.default_rng(seed)
    amplitudes = np.vstack([first, rng.uniform(0.02, 0.1, gauges)])
    phases = rng.normal(0, 0.2, (2, gauges))
    matrix = compensation_conditions(amplitudes, phases, equally_spaced_positions_rad(gauges))
    try:
        result = compensating_gains(matrix)
    except InputError:
        return
    assert result.gains.sum() == pytest.approx(gauges, rel=1e-9)
    assert np.all(result.residuals <= 1e-7 * np.abs(result.gains).max())
    assert result.noise_factor >= 1.0 - 1e-12


def fit_of(angle=range(9), *, positions_rad=(0.0,), **options):
    signals = np.zeros((len(angle), len(positions_rad)))
    return fit_fluctuation(signals, np.array(angle), positions_rad=positions_rad, **options)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: minimum_gauges(0), "harmonics = 0: expected a whole number of at least 1"),
        (lambda: minimum_gauges(1.5), "harmonics = 1.5: expected a whole number"),
        (lambda: minimum_gauges("a"), "harmonics = 'a': expected a whole number"),
        (lambda: minimum_gauges(np.ones(100)), "harmonics = a ndarray: expected a whole number"),
        (lambda: enough_gauges("a", 1), "gauges = 'a': expected a whole number"),
        (lambda: equally_spaced_positions_rad(0), "gauges = 0: expected a whole number"),
        (lambda: equally_spaced_positions_rad(-1), "gauges = -1: expected a whole number"),
        (lambda: equally_spaced_positions_rad(2.5), "gauges = 2.5: expected a whole number"),
        (lambda: compensating_gains([[1, 2, 3]]), "two rows a harmonic, of sine and cosine"),
        (lambda: compensating_gains(np.zeros((2, 0))), "a column a gauge"),
        (lambda: compensating_gains(np.ones((2, 2)), most_noise=0.5), "most_noise = 0.5: expected"),
        (lambda: compensating_gains(np.ones((2, 2)), most_noise="a"), "most_noise = 'a': expected"),
        (lambda: compensating_gains(np.ones((2, 3)), [1, -1, 0]), "add up to 0"),
        (lambda: compensation_conditions([[1, np.nan]], [[0, 0]], [0, 1]), "harmonic 1, gauge 2"),
        (lambda: fit_of(positions_rad=[np.nan]), "positions_rad is not finite at gauge 1"),
        (lambda: fit_of(positions_rad=[1e300]), "positions_rad reaches 1e.300 rad"),
        (lambda: fit_of(wave_factor=-1), "wave_factor = -1: expected a number above 0"),
        (lambda: fit_of(wave_factor=None), "wave_factor = None: expected a number"),
        (lambda: fit_of(harmonics=1.5), "harmonics = 1.5: expected a whole number"),
        (lambda: fit_of(harmonics=9), "motor_angle_rad has 9 elements: expected at least 20"),
        (lambda: fit_of([0, 4] * 4 + [0]), "motor_angle_rad does not tell 2 harmonic"),
        (lambda: fit_of([*range(8), np.nan]), "motor_angle_rad is not finite at row 8"),
        (lambda: compensation_conditions([[1, 1]], [[0, 0, 0]], [0, 1]), "one column a gauge"),
        (lambda: compensating_gains([[1, np.nan], [1, 1]]), "not finite at row 0, column 1"),
        (lambda: compensating_gains([[1, -1], [0, 0]], [1.0]), "torque_sensitivities"),
        (
            lambda: fit_fluctuation(np.zeros((5, 2)), np.zeros(5), positions_rad=[0, 1]),
            "less than half a turn",
        ),
        (
            lambda: fit_fluctuation(np.zeros((5, 3)), np.zeros(5), positions_rad=[0, 1]),
            r"shape \(5, 3\): expected \(5, 2\)",
        ),
    ],
)
def test_bad_input_gets_one_sentence(call, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        call()
    assert "\n" not in str(caught.value)
