"""What the packages are given as matrices: Phi of every sample, C, Q, R and P(0)."""

from __future__ import annotations

from typing import Final

import numpy as np

from benchmarks.speed.inputs import RATIO, SAMPLE_PERIOD_S, Array

ORDERS: Final = (2.0, 4.0, 1.0 / RATIO)
ROW: Final[Array] = np.array([[1.0, 0.0, 1.0, 0.0, 1.0, 0.0]])
Q: Final[Array] = 1e3 * np.eye(6)
R: Final[Array] = np.eye(1)
P0: Final[Array] = 1e3 * np.eye(6)


def turning(motor_speed_rad_s: Array) -> Array:
    """Build Phi for every sample at once.

    Parameters
    ----------
    motor_speed_rad_s : numpy.ndarray
        Speeds, shape (samples,).

    Returns
    -------
    numpy.ndarray
        Shape (samples, 6, 6).
    """
    matrices = np.zeros((len(motor_speed_rad_s), 6, 6))
    for a, order in enumerate(ORDERS):
        angle = order * SAMPLE_PERIOD_S * motor_speed_rad_s
        c, s = np.cos(angle), np.sin(angle)
        matrices[:, 2 * a, 2 * a] = matrices[:, 2 * a + 1, 2 * a + 1] = c
        matrices[:, 2 * a, 2 * a + 1] = s
        matrices[:, 2 * a + 1, 2 * a] = -s
    return matrices
