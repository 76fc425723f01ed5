"""Static torque calibration: known loads and volts to a sensor gain that can be trusted.

A gain is fitted by least squares to each loading experiment; experiments at other positions,
directions, ranges and temperatures say how far it holds. Taghirad & Belanger 1999, section IV.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy import stats

from strainwave.arrays import contiguous
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


#: Share of the largest torque that a gain must explain to be told from rounding.
SMALLEST_SHARE_EXPLAINED: Final = 1e-9


@dataclass(frozen=True)
class LeastSquaresFit:
    """Parameters of a linear regression.

    Attributes
    ----------
    parameters : numpy.ndarray
        Estimates theta, shape (parameters,).
    standard_errors : numpy.ndarray
        Their standard errors from the residuals; NaN where there are no more measurements than
        parameters.
    residuals : numpy.ndarray
        b - A theta, shape (measurements,).
    condition : float
        Condition number of the observation matrix.
    """

    parameters: NDArray[np.float64]
    standard_errors: NDArray[np.float64]
    residuals: NDArray[np.float64]
    condition: float


@dataclass(frozen=True)
class SensorGain:
    """Straight line through one loading experiment.

    Attributes
    ----------
    gain_Nm_per_V : float
        Sensor gain.
    zero_V : float
        Output without load; 0 if the line was made to pass the origin.
    gain_standard_error_Nm_per_V : float
        Standard error of the gain from the residuals.
    residual_rms_Nm : float
        Root mean square of the residuals.
    largest_residual_Nm : float
        Largest residual: linearity error, hysteresis included.
    """

    gain_Nm_per_V: float
    zero_V: float
    gain_standard_error_Nm_per_V: float
    residual_rms_Nm: float
    largest_residual_Nm: float


@dataclass(frozen=True)
class Consistency:
    """What several experiments say about one gain.

    Attributes
    ----------
    gain_Nm_per_V : float
        Mean over the experiments, the final gain.
    consistency : float
        Standard deviation over mean, a fraction.
    standard_uncertainty : float
        Standard uncertainty of the mean, relative.
    prediction_95 : float
        Half width of the 95 % interval for the gain at one more position, relative.
    consistency_low, consistency_high : float
        95 % confidence interval of the consistency measure itself.
    """

    gain_Nm_per_V: float
    consistency: float
    standard_uncertainty: float
    prediction_95: float
    consistency_low: float
    consistency_high: float


def observation_matrix(volts: ArrayLike, *, intercept: bool = False) -> NDArray[np.float64]:
    """Observation matrix A of A theta = b + n. Taghirad & Belanger 1999, eq. (5).

    Parameters
    ----------
    volts : array_like
        Sensor output, shape (measurements,), V.
    intercept : bool
        Whether theta has a second element, the torque read at 0 V.

    Returns
    -------
    numpy.ndarray
        Shape (measurements, 1) or (measurements, 2).
    """
    column = contiguous("volts", volts, np.float64)
    return np.column_stack([column, np.ones_like(column)]) if intercept else column[:, np.newaxis]


def pseudo_inverse(matrix: ArrayLike) -> NDArray[np.float64]:
    """Moore-Penrose inverse of a matrix of full column rank. Taghirad & Belanger 1999, eq. (8).

    Parameters
    ----------
    matrix : array_like
        Observation matrix A, shape (measurements, parameters).

    Returns
    -------
    numpy.ndarray
        (A' A)^-1 A', shape (parameters, measurements); computed by singular values, because A' A
        squares the condition number.

    Raises
    ------
    InputError
        If values are not finite or the columns of A are not independent.
    """
    observation = contiguous("matrix", matrix, np.float64, dimensions=2)
    _require_finite("matrix", observation)
    _require_rank(observation)
    with np.errstate(all="ignore"):
        inverse = np.asarray(np.linalg.pinv(observation), dtype=np.float64)
    _require_no_overflow(inverse)
    return inverse


def least_squares(matrix: ArrayLike, measurements: ArrayLike) -> LeastSquaresFit:
    """Least-squares solution of A theta ~ b. Taghirad & Belanger 1999, eq. (6) and (7).

    Parameters
    ----------
    matrix : array_like
        Observation matrix A, shape (measurements, parameters).
    measurements : array_like
        Measurement vector b, shape (measurements,).

    Returns
    -------
    LeastSquaresFit
        Estimates, standard errors, residuals and condition.

    Raises
    ------
    InputError
        If the shapes do not fit, values are not finite or the columns of A are not independent.
    """
    observation = contiguous("matrix", matrix, np.float64, dimensions=2)
    measured = contiguous("measurements", measurements, np.float64)
    if len(measured) != len(observation):
        raise InputError(
            f"measurements has {len(measured)} elements: expected {len(observation)}, the rows "
            "of the observation matrix; give arrays of one length"
        )
    _require_finite("matrix", observation)
    _require_finite("measurements", measured)
    # Columns of one size, by powers of two that round nothing: better conditioned where units
    # differ; and one step of refinement, because inverse @ measured alone loses digits.
    scale = np.ldexp(1.0, -np.frexp(np.max(np.abs(observation), axis=0, initial=0.0))[1])
    inverse = pseudo_inverse(observation * scale)
    freedom = observation.shape[0] - observation.shape[1]
    with np.errstate(all="ignore"):
        scaled = inverse @ measured
        scaled += inverse @ (measured - (observation * scale) @ scaled)
        parameters = scale * scaled
        residuals = measured - observation @ parameters
        squares = float(residuals @ residuals)
        spread = np.sum((inverse * scale[:, np.newaxis]) ** 2, axis=1)
        errors = np.sqrt((squares / freedom if freedom > 0 else np.nan) * spread)
    _require_no_overflow(parameters, residuals, np.array(squares), spread)
    return LeastSquaresFit(
        parameters=parameters,
        standard_errors=errors,
        residuals=residuals,
        condition=float(np.linalg.cond(observation)),
    )


def sensor_gain(volts: ArrayLike, torque_Nm: ArrayLike, *, intercept: bool = False) -> SensorGain:
    """Gain of one loading experiment.

    Parameters
    ----------
    volts : array_like
        Sensor output, shape (measurements,), V.
    torque_Nm : array_like
        Applied torque, shape (measurements,), Nm.
    intercept : bool
        Whether the line has a zero of its own. Without, as the paper fits it, loads in one
        direction turn a zero error into a gain error.

    Returns
    -------
    SensorGain
        Gain, zero, their quality.

    Raises
    ------
    InputError
        If the arrays do not fit each other, volts or torque do not vary, or the torque does not
        follow the volts.
    """
    output = contiguous("volts", volts, np.float64)
    torque = contiguous("torque_Nm", torque_Nm, np.float64)
    if len(torque) != len(output):
        raise InputError(
            f"torque_Nm has {len(torque)} elements: expected {len(output)} as in volts; give one "
            "torque a measurement"
        )
    for name, values, kind in (("volts", output, "outputs"), ("torque_Nm", torque, "loads")):
        _require_finite(name, values)
        if intercept and np.all(values == values[:1]):
            raise InputError(
                f"{name} has the same value in all {len(values)} measurements: expected at least "
                f"two different {kind}; load the sensor with different torques"
            )
        if not np.any(values):
            raise InputError(
                f"{name} has no value other than 0 in {len(values)} measurements: expected at "
                f"least one of the {kind} to differ from 0; load the sensor"
            )
    fit = least_squares(observation_matrix(output, intercept=intercept), torque)
    gain = float(fit.parameters[0])
    reach_V = float(np.ptp(output) if intercept else np.abs(output).max())
    if abs(gain) * reach_V <= SMALLEST_SHARE_EXPLAINED * float(np.abs(torque).max()):
        raise InputError(
            "torque_Nm does not follow volts, the gain of the best line is 0: expected an output "
            "that changes with the load; check the wiring and the order of the measurements"
        )
    return SensorGain(
        gain_Nm_per_V=gain,
        zero_V=-float(fit.parameters[1]) / gain if intercept else 0.0,
        gain_standard_error_Nm_per_V=float(fit.standard_errors[0]),
        residual_rms_Nm=float(np.sqrt(np.mean(fit.residuals**2))),
        largest_residual_Nm=float(np.max(np.abs(fit.residuals))),
    )


def consistency_measure(gains_Nm_per_V: ArrayLike) -> float:
    """Ratio of standard deviation to mean over experiments. Taghirad & Belanger 1999, section IV.

    Parameters
    ----------
    gains_Nm_per_V : array_like
        Gain of each experiment, at least two; the standard deviation is that of a sample (n - 1).

    Returns
    -------
    float
        A fraction; 0.02 for the 2 % of Table I.

    Raises
    ------
    InputError
        If there are fewer than two gains, or they are not finite or not of one sign.
    """
    gains = contiguous("gains_Nm_per_V", gains_Nm_per_V, np.float64)
    _require_finite("gains_Nm_per_V", gains)
    if len(gains) < 2:
        raise InputError(
            f"gains_Nm_per_V has {len(gains)} elements: expected at least 2; repeat the loading at "
            "another position"
        )
    if not (np.all(gains > 0) or np.all(gains < 0)):
        raise InputError(
            f"gains_Nm_per_V reaches from {gains.min():g} to {gains.max():g} Nm/V: expected gains "
            "of one sign, none of them 0; check the signs of volts and torque in each experiment"
        )
    gains = gains / gains[np.argmax(np.abs(gains))]  # has no unit, and squares cannot overflow
    return float(np.std(gains, ddof=1) / np.mean(gains))


def consistency(gains_Nm_per_V: ArrayLike) -> Consistency:
    """Combine the gains of several experiments, and say what their scatter supports.

    Parameters
    ----------
    gains_Nm_per_V : array_like
        Gain of each experiment, at least two.

    Returns
    -------
    Consistency
        Mean, consistency measure, and intervals of normally distributed gains.

    Raises
    ------
    InputError
        If there are fewer than two gains, or they are not finite or not of one sign.
    """
    gains = contiguous("gains_Nm_per_V", gains_Nm_per_V, np.float64)
    measure = consistency_measure(gains)
    count = len(gains)
    freedom = count - 1
    student = float(stats.t.ppf(0.975, freedom))
    return Consistency(
        gain_Nm_per_V=float(np.sum(gains / count)),
        consistency=measure,
        standard_uncertainty=measure / float(np.sqrt(count)),
        prediction_95=student * measure * float(np.sqrt(1 + 1 / count)),
        consistency_low=measure * float(np.sqrt(freedom / stats.chi2.ppf(0.975, freedom))),
        consistency_high=measure * float(np.sqrt(freedom / stats.chi2.ppf(0.025, freedom))),
    )


def _require_finite(name: str, values: NDArray[np.float64]) -> None:
    finite = np.isfinite(values)
    if not np.all(finite):
        row = int(np.argwhere(~finite)[0][0])
        raise InputError(
            f"{name} is not finite in row {row}: expected numbers; leave that measurement out"
        )


def _require_rank(observation: NDArray[np.float64]) -> None:
    rows, columns = observation.shape
    if columns < 1 or rows < columns:
        raise InputError(
            f"matrix has {rows} rows and {columns} columns: expected at least one column, and a "
            "row or more for each; add measurements"
        )
    if np.linalg.matrix_rank(observation) < columns:
        raise InputError(
            f"the {columns} columns of matrix are not independent: expected measurements that tell "
            f"its {columns} parameters apart; vary what is measured, or fit fewer parameters"
        )


def _require_no_overflow(*results: NDArray[np.float64]) -> None:
    if not all(np.all(np.isfinite(result)) for result in results):
        raise InputError(
            "the fit leaves the range of double precision: expected numbers within about 1e-150 "
            "to 1e150; choose units that suit them"
        )
