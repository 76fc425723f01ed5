"""The delay between angle and torque, by the likelihood of the ripple filter's innovations.

A delay shifts the ripple's phase in proportion to the speed. At one speed that is a phase like any
other, which the filter learns; only a recording at several speeds tells the two apart. Terms in
speed would take the delay's place, so the filter has none here; terms in load it has, because a
phase that follows the load is taken for a delay otherwise, load and speed often going together.

A ripple whose phase wanders is most likely at some delay, too. So that a delay is one, all others
have to be clearly less likely, stretch of the recording by stretch; and how far a filter with every
term disagrees counts into the uncertainty.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.optimize import minimize_scalar

from strainwave import _core
from strainwave.identify.likelihood import block_sums, row_likelihoods
from strainwave.identify.moving_rows import travel_windows

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from strainwave.identify.moving_rows import MovingRows
    from strainwave.samples import Samples

#: Delays that are looked at, s.
SHORTEST_S: Final = -0.005
LONGEST_S: Final = 0.05
#: Long, so that the filter cannot follow the phase that a wrong delay shifts.
MEMORY_TURNS: Final = 40.0
#: Speeds differ where they are this far from the typical one, relatively, over this share of the
#: windows of travel, each of so many motor turns.
SPEED_DIFFERENCE: Final = 0.15
SPEED_SHARE: Final = 0.05
WINDOW_TURNS: Final = 2.0
LEAST_WINDOWS: Final = 3
#: Phase of the lowest order between two delays of the first scan, rad.
SCAN_STEP_RAD: Final = 0.5
#: Delays further away than so many steps must be this much less likely (a ratio's logarithm), and
#: stretches of the recording in which they are more likely must bring no more than this share.
NEAR_STEPS: Final = 2
LEAST_GAIN: Final = 25.0
LARGEST_LOSS_SHARE: Final = 0.2
#: From here on a second order has to lead to the same delay: torque signals lag by a few
#: milliseconds as a rule.
CONFIRMED_FROM_S: Final = 0.01


@dataclass(frozen=True)
class Delay:
    """What was found.

    Attributes
    ----------
    delay_s : float
        Time by which torque lags the angle, s.
    standard_uncertainty_s : float
        From the likelihood's curvature, how far stretches of the recording disagree, and how far a
        filter with every term does, s.
    doubt : str
        Why the delay is not to be trusted; empty where it is.
    """

    delay_s: float
    standard_uncertainty_s: float
    doubt: str = ""


def speed_changes(rows: MovingRows) -> bool:
    """Tell whether a recording has speeds that a delay can be told from.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion, angles of the motor.

    Returns
    -------
    bool
        Whether |speed| differs over enough of the travel.
    """
    windows = travel_windows(rows.angle_rad, WINDOW_TURNS * 2 * np.pi, 8)
    if len(windows) < 2 * LEAST_WINDOWS:
        return False
    speed = np.array([abs(float(np.median(rows.speed_rad_s[window]))) for window in windows])
    typical = float(np.median(speed))
    differing = int(np.count_nonzero(np.abs(speed - typical) > SPEED_DIFFERENCE * typical))
    return differing >= max(LEAST_WINDOWS, SPEED_SHARE * len(windows))


def find_delay(
    excerpt: Samples, rows: MovingRows, orders: Sequence[float], given: Mapping[str, Any]
) -> Delay | None:
    """Find the delay that makes the innovations most likely.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording, with the motor's angle.
    rows : MovingRows
        Those of them in motion.
    orders : sequence of float
        Orders that are there, cycles per motor turn.
    given : mapping
        The other arguments of `RippleFilterConfig`: noise, walk, rated torque.

    Returns
    -------
    Delay or None
        None where the speeds do not tell, or no delay in range does better than its neighbours.
    """
    if not speed_changes(rows) or not orders:
        return None
    search = _Search(excerpt, rows, orders, given)
    lowest = min(orders, key=lambda order: abs(order - 2.0))
    scores = search.scan([lowest])
    best = _best(scores)
    if best in (0, len(scores) - 1):
        return None
    bounds = (float(search.delays_s[best - 1]), float(search.delays_s[best + 1]))
    found = minimize_scalar(search.cost, bounds=bounds, method="bounded", options={"xatol": 1e-6})
    delay_s = float(found.x)
    near = search.parabola(delay_s)
    if near is None:
        return None
    # A phase that follows speed or direction looks like a delay to the one filter, not the other.
    every = search.parabola(delay_s, with_speed=True, with_direction=True)
    away_s = 0.0 if every is None else every.step_s
    deviation_s = float(np.hypot(near.deviation_s, away_s))
    return Delay(delay_s, deviation_s, search.doubt(delay_s, lowest, scores))


@dataclass(frozen=True)
class _Parabola:
    """The likelihood about a delay: Newton's step to its top, and the top's uncertainty."""

    step_s: float
    deviation_s: float


class _Search:
    """Likelihoods of delays on one recording."""

    def __init__(
        self,
        excerpt: Samples,
        rows: MovingRows,
        orders: Sequence[float],
        given: Mapping[str, Any],
    ) -> None:
        self._excerpt = excerpt
        self._orders = orders
        fast = float(np.quantile(np.abs(rows.speed_rad_s), 0.9))
        self._given = {**given, "reference_speed_rad_s": float(np.clip(fast, 1.0, 1e4))}
        lowest = min(orders, key=lambda order: abs(order - 2.0))
        self._step_s = float(np.clip(SCAN_STEP_RAD / (lowest * fast), 5e-4, 5e-3))
        delays_s = np.arange(SHORTEST_S, LONGEST_S + self._step_s, self._step_s)
        self.delays_s = np.minimum(delays_s, LONGEST_S)

    def likelihoods(
        self, delay_s: float, orders: Sequence[float], **terms: bool
    ) -> NDArray[np.float64]:
        config = _core.RippleFilterConfig(
            orders=[_core.RippleOrder(order, with_load=True, **terms) for order in orders],
            memory_turns=MEMORY_TURNS,
            angle_to_torque_delay_s=float(delay_s),
            **self._given,
        )
        return row_likelihoods(self._excerpt, config)

    def cost(self, delay_s: float) -> float:
        return -float(np.sum(self.likelihoods(delay_s, self._orders)))

    def scan(self, orders: Sequence[float]) -> NDArray[np.float64]:
        """Likelihood of each delay in each stretch of the recording, shape (delays, stretches)."""
        return np.array([block_sums(self.likelihoods(each, orders)) for each in self.delays_s])

    def parabola(self, delay_s: float, **terms: bool) -> _Parabola | None:
        # Wide enough to be above rounding, narrow enough to be within the parabola.
        side_s = 0.1 * self._step_s
        low, middle, high = (
            self.likelihoods(delay_s + side, self._orders, **terms) for side in (-side_s, 0, side_s)
        )
        if not len(low) == len(middle) == len(high):
            return None
        curvature = -float(np.sum(low) + np.sum(high) - 2 * np.sum(middle)) / side_s**2
        if not curvature > 0.0:
            return None
        slopes = (high - low) / (2 * side_s)
        step_s = float(np.sum(slopes)) / curvature
        # What the model leaves out goes on for a while: stretches of rows are independent, not rows.
        sums = block_sums(slopes - np.mean(slopes))
        variance = max(float(sums @ sums), curvature)
        return _Parabola(step_s, float(np.sqrt(variance) / curvature))

    def doubt(self, delay_s: float, lowest: float, scores: NDArray[np.float64]) -> str:
        other = self._rival(delay_s, scores)
        if other is not None:
            return f"one of {1e3 * other:.3g} ms fits nearly as well"
        if delay_s <= CONFIRMED_FROM_S:
            return ""
        others = [order for order in self._orders if order != lowest]
        if any(self._confirms(delay_s, order) for order in others):
            return ""
        return "it rests on one order of the ripple alone"

    def _rival(self, delay_s: float, scores: NDArray[np.float64]) -> float | None:
        """Delay elsewhere that is not clearly less likely."""
        best = _best(scores)
        far = np.abs(self.delays_s - delay_s) > NEAR_STEPS * self._step_s
        rivals = [row for row in np.flatnonzero(far) if not _is_clear(scores[best] - scores[row])]
        if not rivals:
            return None
        return float(self.delays_s[max(rivals, key=lambda row: float(scores[row].sum()))])

    def _confirms(self, delay_s: float, order: float) -> bool:
        scores = self.scan([order])
        best = _best(scores)
        near = abs(float(self.delays_s[best]) - delay_s) <= NEAR_STEPS * self._step_s
        # Higher orders repeat sooner: others like it are let pass, delays as a whole are not.
        return near and _is_clear(scores[best] - scores.mean(axis=0))


def _best(scores: NDArray[np.float64]) -> int:
    return int(np.argmax(scores.sum(axis=1)))


def _is_clear(gains: NDArray[np.float64]) -> bool:
    """Tell whether stretches of the recording agree on a gain in likelihood."""
    gained, lost = float(gains[gains > 0.0].sum()), -float(gains[gains < 0.0].sum())
    return gained - lost >= LEAST_GAIN and lost <= LARGEST_LOSS_SHARE * gained
