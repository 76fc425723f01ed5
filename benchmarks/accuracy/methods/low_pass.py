"""A Butterworth low-pass, the first thing tried on any noisy torque."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.accuracy.methods.interface import Method
from benchmarks.accuracy.methods.packaged import run_packaged

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Removal, Setting


def remove(log: Log, setting: Setting) -> Removal:
    """Filter as `--method low-pass` does; refused by it where the sampling is too slow.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Sample period.

    Returns
    -------
    Removal
        Torque, and what was filtered out.
    """
    return run_packaged("low-pass", log, setting)


LOW_PASS = Method("Butterworth 30 Hz", remove, remark="fourth order, causal")
