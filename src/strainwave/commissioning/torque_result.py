"""What a torque calibration found, and how it is told to programs."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.calibrate.crosstalk import Crosstalk
    from strainwave.calibrate.linearisation import Linearisation
    from strainwave.calibrate.loading_series import SeriesErrors
    from strainwave.calibrate.loadings import Loadings
    from strainwave.calibrate.locked_positions import PositionDependence
    from strainwave.calibrate.temperature_drift import TemperatureDrift
    from strainwave.calibrate.torque import Consistency, SensorGain
    from strainwave.calibrate.uncertainty import Budget
    from strainwave.calibrate.variance_components import VarianceComponents


@dataclass(frozen=True)
class TorqueFit:
    """Everything that was found in a table of loads.

    Attributes
    ----------
    loadings : Loadings
        The experiments with torque, their volts without what side loads add.
    full_scale_Nm : float
        FS: the rated torque, or the largest load where that is not known.
    is_rated : bool
        Whether it is the rated torque.
    through_origin : bool
        Whether lines were made to pass the origin.
    lines, origin_lines : tuple of SensorGain
        Line of each experiment, and the one through the origin; of these none where a large zero
        leaves one without a gain.
    linearisation : Linearisation
        Polynomial of the order the data support.
    coefficients : tuple of float
        Polynomial in use: that of `linearisation`, or none where it cannot be written.
    gains_Nm_per_V, zeros_V : numpy.ndarray
        Gain and zero of each experiment for that polynomial, shape (experiments,).
    gain_Nm_per_V, zero_V : float
        Their means, the result.
    scatter : Consistency or None
        What several experiments say about the gain; None for a single one.
    origin_scatter : Consistency or None
        The same for lines through the origin, as the paper fits them.
    errors : SeriesErrors
        Linearity, hysteresis, repeatability, zero return.
    interpolation_error_Nm, total_error_Nm : float
        Largest distance of the means over experiments, and of any reading, from the result.
    drift : TemperatureDrift or None
        Drift over temperature.
    position_dependence : tuple of PositionDependence
        Harmonics of gain and zero over the positions.
    alias_shares : numpy.ndarray
        Share of each harmonic that enters zero and gain; empty where no positions are told.
    over_positions, over_mountings : VarianceComponents or None
        Scatter within and between.
    crosstalk : tuple of Crosstalk
        Sensitivities to side loads.
    gain_budget, torque_budget : Budget
        Uncertainty of the gain, Nm/V, and of a torque at full scale at a new position, %FS.
    outlying_experiment : int or None
        Index of an experiment whose gain stands out.
    outlying_rows : numpy.ndarray
        Indices of readings that stand out.
    """

    loadings: Loadings
    full_scale_Nm: float
    is_rated: bool
    through_origin: bool
    lines: tuple[SensorGain, ...]
    origin_lines: tuple[SensorGain, ...]
    linearisation: Linearisation
    coefficients: tuple[float, ...]
    gains_Nm_per_V: NDArray[np.float64]
    zeros_V: NDArray[np.float64]
    gain_Nm_per_V: float
    zero_V: float
    scatter: Consistency | None
    origin_scatter: Consistency | None
    errors: SeriesErrors
    interpolation_error_Nm: float
    total_error_Nm: float
    drift: TemperatureDrift | None
    position_dependence: tuple[PositionDependence, ...]
    alias_shares: NDArray[np.float64]
    over_positions: VarianceComponents | None
    over_mountings: VarianceComponents | None
    crosstalk: tuple[Crosstalk, ...]
    gain_budget: Budget
    torque_budget: Budget
    outlying_experiment: int | None
    outlying_rows: NDArray[np.intp]

    def percent(self, torque_Nm: float) -> float:
        """Give a torque in percent of full scale.

        Parameters
        ----------
        torque_Nm : float
            Torque, Nm.

        Returns
        -------
        float
            %FS.
        """
        return 100.0 * float(torque_Nm) / self.full_scale_Nm

    def prediction_interval(self) -> tuple[float, float] | None:
        """95 % interval of the gain at one more position.

        Returns
        -------
        tuple of float or None
            Lower and upper end, Nm/V; None for a single experiment.
        """
        if self.scatter is None:
            return None
        reach = self.scatter.prediction_95 * abs(self.gain_Nm_per_V)
        return self.gain_Nm_per_V - reach, self.gain_Nm_per_V + reach


@dataclass(frozen=True)
class TorqueCalibrated:
    """A torque calibration that was written.

    Attributes
    ----------
    path, out : Path
        The table and the joint file.
    fit : TorqueFit
        What was found.
    sections : tuple of str
        Sections that were written.
    warnings : tuple of str
        What a person should know.
    """

    path: Path
    out: Path
    fit: TorqueFit
    sections: tuple[str, ...]
    warnings: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Give the result as plain values.

        Returns
        -------
        dict
            What `--json` prints; None where something is not told by the data.
        """
        fit = self.fit
        scatter, origin = fit.scatter, fit.origin_scatter
        origin_gains = [line.gain_Nm_per_V for line in fit.origin_lines]
        values: dict[str, Any] = {
            "gain_Nm_per_V": fit.gain_Nm_per_V,
            "zero_V": fit.zero_V,
            "gain_standard_uncertainty": fit.gain_budget.combined
            if fit.gain_budget.components
            else None,
            "consistency": None if scatter is None else scatter.consistency,
            "consistency_interval_95": None
            if scatter is None
            else [scatter.consistency_low, scatter.consistency_high],
            "prediction_interval_95": fit.prediction_interval(),
            "linearity_error_FS": fit.percent(_largest(fit.errors.linearity_Nm)),
            "hysteresis_FS": fit.percent(_largest(fit.errors.hysteresis_Nm)),
            "reversibility_FS": fit.percent(_largest(fit.errors.reversibility_Nm)),
            "zero_return_FS": fit.percent(_largest(fit.errors.zero_return_Nm)),
            "repeatability_FS": fit.percent(fit.errors.repeatability_Nm),
            "reproducibility_FS": fit.percent(fit.errors.reproducibility_Nm),
            "interpolation_error_FS": fit.percent(fit.interpolation_error_Nm),
            "total_error_FS": fit.percent(fit.total_error_Nm),
            "full_scale_Nm": fit.full_scale_Nm,
            "full_scale_source": "rated torque" if fit.is_rated else "largest load",
            "linearisation": {
                "order": len(fit.linearisation.curve.coefficients) + 1,
                "coefficients": fit.linearisation.curve.coefficients,
                "is_written": bool(fit.coefficients),
                "evidence": [
                    {
                        "order": each.order,
                        "prediction_error_FS": fit.percent(each.prediction_error_Nm),
                        "p_value": each.p_value,
                    }
                    for each in fit.linearisation.evidence
                ],
            },
            "through_origin": {
                "gain_Nm_per_V": float(np.mean(origin_gains)) if origin_gains else None,
                "consistency": None if origin is None else origin.consistency,
            },
            "gain_uncertainty": _budget(fit.gain_budget),
            "torque_uncertainty_FS": _budget(fit.torque_budget),
            "temperature": None if fit.drift is None else asdict(fit.drift),
            "positions": {
                "alias_shares": fit.alias_shares.tolist(),
                "dependence": [asdict(each) for each in fit.position_dependence],
                "gain_scatter": _components(fit.over_positions),
            },
            "mountings": {"gain_scatter": _components(fit.over_mountings)},
            "crosstalk": [crosstalk_dict(fit, each) for each in fit.crosstalk],
            "experiments": [self._experiment(index) for index in range(len(fit.lines))],
            "sections": self.sections,
            "warnings": self.warnings,
        }
        plain: dict[str, Any] = _plain(values)
        return plain

    def _experiment(self, index: int) -> dict[str, Any]:
        fit = self.fit
        loadings, line = fit.loadings, fit.lines[index]
        loads = loadings.load_Nm[loadings.experiment == index]
        positions, temperatures = loadings.position_rad, loadings.temperature_degC
        return {
            "name": loadings.names[index],
            "gain_Nm_per_V": fit.gains_Nm_per_V[index],
            "zero_V": fit.zeros_V[index],
            "gain_standard_error_Nm_per_V": line.gain_standard_error_Nm_per_V,
            "gain_through_origin_Nm_per_V": fit.origin_lines[index].gain_Nm_per_V
            if fit.origin_lines
            else None,
            "residual_rms_FS": fit.percent(line.residual_rms_Nm),
            "linearity_error_FS": fit.percent(fit.errors.linearity_Nm[index]),
            "hysteresis_FS": fit.percent(fit.errors.hysteresis_Nm[index]),
            "zero_return_FS": fit.percent(fit.errors.zero_return_Nm[index]),
            "readings": len(loads),
            "lowest_load_Nm": loads.min(),
            "highest_load_Nm": loads.max(),
            "position_rad": None if positions is None else positions[index],
            "temperature_degC": None if temperatures is None else temperatures[index],
            "mounting": None if loadings.mounting is None else loadings.mounting[index],
        }


