"""Torque before and after on one simulated joint, with the torque that must stay.

The oscillator filter with a small tuning and the gear's own orders, at constant speed, while
something touches the joint. What is removed, what is left alone and what comes back while the
filter learns the ripple under load stand in one picture.
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
    """

    time_s: NDArray[np.float64]
    measured_Nm: NDArray[np.float64]
    clean_Nm: NDArray[np.float64]
    true_Nm: NDArray[np.float64]

    @property
    def ripple_dB(self) -> float:
        """Change of the ripple's rms by the filter in the half second before the contact, dB."""
        learned = self._between(LEARNED_FROM_S, CONTACT_FROM_S)
        before, after = (
            np.std((torque - self.true_Nm)[learned]) for torque in (self.measured_Nm, self.clean_Nm)
        )
        return 20 * float(np.log10(after / before))

    @property
    def contact_error_percent(self) -> float:
        """Mean distance of the output from the true torque, contact's second half, in % of it.

        The sensor's own errors are in it: gain, hysteresis, zero.
        """
        touched = self._between((CONTACT_FROM_S + CONTACT_TO_S) / 2, CONTACT_TO_S)
        return 100 * float(np.mean((self.clean_Nm - self.true_Nm)[touched])) / CONTACT_NM

    @property
    def returned_Nm(self) -> float:
        """Largest distance of the output from the true torque during the contact, Nm."""
        touched = self._between(CONTACT_FROM_S, CONTACT_TO_S)
        return float(np.max(np.abs((self.clean_Nm - self.true_Nm)[touched])))

    def _between(self, from_s: float, to_s: float) -> NDArray[np.bool_]:
        return np.asarray((self.time_s >= from_s) & (self.time_s < to_s))


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
    clean = OscillatorFilter(config).process(run.raw_torque_Nm, motor_angle_rad=run.motor_angle_rad)
    return Overview(
        time_s=run.time_s,
        measured_Nm=run.raw_torque_Nm,
        clean_Nm=np.asarray(clean.torque_Nm),
        true_Nm=run.truth.torque_without_ripple_Nm,
    )
