"""The sensor's zero without unloading: static poses against a model of the load's weight.

In a pose at rest the output carries the weight and nothing else, so that what the sensor reads beyond
a model of the weight is its zero. That holds only if the model is right; whether it is, the scatter
over the poses says.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy import stats
from scipy.optimize import brentq, least_squares

from strainwave.arrays import contiguous
from strainwave.calibrate.checks import require_finite
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from strainwave.calibrate.poses import Poses

#: Probability that the gate lets a right model pass.
CONFIDENCE: Final = 0.99
#: Probability that it refuses a model that is wrong by `Tare.refused_share`.
POWER: Final = 0.95
#: Poses beyond the number of unknowns.
LEAST_SPARE_POSES: Final = 2
#: The weight's torque has to scatter over the poses by this share of its largest, or a wrong weight
#: and a wrong zero look the same.
LEAST_SPREAD: Final = 0.2
#: Condition number of zero and angle, where the angle is fitted, columns scaled to length 1.
LARGEST_CONDITION: Final = 20.0


@dataclass(frozen=True)
class Weight:
    """A mass on an arm: torque amplitude x cos(angle - horizontal angle).

    Attributes
    ----------
    amplitude_Nm : float
        Its largest torque.
    horizontal_angle_rad : float or None
        Output angle at which that is; None where it is to be fitted.
    """

    amplitude_Nm: float
    horizontal_angle_rad: float | None = None


@dataclass(frozen=True)
class SensorScatter:
    """By how much poses may differ from a right model, as standard deviations.

    Attributes
    ----------
    accuracy_Nm : float
        Of the sensor from pose to pose: fluctuation, hysteresis, linearity.
    gain_share : float
        Relative, of its gain from pose to pose.
    """

    accuracy_Nm: float
    gain_share: float = 0.0


@dataclass(frozen=True)
class Tare:
    """What poses say of the zero.

    Attributes
    ----------
    zero_Nm, standard_uncertainty_Nm : float
        What the sensor reads without torque, and how well that is known.
    model_torque_Nm, residual_Nm : numpy.ndarray
        Of each pose.
    scatter_Nm : float
        Root of the sum of squared residuals over the degrees of freedom.
    chi_square : float
        Sum of squared residuals over the variances that the sensor's scatter gives.
    limit : float
        What it may be.
    degrees_of_freedom : int
        Poses less unknowns.
    horizontal_angle_rad : float or None
        Angle of largest torque, told or fitted; None where the model came as torques.
    is_angle_fitted : bool
        Whether it was fitted.
    model_share, model_share_standard_uncertainty : float or None
        By what the model has to be multiplied to fit best, and how well that is known; None where it
        makes no torque.
    refused_share : float or None
        A model wrong by this share of itself is refused with probability `POWER`; None where it makes
        no torque.
    hidden_zero_Nm : float
        By how much the zero is wrong where the model is wrong by `refused_share`.
    is_explained : bool
        Whether the model explains the poses: the gate.
    would_be_explained : bool
        Whether it does once it is multiplied by `model_share`.
    """

    zero_Nm: float
    standard_uncertainty_Nm: float
    model_torque_Nm: NDArray[np.float64]
    residual_Nm: NDArray[np.float64]
    scatter_Nm: float
    chi_square: float
    limit: float
    degrees_of_freedom: int
    horizontal_angle_rad: float | None
    is_angle_fitted: bool
    model_share: float | None
    model_share_standard_uncertainty: float | None
    refused_share: float | None
    hidden_zero_Nm: float
    is_explained: bool
    would_be_explained: bool


def tare(poses: Poses, model: Weight | ArrayLike, scatter: SensorScatter) -> Tare:
    """Fit the zero, and ask whether the model explains the poses.

    Parameters
    ----------
    poses : Poses
        The readings.
    model : Weight or array_like
        The load's weight, or the torque of a model in each pose, shape (poses,).
    scatter : SensorScatter
        What the sensor itself may scatter by.

    Returns
    -------
    Tare
        The zero; to be used only where `Tare.is_explained`.

    Raises
    ------
    InputError
        If there are too few poses, or they are too much alike to tell a wrong weight from a zero.
    """
    fits_angle = (
        isinstance(model, Weight)
        and model.horizontal_angle_rad is None
        and model.amplitude_Nm != 0.0
    )
    unknowns = 2 if fits_angle else 1
    if len(poses) < unknowns + LEAST_SPARE_POSES:
        raise InputError(
            f"there are {len(poses)} poses: expected at least {unknowns + LEAST_SPARE_POSES} for "
            f"{'zero and horizontal angle' if fits_angle else 'the zero'}, so that their scatter says "
            "whether the model is right; add poses"
        )
    angle_rad: float | None = None
    turned: NDArray[np.float64] | None = None
    if isinstance(model, Weight):
        angle_rad = model.horizontal_angle_rad or 0.0
        if fits_angle:
            _require_apart(poses.output_angle_rad)
            angle_rad = _horizontal_angle(poses, model.amplitude_Nm)
            turned = model.amplitude_Nm * np.sin(poses.output_angle_rad - angle_rad)
        torque = model.amplitude_Nm * np.cos(poses.output_angle_rad - angle_rad)
    else:
        torque = contiguous("model", model, np.float64)
        require_finite("model", torque, "pose")
        if len(torque) != len(poses):
            raise InputError(
                f"model has {len(torque)} elements: expected {len(poses)}, one a pose; give a torque "
                "for each"
            )
    largest = float(np.abs(torque).max())
    if isinstance(model, Weight):
        largest = abs(model.amplitude_Nm)
    _require_spread(torque, largest)
    return _judge(poses, torque, turned, scatter, angle_rad)


def _judge(
    poses: Poses,
    torque: NDArray[np.float64],
    turned: NDArray[np.float64] | None,
    scatter: SensorScatter,
    angle_rad: float | None,
) -> Tare:
    """Weigh the residuals; `turned` is how the model changes with an angle that is fitted."""
    # A mean over readings repeats better than a reading; what changes from pose to pose does not.
    repeats = 0.0 if poses.repeatability_Nm is None else poses.repeatability_Nm
    variance = scatter.accuracy_Nm**2 + (scatter.gain_share * torque) ** 2
    variance = variance + repeats**2 / poses.readings
    zero = _mean(poses.torque_Nm - torque, variance)
    residual = poses.torque_Nm - torque - zero
    freedom = len(poses) - (1 if turned is None else 2)
    chi_square = float(np.sum(residual**2 / variance))
    limit = float(stats.chi2.ppf(CONFIDENCE, freedom))
    share, share_u, scaled_chi = _best_share(poses, torque, turned, variance)
    scaled_limit = float(stats.chi2.ppf(CONFIDENCE, max(freedom - 1, 1)))
    seen = float(np.sum((torque - _mean(torque, variance)) ** 2 / variance))
    refused = float(np.sqrt(_noncentrality(limit, freedom) / seen)) if seen > 0.0 else None
    # Poses that scatter by more than the sensor is said to speak for themselves.
    excess = max(1.0, chi_square / freedom)
    uncertainty = np.sqrt(excess / np.sum(1.0 / variance))
    if turned is not None:
        uncertainty = uncertainty * _inflation(turned)
    return Tare(
        zero_Nm=zero,
        standard_uncertainty_Nm=float(uncertainty),
        model_torque_Nm=torque,
        residual_Nm=residual,
        scatter_Nm=float(np.sqrt(np.sum(residual**2) / freedom)),
        chi_square=chi_square,
        limit=limit,
        degrees_of_freedom=freedom,
        horizontal_angle_rad=angle_rad,
        is_angle_fitted=turned is not None,
        model_share=share,
        model_share_standard_uncertainty=share_u,
        refused_share=refused,
        hidden_zero_Nm=0.0 if refused is None else refused * abs(_mean(torque, variance)),
        is_explained=chi_square <= limit,
        would_be_explained=share is not None and scaled_chi <= scaled_limit,
    )


def _noncentrality(limit: float, freedom: int) -> float:
    """Say what a wrong model has to add to chi-square to be refused with probability `POWER`."""

    def missing(added: float) -> float:
        return float(stats.ncx2.sf(limit, freedom, added)) - POWER

    return float(brentq(missing, 1e-3, 100.0 * limit))


def _mean(values: NDArray[np.float64], variance: NDArray[np.float64]) -> float:
    return float(np.sum(values / variance) / np.sum(1.0 / variance))


def _best_share(
    poses: Poses,
    torque: NDArray[np.float64],
    turned: NDArray[np.float64] | None,
    variance: NDArray[np.float64],
) -> tuple[float | None, float | None, float]:
    """Fit zero and the model's size, and its angle where that is fitted: then all is linear."""
    columns = [np.ones(len(poses)), torque, *([] if turned is None else [turned])]
    matrix = np.column_stack(columns) / np.sqrt(variance)[:, np.newaxis]
    freedom = len(poses) - matrix.shape[1]
    if freedom < 1 or np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        return None, None, np.inf
    readings = poses.torque_Nm / np.sqrt(variance)
    solution = np.linalg.lstsq(matrix, readings, rcond=None)[0]
    left = readings - matrix @ solution
    chi_square = float(left @ left)
    covariance = np.linalg.inv(matrix.T @ matrix) * max(1.0, chi_square / freedom)
    share = float(solution[1] if turned is None else np.hypot(solution[1], solution[2]))
    return share, float(np.sqrt(covariance[1, 1])), chi_square


