"""Gains solved beforehand for the loss of one gauge: with M - 1 >= 2 N + 1 the others suffice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave.calibrate.fluctuation import enough_gauges
from strainwave.calibrate.gains import MOST_NOISE, compensating_gains
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.fluctuation_run import FluctuationRun


@dataclass(frozen=True)
class GainsWithoutGauge:
    """Gains to use when one gauge has failed.

    Attributes
    ----------
    gauge : int
        Number of the gauge, from 1.
    gains : numpy.ndarray
        A gain for every gauge, 0 for the one that has failed, shape (gauges,); the torque signal
        stays what it is with all gauges.
    noise_factor : float
        M sum(g^2) / (sum g)^2 with all M gauges counted.
    residual_after : numpy.ndarray
        Amplitude left in each harmonic that was fitted, the largest over the runs, shape
        (harmonics,).
    """

    gauge: int
    gains: NDArray[np.float64]
    noise_factor: float
    residual_after: NDArray[np.float64]


def gains_without_each(
    runs: Sequence[FluctuationRun],
    harmonics: Sequence[int],
    torque_sensitivities: NDArray[np.float64],
    *,
    most_noise: float = MOST_NOISE,
) -> tuple[tuple[GainsWithoutGauge, ...], tuple[str, ...]]:
    """Solve the gains without each gauge in turn, where enough gauges are left.

    Parameters
    ----------
    runs : sequence of FluctuationRun
        One run, or one for every condition.
    harmonics : sequence of int
        Harmonics to cancel, from 1.
    torque_sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    most_noise : float
        Largest noise factor that is accepted, against equal gains of the gauges that are left.

    Returns
    -------
    tuple
        The gain sets, none where M - 1 < 2 N + 1; and a sentence for every gauge that cannot be
        lost.
    """
    gauges = len(torque_sensitivities)
    if gauges < 3 or not enough_gauges(gauges - 1, len(harmonics)):
        return (), ()
    conditions = np.vstack([run.conditions(harmonics) for run in runs])
    found, said = [], []
    for lost in range(gauges):
        left = np.arange(gauges) != lost
        try:
            solved = compensating_gains(
                conditions[:, left], torque_sensitivities[left], most_noise=most_noise
            )
        except InputError as error:
            said.append(f"Without gauge {lost + 1} no gains are stored: {error}")
            continue
        gains = np.zeros(gauges)
        share = torque_sensitivities.sum() / torque_sensitivities[left].sum()
        gains[left] = solved.gains * share
        after = np.max([np.abs(run.weighted_sum(gains)) for run in runs], axis=0)
        noise = gauges * float(np.sum(gains**2)) / float(np.sum(gains)) ** 2
        found.append(GainsWithoutGauge(lost + 1, gains, noise, after))
    return tuple(found), tuple(said)
