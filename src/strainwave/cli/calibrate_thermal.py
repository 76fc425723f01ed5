"""`strainwave calibrate thermal`: how zero and gain change with temperature."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import cyclopts

if TYPE_CHECKING:
    from strainwave.commissioning.thermal import ThermalJoint


def calibrate_thermal(
    readings: Path,
    /,
    *,
    out: Path,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)] = (),
    joint: Path | None = None,
    reference_temperature: float | None = None,
    json: bool = False,
) -> None:
    """Find the drift of zero and gain over temperature, in a table of readings or a log.

    Example: strainwave calibrate thermal chamber.csv --map
    temperature=T_degC,voltage=bridge_V,load=load_Nm --joint joint.toml --out joint.toml

    Parameters
    ----------
    readings : Path
        Readings in the order in which they were taken: .csv, .tsv, .txt, .parquet or .pq.
    out : Path
        The joint file that is written: .toml.
    map_ : tuple of str
        Which columns are what: key=column[:unit] pairs by commas, with the keys temperature, voltage,
        and where there are such load (torque on the sensor) and time (of a log).
    joint : Path
        A joint file to start from; its other sections stay.
    reference_temperature : float
        Temperature at which the torque calibration holds, degC; the joint file's without, else 20
        where it was seen, else the middle of the range.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_outcome
    from strainwave.cli.repeat import command_text
    from strainwave.commissioning.thermal import calibrate_temperature

    command = command_text(
        ("calibrate", "thermal", readings),
        {
            "--map": map_,
            "--joint": joint,
            "--reference-temperature": reference_temperature,
            "--out": out,
        },
    )
    result = calibrate_temperature(
        readings,
        out,
        map_,
        joint_path=joint,
        reference_temperature_degC=reference_temperature,
        command=command,
    )
    print_outcome(result, _summary, of=readings, as_json=json)


def _summary(result: ThermalJoint) -> list[str]:
    from strainwave.records.identified_log import measured_text

    fit = result.fit
    zero = measured_text(
        1e6 * fit.zero_drift_V_per_K, 1e6 * fit.zero_drift_standard_uncertainty_V_per_K
    )
    share = result.zero_drift_FS_per_K
    lines = [
        f"{result.out}: [temperature] from {fit.rows} readings of {result.path}, "
        f"{fit.lowest_temperature_degC:.4g} to {fit.highest_temperature_degC:.4g} degC, reference "
        f"{fit.reference_temperature_degC:g} degC",
        f"  drift of the zero {zero} uV/K" + ("" if share is None else f", {share:+.3g} %FS/K"),
    ]
    if fit.gain_drift_per_K is not None:
        gain = measured_text(
            1e6 * fit.gain_drift_per_K, 1e6 * (fit.gain_drift_standard_uncertainty_per_K or 0.0)
        )
        lines.append(f"  drift of the gain {gain} ppm/K")
    else:
        lines.append(
            f"  drift of the gain not known ({1e6 * result.gain_drift_per_K:g} ppm/K written)"
        )
    if fit.hysteresis_V is not None:
        lines.append(f"  warming and cooling differ by {1e6 * fit.hysteresis_V:.3g} uV at most")
    if fit.lag_s is not None:
        lag = measured_text(fit.lag_s, fit.lag_standard_uncertainty_s or 0.0)
        lines.append(f"  the gauges follow the thermometer by {lag} s")
    lines.append(f"  {1e6 * fit.residual_rms_V:.3g} uV rms left")
    return lines
