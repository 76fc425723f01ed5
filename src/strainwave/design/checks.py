"""Checks of what a person asks of a study: one clear sentence for what cannot be used."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, SupportsFloat, SupportsIndex

from strainwave.calibrate.checks import real_number
from strainwave.errors import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Sequence


def number_within(
    name: str, value: SupportsFloat, unit: str, lowest: float, highest: float
) -> float:
    """Take a number of a range, or say what was given instead.

    Parameters
    ----------
    name : str
        Name of the parameter, for the message.
    value : float
        What was given.
    unit : str
        Its unit, "" for none.
    lowest, highest : float
        The range; both ends belong to it.

    Returns
    -------
    float
        The number.

    Raises
    ------
    InputError
        If it is no number, or outside the range.
    """
    number = real_number(name, value)
    if not lowest <= number <= highest:
        raise ConfigurationError(
            name, number, unit, f"a number from {lowest:g} to {highest:g}", "choose one of these"
        )
    return number


def count_within(name: str, value: SupportsIndex, lowest: int, highest: int) -> int:
    """Take a whole number of a range, or say what was given instead.

    Parameters
    ----------
    name : str
        Name of the parameter, for the message.
    value : int
        What was given.
    lowest, highest : int
        The range; both ends belong to it.

    Returns
    -------
    int
        The number.

    Raises
    ------
    InputError
        If it is no whole number, or outside the range.
    """
    allowed = f"a whole number from {lowest} to {highest}"
    try:
        number = operator.index(value)
    except TypeError as error:
        raise ConfigurationError(name, value, "", allowed, "choose one of these") from error
    if not lowest <= number <= highest:
        raise ConfigurationError(name, number, "", allowed, "choose one of these")
    return number


def numbers_of_text(name: str, text: str, allowed: str) -> tuple[float, ...]:
    """Read numbers with commas between them.

    Parameters
    ----------
    name : str
        Name of the option, for the message.
    text : str
        What was given.
    allowed : str
        What was expected, for the message.

    Returns
    -------
    tuple of float
        The numbers; their range is not checked.

    Raises
    ------
    InputError
        If one of them is no number.
    """
    parts: Sequence[str] = text.split(",")
    try:
        return tuple(float(part) for part in parts)
    except ValueError as error:
        raise ConfigurationError(name, text, "", allowed, "write it like that") from error
