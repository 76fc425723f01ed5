"""Speed of the wave from its angle, as the methods need it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import lfilter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from benchmarks.accuracy.methods.interface import Log


def interval_s(log: Log) -> NDArray[np.float64]:
    """Time since the sample before; the first sample is given the median.

    Parameters
    ----------
    log : Log
        The recording.

    Returns
    -------
    numpy.ndarray
        Intervals, shape (samples,), s.
    """
    steps = np.diff(log.time_s)
    return np.concatenate([[np.median(steps)], steps])


def difference_speed_rad_s(log: Log) -> NDArray[np.float64]:
    """Angle since the sample before over the time it took: rotates exactly by the encoder.

    Parameters
    ----------
    log : Log
        The recording.

    Returns
    -------
    numpy.ndarray
        Speed, shape (samples,), rad/s.
    """
    return np.diff(log.wave_angle_rad, prepend=log.wave_angle_rad[0]) / interval_s(log)


def smoothed_speed_rad_s(log: Log, time_constant_s: float = 0.05) -> NDArray[np.float64]:
    """Difference speed through a first-order low-pass.

    Parameters
    ----------
    log : Log
        The recording.
    time_constant_s : float
        Of the low-pass.

    Returns
    -------
    numpy.ndarray
        Speed, shape (samples,), rad/s.
    """
    keep = np.exp(-float(np.median(interval_s(log))) / time_constant_s)
    return np.asarray(lfilter([1 - keep], [1, -keep], difference_speed_rad_s(log)))
