"""One test for each numbered equation, and the table that says where each of them is."""

import importlib
import pathlib
import re

import numpy as np
import pytest

from strainwave import (
    Gains,
    GaugeFluctuation,
    Gear,
    GearConfiguration,
    OscillatorFilter,
    OscillatorFilterConfig,
    Rational,
    Rosette,
    full_bridge_V,
    nominal_ratio,
    oscillator_preset,
    signed_reduction_ratio,
)
from strainwave.calibrate import fluctuation, torque

ROOT = pathlib.Path(__file__).parents[2]
TABLE = ROOT / "docs" / "reference" / "equations.md"
ROW = re.compile(r"^\| ([TG]) (\d+) \| .* \| `([^`]+):(\w+)` \| `(\w+)` \|$", re.MULTILINE)
ROWS = ROW.findall(TABLE.read_text(encoding="utf-8"))
BETA = np.linspace(-20.0, 20.0, 401)
PHASE_UNITS = 2e-7  # what the 32-bit phase leaves of a harmonic


def test_table_has_every_equation_once():
    listed = [(paper, int(number)) for paper, number, *_ in ROWS]
    assert listed == [("T", n) for n in range(1, 15)] + [("G", n) for n in range(1, 12)]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row[0]}{row[1]}")
def test_table_names_what_exists(row):
    paper, number, place, name, test = row
    if place.endswith(".hpp"):
        header = (ROOT / "include" / "strainwave" / place).read_text(encoding="utf-8")
        code = re.sub(r"//[^\n]*", "", header)
        declared = rf"(^|[\w>*&] ){name}( =|\(|\[| \{{)"
        assert re.search(declared, code, re.MULTILINE), f"{place} declares no {name}"
    else:
        assert callable(getattr(importlib.import_module(place), name))
    assert test.startswith(f"test_{paper.lower()}{number}_")
    assert callable(globals()[test])


# Taghirad & Belanger 1999


def test_t1_rosette_strains():
    first, second = Rosette().strain(np.array([3e-4]), np.array([1e-4]), np.array([5e-4]))
    # epsilon_t is half the shear strain, epsilon_w the mean normal strain.
    assert first[0] == pytest.approx(2.5e-4 + 2e-4, rel=1e-12)
    assert second[0] == pytest.approx(-2.5e-4 + 2e-4, rel=1e-12)


def test_t2_difference_of_the_first_rosette():
    wave = 4e-5 * np.sin(2 * BETA)
    rosette = Rosette(gauge_factor=2.1)
    first, second = rosette.strain(7e-4 * np.cos(2 * BETA), np.zeros(401), 3e-4 + wave)
    # What a half bridge answers to, K/4 of it times the supply.
    difference = rosette.half_bridge_V(first, second, 10.0) / (2.1 / 4 * 10.0)
    np.testing.assert_allclose(difference, 2 * 1.5e-4 + wave, rtol=0, atol=1e-18)


def test_t3_second_rosette_is_opposite():
    gauge = GaugeFluctuation(amplitudes=[1.3], phase_errors_rad=[0.0], position_rad=np.pi / 2)
    np.testing.assert_allclose(
        gauge.signal(BETA), 1.3 * np.sin(2 * BETA - np.pi), rtol=0, atol=PHASE_UNITS
    )


def test_t4_bridge_output():
    rosettes = [Rosette(gauge_factor=2.1)] * 2
    first, second = np.array([[4e-4, 1e-4]]), np.array([[-2e-4, 3e-4]])
    # K/4 (e1 + e3 - e2 - e4) E = 2.1 / 4 x 4e-4 x 10 V
    assert full_bridge_V(rosettes, first, second, 10.0)[0] == pytest.approx(2.1e-3, rel=1e-12)
    ideal = np.full((1, 2), 1e-4)  # K epsilon_t E
    assert full_bridge_V(rosettes, ideal, -ideal, 10.0)[0] == pytest.approx(2.1e-3, rel=1e-12)


def test_t5_observation_matrix():
    volts, theta = np.array([1.0, -2.0, 0.5]), np.array([6.6, 0.3])
    predicted = torque.observation_matrix(volts, intercept=True) @ theta
    np.testing.assert_allclose(predicted, [6.9, -12.9, 3.6], rtol=1e-15)
    np.testing.assert_array_equal(torque.observation_matrix(volts), volts[:, None])


def test_t6_least_squares_has_the_least_error():
    rng = np.random.default_rng(1)
    A, b = rng.standard_normal((20, 3)), rng.standard_normal(20)
    theta = torque.least_squares(A, b).parameters
    least = np.linalg.norm(A @ theta - b)
    for _ in range(100):
        assert np.linalg.norm(A @ (theta + 1e-3 * rng.standard_normal(3)) - b) > least


