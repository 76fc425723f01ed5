"""Plain numpy, dense, in double: what one writes down from a textbook."""

from __future__ import annotations

import numpy as np

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
    row, noise = ROW[0], R[0, 0]

    def run(samples: int) -> Array:
        torque = recording.torque_Nm[:samples]
        turns = turning(recording.motor_speed_rad_s[:samples])
        state = np.zeros(6)
        P = P0.copy()
        ripple = np.empty(samples)
        for k in range(samples):
            ripple[k] = row @ state
            seen = P @ row
            gain = seen / (row @ seen + noise)
            state += gain * (torque[k] - ripple[k])
            P -= np.outer(gain, seen)
            turn = turns[k]
            state = turn @ state
            P = turn @ P @ turn.T + Q
        return ripple

    return Peer(np.__version__, run)
