"""The linear problem behind a misalignment map: regressors of free motion, their choice and solution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from strainwave.calibrate.free_motion import FreeMotion
from strainwave.calibrate.free_motion_blocks import Blocks
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

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
class Solution:
    """Coefficients of a set of cycles, and what is left.

    Attributes
    ----------
    values, uncertainties : numpy.ndarray
        By column.
    left : numpy.ndarray
        Residuals of the blocks, Nm.
    condition : float
        Condition number, columns scaled to length 1.
    names : tuple of str
        Of the columns.
    """

    values: NDArray[np.float64]
    uncertainties: NDArray[np.float64]
    left: NDArray[np.float64]
    condition: float
    names: tuple[str, ...]


class Design:
    """Regressors of all runs over their blocks; those of free motion are each run's own.

    Parameters
    ----------
    runs : sequence of FreeMotion
        The runs.
    gravity : Gravity or {"unknown", "turned"}
        What is known of gravity.
    zero_rad : float
        Output angle from which the map counts.
    ripple_orders : sequence of float
        Orders of the wave fitted beside.
    """

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
        """Take the cycles that the runs have evidence for, the strongest first.

        Parameters
        ----------
        candidates : sequence of int
            Cycles that are tried.

        Returns
        -------
        list of int
            Those that lower Schwarz's criterion.
        """
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

    def solve(self, cycles: Sequence[int]) -> Solution:
        """Fit these cycles, with uncertainties for residuals that are correlated.

        Parameters
        ----------
        cycles : sequence of int
            Cycles of the map.

        Returns
        -------
        Solution
            Coefficients and residuals.
        """
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
        return Solution(values / length, spread / length, left, min(condition, 1e300), names)

    def term(self, solution: Solution, cycles: int, kind: str) -> MapTerm:
        """Read one number of cycles out of a solution.

        Parameters
        ----------
        solution : Solution
            From `solve`.
        cycles : int
            The number.
        kind : {"map", "once", "gravity"}
            Whose it is.

        Returns
        -------
        MapTerm
            Amplitudes and uncertainties.
        """
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
