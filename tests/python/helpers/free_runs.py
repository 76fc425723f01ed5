"""Runs in free motion for tests: from the station of 1999, and from a few lines of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from strainwave.simulate import Misalignment, MisalignmentTerm, PiecewiseLinear, Run, taghirad1999

RATIO = 100.0
GRAVITY_NM = 5.0
MAP = {1: (3.0, 0.6), 2: (0.5, 0.2), 4: (0.2, 1.2)}
"""Amplitude, Nm, and phase of the sine by cycles per output turn."""


def station_run(seed: int, speed: float = 1.0, start_rad: float = 0.0) -> Run:
    """Simulate a load with weight, to and fro by more than an output turn, on the station."""
    station = taghirad1999()
    terms = tuple(MisalignmentTerm(float(n), *MAP[n]) for n in MAP)
    station = replace(
        station,
        load=replace(station.load, gravity_Nm=GRAVITY_NM),
        misalignment=Misalignment(terms),
    )
    speeds = np.array([0, 100, 100, -120, -120, 60, 150, -40, -150, 0]) * speed
    times = (0.0, 1.0, 9.0, 10.5, 17.0, 18.5, 26.0, 27.5, 34.0, 35.0)
    profile = PiecewiseLinear(times, tuple(float(each) for each in speeds))
    return station.rotate(profile, 35.0, seed, start_angle_rad=start_rad)


def station_columns(run: Run) -> dict[str, np.ndarray]:
    """Columns of a recording of it."""
    return {
        "t": run.time_s,
        "q": run.output_angle_rad,
        "q_motor": run.motor_angle_rad,
        "tau": run.raw_torque_Nm,
    }


def phasors(
    angle_rad: np.ndarray, torque_Nm: np.ndarray, cycles: tuple[int, ...] = (1, 2, 4)
) -> np.ndarray:
    """Complex amplitudes over the output's angle by plain least squares."""
    columns = [np.ones(len(angle_rad))]
    for n in cycles:
        columns += [np.cos(n * angle_rad), np.sin(n * angle_rad)]
    solution = np.linalg.lstsq(np.column_stack(columns), torque_Nm, rcond=None)[0][1:]
    return np.asarray(solution[0::2] + 1j * solution[1::2])


def made_up_run(
    seed: int,
    phasors_Nm: Mapping[int, complex],
    *,
    range_rad: float = 14.0,
    duration_s: float = 40.0,
    mounting_rad: float = 0.0,
    gravity_Nm: complex = 0.0,
    noise_Nm: float = 0.05,
    inertia_kg_m2: float = 1.5,
    coulomb_Nm: float = 0.6,
    viscous_Nm_s: float = 0.3,
) -> dict[str, np.ndarray]:
    """Write down the torque of a joint at 500 Hz whose output goes to and fro; ratio 100.

    Amplitudes are complex: real part of the cosine, imaginary part of the sine.
    """
    random = np.random.default_rng(seed)
    t = np.arange(0.0, duration_s, 2e-3)
    w1, w2 = 2 * np.pi / duration_s, 2 * np.pi * 5 / duration_s
    q = range_rad / 2 * (0.85 * np.cos(w1 * t) + 0.15 * np.cos(w2 * t + 1.0))
    speed = -range_rad / 2 * (0.85 * w1 * np.sin(w1 * t) + 0.15 * w2 * np.sin(w2 * t + 1.0))
    pull = -range_rad / 2 * (0.85 * w1**2 * np.cos(w1 * t) + 0.15 * w2**2 * np.cos(w2 * t + 1.0))
    torque = inertia_kg_m2 * pull + coulomb_Nm * np.sign(speed) + viscous_Nm_s * speed + 0.4
    for n, c in phasors_Nm.items():
        torque = torque + c.real * np.cos(n * q) + c.imag * np.sin(n * q)
    felt = q + mounting_rad
    torque = torque + np.real(gravity_Nm) * np.cos(felt) + np.imag(gravity_Nm) * np.sin(felt)
    torque = torque + 1.2 * np.cos(2 * RATIO * q + 0.4) + 0.5 * np.cos(4 * RATIO * q)
    return {"t": t, "q": q, "tau": torque + noise_Nm * random.standard_normal(len(t))}
