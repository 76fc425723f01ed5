"""`strainwave tare`: the sensor's zero without unloading it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import cyclopts

if TYPE_CHECKING:
    from strainwave.commissioning.tare_result import TaredJoint


def tare_command(
    poses: Path,
    /,
    *,
    joint: Path,
    out: Path,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)] = (),
    payload_mass: float | None = None,
    lever_arm: float | None = None,
    gravity: float = 9.80665,
    axis_tilt_deg: float = 0.0,
    horizontal_angle_deg: float | None = None,
    accuracy_fs: Annotated[float | None, cyclopts.Parameter(name="--accuracy-FS")] = None,
    json: bool = False,
) -> None:
    """Find the sensor's zero in several poses at rest, by the torque of the load's weight.

    Example: strainwave tare poses.csv --map angle=q:deg,torque=tau_Nm --joint joint.toml
    --payload-mass 3.2 --lever-arm 0.45 --horizontal-angle-deg 0 --out joint.toml

    Parameters
    ----------
    poses : Path
        The table, a row for each reading: .csv, .tsv, .txt, .parquet or .pq.
    joint : Path
        The joint file with [gear] and [torque_calibration].
    out : Path
        The joint file that is written: .toml.
    map_ : tuple of str
        Which columns are what: key=column[:unit] pairs by commas, with the keys angle (the output's),
        torque or voltage, and where there are such gravity-torque (of a model of your own), pose (a
        name: readings of one name are averaged) and temperature.
    payload_mass : float
        Mass of the load, kg; 0 without a load.
    lever_arm : float
        Distance of its centre from the joint's axis, m.
    gravity : float
        Acceleration of free fall, m/s^2.
    axis_tilt_deg : float
        Angle of the joint's axis against the horizontal, degrees.
    horizontal_angle_deg : float
        Output angle at which the weight's torque is largest, degrees; fitted without.
    accuracy_fs : float
        Standard deviation of the sensor from pose to pose, percent of the rated torque; without, from
        the joint file's linearity and hysteresis.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_outcome
    from strainwave.cli.repeat import command_text
    from strainwave.commissioning.gravity import Payload
    from strainwave.commissioning.tare import TareTask, tare_joint

    payload = Payload(payload_mass, lever_arm, gravity, axis_tilt_deg, horizontal_angle_deg)
    command = command_text(
        ("tare", poses),
        {
            "--map": map_,
            "--joint": joint,
            "--payload-mass": payload_mass,
            "--lever-arm": lever_arm,
            "--gravity": None if payload_mass is None else gravity,
            "--axis-tilt-deg": axis_tilt_deg or None,
            "--horizontal-angle-deg": horizontal_angle_deg,
            "--accuracy-FS": accuracy_fs,
            "--out": out,
        },
    )
    task = TareTask(payload, accuracy_fs)
    result = tare_joint(poses, out, map_, task, joint_path=joint, command=command)
    print_outcome(result, _summary, of=poses, as_json=json)


def _summary(result: TaredJoint) -> list[str]:
    from math import degrees

    from strainwave.records.identified_log import measured_text

    found = result.tare
    uncertainty_V = result.zero_standard_uncertainty_V
    share_FS = 100 * found.zero_Nm / result.rated_torque_Nm
    lines = [
        f"{result.out}: zero_V in [torque_calibration] {measured_text(result.zero_V, uncertainty_V)} V "
        f"from {len(result.poses)} poses of {result.path}; it was {result.zero_before_V:.6g} V",
        f"  zero {measured_text(found.zero_Nm, found.standard_uncertainty_Nm)} Nm, {share_FS:.3g} %FS",
        f"  scatter {found.scatter_Nm:.3g} Nm, chi-square {found.chi_square:.3g} of at most "
        f"{found.limit:.3g}: the weight explains the poses",
    ]
    if found.horizontal_angle_rad is not None:
        how = "fitted" if found.is_angle_fitted else "told"
        lines.append(f"  largest torque at {degrees(found.horizontal_angle_rad):.4g} deg, {how}")
    share = found.model_share
    if result.payload_mass_kg is not None and share is not None:
        spread = found.model_share_standard_uncertainty or 0.0
        best = measured_text(share * result.payload_mass_kg, spread * result.payload_mass_kg)
        lines.append(f"  the mass that fits best is {best} kg")
    return lines
