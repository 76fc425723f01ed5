"""Monte Carlo of gauge layouts, against theory, published numbers and the solver for one layout."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave.calibrate.circuit import parse_circuit
from strainwave.calibrate.fluctuation import compensation_conditions, equally_spaced_positions_rad
from strainwave.calibrate.gains import compensating_gains
from strainwave.design.case import LayoutCase, assumptions, remarks
from strainwave.design.layout import LayoutStudy, study_layout
from strainwave.design.many_gains import gains_of_layouts, noise_factors
from strainwave.design.placement import Tolerances, Wave, draw_errors, gauge_signals
from strainwave.errors import InputError

TRIALS = 100_000


def electrical(scatter_deg: float, **more: Any) -> LayoutCase:
    """Three gauges whose first harmonic's phases scatter; positions count twice."""
    return LayoutCase(3, 1, Tolerances(position_deg=scatter_deg / 2), **more)


def shares_within(share: float, other: float, trials: int = TRIALS) -> bool:
    """Whether two shares agree within four standard errors of one Monte Carlo each."""
    return abs(share - other) <= 4 * np.sqrt(2 * max(other, 1e-4) * (1 - other) / trials)


@pytest.mark.parametrize(
    ("scatter_deg", "published", "rounding"),
    [(5, 0.0, 0.0), (20, 0.05, 0.005), (30, 0.23, 0.005), (45, 0.49, 0.005)],
)
def test_share_of_layouts_with_a_negative_gain(
    scatter_deg: float, published: float, rounding: float
) -> None:
    found = study_layout(electrical(scatter_deg), 0.5, TRIALS).tuned.negative_gain_share
    error = 4 * np.sqrt(published * (1 - published) / TRIALS)
    assert abs(found - published) <= rounding + error


@pytest.mark.parametrize(
    ("scatter_deg", "low", "high"),
    # The percentile's own spread over seeds at 45 degrees is about 3 %.
    [(20, 1.49, 1.52), (30, 4.0, 4.4), (45, 62.0, 82.0)],
)
def test_noise_factor_at_the_95th_percentile(scatter_deg: float, low: float, high: float) -> None:
    found = study_layout(electrical(scatter_deg), 0.5, TRIALS).tuned.noise_factor[95]
    assert low < found < high


def test_noise_factor_of_small_scatter_is_a_chi_square() -> None:
    # To first order the gains of phases scattered by s deviate by s cot(60 deg) (z_3 - z_2),
    # cyclic: the noise factor is 1 + s^2 / 3 times chi square of two degrees of freedom.
    scatter_rad = np.deg2rad(2.0)
    found = study_layout(electrical(2.0), 0.5, TRIALS).tuned.noise_factor
    for percentile, value in found.items():
        chi_square = -2 * np.log(1 - percentile / 100)
        expected = scatter_rad**2 / 3 * chi_square
        assert value - 1 == pytest.approx(expected, rel=0.05)


def test_closed_form_of_three_gauges() -> None:
    # Godler 2000, M = 3 and N = 1: g_1 ~ sin(phi_3 - phi_2) / a_1, cyclic.
    generator = np.random.default_rng(3)
    size = generator.uniform(0.5, 2.0, (2000, 3))
    angle = generator.uniform(-np.pi, np.pi, (2000, 3))
    found = gains_of_layouts((size * np.exp(1j * angle))[:, np.newaxis])
    expected = np.sin(np.roll(angle, -2, axis=1) - np.roll(angle, -1, axis=1)) / size
    expected *= 3 / expected.sum(axis=1, keepdims=True)
    # Where torque nearly cancels, the sum loses digits in both.
    scale = np.abs(expected).max(axis=1, keepdims=True)
    assert np.abs(found - expected).max() <= 1e-9 * scale.max()
    assert np.median(np.abs(found - expected) / scale) < 1e-14
    direct = np.mean(np.any(expected < 0, axis=1))
    # Three directions at random: one gain or more is negative unless they surround the origin.
    assert direct == pytest.approx(0.75, abs=0.04)


