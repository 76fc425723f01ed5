"""The default ripple filter with 15 states for numba: its equations, dense, in float.

Checks of the sample, gaps, delays and frozen terms are left out, in this peer's favour.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.inputs import RATIO, SAMPLE_PERIOD_S
from benchmarks.speed.peers import numba_options

_PAIRS: Final = 7
_SIZE: Final = 1 + 2 * _PAIRS
_ORDERS: Final = np.array([2.0, 4.0, 1.0 / RATIO])
#: First pair of each order, and one past the last: constant, load and speed for the first two.
_FIRST: Final = np.array([0, 3, 6, 7])
_float = np.float32
_DT_S: Final = _float(SAMPLE_PERIOD_S)
_R: Final = _float(0.04**2)
_WALK: Final = _float(1.3**2)
_LIMIT: Final = _float(2.0**2)
_RATED_NM: Final = _float(40)
_REFERENCE_SPEED: Final = _float(150)
_MEMORY_RAD: Final = _float(2 * math.pi * 300)
_LEAST_SPEED: Final = _float(2)
_MOVING_SHARE: Final = _float(SAMPLE_PERIOD_S / (SAMPLE_PERIOD_S + 0.05))
_SPEED_SHARE: Final = _float(SAMPLE_PERIOD_S / (SAMPLE_PERIOD_S + 0.01))
_LOAD_SHARE: Final = _float(SAMPLE_PERIOD_S / (SAMPLE_PERIOD_S + 1 / (2 * math.pi * 15)))
_LEAST_SCALE: Final = _float(0.5 * 0.04)


@numba.njit(fastmath=numba_options.fastmath)  # type: ignore[untyped-decorator]
def _regressors(angle_rad: float, load: np.float32, speed: np.float32, waves: Any, h: Any) -> None:
    for a in range(3):
        turns = _ORDERS[a] * angle_rad / (2 * math.pi)
        rest = _float((turns - math.floor(turns + 0.5)) * (2 * math.pi))
        waves[a, 0], waves[a, 1] = np.cos(rest), np.sin(rest)
    for a in range(3):
        for b in range(2):
            h[1 + 2 * _FIRST[a] + b] = waves[a, b]
    for a in range(2):
        for b in range(2):
            h[3 + 2 * _FIRST[a] + b] = load * waves[a, b]
            h[5 + 2 * _FIRST[a] + b] = speed * waves[a, b]


@numba.njit(fastmath=numba_options.fastmath)  # type: ignore[untyped-decorator]
def _add_noise(P: Any, h: Any, waves: Any, last: Any, rotation: np.float32, gained: Any) -> None:
    share = (rotation / _MEMORY_RAD) ** 2
    for a in range(3):
        cosine, sine = waves[a, 0] - last[a, 0], waves[a, 1] - last[a, 1]
        chord = cosine * cosine + sine * sine
        weight = _float(0)
        for i in range(1 + 2 * _FIRST[a], 1 + 2 * _FIRST[a + 1]):
            weight += h[i] * h[i]
        of_order = _float(0)
        if chord > 0:
            of_order = _float(2) * share * (_R + _WALK * _DT_S / chord) / weight
        for b in range(_FIRST[a], _FIRST[a + 1]):
            gained[b] = of_order
    for i in range(1, _SIZE):
        if P[i, i] > _LIMIT:
            shrink = np.sqrt(_LIMIT / P[i, i])
            for j in range(_SIZE):
                P[i, j] *= shrink
            for j in range(_SIZE):
                P[j, i] *= shrink
        P[i, i] += gained[(i - 1) // 2]


@numba.njit(fastmath=numba_options.fastmath)  # type: ignore[untyped-decorator]
def _update(
    x: Any, P: Any, h: Any, seen: Any, innovation: np.float32, scale: np.float32, moving: bool
) -> None:
    variance = _R
    ripple_variance = _float(0)
    for i in range(_SIZE):
        total = _float(0)
        for j in range(_SIZE):
            total += P[i, j] * h[j]
        seen[i] = total
        variance += h[i] * total
        if i > 0:
            ripple_variance += h[i] * (total - P[i, 0])
    if not moving:
        gain = seen[0] / variance
        x[0] += gain * innovation
        for j in range(1, _SIZE):
            P[0, j] -= gain * seen[j]
            P[j, 0] = P[0, j]
        P[0, 0] += gain * (gain * variance - _float(2) * seen[0])
        return
    limit = _float(9) * max(scale * scale, ripple_variance)
    if innovation * innovation > limit:
        jump = variance * (innovation * innovation / limit - _float(1))
        P[0, 0] += jump
        seen[0] += jump
        variance += jump
    inverse = _float(1) / variance
    for i in range(_SIZE):
        gain = seen[i] * inverse
        x[i] += gain * innovation
        for j in range(_SIZE):
            P[i, j] -= gain * seen[j]


@numba.njit(fastmath=numba_options.fastmath)  # type: ignore[untyped-decorator]
def _scale_after(scale: np.float32, innovation: np.float32, rotation: np.float32) -> np.float32:
    beyond = _float(1) if abs(innovation) > scale else _float(0)
    change = _float(0.06) * min(abs(rotation), _float(3)) * (beyond - _float(0.3))
    return max(scale * np.exp(change), _LEAST_SCALE)


@numba.njit(fastmath=numba_options.fastmath)  # type: ignore[untyped-decorator]
def _start(x: Any, P: Any, h: Any, torque: np.float32) -> None:
    # T is what the coefficients leave, and as uncertain as they and the noise are.
    x[0] = torque
    variance = _R
    for i in range(1, _SIZE):
        P[0, i] = -_LIMIT * h[i]
        P[i, 0] = P[0, i]
        variance += _LIMIT * h[i] * h[i]
    P[0, 0] = variance


@numba.njit(fastmath=numba_options.fastmath)  # type: ignore[untyped-decorator]
def filtered(torque: NDArray[Any], angle_rad: NDArray[Any]) -> NDArray[Any]:
    """Filter a recording.

    Parameters
    ----------
    torque : numpy.ndarray
        Nm, float32, shape (samples,).
    angle_rad : numpy.ndarray
        Motor angle, float64, shape (samples,).

    Returns
    -------
    numpy.ndarray
        Predicted ripple, float32.
    """
    x = np.zeros(_SIZE, np.float32)
    P = _LIMIT * np.eye(_SIZE, dtype=np.float32)
    h = np.zeros(_SIZE, np.float32)
    h[0] = 1
    seen = np.zeros(_SIZE, np.float32)
    waves = np.zeros((3, 2), np.float32)
    last = np.zeros((3, 2), np.float32)
    gained = np.zeros(_PAIRS, np.float32)
    scale = _float(0.12)
    speed = smoothed = load_Nm = _float(0)
    ripple = np.empty(len(torque), np.float32)
    for k in range(len(torque)):
        rotation = _float(angle_rad[k] - angle_rad[k - 1]) if k > 0 else _float(0)
        speed += _SPEED_SHARE * (rotation / _DT_S - speed)
        smoothed += _MOVING_SHARE * (rotation / _DT_S - smoothed)
        moving = abs(smoothed) >= _LEAST_SPEED
        load = load_Nm / _RATED_NM
        _regressors(
            angle_rad[k], load / (_float(1) + abs(load)), abs(speed) / _REFERENCE_SPEED, waves, h
        )
        total = _float(0)
        for i in range(1, _SIZE):
            total += h[i] * x[i]
        ripple[k] = total
        rest = torque[k] - total
        if k == 0:
            _start(x, P, h, rest)
            load_Nm = rest
        else:
            P[0, 0] += _WALK * _DT_S
            if moving:
                _add_noise(P, h, waves, last, rotation, gained)
            innovation = rest - x[0]
            _update(x, P, h, seen, innovation, scale, moving)
            if moving:
                scale = _scale_after(scale, innovation, rotation)
            load_Nm += _LOAD_SHARE * (rest - load_Nm)
        for a in range(3):
            last[a, 0], last[a, 1] = waves[a, 0], waves[a, 1]
    return ripple
