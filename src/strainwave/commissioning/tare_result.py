"""What was found of a zero: plain values, why it is refused, and what a person should know."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave.calibrate.poses import Poses
from strainwave.calibrate.tare import CONFIDENCE, Tare
from strainwave.calibrate.uncertainty import freedom_text
from strainwave.records.identified_log import measured_text

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave.commissioning.gravity import Payload
    from strainwave.joint import Joint
    from strainwave.records.table import Table

#: What the sensor is taken to scatter by from pose to pose where nothing says it, %FS.
STANDARD_ACCURACY_FS: Final = 0.1
#: Of the fluctuation twice a motor turn, so much may be left in the mean over all readings.
_ALIKE: Final = 0.3


@dataclass(frozen=True)
class TaredJoint:
    """What was found.

    Attributes
    ----------
    path, out : Path
        The table, and the joint file that was written.
    poses : Poses
        The poses.
    tare : Tare
        The fit, by the zero that the joint file had.
    zero_before_V, zero_V : float
        The zero of the joint file as it was, and as it is.
    zero_standard_uncertainty_V : float
        Of the zero.
    rated_torque_Nm : float
        Full scale.
    payload_mass_kg : float or None
        Mass that was told.
    accuracy_Nm : float
        What the sensor may scatter by.
    accuracy_source : str
        Who says so.
    warnings : tuple of str
        What a person should know.
    """

    path: Path
    out: Path
    poses: Poses
    tare: Tare
    zero_before_V: float
    zero_V: float
    zero_standard_uncertainty_V: float
    rated_torque_Nm: float
    payload_mass_kg: float | None
    accuracy_Nm: float
    accuracy_source: str
    warnings: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, for `--json`.

        Returns
        -------
        dict
            Nothing but texts, finite numbers, lists, dictionaries and None.
        """
        found, poses = self.tare, self.poses
        mass = self.payload_mass_kg
        share, share_u = found.model_share, found.model_share_standard_uncertainty
        return {
            "input": str(self.path),
            "output": str(self.out),
            "zero_V": self.zero_V,
            "zero_before_V": self.zero_before_V,
            "zero_standard_uncertainty_V": self.zero_standard_uncertainty_V,
            "zero_Nm": found.zero_Nm,
            "zero_standard_uncertainty_Nm": found.standard_uncertainty_Nm,
            "zero_FS": 100 * found.zero_Nm / self.rated_torque_Nm,
            "zero_standard_uncertainty_FS": 100
            * found.standard_uncertainty_Nm
            / self.rated_torque_Nm,
            "scatter_Nm": found.scatter_Nm,
            "repeatability_Nm": poses.repeatability_Nm,
            "accuracy_Nm": self.accuracy_Nm,
            "accuracy_source": self.accuracy_source,
            "chi_square": found.chi_square,
            "chi_square_limit": found.limit,
            "degrees_of_freedom": found.degrees_of_freedom,
            "confidence": CONFIDENCE,
            "horizontal_angle_rad": found.horizontal_angle_rad,
            "horizontal_angle_is_fitted": found.is_angle_fitted,
            "payload_mass_kg": mass,
            "best_payload_mass_kg": None if mass is None or share is None else mass * share,
            "best_payload_mass_standard_uncertainty_kg": (
                None if mass is None or share_u is None else mass * share_u
            ),
            "best_model_share": share,
            "refused_model_share": found.refused_share,
            "hidden_zero_Nm": found.hidden_zero_Nm,
            "poses": [
                {
                    "output_angle_rad": float(poses.output_angle_rad[at]),
                    "readings": int(poses.readings[at]),
                    "torque_Nm": float(poses.torque_Nm[at]),
                    "model_torque_Nm": float(found.model_torque_Nm[at]),
                    "residual_Nm": float(found.residual_Nm[at]),
                }
                for at in range(len(poses))
            ],
            "warnings": list(self.warnings),
        }


def refusal(path: Path, found: Tare, payload: Payload, source: str) -> str:
    """Say why the gate refuses the poses, and what would explain them.

    Parameters
    ----------
    path : Path
        The table of poses.
    found : Tare
        The fit.
    payload : Payload
        The weight that was told.
    source : str
        Who says what the sensor scatters by.

    Returns
    -------
    str
        The sentence.
    """
    what = "the torques in gravity-torque do"
    mass = payload.mass_kg
    if mass is not None:
        what = f"a payload of {mass:g} kg at {payload.lever_arm_m:g} m does"
    sentence = (
        f"{path}: {what} not explain the poses: they scatter by {found.scatter_Nm:.3g} Nm around the "
        f"model, chi-square {found.chi_square:.3g} where a right model stays below {found.limit:.3g} "
        f"in {CONFIDENCE:.0%} of all cases ({freedom_text(str(found.degrees_of_freedom))}, the "
        f"sensor's scatter as by {_SOURCES[source]})"
    )
    share, share_u = found.model_share, found.model_share_standard_uncertainty
    if share is not None and share_u is not None and found.would_be_explained:
        best = f"{share:.3g} times these torques"
        if mass is not None:
            best = f"{measured_text(mass * share, mass * share_u)} kg at that lever arm"
        sentence += f"; {best} would, so correct the payload"
    else:
        sentence += "; no other mass would either: look for contact, cables, friction, a wrong angle or tilt"
    return f"{sentence}; nothing was written"


_SOURCES: Final = {
    "option": "--accuracy-FS",
    "joint file": "the joint file's linearity and hysteresis",
    "standard": f"assumption, {STANDARD_ACCURACY_FS:g} %FS",
}


def remarks_on(
    joint: Joint, table: Table, poses: Poses, found: Tare, source: str
) -> tuple[str, ...]:
    """Say what a person should know of a zero.

    Parameters
    ----------
    joint : Joint
        The joint.
    table : Table
        The readings.
    poses : Poses
        The poses.
    found : Tare
        The fit.
    source : str
        Who says what the sensor scatters by.

    Returns
    -------
    tuple of str
        Sentences, without an end mark.
    """
    says = []
    if source == "standard":
        says.append(
            f"what the sensor scatters by from pose to pose is not known: {STANDARD_ACCURACY_FS:g} %FS "
            "is assumed; give it with --accuracy-FS, or linearity and hysteresis in the joint file"
        )
    if poses.repeatability_Nm is None:
        says.append(
            "no pose has two readings, so that repeatability is not known; map pose=COLUMN and read "
            "each pose several times"
        )
    largest_Nm = float(np.abs(found.model_torque_Nm).max())
    if largest_Nm == 0.0:
        says.append(
            "the weight makes no torque: the poses are a plain mean, and nothing checks the axis"
        )
    gear = joint.gear
    if gear is not None and "angle" in table:
        wave = 2 * gear.factor_m * gear.ratio * table.values["angle"]
        share = float(abs(np.mean(np.exp(1j * wave))))
        if share > _ALIKE:
            says.append(
                f"the wave generator's positions are uneven: {share:.0%} of the signal fluctuation's "
                "amplitude is part of the zero; read each pose at several angles within half a turn of "
                "the motor"
            )
    if joint.temperature is not None and "temperature" not in table and "voltage" in table:
        says.append(
            "no temperature is mapped: the zero is that of the reference temperature only if the "
            f"sensor was at {joint.temperature.reference_temperature_degC:g} degC"
        )
    return tuple(says)
