"""`strainwave calibrate misalignment`, and what `strainwave filter` makes of it."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.free_runs import GRAVITY_NM, made_up_run, phasors, station_columns, station_run
from helpers.joint_sections import PROVENANCE, gear
from helpers.log_files import command, read_result, recording_path, write_csv, write_parquet
from strainwave.joint import new_joint, read_joint, write_joint

Call = Any
OUTPUT = ("--map", "time=t,angle=q,torque=tau", "--angle-side", "output")
PHASORS = {1: 2.0 - 1.0j, 2: 0.3 + 0.4j}


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _joint(tmp_path: Path) -> Path:
    file = new_joint("station")
    file.set_section("gear", gear(100.0), PROVENANCE)
    path = tmp_path / "joint.toml"
    write_joint(file, path)
    return path


def _log(tmp_path: Path, name: str = "a.parquet", **more: Any) -> Path:
    seed = more.pop("seed", 1)
    return write_parquet(tmp_path / name, made_up_run(seed, more.pop("map", PHASORS), **more))


@pytest.mark.parametrize("side", ["output", "motor"])
def test_one_run_commissions_another(tmp_path: Path, call: Call, side: str) -> None:
    """Simulated (station of 1999): at least 90 % of the misalignment goes, and gravity stays."""
    runs = {"a": station_run(1), "b": station_run(2, 0.8, 40.0)}
    logs = {
        name: write_parquet(tmp_path / f"{name}.parquet", station_columns(run))
        for name, run in runs.items()
    }
    joint = _joint(tmp_path)
    column = "q" if side == "output" else "q_motor"
    reading = ("--map", f"time=t,angle={column},torque=tau", "--angle-side", side)
    told = ("--gravity-torque", GRAVITY_NM, "--horizontal-angle-deg", -90)
    base = ("calibrate", "misalignment", logs["a"], *reading, "--joint", joint, "--out", joint)
    ended = call(*base, *told, "--check", logs["b"], "--json")
    assert ended.code == 0
    result = ended.result
    assert [term["cycles_per_output_turn"] for term in result["terms"]] == [1, 2, 4]
    assert 0.95 < result["check"]["share_removed"] < 1.0
    section = read_joint(joint).joint.misalignment
    assert section is not None
    assert section.provenance is not None
    assert section.provenance.input_sha256 == hashlib.sha256(logs["a"].read_bytes()).hexdigest()
    assert str(section.provenance.command).startswith("strainwave calibrate misalignment ")
    assert section.zero_of_output_angle_rad == 0.0
    out = tmp_path / "clean.parquet"
    more = ("--absolute-angle",) if side == "motor" else ()
    ended = call("filter", logs["b"], *reading, "--joint", joint, *more, "--out", out, "--json")
    assert ended.code == 0
    assert ended.result["settings"]["misalignment_terms"] == 3
    run, clean = runs["b"], read_result(out)
    true_Nm, angle_rad = run.truth.torque_without_ripple_Nm, run.output_angle_rad
    # What speed and acceleration make is the same in all three and goes with the truth.
    before = phasors(angle_rad, run.raw_torque_Nm - true_Nm)
    after = phasors(angle_rad, clean["torque_Nm"] - true_Nm)
    assert np.linalg.norm(before) == pytest.approx(3.05, abs=0.2)
    assert 1 - np.linalg.norm(after) / np.linalg.norm(before) > 0.9
    kept = phasors(angle_rad, clean["torque_Nm"])[0] / phasors(angle_rad, true_Nm)[0]
    assert abs(kept) == pytest.approx(1.0, abs=0.03)


def test_filter_leaves_it_where_the_output_is_not_known(tmp_path: Path, call: Call) -> None:
    joint, log = _joint(tmp_path), _log(tmp_path)
    made = call(
        *("calibrate", "misalignment", log, *OUTPUT, "--axis", "vertical"),
        *("--joint", joint, "--out", joint),
    )
    assert made.code == 0
    columns = made_up_run(1, PHASORS)
    speed = np.gradient(columns["q"], columns["t"])
    other = write_parquet(
        tmp_path / "m.parquet", {**columns, "q_motor": 100 * columns["q"], "w": speed}
    )
    out = tmp_path / "clean.parquet"
    for reading, words in (
        (("--map", "time=t,angle=q_motor,torque=tau", "--angle-side", "motor"), "--absolute-angle"),
        (
            ("--map", "time=t,speed=w,torque=tau", "--angle-side", "output"),
            "integrated from a speed",
        ),
        ((*OUTPUT, "--method", "notch"), "method notch does not"),
    ):
        ended = call("filter", other, *reading, "--joint", joint, "--out", out, "--json")
        assert ended.code == 0
        assert ended.result["settings"]["misalignment_terms"] == 0
        assert words in ended.err
        assert "misalignment of the joint file is not removed" in ended.err
        left = abs(phasors(columns["q"], read_result(out)["torque_Nm"], (1,))[0])
        assert left > 1.0
    for method in ("ripple", "smoother"):
        base = ("filter", other, *OUTPUT, "--joint", joint, "--out", out, "--method", method)
        ended = call(*base, "--json")
        assert ended.result["settings"]["misalignment_terms"] == 2
        assert "not removed" not in ended.err
        left = abs(phasors(columns["q"], read_result(out)["torque_Nm"], (1,))[0])
        # Inertia and friction leave a phasor of their own.
        own_Nm = columns["tau"].copy()
        for n, phasor in PHASORS.items():
            own_Nm -= np.real(phasor * np.exp(-1j * n * columns["q"]))
        assert left == pytest.approx(abs(phasors(columns["q"], own_Nm, (1,))[0]), abs=0.05)
    assert "misalignment of the joint file removed, 2 terms" in call(*base).out


def test_a_map_of_a_part_of_a_turn_is_used_there_only(tmp_path: Path, call: Call) -> None:
    joint = _joint(tmp_path)
    short = _log(tmp_path, range_rad=4.5)
    ended = call(
        *("calibrate", "misalignment", short, *OUTPUT, "--axis", "vertical", "--cycles", "1,2"),
        *("--joint", joint, "--out", joint, "--json"),
    )
    assert ended.code == 0
    assert "the map holds there and nowhere else" in ended.err
    section = read_joint(joint).joint.misalignment
    assert section is not None
    assert section.lowest_output_angle_rad == ended.result["lowest_output_angle_rad"] < -1.8
    out = tmp_path / "clean.parquet"
    base = (*OUTPUT, "--joint", joint, "--out", out, "--json")
    inside = call("filter", _log(tmp_path, "b.parquet", range_rad=4.4, seed=2), *base)
    assert inside.result["settings"]["misalignment_terms"] == 2
    beyond = call("filter", _log(tmp_path, "c.parquet", seed=2), *base)
    assert beyond.result["settings"]["misalignment_terms"] == 0
    assert "commission it over the whole range" in beyond.err


def test_gravity_has_to_be_told(tmp_path: Path, call: Call) -> None:
    log = _log(tmp_path, gravity_Nm=4.0)
    base = ("calibrate", "misalignment", log, *OUTPUT, "--ratio", 100)
    out = tmp_path / "j.toml"
    ended = call(*base, "--out", out, "--json")
    assert ended.code == 0
    assert [term["cycles_per_output_turn"] for term in ended.result["terms"]] == [2]
    assert ended.result["once_a_turn"]["amplitude_Nm"] == pytest.approx(abs(6.0 - 1.0j), abs=0.1)
    assert "one cycle per output turn (6.08" in ended.err
    assert "has no [gear]" in ended.err
    payload = ("--payload-mass", 1.0, "--lever-arm", 4.0 / 9.80665, "--horizontal-angle-deg", 0)
    told = call(*base, *payload, "--out", tmp_path / "k.toml", "--json")
    assert told.result["gravity"] == "told"
    found = told.result["terms"][0]
    assert complex(found["cosine_Nm"], found["sine_Nm"]) == pytest.approx(PHASORS[1], abs=0.05)
    other = _log(tmp_path, "t.parquet", gravity_Nm=4.0, mounting_rad=np.pi / 2, seed=2)
    turned = call(
        *(*base, "--turned-run", other, "--turned-deg", 90),
        *("--out", tmp_path / "l.toml", "--json"),
    )
    assert turned.result["gravity_found"]["cosine_Nm"] == pytest.approx(4.0, abs=0.05)
    once = _log(tmp_path, "once.parquet", map={}, gravity_Nm=4.0)
    ended = call(
        "calibrate", "misalignment", once, *OUTPUT, "--ratio", 100, "--out", tmp_path / "m.toml"
    )
    assert ended.code == 2
    assert "expected gravity to be told" in ended.err
    assert not (tmp_path / "m.toml").exists()


def test_a_model_of_the_load_takes_gravity_away(tmp_path: Path, call: Call) -> None:
    columns = made_up_run(1, PHASORS, gravity_Nm=4.0)
    columns["model"] = 4.0 * np.cos(columns["q"])
    log = write_csv(tmp_path / "a.csv", columns)
    ended = call(
        *("calibrate", "misalignment", log, "--angle-side", "output", "--ratio", 100),
        *("--map", "time=t,angle=q,torque=tau,expected-torque=model"),
        *("--out", tmp_path / "j.toml", "--json"),
    )
    found = ended.result["terms"][0]
    assert complex(found["cosine_Nm"], found["sine_Nm"]) == pytest.approx(PHASORS[1], abs=0.05)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--gravity-torque", 5), "--gravity-torque is given without --horizontal-angle-deg"),
        (("--axis", "vertical", "--gravity-torque", 5), "told more than once"),
        (("--payload-mass", 5), "--payload-mass is given without --lever-arm"),
        (("--payload-mass", -5, "--lever-arm", 1), "--payload-mass -5: expected"),
        (("--gravity-torque", "nan"), "--gravity-torque nan: expected a torque"),
        (("--cycles", "1,x"), "--cycles 1,x: expected whole numbers"),
        (("--cycles", "1,2"), "gravity has one as well"),
        (("--turned-run", "a.csv"), "--turned-run is given 1 times and --turned-deg 0 times"),
        (("--zero-angle-deg", "inf"), "--zero-angle-deg inf: expected an angle"),
        (("--axis", "sideways"), "sideways"),
        (("--check", "nowhere.csv", "--axis", "vertical"), "nowhere.csv: there is no such file"),
        (("--axis-tilt-deg", 100), "--axis-tilt-deg 100: expected"),
    ],
)
def test_what_is_refused(tmp_path: Path, call: Call, options: tuple[Any, ...], words: str) -> None:
    out = tmp_path / "j.toml"
    base = ("calibrate", "misalignment", _log(tmp_path), *OUTPUT, "--ratio", 100, "--out", out)
    ended = call(*base, *options)
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert not out.exists()


def test_recordings_that_are_refused(tmp_path: Path, call: Call) -> None:
    columns = made_up_run(1, PHASORS)
    out = tmp_path / "j.toml"
    still = write_parquet(tmp_path / "still.parquet", {**columns, "q": 0 * columns["q"]})
    ended = call("calibrate", "misalignment", still, *OUTPUT, "--ratio", 100, "--out", out)
    assert (ended.code, "rows are in motion" in ended.err) == (2, True)
    log = _log(tmp_path)
    speed = ("--map", "time=t,speed=q,torque=tau", "--angle-side", "output", "--ratio", 100)
    ended = call("calibrate", "misalignment", log, *speed, "--out", out)
    assert (ended.code, "only a speed is mapped" in ended.err) == (2, True)
    ended = call(
        "calibrate", "misalignment", log, *OUTPUT[:2], "--angle-side", "motor", "--out", out
    )
    assert (ended.code, "--ratio: it is missing" in ended.err) == (2, True)
    motor = (*OUTPUT[:2], "--angle-side", "motor", "--ratio", 100)
    ended = call("calibrate", "misalignment", log, *motor, "--out", out)
    assert (ended.code, "--joint: a [gear] is missing" in ended.err) == (2, True)
    out.write_text("taken")
    ended = call("calibrate", "misalignment", log, *OUTPUT, "--ratio", 100, "--out", out)
    assert (ended.code, "there is a file already" in ended.err) == (2, True)
    assert out.read_text() == "taken"


def test_a_recording_that_is_no_free_motion(tmp_path: Path, call: Call) -> None:
    """Recorded, Med7, base joint, all joints moving: the check says that the map does not repeat."""
    log = recording_path("kuka-lbr-med7", "exciting-100hz.csv")
    ended = call(
        *("calibrate", "misalignment", log, "--map", "angle=q_0,torque=tau_0", "--rate", 100),
        *("--angle-side", "output", "--ratio", 160, "--axis", "vertical"),
        *("--out", tmp_path / "j.toml", "--json"),
    )
    assert ended.code == 0
    result = ended.result
    assert [term["cycles_per_output_turn"] for term in result["terms"]] == [2]
    assert result["terms"][0]["amplitude_Nm"] == pytest.approx(0.62, abs=0.02)
    assert result["check"]["share_removed"] == pytest.approx(0.40, abs=0.03)
    assert "it does not repeat" in ended.err
    shoulder = call(
        *("calibrate", "misalignment", log, "--map", "angle=q_1,torque=tau_1", "--rate", 100),
        *("--angle-side", "output", "--ratio", 160, "--axis", "vertical"),
        *("--out", tmp_path / "k.toml"),
    )
    assert "gravity is there after all" in shoulder.err
