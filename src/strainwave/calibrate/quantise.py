"""The gains of a circuit that serve best.

Gains rounded one by one leave more than they need to: what counts is their weighted sum, and a
factor common to all gains is taken up by the torque calibration. So roundings to neighbouring
values, and common factors, are tried together.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.calibrate.circuit import Circuit

#: By how much all gains together may be scaled.
COMMON_SCALES: Final = np.linspace(0.9, 1.1, 101)
#: Combinations of neighbouring values that are tried for each common factor.
MOST_COMBINATIONS: Final = 4096


@dataclass(frozen=True)
class QuantisedGains:
    """Gains that a circuit can have.

    Attributes
    ----------
    gains : numpy.ndarray
        Shape (gauges,).
    settings : tuple of str
        How each is set.
    rounded : numpy.ndarray
        The gains rounded one by one, for comparison, shape (gauges,).
    """

    gains: NDArray[np.float64]
    settings: tuple[str, ...]
    rounded: NDArray[np.float64]


def quantise_gains(
    circuit: Circuit,
    gains: NDArray[np.float64],
    conditions: NDArray[np.float64],
    torque_sensitivities: NDArray[np.float64],
    *,
    common_scales: NDArray[np.float64] = COMMON_SCALES,
) -> QuantisedGains:
    """Choose gains of a circuit that leave the least fluctuation for the torque they pass.

    Parameters
    ----------
    circuit : Circuit
        What gains can be set to.
    gains : numpy.ndarray
        Gains as solved, shape (gauges,).
    conditions : numpy.ndarray
        Conditions of the harmonics to cancel, of all runs, shape (rows, gauges).
    torque_sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    common_scales : numpy.ndarray
        Factors that all gains together may be scaled by.

    Returns
    -------
    QuantisedGains
        The choice; never worse than gains rounded one by one.

    Raises
    ------
    InputError
        If a gain lies outside what the circuit can do.
    """
    _require_range(circuit, gains)
    rounded = circuit.nearest(gains)
    best, least = rounded, float(_left(rounded, conditions, torque_sensitivities))
    width = next(k for k in (5, 3, 2, 1) if k ** len(gains) <= MOST_COMBINATIONS or k == 1)
    for scale in common_scales:
        if width > 1:
            choices = circuit.neighbours(scale * gains, width)
            tried = np.array(list(itertools.product(*choices)))
            left = _left(tried, conditions, torque_sensitivities)
            found, amount = tried[np.argmin(left)], float(left.min())
        else:
            found, amount = _descended(circuit, scale * gains, conditions, torque_sensitivities)
        if amount < least:
            best, least = found, amount
    settings = tuple(circuit.setting(float(gain)) for gain in best)
    return QuantisedGains(best, settings, rounded)


def _require_range(circuit: Circuit, gains: NDArray[np.float64]) -> None:
    low, high = circuit.values[0], circuit.values[-1]
    sized = np.abs(gains) if circuit.has_both_signs else gains
    for j in np.flatnonzero((sized < low) | (sized > high)):
        raise InputError(
            f"--quantise: gauge {j + 1} needs a gain of {gains[j]:.4g}, and the circuit has gains "
            f"from {low:g} to {high:g}; expected a range that holds all gains, so choose another "
            "circuit or move the gauge"
        )


def _left(
    gains: NDArray[np.float64], conditions: NDArray[np.float64], torque: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Squared fluctuation over squared torque signal, for one set of gains or many."""
    return np.asarray(np.sum((gains @ conditions.T) ** 2, axis=-1) / (gains @ torque) ** 2)


def _descended(
    circuit: Circuit,
    gains: NDArray[np.float64],
    conditions: NDArray[np.float64],
    torque: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    """For many gauges: pairs of gains are moved together as long as that helps."""
    choices = circuit.neighbours(gains, 3)
    best = choices[:, 0].copy()
    least = float(_left(best, conditions, torque))
    improved = True
    while improved:
        improved = False
        for first, second in itertools.combinations(range(len(gains)), 2):
            tried = np.tile(best, (9, 1))
            pairs = np.array(list(itertools.product(choices[first], choices[second])))
            tried[:, [first, second]] = pairs
            left = _left(tried, conditions, torque)
            if left.min() < least * (1 - 1e-12):
                best, least, improved = tried[np.argmin(left)], float(left.min()), True
    return best, least
