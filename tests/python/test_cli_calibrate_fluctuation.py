"""`strainwave calibrate fluctuation`: the experiments of Godler et al. from their simulated logs."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.gauge_logs import (
    columns_of,
    mapping_of,
    percent_of,
    station_of,
    turns_of,
    write_run,
)
from helpers.log_files import command, write_csv, write_parquet
from helpers.watched_joint import described_joint, fluctuation_call, put, write_loads
from strainwave.calibrate.fluctuation import equally_spaced_positions_rad
from strainwave.calibrate.fluctuation_run import fit_run
from strainwave.errors import InputError
from strainwave.joint import build_section, new_joint, read_joint, write_joint
from strainwave.joint.provenance import Provenance
from strainwave.simulate.driving import constant_speed
from strainwave.simulate.presets.godler2000 import godler2000
from strainwave.simulate.trajectories import PiecewiseLinear, Sine

Call = Any
GEAR = ("--ratio", 51, "--configuration", "flexspline-fixed")
PUBLISHED = [1.0586, 0.9966, 0.9448]


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def calibrate(call: Call, log: Path, gauges: int, harmonics: int, out: Path, *more: object) -> Any:
    ended = call(
        *("calibrate", "fluctuation", log, "--map", mapping_of(gauges)),
        *("--harmonics", harmonics, "--out", out, "--json", *more),
    )
    assert ended.code == 0, ended.err
    return ended


def other_run(station, seed: int):
    run = turns_of(station, 2.0, seed)
    return fit_run(
        run.volts,
        run.motor_angle_rad,
        positions_rad=[each.position_rad for each in station.gauges],
        harmonics=4,
        wave_factor=station.wave_factor,
    )


@pytest.mark.parametrize("seed", range(5))
def test_godlers_three_gauges(tmp_path: Path, call: Call, seed: int) -> None:
    station = station_of(3)
    log = write_run(tmp_path / "run.parquet", turns_of(station, 1.0, seed))
    out = tmp_path / "joint.toml"
    result = calibrate(call, log, 3, 1, out, *GEAR).result
    assert result["gains"] == pytest.approx(PUBLISHED, abs=0.002)
    assert sum(result["gains"]) == pytest.approx(3)
    # On another recording: the line at order 2 is gone, that at order 4 is what remains.
    fit = other_run(station, 100 + seed)
    gains = np.array(result["gains"])
    left, spread = np.abs(fit.weighted_sum(gains)), fit.sum_standard_uncertainty(gains)
    largest = max(result["amplitudes"][0])
    assert left[0] <= max(1e-3 * largest, 3 * spread[0])
    assert left[1] > 20 * spread[1]
    assert left[2] < 5 * spread[2]
    assert result["not_cancelled"][0]["residual_after"] == pytest.approx(left[1], rel=0.05)
    # The paper's +-0.2 %FS of higher frequencies.
    assert percent_of(station, left[1:2])[0] == pytest.approx(0.2, abs=0.1)
    assert percent_of(station, np.array(result["residual_before"]))[0] == pytest.approx(2, abs=0.2)
    section = read_joint(out).joint.gains
    assert section is not None
    assert section.gains == tuple(result["gains"])
    assert section.harmonics == (1,)
    assert section.residual_fluctuation_V == pytest.approx(left[1] / math.sqrt(2), rel=0.05)
    provenance = section.provenance
    assert provenance is not None
    assert provenance.input_sha256 == hashlib.sha256(log.read_bytes()).hexdigest()
    assert str(provenance.command).startswith("strainwave calibrate fluctuation ")


def standstill_percent(station, gains: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Torque read right after power-up at standstill without load, %FS, at many angles."""
    nothing = PiecewiseLinear((0.0,), (0.0,))
    read = [
        float(((station.hold(nothing, 0.02, k, position_rad=place).volts - offsets) @ gains)[0])
        for k, place in enumerate(np.linspace(0, 2 * math.pi, 24, endpoint=False) + 0.05)
    ]
    return percent_of(station, np.array(read))


