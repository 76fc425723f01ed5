"""Joints to export: made up at random within what the core takes, and programs built from them."""

from __future__ import annotations

import math
import random
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from helpers.joint_sections import PROVENANCE, gauges
from strainwave import StatusFlag, TorqueSensor, _core
from strainwave.configuration import learned_of, sensor_of
from strainwave.joint import (
    Gains,
    GainsWithoutGauge,
    GaugeSignal,
    Gear,
    Joint,
    Misalignment,
    MisalignmentTerm,
    OscillatorFilter,
    RippleFilter,
    Signals,
    TorqueCalibration,
    read_joint,
)

ROOT = Path(__file__).parents[3]
HELPERS = Path(__file__).parent
WRIST = ROOT / "examples" / "joint" / "wrist.toml"
STRICT = ("-Wall", "-Wextra", "-Werror", "-I", ROOT / "include")
FREESTANDING = ("-ffreestanding", "-fno-exceptions", "-fno-rtti")


def wrist() -> Joint:
    return read_joint(WRIST).joint


def random_joint(seed: random.Random) -> Joint:
    """Any number of gauges, either filter, and every optional part present or not."""
    count = seed.randint(1, 6)
    gear = Gear(
        configuration=seed.choice(["fixed_circular_spline", "fixed_flexspline"]),
        ratio=float(seed.randint(30, 320)),
        rated_torque_Nm=10 ** seed.uniform(-1, 3),
        provenance=PROVENANCE,
    )
    calibration = TorqueCalibration(
        gain_Nm_per_V=seed.uniform(0.1, 100),
        zero_V=seed.uniform(-1, 1),
        linearisation=tuple(seed.uniform(-0.01, 0.01) for _ in range(seed.randint(0, 4))),
        provenance=PROVENANCE,
    )
    delay_s = seed.choice([None, seed.uniform(-0.004, 0.04)])
    parts: dict[str, Any] = {
        "joint": {"name": "any"},
        "gear": gear,
        "gauges": gauges(
            count,
            converter_bits=seed.randint(8, 24),
            converter_minimum_V=-10.0,
            converter_maximum_V=seed.uniform(1, 10),
        ),
        "torque_calibration": calibration,
        "signals": Signals(
            sampling_rate_Hz=seed.uniform(500, 20000),
            provenance=PROVENANCE,
            **({} if delay_s is None else {"angle_to_torque_delay_s": delay_s}),
        ),
        "ripple_filter": _ripple(seed) if seed.random() < 0.8 else _oscillator(seed),
    }
    if seed.random() < 0.7:
        parts["gains"] = _gains(seed, count)
    if seed.random() < 0.5:
        parts["misalignment"] = _misalignment(seed)
    return Joint.model_validate(parts)


def _ripple(seed: random.Random) -> RippleFilter:
    orders = tuple(seed.sample(["2m", "4m", "6m", "1/R", 1, 3.5], seed.randint(1, 5)))
    terms = {
        name: tuple(order for order in orders if seed.random() < 0.4)
        for name in ("load_orders", "speed_orders", "direction_orders", "kept_orders")
    }
    pairs = len(orders) + sum(len(terms[name]) for name in list(terms)[:3])
    learned: dict[str, Any] = {}
    if seed.random() < 0.5:
        learned = {
            "learned_coefficients_Nm": tuple(seed.gauss(0, 1) for _ in range(2 * pairs)),
            "learned_standard_deviations_Nm": tuple(seed.uniform(0, 1) for _ in range(2 * pairs)),
        }
    return RippleFilter.model_validate(
        {
            "method": "ripple",
            "orders": orders,
            "memory_turns": seed.uniform(1, 100),
            "torque_noise_Nm": seed.uniform(0.01, 1),
            "torque_walk_Nm_per_sqrt_s": seed.uniform(0.1, 10),
            "provenance": PROVENANCE,
            **terms,
            **learned,
        }
    )


