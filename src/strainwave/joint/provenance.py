"""Where the values of a section come from."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, AwareDatetime, Field

from strainwave.errors import InputError
from strainwave.joint.base import FilePart, Line

Clock = Callable[[], datetime]
_CHUNK_BYTES = 1 << 20


def utc_now() -> datetime:
    """Return the present time in UTC, in whole seconds."""
    return datetime.now(UTC).replace(microsecond=0)


def strainwave_version() -> str:
    """Return the version of the installed strainwave, or ``"0+unknown"`` where none is."""
    try:
        return metadata.version("strainwave")
    except metadata.PackageNotFoundError:
        return "0+unknown"


def in_utc(time: datetime) -> datetime:
    """Return a time with time zone in UTC."""
    return time.astimezone(UTC)


class Provenance(FilePart):
    """Where the values of a section come from, when, and by which strainwave.

    Build one with `of_file`, `by_hand`, `of_preset` or `of_simulation`; `clock` and `version` can
    be given there, so that a result can be repeated to the byte.
    """

    input: Line = Field(
        description="Source of the values: name of the recording, `entered by hand`, "
        "`preset NAME` or `simulated WHAT`"
    )
    input_sha256: (
        Annotated[str, Field(pattern="^[0-9a-fA-F]{64}$"), AfterValidator(str.lower)] | None
    ) = Field(default=None, description="SHA-256 of the input file, 64 hexadecimal digits")
    created: Annotated[AwareDatetime, AfterValidator(in_utc)] = Field(
        description="When the section was filled: date and time with time zone, kept in UTC"
    )
    version: Line = Field(description="Version of strainwave that filled the section")
    command: Line | None = Field(
        default=None, description="Command line that filled the section, to repeat it"
    )

    @classmethod
    def of_file(
        cls,
        path: str | Path,
        *,
        command: str | None = None,
        clock: Clock = utc_now,
        version: str | None = None,
    ) -> Provenance:
        """Describe values that were computed from a file; its SHA-256 is taken in chunks.

        Parameters
        ----------
        path : str or Path
            The recording. Its name goes into the provenance, its folder does not.
        command : str, optional
            The command line.
        clock : callable, optional
            Returns the time of creation, with time zone.
        version : str, optional
            Version of strainwave; the installed one by default.

        Returns
        -------
        Provenance

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        digest = hashlib.sha256()
        try:
            with Path(path).open("rb") as stream:
                while chunk := stream.read(_CHUNK_BYTES):
                    digest.update(chunk)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise InputError(
                f"{path}: cannot be read for its provenance ({reason}); "
                "expected a readable recording, so check the name and the permissions"
            ) from error
        return cls(
            input=Path(path).name,
            input_sha256=digest.hexdigest(),
            created=clock(),
            version=strainwave_version() if version is None else version,
            command=command,
        )

    @classmethod
    def _described(
        cls, text: str, command: str | None, clock: Clock, version: str | None
    ) -> Provenance:
        return cls(
            input=text,
            created=clock(),
            version=strainwave_version() if version is None else version,
            command=command,
        )

    @classmethod
    def by_hand(
        cls, *, command: str | None = None, clock: Clock = utc_now, version: str | None = None
    ) -> Provenance:
        """Describe values that a person entered; parameters as in `of_file`."""
        return cls._described("entered by hand", command, clock, version)

    @classmethod
    def of_preset(
        cls,
        name: str,
        *,
        command: str | None = None,
        clock: Clock = utc_now,
        version: str | None = None,
    ) -> Provenance:
        """Describe values taken from the preset `name`; parameters as in `of_file`."""
        return cls._described(f"preset {name}", command, clock, version)

    @classmethod
    def of_simulation(
        cls,
        description: str,
        *,
        command: str | None = None,
        clock: Clock = utc_now,
        version: str | None = None,
    ) -> Provenance:
        """Describe values from a simulation, such as "seed 7"; parameters as in `of_file`."""
        return cls._described(f"simulated {description}", command, clock, version)


class Section(FilePart):
    """A section of the joint file: the values of one subject and their provenance.

    In Python a section may be built without provenance, to compute with it; in a joint file the
    provenance is required.
    """

    provenance: Provenance | None = Field(
        default=None, description="Where the values of this section come from"
    )
