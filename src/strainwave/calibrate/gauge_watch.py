"""What the watch over the gauges has to know of sound ones: limits, noise, what gains leave.

How far sound gauges are from torque and fluctuation is measured, because a real wave grows and
shifts with the load: a fault is what exceeds it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.arrays import contiguous
from strainwave.calibrate.checks import real_number, require_finite, whole_number
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: By how much limits lie above the largest that sound gauges showed.
MARGIN: Final = 1.5
#: Steps of the converter below which noise does not show in the codes as it is.
LEAST_NOISE_STEPS: Final = 0.25
#: Share of the torque's range below which a sample counts as one without torque.
LITTLE_TORQUE: Final = 0.05


@dataclass(frozen=True)
class ConsistencyLimits:
    """How far sound gauges are from torque and fluctuation.

    Attributes
    ----------
    limit : float
        Length of what is left beside both without torque, in the unit of the signals.
    share : float or None
        Growth of that length with the length of the torque's share of the signals; None where the
        torque did not change.
    """

    limit: float
    share: float | None


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
    is_loaded: bool = True,
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
    is_loaded : bool
        False where the torque hardly changes: there is one limit, and its growth is not known.

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
    if not is_loaded:
        return ConsistencyLimits(limit=float(np.max(length)), share=None)
    size = np.abs(along)
    little = size <= LITTLE_TORQUE * float(np.max(size))
    limit = float(np.max(length[little], initial=float(np.min(length))))
    with np.errstate(divide="ignore", invalid="ignore"):
        growth = np.where(size > 0, (length - limit) / size, 0.0)
    return ConsistencyLimits(limit=limit, share=max(0.0, float(np.max(growth))))


def white_noise(signals: ArrayLike, *, step: float | None = None) -> NDArray[np.float64]:
    """Estimate the noise of gauges from third differences, which a slower signal does not reach.

    Parameters
    ----------
    signals : array_like
        Consecutive samples, shape (samples, gauges); what is known to change, taken out.
    step : float, optional
        Step of the converter, in the same unit; its rounding is taken off.

    Returns
    -------
    numpy.ndarray
        Standard deviation of each gauge, shape (gauges,); NaN where there are fewer than 4 samples,
        or where the noise is less than a quarter of a step and the codes do not show it.

    Raises
    ------
    InputError
        If the shape does not fit or a value is not finite.
    """
    signal = contiguous("signals", signals, np.float64, dimensions=2)
    require_finite("signals", signal, "row", "column")
    if len(signal) < 4:
        return np.full(signal.shape[1], np.nan)
    # Binomial weights 1, 3, 3, 1 of white noise: their squares add up to 20.
    variance = np.mean(np.diff(signal, 3, axis=0) ** 2, axis=0) / 20
    if step is None:
        return np.asarray(np.sqrt(variance))
    # W. F. Sheppard's correction for rounding.
    noise = np.sqrt(np.maximum(variance - step**2 / 12, 0.0))
    return np.where(noise >= LEAST_NOISE_STEPS * step, noise, np.nan)


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
    if torque.shape != (gauges,) or not np.all(np.isfinite(torque)) or not np.any(torque):
        raise InputError(
            f"torque_sensitivities = {torque.tolist()}: expected {gauges} finite numbers, not all "
            "0, one a gauge; measure them with a known load"
        )
    return torque
