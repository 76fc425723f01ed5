"""Rows of a recording in motion, torque before and after side by side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from strainwave.evidence.envelope import is_rejected
from strainwave.identify.moving_rows import moving_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.methods.interface import Cleaned
    from strainwave.samples import Samples


@dataclass(frozen=True)
class Motion:
    """Rows in motion that were used, each of which brings something new.

    Attributes
    ----------
    time_s : numpy.ndarray
        Time as the recording counts it, shape (rows,), s.
    angle_rad, speed_rad_s : numpy.ndarray
        Of the motor, shape (rows,), rad and rad/s.
    torque_Nm : numpy.ndarray
        Before and after, shape (2, rows), Nm.
    place : numpy.ndarray
        Where each row is in the recording, shape (rows,), from 0.
    """

    time_s: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    speed_rad_s: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    place: NDArray[np.intp]

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def turns(self) -> float:
        """Travel of the motor, turns."""
        return float(np.sum(np.abs(np.diff(self.angle_rad)))) / (2 * np.pi)


def rows_in_motion(samples: Samples, log_time_s: NDArray[np.float64], cleaned: Cleaned) -> Motion:
    """Leave out rows at rest, rows that repeat the row before, and rows that were not used.

    Parameters
    ----------
    samples : Samples
        Rows of a recording.
    log_time_s : numpy.ndarray
        Their time as the recording counts it, shape (rows,), s.
    cleaned : Cleaned
        What was made of them.

    Returns
    -------
    Motion
        What is left.
    """
    rows = moving_rows(samples.time_s, samples.motor_angle_rad, samples.torque_Nm)
    used = ~is_rejected(cleaned.status[rows.place])
    used &= np.isfinite(cleaned.torque_Nm[rows.place])
    place = rows.place[used]
    return Motion(
        log_time_s[place],
        rows.angle_rad[used],
        rows.speed_rad_s[used],
        np.stack([rows.torque_Nm[used], cleaned.torque_Nm[place]]),
        place,
    )
