"""Rows of a recording in the units strainwave computes with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Samples:
    """Consecutive rows of a recording, in the units strainwave computes with.

    Attributes
    ----------
    time_s : numpy.ndarray
        Time stamps as recorded, shape (rows,), s; jitter and gaps included.
    motor_angle_rad : numpy.ndarray
        Angle of the motor, shape (rows,), rad; not wrapped. NaN where it is not known.
    torque_Nm : numpy.ndarray
        Measured torque at the output, shape (rows,), Nm. NaN where it is not known.
    expected_torque_Nm : numpy.ndarray
        Torque expected from a model, shape (rows,), Nm; zeros where there is none.
    """

    time_s: NDArray[np.float64]
    motor_angle_rad: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    expected_torque_Nm: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.time_s)
