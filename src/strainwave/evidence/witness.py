"""Looks on while a recording is filtered, in bounded memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.evidence.envelope import EnvelopeTally, is_rejected
from strainwave.evidence.flags import FlagTally
from strainwave.methods.interface import joined
from strainwave.samples import Samples

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from strainwave.methods.interface import Cleaned, Method
    from strainwave.methods.registry import Setting


class Witness:
    """A `strainwave.records.watching.Watch` that keeps what the evidence is computed from.

    Of the whole recording it keeps an envelope and the flags; row by row only as many as the
    excerpt has on which the method was chosen.
    """

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
            What it was built from, with what it chose; its excerpt is the start of the recording.
        build : callable
            Builds another one from name and setting.
        """
        assert setting.excerpt is not None
        self.rows = rows
        self.name = name
        self.setting = setting
        self.samples: Samples = setting.excerpt
        self.build = build
        self.rejected_rows = 0
        self._envelope = EnvelopeTally(rows)
        self._flags = FlagTally()
        self._parts: list[Cleaned] = []
        self._times: list[NDArray[np.float64]] = []
        self._kept = 0

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
        self._envelope.take(log_time_s, measured_Nm, cleaned)
        self._flags.take(log_time_s, cleaned.status)
        self.rejected_rows += int(np.count_nonzero(is_rejected(cleaned.status)))
        if self._kept < len(self.samples):
            self._parts.append(cleaned)
            self._times.append(log_time_s)
            self._kept += len(cleaned)

    @property
    def envelope(self) -> EnvelopeTally:
        """Of the whole recording."""
        return self._envelope

    @property
    def flags(self) -> FlagTally:
        """Of the whole recording."""
        return self._flags

    def excerpt(self) -> tuple[NDArray[np.float64], Cleaned]:
        """Give the rows that were kept one by one.

        Returns
        -------
        tuple
            Time as the recording counts it, shape (rows,), s, and what was made of the rows: as
            many as `samples` has.
        """
        count = len(self.samples)
        whole = joined(self._parts)
        cleaned = type(whole)(
            whole.torque_Nm[:count], whole.ripple_Nm[:count], whole.status[:count]
        )
        return np.concatenate(self._times)[:count], cleaned
