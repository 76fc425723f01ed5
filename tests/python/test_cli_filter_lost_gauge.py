"""`strainwave filter` on gauges of which one fails: the torque goes on, and it is said what happened."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import strainwave as sw
from benchmarks.faults.station import changing_load, changing_speed
from helpers.gauge_logs import mapping_of, station_of, turns_of, write_run
from helpers.log_files import command, write_parquet
from helpers.watched_joint import described_joint, put, put_calibration, write_loads
from strainwave.commissioning.fluctuation import FluctuationOptions, calibrate_fluctuation
from strainwave.joint import read_joint, write_joint
from strainwave.records.conversion import Columns
from strainwave.records.gauge_watch import GaugeWatch
from strainwave.simulate import Fault, FaultKind
from strainwave.simulate.driving import constant_speed, step
from strainwave.simulate.presets.godler2000 import RATED_TORQUE_NM
from strainwave.simulate.results import Run
from strainwave.simulate.station import Station

GAUGES = 5
LOST = 3
FAULT_S = 1.2
MAP = mapping_of(GAUGES)
FLAG = sw.StatusFlag

Call = Any


@pytest.fixture(scope="module")
def station() -> Station:
    return station_of(GAUGES)


def _commissioned(folder: Path, station: Station, without: int | None) -> Path:
    path = described_joint(folder / f"joint{without}.toml", station)
    options = FluctuationOptions(
        mapping=(f"{MAP},load=load_Nm",), harmonics=2, without_gauge_harmonics=without
    )
    log = write_loads(folder / f"loads{without}.parquet", station)
    calibrate_fluctuation(log, path, options, joint_path=path)
    put_calibration(path, station)
    return path


@pytest.fixture(scope="module")
def joint(station: Station, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With gains without each gauge that cancel the first harmonic, as asked for."""
    return _commissioned(tmp_path_factory.mktemp("joint"), station, 1)


