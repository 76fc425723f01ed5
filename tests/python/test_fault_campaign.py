"""The fault campaign in small: every kind on one gauge; and the table that the documentation shows."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.faults.campaign import (
    KINDS,
    Case,
    all_cases,
    commissioned,
    run_case,
    run_sound,
    summary_of,
)
from benchmarks.faults.table import markdown_of
from strainwave.simulate import FaultKind

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "faults.json"
PAGE = ROOT / "docs" / "design" / "lost-gauge.md"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("condition", ["speed", "rest"])
def test_fault_is_found_and_the_torque_goes_on(condition: str, kind: FaultKind) -> None:
    # Seed 4 loads the gauges at rest with more than the comparison's limit.
    found = run_case(Case(condition, kind, gauge=2, seed=4))
    assert found["found"]
    assert found["right_gauge"]
    assert found["right_name"]
    assert not found["false"]
    assert not found["invalid"]
    # 10 samples, or 14 equal codes; in motion the signals may agree for a part of a wave.
    assert 0.008 < found["time_s"] < (0.1 if condition == "speed" else 0.016)
    assert found["left_out_s"] <= found["time_s"]
    # Four gauges leave the second harmonic, a twentieth of 57 %FS, and what load adds to it.
    assert 0.8 < found["stated_percent"] < 1.3
    assert found["after_percent"] < 4


def test_sound_gauges_are_left_in_peace_for_two_minutes() -> None:
    sound = run_sound(1)
    assert sound["hours"] == pytest.approx(1 / 30)
    assert sound["losses"] == 0
    assert sound["suspected_samples"] == 0


@pytest.mark.slow
def test_no_false_loss_in_three_hours() -> None:
    sound = [run_sound(seed) for seed in range(5000, 5090)]
    assert sum(each["hours"] for each in sound) == pytest.approx(3.0)
    assert sum(each["losses"] for each in sound) == 0


def test_gains_of_the_station_are_those_of_four_and_of_five() -> None:
    _, config = commissioned()
    assert config.monitor is not None
    assert sum(config.gains.values) == pytest.approx(5, rel=1e-9)
    assert config.monitor.residual_fluctuation_V < 1e-9
    for each in config.monitor.without:
        assert sum(each.gains) == pytest.approx(5, rel=1e-9)
        assert each.gains[each.gauge - 1] == 0
    assert [each.gauge for each in config.monitor.without] == [1, 2, 3, 4, 5]


def test_campaign_has_every_gauge_kind_and_condition() -> None:
    cases = all_cases(3)
    assert len(cases) == len(set(cases)) == 2 * 5 * 5 * 3


def test_summary_counts_what_was_missed() -> None:
    cases = [Case("rest", FaultKind.SHORT, 0, seed) for seed in range(2)]
    one = run_case(cases[0])
    missed = {**one, "found": False, "found_at_last": True, "until_found_percent": 2.5}
    (row,) = summary_of(cases, [{**one, "found": True, "time_s": 0.01}, missed])
    assert (row["runs"], row["found"], row["found_when_moving_on"]) == (
        2,
        1,
        1 + int(one["found_at_last"]),
    )
    assert row["error_not_found_largest"] == 2.5
    assert row["time_median_ms"] == pytest.approx(10)


def test_table_of_the_documentation_is_that_of_the_results() -> None:
    results = json.loads(RESULTS.read_text(encoding="utf-8"))
    assert markdown_of(results) in PAGE.read_text(encoding="utf-8")
    assert results["seeds"] == 20
    assert results["sound"]["hours"] >= 10
    assert np.sum([row["runs"] for row in results["rows"]]) == 1000
