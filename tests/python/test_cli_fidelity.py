"""`strainwave fidelity`: what it prints, writes and refuses, and the warning of `strainwave filter`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from helpers.fidelity_joints import GEAR, joint_text, oscillator, ripple, signals
from helpers.log_files import MAP, command, healthy, write_csv
from strainwave import RippleFilterConfig
from strainwave.fidelity.of_joint import subject_of_setting
from strainwave.fidelity.warning import fidelity_warnings
from strainwave.identify.ripple_settings import RippleSettings, Terms
from strainwave.methods.registry import METHOD_NAMES, Setting, build_method
from strainwave.samples import Samples

COMMAND = Path(sys.executable).parent / "strainwave"
Call = Any


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


@pytest.fixture
def joint(tmp_path: Path) -> Path:
    path = tmp_path / "j.toml"
    path.write_text(joint_text(GEAR, signals(1000), ripple(10)), encoding="utf-8")
    return path


def test_json_has_the_keys_of_the_reference(joint: Path, call: Call) -> None:
    ended = call("fidelity", joint, "--json")
    assert (ended.code, ended.err) == (0, "")
    result = ended.result
    assert (result["name"], result["method"]) == ("test", "ripple")
    assert result["verdict"] == "passes true torque"
    assert result["reasons"] == []
    assert result["assumptions"] == []
    assert 0.0 <= result["gain_error_worst"] < 0.02
    assert 0.0 < result["delay_s_worst"] < 0.02
    assert 0.0 <= result["step_error_at_20_ms"] < 0.01
    assert result["limits"] == {"gain_error": 0.05, "delay_s": 1e-3, "step_error_at_20_ms": 0.1}
    assert result["rated_torque_Nm"] == 80.0
    assert result["removed_orders"] == [2.0, 4.0]
    assert [each["motor_speed_rad_s"] for each in result["speeds"]] == [20.0, 50.0, 156.0]
    for speed in result["speeds"]:
        rows = len(speed["frequency_Hz"])
        for key in ("gain", "delay_s", "delay_limit_s", "is_within_notch"):
            assert len(speed[key]) == rows
        assert [each["order"] for each in speed["attenuation"]] == [2.0, 4.0]
        assert all(40 < each["attenuation_dB"] < 120 for each in speed["attenuation"])
    assert result["speeds"][0]["within_notches"]["gain_error_worst"] > 0.0
    assert [each["motor_speed_rad_s"] for each in result["contacts"]] == [20.0, 50.0, 156.0, 0.0]


def test_the_verdict_is_printed_first(joint: Path, call: Call) -> None:
    ended = call("fidelity", joint)
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.splitlines()[0] == f"{joint}: method ripple passes true torque"
    ended = call("fidelity", joint, "--method", "taghirad1999")
    first, *rest = ended.out.splitlines()
    assert first == f"{joint}: method taghirad1999 swallows true torque"
    assert "of a torque of" in rest[0]
    assert any("standstill" in line and "100.00%" in line for line in rest)


@pytest.mark.parametrize(
    ("process_noise", "verdict"), [(1e-6, "passes true torque"), (1e3, "swallows true torque")]
)
def test_the_tuning_is_that_of_the_joint_file(
    tmp_path: Path, call: Call, process_noise: float, verdict: str
) -> None:
    joint = tmp_path / "j.toml"
    joint.write_text(joint_text(oscillator(process_noise)), encoding="utf-8")
    ended = call("fidelity", joint, "--json")
    assert ended.result["method"] == "oscillator"
    assert ended.result["verdict"] == verdict
    assert len(ended.result["assumptions"]) == 1
    shown = call("fidelity", joint)
    assert "a rated torque of 100 Nm and a factor m of 1 are assumed" in shown.err


def test_the_figure_is_written_and_the_same_again(tmp_path: Path, joint: Path, call: Call) -> None:
    out = tmp_path / "f.svg"
    assert call("fidelity", joint, "--method", "low-pass", "--out", out).code == 0
    content = out.read_bytes()
    assert ET.fromstring(content).tag.endswith("svg")
    assert 10_000 < len(content) < 400_000
    assert b"swallows true torque" in content
    assert call("fidelity", joint, "--method", "low-pass", "--out", out, "--json").code == 0
    assert out.read_bytes() == content


@pytest.mark.parametrize(
    ("text", "arguments", "words"),
    [
        (None, (), "j.toml: there is no such file"),
        ("[joint", (), "j.toml"),
        (joint_text(GEAR), (), "there is no section [ripple_filter]"),
        (joint_text(GEAR), ("--method", "riple"), "did you mean ripple?"),
        (joint_text(), ("--method", "taghirad1999"), "needs the ratio of the gear"),
        (joint_text(GEAR), ("--method", "oscillator"), "no section [ripple_filter] with method"),
        (
            joint_text(signals(500), oscillator(1e-6)),
            (),
            "is tuned for sample_period_s = 0.001 s",
        ),
        (joint_text(signals(3), ripple(10)), (), "[gear]"),
        (joint_text(GEAR, signals(3), ripple(10)), (), "expected at least 5 Hz"),
        (joint_text(GEAR, ripple(10)), ("--out", "f.gif"), "expected .svg or .pdf or .png"),
        (
            joint_text(GEAR, ripple(10)),
            ("--out", "no/f.svg"),
            "no/f.svg: it cannot be written (no such file",
        ),
    ],
)
def test_unusable_input_ends_with_2_and_one_sentence(
    tmp_path: Path,
    call: Call,
    monkeypatch: pytest.MonkeyPatch,
    text: str | None,
    arguments: tuple[str, ...],
    words: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    if text is not None:
        Path("j.toml").write_text(text, encoding="utf-8")
    before = sorted(tmp_path.iterdir())
    refused = call("fidelity", "j.toml", *arguments)
    assert (refused.code, refused.out) == (2, "")
    (message,) = refused.err.splitlines()
    assert message.startswith("strainwave: ")
    assert words in message
    assert sorted(tmp_path.iterdir()) == before


def test_the_installed_command_prints_json_alone(joint: Path) -> None:
    ended = subprocess.run(
        [COMMAND, "fidelity", joint, "--json"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONWARNINGS": "error"},
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    assert json.loads(ended.stdout)["verdict"] == "passes true torque"


@pytest.mark.parametrize(
    ("method", "is_warned"),
    [
        ("ripple", False),
        ("smoother", False),
        ("notch", False),
        ("low-pass", True),
        ("taghirad1999", True),
    ],
)
def test_filter_warns_of_a_tuning_that_swallows(
    tmp_path: Path, call: Call, method: str, is_warned: bool
) -> None:
    log = write_csv(tmp_path / "log.csv", healthy())
    told = ("--map", MAP, "--angle-side", "motor", "--ratio", 100, "--rated-torque", 30)
    ended = call("filter", log, *told, "--method", method, "--out", tmp_path / "o.csv", "--json")
    assert ended.code == 0
    sentence = f"method {method} swallows true torque: at 50 rad/s "
    warned = [each for each in ended.result["warnings"] if each.startswith(sentence)]
    assert len(warned) == is_warned
    assert (sentence in ended.err) is is_warned


def test_what_the_filter_chose_is_what_is_measured() -> None:
    rng = np.random.default_rng(5)
    time_s = 1e-3 * np.arange(20_000)
    angle_rad = 50.0 * time_s
    torque = 2.0 * np.cos(2 * angle_rad) + 0.1 * rng.standard_normal(len(time_s))
    excerpt = Samples(time_s, angle_rad, torque, np.zeros(len(time_s)))
    setting = Setting(1e-3, None, 100.0, excerpt=excerpt)
    method: Any = build_method("ripple", setting)
    assert method.settings.is_chosen
    again = Setting(1e-3, None, 100.0, excerpt=excerpt, ripple_settings=method.settings)
    assert subject_of_setting("ripple", again).memory_turns == method.settings.config.memory_turns
    assert fidelity_warnings("ripple", setting, method) == ()


def test_another_method_is_advised_where_there_is_a_better_one() -> None:
    config = RippleFilterConfig(orders=[2, 4], memory_turns=0.1, rated_torque_Nm=100.0)
    settings = RippleSettings(config, Terms(), is_chosen=False)
    setting = Setting(1e-3, None, 100.0, ripple_settings=settings)
    (said,) = fidelity_warnings("ripple", setting, build_method("ripple", setting))
    assert said.endswith("; see `strainwave fidelity`")
    (said,) = fidelity_warnings("low-pass", setting, build_method("low-pass", setting))
    assert said.endswith("; see `strainwave fidelity`, or use method ripple")


@pytest.mark.parametrize("rate_Hz", [1.0, 100.0, 1000.0, 10_000.0, 1e6])
@pytest.mark.parametrize("name", [name for name in METHOD_NAMES if name != "oscillator"])
def test_the_warning_costs_less_than_a_second(name: str, rate_Hz: float) -> None:
    if rate_Hz < {"low-pass": 120.0, "notch": 8.0}.get(name, 0.0):
        pytest.skip("the method refuses so slow a recording")
    setting = Setting(1 / rate_Hz, Fraction(100), 100.0)
    method = build_method(name, setting)
    # The process's own time: others may be at work on this machine.
    started_s = time.process_time()
    warned = fidelity_warnings(name, setting, method)
    assert time.process_time() - started_s < 1.0
    swallows = name.startswith("taghirad1999") or name == "low-pass"
    assert len(warned) == (swallows and rate_Hz >= 5.0)
