"""A low-pass filter, for comparison: what many joints use, and what it costs in delay."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

from strainwave import _core
from strainwave.errors import InputError
from strainwave.methods.interface import Cleaned, nothing

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.methods.setting import Setting
    from strainwave.samples import Samples

ORDER = 4
CORNER_HZ = 30.0
#: Sample rate over corner below which the digital filter is no longer the one that was asked for.
SMALLEST_RATE_RATIO = 4.0
#: Magnitude beyond which the core takes a torque for a fault, Nm.
LARGEST_USABLE_TORQUE_NM = 1e15

_TORQUE_FAULT = np.uint32(_core.StatusFlag.torque_not_finite.value)


class LowPass:
    """Butterworth low-pass of the 4th order at 30 Hz, causal.

    The corner is never moved: a filter of that name with another corner would compare something
    else, so that a recording sampled too slowly for it is refused. The filter starts at the first
    usable torque as if it had always been there. Rows count as equally spaced. A row without usable
    torque is flagged and holds torque and ripple of the last good one (0 before there is one), while
    the filter goes on with its last good input.

    Parameters
    ----------
    setting : Setting
        Sample period.

    Raises
    ------
    InputError
        If the sample rate is below 4 x 30 Hz.
    """

    def __init__(self, setting: Setting) -> None:
        rate_Hz = 1.0 / setting.sample_period_s
        if rate_Hz < SMALLEST_RATE_RATIO * CORNER_HZ * (1.0 - 1e-9):
            raise InputError(
                f"method low-pass has its corner at {CORNER_HZ:g} Hz, and the recording has "
                f"{rate_Hz:.4g} samples a second: expected at least "
                f"{SMALLEST_RATE_RATIO * CORNER_HZ:g}; choose another method"
            )
        self._sections = butter(ORDER, CORNER_HZ, output="sos", fs=rate_Hz)
        self._state: NDArray[np.float64] | None = None
        self._input_Nm = 0.0
        self._torque_Nm = 0.0
        self._ripple_Nm = 0.0

    def process(self, samples: Samples, /) -> Cleaned:
        """Filter the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            One row for each; ripple is the measured torque less the filtered.
        """
        measured_Nm = samples.torque_Nm
        rows = len(measured_Nm)
        usable = np.abs(measured_Nm) <= LARGEST_USABLE_TORQUE_NM
        status = np.where(usable, np.uint32(0), _TORQUE_FAULT)
        # Position 0 stands for what was held from the chunk before.
        last = np.maximum.accumulate(
            np.concatenate([[0], np.where(usable, np.arange(rows) + 1, 0)])
        )
        last = last[1:]
        held_Nm = np.concatenate([[self._input_Nm], measured_Nm])[last]
        filtered_Nm = np.zeros(rows)
        first = 0
        if self._state is None:
            first = int(np.argmax(usable)) if usable.any() else rows
            if first < rows:
                self._state = sosfilt_zi(self._sections) * held_Nm[first]
        if first < rows:
            filtered_Nm[first:], self._state = sosfilt(
                self._sections, held_Nm[first:], zi=self._state
            )
        torque_Nm = np.concatenate([[self._torque_Nm], filtered_Nm])[last]
        ripple_Nm = np.concatenate([[self._ripple_Nm], held_Nm - filtered_Nm])[last]
        if rows > 0:
            self._input_Nm = held_Nm[-1]
            self._torque_Nm = torque_Nm[-1]
            self._ripple_Nm = ripple_Nm[-1]
        return Cleaned(torque_Nm, ripple_Nm, status)

    def finish(self) -> Cleaned:
        """Hand out nothing: no rows are held back.

        Returns
        -------
        Cleaned
            No rows.
        """
        return nothing()
