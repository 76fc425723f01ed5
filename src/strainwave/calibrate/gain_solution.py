"""Gains from fitted runs: one run or a grid of loads and temperatures, with uncertainties.

One run is solved as in Godler et al. 2000, section III-B. Over a grid no gains cancel every
condition's wave exactly; those with the least expected residual are taken, the uncertainty of the
fitted phasors included, so that spare gauges are not spent on noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from strainwave.calibrate.degenerate import reasons
from strainwave.calibrate.gains import MOST_NOISE, compensating_gains, warnings_of
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from strainwave.calibrate.fluctuation_run import FluctuationRun

OverGrid = Literal["sum", "worst"]

#: Rounds of weights for the least worst residual.
WEIGHT_ROUNDS: Final = 200
#: Step of the numerical derivative of gains, relative to the largest phasor; well above the
#: rounding of angles, 3e-8.
DERIVATIVE_STEP: Final = 1e-5


@dataclass(frozen=True)
class GainSolution:
    """Gains, how well they are known, and what they leave.

    Attributes
    ----------
    gains : numpy.ndarray
        g_j, shape (gauges,); t.g = sum(t).
    standard_uncertainties : numpy.ndarray
        Of the gains, from that of the phasors, shape (gauges,).
    is_exact : bool
        Whether the chosen harmonics vanish in the runs that the gains come from.
    harmonics : tuple of int
        Harmonics that are cancelled.
    noise_factor : float
        M sum(g^2) / (sum g)^2.
    condition_number : float
        Of the conditions.
    residual_before, residual_after : numpy.ndarray
        Amplitude of the sum with equal gains and with these, shape (runs, harmonics fitted).
    residual_standard_uncertainties : numpy.ndarray
        Of the phasor of the weighted sum, root mean square of its two parts, same shape.
    warnings : tuple of str
        What is unusual.
    """

    gains: NDArray[np.float64]
    standard_uncertainties: NDArray[np.float64]
    is_exact: bool
    harmonics: tuple[int, ...]
    noise_factor: float
    condition_number: float
    residual_before: NDArray[np.float64]
    residual_after: NDArray[np.float64]
    residual_standard_uncertainties: NDArray[np.float64]
    warnings: tuple[str, ...]

    @property
    def negative(self) -> tuple[int, ...]:
        """Numbers, from 1, of the gauges with a negative gain."""
        return tuple(int(j) + 1 for j in np.flatnonzero(self.gains < 0))


def solve_gains(
    runs: Sequence[FluctuationRun],
    harmonics: Sequence[int],
    torque_sensitivities: ArrayLike | None = None,
    *,
    over_grid: OverGrid = "sum",
    most_noise: float = MOST_NOISE,
) -> GainSolution:
    """Solve the gains that cancel some harmonics in one run, or hold over several.

    Parameters
    ----------
    runs : sequence of FluctuationRun
        One run, or one for every condition; of the same gauges.
    harmonics : sequence of int
        Numbers of the harmonics to cancel, from 1.
    torque_sensitivities : array_like, optional
        t_j, shape (gauges,); equal without.
    over_grid : {"sum", "worst"}
        With several runs: the least sum of squares, or the least worst residual.
    most_noise : float
        Largest noise factor that is accepted.

    Returns
    -------
    GainSolution
        Gains and what they leave.

    Raises
    ------
    InputError
        If the gains would cancel the torque as well or raise the noise above the limit, with the
        reason in this fluctuation.
    """
    parts = [run.conditions(harmonics) for run in runs]
    noise = [_noise_rows(run, harmonics) for run in runs] if len(runs) > 1 else []
    torque = np.ones(parts[0].shape[1])
    if torque_sensitivities is not None:
        torque = np.asarray(torque_sensitivities, dtype=np.float64)
    weights = np.full(len(runs), 1.0 / len(runs))
    if over_grid == "worst" and len(runs) > 1:
        weights = _worst_weights(parts, noise, torque)
    try:
        solved = compensating_gains(_stacked(parts, noise, weights), torque, most_noise=most_noise)
    except InputError as error:
        found = reasons(np.vstack(parts), harmonics)
        raise InputError(f"{error}{'; here ' if found else ''}{'; '.join(found)}") from error
    said = solved.warnings
    if len(runs) > 1:
        said = warnings_of(solved.gains, float(np.mean(solved.gains**2)))
    return GainSolution(
        gains=solved.gains,
        standard_uncertainties=_uncertainties(runs, harmonics, noise, weights, torque),
        is_exact=solved.exact and len(runs) == 1,
        harmonics=tuple(harmonics),
        noise_factor=solved.noise_factor,
        condition_number=solved.condition,
        residual_before=np.array([np.abs(run.weighted_sum(np.ones_like(torque))) for run in runs]),
        residual_after=np.array([np.abs(run.weighted_sum(solved.gains)) for run in runs]),
        residual_standard_uncertainties=np.array(
            [run.sum_standard_uncertainty(solved.gains) for run in runs]
        ),
        warnings=said,
    )


def _stacked(
    parts: Sequence[NDArray[np.float64]],
    noise: Sequence[NDArray[np.float64]],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    """All conditions as one matrix; one run alone is solved as in the paper, without its noise."""
    if not noise:
        return parts[0]
    rows = [np.vstack(pair) for pair in zip(parts, noise, strict=True)]
    return np.vstack([np.sqrt(weight) * row for weight, row in zip(weights, rows, strict=True)])


def _worst_weights(
    parts: Sequence[NDArray[np.float64]],
    noise: Sequence[NDArray[np.float64]],
    torque: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Weights of conditions at which the largest residual is least, by Lawson's rule."""
    weights = np.full(len(parts), 1.0 / len(parts))
    best, least = weights, np.inf
    for _ in range(WEIGHT_ROUNDS):
        gains = compensating_gains(_stacked(parts, noise, weights), torque, most_noise=np.inf).gains
        left = np.array([np.linalg.norm(part @ gains) for part in parts])
        if left.max() < least:
            best, least = weights, float(left.max())
        # A condition counts more as long as it is worse than the others.
        weights = np.maximum(weights * left / max(left.max(), np.finfo(float).tiny), 1e-9)
        weights = weights / weights.sum()
    return best


