"""How much of the scatter of gains lies within groups of experiments, how much between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from strainwave.calibrate.torque import Consistency, consistency

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class VarianceComponents:
    """One-way analysis of variance with random groups.

    Attributes
    ----------
    within : float
        Standard deviation within a group, relative to the mean: repeatability of the gain.
    between : float
        Standard deviation of the groups' true means, relative: what another group adds; 0 where
        the groups scatter no more than their members.
    groups : int
        Number of groups.
    p_value : float
        Of the F-test that the groups scatter no more than their members.
    of_groups : Consistency
        What the means of the groups say of the gain, one of each group: the honest statement where
        groups differ, because members of one group are no independent experiments then.
    """

    within: float
    between: float
    groups: int
    p_value: float
    of_groups: Consistency


def variance_components(gains: ArrayLike, groups: Sequence[object]) -> VarianceComponents | None:
    """Part the scatter of gains.

    Parameters
    ----------
    gains : array_like
        Gain of each experiment, shape (experiments,).
    groups : sequence
        Which group each belongs to: its position, or its mounting.

    Returns
    -------
    VarianceComponents or None
        None for fewer than two groups, or where no group has two experiments.
    """
    values = np.asarray(gains, np.float64)
    _, place = np.unique(np.array([str(group) for group in groups]), return_inverse=True)
    sizes = np.bincount(place)
    number, count = len(sizes), len(values)
    if number < 2 or count == number:
        return None
    mean = float(values.mean())
    means = np.bincount(place, values) / sizes
    within = float(np.sum((values - means[place]) ** 2)) / (count - number)
    between = float(np.sum(sizes * (means - mean) ** 2)) / (number - 1)
    typical = (count - float(np.sum(sizes**2)) / count) / (number - 1)
    return VarianceComponents(
        float(np.sqrt(within)) / abs(mean),
        float(np.sqrt(max(0.0, (between - within) / typical))) / abs(mean),
        number,
        float(stats.f.sf(between / within, number - 1, count - number)) if within > 0 else 0.0,
        consistency(means),
    )
