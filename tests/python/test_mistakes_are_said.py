"""Mistakes that a first user of the calibration commands made, and what is said of each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.log_files import command, write_csv

Call = Any
CERTIFICATE = '<script type="application/json" id="strainwave-certificate">{}</script>'


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _run(folder: Path) -> Path:
    time_s = np.arange(3000) * 0.01
    angle_rad = 2 * np.pi * time_s / 10
    torque_Nm = 5 * np.cos(angle_rad) + 1.2 * np.sin(angle_rad) + 0.3 * np.cos(2 * angle_rad)
    noise_Nm = np.random.default_rng(1).normal(0.0, 0.01, 3000)
    columns = {"t_s": time_s, "q_rad": angle_rad, "tau_Nm": torque_Nm + noise_Nm}
    return write_csv(folder / "free.csv", columns)


@pytest.mark.parametrize("degrees", ["0", "360", "-720"])
def test_a_housing_that_is_not_turned_tells_no_gravity(
    tmp_path: Path, call: Call, degrees: str
) -> None:
    log, out = _run(tmp_path), tmp_path / "joint.toml"
    ended = call(
        *("calibrate", "misalignment", log, "--map", "time=t_s,angle=q_rad,torque=tau_Nm"),
        *("--angle-side", "output", "--ratio", 100, "--turned-run", log, "--turned-deg", degrees),
        *("--out", out),
    )
    assert ended.code == 2
    assert "every run has the housing where the first one has it" in ended.err
    assert not out.exists()


def test_an_issued_certificate_is_never_written_over(tmp_path: Path, call: Call) -> None:
    page = tmp_path / "certificate.html"
    page.write_text(CERTIFICATE, encoding="utf-8")
    ended = call(
        *("filter", _run(tmp_path), "--map", "time=t_s,angle=q_rad,torque=tau_Nm"),
        *("--angle-side", "output", "--ratio", 100, "--out", tmp_path / "o.csv", "--report", page),
    )
    assert ended.code == 2
    assert "issued certificate" in ended.err
    assert page.read_text(encoding="utf-8") == CERTIFICATE
    plan = ("calibrate", "plan", "--rated-torque", 40, "--harmonics", 1)
    sheet = tmp_path / "sheet.csv"
    assert call(*plan, "--out", sheet, "--printable", page).code == 2
    page.write_text("a sheet", encoding="utf-8")
    ended = call(*plan, "--out", sheet, "--printable", page)
    assert ended.code == 2
    assert "there is a file already" in ended.err
    assert not sheet.exists()


def test_kelvin_for_degrees_is_asked_about(tmp_path: Path, call: Call) -> None:
    temperature = np.linspace(10.0, 45.0, 40)
    columns = {"T": temperature, "V": 0.01 + 1e-4 * (temperature - 20.0)}
    log = write_csv(tmp_path / "warm.csv", columns)
    ended = call(
        *("calibrate", "thermal", log, "--map", "temperature=T:K,voltage=V"),
        *("--out", tmp_path / "joint.toml"),
    )
    assert "check their unit, such as temperature=COLUMN:K" in ended.err


def test_a_session_template_is_toml(tmp_path: Path, call: Call) -> None:
    ended = call("certify", "--template", tmp_path / "session.txt")
    assert ended.code == 2
    assert ".toml" in ended.err
    assert call("certify", "--template", tmp_path / "no" / "session.toml").code == 2
    assert call("certify", "--template", tmp_path / "session.toml").code == 0
