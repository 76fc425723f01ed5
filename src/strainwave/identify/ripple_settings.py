"""Memory and terms of the ripple filter from a recording, by the likelihood of its innovations.

Candidates are run over the recording, and the one whose innovations are the most likely is taken. A
longer memory and fewer terms do less to true torque; they are preferred unless there is clear
evidence against them.

Terms in the direction of motion are looked at last. Between reversals they are constants like any
other, so that only the rows after reversals tell whether the ripple differs by direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from strainwave import _core
from strainwave.identify.likelihood import (
    block_sums,
    innovations,
    innovations_of_all,
    standardized_gain,
)
from strainwave.identify.reversals import Reversals, find_reversals

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from strainwave.samples import Samples

#: Memories that are tried, motor turns. Shorter ones follow more ripple and take more true torque;
#: who wants one has to ask for it.
MEMORIES_TURNS: Final = (160.0, 80.0, 40.0, 20.0, 10.0, 5.0, 3.0)
#: Those with which terms in direction are looked at first.
COARSE_MEMORIES_TURNS: Final = (80.0, 20.0)
#: A longer memory is kept while the likelihood of a row falls by no more than this (a ratio's
#: logarithm) behind the best.
TIE: Final = 1e-3
#: A memory is not told from the best one where their likelihoods differ by no more than so many
#: standard uncertainties of the difference.
COVERAGE: Final = 2.0
#: Terms have to gain this much per row, and so much per coefficient over all rows.
LEAST_GAIN: Final = 0.006
LEAST_GAIN_OF_A_COEFFICIENT: Final = 25.0
#: Rows in motion and motor turns, below which the standard is kept; terms need more.
LEAST_ROWS: Final = 500
LEAST_TURNS: Final = 10.0
LEAST_TURNS_FOR_TERMS: Final = 300.0
#: Share of the rows in motion, at the end, on which terms must hold good by themselves.
HELD_OUT_SHARE: Final = 1 / 3
#: Motor turns in each direction and reversals, below which no terms in direction are tried.
LEAST_TURNS_EACH_WAY: Final = 50.0
LEAST_REVERSALS: Final = 3
#: They have to gain this much after reversals, all together.
LEAST_GAIN_AFTER_REVERSALS: Final = 50.0
#: Of what terms in direction gain after reversals, none may lose more than this share, and the best
#: one may bring no more than this share.
LARGEST_LOSS_SHARE: Final = 0.05
LARGEST_SHARE: Final = 0.5


class Terms(NamedTuple):
    """What the modulated orders' ripple depends on.

    Attributes
    ----------
    load, speed, direction : bool
        Whether there is a pair of coefficients for it.
    """

    load: bool = False
    speed: bool = False
    direction: bool = False

    def __str__(self) -> str:
        names = [name for name, has in self._asdict().items() if has]
        return f"{' and '.join(names) if names else 'no load, speed or direction'} terms"


@dataclass(frozen=True)
class RippleSettings:
    """What was chosen.

    Attributes
    ----------
    config : RippleFilterConfig
        The configuration.
    terms : Terms
        Those that the modulated orders have.
    is_chosen : bool
        False where the recording is too short to choose on: the standard was kept.
    memory_interval_turns : tuple of float or None
        Shortest and longest of the tried memories that the recording does not tell from the best
        one; None where none was chosen.
    """

    config: _core.RippleFilterConfig
    terms: Terms
    is_chosen: bool
    memory_interval_turns: tuple[float, float] | None = None


@dataclass(frozen=True)
class _Run:
    """One candidate's likelihood, row by row."""

    memory_turns: float
    rows: NDArray[np.intp]
    likelihoods: NDArray[np.float64]

    @property
    def mean(self) -> float:
        return float(np.mean(self.likelihoods))

    @property
    def held_out_mean(self) -> float:
        first = int((1.0 - HELD_OUT_SHARE) * len(self.likelihoods))
        return float(np.mean(self.likelihoods[first:]))

    def over(self, other: _Run) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Rows that both have, and what each of them gains."""
        rows, mine, others = np.intersect1d(
            self.rows, other.rows, assume_unique=True, return_indices=True
        )
        return rows, self.likelihoods[mine] - other.likelihoods[others]


class _Search:
    """Candidates on one recording."""

    def __init__(
        self,
        excerpt: Samples,
        orders: Sequence[Any],
        modulated: Sequence[Any],
        given: Mapping[str, Any],
    ) -> None:
        self._excerpt = excerpt
        self._orders = orders
        self._modulated = modulated
        self._given = {**given, "reference_speed_rad_s": _typical_speed_rad_s(excerpt)}

    def config(self, memory_turns: float, terms: Terms) -> _core.RippleFilterConfig:
        return _core.RippleFilterConfig(
            orders=[
                _core.RippleOrder(
                    order,
                    with_load=terms.load and order in self._modulated,
                    with_speed=terms.speed and order in self._modulated,
                    with_direction=terms.direction and order in self._modulated,
                )
                for order in self._orders
            ],
            memory_turns=memory_turns,
            **self._given,
        )

    def runs(
        self, all_terms: Sequence[Terms], memories_turns: Sequence[float]
    ) -> Iterator[tuple[Terms, list[_Run]]]:
        """Run all terms with all memories, side by side; each terms' runs in the memories' order."""
        configs = [
            self.config(memory_turns, terms)
            for terms in all_terms
            for memory_turns in memories_turns
        ]
        found = innovations_of_all(self._excerpt, configs)
        each_run = (
            _Run(config.memory_turns, each.rows, each.likelihoods())
            for config, each in zip(configs, found, strict=True)
        )
        for terms in all_terms:
            yield terms, list(islice(each_run, len(memories_turns)))

    def cost(self, terms: Terms, rows: int) -> float:
        """Give what the terms have to gain per row."""
        coefficients = 2 * len(self._modulated) * sum(terms)
        return LEAST_GAIN * any(terms) + LEAST_GAIN_OF_A_COEFFICIENT * coefficients / rows


def choose_ripple_settings(
    excerpt: Samples,
    orders: Sequence[Any],
    modulated: Sequence[Any],
    standard_memory_turns: float,
    given: Mapping[str, Any],
    *,
    may_have_load: bool = True,
) -> RippleSettings:
    """Choose memory and terms by likelihood.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording.
    orders : sequence
        Orders to remove, cycles per motor turn.
    modulated : sequence
        Those of them that may have load, speed and direction terms.
    standard_memory_turns : float
        Memory where the recording is too short to choose.
    given : mapping
        The other arguments of `RippleFilterConfig`.
    may_have_load : bool
        False leaves load terms out.

    Returns
    -------
    RippleSettings
        The choice.
    """
    search = _Search(excerpt, orders, modulated, given)
    standard = _core.RippleFilterConfig(
        orders=list(orders), memory_turns=standard_memory_turns, **given
    )
    rows = len(innovations(excerpt, standard).rows)
    turns = float(np.nansum(np.abs(np.diff(excerpt.motor_angle_rad))) / (2 * np.pi))
    if rows < LEAST_ROWS or turns < LEAST_TURNS:
        return RippleSettings(standard, Terms(), is_chosen=False)
    enough = turns >= LEAST_TURNS_FOR_TERMS
    further = [Terms(load=True), Terms(speed=True), Terms(load=True, speed=True)]
    tried = [terms for terms in further if enough and (may_have_load or not terms.load)]
    terms, runs = _without_direction(search, tried)
    reversals = find_reversals(excerpt.motor_angle_rad)
    if enough and _shows_direction(reversals):
        terms, runs = _with_direction(search, [Terms(), *tried], terms, runs, reversals)
    chosen = _longest_of_the_best(runs)
    return RippleSettings(
        search.config(chosen.memory_turns, terms),
        terms,
        is_chosen=True,
        memory_interval_turns=_memory_interval_turns(runs),
    )


def _without_direction(search: _Search, tried: Sequence[Terms]) -> tuple[Terms, list[_Run]]:
    """Choose load and speed terms; with the runs of every memory."""
    candidates = search.runs([Terms(), *tried], MEMORIES_TURNS)
    best_terms, best_runs = next(candidates)
    plain_held_out = _longest_of_the_best(best_runs).held_out_mean
    best_score = max(run.mean for run in best_runs)
    for terms, runs in candidates:
        score = max(run.mean for run in runs) - search.cost(terms, len(runs[0].rows))
        held_out = _longest_of_the_best(runs).held_out_mean
        if score > best_score and held_out > plain_held_out:
            best_score, best_terms, best_runs = score, terms, runs
    return best_terms, best_runs


def _shows_direction(reversals: Reversals) -> bool:
    each_way = min(reversals.turns_forward, reversals.turns_backward)
    return reversals.count >= LEAST_REVERSALS and each_way >= LEAST_TURNS_EACH_WAY


def _with_direction(
    search: _Search,
    tried: Sequence[Terms],
    terms: Terms,
    runs: list[_Run],
    reversals: Reversals,
) -> tuple[Terms, list[_Run]]:
    """Take direction terms where they gain: on the whole, on the last rows, and after reversals."""
    without = _longest_of_the_best(runs)
    best: tuple[float, Terms] | None = None
    # All again: ripple that differs by direction hides what follows load and speed, or looks so.
    candidates = [candidate._replace(direction=True) for candidate in tried]
    memories_turns = sorted({without.memory_turns, *COARSE_MEMORIES_TURNS})
    for with_direction, coarse in search.runs(candidates, memories_turns):
        for run in coarse:
            score = run.mean - search.cost(with_direction, len(run.rows))
            if best is None or score > best[0]:
                best = score, with_direction
    assert best is not None
    score, with_direction = best
    if score <= without.mean - search.cost(terms, len(without.rows)):
        return terms, runs
    ((_, runs_with),) = search.runs([with_direction], MEMORIES_TURNS)
    chosen = _longest_of_the_best(runs_with)
    held_good = chosen.held_out_mean > without.held_out_mean
    if held_good and _gains_after_reversals(reversals.sums_after(*chosen.over(without))):
        return with_direction, runs_with
    return terms, runs


def _gains_after_reversals(gains: NDArray[np.float64]) -> bool:
    """Tell whether a gain is clear, and that of more than one reversal."""
    if len(gains) < LEAST_REVERSALS - 1:
        return False
    total = float(np.sum(gains))
    return (
        total >= LEAST_GAIN_AFTER_REVERSALS
        and float(np.min(gains)) >= -LARGEST_LOSS_SHARE * total
        and float(np.max(gains)) <= LARGEST_SHARE * total
    )


def _longest_of_the_best(runs: list[_Run]) -> _Run:
    best = max(run.mean for run in runs)
    return next(run for run in runs if run.mean >= best - TIE)


def _memory_interval_turns(runs: list[_Run]) -> tuple[float, float]:
    best = max(runs, key=lambda run: run.mean)

    def is_as_good(run: _Run) -> bool:
        loss = block_sums(best.over(run)[1])
        return run.mean >= best.mean - TIE or standardized_gain(loss) <= COVERAGE

    good = [run.memory_turns for run in runs if is_as_good(run)]
    return min(good), max(good)


def _typical_speed_rad_s(excerpt: Samples) -> float:
    """High speed of the recording, which scales the speed terms; at least 1 rad/s."""
    with np.errstate(divide="ignore", invalid="ignore"):
        speed_rad_s = np.abs(np.diff(excerpt.motor_angle_rad) / np.diff(excerpt.time_s))
    speed_rad_s = speed_rad_s[np.isfinite(speed_rad_s)]
    return float(np.clip(np.quantile(speed_rad_s, 0.95), 1.0, 1e4)) if len(speed_rad_s) else 1.0
