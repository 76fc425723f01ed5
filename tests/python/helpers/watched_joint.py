"""A joint file of five gauges, commissioned from simulated runs with the commands alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from helpers.gauge_logs import columns_of, mapping_of
from helpers.log_files import write_parquet
from strainwave.joint import JointFile, build_section, new_joint, read_joint, write_joint
from strainwave.joint.provenance import Provenance
from strainwave.simulate.driving import constant_speed
from strainwave.simulate.presets.godler2000 import RATED_TORQUE_NM
from strainwave.simulate.station import Station
from strainwave.simulate.trajectories import PiecewiseLinear

LOADS_NM = (-60.0, -20.0, 0.0, 20.0, 60.0)
SPEED_RAD_S = 20.0


def constant(torque_Nm: float) -> PiecewiseLinear:
    """A torque that stays."""
    return PiecewiseLinear((0.0,), (torque_Nm,))


def put(joint_file: JointFile, name: str, values: dict[str, Any]) -> None:
    """Fill a section."""
    section = build_section(name, values, "a test")
    joint_file.set_section(name, section, Provenance.of_simulation("station of five gauges"))


def described_joint(path: Path, station: Station) -> Path:
    """Gear, gauges and converter, as they are known before anything is calibrated."""
    converter = station.bridge.converter
    joint_file = new_joint("elbow")
    put(
        joint_file,
        "gear",
        {
            "ratio": 51.0,
            "configuration": "fixed_flexspline",
            "rated_torque_Nm": RATED_TORQUE_NM,
        },
    )
    put(
        joint_file,
        "gauges",
        {
            "wiring": "half_bridge_each",
            "bridge_supply_V": station.bridge.supply_V,
            "amplifier_gain": float(station.bridge.amplifier.gain),
            "converter_bits": converter.bits,
            "converter_minimum_V": converter.minimum_V,
            "converter_maximum_V": converter.maximum_V,
            "converter_lowest_code": converter.lowest_code,
            "torn_gauge_rail": "upper",
            "rosettes": [
                {"position_rad": each.position_rad, "gauge_factor": each.gauge_factor}
                for each in station.gauges
            ],
        },
    )
    write_joint(joint_file, path)
    return path


def write_loads(path: Path, station: Station, loads_Nm: Sequence[float] = LOADS_NM) -> Path:
    """Write turns under loads that are held, one after the other, in one table."""
    parts = []
    for place, load_Nm in enumerate(loads_Nm):
        run = station.rotate(
            constant_speed(SPEED_RAD_S, 0.0), 1.0, 70 + place, contact_torque=constant(load_Nm)
        )
        columns = columns_of(run)
        columns["t_s"] = columns["t_s"] + 1.5 * place
        parts.append(columns | {"load_Nm": np.full(len(run.time_s), load_Nm)})
    return write_parquet(path, {key: np.concatenate([p[key] for p in parts]) for key in parts[0]})


def fluctuation_call(log: Path, joint: Path, gauges: int, harmonics: int) -> tuple[object, ...]:
    """What calibrates the fluctuation under the loads of a table."""
    return (
        *("calibrate", "fluctuation", log, "--map", f"{mapping_of(gauges)},load=load_Nm"),
        *("--harmonics", harmonics, "--joint", joint, "--out", joint, "--json"),
    )


def put_calibration(path: Path, station: Station) -> None:
    """Gain and zero of the sum, from two loads held at many angles."""
    joint_file = read_joint(path)
    section = joint_file.joint.gains
    assert section is not None
    gains = np.array(section.gains)
    places = np.linspace(0.0, math.pi, 12, endpoint=False)
    read_V = [
        float(np.mean(station.hold(constant(load), 0.2, 50, position_rad=at).volts @ gains))
        for load in (0.0, 60.0)
        for at in places
    ]
    zero_V, loaded_V = np.mean(np.reshape(read_V, (2, -1)), axis=1)
    put(
        joint_file,
        "torque_calibration",
        {"gain_Nm_per_V": 60.0 / (loaded_V - zero_V), "zero_V": float(zero_V)},
    )
    write_joint(joint_file, path)
