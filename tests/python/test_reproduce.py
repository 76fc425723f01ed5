"""Both papers' numbers from the simulated stations."""

import numpy as np
import pytest

from strainwave.filter import OscillatorFilter
from strainwave.reproduce import (
    godler2000,
    godler2000_comparison,
    published,
    taghirad1999,
    taghirad1999_comparison,
)
from strainwave.reproduce.comparison import Comparison, tallies, tally_sentence, within
from strainwave.reproduce.tuning import (
    FOUR_STATES,
    FOUR_STATES_SLOW,
    SETTLING_S,
    SIX_STATES,
    SMALL_CONFIG,
    tuning_study,
)

#: Source, beginning of the quantity, our number, tolerance.
REGRESSION = (
    ("G fig. 3(b)", "fluctuation", 4.14, 0.03),
    ("G section II-A", "one gauge", 9.48, 0.08),
    ("G section II-B", "basic over double", 20.4, 0.1),
    ("G fig. 4", "linearity", 1.98, 0.05),
    ("G fig. 6", "fluctuation", 0.96, 0.03),
    ("G fig. 7", "linearity", 0.49, 0.03),
    ("G fig. 9(b)", "fluctuation", 2.04, 0.03),
    ("G fig. 10", "fluctuation", 0.21, 0.01),
    ("G fig. 11", "linearity", 1.20, 0.05),
    ("T Table I", "torque sensor gain", 6.62, 0.03),
    ("T Table I", "consistency", 2.06, 0.1),
    ("T fig. 10", "misalignment", 10.03, 0.02),
    ("T section VI", "misalignment", 1.60, 0.02),
)


@pytest.fixture(scope="module")
def taghirad() -> taghirad1999.Taghirad1999:
    return taghirad1999.run()


@pytest.fixture(scope="module")
def godler() -> godler2000.Godler2000:
    return godler2000.run()


@pytest.fixture(scope="module")
def compared(
    taghirad: taghirad1999.Taghirad1999, godler: godler2000.Godler2000
) -> dict[tuple[str, str], Comparison]:
    groups = (
        *taghirad1999_comparison.comparisons(taghirad).values(),
        *godler2000_comparison.comparisons(godler).values(),
    )
    return {(entry.source, entry.quantity): entry for group in groups for entry in group}


def test_every_published_number_is_within_its_band(
    compared: dict[tuple[str, str], Comparison],
) -> None:
    assert [entry for entry in compared.values() if not entry.agrees] == []
    assert all(entry.band for entry in compared.values())


def test_kinds_are_counted_and_hardly_anything_is_found(
    compared: dict[tuple[str, str], Comparison],
) -> None:
    counts = {tally.kind: tally.compared for tally in tallies(compared.values())}
    assert counts == {"found": 1, "matched": 12, "recovered": 10, "computed": 3}


def test_published_numbers_are_those_of_the_papers() -> None:
    # As printed, typed from the papers once more.
    assert published.SENSOR_GAIN_NM_PER_V == 6.60
    assert published.CONSISTENCY_MEASURE == 0.02
    assert published.MOTOR_SPEED_RAD_S == 156
    assert (published.FUNDAMENTAL_RAD_S, published.FIRST_HARMONIC_RAD_S) == (312, 624)
    assert published.THREE_GAUGE_AMPLITUDES == (1, 1.07, 1.15)
    assert published.THREE_GAUGE_PHASE_ERRORS_DEG == (0, -1.5, -0.4)


@pytest.mark.parametrize(
    ("source", "quantity", "ours", "tolerance"),
    REGRESSION,
)
def test_numbers_with_wide_bands_have_not_moved(
    compared: dict[tuple[str, str], Comparison],
    source: str,
    quantity: str,
    ours: float,
    tolerance: float,
) -> None:
    # The bands are as wide as the papers' words; these are as tight as the simulation repeats.
    entry = next(
        entry
        for (place, name), entry in compared.items()
        if place == source and name.startswith(quantity)
    )
    assert entry.ours == pytest.approx(ours, abs=tolerance)


def test_linearity_is_read_over_a_closed_loop(godler: godler2000.Godler2000) -> None:
    for build in (godler.two, godler.four, godler.three_compensated):
        # From full load down to the other full load and back, every torque on both branches.
        assert build.loads_Nm[0] == build.loads_Nm[-1] == 100
        assert build.loads_Nm.min() == -100
        assert len(build.loads_Nm) == 41
        # The hysteresis has been run in: the loop ends where it began, up to noise.
        ends = build.linearity_error_FS[[0, -1]]
        assert np.ptp(ends) < 2e-4
        # It is a loop: at no load the branches lie apart.
        at_zero = build.linearity_error_FS[build.loads_Nm == 0]
        assert np.ptp(at_zero) > 1e-3


def test_three_gauges_lie_between_four_and_two(godler: godler2000.Godler2000) -> None:
    assert (
        godler.four.linearity_FS < godler.three_compensated.linearity_FS < godler.two.linearity_FS
    )


def test_compensated_turn_is_not_the_one_that_the_gains_were_found_on(
    godler: godler2000.Godler2000,
) -> None:
    # One station, two draws of its noise.
    assert np.any(godler.three_compensated.signals_FS != godler.three.signals_FS)
    assert godler.three_compensated.periodic_FS == pytest.approx(
        godler.three_compensated.sum_FS, abs=1e-3
    )


