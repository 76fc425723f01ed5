"""`strainwave filter`: what it writes, prints and says."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import strainwave
from helpers.log_files import (
    MAP,
    METHOD,
    RATIO,
    Halving,
    command,
    healthy,
    read_result,
    write_csv,
    write_parquet,
)
from strainwave.records import Options, filter_log, parse_mapping

COMMAND = Path(sys.executable).parent / "strainwave"
BASE = ("--map", MAP, "--angle-side", "motor", "--method", METHOD, "--rated-torque", 30)
NAMES = ["time_s", "torque_measured_Nm", "torque_Nm", "ripple_Nm", "status"]
#: What is said of the published filter's tuning, which these tests use.
SWALLOWS = f"method {METHOD} swallows true torque: at "
Call = Any


def other_lines(err: str) -> list[str]:
    """Lines beside that of the tuning, which must be there once."""
    lines = err.splitlines()
    others = [line for line in lines if SWALLOWS not in line]
    assert len(lines) - len(others) == 1
    return others


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


@pytest.mark.parametrize("into", ["csv", "parquet"])
@pytest.mark.parametrize("of", ["csv", "parquet"])
def test_both_formats_both_ways(tmp_path: Path, call: Call, of: str, into: str) -> None:
    columns = healthy()
    log = tmp_path / f"log.{of}"
    (write_csv if of == "csv" else write_parquet)(log, columns)
    out = tmp_path / f"out.{into}"
    ended = call("filter", log, *BASE, "--out", out)
    assert (ended.code, other_lines(ended.err)) == (0, [])
    found = read_result(out)
    assert list(found) == NAMES
    np.testing.assert_array_equal(found["time_s"], columns["t_s"])
    np.testing.assert_array_equal(found["torque_measured_Nm"], columns["tau_Nm"])
    expected = strainwave.OscillatorFilter(strainwave.oscillator_preset(METHOD)).process(
        columns["tau_Nm"],
        motor_speed_rad_s=np.append(0.0, np.diff(columns["q_rad"]) / np.diff(columns["t_s"])),
    )
    np.testing.assert_allclose(found["torque_Nm"], expected.torque_Nm, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["ripple_Nm"], expected.ripple_Nm, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(found["status"], expected.status)
    assert sorted(tmp_path.iterdir()) == sorted([log, out])


def test_json_is_one_object_and_nothing_else(tmp_path: Path, call: Call) -> None:
    log = write_csv(tmp_path / "log.csv", healthy())
    out = tmp_path / "out.csv"
    ended = call("filter", log, *BASE[:-2], "--ratio", RATIO, "--out", out, "--json")
    result = ended.result
    assert ended.code == 0
    assert (result["input"], result["output"]) == (str(log), str(out))
    assert (result["rows"], result["method"]) == (1000, METHOD)
    assert result["rate_Hz"] == pytest.approx(1000.0)
    assert result["settings"]["map"] == "time=t_s:s,angle=q_rad:rad,torque=tau_Nm:Nm"
    assert result["settings"]["ratio"] == RATIO
    assert result["rated_torque_source"] == "estimated"
    warning, swallows = result["warnings"]
    assert swallows.startswith(SWALLOWS)
    assert "the rated torque is not given" in warning
    assert warning in ended.err
    assert set(result["rows_by_flag"]) == {flag.name for flag in strainwave.StatusFlag}
    found = read_result(out)
    for name, column in (("torque_before", 1), ("torque_after", 2), ("ripple", 3)):
        rms = np.sqrt(np.mean(found[NAMES[column]] ** 2))
        assert result[f"{name}_rms_Nm"] == pytest.approx(rms, rel=1e-9)
    assert result["survey"]["repeated_rows"] == 0


def test_rows_out_of_order_are_rejected_and_the_rest_is_as_without_them(
    tmp_path: Path, call: Call
) -> None:
    columns = healthy()
    log = write_csv(tmp_path / "log.csv", columns)
    call("filter", log, *BASE, "--out", tmp_path / "plain.csv")
    for key, value in (("t_s", 0.1), ("q_rad", 5.0), ("tau_Nm", 999.0)):
        columns[key] = np.insert(columns[key], [500, 700], value)
    columns["t_s"][700 + 1] = np.nan
    ended = call("filter", write_csv(log, columns), *BASE, "--out", tmp_path / "out.csv", "--json")
    assert ended.code == 0
    assert "time goes back or stands still at 1 row (first: row 501)" in ended.err
    assert "1 row of 1002 has no time; it is rejected and flagged" in ended.err
    flags = ended.result["rows_by_flag"]
    assert (flags["sample_out_of_order"], flags["time_not_finite"]) == (1, 1)
    found, plain = read_result(tmp_path / "out.csv"), read_result(tmp_path / "plain.csv")
    kept = np.delete(np.arange(1002), [500, 701])
    for name in NAMES[2:]:
        np.testing.assert_array_equal(found[name][kept], plain[name])
        if name != "status":
            assert found[name][500] == found[name][499]
    assert found["torque_measured_Nm"][500] == 999.0


def test_missing_values_are_empty_fields_and_flagged(tmp_path: Path, call: Call) -> None:
    columns = healthy()
    columns["tau_Nm"][[3, 4]] = np.nan
    columns["q_rad"][7] = np.nan
    log = write_parquet(tmp_path / "log.parquet", columns)
    ended = call("filter", log, *BASE, "--out", tmp_path / "o.csv", "--json")
    assert ended.code == 0
    assert "2 rows of 1000 have no torque" in ended.err
    flags = ended.result["rows_by_flag"]
    assert (flags["torque_not_finite"], flags["rotation_invalid"]) == (2, 1)
    lines = (tmp_path / "o.csv").read_text().splitlines()
    assert lines[0] == ",".join(NAMES)
    assert lines[4].split(",")[1] == ""
    assert float(lines[4].split(",")[2]) == float(lines[3].split(",")[2])


def test_a_wrapped_output_angle_in_degrees_gives_the_same(tmp_path: Path, call: Call) -> None:
    columns = healthy(6000)
    call("filter", write_csv(tmp_path / "a.csv", columns), *BASE, "--out", tmp_path / "a.parquet")
    columns["q_rad"] = np.rad2deg(columns["q_rad"] / 2) % 360.0
    log = write_csv(tmp_path / "b.csv", columns)
    arguments = ["--map", MAP.replace("q_rad", "q_rad:deg"), "--angle-side", "output"]
    ended = call(
        "filter", log, *arguments, "--ratio", 2, *BASE[4:], "--out", tmp_path / "b.parquet"
    )
    assert "the angle goes back to its start after every turn" in ended.err
    one, other = (read_result(tmp_path / f"{name}.parquet") for name in "ab")
    np.testing.assert_allclose(one["torque_Nm"], other["torque_Nm"], atol=1e-6)


def test_volts_for_newton_metres_are_asked_about(tmp_path: Path, call: Call) -> None:
    columns = healthy()
    columns["tau_Nm"] /= 30.0
    log = write_csv(tmp_path / "log.csv", columns)
    ended = call("filter", log, *BASE, "--out", tmp_path / "o.csv")
    assert ended.code == 0
    assert "is the column in volts?" in ended.err
    assert (tmp_path / "o.csv").exists()


def test_the_joint_file_maps_and_an_option_wins(tmp_path: Path, call: Call) -> None:
    columns = healthy()
    log = write_csv(tmp_path / "log.csv", {'"a, b"': columns["t_s"], **columns})
    made = "created = 2026-11-01T08:30:00Z\ninput = 'by hand'\nversion = '0.1.0'"
    (tmp_path / "j.toml").write_text(
        f"""schema_version = 1