@pytest.fixture(scope="module")
def joint_without_sets(station: Station, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _commissioned(tmp_path_factory.mktemp("bare"), station, None)


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def run_of(station: Station, kind: str | None, seed: int = 9, lost: int = LOST) -> Run:
    if kind is not None:
        fault = Fault(FaultKind(kind), lost - 1, FAULT_S)
        station = station.with_changes(faults=(fault,))
    return station.rotate(
        constant_speed(60.0, 0.5), 2.5, seed, contact_torque=step(30.0, 1.6, 2.1, rise_s=0.02)
    )


def filtered(call: Call, log: Path, joint: Path, *more: object) -> tuple[Any, dict[str, Any]]:
    out = log.with_name(f"{log.stem}_clean.parquet")
    ended = call(
        *("filter", log, "--map", MAP, "--angle-side", "motor", "--joint", joint, "--out", out),
        *("--json", *more),
    )
    assert ended.code == 0, ended.err
    table = pq.read_table(out)
    return ended, {name: table[name].to_numpy() for name in table.column_names}


@pytest.mark.parametrize("number", range(1, GAUGES + 1))
@pytest.mark.parametrize(
    ("kind", "name"), [("open", "open"), ("stuck", "stuck"), ("short", "shorted")]
)
def test_torque_goes_on_without_a_lost_gauge(
    tmp_path: Path, call: Call, joint: Path, station: Station, kind: str, name: str, number: int
) -> None:
    run = run_of(station, kind, lost=number)
    ended, found = filtered(call, write_run(tmp_path / "run.parquet", run), joint)
    lost = ended.result["gauge_watch"]["lost"]
    assert (lost["gauge"], lost["fault"], lost["goes_on"]) == (number, name, True)
    failed = int(np.flatnonzero(run.time_s >= FAULT_S)[0]) + 1
    assert failed <= lost["left_out_from_row"] <= lost["row"] <= failed + 15
    assert lost["log_time_s"] == run.time_s[lost["row"] - 1]
    # Flags, row for row.
    is_lost = (found["status"] & FLAG.gauge_lost.value) != 0
    assert np.flatnonzero(is_lost).tolist() == list(range(lost["row"] - 1, len(run.time_s)))
    assert ended.result["rows_by_flag"]["gauge_lost"] == np.count_nonzero(is_lost)
    assert ended.result["rows_by_flag"]["gauges_insufficient"] == 0
    # What the torque is made of, before the ripple filter.
    error_Nm = found["torque_measured_Nm"] - run.truth.torque_Nm
    without = np.arange(len(error_Nm)) >= lost["left_out_from_row"] - 1
    rms_Nm = float(np.sqrt(np.mean(error_Nm[without] ** 2)))
    assert lost["residual_before_Nm"] < 0.1 < 1.0 < rms_Nm <= lost["residual_Nm"] < 5.0
    before_Nm = error_Nm[(run.time_s > 0.2) & (run.time_s < FAULT_S)]
    assert float(np.sqrt(np.mean(before_Nm**2))) < 0.2
    assert (
        float(np.max(np.abs(error_Nm[failed - 1 : lost["left_out_from_row"]])))
        < 0.05 * RATED_TORQUE_NM
    )
    # Plain gains would have read this.
    gains = np.array(read_joint(joint).joint.gains.gains)
    calibration = read_joint(joint).joint.torque_calibration
    plain_Nm = calibration.gain_Nm_per_V * (run.volts @ gains - calibration.zero_V)
    assert float(np.std((plain_Nm - run.truth.torque_Nm)[without])) > 3 * rms_Nm
    # The sentence.
    assert f"gauge {number} is lost ({name}) at {lost['log_time_s']:.10g} s" in ended.err
    assert f"row {lost['row']}: the torque does without it from row" in ended.err
    assert f"{lost['residual_Nm']:.3g} Nm rms" in ended.err
    assert "calibrate again after the repair" in ended.err


def test_the_summary_and_the_page_say_it(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    log = write_run(tmp_path / "run.parquet", run_of(station, "open"))
    page = tmp_path / "page.html"
    ended = call(
        *("filter", log, "--map", MAP, "--angle-side", "motor", "--joint", joint),
        *("--out", tmp_path / "clean.csv", "--report", page),
    )
    assert ended.code == 0, ended.err
    assert f"gauges watched: gauge {LOST} lost (open) at 1.2" in ended.out
    assert f"gauge {LOST} is lost (open)" in page.read_text(encoding="utf-8").lower()


def test_sound_gauges_have_the_torque_of_the_plain_chain(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    log = write_run(tmp_path / "run.parquet", run_of(station, None))
    watched, found = filtered(call, log, joint)
    assert watched.result["gauge_watch"] == {
        "lost": None,
        "rows_suspected": 0,
        "rows_insufficient": 0,
        "rows_disagree": 0,
    }
    assert "gauge" not in watched.err
    joint_file = read_joint(joint)
    gains = joint_file.joint.gains
    put(joint_file, "gains", {"gains": list(gains.gains), "harmonics": [1, 2]})
    bare = tmp_path / "bare.toml"
    write_joint(joint_file, bare)
    plain, same = filtered(call, log, bare)
    assert plain.result["gauge_watch"] is None
    # Codes to volts and back: to the last digits of volts as large as the range.
    assert found["torque_measured_Nm"] == pytest.approx(same["torque_measured_Nm"], abs=1e-11)
    assert np.array_equal(found["status"], same["status"])


def test_sound_gauges_in_use_are_not_suspected(joint: Path, station: Station) -> None:
    """Speeds either way, rests and contacts that the calibration has not seen."""
    generator = np.random.default_rng(5)
    run = station.rotate(
        changing_speed(generator, 120.0, 150.0),
        120.0,
        77,
        contact_torque=changing_load(generator, 120.0, 60.0),
    )
    watch = GaugeWatch(read_joint(joint).joint, 1e-3, True)
    watch.take(columns_part(run, slice(0, len(run.time_s))), run.motor_angle_rad)
    assert watch.result().as_dict() == {
        "lost": None,
        "rows_suspected": 0,
        "rows_insufficient": 0,
        "rows_disagree": 0,
    }


def test_without_the_keys_nothing_is_watched(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    joint_file = read_joint(joint)
    put(joint_file, "gains", {"gains": list(joint_file.joint.gains.gains)})
    bare = tmp_path / "bare.toml"
    write_joint(joint_file, bare)
    ended, found = filtered(
        call, write_run(tmp_path / "run.parquet", run_of(station, "open")), bare
    )
    assert ended.result["gauge_watch"] is None
    assert not np.any(found["status"] & np.uint32(FLAG.gauge_lost | FLAG.gauges_insufficient))
    # The torn gauge is at its rail, and the torque is nonsense without a word: as without a watch.
    assert np.max(np.abs(found["torque_measured_Nm"])) > RATED_TORQUE_NM / 2


@pytest.mark.parametrize("kind", ["open", "stuck", "short"])
def test_where_no_gains_do_without_it_the_torque_is_held(
    tmp_path: Path, call: Call, joint_without_sets: Path, station: Station, kind: str
) -> None:
    run = run_of(station, kind)
    log = write_run(tmp_path / "run.parquet", run)
    ended, found = filtered(call, log, joint_without_sets)
    lost = ended.result["gauge_watch"]["lost"]
    assert (lost["gauge"], lost["goes_on"], lost["residual_Nm"]) == (LOST, False, None)
    insufficient = (found["status"] & FLAG.gauges_insufficient.value) != 0
    first = lost["left_out_from_row"] - 1
    assert np.flatnonzero(insufficient).tolist() == list(range(first, len(run.time_s)))
    assert ended.result["rows_by_flag"]["gauges_insufficient"] == len(run.time_s) - first
    assert ended.result["rows_by_flag"]["torque_not_finite"] == 0
    assert np.all(np.isnan(found["torque_measured_Nm"][first:]))
    assert np.all(found["torque_Nm"][first:] == found["torque_Nm"][first - 1])
    assert "no gains in the joint file do without it" in ended.err
    assert f"{len(run.time_s) - first} row(s) have no torque" in ended.err


def test_rows_that_a_method_holds_back_keep_their_flags(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    log = write_run(tmp_path / "run.parquet", run_of(station, "open"))
    _, at_once = filtered(call, log, joint)
    ended, later = filtered(call, log, joint, "--method", "smoother")
    of_gauges = np.uint32(FLAG.gauge_lost | FLAG.gauge_suspected)
    assert np.array_equal(later["status"] & of_gauges, at_once["status"] & of_gauges)
    assert np.array_equal(later["torque_measured_Nm"], at_once["torque_measured_Nm"])
    assert ended.result["rows_by_flag"]["gauge_lost"] > 1000


def test_codes_and_volts_are_watched_alike(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    run = run_of(station, "stuck")
    _, of_volts = filtered(call, write_run(tmp_path / "volts.parquet", run), joint)
    columns = {"t_s": run.time_s, "beta_rad": run.motor_angle_rad}
    columns |= {f"g{j + 1}_V": np.ascontiguousarray(run.codes[:, j]) for j in range(GAUGES)}
    log = write_parquet(tmp_path / "codes.parquet", columns)
    counts = MAP.replace(f"g{GAUGES}_V", f"g{GAUGES}_V:counts")
    out = tmp_path / "codes_clean.parquet"
    ended = call(
        *("filter", log, "--map", counts, "--angle-side", "motor", "--joint", joint, "--out", out)
    )
    assert ended.code == 0, ended.err
    of_codes = pq.read_table(out)
    for name, values in of_volts.items():
        assert np.array_equal(of_codes[name].to_numpy(), values), name


def columns_part(run: Run, rows: slice) -> Columns:
    return Columns(
        rows.start + 1,
        run.time_s[rows],
        run.time_s[rows],
        run.motor_angle_rad[rows],
        None,
        np.zeros(len(run.time_s[rows])),
        None,
        run.volts[rows],
    )


@settings(max_examples=15, deadline=None)
@given(cuts=st.lists(st.integers(1, 2499), max_size=12), kind=st.sampled_from(["open", "short"]))
def test_how_a_log_is_cut_makes_no_difference(
    joint: Path, station: Station, cuts: list[int], kind: str
) -> None:
    run = run_of(station, kind)
    known = read_joint(joint).joint
    whole = GaugeWatch(known, 1e-3, True)
    expected = whole.take(columns_part(run, slice(0, len(run.time_s))), run.motor_angle_rad)
    parts = GaugeWatch(known, 1e-3, True)
    ends = [0, *sorted(cuts), 1200, 1201, 1205, len(run.time_s)]
    pieces = [slice(a, b) for a, b in zip(sorted(ends), sorted(ends)[1:], strict=False)]
    taken = [parts.take(columns_part(run, each), run.motor_angle_rad[each]) for each in pieces]
    for place in range(2):
        joined = np.concatenate([each[place] for each in taken])
        assert np.array_equal(joined, expected[place], equal_nan=place == 0)
    assert parts.result() == whole.result()
    assert parts.result().lost is not None


def test_a_missing_voltage_is_no_fault(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    run = run_of(station, None)
    columns = {"t_s": run.time_s, "beta_rad": run.motor_angle_rad}
    columns |= {f"g{j + 1}_V": run.volts[:, j].copy() for j in range(GAUGES)}
    columns["g3_V"][700:730] = np.nan
    ended, found = filtered(call, write_parquet(tmp_path / "gaps.parquet", columns), joint)
    assert ended.result["gauge_watch"]["lost"] is None
    assert np.flatnonzero(np.isnan(found["torque_measured_Nm"])).tolist() == list(range(700, 730))


def test_an_angle_from_another_zero_is_said(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    run = run_of(station, None)
    columns = {"t_s": run.time_s, "beta_rad": run.motor_angle_rad + 0.7}
    columns |= {f"g{j + 1}_V": np.ascontiguousarray(run.volts[:, j]) for j in range(GAUGES)}
    log = write_parquet(tmp_path / "shifted.parquet", columns)
    ended, _ = filtered(call, log, joint)
    rows = ended.result["gauge_watch"]["rows_disagree"]
    assert rows > 1000
    assert f"the gauges do not fit each other in {rows} row(s)" in ended.err
    assert ended.result["gauge_watch"]["lost"] is None
    # An angle that is integrated from the speed has no zero: nothing is compared.
    columns["w_rad_s"] = np.gradient(run.motor_angle_rad, run.time_s)
    log = write_parquet(tmp_path / "speed.parquet", columns)
    out = tmp_path / "speed_clean.parquet"
    ended = call(
        *("filter", log, "--map", MAP.replace("angle=beta_rad", "speed=w_rad_s"), "--joint", joint),
        *("--angle-side", "motor", "--out", out, "--json"),
    )
    assert ended.code == 0, ended.err
    assert ended.result["gauge_watch"]["rows_disagree"] == 0


def test_a_gauge_with_a_minus_is_not_watched_and_that_is_said(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    log = write_run(tmp_path / "run.parquet", run_of(station, None))
    ended = call(
        *("filter", log, "--map", MAP.replace("+g2_V", "+-g2_V"), "--angle-side", "motor"),
        *("--joint", joint, "--out", tmp_path / "clean.parquet", "--json"),
    )
    assert ended.code == 0, ended.err
    assert ended.result["gauge_watch"] is None
    assert "gauge 2: mapped with a minus" in ended.err


def test_identify_takes_the_same_rows(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    fault = Fault(FaultKind.OPEN, LOST - 1, 2.0)
    broken = station.with_changes(faults=(fault,))
    log = write_run(tmp_path / "run.parquet", turns_of(broken, 6.0, 4))
    ended = call(
        *("identify", log, "--map", MAP, "--angle-side", "motor", "--joint", joint),
        *("--out", tmp_path / "new.toml", "--json"),
    )
    assert ended.code == 0, ended.err
    assert any(f"gauge {LOST} is lost (open)" in words for words in ended.result["warnings"])


def test_a_joint_whose_watch_cannot_be_is_refused(
    tmp_path: Path, call: Call, joint: Path, station: Station
) -> None:
    log = write_run(tmp_path / "run.parquet", run_of(station, None))
    text = joint.read_text(encoding="utf-8")
    broken = tmp_path / "broken.toml"
    broken.write_text(text.replace("consistency_limit_V = ", "consistency_limit_V = -"))
    ended = call(
        *("filter", log, "--map", MAP, "--angle-side", "motor", "--joint", broken),
        *("--out", tmp_path / "clean.parquet"),
    )
    assert ended.code == 2
    assert "consistency_limit_V" in ended.err
    assert not (tmp_path / "clean.parquet").exists()
