"""Loading experiments for tests, from formulas: scatter, hysteresis, curvature and drift put in."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from helpers.log_files import write_csv
from strainwave.calibrate.loadings import Loadings, paths

MAP = "load=load_Nm,voltage=bridge_V,experiment=run"
FULL_SCALE_NM = 40.0
GAIN = 6.6


@dataclass(frozen=True)
class Truth:
    """What is put into the experiments; all relative to full scale or to the gain."""

    gain: float = GAIN
    zero_V: float = 0.05
    gain_scatter: float = 0.0
    zero_scatter_V: float = 0.0
    hysteresis: float = 0.0
    noise_V: float = 0.0
    cubic: float = 0.0
    gain_per_K: float = 0.0
    zero_V_per_K: float = 0.0


def series(steps: int = 5, *, both: bool = True) -> list[float]:
    """Loads of one experiment: up and down, in one direction or both; they begin and end at 0."""
    rise = [FULL_SCALE_NM * k / steps for k in range(steps + 1)]
    one = rise + rise[-2::-1]
    return one + [-load for load in one[1:]] if both else one


def volts(
    load: np.ndarray, path: np.ndarray, truth: Truth, gain: float, zero_V: float
) -> np.ndarray:
    """Readings: torque = u + FS cubic (u / FS)^3, inverted; a loop that closes at full scale."""
    x = load / FULL_SCALE_NM
    want = x - path * truth.hysteresis / 2 * np.sqrt(1 - x**2)
    u = want.copy()
    for _ in range(50):
        u = want - truth.cubic * u**3
    return zero_V + FULL_SCALE_NM * u / gain


def experiments(
    truth: Truth = Truth(),
    count: int = 5,
    seed: int = 0,
    *,
    loads: Sequence[float] | None = None,
    temperatures: Sequence[float] | None = None,
    positions: bool = True,
) -> Loadings:
    """Experiments at equally spread positions."""
    rng = np.random.default_rng(seed)
    one = np.array(series() if loads is None else loads)
    path = paths(one)
    found = []
    for index in range(count):
        kelvin = 0.0 if temperatures is None else temperatures[index] - 20.0
        gain = truth.gain * (1 + truth.gain_scatter * rng.normal() + truth.gain_per_K * kelvin)
        zero_V = truth.zero_V + truth.zero_scatter_V * rng.normal() + truth.zero_V_per_K * kelvin
        read = volts(one, path, truth, gain, zero_V)
        found.append(read + truth.noise_V * rng.normal(size=len(read)))
    return Loadings(
        tuple(str(index + 1) for index in range(count)),
        np.repeat(np.arange(count), len(one)),
        np.tile(one, count),
        np.concatenate(found),
        np.tile(path, count),
        math.pi * np.arange(count) / count if positions else None,
        None if temperatures is None else np.array(temperatures, float),
    )


def table(path: Path, loadings: Loadings, **more: Sequence[object]) -> Path:
    """Write experiments as a table for `MAP`, with positions in degrees where they are told."""
    columns: dict[str, Sequence[object]] = {
        "run": [loadings.names[index] for index in loadings.experiment],
        "load_Nm": loadings.load_Nm.tolist(),
        "bridge_V": loadings.voltage_V.tolist(),
    }
    if loadings.position_rad is not None:
        columns["beta_deg"] = np.degrees(loadings.position_rad)[loadings.experiment].tolist()
    if loadings.temperature_degC is not None:
        columns["T_degC"] = loadings.temperature_degC[loadings.experiment].tolist()
    return write_csv(path, {**columns, **more})
