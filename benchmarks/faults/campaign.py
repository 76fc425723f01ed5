"""The campaign: every gauge, every kind of fault, at speed and at rest; and hours of sound gauges."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

import strainwave as sw
from benchmarks.faults.station import (
    GAUGES,
    RATE_HZ,
    RATED_TORQUE_NM,
    changing_load,
    changing_speed,
    commissioned_joint,
    five_gauge_station,
)
from strainwave.configuration import sensor_of
from strainwave.sensor import SensorResult
from strainwave.simulate import Fault, FaultKind, PiecewiseLinear, Run, Station, Temperature

#: The simulator's kinds and the sensor's names for them.
KINDS: Final = {
    FaultKind.OPEN: "open",
    FaultKind.SHORT: "shorted",
    FaultKind.STUCK: "stuck",
    FaultKind.SATURATED: "saturated",
    FaultKind.DETACHED: "inconsistent",
}
CONDITIONS: Final = ("speed", "rest")
COMMISSIONING_SEED: Final = 20260
#: Length of a run; a fault at rest has until here before the motor starts.
DURATION_S: Final = 4.0
START_S: Final = 3.0
#: Over which the residual is taken: right after the loss, and once the filter has learned it.
WINDOW_S: Final = 0.5
LARGEST_LOAD_NM: Final = 0.8 * RATED_TORQUE_NM
LARGEST_SPEED_RAD_S: Final = 150.0
HOURS_CHUNK_S: Final = 120.0


@dataclass(frozen=True)
class Case:
    """One fault in one run.

    Parameters
    ----------
    condition : str
        "speed" or "rest".
    kind : FaultKind
        What fails.
    gauge : int
        Which gauge, from 0.
    seed : int
        Seed of motion, load, time of the fault and noise.
    """

    condition: str
    kind: FaultKind
    gauge: int
    seed: int


@lru_cache(maxsize=1)
def commissioned() -> tuple[Station, sw.TorqueSensorConfig]:
    """Return the sound station and its sensor's configuration; once a process.

    Returns
    -------
    tuple of Station and TorqueSensorConfig
        Both.
    """
    station = five_gauge_station()
    return station, sensor_of(commissioned_joint(station, COMMISSIONING_SEED))


def processed(sensor: sw.TorqueSensor, run: Run) -> SensorResult:
    """Run a recording through a sensor.

    Parameters
    ----------
    sensor : TorqueSensor
        The sensor.
    run : Run
        The recording.

    Returns
    -------
    SensorResult
        What it makes of it.
    """
    return sensor.process(
        run.codes,
        motor_angle_rad=run.motor_angle_rad,
        temperature_degC=run.temperature_degC,
        time_s=run.time_s,
    )


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else math.nan


def run_case(case: Case) -> dict[str, Any]:
    """Run one fault.

    Parameters
    ----------
    case : Case
        Which.

    Returns
    -------
    dict
        Whether, when and as what it was found; torque errors in %FS; None where there is none.
    """
    station, config = commissioned()
    generator = np.random.default_rng((case.seed, CONDITIONS.index(case.condition)))
    start_s = float(generator.uniform(1.0, 2.0))
    angle_rad = float(generator.uniform(0, 2 * math.pi))
    size = float(generator.uniform(20.0, LARGEST_SPEED_RAD_S)) * float(generator.choice((-1, 1)))
    if case.condition == "speed":
        speed = PiecewiseLinear((0.0,), (size,))
    else:
        speed = PiecewiseLinear((0.0, START_S, START_S + 0.3), (0.0, 0.0, size))
    load = changing_load(generator, DURATION_S, LARGEST_LOAD_NM)
    if case.condition == "rest":
        load = PiecewiseLinear((0.0,), (float(generator.uniform(-1, 1)) * LARGEST_LOAD_NM,))
    broken = station.with_changes(faults=(Fault(case.kind, case.gauge, start_s),))
    run = broken.rotate(
        speed, DURATION_S, case.seed, contact_torque=load, start_angle_rad=angle_rad
    )
    sensor = sw.TorqueSensor(config)
    result = processed(sensor, run)
    until_s = START_S if case.condition == "rest" else DURATION_S
    lost = (result.status & sw.StatusFlag.gauge_lost.value) != 0
    error = 100 / RATED_TORQUE_NM * (result.torque_measured_Nm - run.truth.torque_Nm)
    clean = 100 / RATED_TORQUE_NM * (result.torque_Nm - run.truth.torque_Nm)
    faulty = run.time_s >= start_s
    first = int(np.argmax(lost)) if lost.any() else None
    found_s = None if first is None else float(run.time_s[first] - start_s)
    in_time = found_s is not None and found_s + start_s < until_s
    left_out = faulty & (result.left_out_gauge == case.gauge + 1)
    before = (run.time_s >= start_s - WINDOW_S) & ~faulty
    values: dict[str, Any] = {
        "false": bool(np.any(lost & ~faulty)),
        "found": in_time,
        "found_at_last": first is not None,
        "right_gauge": first is not None and sensor.lost_gauge == case.gauge + 1,
        "right_name": first is not None and sensor.gauge_fault.name == KINDS[case.kind],
        "time_s": found_s if in_time else None,
        "left_out_s": float(run.time_s[np.argmax(left_out)] - start_s) if left_out.any() else None,
        "invalid": bool(np.any(result.status & sw.StatusFlag.gauges_insufficient.value)),
        "before_percent": _rms(error[before]),
        "clean_before_percent": _rms(clean[before]),
        "until_found_percent": float(
            np.max(np.abs(error[faulty & ~lost & (run.time_s < until_s)]), initial=0.0)
        ),
        "after_percent": None,
        "stated_percent": None,
        "clean_at_last_percent": None,
    }
    if first is not None and in_time:
        after = (run.time_s >= run.time_s[first]) & (run.time_s < run.time_s[first] + WINDOW_S)
        values["after_percent"] = _rms(error[after])
        values["stated_percent"] = 100 / RATED_TORQUE_NM * sensor.residual_fluctuation_Nm
        values["clean_at_last_percent"] = _rms(clean[run.time_s >= DURATION_S - WINDOW_S])
    return values


def all_cases(seeds: int) -> list[Case]:
    """Return every gauge, kind and condition, with so many seeds each.

    Parameters
    ----------
    seeds : int
        How many.

    Returns
    -------
    list of Case
        All of them.
    """
    return [
        Case(condition, kind, gauge, seed)
        for condition in CONDITIONS
        for kind in KINDS
        for gauge in range(GAUGES)
        for seed in range(seeds)
    ]


def run_sound(seed: int) -> dict[str, Any]:
    """Run sound gauges through motion, contacts and 10 K of temperature for a while.

    The flexspline has no hysteresis here, which all gauges see alike and which takes most of the
    time of the simulation.

    Parameters
    ----------
    seed : int
        Seed of everything.

    Returns
    -------
    dict
        Hours, losses, samples with a suspicion.
    """
    station, config = commissioned()
    generator = np.random.default_rng((seed, 99))
    warm = tuple(20.0 + float(each) for each in generator.uniform(-10, 10, 4))
    temperature = Temperature(
        times_s=tuple(np.linspace(0, HOURS_CHUNK_S, 4).tolist()),
        values_degC=warm,
        zero_strain_per_K=station.temperature.zero_strain_per_K,
        gain_per_K=station.temperature.gain_per_K,
    )
    flexspline = replace(station.flexspline, hysteresis_Nm=0.0)
    run = station.with_changes(temperature=temperature, flexspline=flexspline).rotate(
        changing_speed(generator, HOURS_CHUNK_S, LARGEST_SPEED_RAD_S),
        HOURS_CHUNK_S,
        seed,
        contact_torque=changing_load(generator, HOURS_CHUNK_S, RATED_TORQUE_NM),
        start_angle_rad=float(generator.uniform(0, 2 * math.pi)),
    )
    sensor = sw.TorqueSensor(config)
    result = processed(sensor, run)
    flags = sw.StatusFlag
    suspicion = flags.gauge_suspected.value | flags.gauges_disagree.value
    return {
        "hours": len(run.time_s) / RATE_HZ / 3600,
        "rest_hours": float(np.mean(run.truth.motor_speed_rad_s == 0)) * HOURS_CHUNK_S / 3600,
        "losses": int(sensor.lost_gauge != 0),
        "suspected_samples": int(np.count_nonzero(result.status & suspicion)),
    }


def summary_of(cases: Iterable[Case], results: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Put the runs of each condition and kind together.

    Parameters
    ----------
    cases : iterable of Case
        What was run.
    results : iterable of mapping
        What `run_case` said of each.

    Returns
    -------
    list of dict
        A row a condition and kind; times in ms, torques in %FS.
    """
    pairs = list(zip(cases, results, strict=True))
    rows = []
    for condition in CONDITIONS:
        for kind, name in KINDS.items():
            group = [r for c, r in pairs if c.condition == condition and c.kind is kind]
            if not group:
                continue
            found = [r for r in group if r["found"]]
            missed = [r for r in group if not r["found"]]

            def percentile(
                key: str, share: float, among: list[Mapping[str, Any]] = found
            ) -> float | None:
                values = [r[key] for r in among if r[key] is not None]
                return float(np.percentile(values, share)) if values else None

            def ms(seconds: float | None) -> float | None:
                return None if seconds is None else 1000 * seconds

            rows.append(
                {
                    "condition": condition,
                    "fault": name,
                    "runs": len(group),
                    "found": len(found),
                    "found_when_moving_on": sum(r["found_at_last"] for r in group),
                    "wrong_gauge": sum(r["found_at_last"] and not r["right_gauge"] for r in group),
                    "other_name": sum(r["right_gauge"] and not r["right_name"] for r in group),
                    "false": sum(r["false"] for r in group),
                    "invalid": sum(r["invalid"] for r in group),
                    "time_median_ms": ms(percentile("time_s", 50)),
                    "time_95_ms": ms(percentile("time_s", 95)),
                    "time_largest_ms": ms(percentile("time_s", 100)),
                    "left_out_median_ms": ms(percentile("left_out_s", 50, group)),
                    "error_until_found_95": percentile("until_found_percent", 95),
                    "error_not_found_largest": percentile("until_found_percent", 100, missed),
                    "before": percentile("before_percent", 50, group),
                    "after": percentile("after_percent", 50),
                    "after_largest": percentile("after_percent", 100),
                    "stated": percentile("stated_percent", 50),
                    "clean_before": percentile("clean_before_percent", 50, group),
                    "clean_at_last": percentile("clean_at_last_percent", 50),
                }
            )
    return rows