def test_five_gauges_two_harmonics_and_power_up(tmp_path: Path, call: Call) -> None:
    station = station_of(5)
    log = write_run(tmp_path / "run.parquet", turns_of(station, 2.0, 1))
    result = calibrate(call, log, 5, 2, tmp_path / "joint.toml", *GEAR).result
    gains = np.array(result["gains"])
    fit = other_run(station, 77)
    left, spread = np.abs(fit.weighted_sum(gains)), fit.sum_standard_uncertainty(gains)
    for i in range(2):
        assert left[i] <= max(1e-3 * max(result["amplitudes"][i]), 3 * spread[i])
    assert result["is_exact"]
    assert result["residual_held_out"][0] < 1e-3 * max(result["amplitudes"][0])
    tuned = standstill_percent(station, gains, fit.offsets)
    equal = standstill_percent(station, np.ones(5), fit.offsets)
    assert np.abs(tuned).max() <= 0.15
    assert 1.0 < np.abs(equal).max() < 4.0


@pytest.mark.parametrize("gauges", [3, 5])
def test_without_an_angle_the_gains_are_the_same(tmp_path: Path, call: Call, gauges: int) -> None:
    station = station_of(gauges)
    log = write_run(tmp_path / "run.parquet", turns_of(station, 2.0, 3))
    with_angle = calibrate(call, log, gauges, 1, tmp_path / "a.toml", *GEAR).result
    ended = call(
        *("calibrate", "fluctuation", log, "--map", mapping_of(gauges, angle="")),
        *("--harmonics", 1, "--out", tmp_path / "b.toml", "--json"),
    )
    assert ended.code == 0
    assert "modulo pi; its zero is where" in ended.err
    assert ended.result["gains"] == pytest.approx(with_angle["gains"], abs=5e-4)
    assert (ended.result["angle_source"], ended.result["factor_m"]) == ("gauges", None)


def test_two_gauges_reach_the_least_residual_and_say_so(tmp_path: Path, call: Call) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(4), 2.0, 3))
    base = ("calibrate", "fluctuation", log, "--harmonics", 1, "--ratio", 50, "--configuration")
    base += ("circular-spline-fixed", "--out", tmp_path / "j.toml")
    # Gauges 1 and 3 are 90 degrees apart, nearly opposite in the wave.
    opposite = call(*base, "--map", "angle=beta_rad,gauges=g1_V+g3_V", "--json")
    assert opposite.code == 0
    assert not opposite.result["is_exact"]
    assert opposite.result["residual_after"][0] < opposite.result["residual_before"][0]
    assert "The fluctuation does not vanish" in opposite.err
    assert "2 gauges are fewer than the 3" in opposite.err


def test_a_harmonic_that_looks_like_torque_is_said(tmp_path: Path, call: Call) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(godler2000(2), 2.0, 3))
    ended = calibrate(
        *(call, log, 2, 2, tmp_path / "j.toml", "--ratio", 50),
        *("--configuration", "circular-spline-fixed"),
    )
    assert "harmonic 2 has nearly one phase on all 2 gauges, as torque has" in ended.err
    assert not ended.result["is_exact"]


def test_gauges_at_one_place_are_refused(tmp_path: Path, call: Call) -> None:
    columns: dict[str, Any] = dict(columns_of(turns_of(station_of(3), 2.0, 3)))
    random = np.random.default_rng(2)
    for j in (2, 3):
        columns[f"g{j}_V"] = columns["g1_V"] * (1 + 0.05 * j) + random.normal(0, 0.001, 2000)
    log = write_parquet(tmp_path / "run.parquet", columns)
    ended = call(
        *("calibrate", "fluctuation", log, "--map", mapping_of(3), "--harmonics", 1, *GEAR),
        *("--out", tmp_path / "j.toml"),
    )
    assert ended.code == 2
    assert "harmonic 1 has nearly one phase on all 3 gauges" in ended.err
    assert not (tmp_path / "j.toml").exists()


def test_a_factor_that_does_not_fit_is_said_and_can_be_found(tmp_path: Path, call: Call) -> None:
    station = station_of(4)
    log = write_run(tmp_path / "run.parquet", turns_of(station, 6.0, 3))
    ended = calibrate(call, log, 4, 1, tmp_path / "a.toml")
    assert "a fixed circular spline of ratio 50 turns so" in ended.err
    wrong = calibrate(
        *(call, log, 4, 1, tmp_path / "b.toml", "--ratio", 80),
        *("--configuration", "circular-spline-fixed"),
    )
    assert "check --ratio" in wrong.err
    right = calibrate(
        *(call, log, 4, 1, tmp_path / "c.toml", "--ratio", 50),
        *("--configuration", "circular-spline-fixed"),
    )
    assert "times per motor turn" not in right.err
    found = calibrate(call, log, 4, 1, tmp_path / "d.toml", "--fit-factor").result
    assert found["factor_m"] == pytest.approx(1.02, abs=1e-5)
    assert found["gains"] == pytest.approx(right.result["gains"], abs=1e-3)


