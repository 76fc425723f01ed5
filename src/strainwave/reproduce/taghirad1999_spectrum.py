"""Taghirad & Belanger 1999, fig. 8: power spectrum of the torque where the speed is almost flat."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy import signal

from strainwave.reproduce import published
from strainwave.reproduce.taghirad1999_motion import SAMPLE_PERIOD_S

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.reproduce.taghirad1999_motion import Experiment

#: Lines of the spectrum below this are the motion itself, rad/s.
LOWEST_RIPPLE_RAD_S: Final = 100.0


@dataclass(frozen=True)
class Spectrum:
    """Power spectrum of the measured torque between 0.8 and 1.1 s.

    Attributes
    ----------
    frequency_rad_s : numpy.ndarray
        Frequency, rad/s.
    power_Nm2 : numpy.ndarray
        Power, Nm^2.
    peaks_rad_s : tuple of float
        The two largest peaks above the motion itself, in rising order, rad/s.
    speed_rad_s : float
        Mean speed in that interval, rad/s.
    """

    frequency_rad_s: NDArray[np.float64]
    power_Nm2: NDArray[np.float64]
    peaks_rad_s: tuple[float, float]
    speed_rad_s: float


def spectrum(measured: Experiment) -> Spectrum:
    """Power spectrum where the speed is almost flat, 0.8 to 1.1 s, and its two largest peaks.

    Parameters
    ----------
    measured : Experiment
        The run-up.

    Returns
    -------
    Spectrum
        Spectrum of the measured torque.
    """
    inside = (measured.time_s >= published.SPECTRUM_START_S) & (
        measured.time_s < published.SPECTRUM_END_S
    )
    frequency_Hz, power = signal.periodogram(
        measured.measured_Nm[inside],
        fs=1 / SAMPLE_PERIOD_S,
        window="hann",
        nfft=8192,
        detrend="linear",
        scaling="spectrum",
    )
    frequency = 2 * np.pi * frequency_Hz
    tops, _ = signal.find_peaks(np.where(frequency > LOWEST_RIPPLE_RAD_S, power, 0.0))
    first, second = sorted(float(frequency[top]) for top in tops[np.argsort(power[tops])[-2:]])
    return Spectrum(frequency, power, (first, second), float(measured.speed_rad_s[inside].mean()))
