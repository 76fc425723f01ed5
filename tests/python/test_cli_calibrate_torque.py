"""`strainwave calibrate torque`: from a table of loads to a joint file, and bad tables."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.joint_sections import PROVENANCE, gauges, gear
from helpers.load_tables import FULL_SCALE_NM, GAIN, MAP, Truth, experiments, series, table
from helpers.log_files import command, write_csv, write_parquet
from strainwave.errors import InputError
from strainwave.joint import new_joint, read_joint, write_joint
from strainwave.simulate.presets.taghirad1999 import calibration_experiments

Call = Any
FULL_MAP = (MAP, "position=beta_deg:deg")


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _run(call: Call, loads: Path, *more: object, mapping: tuple[str, ...] = FULL_MAP) -> Any:
    maps = [word for text in mapping for word in ("--map", text)]
    return call("calibrate", "torque", loads, *maps, "--out", loads.with_suffix(".toml"), *more)


def test_table_1_of_taghirad_and_belanger(tmp_path: Path, call: Call) -> None:
    columns: dict[str, list[Any]] = {name: [] for name in ("run", "load", "v", "beta", "T")}
    for number, each in enumerate(calibration_experiments(1999), 1):
        rows = [(0.0, 0.0), *zip(each.applied_torque_Nm, each.volts[:, 0], strict=True)]
        for load, volts in rows:
            columns["run"].append(number)
            columns["load"].append(float(load))
            columns["v"].append(float(volts + each.zero_V[0]))
            columns["beta"].append(each.position_rad)
            columns["T"].append(each.temperature_degC)
    loads = write_csv(tmp_path / "table1.csv", columns)
    mapping = ("load=load,voltage=v,experiment=run,position=beta,temperature=T",)
    ended = _run(call, loads, "--rated-torque", 40, "--json", mapping=mapping)
    assert ended.code == 0
    found = ended.result
    # What eight experiments of 2 % support: u = 0.7 %, +-5 %, and 1.3 to 4.1 % for the 2 % itself.
    gain, u = found["gain_Nm_per_V"], found["gain_standard_uncertainty"]
    assert gain == pytest.approx(6.60, abs=2 * u)
    assert u / gain == pytest.approx(0.0071, rel=0.15)
    assert found["consistency"] == pytest.approx(0.02, abs=0.003)
    low, high = found["prediction_interval_95"]
    assert (high - low) / 2 / gain == pytest.approx(0.050, rel=0.15)
    assert found["consistency_interval_95"] == pytest.approx([0.0132, 0.0407], rel=0.15)
    origin = found["through_origin"]
    assert origin["gain_Nm_per_V"] == pytest.approx(6.60, abs=2 * u)
    assert origin["consistency"] == pytest.approx(0.02, abs=0.003)
    assert len(found["experiments"]) == 8
    warned = " ".join(found["warnings"])
    assert "locked at 4 positions, and 5 tell 2 harmonics" in warned
    assert "27 % of harmonic 1" in warned
    assert "the drift of the gain with temperature is not told from none" in warned
    assert "made at 4 positions, and gains scatter by 2.1 % between positions" in warned
    assert "one direction" not in warned
    joint = read_joint(tmp_path / "table1.toml").joint
    assert joint.torque_calibration is not None
    assert joint.torque_calibration.gain_Nm_per_V == gain
    assert joint.torque_calibration.experiment_count == 8
    assert joint.temperature is not None
    assert joint.temperature.gain_drift_per_K == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_one_direction_trap(tmp_path: Path, call: Call, sign: float) -> None:
    # 20 equal steps, zero error 1 %FS, no noise: volts on loads through the origin are off by
    # 3 FS 1 % / (2 20 + 1) of the sensitivity, and loads on volts by this sum.
    load = FULL_SCALE_NM * np.arange(1, 21) / 20
    volts = (load + sign * 0.4) / GAIN
    assert np.sum(load * (GAIN * volts)) / np.sum(load**2) - 1 == pytest.approx(
        sign * 0.01463, abs=1e-5
    )
    off = np.sum(load * volts) / np.sum(volts**2) / GAIN - 1
    loads = write_csv(
        tmp_path / "loads.csv",
        {"run": ["a"] * 20, "load_Nm": load.tolist(), "bridge_V": volts.tolist()},
    )
    ended = _run(call, loads, "--rated-torque", 40, "--json", mapping=(MAP,))
    found = ended.result
    assert found["gain_Nm_per_V"] == pytest.approx(GAIN, rel=1e-12)
    assert found["zero_V"] == pytest.approx(sign * 0.4 / GAIN, rel=1e-9)
    assert found["through_origin"]["gain_Nm_per_V"] == pytest.approx(GAIN * (1 + off), rel=1e-12)
    assert abs(off) == pytest.approx(0.0146, abs=0.0003)
    (warning,) = [text for text in found["warnings"] if "one direction" in text]
    assert f"{100 * off:+.2f} %" in warning
    assert "strainwave: warning" in ended.err
    trapped = call(
        *("calibrate", "torque", loads, "--map", MAP, "--through-origin", "--json"),
        *("--out", tmp_path / "trapped.toml"),
    ).result
    assert trapped["gain_Nm_per_V"] == pytest.approx(GAIN * (1 + off), rel=1e-12)
    assert any("one direction" in text for text in trapped["warnings"])


def test_everything_is_told_and_written(tmp_path: Path, call: Call) -> None:
    truth = Truth(
        gain_scatter=1e-4,
        zero_scatter_V=1e-3,
        hysteresis=0.01,
        cubic=-0.02,
        gain_per_K=5e-4,
        zero_V_per_K=2e-3,
        noise_V=1e-4,
    )
    degrees = [5.0, 20.0, 35.0, 5.0, 20.0, 35.0]
    loads = table(tmp_path / "loads.csv", experiments(truth, 6, 4, temperatures=degrees))
    picture = tmp_path / "loads.svg"
    mapping = (*FULL_MAP, "temperature=T_degC")
    gear = ("--rated-torque", 40, "--ratio", "201/2", "--configuration", "circular-spline-fixed")
    ended = _run(call, loads, *gear, "--figure", picture, "--json", mapping=mapping)
    assert ended.code == 0
    found = ended.result
    assert found["linearisation"]["order"] == 3
    assert found["linearisation"]["coefficients"] == pytest.approx([0.0, -0.02], abs=2e-3)
    assert found["hysteresis_FS"] == pytest.approx(1.0, abs=0.05)
    assert found["gain_Nm_per_V"] == pytest.approx(GAIN, rel=2e-3)
    assert found["zero_V"] == pytest.approx(0.05, abs=2e-3)
    assert found["temperature"]["gain_per_K"] == pytest.approx(5e-4, abs=5e-5)
    assert found["temperature"]["zero_V_per_K"] == pytest.approx(2e-3, abs=2e-4)
    assert found["sections"] == ["gear", "torque_calibration", "temperature"]
    assert found["warnings"] == []
    assert picture.read_text(encoding="utf-8").startswith("<?xml")
    joint = read_joint(tmp_path / "loads.toml").joint
    assert joint.torque_calibration is not None
    assert joint.temperature is not None
    assert joint.gear is not None
    assert joint.gear.ratio == 100.5
    told = found["temperature"]
    assert joint.temperature.zero_drift_standard_uncertainty_V_per_K == pytest.approx(
        told["zero_standard_error_V_per_K"], rel=1e-12
    )
    assert joint.temperature.gain_drift_standard_uncertainty_per_K == pytest.approx(
        told["gain_standard_error_per_K"], rel=1e-12
    )
    written = joint.torque_calibration
    assert list(written.linearisation) == found["linearisation"]["coefficients"]
    assert written.hysteresis_percent_of_rated_torque == found["hysteresis_FS"]
    assert written.linearity_error_percent_of_rated_torque == found["linearity_error_FS"]
    assert written.provenance is not None
    assert "calibrate torque" in str(written.provenance.command)
    assert joint.temperature.zero_drift_V_per_K == found["temperature"]["zero_V_per_K"]
    assert joint.temperature.reference_temperature_degC == pytest.approx(20.0)


def _with_gear(path: Path) -> float:
    """Write a joint file with a comment and [gear]; give its rated torque."""
    joint = new_joint("elbow")
    joint.set_section("gear", gear(), PROVENANCE)
    write_joint(joint, path)
    path.write_text(path.read_text(encoding="utf-8") + "# mine\n", encoding="utf-8")
    return gear().rated_torque_Nm


def test_other_sections_stay_and_the_polynomial_follows_the_gear(
    tmp_path: Path, call: Call
) -> None:
    old = tmp_path / "old.toml"
    rated_Nm = _with_gear(old)
    loads = table(tmp_path / "loads.csv", experiments(Truth(cubic=-0.05), 5))
    ended = call(
        *("calibrate", "torque", loads, "--map", MAP, "--map", "position=beta_deg:deg"),
        *("--joint", old, "--out", old, "--json"),
    )
    assert ended.code == 0
    assert ended.result["full_scale_Nm"] == rated_Nm
    assert ended.result["linearisation"]["is_written"]
    text = old.read_text(encoding="utf-8")
    assert "# mine" in text
    assert "[gear]" in text
    alone = _run(call, loads, "--json").result
    assert not alone["linearisation"]["is_written"]
    assert any("is not written" in warning for warning in alone["warnings"])


def test_people_get_a_table(tmp_path: Path, call: Call) -> None:
    loads = table(tmp_path / "loads.csv", experiments(Truth(gain_scatter=0.02), 5))
    ended = _run(call, loads, "--rated-torque", 40, "--load-uncertainty", 0.1, "--resolution", 1e-4)
    for words in ("consistency", "another position", "hysteresis", "combined", "k = ", "loads"):
        assert words in ended.out


def test_side_loads_are_reported_in_percent_and_per_newton(tmp_path: Path, call: Call) -> None:
    base = experiments(Truth(), 5)
    rng = np.random.default_rng(6)
    axial, moment = rng.uniform(-200, 200, len(base)), rng.uniform(-10, 10, len(base))
    read = base.voltage_V + 1e-4 * axial + 0.003 * moment
    loads = table(
        tmp_path / "loads.csv",
        base.with_voltage(read),
        Fa_kN=(axial / 1e3).tolist(),
        Mt=moment.tolist(),
    )
    mapping = (*FULL_MAP, "axial-force=Fa_kN:kN,tilting-moment=Mt")
    found = _run(call, loads, "--rated-torque", 40, "--json", mapping=mapping).result
    force, tilt = found["crosstalk"]
    assert (force["unit"], tilt["unit"]) == ("Nm/N", "% of the moment")
    assert force["sensitivity"] == pytest.approx(1e-4 * GAIN, rel=1e-6)
    assert tilt["sensitivity"] == pytest.approx(100 * 0.003 * GAIN, rel=1e-6)
    assert found["gain_Nm_per_V"] == pytest.approx(GAIN, rel=1e-9)
    written = read_joint(tmp_path / "loads.toml").joint.torque_calibration
    assert written is not None
    assert written.axial_force_sensitivity_Nm_per_N == force["sensitivity"]
    assert written.tilting_moment_sensitivity == pytest.approx(tilt["sensitivity"] / 100)
    assert written.radial_force_sensitivity_Nm_per_N is None


def test_converter_codes_are_read_by_the_joint_file(tmp_path: Path, call: Call) -> None:
    base = experiments(Truth(gain_scatter=0.01), 5)
    old, out = tmp_path / "old.toml", tmp_path / "new.toml"
    joint = new_joint("elbow")
    converter = {"converter_bits": 16, "converter_minimum_V": -10.0, "converter_maximum_V": 10.0}
    joint.set_section("gauges", gauges(1, **converter), PROVENANCE)
    write_joint(joint, old)
    step_V = 20.0 / 65536
    # Means of codes have fractions.
    codes = ((base.voltage_V + 10.0) / step_V).tolist()
    loads = table(tmp_path / "loads.csv", base, code=codes)
    words = ("calibrate", "torque", loads, "--joint", old, "--out", out, "--json")
    found = call(*words, "--map", "load=load_Nm,voltage=code:counts,experiment=run").result
    volts = _run(call, loads, "--json").result
    assert found["gain_Nm_per_V"] == pytest.approx(volts["gain_Nm_per_V"], rel=2e-4)
    assert found["consistency"] == pytest.approx(volts["consistency"], rel=1e-6)


def test_mountings_are_groups(tmp_path: Path, call: Call) -> None:
    base = experiments(Truth(noise_V=0.001), 6, 2)
    shift = np.array([0.0, 0.0, 0.03, 0.03, -0.02, -0.02])[base.experiment]
    names = np.array(["a", "a", "b", "b", "c", "c"])[base.experiment].tolist()
    moved = base.with_voltage(0.05 + (base.voltage_V - 0.05) * (1 + shift))
    loads = table(tmp_path / "loads.csv", moved, m=names)
    found = _run(call, loads, "--json", mapping=(MAP, "mounting=m")).result
    scatter = found["mountings"]["gain_scatter"]
    assert scatter["groups"] == 3
    assert scatter["between"] == pytest.approx(np.std([0, 0.03, -0.02], ddof=1), rel=0.05)
    assert scatter["within"] < 0.002
    assert found["reproducibility_FS"] > 4.5
    assert found["repeatability_FS"] < 0.2
    assert any("made at 3 mountings" in warning for warning in found["warnings"])


def test_parquet_and_units_say_the_same(tmp_path: Path, call: Call) -> None:
    base = experiments(Truth(gain_scatter=0.02), 5)
    plain = _run(call, table(tmp_path / "a.csv", base), "--json", mapping=(MAP,)).result
    path = write_parquet(
        tmp_path / "b.parquet",
        {
            "run": [f"{index + 1}" for index in base.experiment],
            "L": 1e3 * base.load_Nm,
            "U": 1e3 * base.voltage_V,
        },
    )
    other = _run(call, path, "--json", mapping=("load=L:mNm,voltage=U:mV,experiment=run",)).result
    assert other["gain_Nm_per_V"] == pytest.approx(plain["gain_Nm_per_V"], rel=1e-12)
    assert other["hysteresis_FS"] == pytest.approx(plain["hysteresis_FS"], abs=1e-9)


def test_directions_are_sides_or_senses(tmp_path: Path, call: Call) -> None:
    base = experiments(Truth(hysteresis=0.01), 5)
    rise = ["up"] * 6 + ["down"] * 5
    told = (rise + ["up"] * 5 + ["down"] * 5) * 5
    loads = table(tmp_path / "a.csv", base, how=told)
    sides = _run(call, loads, "--json", mapping=(*FULL_MAP, "direction=how")).result
    assert sides["hysteresis_FS"] == pytest.approx(1.0, rel=0.03)
    sense = np.where(base.load_Nm < 0, "-", "+").tolist()
    magnitudes = np.abs(base.load_Nm).tolist()
    loads = table(tmp_path / "b.csv", base, how=sense, size=magnitudes)
    mapping = ("load=size,voltage=bridge_V,experiment=run,direction=how",)
    senses = _run(call, loads, "--json", mapping=mapping).result
    assert senses["gain_Nm_per_V"] == pytest.approx(sides["gain_Nm_per_V"], rel=1e-12)
    assert senses["hysteresis_FS"] == pytest.approx(sides["hysteresis_FS"], rel=1e-9)


WARNINGS = [
    (lambda: experiments(positions=False), (MAP,), (), "no positions of the wave generator"),
    (lambda: experiments(count=3), FULL_MAP, (), "3 experiments are too few"),
    (lambda: experiments(count=1), FULL_MAP, (), "there is one experiment only"),
    (experiments, FULL_MAP, ("--rated-torque", 100), "40 % of the rated torque"),
    (experiments, FULL_MAP, ("--rated-torque", 0.04), "check its unit"),
    (experiments, FULL_MAP, ("--rated-torque", 20), "2 times the rated torque"),
    (lambda: experiments(loads=series(both=False)), FULL_MAP, (), "only one direction was loaded"),
    (lambda: experiments(loads=[-40.0, 0, 40]), FULL_MAP, (), "hysteresis cannot be told"),
    (lambda: experiments(loads=[0.0, 40, 0]), FULL_MAP, (), "linearity cannot be told"),
    (lambda: experiments(Truth(gain=0.0066)), FULL_MAP, (), "voltage=COLUMN:mV"),
    (experiments, (MAP, "position=beta_deg"), (), "position=COLUMN:deg"),
    (
        lambda: experiments(temperatures=[293.0, 294, 295, 296, 297]),
        (*FULL_MAP, "temperature=T_degC"),
        (),
        "temperature=COLUMN:K",
    ),
    (
        lambda: experiments(temperatures=[20.0, 20, 20, 20, 20]),
        (*FULL_MAP, "temperature=T_degC"),
        (),
        "drift with temperature cannot be told",
    ),
]


@pytest.mark.parametrize(("make", "mapping", "options", "words"), WARNINGS)
def test_warnings(tmp_path: Path, call: Call, make, mapping, options, words: str) -> None:
    loads = table(tmp_path / "loads.csv", make())
    ended = _run(call, loads, *options, "--json", mapping=mapping)
    assert ended.code == 0
    assert any(words in warning for warning in ended.result["warnings"])


def test_two_readings_have_a_gain_and_no_uncertainty(tmp_path: Path, call: Call) -> None:
    loads = table(tmp_path / "loads.csv", experiments(count=1, loads=[0.0, 40.0]))
    found = _run(call, loads, "--json").result
    assert found["gain_Nm_per_V"] == pytest.approx(GAIN, rel=1e-9)
    for key in ("gain_standard_uncertainty", "consistency", "prediction_interval_95"):
        assert found[key] is None
    out = tmp_path / "other.toml"
    ended = call("calibrate", "torque", loads, "--map", MAP, "--out", out)
    assert "standard uncertainty not told" in ended.out
    assert "uncertainty_Nm_per_V" not in out.read_text(encoding="utf-8")


def test_a_large_zero_is_no_reason_to_refuse(tmp_path: Path, call: Call) -> None:
    # The line through the origin beside ours has no gain, or one of the other sign.
    for name, zero_V in (("a", 40.0 / GAIN), ("b", 30.0 / GAIN)):
        base = experiments(Truth(zero_V=zero_V), 3, loads=[0.0, -40.0, 0.0])
        found = _run(call, table(tmp_path / f"{name}.csv", base), "--json").result
        assert found["gain_Nm_per_V"] == pytest.approx(GAIN, rel=1e-9)
        assert found["zero_V"] == pytest.approx(zero_V, rel=1e-9)
        assert any("only one direction" in warning for warning in found["warnings"])


def test_one_load_has_a_line_through_the_origin(tmp_path: Path, call: Call) -> None:
    loads = table(tmp_path / "loads.csv", experiments(Truth(zero_V=0.0), 3, loads=[40.0, 40.0]))
    found = _run(call, loads, "--through-origin", "--json").result
    assert found["gain_Nm_per_V"] == pytest.approx(GAIN, rel=1e-9)
    written = read_joint(tmp_path / "loads.toml").joint.torque_calibration
    assert written is not None
    assert (written.lowest_torque_Nm, written.highest_torque_Nm) == (0.0, 40.0)


def test_outliers_are_named_by_row_and_experiment(tmp_path: Path, call: Call) -> None:
    base = experiments(Truth(gain_scatter=0.001, noise_V=0.002), 8, 1)
    read = base.voltage_V.copy()
    read[30] += 0.4
    read[base.experiment == 6] *= 1.2
    loads = table(tmp_path / "loads.csv", base.with_voltage(read))
    warned = " ".join(_run(call, loads, "--json").result["warnings"])
    assert "row 31 stands out" in warned
    assert "the gain of experiment 7" in warned


def _columns(**changed: Any) -> dict[str, Any]:
    columns: dict[str, Any] = {
        "run": ["a", "a", "a", "b", "b", "b"],
        "load_Nm": [0.0, 10.0, 20.0] * 2,
        "bridge_V": [0.0, 1.0, 2.0] * 2,
        "beta_deg": [0.0] * 3 + [90.0] * 3,
    }
    return {**columns, **changed}


BAD_TABLES = [
    ({"load_Nm": [0.0, 10, None] * 2}, FULL_MAP, "row 3, column 'load_Nm' for load is empty"),
    ({"load_Nm": [0.0, "ten", 20] * 2}, FULL_MAP, "load_Nm"),
    ({"load_Nm": [0.0] * 6}, FULL_MAP, "for load is 0 in all rows"),
    ({"load_Nm": [0.0, 10, 20, 5, 5, 5]}, FULL_MAP, "experiment b: all of its 3 loads are 5 Nm"),
    ({"bridge_V": [0.0, 1, "nan"] * 2}, FULL_MAP, "row 3, column 'bridge_V' for voltage is empty"),
    ({"bridge_V": [1.0] * 6}, FULL_MAP, "experiment a: volts has the same value"),
    ({"bridge_V": [0.0, 1, 2, 0, -1, -2]}, FULL_MAP, "expected gains of one sign"),
    ({"run": ["a", None, "a", "b", "b", "b"]}, FULL_MAP, "row 2, column 'run' for experiment"),
    ({"beta_deg": [0.0, 1, 30, 90, 90, 90]}, FULL_MAP, "experiment a has positions from 0 to 30"),
    ({"beta_deg": [0.0, None] * 3}, FULL_MAP, "row 2, column 'beta_deg' for position is empty"),
    ({"T": [20.0, None] * 3}, (MAP, "temperature=T"), "row 2, column 'T' for temperature"),
    ({"d": ["up", "sideways"] * 3}, (MAP, "direction=d"), "'sideways'; expected one of up"),
    ({"d": ["left", "up"] * 3}, (MAP, "direction=d"), "row 1, column 'd' for direction is 'left'"),
    (
        {"d": ["+", "+", "-"] * 2, "load_Nm": [0.0, -10, 20] * 2},
        (MAP, "direction=d"),
        "row 2 has the load -10 Nm and the direction '+'",
    ),
    ({"m": ["1", "2"] * 3}, (MAP, "mounting=m"), "experiment a has the mountings 1 and 2"),
    ({"p": ["preload"] * 6}, (MAP, "phase=p"), "none of its 6 rows is a measurement"),
    ({"F": [5.0] * 6}, (MAP, "axial-force=F"), "axial-force changes with the torque"),
    ({"F": [1.0, None] * 3}, (MAP, "axial-force=F"), "row 2, column 'F' for axial-force"),
    ({}, ("load=load_Nm,voltage=bridge_V",), "nothing is mapped for experiment"),
    ({}, (), "no sheet of `strainwave calibrate plan`"),
    ({}, ("load=load_Nm:V",), "the unit 'V' of load is unknown"),
    ({}, ("lode=load_Nm",), "did you mean load?"),
    ({}, (MAP, "position=where"), "there is no column 'where' for position"),
    ({}, ("load=load_Nm,voltage=bridge_V:counts,experiment=run",), "voltage is in counts"),
]


@pytest.mark.parametrize(("changed", "mapping", "words"), BAD_TABLES)
def test_bad_tables(tmp_path: Path, call: Call, changed, mapping, words: str) -> None:
    loads = write_csv(tmp_path / "loads.csv", _columns(**changed))
    ended = _run(call, loads, mapping=mapping)
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert not (tmp_path / "loads.toml").exists()


BAD_OPTIONS = [
    (("--rated-torque", 0), "--rated-torque 0: expected 1e-06 to 1e+07 Nm"),
    (("--rated-torque", "nan"), "--rated-torque = nan: expected a number"),
    (("--harmonics", 2.5), "--harmonics 2.5: expected a whole number"),
    (("--harmonics", 0), "--harmonics = 0: expected a whole number of at least 1"),
    (("--harmonics", 101), "--harmonics 101: expected at most 100"),
    (("--load-uncertainty", -1), "--load-uncertainty -1: expected 0 to 100 %"),
    (("--resolution", -1), "--resolution -1: expected 0 to 1000 V"),
    (("--ratio", 100), "--ratio is given without --configuration"),
    (("--configuration", "flexspline-fixed"), "--configuration is given without --ratio"),
    (
        ("--ratio", 100, "--configuration", "flexspline-fixed"),
        "without --rated-torque; expected all three",
    ),
    (
        ("--ratio", 0.5, "--configuration", "flexspline-fixed"),
        "--ratio 0.5: expected motor turns per output turn",
    ),
    (("--configuration", "both-fixed"), "both-fixed"),
    (("--joint", "missing.toml"), "missing.toml"),
    (("--figure", "figure.gif"), "expected .svg or .pdf or .png"),
    (("--figure", "nowhere/figure.svg"), "expected an existing folder"),
]


@pytest.mark.parametrize(("options", "words"), BAD_OPTIONS)
def test_bad_options(tmp_path: Path, call: Call, options, words: str) -> None:
    loads = write_csv(tmp_path / "loads.csv", _columns())
    ended = _run(call, loads, *options)
    assert ended.code == 2
    assert words in ended.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["loads.csv"]


def test_a_figure_that_fails_leaves_no_joint_file(
    tmp_path: Path, call: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_given: object) -> None:
        raise InputError("no room for the figure")

    monkeypatch.setattr("strainwave.report.figure_file.write_figure", fail)
    loads = write_csv(tmp_path / "loads.csv", _columns())
    ended = _run(call, loads, "--figure", tmp_path / "f.svg")
    assert (ended.code, ended.err) == (2, "strainwave: no room for the figure")
    assert [path.name for path in tmp_path.iterdir()] == ["loads.csv"]


def test_files_that_are_there_are_kept(tmp_path: Path, call: Call) -> None:
    loads = write_csv(tmp_path / "loads.csv", _columns())
    there = tmp_path / "there.toml"
    there.write_text("mine", encoding="utf-8")
    ended = call("calibrate", "torque", loads, "--map", MAP, "--out", there)
    assert (ended.code, there.read_text(encoding="utf-8")) == (2, "mine")
    assert "there is a file already" in ended.err
    assert call("calibrate", "torque", loads, "--map", MAP, "--out", tmp_path / "a.csv").code == 2
    assert call("calibrate", "torque", tmp_path / "no.csv", "--out", tmp_path / "b.toml").code == 2
    gone = call("calibrate", "torque", loads, "--map", MAP, "--out", tmp_path / "no" / "b.toml")
    assert gone.code == 2
    old = tmp_path / "old.toml"
    _with_gear(old)
    words = ("calibrate", "torque", loads, "--map", MAP, "--joint", old, "--out", old)
    assert "expected one full scale" in call(*words, "--rated-torque", 3).err
    assert (
        "has a section [gear] already"
        in call(*words, "--ratio", 100, "--configuration", "flexspline-fixed").err
    )