def _horizontal_angle(poses: Poses, amplitude_Nm: float) -> float:
    """Fit the angle of largest torque beside the zero."""

    def residuals(unknown: NDArray[np.float64]) -> NDArray[np.float64]:
        model = amplitude_Nm * np.cos(poses.output_angle_rad - unknown[0])
        return np.asarray(poses.torque_Nm - model - unknown[1])

    # With the size free as well all is linear; its angle is next to that of the size that was told.
    turned = poses.output_angle_rad
    matrix = np.column_stack([np.cos(turned), np.sin(turned), np.ones(len(poses))])
    cosine, sine, constant = np.linalg.lstsq(matrix, poses.torque_Nm, rcond=None)[0]
    sign = np.sign(amplitude_Nm)
    best = least_squares(residuals, [float(np.arctan2(sign * sine, sign * cosine)), constant])
    return float((best.x[0] + np.pi) % (2 * np.pi) - np.pi)


def _inflation(turned: NDArray[np.float64]) -> float:
    """By what the zero is less well known because the angle is fitted beside it."""
    matrix = np.column_stack([np.ones(len(turned)), turned])
    return float(np.sqrt(np.linalg.inv(matrix.T @ matrix)[0, 0] * len(turned)))


def _require_apart(angle_rad: NDArray[np.float64]) -> None:
    middle = angle_rad - angle_rad.mean()
    matrix = np.column_stack([np.ones(len(middle)), np.cos(middle), np.sin(middle)])
    length = np.linalg.norm(matrix, axis=0)
    condition = np.linalg.cond(matrix / np.where(length > 0, length, 1.0))
    if not condition <= LARGEST_CONDITION:
        raise InputError(
            "the poses are too much alike to tell zero, horizontal angle and weight apart (condition "
            f"number {condition:.3g}, expected at most {LARGEST_CONDITION:g}); spread them over half "
            "a turn of the output or more, or tell the horizontal angle"
        )


def _require_spread(torque: NDArray[np.float64], largest_Nm: float) -> None:
    if largest_Nm > 0.0 and float(np.std(torque)) < LEAST_SPREAD * largest_Nm:
        raise InputError(
            f"the poses are too much alike: the weight's torque is {torque.min():.4g} to "
            f"{torque.max():.4g} Nm in them, and a wrong weight would look like a zero; expected its "
            f"standard deviation over the poses to be {LEAST_SPREAD:g} of its largest, "
            f"{largest_Nm:.4g} Nm, so spread the poses over half a turn of the output or more"
        )
