"""What the survey finds in a log, and what is said of it."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from helpers.log_files import layout_of, run
from strainwave.records.findings import warnings_of
from strainwave.records.histogram import LogHistogram
from strainwave.records.layout import Layout
from strainwave.records.survey import Survey, estimated_rated_torque_Nm

KEYS = ("time", "angle", "torque")


def log(rows: int = 5000, seed: int = 2) -> dict[str, np.ndarray]:
    time = np.arange(rows) / 1000.0
    torque = np.random.default_rng(seed).normal(0.0, 3.0, rows)
    return {"time": time, "angle": 25.0 * time, "torque": torque}


def said(columns: dict[str, np.ndarray], layout: Layout | None = None, rated: float = 10.0) -> str:
    layout = layout or layout_of(columns, rated_torque_Nm=rated, rated_torque_source="option")
    return "\n".join(warnings_of(layout, run(columns, layout)[1], rated))


def surveyed(columns: dict[str, np.ndarray], layout: Layout | None = None) -> Survey:
    return run(columns, layout or layout_of(columns))[1]


def test_nothing_is_said_of_a_good_log() -> None:
    assert said(log()) == ""
    survey = surveyed(log())
    assert survey.rows == 5000
    assert survey.timing.duration_s == pytest.approx(4.999)
    assert survey.timing.rate_Hz == pytest.approx(1000.0, rel=1e-9)
    assert survey.moving.typical_speed_rad_s == pytest.approx(25.0, rel=1e-6)
    assert survey.moving.largest_speed_rad_s == pytest.approx(25.0, rel=1e-6)
    assert survey.share_at_rest <= 0.001
    assert survey.moving.repeated_rows == 0


def test_quantiles() -> None:
    values = np.random.default_rng(1).lognormal(0.0, 2.0, 20_000)
    histogram = LogHistogram()
    histogram.add(values[:5])
    histogram.add(values[5:])
    for share in (0.0, 0.01, 0.5, 0.99, 1.0):
        assert histogram.quantile(share) == pytest.approx(np.quantile(values, share), rel=0.01)
    assert histogram.count_above(1.0) == pytest.approx((values > 1.0).sum(), rel=0.01)
    assert LogHistogram().quantile(0.5) is None


def test_jitter() -> None:
    columns = log()
    random = np.random.default_rng(4)
    columns["time"] = np.cumsum(0.001 * random.lognormal(0.0, 0.6, 5000))
    timing = surveyed(columns).timing
    intervals = np.diff(columns["time"])
    assert timing.median_interval_s == pytest.approx(np.median(intervals), rel=0.005)
    assert timing.interval_99th_percentile_s == pytest.approx(
        np.quantile(intervals, 0.99), rel=0.03
    )
    assert timing.interval_1st_percentile_s == pytest.approx(np.quantile(intervals, 0.01), rel=0.03)
    assert timing.largest_interval_s == pytest.approx(intervals.max())
    assert "the time stamps jitter: rows are 0." in said(columns)


def test_gaps() -> None:
    columns = log()
    columns["time"][1000:] += 1.0
    columns["time"][3000:] += 0.3
    columns["time"][4000:] += 0.005
    timing = surveyed(columns).timing
    assert (timing.gaps, timing.first_gap_row) == (2, 1001)
    assert timing.largest_interval_s == pytest.approx(1.001)
    assert "there are 2 gaps in time, the longest 1.001 s (first: before row 1001)" in said(columns)


def test_a_slow_recording_is_no_row_of_gaps() -> None:
    columns = log()
    columns["time"] = np.arange(5000.0)
    assert surveyed(columns).timing.gaps == 0


def test_rows_out_of_order() -> None:
    columns = log()
    columns["time"][[2000, 2001]] = columns["time"][[2001, 2000]]
    columns["time"][3000] = columns["time"][2999]
    timing = surveyed(columns).timing
    assert (timing.out_of_order_rows, timing.first_out_of_order_row) == (2, 2002)
    assert (
        "time goes back or stands still at 2 rows (first: row 2002); these rows are rejected and "
        "flagged sample_out_of_order"
    ) in said(columns)


def test_repeated_samples_in_motion_and_at_rest() -> None:
    columns = log()
    repeated = np.random.default_rng(5).random(5000) < 0.1
    repeated[0] = False
    for place in np.flatnonzero(repeated):
        for key in ("angle", "torque"):
            columns[key][place] = columns[key][place - 1]
    survey = surveyed(columns)
    assert survey.share_repeated == pytest.approx(repeated.mean(), abs=0.002)
    # What is held for a row makes the next step no faster.
    assert survey.moving.typical_speed_rad_s == pytest.approx(25.0, rel=0.02)
    assert "% of the rows in motion" in said(columns)

    columns = log()
    columns["angle"][:] = 1.0
    columns["torque"][:] = 4.0
    survey = surveyed(columns)
    assert (survey.moving.repeated_rows, survey.share_at_rest) == (0, 1.0)
    assert "the motor is never faster than 0.5 rad/s" in said(columns)


def test_torque_noise_at_rest() -> None:
    columns = log()
    columns["angle"] = np.maximum(columns["angle"] - 75.0, 0.0)
    columns["torque"] = np.random.default_rng(6).normal(7.0, 0.2, 5000)
    survey = surveyed(columns)
    assert survey.share_at_rest == pytest.approx(0.6, abs=0.01)
    assert survey.moving.rest_torque_noise_Nm == pytest.approx(0.2, rel=0.05)


def test_a_wrapped_angle_is_said() -> None:
    columns = log()
    columns["angle"] = np.mod(columns["angle"], 2.0 * np.pi)
    assert "the angle goes back to its start after every turn (it stays between 0 and 6.2" in said(
        columns
    )


def test_missing_rows_are_counted() -> None:
    columns = log()
    columns["torque"][10:13] = np.nan
    columns["angle"][10] = np.inf
    columns["time"][20] = np.nan
    survey = surveyed(columns)
    assert survey.missing_by_key == {"time": 1, "angle": 1, "torque": 3}
    words = said(columns)
    assert "3 rows of 5000 have no torque; they are rejected and flagged" in words
    assert "1 row of 5000 has no angle; it is rejected and flagged" in words


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (0.01, "of the rated torque of 10 Nm; is the column in volts?"),
        (1000.0, "times the rated torque of 10 Nm; is the column in mNm or in counts?"),
        (0.0, "the torque is 0 throughout"),
    ],
)
def test_an_implausible_scale(factor: float, words: str) -> None:
    columns = log()
    columns["torque"] *= factor
    assert words in said(columns)


@pytest.mark.parametrize(
    ("largest", "estimate"),
    [(9.21, 9.3), (74.15, 75.0), (100.0, 100.0), (0.0312, 0.032), (1234.0, 1300.0), (0.0, 1.0)],
)
def test_the_estimated_rated_torque(largest: float, estimate: float) -> None:
    survey = replace(surveyed(log()), torque_lowest_Nm=-largest, torque_highest_Nm=0.0)
    assert estimated_rated_torque_Nm(survey) == estimate
    layout = layout_of(KEYS)
    assert any(
        f"{estimate:g} Nm is taken as an estimate" in sentence
        for sentence in warnings_of(layout, survey, estimate)
    )


def test_bursts_of_rows_make_nothing_fast() -> None:
    columns = log()
    # Four rows are stamped when their packet arrives.
    columns["time"] = np.floor(np.arange(5000) / 4) * 0.004 + np.arange(5000) % 4 * 1e-7
    survey = surveyed(columns, layout_of(KEYS, side="output", ratio=Fraction(10)))
    assert survey.moving.speed_99th_percentile_rad_s == pytest.approx(250.0, rel=0.2)


def test_a_counter_of_several_turns_that_overflows_is_said() -> None:
    columns = log()
    columns["angle"] = np.mod(columns["angle"], 16.0 * 2.0 * np.pi)
    survey = surveyed(columns)
    assert not survey.angle_is_wrapped
    assert "the angle jumps, as where values are lost or a counter" in said(columns)


def test_an_angle_with_some_noise_at_its_ends_is_wrapped_too() -> None:
    columns = log()
    columns["angle"] = np.round(np.mod(columns["angle"], 2.0 * np.pi), 1)
    survey = surveyed(columns)
    assert survey.angle_highest_rad == pytest.approx(6.3)
    assert survey.angle_is_wrapped
