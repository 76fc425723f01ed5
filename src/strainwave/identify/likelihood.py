"""How likely a recording's innovations are under a configuration of the ripple filter.

Student's t with four degrees of freedom and a free scale, because contacts are no noise, over rows
in motion, the first eighth left out for learning.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.batch_ripple import RippleBatch, pairs_of
from strainwave.ripple_filter import RippleFilter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.samples import Samples

DEGREES_OF_FREEDOM: Final = 4.0
_SLOPE: Final = 0.5 * (DEGREES_OF_FREEDOM + 1)
#: Share of the rows in motion that is left for learning.
LEARNING_SHARE: Final = 1 / 8
#: Stretches of a recording that are taken for independent where rows are not.
BLOCKS: Final = 30
#: Range of the scale's logarithm, and the step at which its search ends: the likelihood is flat there.
_LOG_SCALES: Final = (-20.0, 20.0)
_LOG_SCALE_STEP: Final = 1e-6
_MOST_STEPS: Final = 60
#: Threads that share candidates: as many as the least of computers has cores.
_THREADS: Final = 2


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
        log_scale = _most_likely_log_scale(squares)
        likelihoods: NDArray[np.float64] = -_SLOPE * np.log1p(squares * np.exp(-log_scale))
        return likelihoods - 0.5 * (log_scale + np.log(self.variance_Nm2))


def _most_likely_log_scale(squares: NDArray[np.float64]) -> float:
    """Find where the likelihood's slope is 0: Newton's steps, and halves where they leave the range."""
    lowest, highest = _LOG_SCALES
    log_scale = 0.0
    for _ in range(_MOST_STEPS):
        scaled = squares * np.exp(-log_scale)
        weights = scaled / (1.0 + scaled)
        # The slope falls everywhere, from above 0 to -1/2.
        slope = _SLOPE * float(np.mean(weights)) - 0.5
        curvature = _SLOPE * float(np.mean(weights * (1.0 - weights)))
        lowest, highest = (log_scale, highest) if slope > 0.0 else (lowest, log_scale)
        step = slope / curvature if curvature > 0.0 else np.inf
        following = log_scale + step
        if not lowest <= following <= highest:
            following = 0.5 * (lowest + highest)
        done = abs(following - log_scale) < _LOG_SCALE_STEP
        log_scale = following
        if done:
            break
    return log_scale


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
    return _in_motion(result.innovation_Nm, result.innovation_variance_Nm2, result.status)


def innovations_of_all(
    excerpt: Samples, configs: Sequence[_core.RippleFilterConfig]
) -> list[Innovations]:
    """Run several filters over a recording side by side, in vector lanes.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording.
    configs : sequence of RippleFilterConfig
        The filters.

    Returns
    -------
    list of Innovations
        As `innovations` gives for each, to rounding.
    """
    count = len(configs)
    if any(pairs_of(config) > _core.MOST_LANE_PAIRS for config in configs):
        return [innovations(excerpt, config) for config in configs]
    found = RippleBatch(configs).innovations(
        [excerpt.time_s] * count,
        [excerpt.motor_angle_rad] * count,
        [excerpt.torque_Nm] * count,
        expected_torque_Nm=[excerpt.expected_torque_Nm] * count,
        threads=_THREADS,
    )
    return [
        _in_motion(*each)
        for each in zip(
            found.innovation_Nm, found.innovation_variance_Nm2, found.status, strict=True
        )
    ]


def _in_motion(
    innovation_Nm: NDArray[np.float64],
    variance_Nm2: NDArray[np.float64],
    status: NDArray[np.uint32],
) -> Innovations:
    at_rest = (status & np.uint32(_core.StatusFlag.at_rest.value)) != 0
    rows = np.flatnonzero((variance_Nm2 > 0) & ~at_rest)
    rows = rows[int(LEARNING_SHARE * len(rows)) :]
    return Innovations(rows, innovation_Nm[rows], variance_Nm2[rows])


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
