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
PARTS: Final = 16


@dataclass(frozen=True)
class OutputCycles:
    """One of them.

    Attributes
    ----------
    cycles : int
        Cycles per output turn.
    amplitude_Nm, amplitude_standard_uncertainty_Nm : float
        Amplitude, zero to peak, and its standard uncertainty, Nm.
    evidence : float
        Logarithm of the likelihood gained, beyond what its coefficients cost.
    """

    cycles: int
    amplitude_Nm: float
    amplitude_standard_uncertainty_Nm: float
    evidence: float


def find_output_cycles(rows: MovingRows, ratio: Fraction) -> tuple[OutputCycles, ...]:
    """Measure the torque's cycles per output turn, 1 to 8, and give those that are there.

    A cycle is there where the likelihood it gains pays for its two coefficients (Schwarz's
    criterion, BIC), as with the orders of the ripple.

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
        Those with evidence; empty where the output turns by less than two turns.
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
    covariance = inverse @ (scores.T @ scores) @ inverse * PARTS / (PARTS - 1)
    covariance = np.maximum(np.diag(covariance), np.diag(inverse) * float(np.mean(left**2)))
    measured = [
        _measure(
            cycles,
            float(np.hypot(solution[place], solution[count + place])),
            float(covariance[place] + covariance[count + place]),
            len(left),
        )
        for place, cycles in enumerate(CYCLES)
    ]
    return tuple(each for each in measured if each.evidence > 0.0)


def _measure(cycles: int, amplitude_Nm: float, variance_Nm2: float, rows: int) -> OutputCycles:
    # Few stretches know their own scatter badly: Student's t takes the place of the normal.
    freedom = 2 * (PARTS - 1)
    share = 2 * amplitude_Nm**2 / max(variance_Nm2, 1e-24) / freedom
    gain = 0.5 * (freedom + 2) * float(np.log1p(share))
    deviation_Nm = float(np.sqrt(variance_Nm2 / 2))
    return OutputCycles(cycles, amplitude_Nm, deviation_Nm, gain - float(np.log(rows)))
