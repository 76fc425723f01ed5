"""The recording that every implementation is given: reversals, standstill, changing load, noise."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAMPLE_PERIOD_S: Final = 1e-3
#: Motor turns per output turn: the published filter's third order is one over it.
RATIO: Final = 100
LARGEST_SPEED_RAD_S: Final = 150.0
#: Amplitudes of ripple, Nm, and phases, rad, by order.
RIPPLE: Final = ((2.0, 3.0, 0.4), (4.0, 1.2, -1.1), (1.0 / RATIO, 0.8, 2.0))
NOISE_NM: Final = 0.05
FILES: Final = ("torque_Nm", "motor_speed_rad_s", "motor_angle_rad")


@dataclass(frozen=True)
class Recording:
    """One joint's signals, one sample a millisecond.

    Attributes
    ----------
    torque_Nm, motor_speed_rad_s, motor_angle_rad : numpy.ndarray
        Measured torque, speed from each sample to the next, angle since the start, shape
        (samples,).
    """

    torque_Nm: Array
    motor_speed_rad_s: Array
    motor_angle_rad: Array

    @property
    def samples(self) -> int:
        """How many there are."""
        return len(self.torque_Nm)

    @property
    def time_s(self) -> Array:
        """Time of each sample."""
        return SAMPLE_PERIOD_S * np.arange(self.samples, dtype=np.float64)

    def write(self, folder: Path) -> None:
        """Write the signals as files of doubles, as the programs in C++ and Rust read them.

        Parameters
        ----------
        folder : Path
            Made if it is missing.
        """
        folder.mkdir(parents=True, exist_ok=True)
        for name in FILES:
            (folder / f"{name}.f64").write_bytes(getattr(self, name).astype("<f8").tobytes())


def read(folder: Path) -> Recording:
    """Read what `Recording.write` wrote.

    Parameters
    ----------
    folder : Path
        Where.

    Returns
    -------
    Recording
        The same signals.
    """
    return Recording(*(np.fromfile(folder / f"{name}.f64", dtype="<f8") for name in FILES))


def _half_of_speed(count: int, generator: np.random.Generator) -> Array:
    # Ramps of 0.1 to 0.5 s between speeds of either sign that are held; every fourth one is rest.
    times: list[float] = [0.0]
    speeds: list[float] = [0.0]
    while times[-1] < count:
        target = generator.uniform(-LARGEST_SPEED_RAD_S, LARGEST_SPEED_RAD_S)
        if generator.uniform() < 0.25:
            target = 0.0
        ramp, hold = generator.uniform(100, 500), generator.uniform(100, 800)
        times += [times[-1] + ramp, times[-1] + ramp + (100 if target == 0.0 else hold)]
        speeds += [target, target]
    return np.interp(np.arange(count), times, speeds)


def make(samples: int, seed: int) -> Recording:
    """Make a recording that ends at the angle where it began, so that it can be repeated.

    Parameters
    ----------
    samples : int
        An even number.
    seed : int
        Of motion, load and noise.

    Returns
    -------
    Recording
        Of a joint with ripple at the published orders that grows with the load.
    """
    generator = np.random.default_rng(seed)
    half = _half_of_speed(samples // 2, generator)
    speed = np.concatenate([half, -half[::-1]])
    angle = np.concatenate([[0.0], SAMPLE_PERIOD_S * np.cumsum(speed)[:-1]])
    time = SAMPLE_PERIOD_S * np.arange(samples)
    load = 6.0 * np.sin(2 * np.pi * 0.31 * time) + 3.0 * np.sin(2 * np.pi * 1.7 * time + 1.0)
    ripple = sum(size * np.cos(order * angle + phase) for order, size, phase in RIPPLE)
    noise = NOISE_NM * generator.standard_normal(samples)
    torque = load + ripple * (1.0 + 0.01 * np.abs(load)) + noise
    return Recording(torque, speed, angle)
