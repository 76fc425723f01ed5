"""From a joint file to the core's gear."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave import _core
from strainwave.configuration.sections import required

if TYPE_CHECKING:
    from strainwave.joint import Joint


def gear_of(joint: Joint) -> _core.Gear:
    """Build the gear of a joint.

    Parameters
    ----------
    joint : Joint
        A joint with a section ``[gear]``.

    Returns
    -------
    Gear
        Ratio, configuration, direction and rated torque.

    Raises
    ------
    InputError
        If the section is missing.
    """
    gear = required(joint, "gear", joint.gear)
    return _core.Gear(
        ratio=gear.ratio,
        configuration=_core.GearConfiguration[gear.configuration],
        rated_torque_Nm=gear.rated_torque_Nm,
        output_direction=gear.output_direction,
    )
