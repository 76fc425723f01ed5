"""The list ``[[history]]``: what was replaced or removed since the joint file began."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, AwareDatetime, Field

from strainwave.joint.base import FilePart, Line
from strainwave.joint.provenance import Provenance, in_utc

Change = Literal["replaced", "removed"]
#: 64 hexadecimal digits.
Sha256 = Annotated[str, Field(pattern="^[0-9a-fA-F]{64}$"), AfterValidator(str.lower)]


class HistoryEntry(FilePart):
    """One change of a section that was filled before; strainwave writes it, nobody else.

    Where values come from that are there still, their own provenance tells. An entry holds the
    canonical hash of the joint as it was before, earlier entries included, so that the entries
    form a chain.
    """

    section: Line = Field(description="Name of the section that was changed")
    change: Change = Field(description="What was done with it")
    changed_at: Annotated[AwareDatetime, AfterValidator(in_utc)] = Field(
        description="When: date and time with time zone, kept in UTC"
    )
    input: Line = Field(description="Source of the change, as the input of a provenance")
    input_sha256: Sha256 | None = Field(
        default=None, description="SHA-256 of the input file, 64 hexadecimal digits"
    )
    version: Line = Field(description="Version of strainwave that changed it")
    command: Line | None = Field(default=None, description="Command line that changed it")
    previous_input: Line = Field(description="Source of the values that were there before")
    previous_input_sha256: Sha256 | None = Field(
        default=None, description="SHA-256 of their input file, 64 hexadecimal digits"
    )
    previous_created: Annotated[AwareDatetime, AfterValidator(in_utc)] = Field(
        description="When the values that were there before had been filled in"
    )
    previous_sha256: Sha256 = Field(
        description="Canonical hash of the joint before the change, 64 hexadecimal digits"
    )


def history_entry(
    section: str,
    change: Change,
    before: Provenance,
    by: Provenance,
    previous_sha256: str,
) -> HistoryEntry:
    """Describe a change of a section.

    Parameters
    ----------
    section : str
        Name of the section.
    change : {"replaced", "removed"}
        What was done with it.
    before : Provenance
        Of the values that were there.
    by : Provenance
        Of what changed them.
    previous_sha256 : str
        Canonical hash of the joint before.

    Returns
    -------
    HistoryEntry
    """
    return HistoryEntry(
        section=section,
        change=change,
        changed_at=by.created,
        input=by.input,
        input_sha256=by.input_sha256,
        version=by.version,
        command=by.command,
        previous_input=before.input,
        previous_input_sha256=before.input_sha256,
        previous_created=before.created,
        previous_sha256=previous_sha256,
    )
