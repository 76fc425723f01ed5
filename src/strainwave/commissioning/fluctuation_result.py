"""What `strainwave calibrate fluctuation` found, and its JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave.calibrate.fluctuation_run import rms_left

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.calibrate.fluctuation_run import FluctuationRun
    from strainwave.calibrate.gain_solution import GainSolution
    from strainwave.calibrate.quantise import QuantisedGains
    from strainwave.calibrate.wave_timing import WaveTiming
    from strainwave.commissioning.conditions import Condition
    from strainwave.commissioning.lost_gauges import LostGauges
    from strainwave.commissioning.watch_values import WatchValues


@dataclass(frozen=True)
class FluctuationCalibration:
    """Everything that was found.

    Attributes
    ----------
    log, out : Path
        Recording and joint file.
    conditions : tuple of Condition
        Loads and temperatures.
    runs : tuple of FluctuationRun
        The fit of each.
    harmonics : int
        N, harmonics that were to be cancelled.
    solution : GainSolution
        Gains as solved.
    quantised : QuantisedGains or None
        What a circuit can have of them.
    held_out : numpy.ndarray or None
        Amplitude left in the second half of the run by gains from the first, shape (harmonics
        fitted,).
    lost_gauges : LostGauges
        Gains for the loss of each gauge.
    watch : WatchValues
        Sound gauges, for the watch over them.
    factor : float or None
        Factor m that was used; None where the angle is from the gauges.
    timing : WaveTiming or None
        Factor and delay that the wave itself shows.
    delay_s : float
        Delay of the gauges that was taken out.
    rms_left : float
        Root mean square of what is left in the sum, its uncertainty included.
    warnings : tuple of str
        What to know before the gains are used.
    """

    log: Path
    out: Path
    conditions: tuple[Condition, ...]
    runs: tuple[FluctuationRun, ...]
    harmonics: int
    solution: GainSolution
    quantised: QuantisedGains | None
    held_out: NDArray[np.float64] | None
    lost_gauges: LostGauges
    watch: WatchValues
    factor: float | None
    timing: WaveTiming | None
    delay_s: float
    rms_left: float
    warnings: tuple[str, ...]

    @property
    def gains(self) -> NDArray[np.float64]:
        """The gains that go to the joint file."""
        return self.solution.gains if self.quantised is None else self.quantised.gains

    @property
    def noise_factor(self) -> float:
        """M sum(g^2) / (sum g)^2 of these gains."""
        gains = self.gains
        return len(gains) * float(np.sum(gains**2)) / float(np.sum(gains)) ** 2

    @property
    def mean_phasors(self) -> NDArray[np.complex128]:
        """Phasors of the gauges, mean over the conditions, shape (harmonics fitted, gauges)."""
        return np.asarray(np.mean([run.phasors for run in self.runs], axis=0))

    def left(self, gains: NDArray[np.float64]) -> NDArray[np.float64]:
        """Amplitude of the weighted sum, the worst over the conditions.

        Parameters
        ----------
        gains : numpy.ndarray
            g_j, shape (gauges,).

        Returns
        -------
        numpy.ndarray
            Shape (harmonics fitted,).
        """
        return np.asarray(np.max([np.abs(run.weighted_sum(gains)) for run in self.runs], axis=0))

    @property
    def left_uncertainty(self) -> NDArray[np.float64]:
        """Standard uncertainty of what is left, the largest over the conditions."""
        each = [run.sum_standard_uncertainty(self.gains) for run in self.runs]
        return np.asarray(np.max(each, axis=0))

    def zero_shift_V(self, gains: NDArray[np.float64]) -> float:
        """Zero of other gains less that of these, which the torque's zero is calibrated for.

        Parameters
        ----------
        gains : numpy.ndarray
            g_j, shape (gauges,).

        Returns
        -------
        float
            V.
        """
        return float((gains - self.gains) @ self.watch.zeros_V)

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON.

        Returns
        -------
        dict
            By name, as in the reference of the command.
        """
        count = self.harmonics
        gauges = len(self.gains)
        before, after = self.left(np.ones(gauges)), self.left(self.gains)
        spread = self.left_uncertainty
        mean = self.mean_phasors
        run = self.runs[0]
        lead = 2 * np.arange(1, len(mean) + 1)[:, np.newaxis] * run.positions_rad
        result: dict[str, Any] = {
            "gains": self.gains.tolist(),
            "gains_standard_uncertainty": self.solution.standard_uncertainties.tolist(),
            "noise_factor": self.noise_factor,
            "condition_number": self.solution.condition_number,
            "is_exact": self.solution.is_exact and self.quantised is None,
            "negative_gauges": [int(j) + 1 for j in np.flatnonzero(self.gains < 0)],
            "harmonics": list(self.solution.harmonics),
            "amplitudes": np.abs(mean[:count]).tolist(),
            "amplitudes_standard_error": _combined(
                [each.amplitude_standard_errors[:count] for each in self.runs]
            ),
            "phases_rad": np.angle(mean * np.exp(-1j * lead))[:count].tolist(),
            "phases_standard_error_rad": _combined(
                [each.phase_standard_errors_rad[:count] for each in self.runs]
            ),
            "residual_before": before[:count].tolist(),
            "residual_after": after[:count].tolist(),
            "residual_standard_uncertainty": spread[:count].tolist(),
            "residual_held_out": None if self.held_out is None else self.held_out[:count].tolist(),
            "residual_rms": self.rms_left,
            "not_cancelled": [
                {
                    "harmonic": i + 1,
                    "residual_before": float(before[i]),
                    "residual_after": float(after[i]),
                    "residual_standard_uncertainty": float(spread[i]),
                    "is_present": bool(any(each.is_present[i] for each in self.runs)),
                }
                for i in range(count, len(mean))
            ],
            "unit": "V",
            "positions_rad": run.positions_rad.tolist(),
            "angle_source": "gauges" if self.factor is None else "column",
            "factor_m": self.factor,
            "factor_m_found": None if self.timing is None else self.timing.factor,
            "factor_m_found_standard_uncertainty": (
                None if self.timing is None else self.timing.factor_standard_uncertainty
            ),
            "delay_s": self.delay_s,
            "conditions": [self._condition(place) for place in range(len(self.runs))],
            "quantised": self._quantised(),
            "without_gauge": [
                {
                    "gauge": each.gauge,
                    "gains": each.gains.tolist(),
                    "noise_factor": each.noise_factor,
                    "residual_after": self.left(each.gains)[:count].tolist(),
                    "residual_rms": rms_left(self.runs, each.gains),
                    "zero_shift_V": self.zero_shift_V(each.gains),
                }
                for each in self.lost_gauges.sets
            ],
            "gauge_watch": {
                "zeros_V": self.watch.zeros_V.tolist(),
                "harmonics": len(self.watch.phasors),
                "noise_V": self.watch.noise_V,
                "consistency_limit_V": self.watch.limit_V,
                "consistency_limit_share": self.watch.share,
                "missing": [*self.lost_gauges.says, *self.watch.says],
            },
            "out": str(self.out),
            "warnings": list(self.warnings),
        }
        return result

    def _condition(self, place: int) -> dict[str, Any]:
        run, condition, count = self.runs[place], self.conditions[place], self.harmonics
        return {
            "name": condition.name,
            "load_Nm": condition.load_Nm,
            "temperature_degC": condition.temperature_degC,
            "rows": run.rows,
            "wave_turns": run.wave_turns,
            "trend_degree": run.trend_degree,
            "amplitudes": run.amplitudes[:count].tolist(),
            "phases_rad": run.phase_errors_rad[:count].tolist(),
            "residual_before": np.abs(run.phasors[:count].sum(axis=1)).tolist(),
            "residual_after": np.abs(run.weighted_sum(self.gains))[:count].tolist(),
            "residual_standard_uncertainty": run.sum_standard_uncertainty(self.gains)[
                :count
            ].tolist(),
        }

    def _quantised(self) -> dict[str, Any] | None:
        if self.quantised is None:
            return None
        count = self.harmonics
        return {
            "settings": list(self.quantised.settings),
            "solved_gains": self.solution.gains.tolist(),
            "residual_solved": self.left(self.solution.gains)[:count].tolist(),
            "residual_rounded_one_by_one": self.left(self.quantised.rounded)[:count].tolist(),
        }


def _combined(errors: list[NDArray[np.float64]]) -> list[list[float]]:
    """Combine standard errors to that of a mean over conditions."""
    combined = np.sqrt(np.sum(np.square(errors), axis=0)) / len(errors)
    return [[float(value) for value in row] for row in combined]