def test_a_grid_of_loads(tmp_path: Path, call: Call) -> None:
    station = station_of(5)
    parts = []
    for k, load in enumerate((-60.0, 0.0, 60.0)):
        torque = PiecewiseLinear((0.0,), (load,))
        run = station.rotate(PiecewiseLinear((0.0,), (2 * math.pi,)), 1.5, k, torque)
        columns = columns_of(run)
        columns["load_Nm"] = np.full(len(run.time_s), load) + 0.01 * run.volts[:, 0]
        columns["t_s"] = columns["t_s"] + 10.0 * k
        parts.append(columns)
    whole = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    log = write_parquet(tmp_path / "grid.parquet", whole)
    results = {}
    for way in ("sum", "worst"):
        ended = call(
            *("calibrate", "fluctuation", log, "--map", mapping_of(5) + ",load=load_Nm"),
            *("--harmonics", 2, *GEAR, "--over-grid", way, "--out", tmp_path / f"{way}.toml"),
            "--json",
        )
        assert ended.code == 0, ended.err
        results[way] = ended.result
    cells = results["sum"]["conditions"]
    assert [round(cell["load_Nm"]) for cell in cells] == [-60, 0, 60]
    after = {
        way: np.array([cell["residual_after"] for cell in result["conditions"]])
        for way, result in results.items()
    }
    before = np.array([cell["residual_before"] for cell in cells])
    assert np.all(np.linalg.norm(after["sum"], axis=1) < 0.3 * np.linalg.norm(before, axis=1))
    worst = {way: np.linalg.norm(each, axis=1).max() for way, each in after.items()}
    assert worst["worst"] <= worst["sum"] * (1 + 1e-6)
    assert results["sum"]["residual_after"] == pytest.approx(after["sum"].max(axis=0))


def test_experiments_by_name(tmp_path: Path, call: Call) -> None:
    columns: dict[str, Any] = dict(columns_of(turns_of(station_of(3), 2.0, 3)))
    columns["run"] = ["cold"] * 1000 + ["warm"] * 1000
    columns["temp"] = [20.0] * 1000 + [35.0] * 1000
    log = write_csv(tmp_path / "run.csv", columns)
    ended = call(
        *("calibrate", "fluctuation", log, "--harmonics", 1, *GEAR),
        *("--map", mapping_of(3) + ",experiment=run,temperature=temp"),
        *("--out", tmp_path / "j.toml", "--json"),
    )
    assert ended.code == 0
    names = [cell["name"] for cell in ended.result["conditions"]]
    assert names == ["cold, 20 degC", "warm, 35 degC"]
    assert ended.result["gains"] == pytest.approx(PUBLISHED, abs=0.002)


@pytest.mark.parametrize("circuit", ["potentiometer:256", "E24", "E96"])
def test_quantised_gains_are_those_in_the_file(tmp_path: Path, call: Call, circuit: str) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(3), 1.0, 3))
    out = tmp_path / "j.toml"
    result = calibrate(call, log, 3, 1, out, *GEAR, "--quantise", circuit).result
    section = read_joint(out).joint.gains
    assert section is not None
    assert section.gains == tuple(result["gains"])
    quantised = result["quantised"]
    assert quantised["solved_gains"] == pytest.approx(PUBLISHED, abs=0.002)
    scale = sum(result["gains"]) / 3
    assert result["residual_after"][0] / scale <= quantised["residual_rounded_one_by_one"][0] * 1.1
    assert result["residual_after"][0] < result["residual_before"][0]
    assert len(quantised["settings"]) == 3


