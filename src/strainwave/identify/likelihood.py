"""How likely a recording's innovations are under a configuration of the ripple filter.

Student's t with four degrees of freedom and a free scale, because contacts are no noise, over rows
in motion, the first eighth left out for learning.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.optimize import minimize_scalar

from strainwave import _core
from strainwave.ripple_filter import RippleFilter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.samples import Samples

DEGREES_OF_FREEDOM: Final = 4.0
#: Share of the rows in motion that is left for learning.
LEARNING_SHARE: Final = 1 / 8
#: Stretches of a recording that are taken for independent where rows are not.
BLOCKS: Final = 30


@dataclass(frozen=True)
class Innovations:
    """Innovations of the rows in motion, after the time for learning.

    Attributes
    ----------
    rows : numpy.ndarray
        Their numbers in the recording, shape (rows,).
    innovation_Nm, variance_Nm2 : numpy.ndarray
        Innovations, and the variances that the filter expects, shape (rows,).
    """

    rows: NDArray[np.intp]
    innovation_Nm: NDArray[np.float64]
    variance_Nm2: NDArray[np.float64]

    def likelihoods(self) -> NDArray[np.float64]:
        """Compute how likely each row's innovation is, the scale profiled out.

        Returns
        -------
        numpy.ndarray
            Logarithm of each row's likelihood, up to a constant, shape (rows,).
        """
        squares = self.innovation_Nm**2 / self.variance_Nm2 / DEGREES_OF_FREEDOM
        slope = 0.5 * (DEGREES_OF_FREEDOM + 1)

        def cost(log_scale: float) -> float:
            return slope * float(np.mean(np.log1p(squares * np.exp(-log_scale)))) + 0.5 * log_scale

        log_scale = float(minimize_scalar(cost, bounds=(-20.0, 20.0), method="bounded").x)
        likelihoods: NDArray[np.float64] = -slope * np.log1p(squares * np.exp(-log_scale))
        return likelihoods - 0.5 * (log_scale + np.log(self.variance_Nm2))


def innovations(excerpt: Samples, config: _core.RippleFilterConfig) -> Innovations:
    """Run the filter over a recording.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording.
    config : RippleFilterConfig
        The filter.

    Returns
    -------
    Innovations
        Of the rows in motion after learning.
    """
    result = RippleFilter(config).process(
        excerpt.time_s,
        excerpt.motor_angle_rad,
        excerpt.torque_Nm,
        expected_torque_Nm=excerpt.expected_torque_Nm,
    )
    at_rest = (result.status & np.uint32(_core.StatusFlag.at_rest.value)) != 0
    rows = np.flatnonzero((result.innovation_variance_Nm2 > 0) & ~at_rest)
    rows = rows[int(LEARNING_SHARE * len(rows)) :]
    return Innovations(rows, result.innovation_Nm[rows], result.innovation_variance_Nm2[rows])


def row_likelihoods(excerpt: Samples, config: _core.RippleFilterConfig) -> NDArray[np.float64]:
    """Compute how likely each row's innovation is.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording.
    config : RippleFilterConfig
        The filter.

    Returns
    -------
    numpy.ndarray
        Logarithm of the likelihood of each row in motion after learning, up to a constant.
    """
    return innovations(excerpt, config).likelihoods()


def block_sums(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Add up rows within stretches of the recording.

    Parameters
    ----------
    values : numpy.ndarray
        One for each row, shape (rows,).

    Returns
    -------
    numpy.ndarray
        Sums over `BLOCKS` consecutive stretches.
    """
    return np.array([np.sum(part) for part in np.array_split(values, BLOCKS)])


def standardized_gain(gains: NDArray[np.float64]) -> float:
    """Compare a gain with how far its parts disagree.

    Parameters
    ----------
    gains : numpy.ndarray
        Gains of independent stretches, shape (stretches,).

    Returns
    -------
    float
        Their mean over its standard uncertainty; 0 for fewer than two.
    """
    if len(gains) < 2:
        return 0.0
    deviation = float(np.std(gains, ddof=1)) / np.sqrt(len(gains))
    return float(np.mean(gains) / max(deviation, 1e-12))
