"""Where the page of `--report` and the picture of `--figure` may be written to."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def check_report(report: Path | None, out: Path, *inputs: Path | None) -> None:
    """Make sure that a report can be written, before anything is computed.

    Parameters
    ----------
    report : Path or None
        Where the page goes; None where none was asked for.
    out : Path
        Where the result goes.
    *inputs : Path or None
        What is read.

    Raises
    ------
    InputError
        If the name, the folder or the permission is wrong, or the place is taken.
    """
    if report is not None:
        _check_beside(report, out, inputs, "--report", (".html",))


def check_figure(
    figure: Path | None, out: Path | None, *inputs: Path | None, option: str = "--figure"
) -> None:
    """Make sure that a figure can be written, before anything is computed.

    Parameters
    ----------
    figure : Path or None
        Where the figure goes; None where none was asked for.
    out : Path or None
        Where the result goes, if it goes to a file.
    *inputs : Path or None
        What is read.
    option : str
        The option that names the figure.

    Raises
    ------
    InputError
        If the name, the folder or the permission is wrong, or the place is taken.
    """
    if figure is not None:
        # Drawing takes long to import; nobody waits for it who wants no figure.
        from strainwave.report.figure_file import FORMATS

        _check_beside(figure, out, inputs, option, FORMATS)


def _check_beside(
    path: Path,
    out: Path | None,
    inputs: Sequence[Path | None],
    option: str,
    endings: Sequence[str],
) -> None:
    from strainwave.records.checks import check_output

    check_output(path, *inputs, option=option, endings=endings)
    if out is not None and os.path.realpath(path) == os.path.realpath(out):
        raise InputError(
            f"{option} {path}: it is the file of --out too; expected another one, so choose "
            "another name"
        )