def gauges_joint(tmp_path: Path, count: int, **more: Any) -> Path:
    """A joint file with converter, gear and gauges."""
    joint = new_joint("elbow")
    rosettes = [
        {"position_rad": float(place), "gauge_factor": 2.0}
        for place in equally_spaced_positions_rad(count)
    ]
    values = {
        "wiring": "half_bridge_each",
        "bridge_supply_V": 10.0,
        "amplifier_gain": 1000.0,
        "converter_bits": 16,
        "converter_minimum_V": -10.0,
        "converter_maximum_V": 10.0,
        "rosettes": rosettes,
    } | more
    provenance = Provenance.by_hand()
    joint.set_section("gauges", build_section("gauges", values, "test"), provenance)
    gear = {"configuration": "fixed_flexspline", "ratio": 51, "rated_torque_Nm": 100.0}
    joint.set_section("gear", build_section("gear", gear, "test"), provenance)
    path = tmp_path / "elbow.toml"
    write_joint(joint, path)
    return path


def test_counts_positions_and_gear_from_the_joint_file(tmp_path: Path, call: Call) -> None:
    run = turns_of(station_of(3), 1.0, 3)
    columns = {"beta_rad": run.motor_angle_rad}
    columns |= {f"g{j + 1}": np.ascontiguousarray(run.codes[:, j]) for j in range(3)}
    log = write_parquet(tmp_path / "codes.parquet", columns)
    file = gauges_joint(tmp_path, 3)
    words = ("calibrate", "fluctuation", log, "--map", "angle=beta_rad,gauges=g1+g2+g3:counts")
    ended = call(*words, "--harmonics", 1, "--joint", file, "--out", file, "--json")
    assert ended.code == 0, ended.err
    assert ended.result["gains"] == pytest.approx(PUBLISHED, abs=0.002)
    assert "equally spaced" not in ended.err
    assert read_joint(file).joint.identity.name == "elbow"
    refused = call(*words, "--harmonics", 1, "--out", tmp_path / "j.toml")
    assert refused.code == 2
    assert "nothing says what a count is" in refused.err
    four = call(
        *("calibrate", "fluctuation", log, "--map", "angle=beta_rad,gauges=g1+g2:counts"),
        *("--harmonics", 1, "--joint", file, "--out", file),
    )
    assert four.code == 2
    assert "3 channel(s)" in four.err


def test_gains_for_a_lost_gauge_are_stored(tmp_path: Path, call: Call) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(4), 2.0, 3))
    out = tmp_path / "j.toml"
    result = calibrate(
        call, log, 4, 1, out, "--ratio", 50, "--configuration", "circular-spline-fixed"
    ).result
    section = read_joint(out).joint.gains
    assert section is not None
    assert [each.gauge for each in section.without_gauge] == [
        each["gauge"] for each in result["without_gauge"]
    ]
    for each in section.without_gauge:
        assert each.gains[each.gauge - 1] == 0
        assert sum(each.gains) == pytest.approx(4)


def test_a_delay_is_found_or_taken_from_the_joint_file(tmp_path: Path, call: Call) -> None:
    base = station_of(3)
    late = replace(base.acquisition, angle_to_torque_delay_s=0.003)
    station = replace(base, acquisition=late)
    run = station.rotate(Sine(3 * math.pi, 0.4, 0.0, 4 * math.pi), 5.0, 1)
    log = write_run(tmp_path / "run.parquet", run)
    plain = calibrate(call, log, 3, 1, tmp_path / "a.toml", *GEAR).result
    found = calibrate(call, log, 3, 1, tmp_path / "b.toml", *GEAR, "--fit-delay").result
    assert found["delay_s"] == pytest.approx(0.003, abs=5e-5)
    assert plain["delay_s"] == 0
    errors = [np.max(each["amplitudes_standard_error"]) for each in (plain, found)]
    assert errors[0] > 10 * errors[1]
    assert found["phases_rad"][0] == pytest.approx([0.0, -0.026, -0.007], abs=0.004)
    file = gauges_joint(tmp_path, 3)
    joint = read_joint(file)
    values = {"angle_to_torque_delay_s": 0.003}
    joint.set_section("signals", build_section("signals", values, "test"), Provenance.by_hand())
    write_joint(joint, file)
    told = calibrate(call, log, 3, 1, file, "--joint", file)
    assert told.result["amplitudes"][0] == pytest.approx(found["amplitudes"][0], rel=1e-4)
    ended = call(
        *("calibrate", "fluctuation", log, "--map", "angle=beta_rad,gauges=g1_V+g2_V+g3_V"),
        *("--harmonics", 1, "--joint", file, "--out", file),
    )
    assert ended.code == 0
    assert "not taken out without a column of time" in ended.err


