"""The speed bench's results on record: complete, said as they are, and the same in the documentation."""

import json
import re
from pathlib import Path

import pytest

from benchmarks.speed.figures import FIGURES
from benchmarks.speed.machine import best_level
from benchmarks.speed.table import BEGIN, END, markdown_of, number, with_tables
from benchmarks.speed.targets import Target, targets

ROOT = Path(__file__).parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "latest.json"
PAGE = ROOT / "docs" / "reference" / "bench.md"
ASKED_FOR = (
    *(
        f"published_single_vs_{peer}"
        for peer in ("eigen", "filterpy", "statsmodels", "pykalman", "simdkalman", "numba")
    ),
    *(f"published_single_vs_{peer}" for peer in ("jax", "minikalman", "numpy")),
    "published_batch_vs_eigen",
    "batch_share_of_issue_bound",
    "batch_two_cores_vs_one",
    "default_single_vs_eigen",
    "default_single_vs_numba",
    "default_batch_vs_numba",
    "default_batch_share_of_issue_bound",
    "long_log_vs_sequential",
    "long_log_share_of_bandwidth",
    "default_long_log_vs_sequential",
    "long_log_difference_rms_Nm",
    "step_vs_empty_bound_function",
    "filter_command_vs_polars",
    "filter_command_peak_memory_bytes",
)


@pytest.fixture(scope="module")
def results():
    return json.loads(RESULTS.read_text(encoding="utf-8"))


def test_every_result_asked_for_is_on_record(results):
    assert tuple(targets("v4")) == ASKED_FOR
    for name, target in targets(results["machine"]["vector_level"]).items():
        each = results[name]
        assert set(each) == {"value", "target", "met", "how"}
        assert each["how"].startswith(target.how)
        # What is recorded as met follows from the value, whoever wrote it down.
        assert each == target.result(each["value"]) or each["value"] is None
        if each["value"] is None:
            assert "not available: " in each["how"]
            assert not each["met"]


def test_the_record_is_of_a_whole_bench(results):
    assert results["run"]["quick"] is False
    assert results["run"]["rounds"] >= 9
    assert results["run"]["duration_s"] < 1200
    assert {each["samples"] for each in results["scaling"]["log_length"]} == {
        10**power for power in range(4, 9)
    }
    assert {each["channels"] for each in results["scaling"]["channels"]} >= {1, 64, 4096}
    states = {each["states"] for each in results["scaling"]["states"]}
    assert (min(states), max(states)) == (4, 31)


def test_every_implementation_is_timed_or_said_why_not(results):
    for row in results["implementations"]:
        assert (row["ns_per_sample"] is None) == (row["not_available"] is not None)
        if row["ns_per_sample"] is not None:
            assert row["difference_rms_Nm"] < 0.05
            share = row["limit_ns"] / row["ns_per_sample"]
            assert row["share_of_limit"] == pytest.approx(share, rel=0.5)
            assert 0 < row["share_of_limit"] < 1
            assert row["peak_memory_bytes"] > 1e6
    for log in results["long_logs"]:
        for way in log["ways"].values():
            assert way.get("peak_memory_bytes", 0) < 4e9


def test_shares_and_ratios_follow_from_the_times(results):
    # The ratio is a median within rounds, so that it only comes near the medians' own.
    times = {
        (row["filter"], row["name"]): row["ns_per_sample"] for row in results["implementations"]
    }
    for row in results["implementations"]:
        if row["ns_per_sample"] is not None:
            quotient = row["ns_per_sample"] / times[row["filter"], "core"]
            assert row["ratio"] == pytest.approx(quotient, rel=0.5)


def test_machine_is_described_without_its_name(results):
    machine = results["machine"]
    assert {"processor", "vector_level", "caches", "cores", "compiler", "python"} <= set(machine)
    assert not {"host", "hostname", "node"} & set(machine)
    rates = results["limits"]["operations_per_s"]
    assert all(rates[level]["float"] > rates[level]["double"] for level in rates)


def test_tables_of_the_documentation_are_those_of_the_record(results):
    page = PAGE.read_text(encoding="utf-8")
    assert with_tables(page, markdown_of(results)) == page


def test_curves_of_the_documentation_are_there():
    page = PAGE.read_text(encoding="utf-8")
    shown = re.findall(r"\.\./images/(speed-[a-z-]+\.svg)", page)
    assert sorted(shown) == sorted(FIGURES)
    for name in FIGURES:
        assert "<svg" in (ROOT / "docs" / "images" / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("draw", FIGURES.values(), ids=FIGURES)
def test_curves_are_drawn_from_the_record(results, draw):
    assert "<svg" in draw(results)


def test_tables_are_put_between_their_marks():
    page = f"before\n{BEGIN}\nold\n{END}\nafter\n"
    assert with_tables(page, "new\n") == f"before\n{BEGIN}\nnew\n{END}\nafter\n"


@pytest.mark.parametrize(
    ("target", "value", "met"),
    [
        (Target("a", least=5.0), 5.0, True),
        (Target("a", least=5.0), 4.99, False),
        (Target("a", most=2.0), 2.0, True),
        (Target("a", most=2.0), 2.01, False),
        (Target("a"), 7.0, None),
    ],
)
def test_met_is_met(target, value, met):
    assert target.result(value)["met"] is met


@pytest.mark.parametrize("value", [None, float("nan"), float("inf")])
def test_what_is_not_available_is_not_met(value):
    found = Target("a", least=5.0).result(value, "no compiler")
    assert found == {
        "value": None,
        "target": 5.0,
        "met": False,
        "how": "a; not available: no compiler",
    }


@pytest.mark.parametrize(
    ("flags", "level"),
    [
        ("", "v1"),
        ("sse4_2 ssse3 popcnt cx16", "v2"),
        ("sse4_2 ssse3 popcnt cx16 avx2 bmi1 bmi2 fma f16c movbe abm", "v3"),
        ("avx512f avx512bw avx512cd avx512dq avx512vl", "v1"),
    ],
)
def test_vector_level_follows_from_the_flags(flags, level):
    assert best_level(set(flags.split())) == level


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (1234.5, "1,230"), (0.0123, "0.0123"), (5.0, "5"), (2.5e-5, "2.5e-05"), (0, "0")],
)
def test_numbers_are_readable(value, text):
    assert number(value) == text


def test_minikalman_says_the_version_that_is_pinned():
    folder = ROOT / "benchmarks" / "speed" / "rust"
    named = (folder / "Cargo.toml").read_text(encoding="utf-8")
    (pinned,) = re.findall(r'minikalman = { version = "=([0-9.]+)"', named)
    assert f'"{pinned}' in (folder / "src" / "main.rs").read_text(encoding="utf-8").replace(
        "\\", ""
    )


def test_lock_of_the_peers_has_hashes_and_no_addresses():
    text = (ROOT / "requirements-bench.lock").read_text(encoding="utf-8")
    packages = re.findall(r"^([a-z0-9-]+)==", text, re.MULTILINE)
    assert {"filterpy", "pykalman", "statsmodels", "simdkalman", "numba", "jax", "polars"} <= set(
        packages
    )
    assert text.count("--hash=sha256:") >= len(packages)
    assert "://" not in text
