"""Drift of gain and zero over the temperatures of loading experiments.

Positions and mountings move gain and zero of a whole experiment at once, so that an experiment is one
point here. `strainwave.calibrate.thermal` fits single readings, which only drift apart by temperature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy import stats

from strainwave.calibrate.torque import least_squares

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

#: Temperatures that differ by less tell no drift, K.
LEAST_SPAN_K: Final = 2.0


@dataclass(frozen=True)
class TemperatureDrift:
    """Straight lines of gain and zero over temperature.

    Attributes
    ----------
    reference_degC : float
        Mean temperature of the experiments, at which their mean gain and mean zero hold.
    lowest_degC, highest_degC : float
        Range of temperatures.
    gain_per_K : float
        Relative change of the gain, 1/K.
    gain_standard_error_per_K : float
        Its standard error.
    zero_V_per_K : float
        Change of the zero, V/K.
    zero_standard_error_V_per_K : float
        Its standard error.
    gain_is_told, zero_is_told : bool
        Whether it differs from 0 at the level of 5 %.
    """

    reference_degC: float
    lowest_degC: float
    highest_degC: float
    gain_per_K: float
    gain_standard_error_per_K: float
    zero_V_per_K: float
    zero_standard_error_V_per_K: float
    gain_is_told: bool
    zero_is_told: bool


def temperature_drift(
    temperatures_degC: ArrayLike, gains: ArrayLike, zeros_V: ArrayLike
) -> TemperatureDrift | None:
    """Fit gain and zero over temperature, one point for each experiment.

    Parameters
    ----------
    temperatures_degC : array_like
        Temperature of each experiment, shape (experiments,), degrees Celsius.
    gains : array_like
        Gain of each, shape (experiments,).
    zeros_V : array_like
        Zero of each, shape (experiments,), V.

    Returns
    -------
    TemperatureDrift or None
        None for fewer than three experiments, or temperatures within `LEAST_SPAN_K`.
    """
    temperatures = np.asarray(temperatures_degC, np.float64)
    if len(temperatures) < 3 or np.ptp(temperatures) < LEAST_SPAN_K:
        return None
    reference = float(temperatures.mean())
    matrix = np.column_stack([np.ones(len(temperatures)), temperatures - reference])
    gain = least_squares(matrix, np.asarray(gains, np.float64))
    zero = least_squares(matrix, np.asarray(zeros_V, np.float64))
    mean = float(gain.parameters[0])
    student = float(stats.t.ppf(0.975, len(temperatures) - 2))
    told = [bool(abs(fit.parameters[1]) > student * fit.standard_errors[1]) for fit in (gain, zero)]
    return TemperatureDrift(
        reference,
        float(temperatures.min()),
        float(temperatures.max()),
        float(gain.parameters[1]) / mean,
        float(gain.standard_errors[1]) / abs(mean),
        float(zero.parameters[1]),
        float(zero.standard_errors[1]),
        *told,
    )