def run_campaign(seeds: int, hours: float, processes: int) -> dict[str, Any]:
    """Run everything.

    Parameters
    ----------
    seeds : int
        Runs of each gauge, kind and condition.
    hours : float
        Of sound gauges.
    processes : int
        How many at a time.

    Returns
    -------
    dict
        Rows of the table, and what sound gauges gave.
    """
    cases = all_cases(seeds)
    chunks = math.ceil(hours * 3600 / HOURS_CHUNK_S)
    with ProcessPoolExecutor(processes) as pool:
        results = list(pool.map(run_case, cases, chunksize=10))
        sound = list(pool.map(run_sound, range(1000, 1000 + chunks), chunksize=5))
    total = {key: sum(each[key] for each in sound) for key in sound[0]} if sound else {}
    _, config = commissioned()
    monitor = config.monitor
    assert monitor is not None
    return {
        "seeds": seeds,
        "gauges": GAUGES,
        "consistency_samples": monitor.consistency_samples,
        "rail_samples": monitor.rail_samples,
        "stuck_samples": monitor.stuck_samples,
        "rows": summary_of(cases, results),
        "sound": total,
        "misses": [
            {"condition": c.condition, "fault": KINDS[c.kind], "gauge": c.gauge + 1, "seed": c.seed}
            for c, r in zip(cases, results, strict=True)
            if not (r["found"] and r["right_gauge"])
        ],
    }
