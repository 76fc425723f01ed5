"""A run in free motion: what the torque of a joint follows from while nothing touches its output."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.signal import savgol_filter

from strainwave.arrays import contiguous
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Speed and acceleration are those of the cubic fitted to this much time on both sides, s.
HALF_WINDOW_S: Final = 0.1
_DEGREE: Final = 3
#: Rows slower than this share of the high speed are at rest: friction there has no direction.
LEAST_SPEED_SHARE: Final = 0.03
#: Rows are so many median intervals apart where something is missing.
_GAP: Final = 3.0
LEAST_ROWS: Final = 500


@dataclass(frozen=True)
class FreeMotion:
    """Rows in motion of one run.

    Attributes
    ----------
    time_s, output_angle_rad, speed_rad_s, acceleration_rad_s2, torque_Nm : numpy.ndarray
        Shape (rows,); the motion is the output's, and torque is what was measured less what a model
        expects.
    ripple_angle_rad : numpy.ndarray or None
        Angle of the wave against the gauges, m times the motor's; None where it is not known.
    mounting_rad : float
        How far the joint's housing is turned about the joint's axis against other runs, rad.
    """

    time_s: NDArray[np.float64]
    output_angle_rad: NDArray[np.float64]
    speed_rad_s: NDArray[np.float64]
    acceleration_rad_s2: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    ripple_angle_rad: NDArray[np.float64] | None = None
    mounting_rad: float = 0.0

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def travel_rad(self) -> NDArray[np.float64]:
        """How far the output has turned up to each row, to and fro added up, rad."""
        return np.cumsum(np.abs(np.diff(self.output_angle_rad, prepend=self.output_angle_rad[0])))

    def part(self, rows: slice) -> FreeMotion:
        """Take some of the rows.

        Parameters
        ----------
        rows : slice
            Which ones.

        Returns
        -------
        FreeMotion
            Those.
        """
        ripple = self.ripple_angle_rad
        return replace(
            self,
            time_s=self.time_s[rows],
            output_angle_rad=self.output_angle_rad[rows],
            speed_rad_s=self.speed_rad_s[rows],
            acceleration_rad_s2=self.acceleration_rad_s2[rows],
            torque_Nm=self.torque_Nm[rows],
            ripple_angle_rad=None if ripple is None else ripple[rows],
        )


def free_motion(
    time_s: ArrayLike,
    output_angle_rad: ArrayLike,
    torque_Nm: ArrayLike,
    *,
    expected_torque_Nm: ArrayLike | None = None,
    ripple_angle_rad: ArrayLike | None = None,
    delay_s: float = 0.0,
    mounting_rad: float = 0.0,
    source: str = "the run",
) -> FreeMotion:
    """Take the rows in motion of a recording, with their speed and acceleration.

    Parameters
    ----------
    time_s, output_angle_rad, torque_Nm : array_like
        Consecutive rows, shape (rows,); the angle unwrapped. Rows with a NaN are left out.
    expected_torque_Nm : array_like, optional
        Torque that a model of the load expects: subtracted as it stands.
    ripple_angle_rad : array_like, optional
        Angle of the wave against the gauges.
    delay_s : float
        Time by which the torque lags the angle.
    mounting_rad : float
        How far the housing is turned about the joint's axis against other runs.
    source : str
        Name of the recording, for messages.

    Returns
    -------
    FreeMotion
        The rows in motion.

    Raises
    ------
    InputError
        If too few rows are in motion.
    """
    columns = {"time_s": time_s, "output_angle_rad": output_angle_rad, "torque_Nm": torque_Nm}
    if expected_torque_Nm is not None:
        columns["expected_torque_Nm"] = expected_torque_Nm
    if ripple_angle_rad is not None:
        columns["ripple_angle_rad"] = ripple_angle_rad
    arrays = {name: contiguous(name, values, np.float64) for name, values in columns.items()}
    rows = len(arrays["time_s"])
    for name, values in arrays.items():
        if len(values) != rows:
            raise InputError(
                f"{name} has {len(values)} elements: expected {rows} as in time_s; give arrays of "
                "one length"
            )
    good = np.all([np.isfinite(values) for values in arrays.values()], axis=0)
    stamps = np.where(good, arrays["time_s"], -np.inf)
    good &= stamps > np.maximum.accumulate(np.append(-np.inf, stamps))[:-1]
    arrays = {name: values[good] for name, values in arrays.items()}
    arrays = _at_one_instant(arrays, delay_s)
    if len(arrays["time_s"]) < LEAST_ROWS:
        raise InputError(
            f"{source}: {len(arrays['time_s'])} rows have time, angle and torque; expected at least "
            f"{LEAST_ROWS}, so record a longer run"
        )
    return _moving(arrays, mounting_rad, source)


def _at_one_instant(
    arrays: dict[str, NDArray[np.float64]], delay_s: float
) -> dict[str, NDArray[np.float64]]:
    """Take the angles that the gauges saw: the torque of a row is older, or younger, than they."""
    if delay_s == 0.0 or not len(arrays["time_s"]):
        return arrays
    seen_s = arrays["time_s"] - delay_s
    known = (seen_s >= arrays["time_s"][0]) & (seen_s <= arrays["time_s"][-1])
    return {
        name: np.interp(seen_s[known], arrays["time_s"], values)
        if name.endswith("angle_rad")
        else values[known]
        for name, values in arrays.items()
    }


def _moving(arrays: dict[str, NDArray[np.float64]], mounting_rad: float, source: str) -> FreeMotion:
    time_s, torque_Nm = arrays["time_s"], arrays["torque_Nm"]
    angle_rad = arrays["output_angle_rad"]
    ripple_rad = arrays.get("ripple_angle_rad")
    period_s = float(np.median(np.diff(time_s)))
    half = min(max(3, round(HALF_WINDOW_S / period_s)), (len(time_s) - 1) // 2)
    window = 2 * half + 1
    speed = savgol_filter(angle_rad, window, _DEGREE, deriv=1, delta=period_s)
    acceleration = savgol_filter(angle_rad, window, _DEGREE, deriv=2, delta=period_s)
    moving = np.abs(speed) > LEAST_SPEED_SHARE * float(np.quantile(np.abs(speed), 0.95))
    for row in np.flatnonzero(np.diff(time_s) > _GAP * period_s):
        # A window over a gap has no right speed.
        moving[max(0, row + 1 - half) : row + 1 + half] = False
    if int(moving.sum()) < LEAST_ROWS:
        raise InputError(
            f"{source}: {int(moving.sum())} rows are in motion without a gap in time near them; "
            f"expected at least {LEAST_ROWS}, so record a longer run in free motion"
        )
    expected = arrays.get("expected_torque_Nm")
    left_Nm = torque_Nm if expected is None else torque_Nm - expected
    return FreeMotion(
        time_s[moving],
        angle_rad[moving],
        np.asarray(speed[moving]),
        np.asarray(acceleration[moving]),
        left_Nm[moving],
        None if ripple_rad is None else ripple_rad[moving],
        mounting_rad,
    )
