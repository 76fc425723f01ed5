"""Memory and terms of the ripple filter from a recording, by the likelihood of its innovations.

Candidates are run over the recording, and the one whose innovations are the most likely is taken:
Student's t with four degrees of freedom and a free scale, because contacts are no noise, over rows
in motion, the first eighth left out for learning. A longer memory and fewer terms do less to true
torque; they are preferred unless there is clear evidence against them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.optimize import minimize_scalar

from strainwave import _core
from strainwave.ripple_filter import RippleFilter

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from strainwave.samples import Samples

#: Memories that are tried, motor turns. Shorter ones follow more ripple and take more true torque;
#: who wants one has to ask for it.
MEMORIES_TURNS: Final = (160.0, 80.0, 40.0, 20.0, 10.0, 5.0, 3.0)
#: A longer memory is kept while the likelihood of a row falls by no more than this (a ratio's
#: logarithm) behind the best.
TIE: Final = 1e-3
#: Terms have to gain this much per row, and so much per coefficient over all rows.
LEAST_GAIN: Final = 0.006
LEAST_GAIN_OF_A_COEFFICIENT: Final = 25.0
#: Rows in motion and motor turns, below which the standard is kept; terms need more.
LEAST_ROWS: Final = 500
LEAST_TURNS: Final = 10.0
LEAST_TURNS_FOR_TERMS: Final = 300.0
DEGREES_OF_FREEDOM: Final = 4.0
#: Share of the rows in motion that is left for learning.
LEARNING_SHARE: Final = 1 / 8
#: Share of the rows in motion, at the end, on which terms must hold good by themselves.
HELD_OUT_SHARE: Final = 1 / 3


@dataclass(frozen=True)
class RippleSettings:
    """What was chosen.

    Attributes
    ----------
    config : RippleFilterConfig
        The configuration.
    load_terms, speed_terms : bool
        Whether the modulated orders have them.
    is_chosen : bool
        False where the recording is too short to choose on: the standard was kept.
    """

    config: _core.RippleFilterConfig
    load_terms: bool
    speed_terms: bool
    is_chosen: bool


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
        Those of them that may have load and speed terms.
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

    def config(memory_turns: float, terms: tuple[bool, bool]) -> _core.RippleFilterConfig:
        return _core.RippleFilterConfig(
            orders=[
                _core.RippleOrder(
                    order,
                    with_load=terms[0] and order in modulated,
                    with_speed=terms[1] and order in modulated,
                )
                for order in orders
            ],
            memory_turns=memory_turns,
            **given,
        )

    none = (False, False)
    standard = config(standard_memory_turns, none)
    given = {**given, "reference_speed_rad_s": _typical_speed_rad_s(excerpt)}
    rows, turns = _motion(excerpt, standard)
    if rows < LEAST_ROWS or turns < LEAST_TURNS:
        return RippleSettings(standard, *none, is_chosen=False)
    enough = turns >= LEAST_TURNS_FOR_TERMS
    every = (none, (True, False), (False, True), (True, True)) if enough else (none,)
    tried = [terms for terms in every if may_have_load or not terms[0]]
    best: tuple[float, float, tuple[bool, bool]] | None = None
    plain_held_out = -np.inf
    for terms in tried:
        scores = [_likelihood(excerpt, config(memory, terms)) for memory in MEMORIES_TURNS]
        memory_turns = next(
            memory
            for memory, score in zip(MEMORIES_TURNS, scores, strict=True)
            if score >= max(scores) - TIE
        )
        coefficients = 2 * len(modulated) * sum(terms)
        cost = LEAST_GAIN * any(terms) + LEAST_GAIN_OF_A_COEFFICIENT * coefficients / rows
        if best is None:
            plain_held_out = _likelihood(excerpt, config(memory_turns, terms), HELD_OUT_SHARE)
            best = (max(scores) - cost, memory_turns, terms)
        elif (
            max(scores) - cost > best[0]
            and _likelihood(excerpt, config(memory_turns, terms), HELD_OUT_SHARE) > plain_held_out
        ):
            best = (max(scores) - cost, memory_turns, terms)
    assert best is not None
    _, memory_turns, terms = best
    return RippleSettings(config(memory_turns, terms), *terms, is_chosen=True)


def _typical_speed_rad_s(excerpt: Samples) -> float:
    """High speed of the recording, which scales the speed terms; at least 1 rad/s."""
    with np.errstate(divide="ignore", invalid="ignore"):
        speed_rad_s = np.abs(np.diff(excerpt.motor_angle_rad) / np.diff(excerpt.time_s))
    speed_rad_s = speed_rad_s[np.isfinite(speed_rad_s)]
    return float(np.clip(np.quantile(speed_rad_s, 0.95), 1.0, 1e4)) if len(speed_rad_s) else 1.0


def _motion(excerpt: Samples, config: _core.RippleFilterConfig) -> tuple[int, float]:
    """Rows that the filter learns from in motion, and motor turns."""
    variance = _run(excerpt, config)[1]
    turned = np.abs(np.diff(excerpt.motor_angle_rad))
    return len(variance), float(np.nansum(turned) / (2 * np.pi))


def _run(
    excerpt: Samples, config: _core.RippleFilterConfig
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Innovations in motion, and their variances, after the time for learning."""
    result = RippleFilter(config).process(
        excerpt.time_s,
        excerpt.motor_angle_rad,
        excerpt.torque_Nm,
        expected_torque_Nm=excerpt.expected_torque_Nm,
    )
    at_rest = (result.status & np.uint32(_core.StatusFlag.at_rest.value)) != 0
    rows = np.flatnonzero((result.innovation_variance_Nm2 > 0) & ~at_rest)
    rows = rows[int(LEARNING_SHARE * len(rows)) :]
    return result.innovation_Nm[rows], result.innovation_variance_Nm2[rows]


def _likelihood(
    excerpt: Samples, config: _core.RippleFilterConfig, last_share: float = 1.0
) -> float:
    """Mean logarithm of a row's likelihood, up to a constant, the scale profiled out."""
    innovation_Nm, variance_Nm2 = _run(excerpt, config)
    first = int((1.0 - last_share) * len(innovation_Nm))
    return _likelihood_of(innovation_Nm[first:], variance_Nm2[first:])


def _likelihood_of(innovation_Nm: NDArray[np.float64], variance_Nm2: NDArray[np.float64]) -> float:
    return float(np.mean(_row_likelihoods(innovation_Nm, variance_Nm2)))


def _row_likelihoods(
    innovation_Nm: NDArray[np.float64], variance_Nm2: NDArray[np.float64]
) -> NDArray[np.float64]:
    squares = innovation_Nm**2 / variance_Nm2 / DEGREES_OF_FREEDOM
    slope = 0.5 * (DEGREES_OF_FREEDOM + 1)

    def cost(log_scale: float) -> float:
        return slope * float(np.mean(np.log1p(squares * np.exp(-log_scale)))) + 0.5 * log_scale

    log_scale = float(minimize_scalar(cost, bounds=(-20.0, 20.0), method="bounded").x)
    likelihoods: NDArray[np.float64] = -slope * np.log1p(squares * np.exp(-log_scale))
    return likelihoods - 0.5 * (log_scale + np.log(variance_Nm2))


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
    return _row_likelihoods(*_run(excerpt, config))


def innovations(excerpt: Samples, config: _core.RippleFilterConfig) -> NDArray[np.float64]:
    """Give a recording's innovations.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording.
    config : RippleFilterConfig
        The filter.

    Returns
    -------
    numpy.ndarray
        Of the rows in motion after learning, Nm.
    """
    return _run(excerpt, config)[0]
