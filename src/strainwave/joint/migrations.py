"""Schema versions of the joint file, and how an older file becomes a newer one."""

from __future__ import annotations

import copy
from collections.abc import Callable, MutableMapping, Sequence
from typing import Any, Final

from strainwave.errors import InputError
from strainwave.joint.problems import shown

Document = MutableMapping[str, Any]
Migration = Callable[[Document], Document]

MIGRATIONS: Final[tuple[Migration, ...]] = ()
"""The migration at position n (counted from 0) takes a document of version n + 1 to n + 2.

A migration is never changed after a release, and new ones are added at the end: the newest schema
version is one more than their number.
"""

VERSION_KEY: Final = "schema_version"


def newest_version(migrations: Sequence[Migration] = MIGRATIONS) -> int:
    """Return the schema version that the last of `migrations` leads to."""
    return 1 + len(migrations)


SCHEMA_VERSION: Final = newest_version()
"""The schema version that this strainwave writes."""


def schema_version(document: Document, source: str) -> int:
    """Return the schema version of a document.

    Parameters
    ----------
    document : mutable mapping
        The parsed file.
    source : str
        Name of the file, for messages.

    Returns
    -------
    int
        From 1.

    Raises
    ------
    InputError
        If it is missing or not a whole number from 1.
    """
    if VERSION_KEY not in document:
        raise InputError(
            f"{source}: the key {VERSION_KEY} is missing; expected it before the first section, "
            f"so add the line {VERSION_KEY} = {SCHEMA_VERSION} if this is a joint file"
        )
    version = document[VERSION_KEY]
    if isinstance(version, bool) or not isinstance(version, int) or version < 1:
        raise InputError(
            f"{source}: {VERSION_KEY} = {shown(version)}: expected a whole number from 1; correct it "
            f"(this strainwave writes {SCHEMA_VERSION})"
        )
    return int(version)


def migrate(
    document: Document, source: str, migrations: Sequence[Migration] = MIGRATIONS
) -> Document:
    """Bring a document to the newest schema version.

    Parameters
    ----------
    document : mutable mapping
        The parsed file; it is left as it is.
    source : str
        Name of the file, for messages.
    migrations : sequence of callables
        In order, from version 1.

    Returns
    -------
    mutable mapping
        A document of the newest version, of the same type.

    Raises
    ------
    InputError
        If the version is missing, wrong or newer than the newest known one, or if a migration
        meets a document that it cannot take over.
    """
    version = schema_version(document, source)
    newest = newest_version(migrations)
    if version > newest:
        raise InputError(
            f"{source}: it was written by a newer strainwave (schema {version}, this one knows up "
            f"to {newest}); update strainwave, or take an older copy of the file"
        )
    migrated = copy.deepcopy(document)
    for number, step in enumerate(migrations[version - 1 :], start=version):
        try:
            migrated = step(migrated)
        except (KeyError, TypeError, AttributeError, ValueError, IndexError) as error:
            raise InputError(
                f"{source}: it cannot be taken from schema {number} to {number + 1} "
                f"({type(error).__name__}: {error}); expected a valid file of schema {number}, so "
                "check it with the strainwave that wrote it"
            ) from error
        migrated[VERSION_KEY] = number + 1
    return migrated