def _oscillator(seed: random.Random) -> OscillatorFilter:
    return OscillatorFilter.model_validate(
        {
            "method": "oscillator",
            "orders": tuple(seed.sample([2, 4, "1/R", "2m"], seed.randint(1, 3))),
            "process_noise_variances_Nm2": (10 ** seed.uniform(-6, 3),),
            "measurement_noise_variance_Nm2": seed.uniform(0.1, 10),
            "initial_variance_Nm2": seed.uniform(0.1, 1000),
            "sample_period_s": seed.uniform(1e-4, 1e-2),
            "rotation_source": seed.choice(["speed", "angle"]),
            "provenance": PROVENANCE,
        }
    )


def _gains(seed: random.Random, count: int) -> Gains:
    harmonics = seed.randint(0, 4)
    more: dict[str, Any] = {}
    if count > 1 and seed.random() < 0.7:
        lost = seed.sample(range(count), seed.randint(1, count))
        more["without_gauge"] = tuple(
            GainsWithoutGauge(
                gauge=j + 1,
                gains=tuple(0.0 if i == j else seed.uniform(0.5, 2) for i in range(count)),
            )
            for j in sorted(lost)
        )
    if count > 1 and seed.random() < 0.7:
        more["gauge_signals"] = tuple(
            GaugeSignal(
                zero_V=seed.uniform(-0.1, 0.1),
                amplitudes_V=tuple(seed.uniform(0.1, 0.5) for _ in range(harmonics)),
                phases_rad=tuple(seed.uniform(-3, 3) for _ in range(harmonics)),
            )
            for _ in range(count)
        )
        if seed.random() < 0.7:
            more |= {"consistency_limit_V": 0.05, "consistency_limit_share": 0.1}
        if seed.random() < 0.5:
            more["noise_V"] = 0.01
    return Gains(
        gains=tuple(seed.uniform(0.5, 2) for _ in range(count)), provenance=PROVENANCE, **more
    )


def _misalignment(seed: random.Random) -> Misalignment:
    cycles = seed.sample(range(1, 9), seed.randint(1, 8))
    return Misalignment(
        zero_of_output_angle_rad=seed.uniform(-3, 3),
        terms=tuple(
            MisalignmentTerm(
                cycles_per_output_turn=n, cosine_Nm=seed.gauss(0, 1), sine_Nm=seed.gauss(0, 1)
            )
            for n in cycles
        ),
        provenance=PROVENANCE,
    )


@dataclass
class Samples:
    """What an interrupt would have seen."""

    codes: np.ndarray
    angle_rad: np.ndarray
    speed_rad_s: np.ndarray
    sequence: np.ndarray
    temperature_degC: np.ndarray

    def as_bytes(self) -> bytes:
        """Rows as the drivers read them."""
        known = np.isfinite(self.angle_rad)
        phases = [
            _core.Phase.from_radians(a if k else 0.0)
            for a, k in zip(self.angle_rad, known, strict=True)
        ]
        rows = np.zeros(
            len(self.codes),
            dtype=[
                ("codes", "<i4", (self.codes.shape[1],)),
                ("turns", "<i8"),
                ("fraction", "<u4"),
                ("known", "<u4"),
                ("sequence", "<u4"),
                ("speed", "<f8"),
                ("temperature", "<f8"),
            ],
        )
        rows["codes"] = self.codes
        rows["turns"] = [phase.turns for phase in phases]
        rows["fraction"] = [phase.fraction for phase in phases]
        rows["known"] = known
        rows["sequence"] = self.sequence
        rows["speed"] = self.speed_rad_s
        rows["temperature"] = self.temperature_degC
        return rows.tobytes()


