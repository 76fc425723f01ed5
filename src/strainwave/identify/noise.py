"""Noise of one torque sample: from rest where there is some, else from the filter's innovations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.samples import Samples

#: The motor rests where it is slower than this over `REST_ROWS` rows.
REST_RAD_S: Final = 0.5
REST_ROWS: Final = 50
LEAST_DIFFERENCES: Final = 100
#: Median of |x| of a standard normal variable, inverted.
FROM_MEDIAN: Final = 1.4826


def rest_noise_Nm(samples: Samples) -> float | None:
    """Estimate the standard deviation of a torque sample at rest, by the median of differences.

    Parameters
    ----------
    samples : Samples
        The recording.

    Returns
    -------
    float or None
        Nm; None where the motor is never at rest for long enough, or nothing changes there.
    """
    known = np.isfinite(samples.motor_angle_rad) & np.isfinite(samples.torque_Nm)
    known &= np.isfinite(samples.time_s)
    angle, torque = samples.motor_angle_rad[known], samples.torque_Nm[known]
    time_s = samples.time_s[known]
    if len(angle) <= REST_ROWS:
        return None
    ends = np.abs(angle[REST_ROWS:] - angle[:-REST_ROWS]) < REST_RAD_S * (
        time_s[REST_ROWS:] - time_s[:-REST_ROWS]
    )
    rest = np.zeros(len(angle), dtype=bool)
    half = REST_ROWS // 2
    rest[half : half + len(ends)] = ends
    steps = np.diff(torque)[rest[1:] & rest[:-1]]
    return _deviation_Nm(steps[steps != 0.0])


def _deviation_Nm(steps_Nm: NDArray[np.float64]) -> float | None:
    if len(steps_Nm) < LEAST_DIFFERENCES:
        return None
    # The difference of two samples has twice the variance of one.
    deviation = FROM_MEDIAN * float(np.median(np.abs(steps_Nm))) / np.sqrt(2.0)
    return float(deviation) if deviation > 0.0 else None


def innovation_noise_Nm(innovation_Nm: NDArray[np.float64]) -> float:
    """Robust standard deviation of innovations, an upper bound of the noise.

    Parameters
    ----------
    innovation_Nm : numpy.ndarray
        Innovations in motion, Nm.

    Returns
    -------
    float
        Nm.
    """
    return FROM_MEDIAN * float(np.median(np.abs(innovation_Nm)))
