"""`strainwave calibrate thermal`: a table or a log in, `[temperature]` out."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.log_files import command, write_csv, write_parquet
from helpers.static_poses import sensor_joint
from strainwave.configuration import calibration_of
from strainwave.joint import read_joint

Call = Any
MAP = ("--map", "temperature=T,voltage=u,load=L")


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _readings(seed: int = 1) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    load = np.tile([0.0, 20.0, 40.0, -20.0], 9)
    temperature = np.repeat(np.linspace(5.0, 35.0, 9), 4)
    warmer = temperature - 20.0
    voltage = 0.05 + 3e-4 * warmer + load / (6.6 * (1 - 2e-4 * warmer))
    return {
        "T": temperature,
        "T_F": 32 + 1.8 * temperature,
        "L": load,
        "u": voltage + 1e-5 * random.standard_normal(36),
    }


def test_zero_and_gain(tmp_path: Path, call: Call) -> None:
    readings = _readings()
    table = write_csv(tmp_path / "chamber.csv", readings)
    joint = sensor_joint(tmp_path / "joint.toml")
    ended = call("calibrate", "thermal", table, *MAP, "--joint", joint, "--out", joint, "--json")
    assert ended.code == 0
    assert ended.err == ""
    result = ended.result
    section = read_joint(joint).joint.temperature
    assert section is not None
    assert section.reference_temperature_degC == 20.0
    assert section.zero_drift_V_per_K == result["zero_drift_V_per_K"]
    assert section.zero_drift_V_per_K == pytest.approx(3e-4, rel=0.01)
    assert section.gain_drift_per_K == pytest.approx(-2e-4, rel=0.01)
    assert (section.lowest_temperature_degC, section.highest_temperature_degC) == (5.0, 35.0)
    assert result["zero_drift_FS_per_K"] == pytest.approx(100 * 3e-4 * 6.6 / 40, rel=0.01)
    provenance = section.provenance
    assert provenance is not None
    assert provenance.input_sha256 == hashlib.sha256(table.read_bytes()).hexdigest()
    assert str(provenance.command).startswith("strainwave calibrate thermal ")
    torque = calibration_of(read_joint(joint).joint).torque_Nm(readings["u"], readings["T"])
    np.testing.assert_allclose(torque, readings["L"], atol=3e-4)


def test_units_and_text(tmp_path: Path, call: Call) -> None:
    table = write_csv(tmp_path / "chamber.csv", _readings())
    out = tmp_path / "j.toml"
    mapping = ("--map", "temperature=T_F:degF,voltage=u,load=L")
    ended = call("calibrate", "thermal", table, *mapping, "--out", out)
    assert ended.code == 0
    assert "drift of the gain -200" in ended.out
    assert "5 to 35 degC, reference 20 degC" in ended.out


def test_without_load_only_the_zero_is_known(tmp_path: Path, call: Call) -> None:
    time = np.arange(0.0, 7200.0, 4.0)
    felt = 25 + 4 * np.sin(2 * np.pi * (time - 200.0) / 7200)
    random = np.random.default_rng(2)
    log = write_parquet(
        tmp_path / "log.parquet",
        {
            "t": time,
            "T": 25 + 4 * np.sin(2 * np.pi * time / 7200),
            "u": 0.05 + 3e-4 * (felt - 25) + 1e-5 * random.standard_normal(len(time)),
        },
    )
    joint = sensor_joint(tmp_path / "joint.toml")
    base = ("calibrate", "thermal", log, "--joint", joint, "--json")
    mapped = ("--map", "temperature=T,voltage=u,time=t")
    ended = call(*base, *mapped, "--out", joint)
    assert ended.code == 0
    assert (ended.result["gain_drift_per_K"], ended.result["gain_drift_source"]) == (0.0, "none")
    assert ended.result["lag_s"] == pytest.approx(200, abs=10)
    for words in (
        "varies by 8 K only",
        "only the drift of the zero is known",
        "no load is mapped",
        "the gauges follow the thermometer by 2",
    ):
        assert words in ended.err
    assert "reference temperature" not in ended.err
    untold = call(*base, "--map", "temperature=T,voltage=u", "--out", tmp_path / "b.toml")
    assert "warming and cooling differ by" in untold.err
    far = call(*base, *mapped, "--reference-temperature", 60, "--out", tmp_path / "c.toml")
    assert far.code == 0
    assert "60 degC lies outside of what was seen" in far.err
    section = read_joint(joint).joint.temperature
    assert section is not None
    assert section.reference_temperature_degC == pytest.approx(25.0, abs=0.01)


def test_a_known_drift_of_the_gain_stays(tmp_path: Path, call: Call) -> None:
    readings = _readings()
    table = write_csv(tmp_path / "a.csv", readings)
    joint = sensor_joint(tmp_path / "joint.toml")
    call("calibrate", "thermal", table, *MAP, "--joint", joint, "--out", joint)
    known = read_joint(joint).joint.temperature
    assert known is not None
    unloaded = {name: values[::4] for name, values in readings.items()}
    again = write_csv(tmp_path / "b.csv", unloaded)
    ended = call("calibrate", "thermal", again, *MAP, "--joint", joint, "--out", joint, "--json")
    assert ended.result["gain_drift_source"] == "joint file"
    assert ended.result["gain_drift_per_K"] == known.gain_drift_per_K
    assert "that of the joint file is kept" in ended.err


@pytest.mark.parametrize(
    ("columns", "options", "words"),
    [
        ({}, ("--map", "temperature=T"), "nothing is mapped for voltage"),
        ({}, ("--map", "temperature=T,voltage=w"), "w"),
        ({}, (*MAP, "--reference-temperature", 2000), "--reference-temperature 2000: expected"),
        ({"T": np.full(36, 20.0)}, MAP, "a.csv: the temperature varies by 0 K"),
        ({"u": [None] * 36}, MAP, "for voltage is empty"),
        ({}, ("--map", "temperature=T,voltage=u:counts"), "nothing says what a count is"),
        ({}, ("--map", "temperature=T:V,voltage=u"), "the unit 'V' of temperature is unknown"),
    ],
)
def test_what_is_refused(
    tmp_path: Path, call: Call, columns: dict[str, Any], options: tuple[Any, ...], words: str
) -> None:
    table = write_csv(tmp_path / "a.csv", {**_readings(), **columns})
    out = tmp_path / "out.toml"
    ended = call("calibrate", "thermal", table, *options, "--out", out)
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert not out.exists()
