"""Keeps rows that are out of order from a method, and puts them back into what it gives."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from strainwave import _core
from strainwave.methods.interface import Cleaned, joined
from strainwave.samples import Samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.methods.interface import Method

_OUT_OF_ORDER = np.uint32(_core.StatusFlag.sample_out_of_order.value)
_WITHOUT_TIME = np.uint32(_core.StatusFlag.time_not_finite.value)


class InOrder:
    """A method that sees only rows which are later than all rows before them.

    The others are rejected for it: they hold the last good torque and ripple, and are flagged
    ``sample_out_of_order``, or ``time_not_finite`` where they have no time stamp at all.

    Parameters
    ----------
    method : Method
        What the other rows go to.
    """

    def __init__(self, method: Method) -> None:
        self._method = method
        self._latest_s = -np.inf
        # Of the rows that have not been handed out: 0 where the method has them, else their flag.
        self._flags: deque[NDArray[np.uint32]] = deque()
        self._results = joined([])
        self._last = (0.0, 0.0)

    def process(self, samples: Samples, /) -> Cleaned:
        """Take the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            Rows that are ready, in order.
        """
        if self._goes_on(samples.time_s):
            self._flags.append(np.zeros(len(samples), np.uint32))
            return self._ready([self._method.process(samples)])
        known = np.isfinite(samples.time_s)
        stamps = np.where(known, samples.time_s, -np.inf)
        latest = np.maximum.accumulate(np.append(self._latest_s, stamps))
        good = known & (samples.time_s > latest[:-1])
        self._latest_s = latest[-1]
        flags = np.where(known, _OUT_OF_ORDER, _WITHOUT_TIME)
        self._flags.append(np.where(good, np.uint32(0), flags))
        if not good.all():
            samples = Samples(
                samples.time_s[good],
                samples.motor_angle_rad[good],
                samples.torque_Nm[good],
                samples.expected_torque_Nm[good],
            )
        return self._ready([self._method.process(samples)] if len(samples) else [])

    def finish(self) -> Cleaned:
        """Hand out the rows held back, at the end of the recording.

        Returns
        -------
        Cleaned
            The rest.
        """
        return self._ready([self._method.finish()])

    def _goes_on(self, time_s: NDArray[np.float64]) -> bool:
        """Whether each row is later than the one before; the last one is taken note of then."""
        if not len(time_s) or not np.isfinite(time_s[-1]) or not time_s[0] > self._latest_s:
            return False
        if not (time_s[1:] > time_s[:-1]).all():
            return False
        self._latest_s = time_s[-1]
        return True

    def _ready(self, new: list[Cleaned]) -> Cleaned:
        results = joined([self._results, *new])
        parts = []
        start = 0
        while self._flags:
            flags = self._flags[0]
            end = start + int(np.count_nonzero(flags == 0))
            if end > len(results):
                break
            self._flags.popleft()
            parts.append(self._merged(flags, results.part(slice(start, end))))
            start = end
        self._results = results.part(slice(start, None))
        return joined(parts)

    def _merged(self, flags: NDArray[np.uint32], good: Cleaned) -> Cleaned:
        if len(good) == len(flags):
            merged = good
        else:
            last = np.cumsum(flags == 0)
            status = flags.copy()
            status[flags == 0] = good.status
            merged = Cleaned(
                np.append(self._last[0], good.torque_Nm)[last],
                np.append(self._last[1], good.ripple_Nm)[last],
                status,
            )
        if len(merged):
            self._last = (float(merged.torque_Nm[-1]), float(merged.ripple_Nm[-1]))
        return merged
