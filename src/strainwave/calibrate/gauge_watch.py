"""What is solved beforehand for the loss of a gauge: gains without each, and what sound gauges do.

M - 1 gauges cancel N harmonics like M do, where M - 1 >= 2 N + 1 (Godler et al. 2000, eq. 10). How
far sound gauges are from torque and fluctuation is measured, because a real wave grows and shifts
with the load: a fault is what exceeds it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.arrays import contiguous
from strainwave.calibrate.checks import real_number, require_finite, whole_number
from strainwave.calibrate.fluctuation import enough_gauges
from strainwave.calibrate.gains import compensating_gains
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: By how much limits lie above the largest that sound gauges showed.
MARGIN: Final = 1.5
#: Share of the torque's range below which a sample counts as one without torque.
LITTLE_TORQUE: Final = 0.05


@dataclass(frozen=True)
class GainsWithout:
    """Gains for the loss of one gauge.

    Attributes
    ----------
    gauge : int
        Number of the lost gauge, from 1.
    gains : numpy.ndarray
        Shape (gauges,), 0 for the lost one; t.g = sum(t) of all gauges, as with all of them.
    noise_factor : float
        M' sum(g^2) / (sum g)^2 of the M' gauges that are left.
    residual_fluctuation : float
        Root mean square of the fluctuation that is left, in the unit of the amplitudes.
    warnings : tuple of str
        What to know before these gains are used.
    """

    gauge: int
    gains: NDArray[np.float64]
    noise_factor: float
    residual_fluctuation: float
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class ConsistencyLimits:
    """How far sound gauges are from torque and fluctuation.

    Attributes
    ----------
    limit : float
        Length of what is left beside both without torque, in the unit of the signals.
    share : float
        Growth of that length with the length of the torque's share of the signals.
    """

    limit: float
    share: float


def fluctuation_rms(conditions: ArrayLike, gains: ArrayLike) -> float:
    """Root mean square over the angle of the fluctuation that gains leave.

    Parameters
    ----------
    conditions : array_like
        A from `compensation_conditions`, shape (2 harmonics, gauges).
    gains : array_like
        Shape (gauges,).

    Returns
    -------
    float
        In the unit of the amplitudes.
    """
    left = np.asarray(conditions, dtype=np.float64) @ np.asarray(gains, dtype=np.float64)
    return float(np.sqrt(np.sum(left**2) / 2))


def gains_without_gauges(
    conditions: ArrayLike,
    torque_sensitivities: ArrayLike | None = None,
    *,
    harmonics: int | None = None,
) -> tuple[GainsWithout, ...]:
    """Solve the gains for the loss of each gauge.

    Parameters
    ----------
    conditions : array_like
        A from `compensation_conditions` of all gauges, shape (2 harmonics, gauges).
    torque_sensitivities : array_like, optional
        t_j of all gauges, shape (gauges,); equal without.
    harmonics : int, optional
        How many of the harmonics the remaining gauges have to cancel, the lowest first; all
        without. What they leave of the others is part of the residual.

    Returns
    -------
    tuple of GainsWithout
        For each gauge whose loss the others can make good; empty where M - 1 < 2 N + 1. A gauge
        without which the gains would cancel the torque as well, or be too noisy, is left out.

    Raises
    ------
    InputError
        If conditions or sensitivities do not fit.
    """
    matrix = contiguous("conditions", conditions, np.float64, dimensions=2)
    require_finite("conditions", matrix, "row", "column")
    known, gauges = matrix.shape[0] // 2, matrix.shape[1]
    cancelled = known if harmonics is None else whole_number("harmonics", harmonics)
    if cancelled > known:
        raise InputError(
            f"harmonics = {cancelled}: expected at most the {known} of the conditions; fit the "
            "fluctuation with more harmonics first"
        )
    torque = _sensitivities(torque_sensitivities, gauges)
    if gauges < 2 or not enough_gauges(gauges - 1, cancelled):
        return ()
    found = []
    for lost in range(gauges):
        others = np.delete(np.arange(gauges), lost)
        try:
            solved = compensating_gains(matrix[: 2 * cancelled, others], torque[others])
        except InputError:
            continue
        gains = np.zeros(gauges)
        gains[others] = solved.gains * (
            float(np.sum(torque)) / float(torque[others] @ solved.gains)
        )
        found.append(
            GainsWithout(
                gauge=lost + 1,
                gains=gains,
                noise_factor=solved.noise_factor,
                residual_fluctuation=fluctuation_rms(matrix, gains),
                warnings=solved.warnings,
            )
        )
    return tuple(found)


def signal_directions(torque_sensitivities: ArrayLike) -> NDArray[np.float64]:
    """Direction in which torque moves the gauges, of unit length.

    Parameters
    ----------
    torque_sensitivities : array_like
        t_j, shape (gauges,).

    Returns
    -------
    numpy.ndarray
        Shape (1, gauges): the only direction that says nothing of a fault where the wave is
        predicted from the angle.
    """
    torque = np.asarray(torque_sensitivities, dtype=np.float64)
    return np.asarray(torque / np.linalg.norm(torque))[np.newaxis, :]


def consistency_limits(
    signals: ArrayLike,
    wave_angle_rad: ArrayLike,
    *,
    zeros: ArrayLike,
    conditions: ArrayLike,
    torque_sensitivities: ArrayLike | None = None,
    margin: float = MARGIN,
) -> ConsistencyLimits:
    """Measure how far sound gauges are from torque and fluctuation, over angles and loads.

    Parameters
    ----------
    signals : array_like
        Signals of sound gauges, shape (samples, gauges), with the loads and speeds of use.
    wave_angle_rad : array_like
        m times the motor angle when the gauges were read, shape (samples,), rad.
    zeros : array_like
        Signal of each gauge without torque, the fluctuation taken out, shape (gauges,).
    conditions : array_like
        A from `compensation_conditions`, in the unit of the signals.
    torque_sensitivities : array_like, optional
        t_j, shape (gauges,); equal without.
    margin : float
        Factor on the largest that was seen, at least 1.

    Returns
    -------
    ConsistencyLimits
        Without torque (less than 5 % of the largest), and its growth with the torque: together not
        less than `margin` times any that was seen.

    Raises
    ------
    InputError
        If shapes do not fit, values are not finite, or the margin is below 1.
    """
    signal = contiguous("signals", signals, np.float64, dimensions=2)
    angle = contiguous("wave_angle_rad", wave_angle_rad, np.float64)
    matrix = contiguous("conditions", conditions, np.float64, dimensions=2)
    zero = contiguous("zeros", zeros, np.float64)
    gauges = signal.shape[1]
    if len(angle) != len(signal) or zero.shape != (gauges,) or matrix.shape[1] != gauges:
        raise InputError(
            f"signals has the shape {signal.shape}, wave_angle_rad {angle.shape}, zeros "
            f"{zero.shape} and conditions {matrix.shape}: expected a row an angle and a column a "
            "gauge; give the recording that the fluctuation was fitted for"
        )
    if len(angle) == 0:
        raise InputError("signals has no rows: expected a recording of sound gauges; record one")
    require_finite("signals", signal, "row", "column")
    require_finite("wave_angle_rad", angle, "row")
    factor = real_number("margin", margin)
    if not factor >= 1:
        raise InputError(
            f"margin = {factor:g}: expected at least 1, or sound gauges would be suspected; give a "
            "larger number"
        )
    torque = _sensitivities(torque_sensitivities, gauges)
    direction = signal_directions(torque)[0]
    left = signal - zero
    for i in range(matrix.shape[0] // 2):
        left -= np.outer(np.sin(2 * (i + 1) * angle), matrix[2 * i])
        left -= np.outer(np.cos(2 * (i + 1) * angle), matrix[2 * i + 1])
    along = left @ direction
    length = factor * np.linalg.norm(left - np.outer(along, direction), axis=1)
    size = np.abs(along)
    little = size <= LITTLE_TORQUE * float(np.max(size))
    limit = float(np.max(length[little], initial=float(np.min(length))))
    with np.errstate(divide="ignore", invalid="ignore"):
        growth = np.where(size > 0, (length - limit) / size, 0.0)
    return ConsistencyLimits(limit=limit, share=max(0.0, float(np.max(growth))))


def stuck_samples(
    noise: float, step: float, *, most_per_hour: float, rate_Hz: float, gauges: int
) -> int:
    """Count the samples of one code in a row that noise does not make in so many hours.

    Parameters
    ----------
    noise : float
        Standard deviation of a gauge's noise, above 0.
    step : float
        Step of the converter, in the same unit, above 0.
    most_per_hour : float
        How often all gauges together may show it by chance at rest, above 0.
    rate_Hz : float
        Sampling rate, above 0.
    gauges : int
        How many there are.

    Returns
    -------
    int
        At least 2. With noise of sigma steps a code repeats itself with a probability of at most
        erf(1 / (2 sqrt(2) sigma)), where the signal stands in its middle.

    Raises
    ------
    InputError
        If a value is not above 0.
    """
    values = {"noise": noise, "step": step, "most_per_hour": most_per_hour, "rate_Hz": rate_Hz}
    for name, value in values.items():
        if not real_number(name, value) > 0 or not math.isfinite(value):
            raise InputError(f"{name} = {value}: expected a finite number above 0; give one")
    repeats = math.erf(step / (2 * math.sqrt(2) * noise))
    starts_per_hour = 3600 * rate_Hz * whole_number("gauges", gauges)
    if repeats >= 1:
        return 2**31 - 1
    allowed = min(most_per_hour / starts_per_hour, 0.5)
    return max(2, math.ceil(math.log(allowed) / math.log(repeats)) + 1)


def _sensitivities(values: ArrayLike | None, gauges: int) -> NDArray[np.float64]:
    if values is None:
        return np.ones(gauges)
    torque = contiguous("torque_sensitivities", values, np.float64)
    if torque.shape != (gauges,) or not np.all(np.isfinite(torque)) or not np.all(torque):
        raise InputError(
            f"torque_sensitivities = {torque.tolist()}: expected {gauges} finite numbers other than "
            "0, one a gauge; measure them with a known load"
        )
    return torque
