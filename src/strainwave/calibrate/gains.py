"""Gains that cancel the signal fluctuation, and what they are worth.

Gains that make the gauges' weighted sum vanish are the null space of Godler's conditions; of those
the quietest are taken, and what is degenerate is refused. Godler et al. 2000, section III-B.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous
from strainwave.calibrate.checks import real_number, require_finite
from strainwave.calibrate.fluctuation import minimum_gauges
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Noise power over that of equal gains above which gains are refused; see `compensating_gains`.
MOST_NOISE: Final = 10.0
#: Noise power over that of equal gains above which gains come with a warning.
NOTEWORTHY_NOISE: Final = 2.0
#: Singular values below this share of the largest are rounding: the core's angles have steps of
#: 2^-32 turn, which sixteen harmonics magnify to 2.4e-8 rad.
ROUNDING_OF_ANGLES: Final = 3e-8


@dataclass(frozen=True)
class CompensatingGains:
    """Gains of the gauges, and what they are worth.

    Attributes
    ----------
    gains : numpy.ndarray
        g_j, shape (gauges,); normalised so that the torque signal is that of equal gains.
    exact : bool
        Whether the fluctuation vanishes, to the resolution of angles. It does wherever the
        conditions have fewer independent rows than there are gauges: always with 2N + 1 gauges or
        more, and with fewer where phasors depend on each other, as those of two ideal gauges in
        opposite phase do. Otherwise only its least residual is reached.
    residuals : numpy.ndarray
        Amplitude left in each harmonic, shape (harmonics,), in the unit of the amplitudes.
    residuals_equal_gains : numpy.ndarray
        The same with equal gains.
    noise_factor : float
        M sum(g^2) / (sum g)^2: noise power over that of equal gains, for gauges of equal
        sensitivity.
    condition : float
        Largest over smallest non-zero singular value of the conditions.
    negative : tuple of int
        Numbers, from 1, of the gauges with a negative gain: they take torque away.
    warnings : tuple of str
        What to know before these gains are used, a sentence each; empty where nothing is.
    """

    gains: NDArray[np.float64]
    exact: bool
    residuals: NDArray[np.float64]
    residuals_equal_gains: NDArray[np.float64]
    noise_factor: float
    condition: float
    negative: tuple[int, ...] = ()
    warnings: tuple[str, ...] = ()


def compensating_gains(
    conditions: ArrayLike,
    torque_sensitivities: ArrayLike | None = None,
    *,
    most_noise: float = MOST_NOISE,
) -> CompensatingGains:
    """Gains that cancel the fluctuation at the least noise. Godler 2000, section III-B.

    Where the conditions leave a choice (M > 2N + 1) the gains with the least noise at the same
    torque signal are taken; where they leave none but zero (M < 2N + 1), those with the least
    residual.

    M >= 2N + 1 guarantees a solution, not a useful one: gauges that see nearly the same wave cancel
    it with large gains of both signs, which nearly cancel the torque as well. Averaging M gauges
    divides the noise power by M and such gains multiply it by the noise factor: from a factor of M
    on, all gauges together are noisier than one alone. The limit of 10, noise of 3.2 times the
    amplitude, has left that behind with up to nine gauges (four harmonics); errors of the gains
    are magnified like noise. Below it, what is unusual is said in `CompensatingGains.warnings`.

    Parameters
    ----------
    conditions : array_like
        A from `compensation_conditions`, shape (2 harmonics, gauges).
    torque_sensitivities : array_like, optional
        t_j, signal of each gauge per Nm in any common unit, shape (gauges,); equal without. The
        gains keep t.g = sum(t).
    most_noise : float
        Largest noise factor that is accepted, at least 1; infinite accepts any.

    Returns
    -------
    CompensatingGains
        Gains, residual, noise factor, condition, negative gains, warnings.

    Raises
    ------
    InputError
        If the gains would cancel the torque as well, or raise the noise above the limit.
    """
    matrix = _checked_conditions(conditions)
    gauges = matrix.shape[1]
    torque = _checked_sensitivities(torque_sensitivities, gauges)
    limit = real_number("most_noise", most_noise)
    if not limit >= 1:
        raise InputError(
            f"most_noise = {limit:g}: expected at least 1, the noise factor of equal gains; give a "
            "larger number"
        )
    scale = float(np.abs(matrix).max()) or 1.0
    _, singular, right = np.linalg.svd(matrix / scale)
    rank = int(np.sum(singular > ROUNDING_OF_ANGLES * singular[0]))
    exact = rank < gauges
    if exact:
        direction = right[rank:].T @ (right[rank:] @ torque)
    else:
        # (A' A)^-1 t by singular values, because A' A squares the condition number.
        direction = right.T @ ((right @ torque) * (singular[-1] / singular[:gauges]) ** 2)
    signal = float(torque @ direction)
    if signal <= 1e-9 * float(torque @ torque) and exact:
        raise InputError(
            "gains that cancel this fluctuation cancel the torque as well: expected phasors "
            "of the gauges that point apart; move or add a gauge"
        )
    gains = direction * float(np.sum(torque)) / signal
    # At the torque of equal gains; with equal sensitivities this is the noise factor itself.
    noise_power = float(np.mean(gains**2))
    if noise_power > limit:
        shown = ", ".join(f"{gain:.3g}" for gain in gains)
        raise InputError(
            f"gains against this fluctuation, [{shown}], raise the noise power to "
            f"{noise_power:.3g} times that of equal gains: expected at most {limit:g} times, "
            "because gauges that see nearly the same wave cannot tell it from torque; move the "
            "gauges apart, add one, compensate fewer harmonics, or raise most_noise"
        )
    negative = tuple(int(j) + 1 for j in np.flatnonzero(gains < 0))
    residuals = scale * _amplitudes(matrix / scale @ gains)
    return CompensatingGains(
        gains=gains,
        exact=exact,
        residuals=residuals,
        residuals_equal_gains=scale * _amplitudes(matrix / scale @ np.ones(gauges)),
        noise_factor=_core.Gains(gains.tolist()).noise_factor,
        condition=float(singular[0] / singular[rank - 1]) if rank else 1.0,
        negative=negative,
        warnings=warnings_of(gains, noise_power)
        + (() if exact else (_least_residual_warning(gauges, residuals),)),
    )


def _checked_conditions(conditions: ArrayLike) -> NDArray[np.float64]:
    matrix = contiguous("conditions", conditions, np.float64, dimensions=2)
    rows, gauges = matrix.shape
    if rows < 2 or rows % 2 or gauges < 1:
        raise InputError(
            f"conditions has the shape {matrix.shape}: expected two rows a harmonic, of sine and "
            "cosine, and a column a gauge; make it with compensation_conditions"
        )
    require_finite("conditions", matrix, "row", "column")
    return matrix


def _checked_sensitivities(values: ArrayLike | None, gauges: int) -> NDArray[np.float64]:
    if values is None:
        return np.ones(gauges)
    torque = contiguous("torque_sensitivities", values, np.float64).copy()
    if torque.shape != (gauges,) or not np.all(np.isfinite(torque)) or not np.any(torque):
        raise InputError(
            f"torque_sensitivities = {torque.tolist()}: expected {gauges} finite numbers, not all "
            "0, one a gauge; measure them with a known load"
        )
    torque /= np.abs(torque).max()
    if abs(float(np.sum(torque))) <= 1e-9 * float(np.sum(np.abs(torque))):
        raise InputError(
            "torque_sensitivities add up to 0: expected gauges whose sum carries torque; reverse "
            "the signs of gauges that are wired the other way round"
        )
    return torque


def warnings_of(gains: NDArray[np.float64], noise_power: float) -> tuple[str, ...]:
    """Say what is unusual about gains, whatever they were solved from.

    Parameters
    ----------
    gains : numpy.ndarray
        g_j, shape (gauges,).
    noise_power : float
        Noise power over that of equal gains at the same torque signal.

    Returns
    -------
    tuple of str
        A sentence each; empty where nothing is.
    """
    found = []
    negative = np.flatnonzero(gains < 0) + 1
    if len(negative):
        which = ", ".join(map(str, negative))
        found.append(
            f"Gauges with a negative gain, {which} of {len(gains)}, take torque away from the sum: "
            "check their sign and position, or move them away from the others."
        )
    if noise_power > NOTEWORTHY_NOISE:
        found.append(
            f"The noise power is {noise_power:.3g} times that of equal gains: the gauges see "
            "waves that are alike; move them apart or add one."
        )
    return tuple(found)


def _least_residual_warning(gauges: int, residuals: NDArray[np.float64]) -> str:
    left = ", ".join(f"{residual:.3g}" for residual in residuals)
    needed = minimum_gauges(len(residuals))
    return (
        f"The fluctuation does not vanish, amplitudes of {left} are left: {gauges} gauges are "
        f"fewer than the {needed} that cancel every wave of {len(residuals)} harmonic(s)."
    )


def _amplitudes(components: NDArray[np.float64]) -> NDArray[np.float64]:
    pairs = components.reshape(-1, 2)
    return np.hypot(pairs[:, 0], pairs[:, 1])
