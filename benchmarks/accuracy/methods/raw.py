"""The torque as measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from benchmarks.accuracy.methods.interface import Method, Removal

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting


def remove(log: Log, setting: Setting) -> Removal:  # noqa: ARG001 - every method is called alike
    """Remove nothing.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Not used.

    Returns
    -------
    Removal
        The measured torque.
    """
    return Removal(log.torque_Nm.copy(), np.zeros(len(log.torque_Nm)))


RAW = Method("raw", remove)
