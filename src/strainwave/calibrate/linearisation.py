"""Linearisation polynomial: common curvature of all experiments, of the order the data support.

torque = u + FS sum over n = 2 .. order of c_n (u / FS)^n with u = gain (voltage - zero), as in the
joint file. Every experiment keeps its own gain and zero, so that neither the scatter of gains over
positions nor a drift of the zero passes for curvature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy import stats

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.loadings import Loadings
    from strainwave.calibrate.torque import SensorGain

HIGHEST_ORDER: Final = 5
#: A higher order has to predict experiments left out better, at this one-sided level.
SIGNIFICANCE: Final = 0.05
#: And by this share: what a loop leaves of itself in the mean is significant and means nothing.
LEAST_IMPROVEMENT: Final = 0.05
_MOST_ROUNDS: Final = 60


@dataclass(frozen=True)
class Curve:
    """Polynomial common to the experiments, with the gain and zero of each.

    Attributes
    ----------
    coefficients : tuple of float
        c_2 to c_order; empty for a straight line.
    gains_Nm_per_V, zeros_V : numpy.ndarray
        Gain at zero torque, and zero, of each experiment; shape (experiments,).
    residuals_Nm : numpy.ndarray
        Load less the curve of its experiment, shape (rows,).
    """

    coefficients: tuple[float, ...]
    gains_Nm_per_V: NDArray[np.float64]
    zeros_V: NDArray[np.float64]
    residuals_Nm: NDArray[np.float64]


@dataclass(frozen=True)
class OrderEvidence:
    """How well polynomials of one order predict experiments that they were not fitted to.

    Attributes
    ----------
    order : int
        1 for a straight line.
    prediction_error_Nm : float
        Root mean square over the experiments left out, each with a gain and zero of its own.
    p_value : float
        One-sided, that it predicts no better than the best lower order; NaN for order 1.
    """

    order: int
    prediction_error_Nm: float
    p_value: float


@dataclass(frozen=True)
class Linearisation:
    """The order the data support.

    Attributes
    ----------
    curve : Curve
        Polynomial of that order.
    evidence : tuple of OrderEvidence
        Of every order that was tried.
    """

    curve: Curve
    evidence: tuple[OrderEvidence, ...]


def linearise(
    loadings: Loadings, lines: Sequence[SensorGain], full_scale_Nm: float
) -> Linearisation:
    """Choose the order of the polynomial by leaving out one experiment after another.

    A higher order is taken where it predicts the experiments left out better than the best lower
    one does: by `LEAST_IMPROVEMENT` of the error, and in a paired t-test over the experiments at
    the level `SIGNIFICANCE`. Rows of one series share their hysteresis, so that tests which take rows for independent would see curvature in it.

    Parameters
    ----------
    loadings : Loadings
        The experiments.
    lines : sequence of SensorGain
        Straight line of each.
    full_scale_Nm : float
        FS, Nm.

    Returns
    -------
    Linearisation
        Curve and evidence. Fewer than three experiments are no evidence for any order but 1.
    """
    normalised = _Normalised(loadings, lines, full_scale_Nm)
    count = len(loadings.names)
    levels = loadings.levels()
    fewest = min(len(np.unique(levels[rows])) for rows in normalised.rows)
    orders = range(1, min(HIGHEST_ORDER, fewest - 2) + 1) if count >= 3 else (1,)
    best, evidence = 1, []
    squares: dict[int, NDArray[np.float64]] = {}
    for order in orders:
        errors = normalised.left_out(order)
        if errors is None:
            break
        squares[order] = errors
        p_value = float("nan")
        if order > 1:
            p_value = _paired(squares[best] - errors, float(squares[best].mean()))
            share = 1.0 - float(np.sqrt(errors.mean() / max(squares[best].mean(), 1e-300)))
            best = order if p_value < SIGNIFICANCE and share > LEAST_IMPROVEMENT else best
        error_Nm = full_scale_Nm * float(np.sqrt(errors.mean()))
        evidence.append(OrderEvidence(order, error_Nm, p_value))
    curve = normalised.curve(best)
    assert curve is not None
    return Linearisation(curve, tuple(evidence))


def _paired(gained: NDArray[np.float64], scale: float) -> float:
    """One-sided p-value of paired differences; 1 where all are rounding."""
    if np.max(np.abs(gained)) <= 1e-9 * scale or scale <= 1e-20:
        return 1.0
    spread = float(np.std(gained, ddof=1))
    if spread == 0.0:
        return 0.0 if gained[0] > 0 else 1.0
    statistic = float(np.mean(gained)) / (spread / np.sqrt(len(gained)))
    return float(stats.t.sf(statistic, len(gained) - 1))


class _Normalised:
    """Loads and straight-line readings of every experiment, in full scales."""

    def __init__(
        self, loadings: Loadings, lines: Sequence[SensorGain], full_scale_Nm: float
    ) -> None:
        self.rows = list(loadings.rows())
        self._lines = lines
        self._full_scale_Nm = full_scale_Nm
        self._size = len(loadings)
        self._load = [loadings.load_Nm[rows] / full_scale_Nm for rows in self.rows]
        self._read = [
            line.gain_Nm_per_V * (loadings.voltage_V[rows] - line.zero_V) / full_scale_Nm
            for rows, line in zip(self.rows, lines, strict=True)
        ]

    def curve(self, order: int) -> Curve | None:
        fitted = self._fit(order, range(len(self.rows)))
        if fitted is None:
            return None
        coefficients, lines = fitted
        residuals = np.empty(self._size)
        gains, zeros = [], []
        for index, (offset, slope) in enumerate(lines):
            x = offset + slope * self._read[index]
            left = self._load[index] - x - _powers(x, order) @ coefficients
            residuals[self.rows[index]] = self._full_scale_Nm * left
            line = self._lines[index]
            gains.append(slope * line.gain_Nm_per_V)
            zeros.append(line.zero_V - offset * self._full_scale_Nm / gains[-1])
        return Curve(
            tuple(float(value) for value in coefficients),
            np.array(gains),
            np.array(zeros),
            residuals,
        )

    def left_out(self, order: int) -> NDArray[np.float64] | None:
        """Mean square of each experiment's residuals from the curvature of the others."""
        errors = []
        everything = range(len(self.rows))
        for out in everything:
            fitted = self._fit(order, [index for index in everything if index != out])
            if fitted is None:
                return None
            line = self._own_line(out, order, fitted[0])
            if line is None:
                return None
            x = line[0] + line[1] * self._read[out]
            left = self._load[out] - x - _powers(x, order) @ fitted[0]
            errors.append(float(np.mean(left**2)))
        return np.array(errors)

    def _fit(
        self, order: int, chosen: Sequence[int] | range
    ) -> tuple[NDArray[np.float64], list[tuple[float, float]]] | None:
        """Coefficients, and offset and slope of u / FS over the straight line's, alternating."""
        coefficients = np.zeros(order - 1)
        lines = [(0.0, 1.0) for _ in chosen]
        if order == 1:
            return coefficients, lines
        for _ in range(_MOST_ROUNDS):
            rows, right = [], []
            for (offset, slope), index in zip(lines, chosen, strict=True):
                x = offset + slope * self._read[index]
                both = _without_line(
                    self._read[index],
                    np.column_stack([_powers(x, order), self._load[index]]),
                )
                rows.append(both[:, :-1])
                right.append(both[:, -1])
            solved, _, rank, _ = np.linalg.lstsq(
                np.concatenate(rows), np.concatenate(right), rcond=1e-10
            )
            if rank < order - 1 or not np.all(np.isfinite(solved)):
                return None
            moved = float(np.max(np.abs(solved - coefficients)))
            coefficients = solved
            lines = [
                self._one_line(line, index, order, coefficients)
                for line, index in zip(lines, chosen, strict=True)
            ]
            if not all(np.isfinite(line).all() and 0.2 < line[1] < 5.0 for line in lines):
                return None
            if moved <= 1e-12 * max(1.0, float(np.max(np.abs(coefficients)))):
                return coefficients, lines
        return None

    def _own_line(
        self, index: int, order: int, coefficients: NDArray[np.float64]
    ) -> tuple[float, float] | None:
        line = (0.0, 1.0)
        for _ in range(_MOST_ROUNDS):
            last, line = line, self._one_line(line, index, order, coefficients)
            if not (np.isfinite(line).all() and 0.2 < line[1] < 5.0):
                return None
            if max(abs(line[0] - last[0]), abs(line[1] - last[1])) <= 1e-12:
                break
        return line

    def _one_line(
        self,
        line: tuple[float, float],
        index: int,
        order: int,
        coefficients: NDArray[np.float64],
    ) -> tuple[float, float]:
        read = self._read[index]
        x = line[0] + line[1] * read
        left = self._load[index] - _powers(x, order) @ coefficients
        design = np.column_stack([np.ones_like(read), read])
        offset, slope = np.linalg.lstsq(design, left, rcond=None)[0]
        return float(offset), float(slope)


def _powers(x: NDArray[np.float64], order: int) -> NDArray[np.float64]:
    return x[:, np.newaxis] ** np.arange(2, order + 1)


def _without_line(x: NDArray[np.float64], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    design = np.column_stack([np.ones_like(x), x])
    return np.asarray(columns - design @ np.linalg.lstsq(design, columns, rcond=None)[0])
