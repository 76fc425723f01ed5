"""Does the filter's own basis contain the generator's ripple? It must not, or the bench flatters.

The basis is written out here from the filter's description: orders 2, 4, 6, each constant, times
load, times the load that flattens, L / (1 + |L|), times speed and times direction, and once per
output turn beside orders 2 and 4, which is more than the filter is given in the bench. Least squares over a whole run may use the truth and the
future; what it leaves no causal filter with constant coefficients can remove.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.signal import lfilter

from benchmarks.accuracy.joint import FULL_SCALE_NM, RATIO, WAVE_FACTOR, Run
from benchmarks.accuracy.motion import FULL_SPEED_RAD_S, SAMPLE_PERIOD_S
from benchmarks.accuracy.ripple import ORDERS

#: Least residual of a mismatch scenario, percent of full scale.
LEAST_RESIDUAL_PERCENT: Final = 0.05
LOAD_CORNER_HZ: Final = 15.0


def basis_residual_percent(run: Run) -> float:
    """Fit the ripple by the filter's full basis and measure what is left.

    Parameters
    ----------
    run : Run
        A run with its true ripple.

    Returns
    -------
    float
        RMS of the residual over the run, percent of full scale.
    """
    keep = np.exp(-2 * np.pi * LOAD_CORNER_HZ * SAMPLE_PERIOD_S)
    load = lfilter([1 - keep], [1, -keep], run.true_torque_Nm) / FULL_SCALE_NM
    speed = run.motion.speed_rad_s
    scales = np.column_stack(
        [
            np.ones(len(load)),
            load,
            load / (1 + np.abs(load)),
            np.abs(speed) / FULL_SPEED_RAD_S,
            speed / (1 + np.abs(speed)),
        ]
    )
    angle = np.multiply.outer(WAVE_FACTOR * run.motion.angle_rad, ORDERS)
    lines = np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    basis = (lines[:, :, None] * scales[:, None, :]).reshape(len(load), -1)
    output = run.motion.angle_rad / RATIO
    beside = [
        wave(angle[:, n] + side * output)
        for n in (0, 1)
        for side in (-1, 1)
        for wave in (np.cos, np.sin)
    ]
    basis = np.column_stack([basis, *beside])
    fit = np.linalg.lstsq(basis, run.ripple_Nm, rcond=None)[0]
    left = run.ripple_Nm - basis @ fit
    return float(100 * np.sqrt(np.mean(left**2)) / FULL_SCALE_NM)
