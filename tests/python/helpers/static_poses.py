"""Poses at rest for tests: on the station of 1999, and by a few lines of their own."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from helpers.joint_sections import PROVENANCE, gear
from strainwave.joint import TorqueCalibration, new_joint, write_joint
from strainwave.simulate import PiecewiseLinear, taghirad1999

GAIN_NM_PER_V = 6.60
RATED_NM = 40.0
MASS_KG = 2.5
LEVER_M = 0.5
GRAVITY_NM = MASS_KG * LEVER_M * 9.80665
HORIZONTAL_DEG = 20.0
ANGLES_DEG = (-130.0, -75.0, -20.0, 43.0, 101.0, 162.0)


def weight_Nm(angle_deg: np.ndarray) -> np.ndarray:
    """Torque of the load's weight."""
    return np.asarray(GRAVITY_NM * np.cos(np.radians(angle_deg - HORIZONTAL_DEG)))


def station_poses(seed: int, zero_V: float, readings: int = 6) -> dict[str, np.ndarray]:
    """Hold the load in six poses on the simulated station, whose zero is moved by `zero_V`.

    The readings of a pose are spread over half a turn of the motor, 1.8 degrees of the output, so
    that the signal fluctuation of their mean is small.
    """
    station = taghirad1999(misalignment="none")
    columns: dict[str, list[float]] = {"q_deg": [], "u": [], "pose": []}
    for place, angle_deg in enumerate(ANGLES_DEG):
        for reading in range(readings):
            motor_rad = 100.0 * math.radians(angle_deg) + math.pi * reading / readings
            torque = float(weight_Nm(np.array(math.degrees(motor_rad / 100.0))))
            run = station.hold(
                PiecewiseLinear((0.0, 0.1, 0.3), (0.0, torque, torque)),
                0.3,
                seed + 97 * place + 7 * reading,
                position_rad=motor_rad,
            )
            columns["q_deg"].append(math.degrees(motor_rad / 100.0))
            columns["u"].append(float(run.volts[150:].sum(axis=1).mean()) + zero_V)
            columns["pose"].append(place)
    return {name: np.array(values) for name, values in columns.items()}


def made_up_poses(
    seed: int,
    zero_Nm: float = 0.9,
    *,
    angles_deg: tuple[float, ...] = ANGLES_DEG,
    scatter_Nm: float = 0.03,
    readings: int = 1,
    noise_Nm: float = 0.01,
) -> dict[str, np.ndarray]:
    """Write down torques of a sensor that scatters from pose to pose and from reading to reading."""
    random = np.random.default_rng(seed)
    angle = np.repeat(np.array(angles_deg), readings)
    pose = np.repeat(np.arange(len(angles_deg)), readings)
    own = scatter_Nm * random.standard_normal(len(angles_deg))
    torque = weight_Nm(angle) + zero_Nm + own[pose] + noise_Nm * random.standard_normal(len(angle))
    return {"q_deg": angle, "tau": torque, "pose": pose}


def sensor_joint(path: Path, **values: Any) -> Path:
    """Write a joint file with gear and calibration."""
    file = new_joint("station")
    file.set_section("gear", gear(100.0), PROVENANCE)
    section = TorqueCalibration(gain_Nm_per_V=GAIN_NM_PER_V, zero_V=0.05, **values)
    file.set_section("torque_calibration", section, PROVENANCE)
    write_joint(file, path)
    return path
