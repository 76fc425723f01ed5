"""The command line as it would be typed again: for the provenance of what it made, and for reports."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

#: Between the options of a command that is to be read: a shell takes the lines for one.
LINE_AFTER_LINE: Final = " \\\n    "
#: A joint file holds no longer one.
_LONGEST_COMMAND: Final = 500


def command_line(
    words: Sequence[object], options: Mapping[str, object], *, between: str = " "
) -> str:
    """Write a command line so that it can be typed again.

    Parameters
    ----------
    words : sequence
        The command's name and what follows it by position.
    options : mapping
        Options by their name with dashes; one that is None or False is left out, one that is True
        stands alone, and one with several values is written once for each.
    between : str
        What stands between the options, such as `LINE_AFTER_LINE`.

    Returns
    -------
    str
        Quoted for a shell.
    """
    parts = [["strainwave", *map(str, words)]]
    for name, value in options.items():
        if value is None or value is False:
            continue
        if value is True:
            parts.append([name])
            continue
        values = value if isinstance(value, tuple | list) else (value,)
        parts += [[name, _text(each)] for each in values]
    return between.join(shlex.join(part) for part in parts)


def command_text(words: Sequence[object], options: Mapping[str, object]) -> str | None:
    """Write a command line for the provenance in a joint file.

    Parameters
    ----------
    words : sequence
        As in `command_line`.
    options : mapping
        As there.

    Returns
    -------
    str or None
        None where it would be too long for a joint file, or holds what cannot be printed.
    """
    text = command_line(words, options)
    return text if text.isprintable() and len(text) <= _LONGEST_COMMAND else None


def _text(value: object) -> str:
    # A number as a person writes it: 100 and not 100.0.
    return str(value).removesuffix(".0") if isinstance(value, float) else str(value)
