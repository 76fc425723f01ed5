"""What commands print: results on the standard output, progress and remarks beside it."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

from rich.console import Console

if TYPE_CHECKING:
    from collections.abc import Mapping


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
    return Console(highlight=False, width=None if sys.stdout.isatty() else 150)


def progress_console() -> Console:
    """Console for progress, which is not part of the result.

    Returns
    -------
    rich.console.Console
        Writes to the standard error.
    """
    return Console(stderr=True, highlight=False)
