"""What a method is built from: options over joint file, and the factor m of the recording."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from helpers.log_files import write_csv
from strainwave.joint import read_joint
from strainwave.methods.interface import Method, nothing
from strainwave.methods.registry import Setting
from strainwave.records import Options, filter_log, parse_mapping
from strainwave.records.method_setting import joint_as_asked, method_name

JOINTS = Path(__file__).parents[1] / "data" / "joints"
MAP = "time=t_s,angle=q_rad,torque=tau_Nm"


def _log(tmp_path: Path, factor: float) -> Path:
    time_s = np.arange(8000) * 1e-3
    angle_rad = 100.0 * time_s
    torque_Nm = 1.6 * np.cos(2 * factor * angle_rad) + 5.0 * np.sin(angle_rad / 100.0)
    path = tmp_path / "log.csv"
    write_csv(path, {"t_s": time_s, "q_rad": angle_rad, "tau_Nm": torque_Nm})
    return path


@pytest.mark.parametrize(("factor", "said"), [(1.0, False), (1.01, True)])
def test_the_recording_decides_where_no_joint_file_does(
    tmp_path: Path, factor: float, said: bool
) -> None:
    options = Options(parse_mapping([MAP]), "motor", Fraction(100), rated_torque_Nm=10.0)
    done = filter_log(_log(tmp_path, factor), tmp_path / "out.csv", options)
    assert done.wave_factor == pytest.approx(factor, rel=1e-12)
    assert done.wave_factor_source == "recording"
    assert any("2.02 cycles per motor turn" in each for each in done.warnings) is said
    # Ripple of 1.13 Nm rms is gone but for the time it took to learn it.
    assert done.ripple_rms_Nm == pytest.approx(1.13, rel=0.03)


def test_without_a_ratio_the_factor_is_assumed(tmp_path: Path) -> None:
    options = Options(parse_mapping([MAP]), "motor", rated_torque_Nm=10.0)
    done = filter_log(_log(tmp_path, 1.0), tmp_path / "out.csv", options)
    assert (done.wave_factor, done.wave_factor_source) == (1.0, "assumed")


def test_the_joint_files_method_is_used_unless_another_is_asked_for() -> None:
    elbow = read_joint(JOINTS / "elbow.toml").joint
    shoulder = read_joint(JOINTS / "shoulder.toml").joint
    assert method_name(None, None) == "ripple"
    assert method_name(None, elbow) == "oscillator"
    assert method_name(None, shoulder) == "ripple"
    assert method_name("low-pass", elbow) == "low-pass"


def test_ratio_and_rated_torque_of_the_options_reach_the_joints_orders(tmp_path: Path) -> None:
    shoulder = read_joint(JOINTS / "shoulder.toml").joint
    assert shoulder.gear is not None
    asked = joint_as_asked(shoulder, Options(ratio=Fraction(120), rated_torque_Nm=55.0))
    assert asked is not None
    assert asked.gear is not None
    assert (asked.gear.ratio, asked.gear.rated_torque_Nm) == (120.0, 55.0)
    assert joint_as_asked(shoulder, Options()) == shoulder
    assert joint_as_asked(None, Options(ratio=Fraction(120))) is None

    seen: list[Setting] = []

    class Nothing:
        def process(self, samples, /):
            raise AssertionError

        def finish(self):
            return nothing()

    def build(name: str, setting: Setting) -> Method:
        assert name == "ripple"
        seen.append(setting)
        return Nothing()

    options = Options(parse_mapping([MAP]), "motor", Fraction(120), rated_torque_Nm=55.0)
    with pytest.raises(AssertionError):
        filter_log(
            _log(tmp_path, 1.0),
            tmp_path / "out.csv",
            options,
            joint_path=JOINTS / "shoulder.toml",
            build=build,
        )
    assert seen[0].ratio == Fraction(120)
    assert seen[0].rated_torque_Nm == 55.0
    assert seen[0].wave_factor == shoulder.gear.model_copy(update={"ratio": 120.0}).exact_factor_m
    assert not (tmp_path / "out.csv").exists()
