"""Signal fluctuation: from a recording of all gauges to the conditions under which it cancels.

Amplitudes and phase errors of each gauge's harmonics come from a least-squares fit against the
wave-generator angle; what gains have to fulfil follows from them. Godler et al. 2000, section III.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous
from strainwave.calibrate.checks import real_number, require_finite, whole_number
from strainwave.calibrate.torque import least_squares
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


#: Largest angle of which the core can tell the phase, 2^40 turns.
LARGEST_ANGLE_RAD: Final = 2 * np.pi * 2.0**40


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

    Raises
    ------
    InputError
        If it is no whole number of at least 1.
    """
    return 2 * whole_number("harmonics", harmonics) + 1


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
        True guarantees a solution of eq. (9), not a useful one: `compensating_gains` says what a
        solution is worth.

    Raises
    ------
    InputError
        If one of them is no whole number of at least 1.
    """
    return whole_number("gauges", gauges) >= minimum_gauges(harmonics)


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

    Raises
    ------
    InputError
        If it is no whole number of at least 1.
    """
    count = whole_number("gauges", gauges)
    return np.array([_core.equally_spaced_position_rad(j, count) for j in range(1, count + 1)])


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
        If the shapes do not fit or values are not finite.
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
    for name, values in (("amplitudes", amplitude), ("phase_errors_rad", phase)):
        require_finite(name, values, "harmonic", "gauge")
    require_finite("positions_rad", position, "gauge")
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


def checked_wave_factor(wave_factor: float) -> float:
    """Take a factor m, or say what was given instead.

    Parameters
    ----------
    wave_factor : float
        Wave turns per motor turn.

    Returns
    -------
    float
        The factor.

    Raises
    ------
    InputError
        If it is no number above 0 and below 2^31.
    """
    factor = real_number("wave_factor", wave_factor)
    if not 0 < factor < 2**31:
        raise InputError(
            f"wave_factor = {factor:g}: expected a number above 0 and below 2^31, wave turns per "
            "motor turn; take it from the gear"
        )
    return factor


def checked_run(
    signals: ArrayLike, motor_angle_rad: ArrayLike, positions_rad: ArrayLike, harmonics: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Take one run of all gauges, or say why harmonics cannot be fitted to it.

    Parameters
    ----------
    signals : array_like
        Gauge signals in any unit, shape (samples, gauges).
    motor_angle_rad : array_like
        Wave-generator angle, shape (samples,), rad.
    positions_rad : array_like
        Positions of the gauges, shape (gauges,), rad.
    harmonics : int
        Number of harmonics to be fitted.

    Returns
    -------
    tuple of numpy.ndarray
        Signals, angle, positions.

    Raises
    ------
    InputError
        If the shapes do not fit, values are not finite or the angle covers less than half a turn.
    """
    signal = contiguous("signals", signals, np.float64, dimensions=2)
    angle = contiguous("motor_angle_rad", motor_angle_rad, np.float64)
    position = contiguous("positions_rad", positions_rad, np.float64)
    if signal.shape != (len(angle), len(position)):
        raise InputError(
            f"signals has the shape {signal.shape}: expected ({len(angle)}, {len(position)}), a "
            "row a sample of motor_angle_rad and a column a gauge of positions_rad; check both"
        )
    require_finite("signals", signal, "row", "column")
    require_finite("motor_angle_rad", angle, "row")
    require_finite("positions_rad", position, "gauge")
    for name, values in (("motor_angle_rad", angle), ("positions_rad", position)):
        if np.any(np.abs(values) > LARGEST_ANGLE_RAD):
            raise InputError(
                f"{name} reaches {np.abs(values).max():g} rad: expected angles within 2^40 turns; "
                "check their unit"
            )
    if len(angle) == 0 or np.ptp(angle) < np.pi:
        raise InputError(
            "motor_angle_rad covers less than half a turn: expected at least pi rad; turn the "
            "wave generator further"
        )
    if len(angle) < 2 + 2 * harmonics:
        raise InputError(
            f"motor_angle_rad has {len(angle)} elements: expected at least {2 + 2 * harmonics} for "
            f"{harmonics} harmonic(s), an offset and a drift; record more samples"
        )
    return signal, angle, position


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
        If the shapes do not fit, values are not finite, the angle covers less than half a turn or
        does not tell the harmonics apart.
    """
    harmonics = whole_number("harmonics", harmonics)
    factor = checked_wave_factor(wave_factor)
    signal, angle, position = checked_run(signals, motor_angle_rad, positions_rad, harmonics)
    orders = 2 * factor * np.arange(1, harmonics + 1)
    columns = [np.ones_like(angle), (angle - angle.mean()) / np.ptp(angle)]
    for order in orders:
        columns += [np.sin(order * angle), np.cos(order * angle)]
    observation = np.column_stack(columns)
    if np.linalg.matrix_rank(observation) < observation.shape[1]:
        raise InputError(
            f"motor_angle_rad does not tell {harmonics} harmonic(s), offset and drift of the signals "
            "apart: expected many different angles over half a turn or more; record at other "
            "angles, or fit fewer harmonics"
        )
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