def crosstalk_dict(fit: TorqueFit, each: Crosstalk) -> dict[str, Any]:
    """Give a crosstalk sensitivity in torque.

    Parameters
    ----------
    fit : TorqueFit
        The calibration.
    each : Crosstalk
        A sensitivity in volts.

    Returns
    -------
    dict
        ``sensitivity``, torque per side load, in Nm/N or for the tilting moment in percent of it;
        to be taken from the torque where the side load is measured in use.
    """
    of_moment = each.name == "tilting-moment"
    factor = abs(fit.gain_Nm_per_V) * (100.0 if of_moment else 1.0)
    signed = factor * float(np.sign(fit.gain_Nm_per_V))
    return {
        "side_load": each.name,
        "sensitivity": signed * each.sensitivity_V,
        "standard_uncertainty": factor * each.standard_error_V,
        "unit": "% of the moment" if of_moment else "Nm/N",
        "error_at_largest_FS": fit.percent(
            abs(fit.gain_Nm_per_V * each.sensitivity_V) * each.largest
        ),
        "largest_applied": each.largest,
    }


def _largest(values: NDArray[np.float64]) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if len(finite) else float("nan")


def _budget(budget: Budget) -> dict[str, Any]:
    return {
        "components": [asdict(part) for part in budget.components],
        "combined": budget.combined,
        "degrees_of_freedom": budget.degrees_of_freedom,
        "coverage_factor": budget.coverage_factor,
        "expanded_95": budget.expanded,
    }


def _components(found: VarianceComponents | None) -> dict[str, Any] | None:
    return None if found is None else asdict(found)


def _plain(value: Any) -> Any:
    """Give lists for tuples, plain numbers, None for what is not finite."""
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(each) for each in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value
