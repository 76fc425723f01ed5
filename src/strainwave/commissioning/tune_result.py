"""What `strainwave calibrate tune` found, and its JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.calibrate.tuning import Advice


@dataclass(frozen=True)
class Tuning:
    """Where the runs have led, and what comes next.

    Attributes
    ----------
    left : numpy.ndarray
        Amplitude of the sum in each run, shape (runs, harmonics), V.
    standard_uncertainties : numpy.ndarray
        Of its phasors, same shape, V.
    threshold : float
        Amplitude at which a line is gone, V.
    is_done : bool
        Whether it is, in the last run, or as far as the potentiometers' steps go.
    advice : Advice
        What to turn.
    steps : tuple of str
        Settings of the potentiometers after the turns; empty where their steps are not told.
    expected : numpy.ndarray or None
        Amplitude expected after the turns, shape (harmonics,), V.
    warnings : tuple of str
        What to know.
    """

    left: NDArray[np.float64]
    standard_uncertainties: NDArray[np.float64]
    threshold: float
    is_done: bool
    advice: Advice
    steps: tuple[str, ...]
    expected: NDArray[np.float64] | None
    warnings: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON.

        Returns
        -------
        dict
            By name, as in the reference of the command.
        """
        phasors = self.advice.phasors
        return {
            "is_done": self.is_done,
            "residual": self.left.tolist(),
            "residual_standard_uncertainty": self.standard_uncertainties.tolist(),
            "threshold": self.threshold,
            "is_trial": self.advice.is_trial,
            "runs_missing": self.advice.runs_missing,
            "turns": [
                {"gauge": turn.gauge, "now": turn.now, "then": turn.then, "change": turn.change}
                for turn in self.advice.turns
            ],
            "steps": list(self.steps),
            "residual_expected": None if self.expected is None else self.expected.tolist(),
            "amplitudes": None if phasors is None else np.abs(phasors).tolist(),
            "unit": "V",
            "warnings": list(self.warnings),
        }
