"""numba: dense loops of constant length, in float."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.inputs import Recording
from benchmarks.speed.peers.peer import Peer


def make(case: str, recording: Recording) -> Peer:
    """Make the peer.

    Parameters
    ----------
    case : str
        ``published_numba`` or ``default_numba``.
    recording : Recording
        Signals.

    Returns
    -------
    Peer
        Ready to run.
    """
    # Here, so that numba_options is read after it was set.
    from benchmarks.speed.peers import numba_default, numba_published  # noqa: PLC0415

    torque = recording.torque_Nm.astype(np.float32)
    speed = recording.motor_speed_rad_s.astype(np.float32)
    angle = recording.motor_angle_rad

    def published(samples: int) -> NDArray[np.float32]:
        result: NDArray[np.float32] = numba_published.filtered(torque[:samples], speed[:samples])
        return result

    def default(samples: int) -> NDArray[np.float32]:
        result: NDArray[np.float32] = numba_default.filtered(torque[:samples], angle[:samples])
        return result

    run = published if case.startswith("published") else default
    run(2)  # compiled before it is timed
    return Peer(numba.__version__, run)
