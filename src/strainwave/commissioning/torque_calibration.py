"""A table of loads in, ``[torque_calibration]`` out: all of `strainwave calibrate torque`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from strainwave.calibrate.checks import real_number, whole_number
from strainwave.commissioning.torque_fit import FitOptions, fit_torque
from strainwave.commissioning.torque_result import TorqueCalibrated, TorqueFit
from strainwave.commissioning.torque_table import read_load_table
from strainwave.commissioning.torque_warnings import warnings_of
from strainwave.errors import InputError
from strainwave.joint import Provenance, build_section, write_joint
from strainwave.records.joint_output import check_joint_output, started_joint
from strainwave.records.voltages import codes_to_volts

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from strainwave.joint import Joint, JointFile

_SOURCE = "the torque calibration"
_LEAST_RATED_NM, _LARGEST_RATED_NM = 1e-6, 1e7

Configuration = Literal["flexspline-fixed", "circular-spline-fixed"]
_CONFIGURATIONS: dict[str, str] = {
    "flexspline-fixed": "fixed_flexspline",
    "circular-spline-fixed": "fixed_circular_spline",
}

_SENSITIVITIES = {
    "axial-force": "axial_force_sensitivity_Nm_per_N",
    "radial-force": "radial_force_sensitivity_Nm_per_N",
    "tilting-moment": "tilting_moment_sensitivity",
}


@dataclass(frozen=True)
class TorqueOptions:
    """What a person tells a torque calibration.

    Attributes
    ----------
    mapping : sequence of str
        What followed ``--map``.
    rated_torque_Nm : float or None
        Full scale, where the joint file does not say it.
    ratio : float or None
        Ratio of the gear; with `configuration` and the rated torque it makes a section [gear].
    configuration : str or None
        "flexspline-fixed" or "circular-spline-fixed".
    harmonics : int
        Harmonics of the fluctuation, N.
    through_origin : bool
        Whether lines pass the origin.
    load_uncertainty_percent : float or None
        Standard uncertainty of the loads, percent of the load.
    resolution_V : float or None
        Smallest step of the readings, V.
    """

    mapping: Sequence[str] = ()
    rated_torque_Nm: float | None = None
    ratio: float | None = None
    configuration: Configuration | None = None
    harmonics: int = 2
    through_origin: bool = False
    load_uncertainty_percent: float | None = None
    resolution_V: float | None = None


def calibrate_torque(
    path: Path,
    out: Path,
    options: TorqueOptions,
    *,
    joint_path: Path | None = None,
    command: str | None = None,
    before_writing: Callable[[TorqueCalibrated], None] | None = None,
) -> TorqueCalibrated:
    """Calibrate torque from a table of loads, and write it to a joint file.

    Parameters
    ----------
    path : Path
        The table: CSV or Parquet.
    out : Path
        The joint file; written whole or not at all. It may be `joint_path`, and no other file that
        is there already.
    options : TorqueOptions
        What else is told.
    joint_path : Path, optional
        A joint file to start from; its other sections stay.
    command : str, optional
        The command line, for the provenance.
    before_writing : callable, optional
        Called with the result just before the joint file is written, such as for its figure: where
        that fails, nothing is written.

    Returns
    -------
    TorqueCalibrated
        What was found and written.

    Raises
    ------
    InputError
        If something that was given cannot be used; nothing is written then.
    """
    path, out = Path(path), Path(out)
    check_joint_output(out, path, joint_path)
    _check(options)
    joint_file = started_joint(path, joint_path)
    joint = joint_file.joint
    rated_Nm = _rated_torque_Nm(options, joint, joint_path)
    makes_gear = joint.gear is None and options.ratio is not None
    fit_options = FitOptions(
        rated_torque_Nm=rated_Nm,
        may_linearise=joint.gear is not None or makes_gear,
        through_origin=options.through_origin,
        harmonics=options.harmonics,
        load_uncertainty=None
        if options.load_uncertainty_percent is None
        else options.load_uncertainty_percent / 100.0,
        resolution_V=options.resolution_V,
    )
    table = read_load_table(path, options.mapping, codes_to_volts(joint))
    try:
        fit = fit_torque(table.loadings, fit_options)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    provenance = Provenance.of_file(path, command=command)
    sections = _fill(joint_file, fit, options, provenance, makes_gear=makes_gear)
    result = TorqueCalibrated(path, out, fit, sections, warnings_of(table, fit, fit_options))
    if before_writing is not None:
        before_writing(result)
    write_joint(joint_file, out)
    return result


def _check(options: TorqueOptions) -> None:
    if whole_number("--harmonics", options.harmonics) > 100:
        raise InputError(
            f"--harmonics {options.harmonics}: expected at most 100; correct this value"
        )
    for name, value, low, high, unit in (
        ("--rated-torque", options.rated_torque_Nm, _LEAST_RATED_NM, _LARGEST_RATED_NM, " Nm"),
        ("--ratio", options.ratio, 1.0, 1e6, ""),
        ("--load-uncertainty", options.load_uncertainty_percent, 0.0, 100.0, " %"),
        ("--resolution", options.resolution_V, 0.0, 1e3, " V"),
    ):
        if value is not None and not low <= real_number(name, value) <= high:
            raise InputError(
                f"{name} {value:g}: expected {low:g} to {high:g}{unit}; correct this value"
            )
    if (options.ratio is None) != (options.configuration is None):
        given = "--ratio" if options.configuration is None else "--configuration"
        missing = "--configuration" if options.configuration is None else "--ratio"
        raise InputError(
            f"{given} is given without {missing}; expected both, for the section [gear], or "
            f"neither, so add {missing} or leave it out"
        )


def _rated_torque_Nm(options: TorqueOptions, joint: Joint, joint_path: Path | None) -> float | None:
    told = options.rated_torque_Nm
    if joint.gear is None:
        if options.ratio is not None and told is None:
            raise InputError(
                "--ratio and --configuration are given without --rated-torque; expected all three, "
                "for the section [gear], so add --rated-torque or leave them out"
            )
        return told
    if options.ratio is not None:
        raise InputError(
            f"--ratio: {joint_path} has a section [gear] already; expected one place that says the "
            "gear, so leave --ratio and --configuration out"
        )
    if told is not None and told != joint.gear.rated_torque_Nm:
        raise InputError(
            f"--rated-torque {told:g}: {joint_path} has rated_torque_Nm = "
            f"{joint.gear.rated_torque_Nm:g} in [gear]; expected one full scale, so leave the "
            "option out or correct the file"
        )
    return joint.gear.rated_torque_Nm


def _fill(
    joint_file: JointFile,
    fit: TorqueFit,
    options: TorqueOptions,
    provenance: Provenance,
    *,
    makes_gear: bool,
) -> tuple[str, ...]:
    sections = []
    values: dict[str, Any]
    if makes_gear:
        assert options.configuration is not None
        values = {
            "configuration": _CONFIGURATIONS[options.configuration],
            "ratio": float(options.ratio or 0.0),
            "rated_torque_Nm": options.rated_torque_Nm,
        }
        gear = build_section("gear", values, _SOURCE)
        joint_file.set_section("gear", gear, provenance)
        sections.append("gear")
    section = build_section("torque_calibration", _values(fit), _SOURCE)
    joint_file.set_section("torque_calibration", section, provenance)
    sections.append("torque_calibration")
    drift = fit.drift
    if drift is not None:
        values = {
            "reference_temperature_degC": drift.reference_degC,
            "zero_drift_V_per_K": drift.zero_V_per_K if drift.zero_is_told else 0.0,
            "zero_drift_standard_uncertainty_V_per_K": drift.zero_standard_error_V_per_K,
            "gain_drift_per_K": drift.gain_per_K if drift.gain_is_told else 0.0,
            "gain_drift_standard_uncertainty_per_K": drift.gain_standard_error_per_K,
            "lowest_temperature_degC": drift.lowest_degC,
            "highest_temperature_degC": drift.highest_degC,
        }
        temperature = build_section("temperature", values, _SOURCE)
        joint_file.set_section("temperature", temperature, provenance)
        sections.append("temperature")
    return tuple(sections)


def _values(fit: TorqueFit) -> dict[str, Any]:
    values: dict[str, Any] = {
        "gain_Nm_per_V": fit.gain_Nm_per_V,
        "zero_V": fit.zero_V,
        "linearisation": [float(value) for value in fit.coefficients],
        "experiment_count": len(fit.lines),
    }
    # The origin is a point of a line that is made to pass it.
    loads = np.append(fit.loadings.load_Nm, [0.0] if fit.through_origin else [])
    values["lowest_torque_Nm"], values["highest_torque_Nm"] = float(loads.min()), float(loads.max())
    if fit.gain_budget.components:
        values["gain_standard_uncertainty_Nm_per_V"] = fit.gain_budget.combined
    if fit.scatter is not None:
        values["consistency"] = abs(fit.scatter.consistency)
    for side in fit.crosstalk:
        values[_SENSITIVITIES[side.name]] = fit.gain_Nm_per_V * side.sensitivity_V
    if fit.is_rated:
        for key, errors in (
            ("hysteresis", fit.errors.hysteresis_Nm),
            ("linearity_error", fit.errors.linearity_Nm),
        ):
            finite = errors[np.isfinite(errors)]
            if len(finite):
                values[f"{key}_percent_of_rated_torque"] = fit.percent(float(finite.max()))
    return values
