"""What all of a joint's configurations need: sections that must be there."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from strainwave.errors import InputError

if TYPE_CHECKING:
    from strainwave.joint import Joint
    from strainwave.joint.provenance import Section

SectionType = TypeVar("SectionType", bound="Section")


def missing(joint: Joint, name: str) -> InputError:
    """Say that a section is not there.

    Parameters
    ----------
    joint : Joint
        The joint.
    name : str
        Name of the section.

    Returns
    -------
    InputError
        To be raised.
    """
    return InputError(
        f'joint "{joint.identity.name}": there is no section [{name}]; expected it for this '
        "configuration, so fill it first"
    )


def required(joint: Joint, name: str, section: SectionType | None) -> SectionType:
    """Return a section that must be there.

    Parameters
    ----------
    joint : Joint
        The joint.
    name : str
        Name of the section.
    section : Section or None
        The section.

    Returns
    -------
    Section
        The same.

    Raises
    ------
    InputError
        If it is not there.
    """
    if section is None:
        raise missing(joint, name)
    return section