def test_time_that_falls_is_refused_where_it_matters(tmp_path: Path, call: Call) -> None:
    columns = columns_of(turns_of(station_of(3), 2.0, 3))
    columns["t_s"][700] = 0.1
    log = write_parquet(tmp_path / "run.parquet", columns)
    words = ("calibrate", "fluctuation", log, "--map", mapping_of(3), "--harmonics", 1, *GEAR)
    assert call(*words, "--out", tmp_path / "a.toml").code == 0
    ended = call(*words, "--fit-delay", "--out", tmp_path / "b.toml")
    assert ended.code == 2
    assert "row 701" in ended.err


def test_torque_sensitivities_are_kept_and_stored(tmp_path: Path, call: Call) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(5), 1.0, 3))
    out = tmp_path / "j.toml"
    torque = [1.0, 1.05, 0.95, 1.1, 0.9]
    text = ",".join(map(str, torque))
    result = calibrate(call, log, 5, 1, out, *GEAR, "--torque-sensitivity", text).result
    assert np.dot(result["gains"], torque) == pytest.approx(sum(torque))
    section = read_joint(out).joint.gains
    assert section is not None
    assert section.torque_sensitivities == tuple(torque)
    # Next time they are known.
    again = calibrate(call, log, 5, 1, out, *GEAR, "--joint", out).result
    assert again["gains"] == pytest.approx(result["gains"], rel=1e-12)


def test_gauges_at_the_end_of_the_range_are_said(tmp_path: Path, call: Call) -> None:
    run = turns_of(station_of(3), 1.0, 3)
    columns = {"beta_rad": run.motor_angle_rad}
    columns |= {f"g{j + 1}": np.ascontiguousarray(run.codes[:, j]) for j in range(3)}
    log = write_parquet(tmp_path / "codes.parquet", columns)
    half = {"converter_minimum_V": -1.75, "converter_maximum_V": 1.75}
    file = gauges_joint(tmp_path, 3, **half)
    step = 3.5 / 2**16
    for j in range(3):
        codes = np.clip(np.round((run.volts[:, j] + 1.75) / step), 0, 2**16 - 1)
        columns[f"g{j + 1}"] = codes.astype(np.int32)
    write_parquet(log, columns)
    ended = call(
        *("calibrate", "fluctuation", log, "--map", "angle=beta_rad,gauges=g1+g2+g3:counts"),
        *("--harmonics", 1, "--joint", file, "--out", file),
    )
    assert ended.code == 0
    assert "gauge 3 is at an end of the converter's range" in ended.err
    assert "gauge 1 is at an end" not in ended.err


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_vector_diagram(tmp_path: Path, call: Call, suffix: str) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(5), 1.0, 3))
    for name in ("a", "b"):
        figure = tmp_path / f"{name}.{suffix}"
        calibrate(call, log, 5, 2, tmp_path / f"{name}.toml", *GEAR, "--figure", figure)
    first, second = ((tmp_path / f"{name}.{suffix}").read_bytes() for name in ("a", "b"))
    assert first == second
    assert len(first) > 5000


def test_a_person_reads_a_table(tmp_path: Path, call: Call) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(3), 2.0, 3))
    ended = call(
        *("calibrate", "fluctuation", log, "--map", mapping_of(3), "--harmonics", 1, *GEAR),
        *("--out", tmp_path / "j.toml"),
    )
    assert ended.code == 0
    for words in ("[gains] from 2000 rows", "gauge 3", "noise factor 1.002", "not cancelled"):
        assert words in ended.out


