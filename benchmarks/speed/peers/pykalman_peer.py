"""pykalman: `KalmanFilter.filter` over the whole recording."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pykalman import KalmanFilter

from benchmarks.speed.inputs import Recording
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

    def run(samples: int) -> Any:
        turns = turning(recording.motor_speed_rad_s[: samples - 1])
        each = KalmanFilter(
            transition_matrices=turns,
            observation_matrices=ROW,
            transition_covariance=Q,
            observation_covariance=R,
            initial_state_mean=np.zeros(6),
            initial_state_covariance=P0,
        )
        return turns, each.filter(recording.torque_Nm[:samples])[0]

    def ripple_Nm(result: Any) -> NDArray[Any]:
        # What it hands out is after the update; the ripple is what was predicted before it.
        turns, states = result
        predicted = np.einsum("kij,kj->ki", turns, states[:-1]) @ ROW[0]
        return np.concatenate([[0.0], predicted])

    return Peer(version("pykalman"), run, ripple_Nm)