def test_peaks_lie_at_the_meshs_orders(taghirad: taghirad1999.Taghirad1999) -> None:
    # Circular spline fixed, R = 100: 2 (R+1)/R and 4 (R+1)/R times the speed of that interval.
    spectrum = taghirad.spectrum
    for order, peak in zip((2.02, 4.04), spectrum.peaks_rad_s, strict=True):
        assert peak == pytest.approx(order * spectrum.speed_rad_s, rel=0.005)


def test_no_sample_of_the_clean_stations_is_rejected(
    taghirad: taghirad1999.Taghirad1999,
) -> None:
    assert [each.rejected for each in (*taghirad.ripple, *taghirad.misalignment)] == [0] * 4


def test_published_filter_removes_ripple_where_the_torque_is_expected(
    taghirad: taghirad1999.Taghirad1999,
) -> None:
    for experiment in taghirad.ripple:
        assert experiment.ripple_rms_Nm() > 1.0
        assert 0.01 < experiment.left_rms_Nm() < 0.2
        assert 0.01 < experiment.error_rms_Nm() < 0.25
    for experiment in taghirad.misalignment:
        # 10 Nm peak to peak of misalignment is 3.5 Nm rms.
        assert 3.0 < experiment.raw_error_rms_Nm() < 4.5
        assert 0.01 < experiment.error_rms_Nm() < 0.25


def test_gains_of_run_and_paper_agree(godler: godler2000.Godler2000) -> None:
    assert godler.compensation.from_run.gains == pytest.approx(
        godler.compensation.from_paper.gains, abs=5e-4
    )
    # The null space of eq. (9) for 1 : 1.07 : 1.15 and 0 : -1.5 : -0.4 degrees, sum 3.
    assert godler.compensation.from_paper.gains == pytest.approx([1.0586, 0.9966, 0.9448], abs=5e-5)


def test_three_vectors_close_and_two_do_not(godler: godler2000.Godler2000) -> None:
    closed = np.sum([[v.sine, v.cosine] for v in godler.vectors_three], axis=0)
    assert closed == pytest.approx([0.0, 0.0], abs=1e-9)
    opened = np.hypot(*np.sum([[v.sine, v.cosine] for v in godler.vectors_two], axis=0))
    # Two nearly opposite vectors of angle error 1.5 degrees.
    assert 0.02 < opened < 0.04


def test_null_space_starts_at_the_minimum_number_of_gauges(godler: godler2000.Godler2000) -> None:
    assert [(c.gauges, c.harmonics, c.solutions) for c in godler.gauge_counts] == [
        (2, 1, 0),
        (3, 1, 1),
        (4, 2, 0),
        (5, 2, 1),
        (6, 3, 0),
        (7, 3, 1),
    ]


def test_tuning_study_says_what_the_theory_says() -> None:
    study = tuning_study()
    at_1_Hz = {
        name: float(
            np.interp(
                1.0,
                study.by_name(name).pass_through.frequency_Hz,
                study.by_name(name).pass_through.gain_dB,
            )
        )
        for name in (FOUR_STATES, SIX_STATES, FOUR_STATES_SLOW)
    }
    assert at_1_Hz[FOUR_STATES] == pytest.approx(-5.5, abs=0.1)
    assert at_1_Hz[SIX_STATES] == pytest.approx(-37.0, abs=0.6)
    assert at_1_Hz[FOUR_STATES_SLOW] == pytest.approx(-17.0, abs=0.2)


@pytest.mark.parametrize("order", [2, 4])
def test_small_tuning_learns_new_ripple_with_the_time_constant_of_theory(order: int) -> None:
    # The ripple's amplitude doubles at 4 s; what is left of it decays exponentially.
    period_s, speed_rad_s, block = SMALL_CONFIG.sample_period_s, 156.0, 40
    time_s = period_s * np.arange(5500)
    ripple = np.where(time_s < 4.0, 1.0, 2.0) * np.sin(order * speed_rad_s * time_s)
    left = np.asarray(
        OscillatorFilter(SMALL_CONFIG)
        .process(ripple, motor_speed_rad_s=np.full(len(time_s), speed_rad_s))
        .torque_Nm
    )[4000:5480]
    envelope = np.sqrt(2 * np.mean(left.reshape(-1, block) ** 2, axis=1))
    slope = np.polyfit(period_s * block * np.arange(len(envelope)), np.log(envelope), 1)[0]
    assert envelope[0] == pytest.approx(0.96, abs=0.03)
    assert -1 / slope == pytest.approx(SETTLING_S, rel=0.01)
    assert pytest.approx(0.4472, abs=1e-4) == SETTLING_S


def test_comparison_can_be_missed_on_both_sides() -> None:
    def compare(ours: float) -> Comparison:
        return within(
            "T",
            "x",
            "2 %",
            ours,
            unit="%",
            decimals=1,
            expected=2.0,
            tolerance=0.1,
            band="±10 %",
            kind="found",
        )

    assert [compare(x).agrees for x in (1.79, 1.81, 2.19, 2.21)] == [False, True, True, False]
    assert not compare(float("nan")).agrees
    assert (compare(-2.04).ours_text, compare(2.0).accepted_text) == (
        "\N{MINUS SIGN}2.0 %",
        "1.8 to 2.2 %",
    )
    assert (compare(2.0).verdict, compare(3.0).verdict) == ("agrees", "MISSED")
    assert tally_sentence([compare(2.0), compare(3.0)]) == (
        "1 of 2 found, 0 matched, 0 recovered, 0 computed"
    )
