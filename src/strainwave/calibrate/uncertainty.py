"""Uncertainty budgets after the GUM: components, effective degrees of freedom, coverage factor.

GUM is JCGM 100:2008, Guide to the expression of uncertainty in measurement.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

LEVEL = 0.95
"""Probability of the intervals."""


@dataclass(frozen=True)
class Component:
    """A source of uncertainty.

    Attributes
    ----------
    name : str
        What it is.
    standard_uncertainty : float
        Its contribution to the result, in the result's unit.
    degrees_of_freedom : float
        Infinite where the uncertainty is taken as known.
    kind : str
        "A" from the scatter of these measurements, "B" from anything else: GUM 4.2 and 4.3.
    """

    name: str
    standard_uncertainty: float
    degrees_of_freedom: float
    kind: str


@dataclass(frozen=True)
class Budget:
    """Combined uncertainty of a result.

    Attributes
    ----------
    components : tuple of Component
        Its sources, taken as uncorrelated.
    combined : float
        Root of the sum of their squares, GUM 5.1.2.
    degrees_of_freedom : float
        Effective ones by Welch and Satterthwaite, GUM G.4.1.
    coverage_factor : float
        Student's t for 95 %.
    expanded : float
        Half width of the 95 % interval.
    """

    components: tuple[Component, ...]
    combined: float
    degrees_of_freedom: float
    coverage_factor: float
    expanded: float


def combine(components: Iterable[Component]) -> Budget:
    """Combine uncorrelated components.

    Parameters
    ----------
    components : iterable of Component
        All in the unit of the result.

    Returns
    -------
    Budget
        Combined and expanded uncertainty. The effective degrees of freedom are not rounded down:
        Student's t is taken at them as they are.
    """
    parts = tuple(components)
    combined = math.hypot(*(part.standard_uncertainty for part in parts))
    freedom = math.inf
    if combined > 0.0:
        share = sum(
            (part.standard_uncertainty / combined) ** 4 / part.degrees_of_freedom for part in parts
        )
        freedom = 1.0 / share if share > 0.0 else math.inf
    quantile = (1.0 + LEVEL) / 2.0
    factor = float(
        stats.norm.ppf(quantile) if math.isinf(freedom) else stats.t.ppf(quantile, freedom)
    )
    return Budget(parts, combined, freedom, factor, factor * combined)


def freedom_text(degrees: str) -> str:
    """Say degrees of freedom.

    Parameters
    ----------
    degrees : str
        Their number.

    Returns
    -------
    str
        The number with its words.
    """
    return f"{degrees} degree{'' if degrees == '1' else 's'} of freedom"


def grubbs_outlier(values: ArrayLike, level: float = 0.05) -> int | None:
    """Find the value that stands out by Grubbs' test, two-sided.

    Parameters
    ----------
    values : array_like
        A sample, shape (values,).
    level : float
        Probability of finding one among normally distributed values.

    Returns
    -------
    int or None
        Its index; None where none stands out, or there are fewer than three values.
    """
    sample = np.asarray(values, np.float64)
    count = len(sample)
    spread = float(np.std(sample, ddof=1)) if count >= 3 else 0.0
    if spread <= 1e-12 * float(np.max(np.abs(sample), initial=0.0)):
        return None
    distance = np.abs(sample - sample.mean()) / spread
    worst = int(np.argmax(distance))
    student = float(stats.t.ppf(1.0 - level / (2 * count), count - 2))
    critical = (count - 1) / math.sqrt(count) * student / math.sqrt(count - 2 + student**2)
    return worst if distance[worst] > critical else None
