"""Where a joint file may be written to, and what it starts from."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from strainwave.errors import InputError
from strainwave.joint import new_joint, read_joint

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave.joint import JointFile


def check_joint_output(out: Path, path: Path, joint_path: Path | None) -> None:
    """Make sure that a joint file can be written, before anything is computed.

    Parameters
    ----------
    out : Path
        The joint file.
    path : Path
        What is read; what is wrong with it is said elsewhere.
    joint_path : Path or None
        The joint file that is started from: the only one that may be replaced.

    Raises
    ------
    InputError
        If the name or the folder is wrong, or another file is there.
    """
    if out.suffix.lower() != ".toml":
        raise InputError(
            f"--out {out}: the name ends in {out.suffix!r}; expected a joint file, so choose a name "
            "that ends in .toml"
        )
    if out.is_dir() or not out.resolve().parent.is_dir():
        raise InputError(
            f"--out {out}: there is no such folder, or it is one itself; expected a file in an "
            "existing folder, so choose another place"
        )
    if not path.exists():
        return
    same = joint_path is not None and os.path.realpath(out) == os.path.realpath(joint_path)
    if out.exists() and not same:
        raise InputError(
            f"--out {out}: there is a file already; expected a new name, or the file of --joint, so "
            "choose another name or start from that file with --joint"
        )


def started_joint(path: Path, joint_path: Path | None) -> JointFile:
    """Read the joint file that is started from, or make one that is named after the input.

    Parameters
    ----------
    path : Path
        What is read.
    joint_path : Path or None
        The joint file that is started from.

    Returns
    -------
    JointFile
        To be filled and written.

    Raises
    ------
    InputError
        If the joint file cannot be read.
    """
    return new_joint(path.stem or "joint") if joint_path is None else read_joint(joint_path)
