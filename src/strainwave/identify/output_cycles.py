"""Torque that repeats with the output's angle: misalignment, and gravity beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from fractions import Fraction

    from strainwave.identify.moving_rows import MovingRows

#: Cycles per output turn that are reported.
CYCLES: Final = tuple(range(1, 9))
#: Output turns below which they cannot be told from slow torque, and parts for their scatter.
LEAST_TURNS: Final = 2.0
PARTS: Final = 8


@dataclass(frozen=True)
class OutputCycles:
    """One of them.

    Attributes
    ----------
    cycles : int
        Cycles per output turn.
    amplitude_Nm, amplitude_standard_uncertainty_Nm : float
        Amplitude, zero to peak, and its standard uncertainty, Nm.
    """

    cycles: int
    amplitude_Nm: float
    amplitude_standard_uncertainty_Nm: float


def find_output_cycles(rows: MovingRows, ratio: Fraction) -> tuple[OutputCycles, ...]:
    """Measure the torque's cycles per output turn, 1 to 8.

    Gravity is among them: what is found is reported, and not removed.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion, angles of the motor.
    ratio : fractions.Fraction
        Motor turns per output turn.

    Returns
    -------
    tuple of OutputCycles
        Empty where the output turns by less than two turns.
    """
    if not len(rows):
        return ()
    angle_rad = rows.angle_rad / float(ratio)
    if float(np.ptp(angle_rad)) < LEAST_TURNS * 2 * np.pi:
        return ()
    turned = np.outer(angle_rad, np.array(CYCLES))
    count = len(CYCLES)
    basis = np.column_stack([np.cos(turned), np.sin(turned), np.ones(len(angle_rad))])
    inverse = np.linalg.inv(basis.T @ basis)
    solution = inverse @ (basis.T @ rows.torque_Nm)
    left = rows.torque_Nm - basis @ solution
    # What is left is no white noise: stretches of the recording are independent, not rows.
    parts = np.array_split(np.arange(len(left)), PARTS)
    scores = np.array([basis[part].T @ left[part] for part in parts])
    covariance = inverse @ (scores.T @ scores) @ inverse
    return tuple(
        OutputCycles(
            cycles,
            float(np.hypot(solution[place], solution[count + place])),
            float(
                np.sqrt((covariance[place, place] + covariance[count + place, count + place]) / 2)
            ),
        )
        for place, cycles in enumerate(CYCLES)
    )
