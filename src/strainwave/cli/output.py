"""What commands print: results on the standard output, progress and remarks beside it."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from rich.console import Console

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence


class _ResultConsole(Console):
    def on_broken_pipe(self) -> None:
        # The command line's own end, and not rich's.
        raise BrokenPipeError


def print_json(result: Mapping[str, Any]) -> None:
    """Print a result for a program to read.

    Parameters
    ----------
    result : mapping
        Plain values by name; what is not finite is refused.
    """
    sys.stdout.write(json.dumps(result, indent=2, allow_nan=False) + "\n")


def result_console() -> Console:
    """Console for results that a person reads.

    Returns
    -------
    rich.console.Console
        Writes to the standard output; lines are as wide as they need to be where it is no terminal.
    """
    return _ResultConsole(highlight=False, width=None if sys.stdout.isatty() else 150)


def progress_console() -> Console:
    """Console for progress, which is not part of the result.

    Returns
    -------
    rich.console.Console
        Writes to the standard error.
    """
    return Console(stderr=True, highlight=False)


class Outcome(Protocol):
    """What a command found."""

    @property
    def warnings(self) -> Sequence[str]:
        """Sentences about what may be wrong."""

    def as_dict(self) -> Mapping[str, Any]:
        """Give plain values for a program."""


_Found = TypeVar("_Found", bound=Outcome)


def print_outcome(
    found: _Found, table: Callable[[_Found], Iterable[str]], *, of: object = None, as_json: bool
) -> None:
    """Print what a command found: warnings beside it, and the result for a person or a program.

    Parameters
    ----------
    found : Outcome
        The result.
    table : callable
        Makes the lines that a person reads.
    of : object, optional
        What the warnings are about: the name of the file.
    as_json : bool
        Whether a program reads it.
    """
    console = progress_console()
    about = "" if of is None else f"{of}: "
    for warning in found.warnings:
        console.print(f"strainwave: warning: {about}{warning}", soft_wrap=True, markup=False)
    if as_json:
        print_json(found.as_dict())
        return
    lines = result_console()
    for line in table(found):
        lines.print(line, soft_wrap=True, markup=False)
