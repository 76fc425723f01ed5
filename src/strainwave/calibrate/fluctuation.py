"""Signal fluctuation: from a recording of all gauges to the gains that cancel it.

Amplitudes and phase errors of each gauge's harmonics come from a least-squares fit against the
wave-generator angle; gains that make their weighted sum vanish are the null space of Godler's
conditions. Godler et al. 2000, section III.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous
from strainwave.calibrate.torque import least_squares
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class FluctuationFit:
    """Amplitudes and phase errors of every gauge's harmonics.

    Attributes
    ----------
    amplitudes : numpy.ndarray
        a_ij, shape (harmonics, gauges), in the unit of the signals.
    phase_errors_rad : numpy.ndarray
        psi_ij in the sine form of eq. (6), shape (harmonics, gauges), rad, within +-pi.
    amplitude_standard_errors, phase_standard_errors_rad : numpy.ndarray
        Standard errors of both, same shape.
    offsets : numpy.ndarray
        Mean signal of each gauge over the recording, shape (gauges,).
    """

    amplitudes: NDArray[np.float64]
    phase_errors_rad: NDArray[np.float64]
    amplitude_standard_errors: NDArray[np.float64]
    phase_standard_errors_rad: NDArray[np.float64]
    offsets: NDArray[np.float64]


@dataclass(frozen=True)
class CompensatingGains:
    """Gains of the gauges, and what they are worth.

    Attributes
    ----------
    gains : numpy.ndarray
        g_j, shape (gauges,); normalised so that the torque signal is that of equal gains.
    exact : bool
        Whether the fluctuation vanishes; with fewer than 2N + 1 gauges only its least residual is
        reached.
    residuals : numpy.ndarray
        Amplitude left in each harmonic, shape (harmonics,), in the unit of the amplitudes.
    residuals_equal_gains : numpy.ndarray
        The same with equal gains.
    noise_factor : float
        M sum(g^2) / (sum g)^2.
    condition : float
        Largest over smallest non-zero singular value of the conditions.
    """

    gains: NDArray[np.float64]
    exact: bool
    residuals: NDArray[np.float64]
    residuals_equal_gains: NDArray[np.float64]
    noise_factor: float
    condition: float


def minimum_gauges(harmonics: int) -> int:
    """Fewest gauges that cancel a number of harmonics, 2 N + 1. Godler 2000, eq. (11).

    Parameters
    ----------
    harmonics : int
        N, at least 1.

    Returns
    -------
    int
        M_min.
    """
    if harmonics < 1:
        raise InputError(f"harmonics = {harmonics}: expected at least 1; give a positive number")
    return 2 * harmonics + 1


def enough_gauges(gauges: int, harmonics: int) -> bool:
    """Whether gains can cancel the fluctuation, M >= 2 N + 1. Godler 2000, eq. (10).

    Parameters
    ----------
    gauges : int
        M.
    harmonics : int
        N.

    Returns
    -------
    bool
        True guarantees a solution of eq. (9), not a useful one.
    """
    return gauges >= minimum_gauges(harmonics)


def equally_spaced_positions_rad(gauges: int) -> NDArray[np.float64]:
    """Positions pi (j - 1) / M of M gauges over half a turn.

    Parameters
    ----------
    gauges : int
        M, at least 1.

    Returns
    -------
    numpy.ndarray
        Shape (gauges,), rad; they count against the wave-generator angle.
    """
    return np.array([_core.equally_spaced_position_rad(j, gauges) for j in range(1, gauges + 1)])


def compensation_conditions(
    amplitudes: ArrayLike, phase_errors_rad: ArrayLike, positions_rad: ArrayLike
) -> NDArray[np.float64]:
    """Matrix of the conditions A g = 0. Godler 2000, eq. (9).

    Parameters
    ----------
    amplitudes : array_like
        a_ij at equal gains, shape (harmonics, gauges).
    phase_errors_rad : array_like
        psi_ij, shape (harmonics, gauges), rad.
    positions_rad : array_like
        Positions of the gauges, shape (gauges,), rad.

    Returns
    -------
    numpy.ndarray
        Shape (2 harmonics, gauges): the sine components of eq. (8) and the cosine components,
        harmonic by harmonic.

    Raises
    ------
    InputError
        If the shapes do not fit.
    """
    amplitude = contiguous("amplitudes", amplitudes, np.float64, dimensions=2)
    phase = contiguous("phase_errors_rad", phase_errors_rad, np.float64, dimensions=2)
    position = contiguous("positions_rad", positions_rad, np.float64)
    if phase.shape != amplitude.shape or position.shape != amplitude.shape[1:]:
        raise InputError(
            f"amplitudes has the shape {amplitude.shape}, phase_errors_rad {phase.shape} and "
            f"positions_rad {position.shape}: expected (harmonics, gauges) twice and (gauges,); "
            "give one column a gauge"
        )
    harmonics, gauges = amplitude.shape
    matrix = np.empty((2 * harmonics, gauges))
    for j in range(gauges):
        gauge = _core.GaugeFluctuation(
            amplitudes=amplitude[:, j].tolist(),
            phase_errors_rad=phase[:, j].tolist(),
            position_rad=float(position[j]),
        )
        for i in range(harmonics):
            matrix[2 * i, j], matrix[2 * i + 1, j] = gauge.phasor(i + 1)
    return matrix


def compensating_gains(
    conditions: ArrayLike, torque_sensitivities: ArrayLike | None = None
) -> CompensatingGains:
    """Gains that cancel the fluctuation at the least noise. Godler 2000, section III-B.

    Where the conditions leave a choice (M > 2N + 1) the gains with the least noise at the same
    torque signal are taken; where they leave none but zero (M < 2N + 1), those with the least
    residual.

    Parameters
    ----------
    conditions : array_like
        A from `compensation_conditions`, shape (2 harmonics, gauges).
    torque_sensitivities : array_like, optional
        t_j, signal of each gauge per Nm in any common unit, shape (gauges,); equal without. The
        gains keep t.g = sum(t).

    Returns
    -------
    CompensatingGains
        Gains, residual, noise factor, condition.

    Raises
    ------
    InputError
        If the gains that cancel the fluctuation would cancel the torque as well.
    """
    matrix = contiguous("conditions", conditions, np.float64, dimensions=2)
    gauges = matrix.shape[1]
    torque = (
        np.ones(gauges)
        if torque_sensitivities is None
        else contiguous("torque_sensitivities", torque_sensitivities, np.float64)
    )
    if torque.shape != (gauges,) or not np.all(np.isfinite(torque)) or not np.any(torque):
        raise InputError(
            f"torque_sensitivities = {torque.tolist()}: expected {gauges} finite numbers, not all "
            "0, one a gauge; measure them with a known load"
        )
    if not np.all(np.isfinite(matrix)):
        raise InputError("conditions is not finite: expected numbers; fit the fluctuation again")
    _, singular, right = np.linalg.svd(matrix)
    tolerance = max(matrix.shape) * np.finfo(np.float64).eps * singular.max(initial=0.0)
    rank = int(np.sum(singular > tolerance))
    exact = rank < gauges
    if exact:
        null_space = right[rank:]
        direction = null_space.T @ (null_space @ torque)
        signal = float(torque @ direction)
        if signal <= 1e-9 * float(torque @ torque):
            raise InputError(
                "gains that cancel this fluctuation cancel the torque as well: expected phasors "
                "of the gauges that point apart; move or add a gauge"
            )
    else:
        direction = np.asarray(np.linalg.solve(matrix.T @ matrix, torque), dtype=np.float64)
        signal = float(torque @ direction)
    gains = direction * float(np.sum(torque)) / signal
    return CompensatingGains(
        gains=gains,
        exact=exact,
        residuals=_amplitudes(matrix @ gains),
        residuals_equal_gains=_amplitudes(matrix @ np.ones(gauges)),
        noise_factor=_core.Gains(gains.tolist()).noise_factor,
        condition=float(singular[0] / singular[rank - 1]) if rank else 1.0,
    )


def fit_fluctuation(
    signals: ArrayLike,
    motor_angle_rad: ArrayLike,
    *,
    positions_rad: ArrayLike,
    harmonics: int = 2,
    wave_factor: float = 1.0,
) -> FluctuationFit:
    """Amplitudes and phase errors of each gauge from one run at about constant torque.

    Parameters
    ----------
    signals : array_like
        Gauge signals in any unit, shape (samples, gauges).
    motor_angle_rad : array_like
        Wave-generator angle, shape (samples,), rad; any speed profile that covers a turn.
    positions_rad : array_like
        Positions of the gauges, shape (gauges,), rad.
    harmonics : int
        N, harmonics of twice the wave's angle.
    wave_factor : float
        Factor m of the gear configuration.

    Returns
    -------
    FluctuationFit
        a_ij and psi_ij with standard errors.

    Raises
    ------
    InputError
        If the shapes do not fit or the angle covers less than half a turn.
    """
    signal = contiguous("signals", signals, np.float64, dimensions=2)
    angle = contiguous("motor_angle_rad", motor_angle_rad, np.float64)
    position = contiguous("positions_rad", positions_rad, np.float64)
    if signal.shape != (len(angle), len(position)):
        raise InputError(
            f"signals has the shape {signal.shape}: expected ({len(angle)}, {len(position)}), a "
            "row a sample of motor_angle_rad and a column a gauge of positions_rad; check both"
        )
    minimum_gauges(harmonics)
    if len(angle) == 0 or np.ptp(angle) < np.pi:
        raise InputError(
            "motor_angle_rad covers less than half a turn: expected at least pi rad; turn the "
            "wave generator further"
        )
    orders = 2 * wave_factor * np.arange(1, harmonics + 1)
    columns = [np.ones_like(angle), (angle - angle.mean()) / np.ptp(angle)]
    for order in orders:
        columns += [np.sin(order * angle), np.cos(order * angle)]
    observation = np.column_stack(columns)
    fits = [least_squares(observation, signal[:, j]) for j in range(signal.shape[1])]
    sine = np.array([fit.parameters[2::2] for fit in fits]).T
    cosine = np.array([fit.parameters[3::2] for fit in fits]).T
    errors = np.array([fit.standard_errors[2:].reshape(-1, 2).max(axis=1) for fit in fits]).T
    amplitude = np.hypot(sine, cosine)
    lead = 2 * np.arange(1, harmonics + 1)[:, np.newaxis] * position
    phase = np.angle(np.exp(1j * (np.arctan2(cosine, sine) - lead)))
    with np.errstate(divide="ignore", invalid="ignore"):
        phase_errors = np.where(amplitude > 0, errors / amplitude, np.inf)
    return FluctuationFit(
        amplitudes=amplitude,
        phase_errors_rad=phase,
        amplitude_standard_errors=errors,
        phase_standard_errors_rad=phase_errors,
        offsets=np.array([fit.parameters[0] for fit in fits]),
    )


def _amplitudes(components: NDArray[np.float64]) -> NDArray[np.float64]:
    pairs = components.reshape(-1, 2)
    return np.hypot(pairs[:, 0], pairs[:, 1])
