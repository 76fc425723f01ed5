"""Uncertainty budgets of a torque calibration: of its gain, and of a torque read with it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from strainwave.calibrate.uncertainty import Budget, Component, combine

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.loading_series import SeriesErrors
    from strainwave.calibrate.torque import Consistency, SensorGain

#: From the width of a rectangular distribution to its standard deviation.
_RECTANGULAR = math.sqrt(12.0)


def gain_budget(
    gain_Nm_per_V: float,
    scatter: Consistency | None,
    lines: Sequence[SensorGain],
    load_uncertainty: float | None,
) -> Budget:
    """Uncertainty of the mean gain.

    Parameters
    ----------
    gain_Nm_per_V : float
        The gain.
    scatter : Consistency or None
        Scatter over the experiments.
    lines : sequence of SensorGain
        Their lines; a single one has its own standard error alone.
    load_uncertainty : float or None
        Standard uncertainty of the loads, relative; it is common to all experiments.

    Returns
    -------
    Budget
        In Nm/V.
    """
    size = abs(gain_Nm_per_V)
    parts = []
    if scatter is not None:
        parts.append(
            Component(
                "scatter of the gain over the experiments, of their mean",
                size * abs(scatter.standard_uncertainty),
                len(lines) - 1,
                "A",
            )
        )
    elif math.isfinite(lines[0].gain_standard_error_Nm_per_V):
        parts.append(
            Component(
                "residuals of the only experiment",
                lines[0].gain_standard_error_Nm_per_V,
                math.inf,
                "A",
            )
        )
    if load_uncertainty is not None:
        parts.append(Component("loads", size * load_uncertainty, math.inf, "B"))
    return combine(parts)


def torque_budget(
    *,
    gain: float,
    scatter: Consistency | None,
    lines: Sequence[SensorGain],
    zeros_V: NDArray[np.float64],
    full_scale_Nm: float,
    curve_Nm: float,
    errors: SeriesErrors,
    load_uncertainty: float | None,
    resolution_V: float | None,
) -> Budget:
    """Uncertainty of a torque at full scale, read once at a position that was not calibrated.

    Parameters
    ----------
    gain : float
        The gain, Nm/V.
    scatter : Consistency or None
        Scatter over the experiments.
    lines : sequence of SensorGain
        Their lines.
    zeros_V : numpy.ndarray
        Their zeros, V.
    full_scale_Nm : float
        FS, Nm.
    curve_Nm : float
        Largest distance of the mean readings from the curve in use, Nm.
    errors : SeriesErrors
        Hysteresis and repeatability.
    load_uncertainty : float or None
        Standard uncertainty of the loads, relative.
    resolution_V : float or None
        Smallest step of the readings, V.

    Returns
    -------
    Budget
        In %FS. What only has bounds counts as spread evenly between them, GUM 4.3.7.
    """
    count = len(lines)
    to_percent = 100.0 / full_scale_Nm
    parts = []
    if scatter is not None:
        # The scatter at the new position and the uncertainty of the mean are one estimate.
        one_more = math.sqrt(1.0 + 1.0 / count)
        parts.append(
            Component(
                "gain at another position",
                100.0 * abs(scatter.consistency) * one_more,
                count - 1,
                "A",
            )
        )
        zero_Nm = abs(gain) * float(np.std(zeros_V, ddof=1))
        parts.append(
            Component("zero at another position", to_percent * zero_Nm * one_more, count - 1, "A")
        )
    bounds = [
        ("distance from the curve", 2.0 * curve_Nm),
        ("hysteresis", _largest(errors.hysteresis_Nm)),
        ("repeatability", errors.repeatability_Nm),
        ("resolution", math.nan if resolution_V is None else abs(gain) * resolution_V),
    ]
    parts += [
        Component(name, to_percent * width_Nm / _RECTANGULAR, math.inf, "B")
        for name, width_Nm in bounds
        if math.isfinite(width_Nm)
    ]
    if load_uncertainty is not None:
        parts.append(Component("loads", 100.0 * load_uncertainty, math.inf, "B"))
    return combine(parts)


def _largest(values: NDArray[np.float64]) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else math.nan
