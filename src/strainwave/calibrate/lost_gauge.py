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

    from strainwave.calibrate.gains import CompensatingGains


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
    """

    gauge: int
    gains: NDArray[np.float64]
    noise_factor: float


def gains_without_each(
    conditions: Sequence[NDArray[np.float64]],
    torque_sensitivities: NDArray[np.float64],
    *,
    torque_signal: float | None = None,
    most_noise: float = MOST_NOISE,
) -> tuple[tuple[GainsWithoutGauge, ...], tuple[str, ...]]:
    """Solve the gains without each gauge in turn, where enough gauges are left.

    Parameters
    ----------
    conditions : sequence of numpy.ndarray
        A of Godler 2000, eq. (9), of all gauges for the harmonics that the others have to cancel,
        shape (2 harmonics, gauges): one for each recording. Where few gauges would follow several
        recordings with gains that are too noisy, they cancel the mean.
    torque_sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    torque_signal : float, optional
        t.g of the gains of all gauges, which the others keep; sum(t) without.
    most_noise : float
        Largest noise factor that is accepted, against equal gains of the gauges that are left.

    Returns
    -------
    tuple
        The gain sets, none where M - 1 < 2 N + 1; and a sentence for every gauge that cannot be
        lost.

    Raises
    ------
    InputError
        If conditions do not fit the sensitivities.
    """
    gauges = len(torque_sensitivities)
    for matrix in conditions:
        if matrix.ndim != 2 or matrix.shape[1] != gauges:
            raise InputError(
                f"conditions has the shape {matrix.shape}: expected a column for each of "
                f"{gauges} torque_sensitivities; make it with compensation_conditions"
            )
    if not enough_gauges(gauges - 1, len(conditions[0]) // 2):
        return (), ()
    stacked, mean = np.vstack(conditions), np.mean(conditions, axis=0)
    kept = float(torque_sensitivities.sum()) if torque_signal is None else torque_signal
    found, said = [], []
    for lost in range(gauges):
        left = np.arange(gauges) != lost
        try:
            solved = _solved(
                stacked[:, left], mean[:, left], torque_sensitivities[left], most_noise
            )
        except InputError as error:
            said.append(f"Without gauge {lost + 1} no gains are stored: {error}")
            continue
        gains = np.zeros(gauges)
        # Not by the sum of the others: what is calibrated with all gauges holds without one.
        signal = float(torque_sensitivities[left] @ solved.gains)
        gains[left] = solved.gains * (kept / signal)
        noise = gauges * float(np.sum(gains**2)) / float(np.sum(gains)) ** 2
        found.append(GainsWithoutGauge(lost + 1, gains, noise))
    return tuple(found), tuple(said)


def _solved(
    stacked: NDArray[np.float64],
    mean: NDArray[np.float64],
    torque_sensitivities: NDArray[np.float64],
    most_noise: float,
) -> CompensatingGains:
    try:
        return compensating_gains(stacked, torque_sensitivities, most_noise=most_noise)
    except InputError:
        return compensating_gains(mean, torque_sensitivities, most_noise=most_noise)
