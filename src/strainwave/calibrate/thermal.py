"""Drift of zero and gain with temperature, from readings at several temperatures.

The sensor's voltage is V = zero + zero drift d + T / (gain (1 + gain drift d)), with T the torque and
d the temperature less that of reference: `strainwave.TorqueCalibration` read the other way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import savgol_filter

from strainwave.arrays import contiguous
from strainwave.calibrate.checks import require_finite
from strainwave.calibrate.warming_and_cooling import warming_less_cooling
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Readings beyond the number of unknowns: zero and its drift, and where the load varies gain and its.
LEAST_SPARE_ROWS: Final = 2
#: Temperatures have to span so much for a slope to be one, K.
LEAST_RANGE_K: Final = 1.0
#: Loads have to span this share of their largest to tell the gain from the zero.
_LEAST_LOAD_SPREAD: Final = 0.1
#: Rows of a log from which a lag can be told, and the share of it over which its rate is taken.
LEAST_LOG_ROWS: Final = 50
_RATE_SHARE: Final = 0.04
#: A coefficient beyond so many standard uncertainties is taken to be there.
CLEAR: Final = 4.0


@dataclass(frozen=True)
class ThermalFit:
    """What readings at several temperatures say.

    Attributes
    ----------
    reference_temperature_degC : float
        Temperature from which the drift counts.
    zero_V : float
        Voltage without torque there.
    zero_drift_V_per_K, zero_drift_standard_uncertainty_V_per_K : float
        Change of the zero, and how well it is known.
    gain_drift_per_K, gain_drift_standard_uncertainty_per_K : float or None
        Relative change of the gain; None where the load did not vary.
    gain_Nm_per_V : float or None
        Gain at the reference temperature.
    lag_s, lag_standard_uncertainty_s : float or None
        Time by which the gauges' temperature follows the thermometer's, negative where it leads;
        None where rows have no time, are too few, or the temperature hardly moved.
    lag_is_used : bool
        Whether the drift is that of the temperature so shifted.
    hysteresis_V : float or None
        Largest difference between warming and cooling at one temperature, the lag taken out where it
        is used; None where there are not both.
    curvature_V : float
        By how much a parabola bends away from the line over half of the range.
    curvature_is_clear : bool
        Whether it stands out of its uncertainty.
    residual_rms_V : float
        What is left.
    lowest_temperature_degC, highest_temperature_degC : float
        Range.
    rows : int
        Readings.
    effective_rows : float
        How many independent ones they are worth.
    """

    reference_temperature_degC: float
    zero_V: float
    zero_drift_V_per_K: float
    zero_drift_standard_uncertainty_V_per_K: float
    gain_drift_per_K: float | None
    gain_drift_standard_uncertainty_per_K: float | None
    gain_Nm_per_V: float | None
    lag_s: float | None
    lag_standard_uncertainty_s: float | None
    lag_is_used: bool
    hysteresis_V: float | None
    curvature_V: float
    curvature_is_clear: bool
    residual_rms_V: float
    lowest_temperature_degC: float
    highest_temperature_degC: float
    rows: int
    effective_rows: float


def fit_thermal(
    temperature_degC: ArrayLike,
    voltage_V: ArrayLike,
    *,
    load_Nm: ArrayLike | None = None,
    time_s: ArrayLike | None = None,
    reference_temperature_degC: float | None = None,
) -> ThermalFit:
    """Fit the drift of zero and, where the load varies, of the gain.

    Parameters
    ----------
    temperature_degC, voltage_V : array_like
        Readings in the order in which they were taken, shape (rows,).
    load_Nm : array_like, optional
        Torque on the sensor; none, and constant, without.
    time_s : array_like, optional
        When they were taken: in a log, the lag of the gauges' temperature is found as well.
    reference_temperature_degC : float, optional
        Temperature from which the drift counts; the middle of the range without.

    Returns
    -------
    ThermalFit
        Drifts with uncertainties for residuals that are correlated.

    Raises
    ------
    InputError
        If there are too few readings, or the temperature hardly varies.
    """
    data = _Readings.checked(temperature_degC, voltage_V, load_Nm, time_s)
    low, high = float(data.temperature.min()), float(data.temperature.max())
    reference = reference_temperature_degC
    if reference is None:
        reference = (low + high) / 2
    warmer = data.temperature - reference
    rate = _rate(data)
    lag, lag_u, lag_is_used = None, None, False
    if rate is not None:
        model = _solve(data, warmer, [rate])
        drift, shift = model.values[1], model.values[-1]
        if drift != 0.0:
            lag = -float(shift / drift)
            lag_u = float(model.uncertainties[-1] / abs(drift))
            lag_is_used = bool(abs(shift) > CLEAR * model.uncertainties[-1])
    seen = warmer if not lag_is_used or rate is None or lag is None else warmer - lag * rate
    fit = _solve(data, seen, [])
    half = (high - low) / 2
    bent = _solve(data, seen, [((seen - seen.mean()) / half) ** 2])
    gain = gain_u = drift_gain = None
    if data.load_varies:
        gain = float(1.0 / fit.values[2])
        drift_gain, gain_u = float(fit.values[3]), float(fit.uncertainties[3])
    return ThermalFit(
        reference_temperature_degC=reference,
        zero_V=float(fit.values[0]),
        zero_drift_V_per_K=float(fit.values[1]),
        zero_drift_standard_uncertainty_V_per_K=float(fit.uncertainties[1]),
        gain_drift_per_K=drift_gain,
        gain_drift_standard_uncertainty_per_K=gain_u,
        gain_Nm_per_V=gain,
        lag_s=lag,
        lag_standard_uncertainty_s=lag_u,
        lag_is_used=lag_is_used,
        hysteresis_V=warming_less_cooling(data.temperature, fit.left),
        curvature_V=abs(float(bent.values[-1])),
        curvature_is_clear=bool(abs(bent.values[-1]) > CLEAR * bent.uncertainties[-1]),
        residual_rms_V=float(np.sqrt(np.mean(fit.left**2))),
        lowest_temperature_degC=low,
        highest_temperature_degC=high,
        rows=len(data.voltage),
        effective_rows=len(data.voltage) / fit.correlation_time,
    )


@dataclass(frozen=True)
class _Readings:
    temperature: NDArray[np.float64]
    voltage: NDArray[np.float64]
    load: NDArray[np.float64]
    time: NDArray[np.float64] | None

    @property
    def load_varies(self) -> bool:
        return float(np.ptp(self.load)) > _LEAST_LOAD_SPREAD * float(np.abs(self.load).max())

    @classmethod
    def checked(
        cls,
        temperature: ArrayLike,
        voltage: ArrayLike,
        load: ArrayLike | None,
        time: ArrayLike | None,
    ) -> _Readings:
        given = {"temperature_degC": temperature, "voltage_V": voltage}
        given |= {} if load is None else {"load_Nm": load}
        given |= {} if time is None else {"time_s": time}
        arrays = {name: contiguous(name, values, np.float64) for name, values in given.items()}
        rows = len(arrays["temperature_degC"])
        for name, values in arrays.items():
            if len(values) != rows:
                raise InputError(
                    f"{name} has {len(values)} elements: expected {rows} as in temperature_degC; give "
                    "one a reading"
                )
            require_finite(name, values, "row")
        data = cls(
            arrays["temperature_degC"],
            arrays["voltage_V"],
            arrays.get("load_Nm", np.zeros(rows)),
            arrays.get("time_s"),
        )
        least = LEAST_SPARE_ROWS + (4 if rows and data.load_varies else 2)
        if rows < least:
            raise InputError(
                f"there are {rows} readings: expected at least {least} at several temperatures; add "
                "readings"
            )
        spread = float(np.ptp(arrays["temperature_degC"]))
        if spread < LEAST_RANGE_K:
            raise InputError(
                f"the temperature varies by {spread:.3g} K: expected at least {LEAST_RANGE_K:g} K, and "
                "better the whole range of use; warm or cool the sensor"
            )
        stamps = data.time
        if stamps is not None and not np.all(np.diff(stamps) > 0):
            row = int(np.argmax(np.diff(stamps) <= 0)) + 1
            raise InputError(
                f"time_s does not grow at row {row}: expected readings in the order of time; sort "
                "them, or leave out the time"
            )
        return data


@dataclass(frozen=True)
class _Model:
    values: NDArray[np.float64]
    uncertainties: NDArray[np.float64]
    left: NDArray[np.float64]
    correlation_time: float


def _solve(data: _Readings, warmer: NDArray[np.float64], more: list[NDArray[np.float64]]) -> _Model:
    """Fit zero, zero drift, and where the load varies 1/gain and gain drift; further columns last."""
    linear = [np.ones(len(warmer)), warmer]
    if data.load_varies:
        linear += [data.load, -data.load * warmer]
    matrix = np.column_stack([*linear, *more])
    length = np.linalg.norm(matrix, axis=0)
    length[length == 0.0] = 1.0
    if np.linalg.matrix_rank(matrix[:, : len(linear)] / length[: len(linear)]) < len(linear):
        raise InputError(
            "loads and temperatures vary together: expected several loads at each temperature, or one "
            "throughout, to tell the drift of the gain from that of the zero; add readings"
        )
    values = np.linalg.lstsq(matrix / length, data.voltage, rcond=None)[0] / length
    jacobian = matrix
    if data.load_varies:
        values[3] = values[3] / values[2] if values[2] else 0.0
        values, jacobian = _with_gain(data, warmer, matrix, values)
    left = data.voltage - _voltage(data, warmer, matrix, values)
    correlation = _correlation_time(left)
    freedom = max(len(left) / correlation - matrix.shape[1], 1.0)
    variance = float(left @ left) / freedom
    scaled = jacobian / length
    covariance = np.linalg.pinv(scaled.T @ scaled) * variance
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0)) / length
    return _Model(values, spread, left, correlation)


def _voltage(
    data: _Readings,
    warmer: NDArray[np.float64],
    matrix: NDArray[np.float64],
    values: NDArray[np.float64],
) -> NDArray[np.float64]:
    if not data.load_varies:
        return np.asarray(matrix @ values)
    base = np.delete(matrix, (2, 3), axis=1) @ np.delete(values, (2, 3))
    return np.asarray(base + data.load * values[2] / (1.0 + values[3] * warmer))


def _with_gain(
    data: _Readings,
    warmer: NDArray[np.float64],
    matrix: NDArray[np.float64],
    start: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Refine the linear solution for a gain that is divided by, not multiplied."""

    def residuals(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return _voltage(data, warmer, matrix, values) - data.voltage

    def jacobian(values: NDArray[np.float64]) -> NDArray[np.float64]:
        found = matrix.copy()
        share = 1.0 + values[3] * warmer
        found[:, 2] = data.load / share
        found[:, 3] = -data.load * values[2] * warmer / share**2
        return found

    found = least_squares(residuals, start, jac=jacobian, x_scale="jac", xtol=1e-15, ftol=1e-15)
    return found.x, jacobian(found.x)


def _correlation_time(left: NDArray[np.float64]) -> float:
    """Say how many neighbouring residuals are worth one: up to the first lag without correlation."""
    power = float(left @ left)
    if power <= 0.0 or len(left) < LEAST_LOG_ROWS:
        return 1.0
    time = 1.0
    for lag in range(1, len(left) // 4):
        share = float(left[lag:] @ left[:-lag]) / power
        if share <= 0.05:
            break
        time += 2.0 * share
    return time


def _rate(data: _Readings) -> NDArray[np.float64] | None:
    """How fast the thermometer's temperature moves in a log, K/s; None where that says nothing."""
    if data.time is None or len(data.time) < LEAST_LOG_ROWS:
        return None
    window = max(5, int(_RATE_SHARE * len(data.time)) // 2 * 2 + 1)
    # By row, and then by time: rows need not be equally spaced.
    degrees = savgol_filter(data.temperature, window, 2, deriv=1)
    seconds = savgol_filter(data.time, window, 2, deriv=1)
    rate = np.asarray(degrees / seconds)
    # One steady slope shifts the temperature by a constant, which is a zero.
    return rate if float(np.std(rate)) > 0.1 * float(np.abs(rate).max()) else None
