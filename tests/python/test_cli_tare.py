"""`strainwave tare`: a table of poses in, the zero in the joint file out, or a refusal."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.log_files import command, write_csv
from helpers.static_poses import (
    GAIN_NM_PER_V,
    LEVER_M,
    MASS_KG,
    RATED_NM,
    made_up_poses,
    sensor_joint,
    station_poses,
    weight_Nm,
)
from strainwave.joint import read_joint

Call = Any
WEIGHT = ("--payload-mass", MASS_KG, "--lever-arm", LEVER_M)
ANGLE = ("--horizontal-angle-deg", 20)
MAP = ("--map", "angle=q_deg:deg,torque=tau")


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _table(tmp_path: Path, seed: int = 1, **more: Any) -> Path:
    return write_csv(tmp_path / "poses.csv", made_up_poses(seed, **more))


def _joint(tmp_path: Path, **values: Any) -> Path:
    return sensor_joint(tmp_path / "joint.toml", **values)


def test_six_poses_on_the_station(tmp_path: Path, call: Call) -> None:
    """Simulated (station of 1999): wrong payload refused, right one within 0.1 %FS."""
    table = write_csv(tmp_path / "poses.csv", station_poses(1, 0.15))
    joint = _joint(tmp_path, consistency=0.02)
    before = joint.read_bytes()
    base = ("tare", table, "--map", "angle=q_deg:deg,voltage=u,pose=pose", "--joint", joint, *ANGLE)
    wrong = ("--payload-mass", 0.8 * MASS_KG, "--lever-arm", LEVER_M)
    ended = call(*base, *wrong, "--out", joint)
    assert ended.code == 2
    assert "a payload of 2 kg at 0.5 m does not explain the poses" in ended.err
    assert "2.4" in ended.err.split("degrees of freedom")[1]
    assert joint.read_bytes() == before
    ended = call(*base, *WEIGHT, "--out", joint, "--json")
    assert ended.code == 0
    section = read_joint(joint).joint.torque_calibration
    assert section is not None
    assert section.zero_V == ended.result["zero_V"]
    error_FS = 100 * GAIN_NM_PER_V * (section.zero_V - 0.15) / RATED_NM
    assert abs(error_FS) < 0.1
    assert section.consistency == 0.02
    provenance = section.provenance
    assert provenance is not None
    assert provenance.input == "entered by hand; zero from poses.csv"
    assert provenance.input_sha256 == hashlib.sha256(table.read_bytes()).hexdigest()
    assert str(provenance.command).startswith("strainwave tare ")
    again = call(*base, *WEIGHT, "--out", joint, "--json").result
    assert abs(again["zero_Nm"]) < 1e-6 * RATED_NM
    again = read_joint(joint).joint.torque_calibration
    assert again is not None
    assert again.provenance is not None
    assert again.provenance.input == "entered by hand; zero from poses.csv"


def test_torque_and_voltage_give_one_zero(tmp_path: Path, call: Call) -> None:
    columns = made_up_poses(1, readings=3)
    columns["u"] = columns["tau"] / GAIN_NM_PER_V + 0.05
    columns["mv"] = 1000 * columns["u"]
    columns["model"] = weight_Nm(columns["q_deg"])
    table = write_csv(tmp_path / "poses.csv", columns)
    joint = _joint(tmp_path)
    zeros = []
    for place, (mapping, weight) in enumerate(
        (
            ("angle=q_deg:deg,torque=tau,pose=pose", (*WEIGHT, *ANGLE)),
            ("angle=q_deg:deg,voltage=u,pose=pose", (*WEIGHT, *ANGLE)),
            ("voltage=mv:mV,gravity-torque=model,pose=pose", ()),
        )
    ):
        out = tmp_path / f"{place}.toml"
        ended = call(
            "tare", table, "--map", mapping, "--joint", joint, *weight, "--out", out, "--json"
        )
        assert ended.code == 0
        assert ended.result["zero_Nm"] == pytest.approx(0.9, abs=0.05)
        zeros.append(ended.result["zero_V"])
    assert zeros == pytest.approx([zeros[0]] * 3, abs=1e-9)
    assert zeros[0] == pytest.approx(0.05 + 0.9 / GAIN_NM_PER_V, abs=0.01)


def test_a_curved_characteristic(tmp_path: Path, call: Call) -> None:
    """The zero is where the characteristic begins, whatever its curvature."""
    angles = np.array([-130.0, -75.0, -20.0, 43.0, 101.0, 162.0])
    torque = weight_Nm(angles)
    linear = torque.copy()
    for _ in range(60):
        linear = torque - 40.0 * 0.05 * (linear / 40.0) ** 2
    columns = {"q_deg": angles, "u": linear / GAIN_NM_PER_V + 0.31}
    table = write_csv(tmp_path / "poses.csv", columns)
    joint = _joint(tmp_path, linearisation=(0.05,))
    ended = call(
        *("tare", table, "--map", "angle=q_deg:deg,voltage=u", "--joint", joint),
        *(*WEIGHT, *ANGLE, "--out", tmp_path / "j.toml", "--json"),
    )
    assert ended.result["zero_V"] == pytest.approx(0.31, abs=1e-8)


def test_what_is_said(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path)
    base = ("tare", _table(tmp_path), *MAP, "--joint", joint, *WEIGHT, "--json")
    ended = call(*base, "--out", tmp_path / "a.toml")
    assert ended.code == 0
    result = ended.result
    assert result["horizontal_angle_is_fitted"] is True
    assert np.degrees(result["horizontal_angle_rad"]) == pytest.approx(20.0, abs=0.5)
    assert result["accuracy_source"] == "standard"
    assert result["best_payload_mass_kg"] == pytest.approx(MASS_KG, rel=0.02)
    assert "0.1 %FS is assumed" in ended.err
    assert "no pose has two readings" in ended.err
    known = sensor_joint(
        tmp_path / "known.toml",
        hysteresis_percent_of_rated_torque=0.3,
        linearity_error_percent_of_rated_torque=0.2,
    )
    told = ("tare", _table(tmp_path), *MAP, "--joint", known, *WEIGHT, "--json")
    result = call(*told, "--out", tmp_path / "b.toml").result
    assert result["accuracy_source"] == "joint file"
    # sqrt((0.2^2 + 0.15^2) / 3) %FS of 40 Nm.
    assert result["accuracy_Nm"] == pytest.approx(0.05774, rel=1e-3)
    uneven = made_up_poses(1, angles_deg=(-160.0, -100.0, -40.0, 20.0, 80.0, 140.0))
    # Multiples of a whole turn of the wave: 180 degrees / (101 / 100 x 100).
    uneven["q_deg"] = np.round(uneven["q_deg"] / (180 / 101)) * (180 / 101)
    uneven["tau"] = weight_Nm(uneven["q_deg"]) + 0.9
    table = write_csv(tmp_path / "uneven.csv", uneven)
    ended = call("tare", table, *MAP, "--joint", joint, *WEIGHT, "--out", tmp_path / "c.toml")
    assert ended.code == 0
    assert "positions are uneven: 100%" in ended.err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "--payload-mass: nothing says what the load weighs"),
        (("--payload-mass", 2), "--payload-mass is given without --lever-arm"),
        ((*WEIGHT, "--gravity", -1), "--gravity -1: expected"),
        ((*WEIGHT, "--accuracy-FS", 0), "--accuracy-FS 0: expected"),
        ((*WEIGHT, "--axis-tilt-deg", "nan"), "--axis-tilt-deg nan: expected"),
        ((*WEIGHT, "--map", "voltage=tau2"), "expected one of torque=COLUMN"),
        ((*WEIGHT, "--map", "gravity-torque=tau2"), "a gravity-torque is mapped as well"),
    ],
)
def test_what_is_refused(tmp_path: Path, call: Call, options: tuple[Any, ...], words: str) -> None:
    columns = made_up_poses(1)
    columns["tau2"] = columns["tau"]
    table = write_csv(tmp_path / "poses.csv", columns)
    out = tmp_path / "out.toml"
    ended = call("tare", table, *MAP, "--joint", _joint(tmp_path), "--out", out, *options)
    assert ended.code == 2
    assert words in ended.err
    assert not out.exists()


def test_tables_and_joints_that_are_refused(tmp_path: Path, call: Call) -> None:
    joint, out = _joint(tmp_path), tmp_path / "out.toml"
    columns: dict[str, Any] = dict(made_up_poses(1))
    columns["tau"] = [*columns["tau"][:-1], None]
    gap = write_csv(tmp_path / "gap.csv", columns)
    ended = call("tare", gap, *MAP, "--joint", joint, *WEIGHT, "--out", out)
    assert (ended.code, "row 6" in ended.err, "for torque is empty" in ended.err) == (2, True, True)
    two = write_csv(tmp_path / "two.csv", {k: v[:2] for k, v in made_up_poses(1).items()})
    ended = call("tare", two, *MAP, "--joint", joint, *WEIGHT, *ANGLE, "--out", out)
    assert (ended.code, "two.csv: there are 2 poses" in ended.err) == (2, True)
    contact = made_up_poses(1)
    contact["tau"] = contact["tau"] + np.array([0, 2, -1, 3, 0, -2])
    table = write_csv(tmp_path / "contact.csv", contact)
    ended = call("tare", table, *MAP, "--joint", joint, *WEIGHT, *ANGLE, "--out", out)
    assert (ended.code, "no other mass would either" in ended.err) == (2, True)
    bare = tmp_path / "bare.toml"
    call("joint", "new", bare, "--name", "bare")
    ended = call("tare", table, *MAP, "--joint", bare, *WEIGHT, "--out", out)
    assert (ended.code, "there is no [gear]" in ended.err) == (2, True)
    counts = ("--map", "angle=q_deg:deg,voltage=tau:counts")
    ended = call("tare", table, *counts, "--joint", joint, *WEIGHT, "--out", out)
    assert (ended.code, "nothing says what a count is" in ended.err) == (2, True)
    assert not out.exists()