[joint]
name = "x"
[signals]
time = {{column = "a, b", unit = "s"}}
motor_angle = {{column = "q_rad", unit = "rad"}}
torque = {{column = "tau_Nm", unit = "Nm"}}
[signals.provenance]
{made}
[gear]
configuration = "fixed_flexspline"
ratio = 100
rated_torque_Nm = 30
[gear.provenance]
{made}
"""
    )
    out = tmp_path / "o.csv"
    base = ("filter", log, "--joint", tmp_path / "j.toml", "--method", METHOD, "--out", out)
    ended = call(*base, "--json")
    assert (ended.code, other_lines(ended.err)) == (0, [])
    assert ended.result["rated_torque_source"] == "joint file"
    assert ended.result["settings"]["map"].startswith('time="a, b":s,')
    ended = call(*base, "--rated-torque", 40, "--map", "torque=tau_Nm:mNm", "--ratio", "100")
    assert "--rated-torque 40 is used instead of 30 in the joint file" in ended.err
    assert "--map torque 'tau_Nm' in mNm is used instead of 'tau_Nm' in Nm" in ended.err
    assert "--ratio" not in ended.err
    refused = call(*base[:2], "--joint", out, *base[4:])
    assert refused.code == 2
    assert "it is the file that is read" in refused.err


def test_help_has_an_example(call: Call) -> None:
    shown = call("filter", "--help")
    words = " ".join(shown.out.split())
    assert "Example: strainwave filter run.csv --map time=t_s,angle=q:deg,torque=tau_Nm" in words
    for option in ("--map", "--angle-side", "--ratio", "--out", "--joint", "--method", "--json"):
        assert option in words


def test_values_beyond_all_reach_are_missing(tmp_path: Path, call: Call) -> None:
    columns = healthy()
    columns["tau_Nm"][5] = 1e200
    columns["q_rad"][9] = -1e308
    log = write_csv(tmp_path / "log.csv", columns)
    ended = call("filter", log, *BASE, "--out", tmp_path / "o.csv", "--json")
    assert ended.code == 0
    flags = ended.result["rows_by_flag"]
    assert (flags["torque_not_finite"], flags["rotation_invalid"]) == (1, 1)


def test_options_may_stand_before_the_recording(tmp_path: Path, call: Call) -> None:
    log = write_csv(tmp_path / "log.csv", healthy())
    arguments = ["--map", "time=t_s", "--map", "angle=q_rad,torque=tau_Nm", log, *BASE[2:]]
    assert call("filter", *arguments, "--out", tmp_path / "o.csv").code == 0


def test_progress_goes_through_both_passes(tmp_path: Path) -> None:
    log = write_parquet(tmp_path / "log.parquet", healthy(200_000))
    told: list[tuple[str, float]] = []
    options = Options(parse_mapping([MAP]), "motor", ratio=Fraction(RATIO))
    filter_log(
        log,
        tmp_path / "o.parquet",
        options,
        method="any",
        build=lambda *_: Halving(),
        progress=lambda step, share: told.append((step, share)),
    )
    assert [share for step, share in told if step == "surveying"][-1] == 1.0
    shares = [share for step, share in told if step == "filtering"]
    assert len(shares) > 2
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_the_installed_command_prints_json_alone(tmp_path: Path) -> None:
    log = write_csv(tmp_path / "log.csv", healthy())
    out = tmp_path / "o.csv"
    ended = subprocess.run(
        [COMMAND, "filter", log, *map(str, BASE), "--out", out, "--json"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONWARNINGS": "error"},
    )
    assert (ended.returncode, other_lines(ended.stderr)) == (0, [])
    assert json.loads(ended.stdout)["rows"] == 1000
