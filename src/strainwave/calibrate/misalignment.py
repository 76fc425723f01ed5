"""Misalignment torque over the output's angle, from runs in free motion.

A misaligned load makes the gauges read a torque that repeats with the output's turn: Taghirad &
Belanger 1999, section VI. On the way it cannot be told from contact torque, so it is found once, with
the torques of free motion beside it, and then removed as it stands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from strainwave.calibrate.free_motion import Blocks, FreeMotion
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: Cycles per output turn that are tried where none are named.
CYCLES: Final = tuple(range(1, 9))
#: Orders of the wave that are fitted beside: the mesh's ripple.
RIPPLE_ORDERS: Final = (2.0, 4.0, 6.0)
#: Columns of the fit, each scaled to length 1, may not be closer to each other than this.
LARGEST_CONDITION: Final = 100.0
#: Lags of Bartlett's window over the blocks (Newey and West 1987).
_LAGS: Final = 8
#: An output that turns by this share of a turn or more has seen every angle.
_WHOLE_TURN: Final = 0.99


@dataclass(frozen=True)
class Gravity:
    """Torque of the load's weight that is known beforehand.

    Attributes
    ----------
    amplitude_Nm : float
        Largest torque, at the output; 0 where the axis is vertical.
    horizontal_angle_rad : float
        Output angle at which the torque is largest: the arm is horizontal.
    """

    amplitude_Nm: float
    horizontal_angle_rad: float = 0.0

    def torque_Nm(self, output_angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute the torque at output angles.

        Parameters
        ----------
        output_angle_rad : numpy.ndarray
            Angles, rad.

        Returns
        -------
        numpy.ndarray
            Torque, Nm.
        """
        return self.amplitude_Nm * np.cos(output_angle_rad - self.horizontal_angle_rad)


#: What is known of gravity: its torque, nothing, or runs with the housing turned from one to another.
GravityKnowledge = Gravity | Literal["unknown", "turned"]


@dataclass(frozen=True)
class MapTerm:
    """One number of cycles.

    Attributes
    ----------
    cycles_per_output_turn : int
        The number.
    cosine_Nm, sine_Nm : float
        Amplitudes.
    cosine_standard_uncertainty_Nm, sine_standard_uncertainty_Nm : float
        Their standard uncertainties.
    """

    cycles_per_output_turn: int
    cosine_Nm: float
    sine_Nm: float
    cosine_standard_uncertainty_Nm: float
    sine_standard_uncertainty_Nm: float

    @property
    def amplitude_Nm(self) -> float:
        """Zero to peak."""
        return float(np.hypot(self.cosine_Nm, self.sine_Nm))

    @property
    def amplitude_standard_uncertainty_Nm(self) -> float:
        """Standard uncertainty of the amplitude, the mean over both directions of the phasor."""
        squares = self.cosine_standard_uncertainty_Nm**2 + self.sine_standard_uncertainty_Nm**2
        return float(np.sqrt(squares / 2))


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
    design = _Design(runs, gravity, zero_rad, ripple_orders)
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
    design = _Design([run], gravity, zero_rad, ripple_orders)
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


@dataclass(frozen=True)
class _Solution:
    values: NDArray[np.float64]
    uncertainties: NDArray[np.float64]
    left: NDArray[np.float64]
    condition: float
    names: tuple[str, ...]


