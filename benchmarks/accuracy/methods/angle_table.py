"""A constant table of ripple against the motor angle, learned offline from the whole log."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks.accuracy.methods.interface import Method, Removal
from benchmarks.accuracy.methods.speed import interval_s, smoothed_speed_rad_s

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from benchmarks.accuracy.methods.interface import Log, Setting

BINS: Final = 256
#: Slower than this a turn takes so long that the joint's load changes within it.
LEARNS_FROM_RAD_S: Final = 20.0


def remove(log: Log, setting: Setting) -> Removal:  # noqa: ARG001 - every method is called alike
    """Subtract the log's own mean ripple by angle; it sees the future, which favours it.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Not used.

    Returns
    -------
    Removal
        Torque and ripple.
    """
    speed = np.abs(smoothed_speed_rad_s(log))
    learns = speed > LEARNS_FROM_RAD_S
    turn_s = 2 * np.pi / np.maximum(speed, LEARNS_FROM_RAD_S)
    half = np.rint(0.5 * turn_s / np.median(interval_s(log))).astype(int)
    fluctuation = log.torque_Nm - _mean_over_a_turn(log.torque_Nm, half)
    share = np.mod(log.wave_angle_rad, 2 * np.pi) / (2 * np.pi)
    bins = np.minimum((BINS * share).astype(int), BINS - 1)
    counts = np.bincount(bins[learns], minlength=BINS)
    sums = np.bincount(bins[learns], weights=fluctuation[learns], minlength=BINS)
    table = np.divide(sums, counts, out=np.zeros(BINS), where=counts > 0)
    table -= table.mean()
    centres = (np.arange(BINS) + 0.5) / BINS
    ripple = np.interp(share, centres, table, period=1.0)
    return Removal(log.torque_Nm - ripple, ripple)


def _mean_over_a_turn(values: NDArray[np.float64], half: NDArray[np.int64]) -> NDArray[np.float64]:
    sums = np.concatenate([[0.0], np.cumsum(values)])
    here = np.arange(len(values))
    # Cut alike on both sides at the ends, so that a slope leaves no offset.
    reach = np.minimum(half, np.minimum(here, len(values) - 1 - here))
    return (sums[here + reach + 1] - sums[here - reach]) / (2 * reach + 1)


ANGLE_TABLE = Method("angle table", remove, remark="learned offline on the log itself")
