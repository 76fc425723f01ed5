"""Godler et al. 2000, fig. 8 and eq. (10): vectors that gains can close, and how many it takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave.calibrate.fluctuation import (
    compensation_conditions,
    enough_gauges,
    equally_spaced_positions_rad,
    minimum_gauges,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Phasor:
    """One gauge's vector in the diagram of fig. 8.

    Attributes
    ----------
    sine, cosine : float
        What multiplies sin(2 m beta) and cos(2 m beta), times the gauge's gain.
    """

    sine: float
    cosine: float


@dataclass(frozen=True)
class GaugeCount:
    """Whether M gauges cancel N harmonics.

    Attributes
    ----------
    gauges, harmonics : int
        M and N.
    enough : bool
        Eq. (10).
    solutions : int
        Dimension of the null space of eq. (9) for careless gauges.
    """

    gauges: int
    harmonics: int
    enough: bool
    solutions: int


def vectors(
    amplitudes: tuple[float, ...], phases_rad: NDArray[np.float64], gains: NDArray[np.float64]
) -> tuple[Phasor, ...]:
    """Vectors of the basic frequency, gains included.

    Parameters
    ----------
    amplitudes : tuple of float
        a_1j of the gauges.
    phases_rad : numpy.ndarray
        psi_1j, shape (gauges,), rad.
    gains : numpy.ndarray
        g_j, shape (gauges,).

    Returns
    -------
    tuple of Phasor
        One a gauge.
    """
    positions = equally_spaced_positions_rad(len(amplitudes))
    matrix = compensation_conditions([amplitudes], phases_rad[np.newaxis], positions) * gains
    return tuple(Phasor(float(sine), float(cosine)) for sine, cosine in matrix.T)


def gauge_counts() -> tuple[GaugeCount, ...]:
    """Count the solutions of eq. (9) for gauges bonded without care.

    Returns
    -------
    tuple of GaugeCount
        One gauge too few and just enough for one to three harmonics; amplitudes scatter by 15 %,
        phases by 10 degrees.
    """
    generator = np.random.default_rng(2000)
    counts = []
    for harmonics in (1, 2, 3):
        for gauges in (minimum_gauges(harmonics) - 1, minimum_gauges(harmonics)):
            matrix = compensation_conditions(
                generator.normal(1.0, 0.15, (harmonics, gauges)),
                generator.normal(0.0, np.deg2rad(10.0), (harmonics, gauges)),
                equally_spaced_positions_rad(gauges),
            )
            counts.append(
                GaugeCount(
                    gauges,
                    harmonics,
                    enough_gauges(gauges, harmonics),
                    gauges - int(np.linalg.matrix_rank(matrix)),
                )
            )
    return tuple(counts)
