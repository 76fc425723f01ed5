"""Whole numbers of the command line, refused where they are not whole instead of rounded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import cyclopts

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence


def whole_number_of_tokens(_type: Any, tokens: Sequence[cyclopts.Token]) -> int:
    """Read a whole number; 1e6 is one, 3.5 is none.

    Parameters
    ----------
    _type : type
        The parameter's type; int.
    tokens : sequence of cyclopts.Token
        What was typed.

    Returns
    -------
    int
        The number.

    Raises
    ------
    InputError
        If it is not whole.
    """
    text = tokens[0].value
    try:
        return int(text)
    except ValueError:
        pass
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not number.is_integer():
        raise InputError(f"{tokens[0].keyword} {text}: expected a whole number; correct this value")
    return int(number)


#: A whole number that a person types.
Whole = Annotated[int, cyclopts.Parameter(converter=whole_number_of_tokens)]
