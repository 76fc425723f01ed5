"""From loading experiments to everything that is known of gain, zero and curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import stats

from strainwave.calibrate.crosstalk import crosstalk, has_torque, without_crosstalk
from strainwave.calibrate.linearisation import Linearisation, linearise
from strainwave.calibrate.loading_series import series_errors
from strainwave.calibrate.loadings import require_loads
from strainwave.calibrate.locked_positions import (
    SAME_POSITION_RAD,
    alias_shares,
    position_dependence,
)
from strainwave.calibrate.temperature_drift import temperature_drift
from strainwave.calibrate.torque import consistency, sensor_gain
from strainwave.calibrate.uncertainty import grubbs_outlier
from strainwave.calibrate.variance_components import variance_components
from strainwave.commissioning.torque_budget import gain_budget, torque_budget
from strainwave.commissioning.torque_result import TorqueFit
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.calibrate.loadings import Loadings
    from strainwave.calibrate.torque import Consistency, SensorGain
    from strainwave.calibrate.variance_components import VarianceComponents


@dataclass(frozen=True)
class FitOptions:
    """What a fit has to know beside the loads.

    Attributes
    ----------
    rated_torque_Nm : float or None
        Full scale; the largest load stands in without.
    may_linearise : bool
        Whether a polynomial can be written: it is relative to the rated torque.
    through_origin : bool
        Whether lines pass the origin, as the paper's do.
    harmonics : int
        Harmonics of the fluctuation, N.
    load_uncertainty : float or None
        Standard uncertainty of the loads, relative.
    resolution_V : float or None
        Smallest step of the readings, V.
    """

    rated_torque_Nm: float | None = None
    may_linearise: bool = False
    through_origin: bool = False
    harmonics: int = 2
    load_uncertainty: float | None = None
    resolution_V: float | None = None


def fit_torque(loadings: Loadings, options: FitOptions) -> TorqueFit:
    """Fit gains, zeros and the curve, and find what is known of them.

    Parameters
    ----------
    loadings : Loadings
        The experiments.
    options : FitOptions
        What else is known.

    Returns
    -------
    TorqueFit
        Everything that was found.

    Raises
    ------
    InputError
        If an experiment determines no gain, or the gains are not of one sign.
    """
    side = crosstalk(loadings) if loadings.side_loads else ()
    if side:
        loadings = without_crosstalk(loadings, side).only(has_torque(loadings))
    require_loads(loadings, intercept=not options.through_origin)
    lines = _lines(loadings, intercept=not options.through_origin)
    origin_lines = lines if options.through_origin else _origin_lines(loadings)
    full_scale_Nm = options.rated_torque_Nm or loadings.largest_load_Nm
    linearisation = linearise(loadings, lines, full_scale_Nm)
    curve = linearisation.curve
    is_curved = bool(options.may_linearise and curve.coefficients and not options.through_origin)
    gains = np.array([line.gain_Nm_per_V for line in lines])
    zeros = np.array([line.zero_V for line in lines])
    if is_curved:
        gains, zeros = curve.gains_Nm_per_V, curve.zeros_V
    scatter = consistency(gains) if len(gains) > 1 else None
    coefficients = curve.coefficients if is_curved else ()
    gain, zero_V = float(np.mean(gains)), float(np.mean(zeros))
    distances = loadings.load_Nm - calibrated_torque_Nm(
        loadings.voltage_V, gain, zero_V, coefficients, full_scale_Nm
    )
    level_means = np.bincount(loadings.levels(), distances) / np.bincount(loadings.levels())
    errors = series_errors(loadings, lines)
    interpolation_Nm = float(np.max(np.abs(level_means)))
    temperatures, positions = loadings.temperature_degC, loadings.position_rad
    of_gain = gain_budget(gain, scatter, lines, options.load_uncertainty)
    of_torque = torque_budget(
        gain=gain,
        scatter=scatter,
        lines=lines,
        zeros_V=zeros,
        full_scale_Nm=full_scale_Nm,
        curve_Nm=_curve_error_Nm(loadings, lines, linearisation, is_curved=is_curved),
        errors=errors,
        load_uncertainty=options.load_uncertainty,
        resolution_V=options.resolution_V,
    )
    return TorqueFit(
        loadings=loadings,
        full_scale_Nm=full_scale_Nm,
        is_rated=options.rated_torque_Nm is not None,
        through_origin=options.through_origin,
        lines=lines,
        origin_lines=origin_lines,
        linearisation=linearisation,
        coefficients=coefficients,
        gains_Nm_per_V=gains,
        zeros_V=zeros,
        gain_Nm_per_V=gain,
        zero_V=zero_V,
        scatter=scatter,
        origin_scatter=_origin_scatter(origin_lines),
        errors=errors,
        interpolation_error_Nm=interpolation_Nm,
        total_error_Nm=float(np.max(np.abs(distances))),
        drift=None if temperatures is None else temperature_drift(temperatures, gains, zeros),
        position_dependence=()
        if positions is None
        else position_dependence(positions, gains, zeros, options.harmonics),
        alias_shares=np.empty(0)
        if positions is None
        else alias_shares(positions, options.harmonics),
        over_positions=_over_positions(loadings, gains),
        over_mountings=None
        if loadings.mounting is None
        else variance_components(gains, loadings.mounting),
        crosstalk=side,
        gain_budget=of_gain,
        torque_budget=of_torque,
        outlying_experiment=grubbs_outlier(gains),
        outlying_rows=_outlying_rows(loadings, linearisation),
    )


def calibrated_torque_Nm(
    voltage_V: NDArray[np.float64],
    gain_Nm_per_V: float,
    zero_V: float,
    coefficients: tuple[float, ...],
    full_scale_Nm: float,
) -> NDArray[np.float64]:
    """Torque as the section ``[torque_calibration]`` gives it.

    Parameters
    ----------
    voltage_V : numpy.ndarray
        Sensor output, V.
    gain_Nm_per_V, zero_V : float
        Gain and zero.
    coefficients : tuple of float
        c_2 and on.
    full_scale_Nm : float
        FS, Nm.

    Returns
    -------
    numpy.ndarray
        Torque, Nm.
    """
    u = gain_Nm_per_V * (voltage_V - zero_V) / full_scale_Nm
    bent = sum((c * u**power for power, c in enumerate(coefficients, 2)), start=np.zeros_like(u))
    return np.asarray(full_scale_Nm * (u + bent))


def _lines(loadings: Loadings, *, intercept: bool) -> tuple[SensorGain, ...]:
    lines = []
    for name, rows in zip(loadings.names, loadings.rows(), strict=True):
        try:
            lines.append(
                sensor_gain(loadings.voltage_V[rows], loadings.load_Nm[rows], intercept=intercept)
            )
        except InputError as error:
            raise InputError(f"experiment {name}: {error}") from error
    return tuple(lines)


def _origin_lines(loadings: Loadings) -> tuple[SensorGain, ...]:
    """Lines beside those in use; none where a large zero leaves one without a gain."""
    try:
        return _lines(loadings, intercept=False)
    except InputError:
        return ()


def _origin_scatter(lines: tuple[SensorGain, ...]) -> Consistency | None:
    gains = np.array([line.gain_Nm_per_V for line in lines])
    of_one_sign = len(gains) > 1 and (np.all(gains > 0) or np.all(gains < 0))
    return consistency(gains) if of_one_sign else None


def _curve_error_Nm(
    loadings: Loadings,
    lines: tuple[SensorGain, ...],
    linearisation: Linearisation,
    *,
    is_curved: bool,
) -> float:
    """Largest mean residual at a load, over the experiments, of curve or lines in use."""
    levels = loadings.levels()
    if is_curved:
        residuals = linearisation.curve.residuals_Nm
    else:
        residuals = np.empty(len(loadings))
        for rows, line in zip(loadings.rows(), lines, strict=True):
            read_Nm = line.gain_Nm_per_V * (loadings.voltage_V[rows] - line.zero_V)
            residuals[rows] = loadings.load_Nm[rows] - read_Nm
    means = np.bincount(levels, residuals) / np.bincount(levels)
    return float(np.max(np.abs(means)))


def _over_positions(loadings: Loadings, gains: NDArray[np.float64]) -> VarianceComponents | None:
    if loadings.position_rad is None:
        return None
    # The fluctuation repeats after half a turn.
    angles = np.mod(loadings.position_rad + SAME_POSITION_RAD / 2, np.pi)
    return variance_components(gains, [int(angle / SAME_POSITION_RAD) for angle in angles])


def _outlying_rows(loadings: Loadings, linearisation: Linearisation) -> NDArray[np.intp]:
    """Find readings that the others of their experiment contradict, 5 % over all readings.

    Externally studentized residuals: each reading against the fit without it.
    """
    residuals = linearisation.curve.residuals_Nm
    found = []
    for rows in loadings.rows():
        count, left = len(rows), residuals[rows]
        freedom = count - 3
        if freedom < 2:
            continue
        volts = loadings.voltage_V[rows]
        centred = volts - volts.mean()
        leverage = 1.0 / count + centred**2 / np.sum(centred**2)
        squares = float(np.sum(left**2))
        if squares <= (1e-9 * loadings.largest_load_Nm) ** 2:
            continue
        without = np.maximum(squares - left**2 / (1 - leverage), 1e-12 * squares) / freedom
        student = np.abs(left) / np.sqrt(without * (1 - leverage))
        limit = float(stats.t.ppf(1 - 0.05 / (2 * len(loadings)), freedom))
        found.append(rows[student > limit])
    return np.concatenate(found) if found else np.empty(0, np.intp)
