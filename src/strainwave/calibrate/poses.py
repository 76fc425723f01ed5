"""Readings at rest, one a pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave.arrays import contiguous
from strainwave.calibrate.checks import require_finite
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Poses:
    """Readings at rest, one a pose.

    Attributes
    ----------
    torque_Nm : numpy.ndarray
        What the sensor reads, mean over the readings of a pose, shape (poses,).
    output_angle_rad : numpy.ndarray
        Angle of the output.
    readings : numpy.ndarray
        How many readings a pose has.
    repeatability_Nm : float or None
        Standard deviation of readings within a pose, pooled; None where no pose has two.
    repeatability_freedom : int
        Its degrees of freedom.
    """

    torque_Nm: NDArray[np.float64]
    output_angle_rad: NDArray[np.float64]
    readings: NDArray[np.int64]
    repeatability_Nm: float | None = None
    repeatability_freedom: int = 0

    def __len__(self) -> int:
        return len(self.torque_Nm)


def group_poses(
    torque_Nm: ArrayLike, output_angle_rad: ArrayLike, pose: ArrayLike | None = None
) -> tuple[Poses, NDArray[np.int64]]:
    """Average the readings of each pose.

    Parameters
    ----------
    torque_Nm, output_angle_rad : array_like
        Readings, shape (readings,).
    pose : array_like, optional
        What names the pose of each reading; every reading is a pose without.

    Returns
    -------
    Poses, numpy.ndarray
        The poses in the order in which they came first, and the pose of each reading.

    Raises
    ------
    InputError
        If the arrays do not fit each other or are not finite.
    """
    torque = contiguous("torque_Nm", torque_Nm, np.float64)
    angle = contiguous("output_angle_rad", output_angle_rad, np.float64)
    names = np.arange(len(torque)) if pose is None else np.asarray(pose)
    for name, values in (("output_angle_rad", angle), ("pose", names)):
        if len(values) != len(torque):
            raise InputError(
                f"{name} has {len(values)} elements: expected {len(torque)} as in torque_Nm; give "
                "one a reading"
            )
    require_finite("torque_Nm", torque, "row")
    require_finite("output_angle_rad", angle, "row")
    _, first, place = np.unique(names, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    number = rank[place].astype(np.int64)
    count = np.bincount(number).astype(np.int64)
    mean = np.bincount(number, torque) / count
    freedom = int((count - 1).sum())
    spread = None
    if freedom > 0:
        spread = float(np.sqrt(np.sum((torque - mean[number]) ** 2) / freedom))
    grouped = Poses(mean, np.bincount(number, angle) / count, count, spread, freedom)
    return grouped, number