BASE = {
    "--map": mapping_of(3),
    "--harmonics": "1",
    "--ratio": "51",
    "--configuration": "flexspline-fixed",
}


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"--map": "angle=beta_rad,gauges=g1_V"}, "1 gauge column is mapped"),
        ({"--map": "angle=beta_rad"}, "nothing is mapped for gauges"),
        ({"--map": "angle=beta_rad,gauges=g1_V+g9_V"}, "g9_V"),
        ({"--map": "angle=beta_rad,gauges=g1_V+g1_V"}, "mapped twice for gauges"),
        ({"--map": "angle=beta_rad,gauges=g1_V+g2_V:Nm"}, "unit 'Nm' of gauges is unknown"),
        ({"--map": "gauges=g1_V+g2_V"}, "at least 3 gauges to find an angle"),
        ({"--map": "gauges=g1_V+g2_V+g3_V", "--fit-factor": None}, "no angle is mapped"),
        ({"--map": "gauges=g1_V+g2_V+g3_V", "--fit-delay": None}, "no angle is mapped"),
        ({"--harmonics": "0"}, "--harmonics 0: expected a whole number"),
        ({"--harmonics": "17"}, "--harmonics 17: expected a whole number"),
        ({"--harmonics": "1.5"}, "--harmonics 1.5: expected a whole number"),
        ({"--harmonics": "one"}, "harmonics"),
        ({"--ratio": "0.5"}, "--ratio 0.5: expected"),
        ({"--configuration": None}, "configuration"),
        ({"--configuration": "wave-fixed"}, "configuration"),
        ({"--joint": "nowhere.toml"}, "nowhere.toml"),
        ({"--out": "joint.csv"}, "expected a joint file"),
        ({"--out": "nowhere/joint.toml"}, "existing folder"),
        ({"--torque-sensitivity": "1,1"}, "expected 3 numbers"),
        ({"--torque-sensitivity": "1,-1,0"}, "do not add up to 0"),
        ({"--torque-sensitivity": "1,a,1"}, "numbers by commas"),
        ({"--quantise": "E12"}, "--quantise E12: expected"),
        ({"--quantise": "potentiometer:256:0:0.5"}, "gauge 1 needs a gain of 1.0"),
        ({"--most-noise": "0.5"}, "most_noise = 0.5: expected at least 1"),
        ({"--over-grid": "best"}, "over-grid"),
        ({"--figure": "vectors.gif"}, "--figure vectors.gif: the name ends in"),
        ({"--figure": "nowhere/vectors.svg"}, "existing folder"),
        ({"--joint": "old.svg", "--figure": "old.svg"}, "it is the file that is read"),
        ({"--fit-delay": None}, "expected at least 1.5 turns"),
        ({"--fit-factor": None}, "expected at least 1.5 turns"),
    ],
)
def test_what_cannot_be_used_is_refused(
    tmp_path: Path, call: Call, monkeypatch: pytest.MonkeyPatch, changed: Any, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_run(tmp_path / "run.parquet", turns_of(station_of(3), 1.0, 3))
    options = {**BASE, "--out": "joint.toml", **changed}
    line: list[object] = ["calibrate", "fluctuation", "run.parquet"]
    for name, value in options.items():
        line += [name] if value is None else [name, value]
    ended = call(*line)
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert not (tmp_path / "joint.toml").exists()


def test_a_figure_that_fails_leaves_no_joint_file(
    tmp_path: Path, call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_given: object) -> None:
        raise InputError("no room for the figure")

    monkeypatch.setattr("strainwave.report.figure_file.write_figure", fail)
    write_run(tmp_path / "run.parquet", turns_of(station_of(3), 1.0, 3))
    ended = call(
        *("calibrate", "fluctuation", tmp_path / "run.parquet", "--map", mapping_of(3)),
        *("--harmonics", 1, "--out", tmp_path / "joint.toml", "--figure", tmp_path / "f.svg"),
    )
    assert (ended.code, ended.err) == (2, "strainwave: no room for the figure")
    assert [path.name for path in tmp_path.iterdir()] == ["run.parquet"]


def test_options_that_belong_together(tmp_path: Path, call: Call) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(3), 1.0, 3))
    base = ("calibrate", "fluctuation", log, "--map", mapping_of(3), "--harmonics", 1)
    for given, words in (
        (("--ratio", 51), "is given without --configuration"),
        (("--configuration", "circular-spline-fixed"), "is given without --ratio"),
    ):
        ended = call(*base, *given, "--out", tmp_path / "j.toml")
        assert ended.code == 2
        assert words in ended.err
    taken = tmp_path / "taken.toml"
    taken.write_text("mine")
    ended = call(*base, *GEAR, "--out", taken)
    assert ended.code == 2
    assert taken.read_text() == "mine"