def test_negative_gains_counted_from_the_closed_form() -> None:
    generator = np.random.default_rng(11)
    spaced = 2 * equally_spaced_positions_rad(3)
    for scatter_deg in (20.0, 30.0, 45.0):
        angle = spaced + generator.normal(0.0, np.deg2rad(scatter_deg), (TRIALS, 3))
        gains = np.sin(np.roll(angle, -2, axis=1) - np.roll(angle, -1, axis=1))
        gains *= np.sign(gains.sum(axis=1, keepdims=True))
        expected = float(np.mean(np.any(gains < 0, axis=1)))
        found = study_layout(electrical(scatter_deg), 0.5, TRIALS, seed=12).tuned
        assert shares_within(found.negative_gain_share, expected)


@pytest.mark.parametrize("harmonics", [1, 2, 3, 4])
@pytest.mark.parametrize("gauges", [2, 3, 4, 5, 6, 7, 8, 9])
def test_gains_are_those_of_the_solver_for_one_layout(gauges: int, harmonics: int) -> None:
    generator = np.random.default_rng(gauges * 10 + harmonics)
    layouts = 12
    sizes = (0.05 ** np.arange(harmonics))[:, np.newaxis] if gauges > 2 * harmonics else 1.0
    amplitudes = sizes * generator.normal(1.0, 0.1, (layouts, harmonics, gauges))
    phases = generator.normal(0.0, 0.15, (layouts, harmonics, gauges))
    positions = equally_spaced_positions_rad(gauges)
    orders = 2 * np.arange(1, harmonics + 1)[:, np.newaxis]
    found = gains_of_layouts(amplitudes * np.exp(1j * (orders * positions + phases)))
    assert found.sum(axis=1) == pytest.approx(gauges)
    for n in range(layouts):
        one = compensating_gains(
            compensation_conditions(amplitudes[n], phases[n], positions), most_noise=np.inf
        )
        assert found[n] == pytest.approx(one.gains, rel=1e-5, abs=1e-5 * np.abs(one.gains).max())
        assert noise_factors(found[n : n + 1])[0] == pytest.approx(one.noise_factor, rel=1e-4)


@pytest.mark.parametrize(("gauges", "harmonics"), [(2, 1), (4, 2), (3, 2), (4, 3), (6, 3)])
def test_ideal_gauges_that_are_too_few_by_the_rule(gauges: int, harmonics: int) -> None:
    """Phasors that depend on each other cancel with equal gains; the solver finds that."""
    positions = equally_spaced_positions_rad(gauges)
    orders = 2 * np.arange(1, harmonics + 1)[:, np.newaxis]
    assert gains_of_layouts(np.exp(1j * orders * positions)[np.newaxis]) == pytest.approx(
        np.ones((1, gauges)), abs=1e-6
    )


def test_experiment_of_the_paper() -> None:
    # Godler 2000, section IV: 1 : 1.07 : 1.15 at 0, -1.5, -0.4 degrees.
    size = 56.7 * np.array([1.0, 1.07, 1.15])
    angle = 2 * equally_spaced_positions_rad(3) + np.deg2rad([0.0, -1.5, -0.4])
    phasors = (size * np.exp(1j * angle))[np.newaxis, np.newaxis]
    gains = gains_of_layouts(phasors)
    assert gains[0] == pytest.approx([1.0586, 0.9966, 0.9448], abs=5e-5)
    assert noise_factors(gains)[0] == pytest.approx(1.002, abs=5e-4)
    assert abs(phasors.sum()) / 3 == pytest.approx(2.0, abs=0.005)


def test_second_harmonic_of_the_paper() -> None:
    """A twentieth that scatters by 15 % and 10 degrees leaves about 0.3 %FS."""
    case = LayoutCase(
        3,
        1,
        Tolerances(amplitude=0.15, phase_deg=10.0),
        Wave((56.7, 56.7 / 20)),
        measurement_error_FS=0.0,
    )
    found = study_layout(case, 0.5, TRIALS).tuned.residual_FS
    assert found[5] < 0.3 < found[95]
    # By itself: mean of three scattered phasors, Rayleigh; the gains' own scatter adds to it.
    alone = 56.7 / 20 * np.sqrt(0.15**2 + np.deg2rad(10) ** 2) / np.sqrt(3) * np.sqrt(np.log(2))
    assert 1.0 < found[50] / alone < 1.5


