"""Misalignment torque over the output's angle, from runs in free motion.

A misaligned load makes the gauges read a torque that repeats with the output's turn: Taghirad &
Belanger 1999, section VI. On the way it cannot be told from contact torque, so it is found once, with
the torques of free motion beside it, and then removed as it stands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.misalignment_design import (
    Design,
    GravityKnowledge,
    MapTerm,
    Solution,
)
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strainwave.calibrate.free_motion import FreeMotion

#: Cycles per output turn that are tried where none are named.
CYCLES: Final = tuple(range(1, 9))
#: Orders of the wave that are fitted beside: the mesh's ripple.
RIPPLE_ORDERS: Final = (2.0, 4.0, 6.0)
#: Columns of the fit, each scaled to length 1, may not be closer to each other than this.
LARGEST_CONDITION: Final = 100.0


@dataclass(frozen=True)
class MisalignmentFit:
    """What runs in free motion say of the misalignment.

    Attributes
    ----------
    terms : tuple of MapTerm
        The map, by cycles.
    once_a_turn : MapTerm or None
        One cycle per output turn where it may be gravity as well: not part of the map.
    gravity : MapTerm or None
        Gravity's cosine and sine of the output angle at mounting 0, where it was found from
        turned runs.
    others : dict
        What else was fitted: value and standard uncertainty by name, of the first run.
    condition : float
        Condition number of the fit, columns scaled to length 1.
    residual_rms_Nm : float
        Root mean square of what is left of the blocks' means.
    effective_blocks : float
        How many independent means the blocks are worth.
    lowest_output_angle_rad, highest_output_angle_rad : float or None
        Range that was seen; None where it is a whole turn.
    output_turns : float
        How far the output turned, to and fro added up.
    says : tuple of str
        What the runs cannot tell.
    """

    terms: tuple[MapTerm, ...]
    once_a_turn: MapTerm | None
    gravity: MapTerm | None
    others: dict[str, tuple[float, float]]
    condition: float
    residual_rms_Nm: float
    effective_blocks: float
    lowest_output_angle_rad: float | None
    highest_output_angle_rad: float | None
    output_turns: float
    says: tuple[str, ...]


def fit_misalignment(
    runs: Sequence[FreeMotion],
    gravity: GravityKnowledge,
    *,
    cycles: Sequence[int] | None = None,
    zero_rad: float = 0.0,
    ripple_orders: Sequence[float] = RIPPLE_ORDERS,
) -> MisalignmentFit:
    """Fit the map by least squares, with inertia, friction, zero, drift, gravity and ripple beside.

    Parameters
    ----------
    runs : sequence of FreeMotion
        One run, or several of one joint.
    gravity : Gravity or {"unknown", "turned"}
        "unknown" leaves one cycle a turn out of the map; "turned" tells gravity from misalignment
        by runs whose `mounting_rad` differ.
    cycles : sequence of int, optional
        Cycles per output turn of the map. Without, those of 1 to 8 that lower Schwarz's criterion
        (BIC), the strongest first, with as many independent observations as the residuals are worth.
    zero_rad : float
        Output angle from which the map counts.
    ripple_orders : sequence of float
        Orders of the wave fitted beside.

    Returns
    -------
    MisalignmentFit
        The map with its uncertainties: Newey and West's, as what is left is no white noise.

    Raises
    ------
    InputError
        If the runs cannot tell the terms from each other, or one cycle a turn is asked for and
        may be gravity.
    """
    _check_cycles(cycles, gravity)
    design = Design(runs, gravity, zero_rad, ripple_orders)
    candidates = [n for n in (cycles or CYCLES) if n != 1 or gravity != "unknown"]
    chosen = list(candidates) if cycles else design.choose(candidates)
    solution = design.solve(chosen)
    if solution.condition > LARGEST_CONDITION:
        raise InputError(_too_close(design, solution, chosen))
    once = design.term(solution, 1, "once") if gravity == "unknown" else None
    found = design.term(solution, 1, "gravity") if gravity == "turned" else None
    lowest, highest = design.range_rad
    return MisalignmentFit(
        terms=tuple(design.term(solution, n, "map") for n in sorted(chosen)),
        once_a_turn=once,
        gravity=found,
        others={
            name: (solution.values[at], solution.uncertainties[at])
            for at, name in enumerate(design.names)
            if name.endswith("#0")
        },
        condition=solution.condition,
        residual_rms_Nm=float(np.sqrt(np.mean(solution.left**2))),
        effective_blocks=design.effective_blocks,
        lowest_output_angle_rad=None if design.is_whole_turn else lowest,
        highest_output_angle_rad=None if design.is_whole_turn else highest,
        output_turns=sum(float(run.travel_rad[-1]) for run in runs) / (2 * np.pi),
        says=design.says,
    )


@dataclass(frozen=True)
class CheckedTerm:
    """A number of cycles in a run that the map was not fitted to.

    Attributes
    ----------
    cycles_per_output_turn : int
        The number.
    before_Nm, after_Nm : float
        Its amplitude, as measured and less the map.
    """

    cycles_per_output_turn: int
    before_Nm: float
    after_Nm: float


@dataclass(frozen=True)
class MapCheck:
    """What the map removes of a run that it was not fitted to.

    Attributes
    ----------
    terms : tuple of CheckedTerm
        By cycles.
    share_removed : float
        1 less the root of the sums of squares, after over before.
    """

    terms: tuple[CheckedTerm, ...]
    share_removed: float


def check_map(
    run: FreeMotion,
    terms: Sequence[MapTerm],
    gravity: GravityKnowledge,
    *,
    zero_rad: float = 0.0,
    ripple_orders: Sequence[float] = RIPPLE_ORDERS,
) -> MapCheck:
    """Fit the cycles of a map anew to another run, and compare.

    Parameters
    ----------
    run : FreeMotion
        A run that the map was not fitted to.
    terms : sequence of MapTerm
        The map.
    gravity : Gravity or {"unknown"}
        What is known of gravity in this run.
    zero_rad : float
        Output angle from which the map counts.
    ripple_orders : sequence of float
        Orders of the wave fitted beside.

    Returns
    -------
    MapCheck
        Amplitudes before and after.
    """
    design = Design([run], gravity, zero_rad, ripple_orders)
    solution = design.solve([term.cycles_per_output_turn for term in terms])
    if solution.condition > LARGEST_CONDITION:
        raise InputError(
            "the run that checks the map cannot tell its terms from each other (condition number "
            f"{solution.condition:.3g}, expected at most {LARGEST_CONDITION:g}); let the output turn "
            "further in it"
        )
    checked, before, after = [], 0.0, 0.0
    for term in terms:
        here = design.term(solution, term.cycles_per_output_turn, "map")
        left = np.hypot(here.cosine_Nm - term.cosine_Nm, here.sine_Nm - term.sine_Nm)
        checked.append(CheckedTerm(term.cycles_per_output_turn, here.amplitude_Nm, float(left)))
        before += here.amplitude_Nm**2
        after += float(left) ** 2
    return MapCheck(tuple(checked), 1.0 - float(np.sqrt(after / before)) if before else 0.0)


def _check_cycles(cycles: Sequence[int] | None, gravity: GravityKnowledge) -> None:
    if cycles is None:
        return
    for n in cycles:
        if not 1 <= n <= 1000 or list(cycles).count(n) > 1:
            raise InputError(
                f"cycles {', '.join(map(str, cycles))}: expected whole numbers from 1 to 1000, each "
                "once, such as 1,2,4,8; correct this value"
            )
    if 1 in cycles and gravity == "unknown":
        raise InputError(
            "one cycle per output turn is asked for, and gravity has one as well: the run cannot "
            "tell them apart; say what gravity is, that the axis is vertical, or give a second run "
            "with the housing turned"
        )


def _too_close(design: Design, solution: Solution, chosen: Sequence[int]) -> str:
    low, high = np.degrees(design.range_rad)
    cycles = ", ".join(map(str, sorted(chosen))) or "none"
    reason = (
        f"the output turned from {low:.4g} to {high:.4g} deg only"
        if not design.is_whole_turn
        else "speed and acceleration follow the output's angle, or the housings are hardly turned"
    )
    return (
        f"the run cannot tell cycles {cycles} per output turn from each other and from inertia, "
        f"friction and zero (condition number {solution.condition:.3g}, expected at most "
        f"{LARGEST_CONDITION:g}): {reason}; turn further and in both directions at several speeds, or "
        "name fewer cycles"
    )