def test_t7_solution_by_hand():
    # Through the origin the gain is sum(v T) / sum(v^2): (6 + 26 + 60) / 14.
    fit = torque.least_squares([[1.0], [2.0], [3.0]], [6.0, 13.0, 20.0])
    assert fit.parameters[0] == pytest.approx(92 / 14, rel=1e-15)


def test_t8_pseudo_inverse():
    # (A'A)^-1 A' of [[1, 0], [1, 1], [1, 2]] by hand, in sixths.
    inverse = torque.pseudo_inverse([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
    np.testing.assert_allclose(inverse * 6, [[5, 2, -1], [-3, 0, 3]], atol=1e-13)


def oscillators(orders, q, r, p0):
    return OscillatorFilter(
        OscillatorFilterConfig(
            orders=orders,
            process_noise_variance_Nm2=q,
            measurement_noise_variance_Nm2=r,
            initial_variance_Nm2=p0,
            minimum_travel_rad=0.0,
            minimum_speed_rad_s=0.0,
            variance_limit_ratio=0,
        )
    )


def one_sample(ours, torque_Nm, speed_rad_s):
    return ours.process(np.array([torque_Nm]), motor_speed_rad_s=np.array([speed_rad_s]))


def test_t9_blocks_and_output():
    ours = oscillators([2, 4], 0.0, 1.0, 1.0)
    one_sample(ours, 3.0, 0.0)
    states, _ = ours.predicted_state()
    # s = 1 + 2: every first state takes a third of the 3 Nm, no second state takes any.
    np.testing.assert_allclose(states, [1, 0, 1, 0], atol=1e-15)
    assert one_sample(ours, 0.0, 0.0).ripple_Nm[0] == pytest.approx(2.0, abs=1e-15)


def test_t10_rotation_without_measurement():
    ours = oscillators([2, 4], 0.0, 1.0, 1.0)
    speed = np.pi / 4 / 1e-3  # an eighth of a turn in one sample: orders turn by 90 and 180 degrees
    one_sample(ours, 3.0, speed)
    np.testing.assert_allclose(ours.predicted_state()[0], [0, -1, -1, 0], atol=1e-12)


def test_t11_noise_enters_where_it_should():
    ours = oscillators([2, 4], [5.0, 7.0], 1e12, 1.0)  # R so large that nothing is learned
    for _ in range(10):
        one_sample(ours, 100.0, 37.0)
    np.testing.assert_allclose(
        ours.predicted_state()[1], np.diag([51.0, 51.0, 71.0, 71.0]), rtol=1e-8, atol=1e-8
    )


def test_t12_first_states_by_hand():
    ours = OscillatorFilter(oscillator_preset("taghirad1999-4"))
    one_sample(ours, 2001.0, 0.0)  # gain 1000 / 2001 for both first states
    np.testing.assert_allclose(ours.predicted_state()[0], [1000, 0, 1000, 0], rtol=1e-13)


def test_t13_steady_gain_of_one_state():
    """At rest one order is a random walk, whose steady covariance is the golden ratio's."""
    ours = oscillators([2], 1.0, 1.0, 1.0)
    for _ in range(100):
        one_sample(ours, 0.0, 0.0)
    golden = (1 + np.sqrt(5)) / 2  # P = P - P^2 / (P + 1) + 1
    assert ours.predicted_state()[1][0, 0] == pytest.approx(golden, rel=1e-14)
    before = ours.predicted_state()[0][0]
    one_sample(ours, before + 1.0, 0.0)
    gain = ours.predicted_state()[0][0] - before
    assert gain == pytest.approx(golden / (golden + 1), rel=1e-13)


def test_t14_first_covariance_by_hand():
    ours = oscillators([2, 4], 0.5, 1.0, 1.0)
    one_sample(ours, 0.0, 0.0)
    # I - c c' / 3 + 0.5 I
    expected = 1.5 * np.eye(4)
    expected[np.ix_([0, 2], [0, 2])] -= 1 / 3
    np.testing.assert_allclose(ours.predicted_state()[1], expected, rtol=1e-15)


# Godler et al. 2000


def test_g1_nominal_ratio():
    assert nominal_ratio(100, 102) == Rational(50)
    assert nominal_ratio(241, 243) == Rational(120.5)


def test_g2_ratio_of_both_configurations():
    circular, flexspline = (
        GearConfiguration.fixed_circular_spline,
        GearConfiguration.fixed_flexspline,
    )
    assert signed_reduction_ratio(circular, Rational(50)) == -50
    assert signed_reduction_ratio(flexspline, Rational(50)) == 51
    # Willis: turns of the splines against the wave generator are as their teeth.
    for configuration, output in ((circular, -1 / 50), (flexspline, 1 / 51)):
        turns_f, turns_c = (output, 0.0) if configuration == circular else (0.0, output)
        assert (turns_f - 1) * 100 == pytest.approx((turns_c - 1) * 102)
        assert 1 / output == pytest.approx(signed_reduction_ratio(configuration, Rational(50)))


def gauges(degrees, amplitudes, m=1, errors=None):
    return [
        GaugeFluctuation(
            amplitudes=amplitudes,
            phase_errors_rad=errors or [0.0] * len(amplitudes),
            position_rad=np.deg2rad(position),
            wave_factor=m,
        )
        for position in degrees
    ]


def test_g3_two_gauges():
    m = Gear(ratio=50).wave_factor
    e1, e2 = (gauge.signal(BETA) for gauge in gauges([0, 90], [1.7], m))
    np.testing.assert_allclose(e1, 1.7 * np.sin(2 * 1.02 * BETA), atol=PHASE_UNITS)
    np.testing.assert_allclose(e2, -1.7 * np.sin(2 * 1.02 * BETA), atol=PHASE_UNITS)


def test_g4_second_harmonic():
    e1, e2 = (gauge.signal(BETA) for gauge in gauges([0, 90], [1.0, 0.05]))
    s1, s2 = np.sin(2 * BETA), 0.05 * np.sin(4 * BETA)
    np.testing.assert_allclose(e1, s1 + s2, atol=PHASE_UNITS)
    np.testing.assert_allclose(e2, -s1 + s2, atol=PHASE_UNITS)


def test_g5_four_gauges():
    e = np.array([gauge.signal(BETA) for gauge in gauges([0, 90, 45, 135], [1.0, 0.3])])
    s1, c1, s2 = np.sin(2 * BETA), np.cos(2 * BETA), 0.3 * np.sin(4 * BETA)
    np.testing.assert_allclose(e, [s1 + s2, -s1 + s2, c1 - s2, -c1 - s2], atol=PHASE_UNITS)
    np.testing.assert_allclose(e.sum(axis=0), 0, atol=4 * PHASE_UNITS)


def test_g6_general_gauge():
    amplitudes, errors = [1.0, 0.2, 0.1], [0.3, -0.7, 2.0]
    (gauge,) = gauges([72], amplitudes, 1.02, errors)  # gauge 3 of 5
    expected = sum(
        a * np.sin(2 * i * (1.02 * BETA + np.pi * 2 / 5) + psi)
        for i, (a, psi) in enumerate(zip(amplitudes, errors, strict=True), start=1)
    )
    np.testing.assert_allclose(gauge.signal(BETA), expected, atol=PHASE_UNITS)


def test_g7_sum_of_all_gauges():
    placed = gauges([0, 60, 120], [1.0, 0.5, 0.25], 1.02)
    signals = np.stack([gauge.signal(BETA) for gauge in placed], axis=1)
    h = Gains([1.0, 1.0, 1.0]).weighted_sum(signals)
    # Only the harmonic that is a multiple of M is left, M times.
    np.testing.assert_allclose(h, 0.75 * np.sin(6 * 1.02 * BETA), atol=1e-6)
    unequal = Gains([1.0586, 0.9966, 0.9448])
    np.testing.assert_allclose(
        unequal.weighted_sum(signals), signals @ [1.0586, 0.9966, 0.9448], atol=1e-15
    )


def test_g8_split_into_sine_and_cosine():
    (gauge,) = gauges([33], [1.1, 0.4], 1.02, [0.2, -0.9])
    total = np.zeros_like(BETA)
    for i in (1, 2):
        sine, cosine = gauge.phasor(i)
        total += sine * np.sin(2 * i * 1.02 * BETA) + cosine * np.cos(2 * i * 1.02 * BETA)
    np.testing.assert_allclose(gauge.signal(BETA), total, atol=PHASE_UNITS)


def test_g9_conditions():
    """Godler's experiment: gains 1.0586, 0.9966, 0.9448 make the conditions vanish."""
    amplitudes, errors = [[1.0, 1.07, 1.15]], np.deg2rad([[0.0, -1.5, -0.4]])
    positions = np.pi * np.arange(3) / 3
    A = fluctuation.compensation_conditions(amplitudes, errors, positions)
    assert A.shape == (2, 3)
    np.testing.assert_allclose(A @ [1.0586, 0.9966, 0.9448], 0, atol=2e-4)
    assert np.hypot(*A.sum(axis=1)) == pytest.approx(0.1059 * 1.0, abs=0.0005)


def test_g10_enough_gauges():
    for gauge_count in range(2, 10):
        for harmonics in range(1, 5):
            # Unknowns against equations of (9): a null vector exists for sure where there are more.
            assert fluctuation.enough_gauges(gauge_count, harmonics) == (
                gauge_count > 2 * harmonics
            )


def test_g11_minimum_gauges():
    assert [fluctuation.minimum_gauges(n) for n in (1, 2, 3, 4)] == [3, 5, 7, 9]
