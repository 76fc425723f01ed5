"""`strainwave identify`: from a recording to a joint file that `strainwave filter` uses."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.accuracy import kuka
from benchmarks.accuracy.joint import FULL_SCALE_NM, RATIO, Run, make_joint, simulate
from benchmarks.accuracy.methods.interface import Log, Removal, Setting
from benchmarks.accuracy.motion import LEARNING, constant_plan
from benchmarks.accuracy.ripple import RIGHT
from helpers.log_files import command, read_result, recording_path, write_parquet
from strainwave import RippleFilter
from strainwave.configuration import ripple_filter_of
from strainwave.joint import read_joint

Call = Any
DELAY_ROWS = 2
OUTPUT = ("--map", "time=t,angle=q,torque=tau", "--angle-side", "output")


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _write(path: Path, run: Run, rows: slice = slice(None)) -> Path:
    motor_rad = run.motor_angle_rad[DELAY_ROWS:]
    columns = {
        "t": run.motion.time_s[DELAY_ROWS:],
        "q": motor_rad / RATIO,
        "q_motor": motor_rad,
        "tau": run.measured_torque_Nm[:-DELAY_ROWS],
    }
    return write_parquet(path, {name: values[rows] for name, values in columns.items()})


def test_identify_then_filter_another_run(tmp_path: Path, call: Call) -> None:
    joint = make_joint(RIGHT, 3)
    log = _write(tmp_path / "a.parquet", simulate(joint))
    other = simulate(replace(joint, start_angle_rad=joint.start_angle_rad + 1, speed_scale=0.95))
    file = tmp_path / "joint.toml"
    ended = call(
        *("identify", log, *OUTPUT, "--ratio", "100.3", "--rated-torque", FULL_SCALE_NM),
        *("--out", file, "--json"),
    )
    assert ended.code == 0
    result = ended.result
    assert result["ratio"] == pytest.approx(100.0, rel=1e-4)
    assert 0 < result["ratio_standard_uncertainty"] < 0.01
    assert result["delay_s"] == pytest.approx(2e-3, abs=1e-4)
    assert [each["order"] for each in result["orders"]] == [2.0, 4.0, 6.0]
    assert result["noise_Nm"] == pytest.approx(0.04, rel=0.06)
    assert result["memory_turns"] >= 80.0
    assert (result["terms"]["load"], result["terms"]["speed"]) == (True, True)
    assert "replaces the ratio of 100.3" in ended.err
    section = read_joint(file).joint
    assert section.gear is not None
    assert section.signals is not None
    assert section.ripple_filter is not None
    assert section.gear.configuration == "fixed_circular_spline"
    assert section.ripple_filter.orders == ("2m", "4m", "6m")
    provenance = section.ripple_filter.provenance
    assert provenance is not None
    assert provenance.input_sha256 == hashlib.sha256(log.read_bytes()).hexdigest()
    assert str(provenance.command).startswith("strainwave identify ")
    out = tmp_path / "clean.parquet"
    run = _write(tmp_path / "b.parquet", other)
    assert call("filter", run, "--joint", file, "--out", out).code == 0
    error_Nm = read_result(out)["torque_Nm"] - other.true_torque_Nm[:-DELAY_ROWS]
    counted = other.motion.phase[:-DELAY_ROWS] != LEARNING
    error_percent = 100 * float(np.sqrt(np.mean(error_Nm[counted] ** 2))) / FULL_SCALE_NM
    # The noise alone is 0.10.
    assert 0.095 < error_percent < 0.12


def test_two_angles(tmp_path: Path, call: Call) -> None:
    log = _write(tmp_path / "a.parquet", simulate(make_joint(RIGHT, 3)))
    mapping = "time=t,angle=q,motor-angle=q_motor,torque=tau"
    base = ("identify", log, "--map", mapping, "--rated-torque", FULL_SCALE_NM)
    ended = call(*base, "--angle-side", "output", "--out", tmp_path / "j.toml", "--json")
    assert ended.code == 0
    assert ended.result["ratio"] == pytest.approx(100.0, rel=1e-6)
    assert ended.result["factor_m"] == pytest.approx(1.01, rel=1e-6)
    signals = read_joint(tmp_path / "j.toml").joint.signals
    assert signals is not None
    assert signals.angle_side == "motor"
    assert signals.motor_angle is not None
    assert signals.output_angle is not None
    refused = call(*base, "--angle-side", "motor", "--out", tmp_path / "k.toml")
    assert refused.code == 2
    assert "angle and motor-angle are both mapped" in refused.err


def test_what_cannot_be_told_is_said(tmp_path: Path, call: Call) -> None:
    run = simulate(make_joint(RIGHT, 3), constant_plan(8.0))
    log = _write(tmp_path / "steady.parquet", run, slice(4000, None))
    ended = call("identify", log, *OUTPUT, "--ratio", 100, "--out", tmp_path / "j.toml", "--json")
    assert ended.code == 0
    assert ended.result["delay_s"] is None
    assert "the motor's speed hardly changes" in ended.err
    assert "the motor is never at rest" in ended.err
    assert "has no [gear]" in ended.err
    assert ended.result["sections"] == ["signals", "ripple_filter"]
    short = _write(tmp_path / "short.parquet", run, slice(0, 620))
    ended = call("identify", short, *OUTPUT, "--ratio", 100, "--out", tmp_path / "k.toml", "--json")
    assert ended.code == 0
    assert "fewer than 3" in ended.err
    assert (ended.result["orders"], ended.result["memory_turns"]) == ([], None)


def test_what_is_refused(tmp_path: Path, call: Call) -> None:
    log = _write(tmp_path / "a.parquet", simulate(make_joint(RIGHT, 3)), slice(0, 3000))
    taken = tmp_path / "taken.toml"
    taken.write_text("mine")
    for out in (taken, tmp_path / "j.csv", tmp_path / "nowhere" / "j.toml"):
        ended = call("identify", log, *OUTPUT, "--ratio", 100, "--out", out)
        assert ended.code == 2
        assert f"--out {out}: " in ended.err
    assert taken.read_text() == "mine"
    still = _write(tmp_path / "s.parquet", simulate(make_joint(RIGHT, 3)), slice(0, 200))
    ended = call("identify", still, *OUTPUT, "--out", tmp_path / "j.toml")
    assert ended.code == 2
    assert "give the ratio" in ended.err
    assert not (tmp_path / "j.toml").exists()


def test_an_old_joint_file_is_kept_and_filled(tmp_path: Path, call: Call) -> None:
    log = _write(tmp_path / "a.parquet", simulate(make_joint(RIGHT, 3)))
    file = tmp_path / "elbow.toml"
    assert call("joint", "new", file, "--name", "elbow").code == 0
    given = ("--ratio", 100, "--rated-torque", FULL_SCALE_NM)
    assert call("identify", log, *OUTPUT, *given, "--joint", file, "--out", file).code == 0
    assert read_joint(file).joint.identity.name == "elbow"
    # The second time the file says all that the options said.
    ended = call("identify", log, "--joint", file, "--out", file, "--json")
    assert ended.code == 0
    assert ended.result["ratio"] == 100.0


class _Identified:
    """The ripple filter of a joint file, as a method of the bench."""

    name = "identified"

    def __init__(self, file: Path) -> None:
        self._joint = read_joint(file).joint

    def remove(self, log: Log, _setting: Setting, /) -> Removal:
        gear = self._joint.gear
        assert gear is not None
        # The bench multiplies the output's angle by 160.
        angle_rad = log.wave_angle_rad / kuka.RATIO * gear.ratio
        cleaned = RippleFilter(ripple_filter_of(self._joint)).process(
            log.time_s, angle_rad, log.torque_Nm
        )
        return Removal(cleaned.torque_Nm, cleaned.ripple_Nm)


def _score(file: Path, folder: Path, number: int) -> tuple[float, float]:
    method: Any = _Identified(file)
    score = kuka.score_on_kuka(method, {}, kuka.read_kuka_joint(folder, number), number)
    return score.attenuation_dB[0], score.injection_error_percent


def test_kuka_without_a_ratio(tmp_path: Path, call: Call) -> None:
    source = recording_path("kuka-lbr-med7", "constant-speed-400hz.csv")
    header, *lines = source.read_text().splitlines()
    early = [line for line in lines if float(line.split(",")[0]) < 20.0]
    log = tmp_path / "med7.csv"
    log.write_text("\n".join([header, *early]) + "\n")
    for number in (1, 2, 3, 4):
        mapping = f"time=t_s,angle=q{number}_rad,torque=tau{number}_Nm"
        file = tmp_path / f"j{number}.toml"
        ended = call(
            *("identify", log, "--map", mapping, "--angle-side", "output"),
            *("--rated-torque", 100, "--out", file, "--json"),
        )
        assert ended.code == 0
        assert ended.result["ratio"] == pytest.approx(160.0, abs=1.0)
        assert 0.02 < ended.result["ratio_standard_uncertainty"] < 0.6
        assert 2.0 in [each["order"] for each in ended.result["orders"]]
        assert "only the product of ratio and factor m" in ended.err
        removed_dB, error_percent = _score(file, source.parent.parent, number)
        assert 10.0 < removed_dB < 20.0
        assert 0.5 < error_percent < 5.0
    assert call("filter", source, "--joint", file, "--out", tmp_path / "o.csv").code == 0


def test_kuka_exciting_without_time_or_ratio(tmp_path: Path, call: Call) -> None:
    log = recording_path("kuka-lbr-med7", "exciting-100hz.csv")
    ended = call(
        *("identify", log, "--map", "angle=q_0,torque=tau_0", "--angle-side", "output"),
        *("--rate", 100, "--rated-torque", 176, "--out", tmp_path / "j.toml", "--json"),
    )
    assert ended.code == 0
    assert ended.result["ratio"] == pytest.approx(160.0, abs=0.3)
    assert [each["order"] for each in ended.result["orders"]][:2] == [2.0, 4.0]


@pytest.mark.parametrize("output", ["joint_angles_3", "encoder_loadinc_3:counts/16777216"])
def test_lara8_from_two_encoders(tmp_path: Path, call: Call, output: str) -> None:
    log = recording_path("neura-lara8", "validate-250hz.csv")
    mapping = (
        f"time=Timestamp,angle={output},motor-angle=encoder_motorinc_3:counts/16777216,"
        "torque=joint_torque_current_3"
    )
    ended = call(
        *("identify", log, "--map", mapping, "--angle-side", "output"),
        *("--rated-torque", 100, "--out", tmp_path / "j.toml", "--json"),
    )
    assert ended.code == 0
    assert ended.result["ratio"] == pytest.approx(101.0, abs=0.2)
    assert 2.0 in [each["order"] for each in ended.result["orders"]]
