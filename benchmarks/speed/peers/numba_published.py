"""The published filter for numba: dense, in loops of constant length, in float."""

from __future__ import annotations

from typing import Any, Final

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.inputs import SAMPLE_PERIOD_S
from benchmarks.speed.peers import numba_options
from benchmarks.speed.peers.matrices import ORDERS

_ORDERS: Final = np.array(ORDERS, np.float32)
_SIZE: Final = 6
_PERIOD_S: Final = np.float32(SAMPLE_PERIOD_S)
_ONE: Final = np.float32(1)
_Q: Final = np.float32(1e3)


@numba.njit(fastmath=numba_options.fastmath)  # type: ignore[untyped-decorator]
def filtered(torque: NDArray[Any], speed: NDArray[Any]) -> NDArray[Any]:
    """Filter a recording.

    Parameters
    ----------
    torque, speed : numpy.ndarray
        Nm and rad/s, float32, shape (samples,).

    Returns
    -------
    numpy.ndarray
        Predicted ripple, float32.
    """
    x = np.zeros(_SIZE, np.float32)
    turned = np.zeros(_SIZE, np.float32)
    P = _Q * np.eye(_SIZE, dtype=np.float32)
    F = np.zeros((_SIZE, _SIZE), np.float32)
    FP = np.zeros((_SIZE, _SIZE), np.float32)
    seen = np.zeros(_SIZE, np.float32)
    ripple = np.empty(len(torque), np.float32)
    for k in range(len(torque)):
        ripple[k] = x[0] + x[2] + x[4]
        for i in range(_SIZE):
            seen[i] = P[i, 0] + P[i, 2] + P[i, 4]
        inverse = _ONE / (seen[0] + seen[2] + seen[4] + _ONE)
        innovation = (torque[k] - ripple[k]) * inverse
        for i in range(_SIZE):
            x[i] += seen[i] * innovation
            for j in range(_SIZE):
                P[i, j] -= seen[i] * inverse * seen[j]
        for a in range(_SIZE // 2):
            angle = _ORDERS[a] * _PERIOD_S * speed[k]
            c, s = np.cos(angle), np.sin(angle)
            F[2 * a, 2 * a] = F[2 * a + 1, 2 * a + 1] = c
            F[2 * a, 2 * a + 1] = s
            F[2 * a + 1, 2 * a] = -s
        for i in range(_SIZE):
            total = np.float32(0)
            for j in range(_SIZE):
                total += F[i, j] * x[j]
                part = np.float32(0)
                for m in range(_SIZE):
                    part += F[i, m] * P[m, j]
                FP[i, j] = part
            turned[i] = total
        for i in range(_SIZE):
            x[i] = turned[i]
            for j in range(_SIZE):
                part = np.float32(0)
                for m in range(_SIZE):
                    part += FP[i, m] * F[j, m]
                P[i, j] = part
            P[i, i] += _Q
    return ripple
