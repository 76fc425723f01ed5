"""What every compared method is given and gives: a whole log in, a whole log out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Log:
    """A recording as a method sees it.

    Attributes
    ----------
    time_s : numpy.ndarray
        Time stamps, shape (samples,), s.
    wave_angle_rad : numpy.ndarray
        Motor angle as recorded times the wave factor m, shape (samples,), rad. Every method is
        given the right m, so that none is judged by a number that is not its own.
    torque_Nm : numpy.ndarray
        Measured torque, shape (samples,), Nm.
    expected_torque_Nm : numpy.ndarray
        Torque expected from a model, shape (samples,), Nm; zeros in this bench.
    """

    time_s: NDArray[np.float64]
    wave_angle_rad: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    expected_torque_Nm: NDArray[np.float64]


@dataclass(frozen=True)
class Setting:
    """What is known of a joint before the log.

    Attributes
    ----------
    sample_period_s : float
        Nominal sample period.
    ratio : float
        Motor turns per output turn.
    rated_torque_Nm : float
        Full scale.
    torque_noise_Nm : float
        Standard deviation of the torque signal at rest.
    orders : tuple of int
        Orders to remove, per turn of the wave.
    modulated_orders : tuple of int
        Those whose amplitude may follow load and speed; used by methods that can.
    """

    sample_period_s: float
    ratio: float
    rated_torque_Nm: float
    torque_noise_Nm: float
    orders: tuple[int, ...]
    modulated_orders: tuple[int, ...] = ()


@dataclass(frozen=True)
class Removal:
    """What a method makes of a log.

    Attributes
    ----------
    torque_Nm : numpy.ndarray
        Torque without ripple, shape (samples,), Nm.
    ripple_Nm : numpy.ndarray
        What was removed, shape (samples,), Nm.
    """

    torque_Nm: NDArray[np.float64]
    ripple_Nm: NDArray[np.float64]


#: Runs a fresh method over a log: (log, setting, **tuning) -> removal.
Remove = Callable[..., Removal]


@dataclass(frozen=True)
class Method:
    """A method of the table.

    Attributes
    ----------
    name : str
        Its name in the table.
    remove : callable
        Runs it.
    grid : tuple of mapping
        Tunings to choose among on the training runs, the one that does least to true torque first;
        a single one is taken as it is.
    remark : str
        What one must know to compare it.
    """

    name: str
    remove: Remove
    grid: tuple[Mapping[str, Any], ...] = ({},)
    remark: str = ""
