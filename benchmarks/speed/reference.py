"""What every implementation has to agree with: both filters as dense matrices in double."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks.accuracy.methods.reference_filter import ReferenceSettings, reference_filter
from benchmarks.speed.inputs import RATIO, SAMPLE_PERIOD_S

if TYPE_CHECKING:
    from benchmarks.speed.inputs import Array, Recording

#: The published filter: Taghirad & Belanger 1999, section VI.
PUBLISHED_ORDERS: Final = (2.0, 4.0, 1.0 / RATIO)
PROCESS_NOISE_NM2: Final = 1e3
MEASUREMENT_NOISE_NM2: Final = 1.0
INITIAL_VARIANCE_NM2: Final = 1e3

#: The default filter with 15 states: load and speed terms for orders 2 and 4.
DEFAULT_TERMS: Final = (
    *((order, kind) for order in (2.0, 4.0) for kind in ("constant", "load", "speed")),
    (1.0 / RATIO, "constant"),
)
DEFAULT_SETTINGS: Final = ReferenceSettings(
    DEFAULT_TERMS,
    memory_turns=300.0,
    contact_rule="jump",
    scale_rate_per_rad=0.06,
    load_flattens=True,
    variance_limited=True,
    noise_shared=True,
    noise_after=True,
    gaps_bridged=True,
    rest_is_exact=True,
)


def published_ripple(recording: Recording, samples: int) -> Array:
    """Run the published filter, eq. (9) to (14), as it stands in a textbook.

    Parameters
    ----------
    recording : Recording
        Signals.
    samples : int
        How many of them.

    Returns
    -------
    numpy.ndarray
        Ripple predicted from the samples before, Nm, shape (samples,).
    """
    size = 2 * len(PUBLISHED_ORDERS)
    row = np.tile([1.0, 0.0], len(PUBLISHED_ORDERS))
    state = np.zeros(size)
    P = INITIAL_VARIANCE_NM2 * np.eye(size)
    Q = PROCESS_NOISE_NM2 * np.eye(size)
    ripple = np.empty(samples)
    for k in range(samples):
        ripple[k] = row @ state
        gain = P @ row / (row @ P @ row + MEASUREMENT_NOISE_NM2)
        state = state + gain * (recording.torque_Nm[k] - ripple[k])
        # Joseph's form, which nobody else uses here: positive whatever rounding does.
        left = np.eye(size) - np.outer(gain, row)
        P = left @ P @ left.T + MEASUREMENT_NOISE_NM2 * np.outer(gain, gain)
        turn = turning(recording.motor_speed_rad_s[k])
        state = turn @ state
        P = turn @ P @ turn.T + Q
    return ripple


def turning(motor_speed_rad_s: float) -> Array:
    """Build Phi of eq. (10).

    Parameters
    ----------
    motor_speed_rad_s : float
        Speed from this sample to the next.

    Returns
    -------
    numpy.ndarray
        One rotation for each order, shape (6, 6).
    """
    matrix = np.zeros((6, 6))
    for a, order in enumerate(PUBLISHED_ORDERS):
        angle = order * SAMPLE_PERIOD_S * motor_speed_rad_s
        c, s = np.cos(angle), np.sin(angle)
        matrix[2 * a : 2 * a + 2, 2 * a : 2 * a + 2] = [[c, s], [-s, c]]
    return matrix


def default_ripple(recording: Recording, samples: int, *, limited: bool = True) -> Array:
    """Run the default filter as the accuracy bench's independent implementation has it.

    Parameters
    ----------
    recording : Recording
        Signals.
    samples : int
        How many of them.
    limited : bool
        Whether a pair gains the less process noise the less it is known, and after a sample. The
        peers go without, and give it before.

    Returns
    -------
    numpy.ndarray
        Ripple predicted from the samples before, Nm, shape (samples,).
    """
    return reference_filter(
        replace(DEFAULT_SETTINGS, variance_limited=limited, noise_after=limited),
        recording.time_s[:samples],
        recording.motor_angle_rad[:samples],
        recording.torque_Nm[:samples],
    ).ripple_Nm
