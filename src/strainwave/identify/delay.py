"""The delay between angle and torque, by the likelihood of the ripple filter's innovations.

A delay shifts the ripple's phase in proportion to the speed. At one speed that is a phase like any
other, which the filter learns; only a recording at several speeds tells the two apart. Terms in
speed would take the delay's place, so the filter has none here; terms in load it has, because a
phase that follows the load is taken for a delay otherwise, load and speed often going together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.optimize import minimize_scalar

from strainwave import _core
from strainwave.identify.moving_rows import travel_windows
from strainwave.identify.ripple_settings import row_likelihoods

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
#: Stretches of the recording whose disagreement counts into the uncertainty.
BLOCKS: Final = 30


@dataclass(frozen=True)
class Delay:
    """What was found.

    Attributes
    ----------
    delay_s : float
        Time by which torque lags the angle, s.
    standard_uncertainty_s : float
        From the likelihood's curvature and how far stretches of the recording disagree, s.
    """

    delay_s: float
    standard_uncertainty_s: float


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

    def likelihoods(delay_s: float, chosen: Sequence[float] = orders) -> NDArray[np.float64]:
        config = _core.RippleFilterConfig(
            orders=[_core.RippleOrder(order, with_load=True) for order in chosen],
            memory_turns=MEMORY_TURNS,
            angle_to_torque_delay_s=float(delay_s),
            **given,
        )
        return row_likelihoods(excerpt, config)

    def cost(delay_s: float) -> float:
        return -float(np.sum(likelihoods(delay_s)))

    lowest = min(orders, key=lambda order: abs(order - 2.0))
    fast = float(np.quantile(np.abs(rows.speed_rad_s), 0.9))
    step_s = float(np.clip(SCAN_STEP_RAD / (lowest * fast), 5e-4, 5e-3))
    scan = np.arange(SHORTEST_S, LONGEST_S + step_s, step_s)
    scan = np.minimum(scan, LONGEST_S)
    scores = np.array([_block_sums(likelihoods(delay_s, [lowest])) for delay_s in scan])
    best = int(np.argmax(scores.sum(axis=1)))
    # Every other stretch by itself has to say the same: a phase that wanders does not.
    parts = [int(np.argmax(scores[:, first::2].sum(axis=1))) for first in (0, 1)]
    if best in (0, len(scan) - 1) or max(abs(part - best) for part in parts) > 1:
        return None
    bounds = (float(scan[best - 1]), float(scan[best + 1]))
    found = minimize_scalar(cost, bounds=bounds, method="bounded", options={"xatol": 1e-6})
    delay_s = float(found.x)
    # Wide enough to be above rounding, narrow enough to be within the parabola.
    side_s = 0.1 * step_s
    sides = [likelihoods(delay_s + side_s), likelihoods(delay_s - side_s)]
    curvature = -(float(np.sum(sides[0]) + np.sum(sides[1])) + 2 * found.fun) / side_s**2
    if not curvature > 0.0 or len(sides[0]) != len(sides[1]):
        return None
    # What the model leaves out goes on for a while: stretches of rows are independent, not rows.
    slopes = _block_sums((sides[0] - sides[1]) / (2 * side_s))
    variance = max(float(slopes @ slopes), curvature)
    return Delay(delay_s, float(np.sqrt(variance) / curvature))


def _block_sums(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([np.sum(part) for part in np.array_split(values, BLOCKS)])
