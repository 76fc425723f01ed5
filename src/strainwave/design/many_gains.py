"""Compensating gains of many layouts at once, as `calibrate.gains` finds them for one.

With as many gauges as Godler et al. 2000, eq. (11), asks for, the quietest null vector of eq. (9) is
what the vector of equal gains has left outside the row space of A; with fewer, the gains of least
residual are (A' A)^-1 t.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.calibrate.fluctuation import enough_gauges
from strainwave.calibrate.gains import ROUNDING_OF_ANGLES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    ComplexArray = NDArray[np.complex128]


def gains_of_layouts(phasors: ComplexArray) -> FloatArray:
    """Gains against the given harmonics, for gauges taken to see torque alike.

    Parameters
    ----------
    phasors : numpy.ndarray
        Of the harmonics to cancel, shape (layouts, harmonics, gauges).

    Returns
    -------
    numpy.ndarray
        g_j, shape (layouts, gauges), sum M. Gains of a layout that cancels torque altogether are
        not finite.
    """
    layouts, harmonics, gauges = phasors.shape
    conditions = np.empty((layouts, gauges, 2 * harmonics + 1))
    conditions[:, :, 0:-1:2] = phasors.real.swapaxes(1, 2)
    conditions[:, :, 1:-1:2] = phasors.imag.swapaxes(1, 2)
    conditions[:, :, -1] = 1.0
    if enough_gauges(gauges, harmonics):
        # Equal gains, orthogonalised against every condition: the last column of Q.
        direction = np.linalg.qr(conditions).Q[:, :, -1]
    else:
        direction = _least_residual(conditions[:, :, :-1])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        gains: FloatArray = direction * (gauges / direction.sum(axis=1, keepdims=True))
    return gains


def _least_residual(conditions: FloatArray) -> FloatArray:
    _, singular, right = np.linalg.svd(conditions.swapaxes(1, 2))
    along = right.sum(axis=2)
    gauges = right.shape[1]
    missing = singular <= ROUNDING_OF_ANGLES * singular[:, :1]
    padded = np.ones((len(along), gauges), dtype=bool)
    padded[:, : singular.shape[1]] = missing
    # Where something cancels exactly, the quietest of that; elsewhere (A' A)^-1 t.
    smallest = singular[:, -1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = np.where(padded.any(axis=1, keepdims=True), padded, (smallest / singular) ** 2)
    direction: FloatArray = np.einsum("bk,bkm->bm", along * weights, right)
    return direction


def noise_factors(gains: FloatArray) -> FloatArray:
    """Noise power over that of equal gains, M sum(g^2) / (sum g)^2.

    Parameters
    ----------
    gains : numpy.ndarray
        Shape (layouts, gauges).

    Returns
    -------
    numpy.ndarray
        Shape (layouts,).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        factors: FloatArray = gains.shape[1] * np.sum(gains**2, axis=1) / np.sum(gains, axis=1) ** 2
    return factors
