"""statsmodels: the compiled state space filter, told to keep the predictions alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import statsmodels
from numpy.typing import NDArray
from statsmodels.tsa.statespace import kalman_filter

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
        each = kalman_filter.KalmanFilter(k_endog=1, k_states=6)
        each.bind(recording.torque_Nm[:samples].copy())
        each["design"] = ROW
        each["transition"] = np.asfortranarray(
            turning(recording.motor_speed_rad_s[:samples]).transpose(1, 2, 0)
        )
        each["selection"] = np.eye(6)
        each["state_cov"] = Q
        each["obs_cov"] = R
        each.initialize_known(np.zeros(6), P0)
        each.set_conserve_memory(
            kalman_filter.MEMORY_CONSERVE & ~kalman_filter.MEMORY_NO_FORECAST_MEAN
        )
        return each.filter()

    def ripple_Nm(result: Any) -> NDArray[Any]:
        return np.asarray(result.forecasts[0])

    return Peer(statsmodels.__version__, run, ripple_Nm)
