"""Noise of one torque sample: from rest where there is some, else from the filter's innovations."""

from __future__ import annotations

from dataclasses import dataclass
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
#: Relative standard uncertainty of a deviation from the median of n magnitudes, times the root of
#: n: 1.166 for independent normal values, more for differences, of which each shares a sample with
#: the next.
OF_INDEPENDENT: Final = 1.166
OF_DIFFERENCES: Final = 1.28
#: Stretches whose disagreement counts into the uncertainty.
PARTS: Final = 8


@dataclass(frozen=True)
class Noise:
    """Noise of one torque sample.

    Attributes
    ----------
    noise_Nm : float
        Standard deviation, Nm.
    standard_uncertainty_Nm : float or None
        Of that, Nm; None where nothing was measured.
    source : str
        "rest", "innovations" or "standard".
    """

    noise_Nm: float
    standard_uncertainty_Nm: float | None
    source: str


def rest_noise(samples: Samples) -> Noise | None:
    """Estimate the standard deviation of a torque sample at rest, by the median of differences.

    Parameters
    ----------
    samples : Samples
        The recording.

    Returns
    -------
    Noise or None
        None where the motor is never at rest for long enough, or nothing changes there.
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
    steps = steps[steps != 0.0]
    if len(steps) < LEAST_DIFFERENCES:
        return None
    # The difference of two samples has twice the variance of one.
    return _robust(steps / np.sqrt(2.0), OF_DIFFERENCES, "rest")


def innovation_noise(innovation_Nm: NDArray[np.float64]) -> Noise | None:
    """Take the robust standard deviation of innovations, an upper bound of the noise.

    Parameters
    ----------
    innovation_Nm : numpy.ndarray
        Innovations in motion, Nm.

    Returns
    -------
    Noise or None
        None where there are none, or they are 0.
    """
    if not len(innovation_Nm):
        return None
    return _robust(innovation_Nm, OF_INDEPENDENT, "innovations")


def _robust(values_Nm: NDArray[np.float64], relative: float, source: str) -> Noise | None:
    noise_Nm = FROM_MEDIAN * float(np.median(np.abs(values_Nm)))
    if not noise_Nm > 0.0:
        return None
    count = len(values_Nm)
    deviation_Nm = relative * noise_Nm / np.sqrt(count)
    if count >= PARTS:
        parts = np.array_split(np.abs(values_Nm), PARTS)
        medians = FROM_MEDIAN * np.array([float(np.median(part)) for part in parts])
        deviation_Nm = max(deviation_Nm, float(np.std(medians, ddof=1)) / np.sqrt(PARTS))
    return Noise(noise_Nm, float(deviation_Nm), source)