class _Design:
    """Regressors of all runs over their blocks; those of free motion are each run's own."""

    def __init__(
        self,
        runs: Sequence[FreeMotion],
        gravity: GravityKnowledge,
        zero_rad: float,
        ripple_orders: Sequence[float],
    ) -> None:
        blocks = [Blocks(run) for run in runs]
        self._blocks, self._zero_rad = blocks, zero_rad
        self._waves: dict[int, NDArray[np.float64]] = {}
        total = sum(each.count for each in blocks)
        self.names: list[str] = []
        columns: list[NDArray[np.float64]] = []
        says: list[str] = []
        start = 0
        for number, each in enumerate(blocks):
            own, remarks = each.regressors(ripple_orders)
            for name, values in own.items():
                column = np.zeros(total)
                column[start : start + each.count] = values
                columns.append(column)
                self.names.append(f"{name}#{number}")
            says += [remark for remark in remarks if remark not in says]
            start += each.count
        torques = [
            each.mean(each.run.torque_Nm - _known(gravity, each.run.output_angle_rad))
            for each in blocks
        ]
        self.torque_Nm = np.concatenate(torques)
        if gravity == "unknown":
            columns += list(self._wave(1).T)
            self.names += ["once cosine 1", "once sine 1"]
        if gravity == "turned":
            turned = [each.waves((1,), -each.run.mounting_rad) for each in blocks]
            columns += list(np.concatenate(turned).T)
            self.names += ["gravity cosine 1", "gravity sine 1"]
        self._base = np.column_stack(columns)
        self.says = tuple(says)
        angles = [run.output_angle_rad for run in runs]
        self.range_rad = (
            min(float(a.min()) for a in angles),
            max(float(a.max()) for a in angles),
        )
        self.is_whole_turn = any(float(np.ptp(a)) >= _WHOLE_TURN * 2 * np.pi for a in angles)
        self.effective_blocks = float(total)

    def _wave(self, cycles: int) -> NDArray[np.float64]:
        if cycles not in self._waves:
            parts = [each.waves((cycles,), self._zero_rad) for each in self._blocks]
            self._waves[cycles] = np.concatenate(parts)
        return self._waves[cycles]

    def _matrix(self, cycles: Sequence[int]) -> NDArray[np.float64]:
        return np.column_stack([self._base, *(self._wave(n) for n in cycles)])

    def choose(self, candidates: Sequence[int]) -> list[int]:
        """Take the cycles that the runs have evidence for, the strongest first."""
        left = _residual(self._matrix(candidates), self.torque_Nm)
        self.effective_blocks = len(left) / _correlation_time(left)
        penalty = 2.0 * np.log(self.effective_blocks)
        chosen: list[int] = []
        squares = _squares(self._matrix(()), self.torque_Nm)
        while remaining := [n for n in candidates if n not in chosen]:
            tried = {n: _squares(self._matrix([*chosen, n]), self.torque_Nm) for n in remaining}
            best = min(tried, key=lambda n: tried[n])
            if tried[best] <= 0.0 or squares <= 0.0:
                break
            if self.effective_blocks * np.log(squares / tried[best]) <= penalty:
                break
            chosen.append(best)
            squares = tried[best]
        return chosen

    def solve(self, cycles: Sequence[int]) -> _Solution:
        """Fit these cycles, with uncertainties for residuals that are correlated."""
        matrix = self._matrix(cycles)
        names = (*self.names, *(f"map {wave} {n}" for n in cycles for wave in ("cosine", "sine")))
        if len(self.torque_Nm) <= matrix.shape[1]:
            raise InputError(
                f"the run gives {len(self.torque_Nm)} means for {matrix.shape[1]} unknowns; "
                "expected more, so record a longer run"
            )
        length = np.linalg.norm(matrix, axis=0)
        length[length == 0.0] = 1.0
        scaled = matrix / length
        singular = np.linalg.svd(scaled, compute_uv=False)
        condition = float(singular[0] / max(singular[-1], np.finfo(float).tiny))
        inverse = np.linalg.pinv(scaled)
        values = inverse @ self.torque_Nm
        left = self.torque_Nm - scaled @ values
        scores = inverse.T * left[:, np.newaxis]
        covariance = scores.T @ scores
        for lag in range(1, _LAGS + 1):
            product = scores[lag:].T @ scores[:-lag]
            covariance += (1 - lag / (_LAGS + 1)) * (product + product.T)
        covariance *= len(left) / (len(left) - matrix.shape[1])
        spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        return _Solution(values / length, spread / length, left, min(condition, 1e300), names)

    def term(self, solution: _Solution, cycles: int, kind: str) -> MapTerm:
        """Read one number of cycles out of a solution."""
        at = solution.names.index(f"{kind} cosine {cycles}")
        return MapTerm(
            cycles,
            *(float(value) for value in solution.values[at : at + 2]),
            *(float(value) for value in solution.uncertainties[at : at + 2]),
        )


def _known(gravity: GravityKnowledge, angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    return gravity.torque_Nm(angle_rad) if isinstance(gravity, Gravity) else 0.0 * angle_rad


def _residual(matrix: NDArray[np.float64], torque_Nm: NDArray[np.float64]) -> NDArray[np.float64]:
    length = np.linalg.norm(matrix, axis=0)
    length[length == 0.0] = 1.0
    scaled = matrix / length
    return np.asarray(torque_Nm - scaled @ np.linalg.lstsq(scaled, torque_Nm, rcond=None)[0])


def _squares(matrix: NDArray[np.float64], torque_Nm: NDArray[np.float64]) -> float:
    left = _residual(matrix, torque_Nm)
    return float(left @ left)


def _correlation_time(left: NDArray[np.float64]) -> float:
    """Say how many neighbouring residuals are worth one independent one; at least 1."""
    power = float(left @ left)
    if power == 0.0:
        return 1.0
    lags = [float(left[lag:] @ left[:-lag]) / power for lag in range(1, _LAGS + 1)]
    weights = 1.0 - np.arange(1, _LAGS + 1) / (_LAGS + 1)
    return max(1.0, 1.0 + 2.0 * float(weights @ np.array(lags)))


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


def _too_close(design: _Design, solution: _Solution, chosen: Sequence[int]) -> str:
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