def test_bad_recordings(tmp_path: Path, call: Call) -> None:
    columns = {
        name: values.copy() for name, values in columns_of(turns_of(station_of(3), 1.0, 3)).items()
    }

    def ended_with(name: str, values: Any) -> Any:
        changed: dict[str, Any] = dict(columns)
        changed[name] = values
        log = write_csv(tmp_path / "bad.csv", changed)
        return call(
            *("calibrate", "fluctuation", log, "--map", mapping_of(3), "--harmonics", 1, *GEAR),
            *("--out", tmp_path / "j.toml"),
        )

    gap = [None if row == 41 else value for row, value in enumerate(columns["g2_V"])]
    noise = 0.001 * np.random.default_rng(1).normal(size=1000)
    for name, values, words in (
        ("g2_V", gap, "row 42"),
        ("g2_V", np.full(1000, 0.5), "has the value 0.5 in every row"),
        ("beta_rad", columns["beta_rad"] / 10, "less than half a turn"),
        ("beta_rad", columns["beta_rad"] * 0 + 1, "less than half a turn"),
    ):
        ended = ended_with(name, values)
        assert ended.code == 2
        assert words in ended.err
    for j in range(3):
        columns[f"g{j + 1}_V"] = noise * (1 + j) + np.random.default_rng(j).normal(size=1000)
    ended = ended_with("g1_V", columns["g1_V"])
    assert ended.code == 2
    assert "no gauge shows a fluctuation" in ended.err
    assert not (tmp_path / "j.toml").exists()


def joint_gains(path: Path) -> Any:
    section = read_joint(path).joint.gains
    assert section is not None
    return section


def test_what_the_watch_over_the_gauges_needs(tmp_path: Path, call: Call) -> None:
    station = station_of(5)
    path = described_joint(tmp_path / "joint.toml", station)
    log = write_loads(tmp_path / "loads.parquet", station)
    ended = call(*fluctuation_call(log, path, 5, 2), "--without-gauge-harmonics", 1)
    assert ended.code == 0, ended.err
    section = joint_gains(path)
    assert len(section.gauge_signals) == 5
    assert all(len(each.amplitudes_V) == 3 for each in section.gauge_signals)
    # The station's noise, and that of the converter's rounding taken off.
    assert section.noise_V == pytest.approx(1e-3, rel=0.05)
    # What these signals leave of other sound gauges, at other angles, speeds and loads.
    run = station.rotate(
        constant_speed(90.0, 0.5), 3.0, 31, contact_torque=PiecewiseLinear((0, 3), (-50.0, 50.0))
    )
    left = run.volts - np.array([each.zero_V for each in section.gauge_signals])
    for j, each in enumerate(section.gauge_signals):
        for i, (amplitude, phase) in enumerate(
            zip(each.amplitudes_V, each.phases_rad, strict=True), 1
        ):
            left[:, j] -= amplitude * np.sin(2 * i * run.motor_angle_rad + phase)
    torque = left.mean(axis=1)
    length = np.linalg.norm(left - torque[:, np.newaxis], axis=1)
    limit = section.consistency_limit_V + section.consistency_limit_share * np.abs(
        torque
    ) * math.sqrt(5)
    assert np.all(length < limit)
    assert np.max(length / limit) > 0.2
    # Gains without a gauge keep torque and zero, and state what they leave.
    run = turns_of(station, 2.0, 8)
    for stored, told in zip(section.without_gauge, ended.result["without_gauge"], strict=True):
        assert sum(stored.gains) == pytest.approx(5)
        shift_V = told["zero_shift_V"]
        zeros_V = np.array([each.zero_V for each in section.gauge_signals])
        assert shift_V == pytest.approx(
            (np.array(stored.gains) - section.gains) @ zeros_V, abs=1e-9
        )
        seen_V = float(np.std(run.volts @ np.array(stored.gains)))
        assert told["residual_rms"] == stored.residual_fluctuation_V
        # Stated is the worst of the loads; this is without load.
        assert 0.4 * told["residual_rms"] < seen_V < told["residual_rms"]
        assert told["residual_after"][0] < 1e-3 < told["residual_after"][1]
    missing = ended.result["gauge_watch"]["missing"]
    assert missing == [
        "gains without a gauge leave harmonic 2, as asked: ripple comes back when one is lost"
    ]


