"""The methods of the table, in its order."""

from __future__ import annotations

from typing import Final

from benchmarks.accuracy.methods.angle_table import ANGLE_TABLE
from benchmarks.accuracy.methods.lms import LMS
from benchmarks.accuracy.methods.low_pass import LOW_PASS
from benchmarks.accuracy.methods.ours import OURS
from benchmarks.accuracy.methods.ours_variants import OURS_SMOOTHER, OURS_UNTOUCHED
from benchmarks.accuracy.methods.published import PUBLISHED, PUBLISHED_TUNED
from benchmarks.accuracy.methods.raw import RAW
from benchmarks.accuracy.methods.tacho_oscillator import TACHO_OSCILLATOR
from benchmarks.accuracy.methods.tracking_notch import TRACKING_NOTCH

METHODS: Final = (
    RAW,
    PUBLISHED,
    PUBLISHED_TUNED,
    TACHO_OSCILLATOR,
    ANGLE_TABLE,
    LMS,
    TRACKING_NOTCH,
    LOW_PASS,
    OURS_UNTOUCHED,
    OURS,
    OURS_SMOOTHER,
)
BY_NAME: Final = {method.name: method for method in METHODS}
