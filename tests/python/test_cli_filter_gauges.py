"""`strainwave filter` on gauge voltages: gains, calibration and ripple filter from the joint file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from helpers.gauge_logs import mapping_of, station_of, turns_of, write_run
from helpers.log_files import command, write_parquet
from strainwave.joint import JointFile, build_section, read_joint, write_joint
from strainwave.joint.provenance import Provenance
from strainwave.simulate.driving import constant_speed, step
from strainwave.simulate.presets.godler2000 import RATED_TORQUE_NM
from strainwave.simulate.station import Station
from strainwave.simulate.trajectories import NOTHING, PiecewiseLinear

GAUGES = 5
GEAR = ("--ratio", 51, "--configuration", "flexspline-fixed")
MAP = mapping_of(GAUGES)

Call = Any


@pytest.fixture(scope="module")
def station() -> Station:
    return station_of(GAUGES)


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _put(joint_file: JointFile, name: str, values: dict[str, Any]) -> None:
    section = build_section(name, values, "a test")
    joint_file.set_section(name, section, Provenance.of_simulation("station of five gauges"))


@pytest.fixture
def joint(tmp_path: Path, call: Call, station: Station) -> Path:
    """Gains from a run without load, gain and zero of the sum from two loads held at many angles."""
    path = tmp_path / "joint.toml"
    log = write_run(tmp_path / "turns.parquet", turns_of(station, 2.0, 1))
    ended = call(
        *("calibrate", "fluctuation", log, "--map", MAP, "--harmonics", 2, *GEAR),
        *("--out", path, "--json"),
    )
    assert ended.code == 0, ended.err
    gains = np.array(ended.result["gains"])
    places = np.linspace(0.0, math.pi, 12, endpoint=False)
    read_V = [
        float(np.mean(station.hold(_constant(load), 0.2, 50, position_rad=at).volts @ gains))
        for load in (0.0, 60.0)
        for at in places
    ]
    zero_V, loaded_V = np.mean(np.reshape(read_V, (2, -1)), axis=1)
    joint_file = read_joint(path)
    _put(
        joint_file,
        "torque_calibration",
        {"gain_Nm_per_V": 60.0 / (loaded_V - zero_V), "zero_V": float(zero_V)},
    )
    _put(
        joint_file,
        "gear",
        {
            "ratio": 51.0,
            "configuration": "fixed_flexspline",
            "rated_torque_Nm": RATED_TORQUE_NM,
        },
    )
    write_joint(joint_file, path)
    return path


def _constant(torque_Nm: float) -> PiecewiseLinear:
    return PiecewiseLinear((0.0,), (torque_Nm,))


def _filtered(call: Call, log: Path, joint: Path, out: Path, *more: object) -> dict[str, Any]:
    ended = call(
        *("filter", log, "--map", MAP, "--angle-side", "motor", "--joint", joint, "--out", out),
        *("--json", *more),
    )
    assert ended.code == 0, ended.err
    assert "gauges=g1_V" in ended.result["settings"]["map"]
    return pq.read_table(out).to_pydict()


def test_clean_torque_at_power_up_at_standstill(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    """No filter can know the ripple before the motor has turned; gains do."""
    tuned, equal = [], []
    for k, place in enumerate(np.linspace(0.0, 2 * math.pi, 12, endpoint=False) + 0.05):
        run = station.hold(NOTHING, 0.1, 60 + k, position_rad=float(place))
        log = write_run(tmp_path / f"rest{k}.parquet", run)
        found = _filtered(call, log, joint, tmp_path / f"clean{k}.parquet")
        tuned.append(found["torque_Nm"][0] - run.truth.torque_Nm[0])
        equal.append(np.mean(run.volts[0]) * GAUGES)
    assert np.max(np.abs(tuned)) <= 0.0015 * RATED_TORQUE_NM
    # With equal gains the same angles read some percent, whatever the zero.
    swing_Nm = np.ptp(equal) / 2 * station.sensor_gain_Nm_per_V
    assert 0.01 * RATED_TORQUE_NM < swing_Nm < 0.04 * RATED_TORQUE_NM


def test_a_touch_while_turning(tmp_path: Path, call: Call, joint: Path, station: Station) -> None:
    run = station.rotate(
        constant_speed(60.0, 0.5), 4.0, 9, contact_torque=step(30.0, 2.5, 3.2, rise_s=0.02)
    )
    log = write_run(tmp_path / "run.parquet", run)
    found = _filtered(call, log, joint, tmp_path / "clean.parquet")
    error_Nm = np.array(found["torque_Nm"]) - run.truth.torque_Nm
    touched = (run.time_s > 2.6) & (run.time_s < 3.2)
    # What passes by the gauges (hysteresis of +-0.5 %FS) is in it.
    assert np.sqrt(np.mean(error_Nm[run.time_s > 1.0] ** 2)) < 0.01 * RATED_TORQUE_NM
    assert abs(np.mean(error_Nm[touched])) < 0.01 * RATED_TORQUE_NM
    raw_Nm = np.array(run.raw_torque_Nm) - run.truth.torque_Nm
    assert np.std(raw_Nm[run.time_s > 1.0]) > 2.5 * np.std(error_Nm[run.time_s > 1.0])


def test_the_joint_file_may_name_the_columns(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    joint_file = read_joint(joint)
    gauges = [{"column": f"g{j + 1}_V", "unit": "V"} for j in range(GAUGES)]
    _put(
        joint_file,
        "signals",
        {
            "time": {"column": "t_s", "unit": "s"},
            "motor_angle": {"column": "beta_rad", "unit": "rad"},
            "gauges": gauges,
        },
    )
    named = tmp_path / "named.toml"
    write_joint(joint_file, named)
    log = write_run(tmp_path / "run.parquet", turns_of(station, 3.0, 4))
    told = _filtered(call, log, joint, tmp_path / "told.parquet")
    ended = call("filter", log, "--joint", named, "--out", tmp_path / "named.parquet", "--json")
    assert ended.code == 0, ended.err
    assert pq.read_table(tmp_path / "named.parquet").to_pydict() == told


def test_a_missing_voltage_is_a_missing_torque(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    run = turns_of(station, 2.0, 5)
    columns = {"t_s": run.time_s, "beta_rad": run.motor_angle_rad}
    columns |= {f"g{j + 1}_V": run.volts[:, j].copy() for j in range(GAUGES)}
    columns["g3_V"][100:103] = np.nan
    log = write_parquet(tmp_path / "gaps.parquet", columns)
    ended = call(
        *("filter", log, "--map", MAP, "--angle-side", "motor", "--joint", joint),
        *("--out", tmp_path / "clean.parquet", "--json"),
    )
    assert ended.code == 0
    assert ended.result["rows_by_flag"]["torque_not_finite"] == 3
    assert "3 rows of" in ended.err


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        (mapping_of(4), "4 gauges are mapped, and joint"),
        (f"{MAP},torque=t_s", "torque and gauges are both mapped"),
        (MAP.replace("g5_V", "g9_V"), "no column 'g9_V' for gauge 5"),
        ("angle=beta_rad,time=t_s", "or gauges=COLUMN+COLUMN"),
    ],
)
def test_bad_mappings_have_their_sentence(
    tmp_path: Path, call: Call, joint: Path, station: Station, mapping: str, words: str
) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station, 1.0, 4))
    out = tmp_path / "clean.parquet"
    ended = call(
        *("filter", log, "--map", mapping, "--angle-side", "motor", "--joint", joint, "--out", out)
    )
    assert ended.code == 2
    assert words in ended.err
    assert not out.exists()


def test_gauges_need_a_calibration(tmp_path: Path, call: Call, station: Station) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station, 1.0, 4))
    out = tmp_path / "clean.parquet"
    base = ("filter", log, "--map", MAP, "--angle-side", "motor", "--out", out)
    ended = call(*base)
    assert ended.code == 2
    assert "nothing says what torque their voltage is" in ended.err
    path = tmp_path / "bare.toml"
    assert call("joint", "new", path, "--name", "bare").code == 0
    ended = call(*base, "--joint", path)
    assert ended.code == 2
    assert "it has no [gear]" in ended.err