def test_one_load_gives_a_limit_and_no_growth(tmp_path: Path, call: Call) -> None:
    station = station_of(5)
    log = write_run(tmp_path / "run.parquet", turns_of(station, 3.0, 3))
    out = tmp_path / "j.toml"
    watch = calibrate(call, log, 5, 2, out, *GEAR).result["gauge_watch"]
    section = joint_gains(out)
    assert section.consistency_limit_share is None
    # Noise of 1 mV in four directions, half as much again; the wave's own harmonics beyond.
    assert 0.004 < section.consistency_limit_V == watch["consistency_limit_V"] < 0.03
    assert section.noise_V == pytest.approx(1e-3, rel=0.1)
    assert section.without_gauge == ()
    words = " ".join(watch["missing"])
    assert "--without-gauge-harmonics 1 stores gains that let ripple come back" in words
    assert "record" in words
    assert "under one load alone" in words
    ended = call(
        *("calibrate", "fluctuation", log, "--map", mapping_of(5), "--harmonics", 2, *GEAR),
        *("--out", tmp_path / "k.toml"),
    )
    assert "lost gauge     4 gauges do not cancel 2 harmonic(s)" in ended.out


def test_without_an_angle_there_are_zeros_and_no_wave(tmp_path: Path, call: Call) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(5), 2.0, 3))
    out = tmp_path / "j.toml"
    ended = call(
        *("calibrate", "fluctuation", log, "--map", mapping_of(5, angle="")),
        *("--harmonics", 1, "--out", out, "--json"),
    )
    assert ended.code == 0, ended.err
    section = joint_gains(out)
    assert all(each.amplitudes_V == () for each in section.gauge_signals)
    assert section.consistency_limit_V is None
    assert len(section.without_gauge) == 5
    assert any("without an angle" in words for words in ended.result["gauge_watch"]["missing"])


def test_a_delay_that_the_joint_file_does_not_have_leaves_the_comparison_out(
    tmp_path: Path, call: Call
) -> None:
    base = station_of(5)
    station = replace(base, acquisition=replace(base.acquisition, angle_to_torque_delay_s=0.003))
    run = station.rotate(Sine(3 * math.pi, 0.4, 0.0, 4 * math.pi), 5.0, 1)
    log = write_run(tmp_path / "run.parquet", run)
    out = tmp_path / "j.toml"
    result = calibrate(call, log, 5, 2, out, *GEAR, "--fit-delay").result
    assert joint_gains(out).consistency_limit_V is None
    assert any("angle_to_torque_delay_s" in words for words in result["gauge_watch"]["missing"])


def test_what_a_person_chose_stays(tmp_path: Path, call: Call) -> None:
    station = station_of(5)
    path = described_joint(tmp_path / "joint.toml", station)
    joint_file = read_joint(path)
    put(joint_file, "gains", {"gains": [1.0] * 5, "detection_time_s": 0.02})
    write_joint(joint_file, path)
    log = write_loads(tmp_path / "loads.parquet", station, (0.0, 40.0))
    ended = call(*fluctuation_call(log, path, 5, 1))
    assert ended.code == 0, ended.err
    assert joint_gains(path).detection_time_s == 0.02
    assert [each.gauge for each in joint_gains(path).without_gauge] == [1, 2, 3, 4, 5]


def test_gains_of_a_circuit_and_those_without_a_gauge_read_one_torque(
    tmp_path: Path, call: Call
) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(5), 2.0, 3))
    out = tmp_path / "j.toml"
    calibrate(call, log, 5, 1, out, *GEAR, "--quantise", "E24")
    section = joint_gains(out)
    assert abs(sum(section.gains) - 5) > 1e-3
    for each in section.without_gauge:
        assert sum(each.gains) == pytest.approx(sum(section.gains), rel=1e-12)


@pytest.mark.parametrize(
    ("gauges", "harmonics", "asked", "words"),
    [
        (5, 2, 2, "expected a whole number from 1 to 1"),
        (5, 2, 0, "expected a whole number from 1 to 1"),
        (5, 1, 2, "expected a whole number from 1 to 1"),
        (3, 1, 1, "expected four gauges or more"),
    ],
)
def test_harmonics_that_the_others_do_not_cancel_are_refused(
    tmp_path: Path, call: Call, gauges: int, harmonics: int, asked: int, words: str
) -> None:
    log = write_run(tmp_path / "run.parquet", turns_of(station_of(gauges), 1.0, 3))
    out = tmp_path / "j.toml"
    ended = call(
        *("calibrate", "fluctuation", log, "--map", mapping_of(gauges), "--harmonics", harmonics),
        *("--out", out, "--without-gauge-harmonics", asked),
    )
    assert ended.code == 2
    assert f"--without-gauge-harmonics {asked}: " in ended.err
    assert words in ended.err
    assert not out.exists()
