"""What the commands with `--report` share: the place, and the command line that repeats them."""

from __future__ import annotations

import os
import shlex
from typing import TYPE_CHECKING, Final

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

#: Between the options of a command that is to be read: a shell takes the lines for one.
LINE_AFTER_LINE: Final = " \\\n    "


def command_line(
    name: str,
    log: Path,
    mapping: tuple[str, ...],
    options: Mapping[str, object],
    *,
    between: str = " ",
) -> str:
    """Write the command line that does the same again.

    Parameters
    ----------
    name : str
        The subcommand.
    log : Path
        The recording.
    mapping : tuple of str
        Values of ``--map``.
    options : mapping
        Further options by name; None where one was not given, True where it stands alone.
    between : str
        What stands between the options, such as `LINE_AFTER_LINE`.

    Returns
    -------
    str
        Quoted for a shell.
    """
    parts = [["strainwave", name, str(log)], *(["--map", text] for text in mapping)]
    parts += [
        [option] if value is True else [option, _text(value)]
        for option, value in options.items()
        if value is not None
    ]
    return between.join(shlex.join(words) for words in parts)


def _text(value: object) -> str:
    # A number as a person writes it: 100 and not 100.0.
    return str(value).removesuffix(".0") if isinstance(value, float) else str(value)


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
    from strainwave.records.checks import check_output

    if report is None:
        return
    check_output(report, *inputs, option="--report", endings=(".html",))
    if os.path.realpath(report) == os.path.realpath(out):
        raise InputError(
            f"--report {report}: it is the file of --out too; expected another one, so choose "
            "another name"
        )