def samples_of(joint: Joint, rows: int, seed: int = 1) -> Samples:
    """Motion with reversals and rest, load, waves; gaps, repeats, NaN, saturation, torn gauges."""
    random_numbers = np.random.default_rng(seed)
    config = sensor_of(joint)
    gauges_count = len(config.gains.values)
    time_s = np.arange(rows) * config.sample_period_s
    duration_s = time_s[-1]
    speed = 60 * np.sin(2 * math.pi * 1.5 * time_s / duration_s)
    speed[(time_s > 0.45 * duration_s) & (time_s < 0.55 * duration_s)] = 0.0
    angle = np.cumsum(speed) * config.sample_period_s
    load_V = 3 * np.sin(2 * math.pi * 3 * time_s / duration_s) / gauges_count
    volts = np.empty((rows, gauges_count))
    signals = joint.gains.gauge_signals if joint.gains is not None else None
    factor = (
        1.01
        if joint.gear is not None and joint.gear.configuration == "fixed_circular_spline"
        else 1.0
    )
    for j in range(gauges_count):
        wave = np.zeros(rows)
        for i, (amplitude, phase) in enumerate(
            zip(signals[j].amplitudes_V, signals[j].phases_rad, strict=True) if signals else ()
        ):
            wave += amplitude * np.sin(2 * (i + 1) * factor * angle + phase)
        zero_V = signals[j].zero_V if signals else 0.0
        volts[:, j] = load_V + wave + zero_V + random_numbers.normal(0, 1e-3, rows)
    volts[rows // 3 : rows // 3 + 5] = 20.0
    volts[3 * rows // 4 :, 0] = 20.0
    volts[9 * rows // 10 :, 1 % gauges_count] = 20.0
    codes = config.converter.to_code(volts.ravel()).reshape(volts.shape)
    sequence = np.arange(rows, dtype=np.uint32) + np.uint32(2**32 - rows // 2)
    sequence[rows // 4 :] += np.uint32(3)
    sequence[rows // 5] = sequence[rows // 5 - 1]
    angle[rows // 6 : rows // 6 + 4] = np.nan
    temperature = 25 + 2 * np.sin(time_s)
    temperature[rows // 7] = np.nan
    return Samples(np.asarray(codes), angle, speed, sequence, temperature)


def in_python(joint: Joint, samples: Samples, dtype: type) -> dict[str, np.ndarray]:
    """What the package makes of the samples."""
    ripple = isinstance(joint.ripple_filter, RippleFilter)
    sensor = TorqueSensor(sensor_of(joint), learned_of(joint) if ripple else None, dtype=dtype)
    result = sensor.process(
        samples.codes,
        motor_speed_rad_s=samples.speed_rad_s.astype(dtype),
        motor_angle_rad=samples.angle_rad,
        temperature_degC=samples.temperature_degC.astype(dtype),
        sequence=samples.sequence,
    )
    return {
        "measured": result.torque_measured_Nm,
        "torque": result.torque_Nm,
        "ripple": result.ripple_Nm,
        "status": result.status,
        "left_out": result.left_out_gauge,
    }


def run_program(program: Path, samples: Samples) -> dict[str, np.ndarray]:
    """What a program built with a driver makes of them."""
    run = subprocess.run([program], input=samples.as_bytes(), capture_output=True, check=True)
    kinds = [
        ("measured", "<f8"),
        ("torque", "<f8"),
        ("ripple", "<f8"),
        ("status", "<u4"),
        ("left_out", "<u4"),
    ]
    rows = np.frombuffer(run.stdout, dtype=kinds)
    return {name: rows[name] for name, _ in kinds}


def raised(status: np.ndarray) -> set[str]:
    """Names of all flags in a column of status."""
    together = int(np.bitwise_or.reduce(status))
    return {str(flag.name) for flag in StatusFlag if flag & together}


def build_cpp(folder: Path, name: str, *more: object) -> Path:
    """Build the C++ driver with an exported header."""
    program = folder / "cpp_program"
    defines = (f'-DHEADER="{name}.hpp"', f"-DJOINT=strainwave::joints::{name}")
    source = HELPERS / "exported_driver.cpp"
    subprocess.run(
        ["g++", "-std=c++20", "-O1", *STRICT, "-I", folder, *defines, *more, source, "-o", program],
        check=True,
    )
    return program


def build_c(folder: Path) -> Path:
    """Build the C driver with the exported C interface, that freestanding."""
    interface, program = folder / "interface.o", folder / "c_program"
    subprocess.run(
        [
            *("g++", "-std=c++20", "-O1", *STRICT, *FREESTANDING, "-I", folder),
            *("-c", folder / "strainwave_joint.cpp", "-o", interface),
        ],
        check=True,
    )
    subprocess.run(
        [
            *("gcc", "-std=c11", "-O1", *STRICT, "-I", folder, HELPERS / "exported_driver.c"),
            *(interface, "-o", program, "-lm"),
        ],
        check=True,
    )
    return program
