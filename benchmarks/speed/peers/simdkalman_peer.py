"""simdkalman: its primitives, because its filter takes no transition that changes with time."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
from simdkalman import primitives

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
        torque = recording.torque_Nm[:samples].reshape(-1, 1, 1)
        state = np.zeros((6, 1))
        P = P0.copy()
        ripple = np.empty(samples)
        for k in range(samples):
            ripple[k] = (ROW @ state)[0, 0]
            state, P = primitives.update(state, P, ROW, R, torque[k])
            state, P = primitives.predict(state, P, turns[k], Q)
        return ripple

    return Peer(version("simdkalman"), run)
