"""Means over blocks of a run in free motion, and what the torque in them follows from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.free_motion import FreeMotion

#: Blocks of rows whose means are fitted: at least so many, and so many an output turn.
LEAST_BLOCKS: Final = 400
BLOCKS_PER_TURN: Final = 64
#: A speed that varies less than this share of its mean does not tell friction from a zero.
_LEAST_SPEED_SPREAD: Final = 0.1
#: Output turns below which a drift over time cannot be told from slow torque.
_TURNS_FOR_DRIFT: Final = 3.0


class Blocks:
    """Means over blocks of consecutive rows: ripple and noise average out, slow torque stays.

    Parameters
    ----------
    run : FreeMotion
        The rows.
    """

    def __init__(self, run: FreeMotion) -> None:
        turns = float(run.travel_rad[-1]) / (2 * np.pi)
        wanted = max(LEAST_BLOCKS, round(BLOCKS_PER_TURN * turns))
        self.count = min(wanted, len(run) // 5)
        # Blocks of equal size, so that their means weigh the same; the last few rows are left.
        self._size = len(run) // self.count
        self.run = run

    def mean(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Average a column.

        Parameters
        ----------
        values : numpy.ndarray
            A value a row.

        Returns
        -------
        numpy.ndarray
            A value a block.
        """
        whole = values[: self.count * self._size].reshape(self.count, self._size)
        return np.asarray(whole.mean(axis=1))

    def waves(self, cycles: Sequence[int], zero_rad: float) -> NDArray[np.float64]:
        """Average cosine and sine of cycles per output turn.

        Parameters
        ----------
        cycles : sequence of int
            Cycles per output turn.
        zero_rad : float
            Output angle from which they count.

        Returns
        -------
        numpy.ndarray
            Shape (blocks, 2 x cycles): cosine and sine of each in turn.
        """
        gamma = self.run.output_angle_rad - zero_rad
        columns = [self.mean(wave(n * gamma)) for n in cycles for wave in (np.cos, np.sin)]
        return np.column_stack(columns) if columns else np.empty((self.count, 0))

    def regressors(
        self, ripple_orders: Sequence[float]
    ) -> tuple[dict[str, NDArray[np.float64]], tuple[str, ...]]:
        """Average what the torque of free motion follows from, gravity and misalignment apart.

        Parameters
        ----------
        ripple_orders : sequence of float
            Orders of the wave that are fitted beside.

        Returns
        -------
        dict, tuple of str
            Columns by name, and sentences on what the run cannot tell.
        """
        run = self.run
        forward = run.speed_rad_s > 0
        columns = {"zero_Nm": np.ones(self.count)}
        says = []
        if float(run.travel_rad[-1]) >= _TURNS_FOR_DRIFT * 2 * np.pi:
            middle_s = float(run.time_s.mean())
            columns["drift_Nm_per_s"] = self.mean(run.time_s - middle_s)
        shares = (float(forward.mean()), float((~forward).mean()))
        if min(shares) > 0.02:
            columns["coulomb_friction_Nm"] = self.mean(np.sign(run.speed_rad_s))
        else:
            says.append(
                "the output turns in one direction only: its dry friction is part of the zero, and "
                "a misalignment that depends on the direction does not show"
            )
        for name, rows in (("forward", forward), ("backward", ~forward)):
            speeds = np.abs(run.speed_rad_s[rows])
            if rows.mean() > 0.02 and float(np.std(speeds)) > _LEAST_SPEED_SPREAD * float(
                np.mean(speeds)
            ):
                columns[f"viscous_friction_{name}_Nm_s_per_rad"] = self.mean(
                    np.where(rows, run.speed_rad_s, 0.0)
                )
        columns["inertia_kg_m2"] = self.mean(run.acceleration_rad_s2)
        if run.ripple_angle_rad is not None:
            for order in ripple_orders:
                columns[f"ripple_{order:g}_cosine_Nm"] = self.mean(
                    np.cos(order * run.ripple_angle_rad)
                )
                columns[f"ripple_{order:g}_sine_Nm"] = self.mean(
                    np.sin(order * run.ripple_angle_rad)
                )
        return columns, tuple(says)
