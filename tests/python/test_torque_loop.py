"""The torque loop of the examples: clean torque in it, raw torque, and theory."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "examples/python/torque_loop.py"
HOW_TO = (ROOT / "docs/how-to/torque-loop.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def loop():
    spec = importlib.util.spec_from_file_location("torque_loop", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules["torque_loop"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def kept(loop):
    return loop.commissioned()


@pytest.fixture(scope="module")
def raw(loop):
    return loop.run_loop(loop.whole_run_speed, loop.DURATION_S)


def clean_run(loop, *learned):
    clean = loop.ripple_filter(loop.learning_speed(loop.BANDWIDTH_HZ), *learned)
    return loop.run_loop(loop.whole_run_speed, loop.DURATION_S, clean=clean)


def test_clean_torque_halves_the_error_at_least(loop, raw, kept):
    ratio = clean_run(loop, kept).error_rms() / raw.error_rms()
    assert 0.10 < ratio < 0.22


def test_so_it_does_while_it_still_learns(loop, raw):
    ratio = clean_run(loop).error_rms() / raw.error_rms()
    assert 0.35 < ratio < 0.5


def test_raw_error_is_the_ripple_through_the_closed_loop(loop, raw):
    predicted = loop.predicted_over(loop.whole_run_speed, loop.DURATION_S, loop.BANDWIDTH_HZ)
    assert raw.error_rms() == pytest.approx(predicted, rel=0.06)


def test_nothing_of_the_artefact_is_in_the_true_torque_before_the_loop_is_closed(loop):
    joint = loop.Joint(angle_rad=1.0, torque_Nm=5.0)
    joint.advance(0.0, np.full(8, 1.0 / 100 - 5.0 / 500))
    assert joint.torque_Nm == pytest.approx(5.0, abs=0.3)
    assert abs(loop.artefact(joint)) > 0.1


def test_a_sensor_without_ripple_is_the_bound(loop, kept):
    _, clean, ideal = loop.steady_errors(150.0, 15.0, kept)
    assert 0.005 < ideal < 0.03
    assert ideal < clean < 0.06


def test_raw_torque_is_as_good_where_the_loop_is_slow(loop, kept):
    raw_Nm, clean_Nm, _ = loop.steady_errors(150.0, 1.0, kept)
    assert 0.98 < clean_Nm / raw_Nm < 1.02


def test_learning_below_the_limit_makes_it_worse_and_kept_coefficients_do_not(loop, kept):
    raw_Nm, learning_Nm, frozen_Nm = loop.slow_errors(kept)
    assert 1.05 < learning_Nm / raw_Nm < 1.5
    assert 0.1 < frozen_Nm / raw_Nm < 0.35


def test_the_limit_of_learning_is_where_the_loops_answer_turns(loop):
    crossover = 2 * np.pi * 15.0
    speed = loop.learning_speed(15.0) / 1.25
    for share, sign in ((0.99, -1), (1.01, 1)):
        s = 2j * speed * share
        answer = 1 / (1 + crossover * (s + loop.CORNER_SHARE * crossover) / s**2)
        assert np.sign(answer.real) == sign


def test_every_sample_goes_through_the_filter(loop, kept):
    clean = loop.ripple_filter(5.0, kept)
    run = loop.run_loop(loop.whole_run_speed, 3.0, clean=clean)
    assert clean.counters["samples"] == run.time_s.size
    assert not np.array_equal(run.used_Nm, run.sensed_Nm)


def test_same_seed_same_run(loop):
    first, second = (loop.run_loop(loop.whole_run_speed, 1.0) for _ in range(2))
    assert np.array_equal(first.true_Nm, second.true_Nm)


def printed(*options):
    run = subprocess.run(
        [sys.executable, SCRIPT, *options], capture_output=True, text=True, check=True
    )
    return run.stdout


def shown(text):
    """Return words and numbers of a text without what draws tables."""
    return [line.replace("|", " ").split() for line in text.splitlines()]


def test_the_page_shows_what_the_example_prints(tmp_path):
    figure = tmp_path / "torque-loop.svg"
    lines = printed("--figure", str(figure)).splitlines()
    assert len(lines) == 7
    for line in lines:
        assert line in HOW_TO
    assert figure.read_text(encoding="utf-8").startswith("<?xml")
    assert "](../images/torque-loop.svg)" in HOW_TO
    assert (ROOT / "docs/images/torque-loop.svg").stat().st_size < 400_000


@pytest.mark.slow
def test_the_page_shows_the_table():
    rows = shown(printed("--table"))[8:-1]
    assert len(rows) == 16
    page = shown(HOW_TO)
    for row in rows:
        assert row in page
