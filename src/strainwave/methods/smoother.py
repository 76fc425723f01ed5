"""The ripple smoother as a method for recordings: blocks of rows that look ahead."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave import _core
from strainwave.methods.interface import Cleaned, joined
from strainwave.methods.ripple import ripple_settings
from strainwave.samples import Samples

if TYPE_CHECKING:
    from strainwave.identify.ripple_settings import RippleSettings
    from strainwave.methods.setting import Setting


class Smoother:
    """The ripple filter's model forwards and backwards: for logs, not for control.

    A block of rows is handed out once `looks_ahead` further rows are there. Blocks are counted from
    the first row, so that it makes no difference how a log is cut.

    Parameters
    ----------
    setting : Setting
        See `ripple_settings`.
    block_rows : int
        Rows handed out together.
    looks_ahead_rows : int
        Rows looked at beyond a block; some memories of the filter should fit into them.
    """

    def __init__(
        self, setting: Setting, *, block_rows: int = 50_000, looks_ahead_rows: int = 25_000
    ) -> None:
        self._settings = ripple_settings(setting)
        self._smoother = _core.RippleSmoother(self._settings.config)
        self._block_rows = block_rows
        self._looks_ahead_rows = looks_ahead_rows
        self._pending = Samples(np.empty(0), np.empty(0), np.empty(0), np.empty(0))

    @property
    def settings(self) -> RippleSettings:
        """The configuration, and how it was chosen."""
        return self._settings

    def process(self, samples: Samples, /) -> Cleaned:
        """Take the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            The blocks that are ready.
        """
        self._pending = _appended(self._pending, samples)
        window = self._block_rows + self._looks_ahead_rows
        parts = []
        start = 0
        while len(self._pending) - start >= window:
            parts.append(self._smoothed(start, start + window, self._block_rows))
            start += self._block_rows
        self._pending = _cut(self._pending, start, len(self._pending))
        return joined(parts)

    def finish(self) -> Cleaned:
        """Hand out the rest.

        Returns
        -------
        Cleaned
            The rows that were held back.
        """
        count = len(self._pending)
        parts = []
        start = 0
        while count - start > 0:
            end = min(start + self._block_rows + self._looks_ahead_rows, count)
            # The last rows go out together: there is nothing ahead of them.
            finished = self._block_rows if end < count else end - start
            parts.append(self._smoothed(start, end, finished))
            start += finished
        self._pending = _cut(self._pending, count, count)
        return joined(parts)

    def _smoothed(self, start: int, end: int, finished_rows: int) -> Cleaned:
        rows = _cut(self._pending, start, end)
        return Cleaned(
            *self._smoother.process(
                rows.time_s,
                rows.motor_angle_rad,
                rows.torque_Nm,
                rows.expected_torque_Nm,
                finished_rows,
            )
        )


def _cut(samples: Samples, start: int, end: int) -> Samples:
    return Samples(
        np.ascontiguousarray(samples.time_s[start:end]),
        np.ascontiguousarray(samples.motor_angle_rad[start:end]),
        np.ascontiguousarray(samples.torque_Nm[start:end]),
        np.ascontiguousarray(samples.expected_torque_Nm[start:end]),
    )


def _appended(first: Samples, second: Samples) -> Samples:
    return Samples(
        np.concatenate([first.time_s, second.time_s]),
        np.concatenate([first.motor_angle_rad, second.motor_angle_rad]),
        np.concatenate([first.torque_Nm, second.torque_Nm]),
        np.concatenate([first.expected_torque_Nm, second.expected_torque_Nm]),
    )