def test_equal_gains_leave_a_rayleigh_residual() -> None:
    # Small errors of amplitude and phase alike: the mean of M phasors of variance s^2 each.
    scatter = 0.02
    for gauges in (3, 8):
        case = LayoutCase(
            gauges,
            1,
            Tolerances(amplitude=scatter, phase_deg=float(np.rad2deg(scatter))),
            Wave((50.0,)),
        )
        found = study_layout(case, 0.5, TRIALS).untuned
        spread = 50.0 * scatter / np.sqrt(gauges)
        for percentile, value in found.residual_FS.items():
            expected = spread * np.sqrt(-2 * np.log(1 - percentile / 100))
            assert value == pytest.approx(expected, rel=0.02)
        assert shares_within(found.met_limit, 1 - np.exp(-((0.5 / spread) ** 2) / 2))


def test_measurement_error_alone() -> None:
    # Ideal gauges, one harmonic: what gains leave is what was measured wrongly, Rayleigh again.
    case = LayoutCase(3, 1, Tolerances(), Wave((50.0,)), measurement_error_FS=0.05)
    found = study_layout(case, 0.5, TRIALS)
    spread = 0.05 / np.sqrt(3)
    for percentile, value in found.tuned.residual_FS.items():
        expected = spread * np.sqrt(-2 * np.log(1 - percentile / 100))
        assert value == pytest.approx(expected, rel=0.03)
    assert found.parts_FS["up_to_N_solved"] == found.tuned.residual_FS
    assert found.parts_FS["above_N"] == {5: 0.0, 50: 0.0, 95: 0.0}
    exact = study_layout(replace(case, measurement_error_FS=0.0), 0.5, 1000)
    assert exact.tuned.residual_FS[95] < 1e-6


def test_potentiometer_steps() -> None:
    """A step leaves uniform errors of the gains: of each gauge, step / sqrt(12)."""
    step = 0.01
    case = LayoutCase(
        5,
        1,
        Tolerances(position_deg=1.0, amplitude=0.1),
        Wave((50.0,)),
        measurement_error_FS=0.0,
        circuit=parse_circuit(str(step)),
    )
    found = study_layout(case, 0.5, TRIALS).parts_FS
    assert found["up_to_N_solved"][95] < 1e-6
    spread = 50.0 * step / np.sqrt(12) / np.sqrt(5) / np.sqrt(2)
    assert found["up_to_N"][50] == pytest.approx(spread * np.sqrt(2 * np.log(2)), rel=0.05)


def test_gauge_watch() -> None:
    two = Wave((56.7, 2.835))
    case = LayoutCase(5, 2, Tolerances(position_deg=1.0), two, lost_gauge=True)
    found = study_layout(case, 0.5, 5000)
    assert found.lost_tuned is not None
    assert found.lost_untuned is not None
    # Four gauges cannot cancel two harmonics; six less one can.
    assert found.lost_tuned.residual_FS[50] > 3 * found.tuned.residual_FS[50]
    spare = study_layout(replace(case, gauges=6), 0.5, 5000)
    assert spare.lost_tuned is not None
    assert spare.lost_tuned.residual_FS[50] < 3 * spare.tuned.residual_FS[50]
    # Without errors equal gains of M - 1 gauges leave the lost one's wave.
    ideal = LayoutCase(4, 1, Tolerances(), Wave((60.0,)), lost_gauge=True)
    lost = study_layout(ideal, 0.5, 10).lost_untuned
    assert lost is not None
    assert lost.residual_FS[50] == pytest.approx(60.0 / 3)


def of_one_layout(phasors: np.ndarray, torque: np.ndarray, harmonics: int) -> tuple[float, ...]:
    """Residual, its part above N, and noise factor of one layout, by the solver for one."""
    matrix = np.empty((2 * harmonics, len(torque)))
    matrix[0::2], matrix[1::2] = phasors[:harmonics].real, phasors[:harmonics].imag
    found = compensating_gains(matrix, most_noise=np.inf)
    left = np.abs(phasors @ found.gains) / (found.gains @ torque)
    return left.sum(), left[harmonics:].sum(), found.noise_factor


