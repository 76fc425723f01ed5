"""The command line as it would be typed again, for the provenance of what it made."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_LONGEST_COMMAND = 500


def command_text(words: Sequence[object], options: Mapping[str, object]) -> str | None:
    """Write a command line so that it can be typed again.

    Parameters
    ----------
    words : sequence
        The command's name and what follows it by position.
    options : mapping
        Options by their name with dashes; one that is None or False is left out, one that is True
        stands alone, and one with several values is written once for each.

    Returns
    -------
    str or None
        None where it would be too long for a joint file, or holds what cannot be printed.
    """
    line = ["strainwave", *map(str, words)]
    for name, value in options.items():
        if value is None or value is False:
            continue
        if value is True:
            line.append(name)
            continue
        values = value if isinstance(value, tuple | list) else (value,)
        for each in values:
            line += [name, str(each)]
    text = shlex.join(line)
    return text if text.isprintable() and len(text) <= _LONGEST_COMMAND else None
