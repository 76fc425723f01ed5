"""Checks of a figure's file before the work begins."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from strainwave.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path


def check_figure(option: str, path: Path, *others: Path, ending: str = ".svg") -> None:
    """Refuse a name that no figure can have.

    Parameters
    ----------
    option : str
        The option that names it.
    path : Path
        The file.
    *others : Path
        Files of this command that it must not replace.
    ending : str
        How its name has to end.

    Raises
    ------
    InputError
        If the name has another ending, its folder is missing, or it is one of the others.
    """
    if path.suffix.lower() != ending:
        raise InputError(
            f"{option} {path}: expected a file whose name ends with {ending}; choose such a name"
        )
    if path.is_dir() or not path.resolve().parent.is_dir():
        raise InputError(
            f"{option} {path}: there is no such folder, or it is one itself; expected a file in an "
            "existing folder, so choose another place"
        )
    if any(os.path.realpath(path) == os.path.realpath(other) for other in others):
        raise InputError(
            f"{option} {path}: it is another file of this command; expected a name of its own, so "
            "choose another name"
        )
