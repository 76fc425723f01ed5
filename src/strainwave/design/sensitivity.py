"""What one misplaced gauge does to the torque signal and to the ripple, error by error.

The three placement errors of Taghirad & Belanger 1999, section III, and the two of manufacture.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.design.placement import GaugeErrors, gauge_signals

if TYPE_CHECKING:
    from strainwave.design.case import LayoutCase

#: Errors of which there is a row, with the unit that is put in; see `Sensitivity`.
_ROWS: Final = (
    ("radial", "0.1 mm"),
    ("circumferential", "0.1 mm"),
    ("circumferential", "1 deg"),
    ("angular", "1 deg"),
    ("gauge factor", "1 %"),
    ("amplitude", "1 %"),
)
#: Steps by which the derivative is taken: so small that sensitivities are those of small errors.
_SMALL: Final = 1e-5


@dataclass(frozen=True)
class Sensitivity:
    """What an error of one gauge changes.

    Attributes
    ----------
    error : str
        "radial", "circumferential", "angular", "gauge factor", "amplitude".
    per : str
        Unit of the error.
    gauge_torque_percent : float
        Change of the gauge's own torque signal, %.
    sum_torque_percent : float
        Change of the torque signal of the sum of all gauges, %.
    ripple_FS : tuple of float
        What it adds to each harmonic of the sum with equal gains, %FS zero to peak, per unit: the
        slope at a small error.
    """

    error: str
    per: str
    gauge_torque_percent: float
    sum_torque_percent: float
    ripple_FS: tuple[float, ...]


def sensitivities(case: LayoutCase) -> tuple[Sensitivity, ...]:
    """Sensitivities of a layout to an error of one of its gauges.

    Parameters
    ----------
    case : LayoutCase
        Gauges, radius and wave; its tolerances play no part.

    Returns
    -------
    tuple of Sensitivity
        Radial, circumferential, angular; gauge factor and amplitude beside them. An angular error
        changes the torque signal in second order alone: that column is the change at the unit
        itself.
    """
    return tuple(_sensitivity(case, error, per) for error, per in _ROWS)


def _sensitivity(case: LayoutCase, error: str, per: str) -> Sensitivity:
    amount, unit = float(per.split(maxsplit=1)[0]), per.split()[1]
    size = {"mm": amount / case.radius_mm, "deg": np.deg2rad(amount), "%": amount / 100}[unit]
    ripple, _, _ = _change(case, error, size * _SMALL)
    # Torque at the unit itself: the angular error's change is of second order.
    _, own, total = _change(case, error, size)
    return Sensitivity(error, per, own, total, tuple(float(each) / _SMALL for each in ripple))


def _change(case: LayoutCase, error: str, size: float) -> tuple[np.ndarray, float, float]:
    errors = GaugeErrors.none(1, len(case.wave.amplitudes_FS), case.gauges)
    ideal_torque, ideal = gauge_signals(case.wave, errors)
    array = {
        "radial": errors.radius,
        "circumferential": errors.position_rad,
        "angular": errors.orientation_rad,
        "gauge factor": errors.gauge_factor,
        "amplitude": errors.amplitude,
    }[error]
    array[..., 0] = size
    torque, phasors = gauge_signals(case.wave, errors)
    before = ideal.sum(axis=2)[0] / ideal_torque.sum()
    after = phasors.sum(axis=2)[0] / torque.sum()
    own = float(torque[0, 0] / ideal_torque[0, 0] - 1)
    total = float(torque.sum() / ideal_torque.sum() - 1)
    return np.abs(after - before), 100 * own, 100 * total
