"""Readings at several temperatures in, ``[temperature]`` of a joint file out."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

from strainwave.calibrate.thermal import ThermalFit, fit_thermal
from strainwave.errors import InputError
from strainwave.joint import Provenance, build_section, write_joint
from strainwave.records.joint_output import check_joint_output, started_joint
from strainwave.records.mapping import MapKeys
from strainwave.records.table import read_table
from strainwave.records.voltages import codes_to_volts

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from strainwave.joint import Joint

KEYS: Final = MapKeys(
    {"temperature": "temperature", "voltage": "voltage", "load": "torque", "time": "time"},
    example="--map temperature=T_degC,voltage=bridge_V",
)
#: Where nothing names a reference temperature and this one was seen.
USUAL_REFERENCE_DEGC: Final = 20.0
#: A range below which drifts are hardly those of the range of use, K.
SMALL_RANGE_K: Final = 10.0
#: Branches that differ by more than this share of the whole drift are worth a sentence.
_HYSTERESIS_SHARE: Final = 0.05
#: Beyond these a column of temperatures is more likely in another unit.
COLDEST_LIKELY_DEGC: Final = -100.0
HOTTEST_LIKELY_DEGC: Final = 150.0


@dataclass(frozen=True)
class ThermalJoint:
    """What was found.

    Attributes
    ----------
    path, out : Path
        The table, and the joint file that was written.
    fit : ThermalFit
        The drifts.
    gain_drift_per_K : float
        What was written: that of the fit, else that of the joint file, else 0.
    gain_drift_source : str
        "readings", "joint file" or "none".
    zero_drift_FS_per_K : float or None
        Drift of the zero in percent of the rated torque; None where gain or rated torque are not
        known.
    warnings : tuple of str
        What a person should know.
    """

    path: Path
    out: Path
    fit: ThermalFit
    gain_drift_per_K: float
    gain_drift_source: str
    zero_drift_FS_per_K: float | None
    warnings: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, for `--json`.

        Returns
        -------
        dict
            Nothing but texts, finite numbers, lists, dictionaries and None.
        """
        return {
            "input": str(self.path),
            "output": str(self.out),
            **asdict(self.fit),
            "gain_drift_per_K": self.gain_drift_per_K,
            "gain_drift_source": self.gain_drift_source,
            "zero_drift_FS_per_K": self.zero_drift_FS_per_K,
            "warnings": list(self.warnings),
        }


def calibrate_temperature(
    path: Path,
    out: Path,
    mapping: Iterable[str],
    *,
    joint_path: Path | None = None,
    reference_temperature_degC: float | None = None,
    command: str | None = None,
) -> ThermalJoint:
    """Find the drift of zero and gain, and write it to a joint file.

    Parameters
    ----------
    path : Path
        The table or log.
    out : Path
        The joint file; written whole or not at all.
    mapping : iterable of str
        Which columns are what.
    joint_path : Path, optional
        The joint file to start from.
    reference_temperature_degC : float, optional
        Temperature at which ``[torque_calibration]`` holds; without, the joint file's, else 20 degC
        where it was seen, else the middle of the range.
    command : str, optional
        The command line, for the provenance.

    Returns
    -------
    ThermalJoint
        What was found.

    Raises
    ------
    InputError
        If something that was given cannot be used; nothing is written then.
    """
    check_joint_output(out, path, joint_path)
    joint_file = started_joint(path, joint_path)
    joint = joint_file.joint
    table = read_table(
        path,
        mapping,
        KEYS,
        required=("temperature", "voltage"),
        codes_to_volts=codes_to_volts(joint),
    )
    table.require_complete(KEYS.quantities)
    temperature = table.values["temperature"]
    reference = _reference(reference_temperature_degC, joint, temperature)
    try:
        fit = fit_thermal(
            temperature,
            table.values["voltage"],
            load_Nm=table.values.get("load"),
            time_s=table.values.get("time"),
            reference_temperature_degC=reference,
        )
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    gain_drift, source = fit.gain_drift_per_K, "readings"
    if gain_drift is None:
        known = joint.temperature
        gain_drift, source = (
            (0.0, "none") if known is None else (known.gain_drift_per_K, "joint file")
        )
    section = build_section(
        "temperature",
        {
            "reference_temperature_degC": fit.reference_temperature_degC,
            "zero_drift_V_per_K": fit.zero_drift_V_per_K,
            "zero_drift_standard_uncertainty_V_per_K": fit.zero_drift_standard_uncertainty_V_per_K,
            "gain_drift_per_K": gain_drift,
            "gain_drift_standard_uncertainty_per_K": fit.gain_drift_standard_uncertainty_per_K,
            "lowest_temperature_degC": fit.lowest_temperature_degC,
            "highest_temperature_degC": fit.highest_temperature_degC,
        },
        "what was found",
    )
    joint_file.set_section("temperature", section, Provenance.of_file(path, command=command))
    load = table.values.get("load")
    result = ThermalJoint(
        path,
        out,
        fit,
        gain_drift,
        source,
        _in_percent(fit, joint),
        tuple(_warnings(fit, joint, load, source)),
    )
    write_joint(joint_file, out)
    return result


