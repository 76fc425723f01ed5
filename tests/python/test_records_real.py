"""Recordings of real joints run through; what is odd in them is found and said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from helpers.log_files import (
    command,
    read_result,
    recording_path,
)

Call = Any


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def test_kuka_held_samples_are_found(tmp_path: Path, call: Call) -> None:
    log = recording_path("kuka-lbr-med7", "constant-speed-400hz.csv")
    ended = call(
        *("filter", log, "--map", "time=t_s,angle=q1_rad,torque=tau1_Nm"),
        *("--angle-side", "output", "--ratio", 160, "--method", "taghirad1999"),
        *("--out", tmp_path / "o.parquet", "--json"),
    )
    result = ended.result
    assert ended.code == 0
    assert result["rows"] == 12048
    assert result["rate_Hz"] == pytest.approx(400.0, abs=2.0)
    assert result["survey"]["share_repeated"] == pytest.approx(0.75, abs=0.01)
    # 0.2 rad/s at the joint.
    assert result["survey"]["typical_speed_rad_s"] == pytest.approx(32.0, abs=2.0)
    assert "only repeat the angle and the torque of the row before" in ended.err
    assert len(read_result(tmp_path / "o.parquet")["status"]) == 12048


def test_kuka_without_time(tmp_path: Path, call: Call) -> None:
    log = recording_path("kuka-lbr-med7", "exciting-100hz.csv")
    base = ("filter", log, "--map", "angle=q_0,torque=tau_0,expected-torque=tau_ext_0")
    base += ("--angle-side", "output", "--ratio", 160, "--method", "taghirad1999", "--json")
    ended = call(*base, "--rate", 100, "--out", tmp_path / "o.csv")
    assert ended.code == 0
    assert (ended.result["rows"], ended.result["rate_Hz"]) == (10007, pytest.approx(100.0))
    assert read_result(tmp_path / "o.csv")["time_s"][-1] == 100.06
    assert call(*base, "--out", tmp_path / "o.csv").code == 2


@pytest.mark.parametrize(
    ("name", "rows", "joint"), [("validate-250hz.csv", 1832, 3), ("jogging-250hz.csv", 1239, 1)]
)
@pytest.mark.parametrize("side", ["motor", "output"])
def test_lara8(tmp_path: Path, call: Call, name: str, rows: int, joint: int, side: str) -> None:
    log = recording_path("neura-lara8", name)
    column = "encoder_motorinc_{}:counts/16777216" if side == "motor" else "joint_angles_{}"
    mapping = f"time=Timestamp,angle={column},torque=joint_torque_current_{{}}".format(joint, joint)
    ended = call(
        *("filter", log, "--map", mapping, "--angle-side", side, "--ratio", "101"),
        *("--method", "taghirad1999", "--out", tmp_path / "o.csv", "--json"),
    )
    result = ended.result
    assert ended.code == 0
    assert result["rows"] == rows
    assert result["rate_Hz"] == pytest.approx(250.0, abs=1.0)
    assert "the time stamps jitter" in ended.err
    # Motor encoder and joint angle agree on how fast the motor turns.
    assert 10.0 < result["survey"]["typical_speed_rad_s"] < 150.0
