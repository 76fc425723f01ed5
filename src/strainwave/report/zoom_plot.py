"""Torque before and after as the page's own script reads it."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.evidence import Envelope


@dataclass(frozen=True)
class ZoomPlot:
    """A plot that can be zoomed.

    Attributes
    ----------
    envelope : Envelope
        What is drawn.
    origin_s : float
        Time that is shown as 0, s.
    time_label : str
        Label of the axis of time.
    """

    envelope: Envelope
    origin_s: float
    time_label: str

    @property
    def as_json(self) -> str:
        """Arrays in base64, little-endian: time as float64, torque as float32."""
        shown = self.envelope
        lowest = [
            _text(values, "<f4") for values in (shown.before_lowest_Nm, shown.after_lowest_Nm)
        ]
        highest = lowest
        if shown.rows_per_point > 1:
            both = (shown.before_highest_Nm, shown.after_highest_Nm)
            highest = [_text(values, "<f4") for values in both]
        return json.dumps(
            {
                "time": _text(shown.time_s - self.origin_s, "<f8"),
                "low": lowest,
                "high": highest,
                "rejected": _text(shown.is_rejected, "u1"),
                "timeLabel": self.time_label,
            },
            separators=(",", ":"),
        )


def _text(values: NDArray[np.float64] | NDArray[np.bool_], kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode("ascii")
