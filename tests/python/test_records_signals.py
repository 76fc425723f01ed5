"""From columns to samples: however a log is cut the samples are the same, and they are right."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.log_files import layout_of, run
from strainwave.records.signals import SpeedIntegration, Unwrapping
from strainwave.records.survey import Survey


def motion(rows: int, seed: int = 1) -> dict[str, np.ndarray]:
    """Jitter, a rest, held samples, missing values, a row out of order: everything at once."""
    random = np.random.default_rng(seed)
    time = np.cumsum(0.001 * random.uniform(0.5, 1.5, rows))
    speed = 40.0 * np.sin(5.0 * time)
    speed[rows // 3 : rows // 2] = 0.0
    angle = np.cumsum(speed * np.diff(time, prepend=0.0))
    torque = random.normal(0.0, 5.0, rows)
    for values in (angle, torque):
        values[1::4] = values[: len(values[1::4]) * 4 : 4]
    angle[random.integers(0, rows, rows // 20)] = np.nan
    torque[random.integers(0, rows, rows // 20)] = np.nan
    time[rows // 2] = time[rows // 2 - 2]
    return {"time": time, "angle": angle, "torque": torque}


def same(one: Survey, other: Survey) -> bool:
    """Surveys agree; sums are added in another order, and may differ in the last digits."""

    def flat(survey: Survey) -> list[float]:
        parts = [vars(survey.timing), vars(survey.moving), survey.missing_by_key]
        values = [survey.rows, survey.angle_is_wrapped, survey.torque_highest_Nm]
        values += [value for part in parts for value in part.values()]
        return [math.nan if value is None else float(value) for value in values]

    return bool(np.allclose(flat(one), flat(other), rtol=1e-9, atol=1e-12, equal_nan=True))


CASES = {
    "angle": ({}, {}),
    "output": ({}, {"side": "output", "ratio": Fraction(241, 2)}),
    "wrapped": ({"wrap": True}, {}),
    "speed": ({"speed": True}, {}),
    "inertia": ({}, {"load_inertia_kg_m2": 0.5, "ratio": Fraction(100)}),
    "rate": ({"untimed": True}, {"rate_Hz": 1000.0}),
}


@pytest.mark.parametrize("case", CASES)
@given(data=st.data())
def test_how_a_log_is_cut_makes_no_difference(case: str, data: st.DataObject) -> None:
    change, more = CASES[case]
    columns = motion(600)
    if "wrap" in change:
        columns["angle"] = np.mod(columns["angle"], 2.0 * np.pi)
    if "speed" in change:
        columns["speed"] = columns.pop("angle")
    if "untimed" in change:
        del columns["time"]
    layout = layout_of(columns, **more)
    whole, survey = run(columns, layout)
    cuts = data.draw(st.lists(st.integers(0, 600), max_size=8))
    parts, survey_of_parts = run(columns, layout, cuts)
    np.testing.assert_array_equal(parts, whole)
    assert same(survey, survey_of_parts)
    assert len(whole) == 600
    assert survey.angle_is_wrapped == ("wrap" in change)


@given(
    st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=50),
    st.sampled_from([0.0, -np.pi]),
    st.integers(0, 50),
)
def test_unwrapping_is_numpys(steps: list[float], lowest: float, cut: int) -> None:
    angle_rad = np.cumsum(steps)
    wrapped = np.mod(angle_rad - lowest, 2.0 * np.pi) + lowest
    unwrapping = Unwrapping()
    found = np.concatenate([unwrapping.unwrap(wrapped[:cut]), unwrapping.unwrap(wrapped[cut:])])
    np.testing.assert_allclose(found, np.unwrap(wrapped), atol=1e-12)


def test_unwrapping_bridges_missing_rows() -> None:
    angle_rad = np.linspace(0.0, 20.0, 200)
    wrapped = np.mod(angle_rad, 2.0 * np.pi)
    wrapped[60:66] = np.nan
    found = Unwrapping().unwrap(wrapped)
    known = np.isfinite(wrapped)
    np.testing.assert_allclose(found[known], angle_rad[known], atol=1e-12)
    assert np.isnan(found[60:66]).all()


@pytest.mark.parametrize(
    ("unit", "turn"), [("rad", 2.0 * np.pi), ("deg", 360.0), ("turn", 1.0), ("counts/4096", 4096.0)]
)
@pytest.mark.parametrize("side", ["motor", "output"])
def test_a_wrapped_angle_is_found_on_its_side_in_its_unit(
    unit: str, turn: float, side: str
) -> None:
    time = np.arange(4000) / 1000.0
    turns = 0.3 * np.sin(time) + 4.0 * time
    columns = {"time": time, "angle": np.mod(turns, 1.0) * turn, "torque": np.cos(time)}
    layout = layout_of(columns, {"angle": unit}, side, ratio=Fraction(50))
    table, survey = run(columns, layout)
    assert survey.angle_is_wrapped
    gain = 50.0 if side == "output" else 1.0
    np.testing.assert_allclose(table[:, 2], gain * 2.0 * np.pi * turns, atol=1e-9 * gain)
    assert survey.moving.typical_speed_rad_s == pytest.approx(gain * 2.0 * np.pi * 4.0, rel=0.06)


def test_an_angle_that_jumps_without_filling_a_turn_is_left_alone() -> None:
    time = np.arange(1000) / 1000.0
    angle = 4.0 * time
    angle[700] = 0.0  # a value that was lost on the way
    table, survey = run(
        {"time": time, "angle": angle, "torque": time},
        layout_of(("time", "angle", "torque")),
    )
    assert not survey.angle_is_wrapped
    np.testing.assert_array_equal(table[:, 2], angle)


def test_speed_is_integrated_by_trapezoids_over_the_real_time() -> None:
    random = np.random.default_rng(3)
    time = np.cumsum(random.uniform(1e-4, 2e-3, 3000))
    columns = {"time": time, "speed": 30.0 * np.cos(4.0 * time), "torque": np.cos(time)}
    table, _ = run(columns, layout_of(columns))
    exact = 7.5 * (np.sin(4.0 * time) - np.sin(4.0 * time[0]))
    np.testing.assert_allclose(table[:, 2], exact, atol=1e-4)
    mean = 0.5 * (columns["speed"][1:] + columns["speed"][:-1])
    np.testing.assert_allclose(np.diff(table[:, 2]), mean * np.diff(time), atol=1e-12)


def test_integration_bridges_missing_rows_and_leaves_out_rows_out_of_order() -> None:
    time_s = np.array([0.0, 1.0, 2.0, 1.5, 3.0, 3.0, 4.0])
    speed = np.array([1.0, 1.0, np.nan, 1.0, 1.0, 9.0, 1.0])
    found = SpeedIntegration().integrate(time_s, speed)
    np.testing.assert_array_equal(found, [0.0, 1.0, np.nan, 1.5, 3.0, 3.0, 4.0])


def test_nanoseconds_since_1970_keep_their_digits() -> None:
    start = 1_794_000_000_123_456_789
    ticks = start + np.arange(1000, dtype=np.int64) * 1_000_001
    columns = {"time": ticks, "angle": np.arange(1000.0), "torque": np.ones(1000)}
    table, survey = run(columns, layout_of(columns, {"time": "ns"}), [1, 500])
    np.testing.assert_array_equal(table[:, 1], np.arange(1000) * 1_000_001 / 1e9)
    np.testing.assert_array_equal(table[:, 0], ticks / 1e9)
    assert survey.sample_period_s == pytest.approx(1.000001e-3, rel=1e-12)
    assert survey.timing.out_of_order_rows == 0


def test_milliseconds_are_seconds_to_the_last_digit() -> None:
    columns = {"time": np.arange(50.0), "angle": np.arange(50.0), "torque": np.ones(50)}
    table, _ = run(columns, layout_of(columns, {"time": "ms"}))
    assert table[:, 0].tolist() == [row / 1000 for row in range(50)]


def test_the_rate_stands_in_for_time() -> None:
    columns = {"angle": np.arange(50.0), "torque": np.ones(50)}
    table, survey = run(columns, layout_of(columns, rate_Hz=250.0), [7])
    assert table[:, 1].tolist() == [row / 250 for row in range(50)]
    assert survey.sample_period_s == pytest.approx(0.004, rel=1e-12)


@pytest.mark.parametrize("side", ["motor", "output"])
def test_inertia_times_acceleration_of_the_output(side: str) -> None:
    time = np.arange(3000) / 1000.0
    output = 0.4 * np.sin(6.0 * time)
    ratio = 80.0
    # Geared so that the output turns against the motor.
    angle = output if side == "output" else -ratio * output
    columns = {"time": time, "angle": angle, "torque": np.cos(time)}
    layout = layout_of(
        columns, side=side, ratio=Fraction(80), load_inertia_kg_m2=1.5, output_direction=-1
    )
    table, _ = run(columns, layout, [10, 60, 1500])
    exact = -1.5 * 0.4 * 36.0 * np.sin(6.0 * time)
    inside = slice(60, -60)
    np.testing.assert_allclose(table[inside, 4], exact[inside], atol=1e-3 * 1.5 * 0.4 * 36.0)
    assert len(table) == 3000
    assert np.isfinite(table).all()


def test_too_few_rows_for_an_acceleration() -> None:
    columns = {"time": np.arange(4) / 10.0, "angle": np.arange(4.0) ** 2, "torque": np.ones(4)}
    layout = layout_of(columns, ratio=Fraction(80), load_inertia_kg_m2=1.5)
    table, _ = run(columns, layout, [1])
    assert table[:, 4].tolist() == [0.0] * 4


def test_a_short_recording_of_constant_acceleration() -> None:
    time = np.arange(9) / 100.0
    columns = {"time": time, "angle": 40.0 * time**2, "torque": np.ones(9)}
    layout = layout_of(columns, ratio=Fraction(80), load_inertia_kg_m2=1.5)
    table, _ = run(columns, layout, [2, 8])
    np.testing.assert_allclose(table[:, 4], 1.5 * 80.0 / 80.0, rtol=1e-6)
