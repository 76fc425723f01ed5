"""Torque before and after on one simulated joint, with the torque that must stay.

The oscillator filter with a small tuning and the gear's own orders, at constant speed, while
something touches the joint. What is removed and what is left alone stand in one picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.filter import OscillatorFilter
from strainwave.simulate.commands import SpeedCommand
from strainwave.simulate.driving import constant_speed, step
from strainwave.simulate.presets.taghirad1999 import taghirad1999

if TYPE_CHECKING:
    from numpy.typing import NDArray

CONTACT_NM: Final = 8.0
CONTACT_FROM_S: Final = 5.0
CONTACT_TO_S: Final = 5.6
SPEED_RAD_S: Final = 100.0
DURATION_S: Final = 7.0
#: From here on the filter has learned; about 150 ripple cycles after the run-up.
LEARNED_FROM_S: Final = 4.5


@dataclass(frozen=True)
class Overview:
    """One run before and after.

    Attributes
    ----------
    time_s : numpy.ndarray
        Time stamps, s.
    measured_Nm, clean_Nm, true_Nm : numpy.ndarray
        Torque with ripple, without, and as transmitted without its ripple (from the simulation),
        Nm.
    ripple_dB : float
        Change of the ripple's rms by the filter before the contact, dB.
    contact_error_percent : float
        Distance of the output's mean from the true torque's over the contact's second half, in %
        of the contact.
    """

    time_s: NDArray[np.float64]
    measured_Nm: NDArray[np.float64]
    clean_Nm: NDArray[np.float64]
    true_Nm: NDArray[np.float64]
    ripple_dB: float
    contact_error_percent: float


def overview() -> Overview:
    """Run the joint and the filter.

    Returns
    -------
    Overview
        Torque before and after, attenuation and fidelity.
    """
    station = taghirad1999(misalignment="none")
    run = station.drive(
        SpeedCommand(constant_speed(SPEED_RAD_S), 0.05, 0.4),
        DURATION_S,
        seed=3,
        contact_torque=step(CONTACT_NM, CONTACT_FROM_S, CONTACT_TO_S, rise_s=0.01),
    )
    wave = station.gear.wave_factor
    config = _core.OscillatorFilterConfig(
        orders=[_core.Rational(2) * wave, _core.Rational(4) * wave],
        rotation_source=_core.RotationSource.angle,
    )
    measured = run.raw_torque_Nm
    clean = np.asarray(
        OscillatorFilter(config).process(measured, motor_angle_rad=run.motor_angle_rad).torque_Nm
    )
    true = run.truth.torque_without_ripple_Nm
    learned = (run.time_s >= LEARNED_FROM_S) & (run.time_s < CONTACT_FROM_S)
    touched = (run.time_s >= (CONTACT_FROM_S + CONTACT_TO_S) / 2) & (run.time_s < CONTACT_TO_S)
    before, after = (np.std((torque - true)[learned]) for torque in (measured, clean))
    # Up to the sensor's own gain and hysteresis, which no filter sees: against the measured mean.
    swallowed = np.mean((clean - measured)[touched])
    return Overview(
        time_s=run.time_s,
        measured_Nm=measured,
        clean_Nm=clean,
        true_Nm=true,
        ripple_dB=20 * float(np.log10(after / before)),
        contact_error_percent=100 * float(swallowed) / CONTACT_NM,
    )
