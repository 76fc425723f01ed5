"""What is recorded of a joint: white noise, a converter's codes, an encoder's counts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

COUNTS_PER_TURN: Final = 4096
CONVERTER_BITS: Final = 16
#: The converter's range over full scale: overload and ripple must not clip.
CONVERTER_RANGE: Final = 2.5


def step_Nm(full_scale_Nm: float) -> float:
    """Torque of one converter code.

    Parameters
    ----------
    full_scale_Nm : float
        Rated torque.

    Returns
    -------
    float
        Nm per code.
    """
    return float(2 * CONVERTER_RANGE * full_scale_Nm / 2**CONVERTER_BITS)


def converted_Nm(torque_Nm: NDArray[np.float64], full_scale_Nm: float) -> NDArray[np.float64]:
    """Round to the converter's codes.

    Parameters
    ----------
    torque_Nm : numpy.ndarray
        Torque at the converter, Nm.
    full_scale_Nm : float
        Rated torque.

    Returns
    -------
    numpy.ndarray
        Torque of the nearest code, clipped to the range.
    """
    highest = 2 ** (CONVERTER_BITS - 1) - 1
    step = step_Nm(full_scale_Nm)
    return step * np.clip(np.rint(torque_Nm / step), -highest - 1, highest)


def counted_rad(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Round down to the encoder's counts, which do not wrap.

    Parameters
    ----------
    angle_rad : numpy.ndarray
        Motor angle, rad.

    Returns
    -------
    numpy.ndarray
        Middle of the count in which the angle is.
    """
    count_rad = 2 * np.pi / COUNTS_PER_TURN
    return count_rad * (np.floor(angle_rad / count_rad) + 0.5)