def _reference(asked: float | None, joint: Joint, temperature: NDArray[np.float64]) -> float | None:
    if asked is not None:
        if not -273.15 <= asked <= 1000.0:
            raise InputError(
                f"--reference-temperature {asked:g}: expected degC from -273.15 to 1000; correct this "
                "value"
            )
        return asked
    if joint.temperature is not None:
        return joint.temperature.reference_temperature_degC
    if len(temperature) and temperature.min() <= USUAL_REFERENCE_DEGC <= temperature.max():
        return USUAL_REFERENCE_DEGC
    return None


def _in_percent(fit: ThermalFit, joint: Joint) -> float | None:
    gain = fit.gain_Nm_per_V
    if joint.torque_calibration is not None:
        gain = joint.torque_calibration.gain_Nm_per_V
    if gain is None or joint.gear is None:
        return None
    return 100 * fit.zero_drift_V_per_K * gain / joint.gear.rated_torque_Nm


def _warnings(
    fit: ThermalFit, joint: Joint, load: NDArray[np.float64] | None, source: str
) -> list[str]:
    says = []
    spread = fit.highest_temperature_degC - fit.lowest_temperature_degC
    if spread < SMALL_RANGE_K:
        says.append(
            f"the temperature varies by {spread:.3g} K only: beyond it the drift is not known; warm and "
            "cool over the whole range of use"
        )
    if source != "readings":
        kept = {"none": "0 is written for it", "joint file": "that of the joint file is kept"}[
            source
        ]
        says.append(
            f"the load does not vary, so that only the drift of the zero is known; the gain's is not, "
            f"and {kept}: take readings under load as well, and map load=COLUMN"
        )
        if load is None:
            says.append("no load is mapped: the sensor is taken to carry nothing throughout")
        elif load[0] != 0.0:
            says.append(
                f"the sensor carried {load[0]:.4g} Nm throughout: a drift of the gain is in the drift of "
                "the zero; unload it"
            )
    if fit.lag_is_used and fit.lag_s is not None:
        follows = "follow" if fit.lag_s > 0 else "lead"
        says.append(
            f"the gauges {follows} the thermometer by {abs(fit.lag_s):.3g} s: the drift is that of the "
            "temperature so shifted, and holds where temperatures settle; in use it is wrong by the drift "
            "times rate times this time"
        )
    hysteresis = fit.hysteresis_V
    if (
        hysteresis is not None
        and hysteresis > _HYSTERESIS_SHARE * abs(fit.zero_drift_V_per_K) * spread
        and hysteresis > 2 * fit.residual_rms_V / _root(fit.effective_rows)
    ):
        says.append(
            f"warming and cooling differ by {hysteresis:.3g} V at one temperature: the thermometer is "
            "not where the gauges are, or the readings were taken before temperatures settled; wait "
            "longer at each"
        )
    if fit.curvature_is_clear and fit.curvature_V > fit.residual_rms_V:
        says.append(
            f"the zero does not follow a straight line: it bends by {fit.curvature_V:.3g} V over half of "
            "the range, which the joint file cannot hold"
        )
    gain = fit.gain_Nm_per_V
    section = joint.torque_calibration
    if gain is not None and section is not None:
        off = gain / section.gain_Nm_per_V - 1.0
        if abs(off) > max(0.01, 2 * (section.consistency or 0.0)):
            says.append(
                f"the gain here is {gain:.5g} Nm/V, {off:+.1%} off that of the joint file, which is "
                "kept; check the loads, the units of load and voltage, and the wiring"
            )
    low, high = fit.lowest_temperature_degC, fit.highest_temperature_degC
    if not low <= fit.reference_temperature_degC <= high:
        says.append(
            f"the reference temperature of {fit.reference_temperature_degC:g} degC lies outside of what "
            f"was seen, {low:.4g} to {high:.4g} degC: correct --reference-temperature (in degC), or take readings there"
        )
    if low < COLDEST_LIKELY_DEGC or high > HOTTEST_LIKELY_DEGC:
        says.append(
            f"the temperatures lie from {low:.4g} to {high:.4g} degC: check their unit, such as "
            "temperature=COLUMN:K, and that the columns are not swapped"
        )
    return says


def _root(rows: float) -> float:
    """Root of the independent readings of one branch in a part of the range: six parts, two branches."""
    return math.sqrt(max(rows / 12.0, 1.0))
