"""A table of poses in, the zero in ``[torque_calibration]`` out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.poses import Poses, group_poses
from strainwave.calibrate.tare import SensorScatter, Weight, tare
from strainwave.commissioning.tare_result import (
    STANDARD_ACCURACY_FS,
    TaredJoint,
    refusal,
    remarks_on,
)
from strainwave.configuration import calibration_of
from strainwave.errors import InputError
from strainwave.joint import Provenance, TorqueCalibration, read_joint, write_joint
from strainwave.records.joint_output import check_joint_output
from strainwave.records.mapping import MapKeys
from strainwave.records.table import read_table
from strainwave.records.voltages import codes_to_volts

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.commissioning.gravity import Payload
    from strainwave.joint import Joint
    from strainwave.records.table import Table

KEYS: Final = MapKeys(
    {
        "angle": "angle",
        "torque": "torque",
        "voltage": "voltage",
        "gravity-torque": "torque",
        "temperature": "temperature",
        "pose": None,
    },
    example="--map angle=q:deg,torque=tau_Nm",
)
_STEPS: Final = 8


@dataclass(frozen=True)
class TareTask:
    """What is known beforehand.

    Attributes
    ----------
    payload : Payload
        The load's weight.
    accuracy_FS : float or None
        Standard deviation of the sensor from pose to pose, %FS; None takes the joint file's.
    """

    payload: Payload
    accuracy_FS: float | None = None


def tare_joint(
    path: Path,
    out: Path,
    mapping: Iterable[str],
    task: TareTask,
    *,
    joint_path: Path,
    command: str | None = None,
) -> TaredJoint:
    """Find the zero in poses at rest, and write it to the joint file, unless the gate refuses it.

    Parameters
    ----------
    path : Path
        The table of poses.
    out : Path
        The joint file; written whole or not at all.
    mapping : iterable of str
        Which columns are what.
    task : TareTask
        What is known.
    joint_path : Path
        The joint file with ``[gear]`` and ``[torque_calibration]``.
    command : str, optional
        The command line, for the provenance.

    Returns
    -------
    TaredJoint
        What was found.

    Raises
    ------
    InputError
        If something that was given cannot be used, or the model of the weight does not explain the
        poses; nothing is written then.
    """
    check_joint_output(out, path, joint_path)
    joint_file = read_joint(joint_path)
    joint = joint_file.joint
    section = joint.torque_calibration
    for name, part in (("gear", joint.gear), ("torque_calibration", section)):
        if part is None:
            raise InputError(
                f"{joint_path}: there is no [{name}]; expected it for the zero in volts, so fill it "
                "first"
            )
    assert section is not None
    assert joint.gear is not None
    rated_Nm = joint.gear.rated_torque_Nm
    table = _read(path, mapping, joint)
    model_by_row = table.values.get("gravity-torque")
    _check_task(path, task, table)
    accuracy_Nm, source = _accuracy(task, section, rated_Nm)
    scatter = SensorScatter(accuracy_Nm, _gain_share(section))
    texts = table.texts.get("pose")
    names = None if texts is None else np.array(texts)
    angle_rad = table.values.get("angle", np.zeros(table.rows))
    zero_V, first, found, poses = section.zero_V, None, None, None
    try:
        for _ in range(_STEPS):
            torque_Nm = _torque(table, joint, zero_V)
            poses, number = group_poses(torque_Nm, angle_rad, names)
            model = _model(task, poses, number, model_by_row)
            found = tare(poses, model, scatter)
            first = found if first is None else first
            zero_V += found.zero_Nm / section.gain_Nm_per_V
            # By a curved characteristic the zero is found step by step.
            if "voltage" not in table or abs(found.zero_Nm) < 1e-9 * rated_Nm:
                break
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    assert first is not None
    assert found is not None
    assert poses is not None
    if not found.is_explained:
        raise InputError(refusal(path, found, task.payload, source))
    changed = section.model_copy(update={"zero_V": zero_V, "provenance": None})
    joint_file.set_section(
        "torque_calibration", changed, _provenance(path, section.provenance, command)
    )
    result = TaredJoint(
        path,
        out,
        poses,
        first,
        section.zero_V,
        zero_V,
        found.standard_uncertainty_Nm / abs(section.gain_Nm_per_V),
        rated_Nm,
        task.payload.mass_kg if model_by_row is None else None,
        accuracy_Nm,
        source,
        remarks_on(joint, table, poses, found, source),
    )
    write_joint(joint_file, out)
    return result


def _read(path: Path, mapping: Iterable[str], joint: Joint) -> Table:
    table = read_table(path, mapping, KEYS, codes_to_volts=codes_to_volts(joint))
    if ("torque" in table) == ("voltage" in table):
        raise InputError(
            "--map: expected one of torque=COLUMN, as the joint reports it with the zero of the joint "
            "file, and voltage=COLUMN; map one of them"
        )
    table.require_complete(KEYS.quantities)
    if table.rows == 0:
        raise InputError(f"{path}: it has no rows; expected a row for each reading, so add them")
    return table


def _check_task(path: Path, task: TareTask, table: Table) -> None:
    accuracy = task.accuracy_FS
    if accuracy is not None and not 0.0 < accuracy <= 100.0:
        raise InputError(
            f"--accuracy-FS {accuracy:g}: expected a standard deviation in percent of the rated "
            "torque, above 0 and up to 100; correct this value"
        )
    if "gravity-torque" in table:
        if task.payload.is_given:
            raise InputError(
                "--payload-mass: a gravity-torque is mapped as well; expected one of them, so leave "
                "out the other"
            )
        return
    if not task.payload.is_given:
        raise InputError(
            "--payload-mass: nothing says what the load weighs; expected --payload-mass and "
            "--lever-arm (0 without a load), or a column gravity-torque of a model, so add them"
        )
    if "angle" not in table:
        raise InputError(
            f"--map: nothing is mapped for angle of {path}; expected angle=COLUMN, the output's, from "
            "which the weight's torque follows, or gravity-torque=COLUMN"
        )


def _torque(table: Table, joint: Joint, zero_V: float) -> NDArray[np.float64]:
    if "torque" in table:
        return table.values["torque"]
    assert joint.torque_calibration is not None
    section = joint.torque_calibration.model_copy(update={"zero_V": zero_V})
    calibration = calibration_of(joint.model_copy(update={"torque_calibration": section}))
    temperature = table.values.get("temperature")
    if temperature is None:
        temperature = np.full(table.rows, calibration.reference_temperature_degC)
    return np.asarray(calibration.torque_Nm(table.values["voltage"], temperature))


def _model(
    task: TareTask, poses: Poses, number: NDArray[np.int64], by_row: NDArray[np.float64] | None
) -> Weight | NDArray[np.float64]:
    if by_row is not None:
        return np.asarray(np.bincount(number, by_row) / poses.readings)
    angle_deg = task.payload.horizontal_angle_deg
    return Weight(
        task.payload.largest_torque_Nm, None if angle_deg is None else math.radians(angle_deg)
    )


def _accuracy(task: TareTask, section: TorqueCalibration, rated_Nm: float) -> tuple[float, str]:
    if task.accuracy_FS is not None:
        return task.accuracy_FS / 100 * rated_Nm, "option"
    linearity = section.linearity_error_percent_of_rated_torque
    hysteresis = section.hysteresis_percent_of_rated_torque
    if linearity is None and hysteresis is None:
        return STANDARD_ACCURACY_FS / 100 * rated_Nm, "standard"
    # Both are limits: standard deviations of rectangular distributions, of hysteresis half of it.
    percent = math.hypot(linearity or 0.0, (hysteresis or 0.0) / 2) / math.sqrt(3)
    return max(percent / 100 * rated_Nm, 1e-6 * rated_Nm), "joint file"


def _gain_share(section: TorqueCalibration) -> float:
    if section.consistency is not None:
        return section.consistency
    spread = section.gain_standard_uncertainty_Nm_per_V
    return 0.0 if spread is None else abs(spread / section.gain_Nm_per_V)


def _provenance(path: Path, old: Provenance | None, command: str | None) -> Provenance:
    """Say where the zero comes from, and where the rest does."""
    new = Provenance.of_file(path, command=command)
    if old is None:
        return new
    first = old.input.partition("; zero from ")[0]
    text = f"{first}; zero from {path.name}"
    return new.model_copy(update={"input": text}) if len(text) <= 500 else new
