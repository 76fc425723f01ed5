"""Oscillators turned by a tachometer: a Kalman filter on torque and lines, without an encoder.

The phase is the integral of a speed that is a little wrong, so it drifts, and the lines must be
learned again as fast as it drifts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks.accuracy.methods.interface import Method, Removal
from benchmarks.accuracy.methods.speed import interval_s

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting

#: A good tachometer: scale error, offset and white noise (rms) of the motor speed.
SCALE_ERROR: Final = 0.003
OFFSET_RAD_S: Final = 0.05
NOISE_RAD_S: Final = 0.5
NOISE_SEED: Final = 20
#: Adaptation rests below, as at a speed that offset and noise drown.
FROZEN_BELOW_RAD_S: Final = 2.0
#: Growth of the torque's variance per sample over that of the measurement.
TORQUE_WALK: Final = 1.0


def tachometer_rad_s(log: Log) -> np.ndarray:
    """Speed as the tachometer reads it, from the log's angle.

    Parameters
    ----------
    log : Log
        The recording.

    Returns
    -------
    numpy.ndarray
        Speed, shape (samples,), rad/s.
    """
    true_rad_s = np.gradient(log.wave_angle_rad, log.time_s)
    random = np.random.default_rng(NOISE_SEED)
    noise = NOISE_RAD_S * random.standard_normal(len(true_rad_s))
    return (1 + SCALE_ERROR) * true_rad_s + OFFSET_RAD_S + noise


def remove(log: Log, setting: Setting, *, process_over_measurement: float) -> Removal:
    """Track torque and lines, turned by the tachometer.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Orders and noise.
    process_over_measurement : float
        Growth of the lines' variances per sample over the measurement's variance.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    speed = tachometer_rad_s(log)
    phase = np.multiply.outer(np.cumsum(speed * interval_s(log)), setting.orders)
    size = 1 + 2 * len(setting.orders)
    basis = np.concatenate([np.ones((len(speed), 1)), np.cos(phase), np.sin(phase)], axis=1)
    R = setting.torque_noise_Nm**2
    growth = np.full(size, process_over_measurement * R)
    growth[0] = TORQUE_WALK * R
    # Noise of a single sample must not thaw it at rest.
    smoothed = np.convolve(speed, np.full(50, 1 / 50))[: len(speed)]
    moves = np.abs(smoothed) >= FROZEN_BELOW_RAD_S
    state = np.zeros(size)
    P = np.diag([1e6 * R] + [(0.05 * setting.rated_torque_Nm) ** 2] * (size - 1))
    ripple = np.empty(len(speed))
    for n, y in enumerate(log.torque_Nm):
        h = basis[n]
        if moves[n]:
            P.flat[:: size + 1] += growth
        else:
            P[0, 0] += growth[0]
        ripple[n] = h[1:] @ state[1:]
        Ph = P @ h
        s = h @ Ph + R
        gain = Ph / s
        if not moves[n]:
            gain[1:] = 0.0
        state += gain * (y - state[0] - ripple[n])
        P += s * np.outer(gain, gain) - np.outer(gain, Ph) - np.outer(Ph, gain)
    return Removal(log.torque_Nm - ripple, ripple)


TACHO_OSCILLATOR = Method(
    "tacho oscillator",
    remove,
    tuple({"process_over_measurement": 10.0**power} for power in (-3, -2.5, -2, -1.5, -1, 0)),
    f"scale {SCALE_ERROR:.1%} wrong, offset {OFFSET_RAD_S} rad/s, noise {NOISE_RAD_S} rad/s",
)
