"""Temperature of the station and what it does to the sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strainwave.simulate.checks import (
    require_increasing,
    require_length,
    require_number,
)
from strainwave.simulate.trajectories import FloatArray


@dataclass(frozen=True)
class Temperature:
    """A temperature over time, with drift of zero and of gain.

    Parameters
    ----------
    times_s : tuple of float
        Times at which the temperature is known, increasing; straight lines between.
    values_degC : tuple of float
        Temperatures then, -50 to 150 degrees C.  Taghirad & Belanger 1999: 5 to 35.
    reference_degC : float
        Temperature at which zero and gain are as they were adjusted.
    zero_strain_per_K : float or tuple of float
        Apparent shear strain per kelvin, of all gauges or of each.
    gain_per_K : float
        Relative change of the sensitivity per kelvin: gauge factor and shear modulus.
    """

    times_s: tuple[float, ...] = (0.0,)
    values_degC: tuple[float, ...] = (20.0,)
    reference_degC: float = 20.0
    zero_strain_per_K: float | tuple[float, ...] = 0.0
    gain_per_K: float = 0.0

    def __post_init__(self) -> None:
        for time in self.times_s:
            require_number("times_s", time, "s", minimum=0.0)
        require_increasing("times_s", self.times_s, "s")
        require_length("values_degC", self.values_degC, max(len(self.times_s), 1), "one a time")
        for value in (*self.values_degC, self.reference_degC):
            require_number("values_degC", value, "degC", minimum=-50.0, maximum=150.0)
        drifts = self.zero_strain_per_K
        for drift in drifts if isinstance(drifts, tuple) else (drifts,):
            require_number("zero_strain_per_K", drift, "1/K")
        require_number("gain_per_K", self.gain_per_K, "1/K", minimum=-4e-3, maximum=4e-3)

    def value_degC(self, time_s: FloatArray) -> FloatArray:
        """Return the temperature at the given times.

        Parameters
        ----------
        time_s : ndarray, shape (n,)
            Time, s.

        Returns
        -------
        ndarray, shape (n,)
            Temperature, degrees C.
        """
        return np.asarray(np.interp(time_s, self.times_s, self.values_degC), dtype=np.float64)

    def gain(self, temperature_degC: FloatArray) -> FloatArray:
        """Return the sensitivity relative to that at the reference temperature.

        Parameters
        ----------
        temperature_degC : ndarray, shape (n,)
            Temperature, degrees C.

        Returns
        -------
        ndarray, shape (n,)
            Relative sensitivity.
        """
        return 1.0 + self.gain_per_K * (temperature_degC - self.reference_degC)

    def apparent_strain(self, temperature_degC: FloatArray, gauge: int) -> FloatArray:
        """Return the shear strain that one gauge shows because of the temperature.

        Parameters
        ----------
        temperature_degC : ndarray, shape (n,)
            Temperature, degrees C.
        gauge : int
            Index of the gauge from 0.

        Returns
        -------
        ndarray, shape (n,)
            Apparent shear strain.
        """
        drifts = self.zero_strain_per_K
        drift = drifts[gauge] if isinstance(drifts, tuple) else drifts
        return drift * (temperature_degC - self.reference_degC)


def constant_temperature(like: Temperature, value_degC: float) -> Temperature:
    """Return the same drifts at one constant temperature.

    Parameters
    ----------
    like : Temperature
        The drifts.
    value_degC : float
        Temperature, degrees C.

    Returns
    -------
    Temperature
        The temperature.
    """
    return Temperature(
        (0.0,), (value_degC,), like.reference_degC, like.zero_strain_per_K, like.gain_per_K
    )
