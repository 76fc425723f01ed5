"""Whether a joint's misalignment can be removed from a recording, and against which angle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from strainwave.joint import Gear, Joint, Misalignment
    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey

#: Methods that remove it.
METHODS: Final = ("ripple", "smoother")
#: A recording may leave the range in which the terms were measured by so much.
RANGE_TOLERANCE_RAD: Final = math.radians(2.0)


@dataclass(frozen=True)
class MisalignmentAsRead:
    """What of a joint's misalignment is removed.

    Attributes
    ----------
    joint : Joint or None
        The joint for the method: without ``[misalignment]`` where it is not removed.
    terms : int
        Terms that are removed.
    says : tuple of str
        Why it is not, where there is one.
    """

    joint: Joint | None
    terms: int = 0
    says: tuple[str, ...] = ()


def misalignment_as_read(
    joint: Joint | None, method: str, layout: Layout, survey: Survey, *, is_absolute: bool
) -> MisalignmentAsRead:
    """Keep the misalignment only where the recording's angle says where the output is.

    Parameters
    ----------
    joint : Joint or None
        The joint.
    method : str
        Name of the method.
    layout : Layout
        How the recording is read.
    survey : Survey
        What it holds.
    is_absolute : bool
        The motor's angle counts from where the output is at 0.

    Returns
    -------
    MisalignmentAsRead
        The joint as the method shall see it.
    """
    if joint is None or joint.misalignment is None:
        return MisalignmentAsRead(joint)
    reason = _hindrance(joint, joint.misalignment, method, layout, survey, is_absolute)
    if reason is not None:
        without = joint.model_copy(update={"misalignment": None})
        return MisalignmentAsRead(
            without, says=(f"the misalignment of the joint file is not removed: {reason}",)
        )
    if layout.angle_side == "output":
        assert joint.gear is not None
        # An output angle is taken to the motor in its own sense, whichever the gear's is.
        gear = joint.gear.model_copy(update={"output_direction": 1})
        joint = joint.model_copy(update={"gear": gear})
    assert joint.misalignment is not None
    return MisalignmentAsRead(joint, len(joint.misalignment.terms))


def _hindrance(
    joint: Joint,
    misalignment: Misalignment,
    method: str,
    layout: Layout,
    survey: Survey,
    is_absolute: bool,
) -> str | None:
    if method not in METHODS:
        return f"method {method} does not; use {' or '.join(METHODS)}"
    if "angle" not in layout.columns:
        return "the angle is integrated from a speed, so that where the output is is not known"
    if layout.angle_side == "motor" and not is_absolute:
        return (
            "the angle is the motor's, and where the output is is not known; map the output's angle, "
            "or say with --absolute-angle that the motor's counts from where the output is at 0"
        )
    if joint.gear is None:
        return "the joint file has no [gear]; fill it, such as by `strainwave identify`"
    return _beyond_the_range(misalignment, joint.gear, layout, survey)


def _beyond_the_range(
    misalignment: Misalignment, gear: Gear, layout: Layout, survey: Survey
) -> str | None:
    low, high = misalignment.lowest_output_angle_rad, misalignment.highest_output_angle_rad
    if low is None or high is None or survey.angle_lowest_rad is None:
        return None
    assert survey.angle_highest_rad is not None
    gain = 1.0
    if layout.angle_side == "motor":
        gain = gear.output_direction / gear.ratio
    first, last = sorted((survey.angle_lowest_rad * gain, survey.angle_highest_rad * gain))
    if first < low - RANGE_TOLERANCE_RAD or last > high + RANGE_TOLERANCE_RAD:
        return (
            f"it was measured from {math.degrees(low):.4g} to {math.degrees(high):.4g} deg of the "
            f"output, and the recording goes from {math.degrees(first):.4g} to "
            f"{math.degrees(last):.4g}; commission it over the whole range"
        )
    return None
