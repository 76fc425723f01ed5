"""Static torque calibration: known loads and volts to a sensor gain that can be trusted.

A gain is fitted by least squares to each loading experiment; experiments at other positions,
directions, ranges and temperatures say how far it holds. Taghirad & Belanger 1999, section IV.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from strainwave.arrays import contiguous
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


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
        If the columns of A are not independent.
    """
    observation = contiguous("matrix", matrix, np.float64, dimensions=2)
    _require_rank(observation)
    return np.asarray(np.linalg.pinv(observation), dtype=np.float64)


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
    for name, values in (("matrix", observation), ("measurements", measured)):
        if not np.all(np.isfinite(values)):
            row = int(np.argwhere(~np.isfinite(values))[0][0])
            raise InputError(
                f"{name} is not finite in row {row}: expected numbers; leave that measurement out"
            )
    inverse = pseudo_inverse(observation)
    parameters = inverse @ measured
    residuals = measured - observation @ parameters
    freedom = observation.shape[0] - observation.shape[1]
    variance = float(residuals @ residuals) / freedom if freedom > 0 else np.nan
    return LeastSquaresFit(
        parameters=parameters,
        standard_errors=np.sqrt(variance * np.sum(inverse**2, axis=1)),
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
        If the arrays do not fit each other or no load differs from the others.
    """
    fit = least_squares(observation_matrix(volts, intercept=intercept), torque_Nm)
    gain = float(fit.parameters[0])
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
        If there are fewer than two gains.
    """
    gains = contiguous("gains_Nm_per_V", gains_Nm_per_V, np.float64)
    if len(gains) < 2:
        raise InputError(
            f"gains_Nm_per_V has {len(gains)} elements: expected at least 2; repeat the loading at "
            "another position"
        )
    return float(np.std(gains, ddof=1) / np.abs(np.mean(gains)))


def consistency(gains_Nm_per_V: Sequence[float]) -> Consistency:
    """Combine the gains of several experiments, and say what their scatter supports.

    Parameters
    ----------
    gains_Nm_per_V : sequence of float
        Gain of each experiment, at least two.

    Returns
    -------
    Consistency
        Mean, consistency measure, and intervals of normally distributed gains.
    """
    measure = consistency_measure(gains_Nm_per_V)
    count = len(gains_Nm_per_V)
    freedom = count - 1
    student = float(stats.t.ppf(0.975, freedom))
    return Consistency(
        gain_Nm_per_V=float(np.mean(gains_Nm_per_V)),
        consistency=measure,
        standard_uncertainty=measure / float(np.sqrt(count)),
        prediction_95=student * measure * float(np.sqrt(1 + 1 / count)),
        consistency_low=measure * float(np.sqrt(freedom / stats.chi2.ppf(0.975, freedom))),
        consistency_high=measure * float(np.sqrt(freedom / stats.chi2.ppf(0.025, freedom))),
    )


def _require_rank(observation: NDArray[np.float64]) -> None:
    if np.linalg.matrix_rank(observation) < observation.shape[1]:
        raise InputError(
            f"the {observation.shape[1]} columns of the observation matrix are not independent: "
            "expected measurements that tell them apart; load the sensor with different torques"
        )
