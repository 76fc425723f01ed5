"""Gauges on simulated gears: stations of three to five gauges, and their recordings."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from helpers.log_files import write_parquet
from strainwave.simulate.driving import constant_speed
from strainwave.simulate.presets.godler2000 import GAUGE_RADIUS_M, RATED_TORQUE_NM, godler2000
from strainwave.simulate.results import Run
from strainwave.simulate.station import Station
from strainwave.simulate.strain_field import GaugePlacement, WaveHarmonic

TURN_RAD_S = 2 * math.pi


def station_of(gauges: int, seed: int = 5) -> Station:
    """Three or four gauges as in the paper, others bonded as carelessly.

    15 % of amplitude and 10 degrees of phase is what careless gauges scatter by; the gear is that
    of three gauges, with its wave in the sum of all as it is there.
    """
    if gauges in (3, 4):
        return godler2000(gauges)
    random = np.random.default_rng(seed)
    base = godler2000(3)
    harmonics = tuple(
        replace(each, shear_strain=each.shear_strain * gauges / 3)
        for each in base.strain_field.harmonics
    )
    assert all(isinstance(each, WaveHarmonic) for each in harmonics)
    placements = tuple(
        GaugePlacement(
            position_rad=math.pi * j / gauges,
            radius_m=GAUGE_RADIUS_M,
            wave_scale=(*(1 + random.normal(0, [0.06, 0.15])), 1.0),
            wave_phase_error_rad=(*np.deg2rad(random.normal(0, [3.0, 10.0])), 0.0),
        )
        for j in range(gauges)
    )
    return replace(
        base, gauges=placements, strain_field=replace(base.strain_field, harmonics=harmonics)
    )


def turns_of(station: Station, turns: float, seed: int) -> Run:
    """Turn the input shaft at a turn a second, without load."""
    return station.rotate(constant_speed(TURN_RAD_S, 0.0), turns, seed)


def percent_of(station: Station, volts: np.ndarray) -> np.ndarray:
    """A voltage of the sum in %FS."""
    return 100 * volts * station.sensor_gain_Nm_per_V / RATED_TORQUE_NM


def columns_of(run: Run, gains: tuple[float, ...] | None = None) -> dict[str, np.ndarray]:
    """Columns of a recording; with gains their weighted sum as well."""
    volts = run.volts
    columns = {"t_s": run.time_s, "beta_rad": run.motor_angle_rad}
    columns |= {f"g{j + 1}_V": np.ascontiguousarray(volts[:, j]) for j in range(volts.shape[1])}
    if gains is not None:
        columns["sum_V"] = volts @ np.array(gains)
    return columns


def write_run(path: Path, run: Run, gains: tuple[float, ...] | None = None) -> Path:
    """Write them."""
    return write_parquet(path, columns_of(run, gains))


def mapping_of(gauges: int, angle: str = "angle=beta_rad,") -> str:
    """What maps them."""
    return f"{angle}gauges={'+'.join(f'g{j + 1}_V' for j in range(gauges))},time=t_s"
