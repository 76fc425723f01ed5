"""Misalignment of gear and load: a signature at whole cycles per output turn.

Taghirad & Belanger 1999, section VI: the sensor is sensitive to torques perpendicular to its axis,
and a misaligned load makes one that repeats with the output's turn.  It is crosstalk of the
sensing, not torque that drives the load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strainwave.simulate.checks import require_number
from strainwave.simulate.trajectories import FloatArray


@dataclass(frozen=True)
class MisalignmentTerm:
    """One sine of the output angle.

    Parameters
    ----------
    cycles_per_output_turn : float
        1 in the paper; 2, 4 and 8 occur as well. Above 0.
    amplitude_Nm : float
        Half of its peak-to-peak value, at least 0.
    phase_rad : float
        Phase at output angle 0, sine form.
    """

    cycles_per_output_turn: float
    amplitude_Nm: float
    phase_rad: float = 0.0

    def __post_init__(self) -> None:
        require_number("cycles_per_output_turn", self.cycles_per_output_turn, "", above=0.0)
        require_number("amplitude_Nm", self.amplitude_Nm, "Nm", minimum=0.0)
        require_number("phase_rad", self.phase_rad, "rad")


@dataclass(frozen=True)
class Misalignment:
    """All misalignment terms of a station.

    Parameters
    ----------
    terms : tuple of MisalignmentTerm
        The terms; none is a perfectly aligned load.
    """

    terms: tuple[MisalignmentTerm, ...] = ()

    def torque_Nm(self, output_angle_rad: FloatArray) -> FloatArray:
        """Return what the sensor reads because of the misalignment.

        Parameters
        ----------
        output_angle_rad : ndarray, shape (n,)
            Output angle, rad.

        Returns
        -------
        ndarray, shape (n,)
            Torque that is read and not transmitted, Nm.
        """
        total = np.zeros(np.shape(output_angle_rad))
        for term in self.terms:
            angle = term.cycles_per_output_turn * output_angle_rad + term.phase_rad
            total = total + term.amplitude_Nm * np.sin(angle)
        return total