def _noise_rows(run: FluctuationRun, harmonics: Sequence[int]) -> NDArray[np.float64]:
    """Rows whose squares with gains are the variance of the weighted sum; an even number."""
    gauges = run.phasors.shape[1]
    summed = np.zeros((gauges, gauges))
    for i in harmonics:
        for part in range(2):
            summed += run.covariance[i - 1, part, :, i - 1, part, :]
    values, vectors = np.linalg.eigh(summed)
    rows = np.sqrt(np.maximum(values, 0.0))[:, np.newaxis] * vectors.T
    return np.vstack([rows, np.zeros((gauges % 2, gauges))])


def _uncertainties(
    runs: Sequence[FluctuationRun],
    harmonics: Sequence[int],
    noise: Sequence[NDArray[np.float64]],
    weights: NDArray[np.float64],
    torque: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Find standard uncertainties of gains by their derivatives with respect to every phasor."""
    chosen = np.asarray(harmonics, dtype=int) - 1
    parts = [run.conditions(harmonics) for run in runs]
    step = DERIVATIVE_STEP * max(float(np.abs(part).max()) for part in parts)
    variance = np.zeros(len(torque))
    if step == 0:
        return variance
    for which, run in enumerate(runs):
        slopes = np.empty((*parts[which].shape, len(torque)))
        for place in np.ndindex(parts[which].shape):
            moved = []
            for sign in (1.0, -1.0):
                varied = [part.copy() for part in parts]
                varied[which][place] += sign * step
                matrix = _stacked(varied, noise, weights)
                moved.append(compensating_gains(matrix, torque, most_noise=np.inf).gains)
            slopes[place] = (moved[0] - moved[1]) / (2 * step)
        flat = slopes.reshape(-1, len(torque))
        spread = run.covariance[chosen][:, :, :, chosen].reshape(len(flat), len(flat))
        variance += np.einsum("ak,ab,bk->k", flat, spread, flat)
    return np.sqrt(np.maximum(variance, 0.0))
