"""Who looks on while a recording is filtered, to tell about it afterwards."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from strainwave.methods.interface import Cleaned, Method
    from strainwave.methods.registry import Setting


class Watch(Protocol):
    """Is shown the method before the first row, and then every row that is written."""

    def begin(
        self, rows: int, name: str, setting: Setting, build: Callable[[str, Setting], Method]
    ) -> None:
        """Take note of what the recording will be filtered with.

        Parameters
        ----------
        rows : int
            Rows of the recording.
        name : str
            Name of the method.
        setting : Setting
            What it was built from, with what it chose.
        build : callable
            Builds another one from name and setting.
        """
        ...

    def take(
        self, log_time_s: NDArray[np.float64], measured_Nm: NDArray[np.float64], cleaned: Cleaned
    ) -> None:
        """Take the next rows.

        Parameters
        ----------
        log_time_s, measured_Nm : numpy.ndarray
            Time as the recording counts it, s, and torque as recorded, Nm, shape (rows,).
        cleaned : Cleaned
            What the method made of them.
        """
        ...