@pytest.mark.parametrize(("gauges", "harmonics"), [(4, 1), (6, 2), (5, 2)])
def test_every_number_layout_by_layout(gauges: int, harmonics: int) -> None:
    """The same layouts, one after the other."""
    layouts = 101
    tolerances = Tolerances(4.0, 0.1, 3.0, 0.1, 0.5, 2.0)
    case = LayoutCase(
        gauges, harmonics, tolerances, measurement_error_FS=0.0, lost_gauge=True, radius_mm=20.0
    )
    study = study_layout(case, 0.5, layouts, seed=21)
    shape = (layouts, len(case.wave.amplitudes_FS), gauges)
    errors = draw_errors(np.random.default_rng(21), tolerances, 20.0, shape)
    torque, phasors = gauge_signals(case.wave, errors)
    whole, lost, untuned = [], [], []
    for seen, signal in zip(phasors, torque, strict=True):
        whole.append(of_one_layout(seen, signal, harmonics))
        others = [np.delete(np.arange(gauges), j) for j in range(gauges)]
        each = [of_one_layout(seen[:, kept], signal[kept], harmonics) for kept in others]
        lost.append(np.max(each, axis=0))
        equal = [np.abs(seen[:, kept].sum(axis=1)).sum() / signal[kept].sum() for kept in others]
        untuned.append(max(equal))
    assert study.lost_tuned is not None
    assert study.lost_untuned is not None
    for values, found in (
        (np.array(whole)[:, 0], study.tuned.residual_FS),
        (np.array(whole)[:, 1], study.parts_FS["above_N"]),
        (np.array(whole)[:, 2], study.tuned.noise_factor),
        (np.array(lost)[:, 0], study.lost_tuned.residual_FS),
        (np.array(lost)[:, 2], study.lost_tuned.noise_factor),
        (np.array(untuned), study.lost_untuned.residual_FS),
    ):
        # Of 101 values the percentiles 5, 50 and 95 are the 6th, the 51st and the 96th.
        expected = np.sort(values)[[5, 50, 95]]
        assert list(found.values()) == pytest.approx(list(expected), rel=1e-4)


def test_refused_layouts_count_as_failed() -> None:
    case = electrical(45, wave=Wave((56.7,)), measurement_error_FS=0.0)
    found = study_layout(case, 1e6, TRIALS).tuned
    assert 0.13 < found.refused_share < 0.15
    assert found.met_limit == pytest.approx(1 - found.refused_share)
    accepting = study_layout(replace(case, most_noise=np.inf), 1e6, TRIALS).tuned
    assert accepting.refused_share == 0.0
    assert accepting.met_limit == 1.0


def test_a_harmonic_below_the_measurement_error_is_named() -> None:
    wrong = LayoutCase(9, 4, Tolerances(position_deg=1.0))
    assert any("Harmonic 4" in sentence for sentence in remarks(wrong))
    found = study_layout(wrong, 0.5, 5000).tuned
    better = study_layout(replace(wrong, harmonics=2), 0.5, 5000).tuned
    assert found.noise_factor[95] > 5 * better.noise_factor[95]
    assert remarks(replace(wrong, harmonics=2)) == ()


def test_a_harmonic_that_does_not_exist_asks_nothing() -> None:
    one = LayoutCase(5, 1, Tolerances(position_deg=3.0), Wave((56.7, 0.0)))
    two = replace(one, harmonics=2)
    assert study_layout(one, 0.5, 1000).tuned == study_layout(two, 0.5, 1000).tuned


def test_assumptions_name_the_paper_only_for_its_wave() -> None:
    assert any("Godler" in sentence for sentence in assumptions(electrical(5)))
    assert not any("Godler" in each for each in assumptions(electrical(5, wave=Wave((30.0,)))))
    assert "18.9 %FS" in assumptions(electrical(5))[0]


def test_a_seed_is_the_same_layouts() -> None:
    first = study_layout(electrical(20), 0.5, 15_000, seed=7)
    assert first == study_layout(electrical(20), 0.5, 15_000, seed=7)
    other = study_layout(electrical(20), 0.5, 15_000, seed=8)
    assert first.tuned.residual_FS != other.tuned.residual_FS


