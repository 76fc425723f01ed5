"""Monte Carlo of gauge layouts: what is left of the wave, how noisy, and how many meet a limit.

Every layout has its own errors. Untuned it is used with equal gains; tuned, with gains solved from
what a calibration run measured of its own wave (Godler et al. 2000, eq. 9), as a circuit can have
them. Torque is calibrated afterwards, so that residuals are in % of the layout's own full scale.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.design.batch import PARTS, Batch, worst_outcome
from strainwave.design.checks import count_within, number_within

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from strainwave.design.batch import Outcome
    from strainwave.design.case import LayoutCase

MOST_TRIALS: Final = 10_000_000
#: Layouts that are in memory at once; the same whatever the machine, so that a seed means the same.
_BATCH: Final = 10_000
PERCENTILES: Final = (5, 50, 95)


@dataclass(frozen=True)
class Distribution:
    """How a sensor of many layouts does.

    Attributes
    ----------
    residual_FS, noise_factor : dict of int to float
        Percentiles; the residual is the sum of the amplitudes left in all harmonics, zero to peak:
        the largest it can be, whatever the phases between harmonics.
    negative_gain_share : float
        Share of layouts with a negative gain.
    refused_share : float
        Share of layouts whose gains raise the noise above the limit, or cancel torque.
    met_limit : float
        Yield: share of layouts that are not refused and whose residual is within the limit.
    met_limit_error : float
        Its standard error, of the number of trials.
    """

    residual_FS: dict[int, float]
    noise_factor: dict[int, float]
    negative_gain_share: float
    refused_share: float
    met_limit: float
    met_limit_error: float


@dataclass(frozen=True)
class LayoutStudy:
    """What the layouts of one case are worth.

    Attributes
    ----------
    case : LayoutCase
        What was studied.
    trials, seed : int
        How many layouts, and of which chance.
    limit_FS : float
        Limit of the residual.
    tuned, untuned : Distribution
        With gains solved for each layout, and with equal gains.
    lost_tuned, lost_untuned : Distribution or None
        The same after losing the gauge whose loss is worst, with the gains solved again.
    parts_FS : dict
        Percentiles of what the tuned residual consists of: "above_N", harmonics that no gains were
        solved against; "up_to_N_solved", what solved gains leave of the others (too few gauges,
        measurement error); "up_to_N", the same with the gains that the circuit has.
    """

    case: LayoutCase
    trials: int
    seed: int
    limit_FS: float
    tuned: Distribution
    untuned: Distribution
    lost_tuned: Distribution | None
    lost_untuned: Distribution | None
    parts_FS: dict[str, dict[int, float]]


def study_layout(
    case: LayoutCase, limit_FS: float, trials: int = 100_000, seed: int = 1
) -> LayoutStudy:
    """Draw layouts and say what they are worth.

    Parameters
    ----------
    case : LayoutCase
        What to study.
    limit_FS : float
        Limit of the residual, %FS zero to peak, above 0.
    trials : int
        Layouts, up to 10 million; 32 bytes of memory each, 52 with a lost gauge.
    seed : int
        Seed of everything random.

    Returns
    -------
    LayoutStudy
        Percentiles and shares.

    Raises
    ------
    InputError
        If a value cannot be used.
    """
    trials = count_within("trials", trials, 1, MOST_TRIALS)
    seed = count_within("seed", seed, 0, 2**63 - 1)
    limit_FS = number_within("limit_FS", limit_FS, "%FS", 1e-9, 1e6)
    names = ("tuned", "untuned", *(("lost_tuned", "lost_untuned") if case.lost_gauge else ()))
    kept = {name: _Kept.of(trials) for name in names}
    parts = {name: np.empty(trials, np.float32) for name in PARTS}
    generator = np.random.default_rng(seed)
    for rows in _batches(trials):
        batch = Batch.drawn(case, generator, rows.stop - rows.start)
        kept["untuned"].put(rows, batch.equal())
        found, of_parts = batch.tuned_with_parts()
        kept["tuned"].put(rows, found)
        for name, values in of_parts.items():
            parts[name][rows] = values
        if case.lost_gauge:
            kept["lost_tuned"].put(rows, worst_outcome([each.tuned() for each in batch.losses()]))
            kept["lost_untuned"].put(rows, worst_outcome([each.equal() for each in batch.losses()]))
    results = {name: each.distribution(limit_FS) for name, each in kept.items()}
    return LayoutStudy(
        case,
        trials,
        seed,
        limit_FS,
        results["tuned"],
        results["untuned"],
        results.get("lost_tuned"),
        results.get("lost_untuned"),
        {name: percentiles(values) for name, values in parts.items()},
    )


def percentiles(values: NDArray[np.float32]) -> dict[int, float]:
    """Percentiles 5, 50 and 95.

    Parameters
    ----------
    values : numpy.ndarray
        One a layout.

    Returns
    -------
    dict of int to float
        By percentile.
    """
    found = np.percentile(values, PERCENTILES, method="inverted_cdf")
    return dict(zip(PERCENTILES, map(float, found), strict=True))


def _batches(trials: int) -> Iterator[slice]:
    for start in range(0, trials, _BATCH):
        yield slice(start, min(start + _BATCH, trials))


@dataclass(frozen=True)
class _Kept:
    """What is kept of every layout, single precision."""

    residual_FS: NDArray[np.float32]
    noise_factor: NDArray[np.float32]
    negative: NDArray[np.bool_]
    refused: NDArray[np.bool_]

    @classmethod
    def of(cls, trials: int) -> _Kept:
        return cls(
            np.empty(trials, np.float32),
            np.empty(trials, np.float32),
            np.empty(trials, np.bool_),
            np.empty(trials, np.bool_),
        )

    def put(self, rows: slice, outcome: Outcome) -> None:
        # A layout that cancels torque altogether has no finite residual; the largest float stands
        # for it, so that every percentile is a number.
        largest = np.finfo(np.float32).max
        for name in ("residual_FS", "noise_factor"):
            values = getattr(outcome, name)
            getattr(self, name)[rows] = np.fmin(np.where(np.isnan(values), np.inf, values), largest)
        self.negative[rows] = outcome.negative
        self.refused[rows] = outcome.refused

    def distribution(self, limit_FS: float) -> Distribution:
        met = float(np.mean((self.residual_FS <= limit_FS) & ~self.refused))
        return Distribution(
            percentiles(self.residual_FS),
            percentiles(self.noise_factor),
            float(np.mean(self.negative)),
            float(np.mean(self.refused)),
            met,
            float(np.sqrt(met * (1 - met) / len(self.refused))),
        )
