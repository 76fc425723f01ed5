"""`strainwave calibrate plan`: the loading sequence, and the filled sheet read back."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.log_files import command
from strainwave.calibrate.locked_positions import alias_shares
from strainwave.commissioning.loading_plan import COLUMNS, PlanOptions, make_plan

Call = Any
GAIN = 6.6


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _plan(call: Call, out: Path, *more: object) -> Any:
    return call(
        "calibrate", "plan", "--rated-torque", 40, "--harmonics", 2, "--out", out, "--json", *more
    )


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def _fill(path: Path, rows: list[dict[str, str]], delimiter: str = ",") -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]), delimiter=delimiter, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def _filled(path: Path, *, temperature: bool = False) -> list[dict[str, str]]:
    rows = _rows(path)
    for row in rows:
        if row["phase"] == "measure":
            beta = np.radians(float(row["position_deg"]))
            gain = GAIN * (1 + 0.02 * np.cos(2 * beta) + 0.01 * np.cos(4 * beta))
            row["voltage_V"] = repr(float(0.1 + float(row["load_Nm"]) / gain))
            row["temperature_degC"] = row["target_temperature_degC"] if temperature else ""
    return rows


def test_the_sheet_is_read_back_without_a_mapping(tmp_path: Path, call: Call) -> None:
    sheet, page = tmp_path / "sheet.csv", tmp_path / "sheet.html"
    ended = _plan(call, sheet, "--temperatures", "5,20,35", "--printable", page)
    assert ended.code == 0
    assert ended.result["positions_deg"] == pytest.approx([0, 36, 72, 108, 144])
    assert ended.result["readings"] == 5 * 2 * 11
    _fill(sheet, _filled(sheet, temperature=True))
    out = tmp_path / "joint.toml"
    read = call("calibrate", "torque", sheet, "--rated-torque", 40, "--out", out, "--json")
    assert read.code == 0
    found = read.result
    # Positions equally spread: the harmonics of the gain leave its mean as it is.
    dependence = found["positions"]["dependence"]
    assert [each["gain_amplitude"] for each in dependence] == pytest.approx([0.02, 0.01], rel=1e-6)
    assert found["gain_Nm_per_V"] == pytest.approx(GAIN, rel=1e-9)
    assert found["zero_V"] == pytest.approx(0.1, abs=1e-9)
    assert found["temperature"]["lowest_degC"] == 5.0
    assert found["positions"]["alias_shares"] == pytest.approx([0, 0], abs=1e-12)
    assert not any("positions" in warning for warning in found["warnings"])
    html = page.read_text(encoding="utf-8")
    assert html.count("<section>") == 5
    assert html.count('class="preload"') == 5 * 2 * 6
    assert "Experiment 5: 144 deg, 20 degC" in html


def test_a_spreadsheet_may_save_it_with_semicolons_and_more_columns(
    tmp_path: Path, call: Call
) -> None:
    sheet = tmp_path / "sheet.csv"
    _plan(call, sheet)
    rows = [{**row, "remark": "calm"} for row in _filled(sheet)]
    _fill(sheet, rows, ";")
    out = tmp_path / "joint.toml"
    assert call("calibrate", "torque", sheet, "--out", out, "--json").result["zero_V"] == (
        pytest.approx(0.1, abs=1e-9)
    )


def test_rows_that_are_not_filled_in_are_named(tmp_path: Path, call: Call) -> None:
    sheet, out = tmp_path / "sheet.csv", tmp_path / "joint.toml"
    _plan(call, sheet)
    empty = call("calibrate", "torque", sheet, "--out", out)
    assert empty.code == 2
    assert "no voltage is filled in" in empty.err
    rows = _filled(sheet)
    rows[8]["voltage_V"] = ""
    rows[30]["voltage_V"] = ""
    _fill(sheet, rows)
    ended = call("calibrate", "torque", sheet, "--out", out)
    assert ended.code == 2
    assert (
        "experiment 1 is not filled in to its end, voltage_V is empty in rows 9, 31;" in ended.err
    )
    rows = _filled(sheet)
    for row in rows:
        row["temperature_degC"] = "20" if row["experiment"] == "2" else ""
    _fill(sheet, rows)
    ended = call("calibrate", "torque", sheet, "--out", out)
    assert ended.code == 2
    assert "temperature_degC is filled in for some rows and empty in rows 7, 8" in ended.err
    assert not out.exists()


def test_experiments_that_were_not_made_are_left_out_and_said(tmp_path: Path, call: Call) -> None:
    sheet, out = tmp_path / "sheet.csv", tmp_path / "joint.toml"
    _plan(call, sheet)
    rows = _filled(sheet)
    for row in rows:
        if row["experiment"] in {"4", "5"}:
            row["voltage_V"] = ""
    _fill(sheet, rows)
    found = call("calibrate", "torque", sheet, "--out", out, "--json").result
    assert [each["name"] for each in found["experiments"]] == ["1", "2", "3"]
    assert any("experiments 4, 5 of the sheet are not filled in" in w for w in found["warnings"])
    assert any("locked at 3 positions, and 5 tell" in w for w in found["warnings"])


def test_a_sheet_in_use_is_not_replaced(tmp_path: Path, call: Call) -> None:
    sheet = tmp_path / "sheet.csv"
    _plan(call, sheet)
    before = sheet.read_bytes()
    ended = _plan(call, sheet)
    assert ended.code == 2
    assert "somebody has filled in" in ended.err
    assert sheet.read_bytes() == before


def test_people_are_told_what_comes_next(tmp_path: Path, call: Call) -> None:
    ended = call(
        *("calibrate", "plan", "--rated-torque", 40, "--harmonics", 1, "--temperatures", "20"),
        *("--out", tmp_path / "sheet.csv"),
    )
    assert "0, 60, 120 deg" in ended.out
    assert "calibrate torque" in ended.out


@settings(max_examples=40, deadline=None)
@given(
    harmonics=st.integers(1, 4),
    more=st.integers(0, 3),
    rounds=st.integers(1, 3),
    steps=st.integers(2, 8),
    preloads=st.integers(0, 3),
    one=st.booleans(),
)
def test_plans_hold_what_a_calibration_needs(
    harmonics: int, more: int, rounds: int, steps: int, preloads: int, one: bool
) -> None:
    positions = 2 * harmonics + 1 + more
    plan = make_plan(
        PlanOptions(
            50.0,
            harmonics,
            positions,
            rounds * positions,
            (10.0, 30.0),
            steps=steps,
            preloads=preloads,
            one_direction=one,
        )
    )
    firsts = {row.experiment: row for row in plan.rows}.values()
    assert alias_shares(np.radians([row.position_deg for row in firsts]), harmonics) == (
        pytest.approx(0.0, abs=1e-12)
    )
    for experiment in range(1, plan.experiments + 1):
        rows = [row for row in plan.rows if row.experiment == experiment]
        measured = [row.load_Nm for row in rows if row.phase == "measure"]
        assert max(measured) == 50.0
        assert min(measured) == (0.0 if one else -50.0)
        assert measured[0] == measured[-1] == 0.0
        preloaded = [row.load_Nm for row in rows if row.phase == "preload"]
        assert preloaded.count(50.0) == preloads
        assert len(measured) == (2 * steps + 1) * (1 if one else 2)
    assert plan.readings == sum(row.phase == "measure" for row in plan.rows)


def test_the_header_is_the_sheets(tmp_path: Path, call: Call) -> None:
    _plan(call, tmp_path / "sheet.csv")
    assert tuple(_rows(tmp_path / "sheet.csv")[0]) == COLUMNS


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--rated-torque", 0), "rated_torque_Nm = 0 Nm: expected 1e-06 to 1e+07 Nm"),
        (("--rated-torque", "nan"), "rated_torque_Nm = nan: expected a number"),
        (("--harmonics", 0), "harmonics = 0: expected a whole number"),
        (("--harmonics", 2.5), "--harmonics 2.5: expected a whole number"),
        (("--positions", 4), "positions = 4: expected at least 5"),
        (("--experiments", 4), "experiments = 4: expected at least 5, one for each position"),
        (("--experiments", 99999), "expected at most 100000"),
        (("--temperatures", "5,warm"), "--temperatures 5,warm: expected numbers"),
        (("--temperatures", "-300"), "temperatures = -300 degC: expected -273.15 to 1000"),
        (("--steps", 1), "steps = 1: expected 2 to 1000"),
        (("--preloads", -1), "preloads = -1: expected 0 to 100"),
        (("--dwell", -1), "dwell_s = -1 s: expected 0 to 86400 s"),
        (
            ("--printable", "page.pdf"),
            "--printable page.pdf: the name ends in '.pdf'; expected .html",
        ),
        (("--out", "sheet.xlsx"), "--out sheet.xlsx: the name ends in '.xlsx'; expected .csv"),
        (("--out", "nowhere/sheet.csv"), "expected an existing folder"),
    ],
)
def test_bad_options(tmp_path: Path, call: Call, options, words: str) -> None:
    given = {"--rated-torque": 40, "--harmonics": 2, "--out": tmp_path / "sheet.csv"}
    given[options[0]] = options[1]
    ended = call("calibrate", "plan", *(word for pair in given.items() for word in pair))
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert list(tmp_path.iterdir()) == []