@settings(max_examples=25, deadline=None)
@given(
    gauges=st.integers(2, 9),
    harmonics=st.integers(1, 4),
    position_deg=st.floats(0.0, 90.0),
    amplitude=st.floats(0.0, 1.0),
    angular_deg=st.floats(0.0, 15.0),
    radial_mm=st.floats(0.0, 100.0),
    seed=st.integers(0, 2**40),
)
def test_whatever_the_tolerances_numbers_come_out(
    gauges: int,
    harmonics: int,
    position_deg: float,
    amplitude: float,
    angular_deg: float,
    radial_mm: float,
    seed: int,
) -> None:
    tolerances = Tolerances(
        position_deg, amplitude, gauge_factor=0.1, radial_mm=radial_mm, angular_deg=angular_deg
    )
    case = LayoutCase(gauges, harmonics, tolerances, lost_gauge=True)
    study = study_layout(case, 0.5, 40, seed)
    for found in every(study):
        values = list(found.residual_FS.values())
        assert np.all(np.isfinite(values))
        assert values == sorted(values)
        assert min(values) >= 0
        assert min(found.noise_factor.values()) >= 1 - 1e-6
        assert 0 <= found.met_limit <= 1 - found.refused_share + 1e-12
    assert study.lost_tuned is not None
    assert study.untuned.negative_gain_share == 0


def every(study: LayoutStudy) -> list[Any]:
    found = (study.tuned, study.untuned, study.lost_tuned, study.lost_untuned)
    return [each for each in found if each is not None]


@settings(max_examples=30, deadline=None)
@given(limit_FS=st.floats(0.01, 10.0), more=st.floats(1.0, 10.0), position_deg=st.floats(0.1, 20.0))
def test_a_wider_limit_is_met_by_no_fewer(
    limit_FS: float, more: float, position_deg: float
) -> None:
    case = LayoutCase(4, 1, Tolerances(position_deg))
    narrow = study_layout(case, limit_FS, 100)
    wide = study_layout(case, limit_FS * more, 100)
    assert narrow.tuned.met_limit <= wide.tuned.met_limit
    assert narrow.untuned.met_limit <= wide.untuned.met_limit


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"gauges": 1}, "gauges = 1: expected a whole number from 2 to 9"),
        ({"gauges": 2.5}, "gauges = 2.5: expected a whole number from 2 to 9"),
        ({"harmonics": 5}, "harmonics = 5: expected a whole number from 1 to 4"),
        ({"measurement_error_FS": -1.0}, "measurement_error_FS = -1.0 %FS"),
        ({"radius_mm": float("nan")}, "radius_mm = nan: expected a number"),
        ({"most_noise": 0.5}, "most_noise = 0.5: expected at least 1"),
    ],
)
def test_a_case_that_cannot_be(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match="expected") as caught:
        LayoutCase(**({"gauges": 3, "harmonics": 1} | arguments))
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"limit_FS": 0.0}, "limit_FS = 0.0 %FS: expected"),
        ({"trials": 10_000_001}, "trials = 10000001: expected a whole number from 1 to 10000000"),
        ({"trials": "many"}, "trials = 'many'"),
        ({"seed": -1}, "seed = -1"),
    ],
)
def test_a_study_that_cannot_be(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as caught:
        study_layout(electrical(5), **({"limit_FS": 0.5} | arguments))
    assert words in str(caught.value)


@pytest.mark.parametrize(
    "build",
    [
        lambda: Tolerances(position_deg=-1.0),
        lambda: Tolerances(amplitude=float("inf")),
        lambda: Tolerances(gauge_factor=0.5),
        lambda: Wave(()),
        lambda: Wave((0.0, 1.0)),
        lambda: Wave((1.0, -1.0)),
        lambda: Wave((1.0,), normal_strain_ratio=float("nan")),
        lambda: LayoutCase(5, 2, wave=Wave((1.0,))),
    ],
)
def test_other_things_that_cannot_be(build: Any) -> None:
    with pytest.raises(InputError, match="expected"):
        build()
