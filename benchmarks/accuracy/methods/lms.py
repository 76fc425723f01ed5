"""An adaptive sine and cosine canceller (LMS) at the orders, with a weight for the mean."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks.accuracy.methods.interface import Method, Removal
from benchmarks.accuracy.methods.speed import smoothed_speed_rad_s

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting

#: Rate of the mean's weight per sample. Without it the joint's load would shake the others.
MEAN_RATE: Final = 0.05
#: It is spared from learning torque at rest as ripple, as the default filter is.
FROZEN_BELOW_RAD_S: Final = 2.0


def remove(log: Log, setting: Setting, *, rate: float) -> Removal:
    """Cancel what is correlated with the orders' sines and cosines.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Orders.
    rate : float
        Step size per sample, 2 mu.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    angle = np.multiply.outer(log.wave_angle_rad, setting.orders)
    basis = np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    moves = np.abs(smoothed_speed_rad_s(log)) >= FROZEN_BELOW_RAD_S
    rates = np.where(moves, rate, 0.0)
    weights = np.zeros(basis.shape[1])
    ripple = np.empty(len(log.torque_Nm))
    mean = log.torque_Nm[0]
    for n, y in enumerate(log.torque_Nm):
        ripple[n] = basis[n] @ weights
        error = y - mean - ripple[n]
        weights += rates[n] * error * basis[n]
        mean += MEAN_RATE * error
    return Removal(log.torque_Nm - ripple, ripple)


LMS = Method(
    "LMS canceller",
    remove,
    tuple({"rate": 10.0**power} for power in (-4, -3.5, -3, -2.5, -2, -1.5)),
    "frozen below 2 rad/s",
)
