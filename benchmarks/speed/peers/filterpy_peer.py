"""filterpy: `KalmanFilter`, its transition given with every prediction."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
from filterpy.kalman import KalmanFilter

from benchmarks.speed.inputs import Array, Recording
from benchmarks.speed.peers.matrices import P0, ROW, Q, R, turning
from benchmarks.speed.peers.peer import Peer


def make(_case: str, recording: Recording) -> Peer:
    """Make the peer.

    Parameters
    ----------
    _case : str
        The published filter is the only one.
    recording : Recording
        Signals.

    Returns
    -------
    Peer
        Ready to run.
    """

    def run(samples: int) -> Array:
        turns = turning(recording.motor_speed_rad_s[:samples])
        torque = recording.torque_Nm[:samples]
        each = KalmanFilter(dim_x=6, dim_z=1)
        each.H, each.Q, each.R, each.P = ROW, Q, R, P0.copy()
        ripple = np.empty(samples)
        for k in range(samples):
            ripple[k] = (ROW @ each.x)[0, 0]
            each.update(torque[k])
            each.predict(F=turns[k])
        return ripple

    return Peer(version("filterpy"), run)
