"""Reading, changing and writing joint files."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import TypeAdapter, ValidationError

from strainwave.atomic import write_atomically
from strainwave.errors import InputError
from strainwave.joint import editing
from strainwave.joint.document import JointFile, joint_of_text, section_models
from strainwave.joint.migrations import (
    MIGRATIONS,
    SCHEMA_VERSION,
    VERSION_KEY,
    Migration,
    migrate,
    schema_version,
)
from strainwave.joint.model import Identity, Joint
from strainwave.joint.problems import input_error
from strainwave.joint.provenance import Section
from strainwave.joint.toml_text import decode, parse_document, read_bytes


def parse_joint(
    text: str, source: str = "joint file", *, migrations: Sequence[Migration] = MIGRATIONS
) -> JointFile:
    """Read a joint from the text of a joint file.

    Parameters
    ----------
    text : str
        The text.
    source : str
        Name of the file, for messages.
    migrations : sequence of callables
        What brings older schema versions up to the present one.

    Returns
    -------
    JointFile

    Raises
    ------
    InputError
        If the text is not a valid joint file.
    """
    document = parse_document(text, source)
    version = schema_version(document, source)
    migrated = migrate(document, source, migrations)
    older = version if version <= len(migrations) else None
    joint_file = JointFile(tomlkit.parse(tomlkit.dumps(migrated)), source, migrated_from=older)
    if older is None and joint_of_text(text, source) != joint_file.joint:
        raise InputError(
            f"{source}: its layout is read in two ways; expected sections with key = value lines, "
            "so bring the keys of each section together"
        )
    return joint_file


def read_joint(path: str | Path) -> JointFile:
    """Read a joint file; one of an older schema is brought up to the present one in memory.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    JointFile

    Raises
    ------
    InputError
        If the file cannot be read or is not a valid joint file.
    """
    content = read_bytes(Path(path))
    joint_file = parse_joint(decode(content, str(path)), str(path))
    joint_file.line_end = "\r\n" if b"\r\n" in content else "\n"
    joint_file.content_sha256 = hashlib.sha256(content).hexdigest()
    return joint_file


def write_joint(joint_file: JointFile, path: str | Path, *, overwrite: bool = False) -> None:
    """Write a joint file whole or not at all.

    An existing file is replaced only if it is as it was when this joint file was read from it or
    last written to it, so that nobody's changes are lost.

    Parameters
    ----------
    joint_file : JointFile
        What to write.
    path : str or Path
        Where to.
    overwrite : bool
        True replaces whatever is there.

    Raises
    ------
    InputError
        If the file cannot be written, or if another one is there.
    """
    target = Path(path)
    if target.exists() and not overwrite:
        present = hashlib.sha256(read_bytes(target)).hexdigest()
        if present != joint_file.content_sha256:
            raise InputError(
                f"{path}: there is a file already that is not the one this joint was read from, or "
                "that was changed since; expected a new name or the unchanged file, so read it "
                "again, choose another name, or ask to overwrite it"
            )
    content = joint_file.text().replace("\n", joint_file.line_end).encode("utf-8")
    write_atomically(target, content)
    joint_file.content_sha256 = hashlib.sha256(content).hexdigest()


def new_joint(name: str, *, serial: str | None = None, notes: str | None = None) -> JointFile:
    """Begin a joint file, with the section ``[joint]`` alone.

    Parameters
    ----------
    name : str
        Name of the joint.
    serial : str, optional
        Serial number of the joint or gear.
    notes : str, optional
        Anything a reader should know.

    Returns
    -------
    JointFile

    Raises
    ------
    InputError
        If a text is empty or holds control characters.
    """
    try:
        identity = Identity(name=name, serial=serial, notes=notes)
    except ValidationError as error:
        raise input_error(error, "new joint", Joint, ("joint",)) from error
    document = tomlkit.document()
    document.append(VERSION_KEY, tomlkit.item(SCHEMA_VERSION))
    document.append(tomlkit.key("joint"), editing.new_table(identity.model_dump(exclude_none=True)))
    return JointFile(document, f'joint "{name}"')


def build_section(name: str, values: Mapping[str, Any], source: str) -> Section:
    """Build the model of a section from values a person gave.

    Parameters
    ----------
    name : str
        Name of the section, one of `SECTION_NAMES`.
    values : mapping
        Values by key, as in the file; lists as lists or tuples.
    source : str
        Where the values come from, for messages: ``"command line"``.

    Returns
    -------
    Section
        A `Gear` for ``"gear"`` and so on; for ``"ripple_filter"`` that of its method.

    Raises
    ------
    InputError
        If there is no such section, or a value is missing, unknown or wrong.
    """
    section_models(name, source)
    annotation: Any = Joint.model_fields[name].annotation
    try:
        section: Section = TypeAdapter(annotation).validate_python(dict(values))
    except ValidationError as error:
        raise input_error(error, source, Joint, (name,)) from error
    return section
