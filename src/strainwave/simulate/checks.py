"""Checks of what a person enters: one clear sentence for each value that cannot be used."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np

from strainwave.errors import ConfigurationError


def _number(value: object) -> float:
    """Return the number, or not-a-number for what is none; True is none, whatever Python says."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return math.nan
    return float(value)


def require_number(
    parameter: str,
    value: object,
    unit: str,
    *,
    above: float | None = None,
    minimum: float | None = None,
    maximum: float | None = None,
) -> None:
    """Refuse what is not a finite number within the limits.

    Parameters
    ----------
    parameter : str
        Name of the parameter, for the message.
    value : object
        What was given.
    unit : str
        Unit of the value.
    above : float, optional
        The value must be larger than this.
    minimum : float, optional
        The value must be at least this.
    maximum : float, optional
        The value must be at most this.
    """
    words = ["a finite number"]
    if above is not None:
        words.append(f"above {above:g}")
    if minimum is not None:
        words.append(f"of at least {minimum:g}")
    if maximum is not None:
        words.append(f"{'and ' if len(words) > 1 else ''}of at most {maximum:g}")
    number = _number(value)
    too_low = (above is not None and number <= above) or (minimum is not None and number < minimum)
    too_high = maximum is not None and number > maximum
    if not math.isfinite(number) or too_low or too_high:
        raise ConfigurationError(parameter, value, unit, " ".join(words))


def require_integer(
    parameter: str, value: object, unit: str, *, minimum: int, maximum: int | None = None
) -> None:
    """Refuse what is not a whole number within the limits.

    Parameters
    ----------
    parameter : str
        Name of the parameter, for the message.
    value : object
        What was given.
    unit : str
        Unit of the value.
    minimum : int
        Smallest value allowed.
    maximum : int, optional
        Largest value allowed.
    """
    number = math.nan if isinstance(value, float) else _number(value)
    if not number >= minimum or (maximum is not None and number > maximum):
        upper = "" if maximum is None else f" and at most {maximum}"
        raise ConfigurationError(
            parameter, value, unit, f"a whole number of at least {minimum}{upper}"
        )


def require_choice(parameter: str, value: object, choices: Collection[str]) -> None:
    """Refuse what is none of a few words.

    Parameters
    ----------
    parameter : str
        Name of the parameter, for the message.
    value : object
        What was given.
    choices : collection of str
        What is allowed.
    """
    if not isinstance(value, str) or value not in choices:
        raise ConfigurationError(parameter, value, "", " or ".join(choices))


def require_length(parameter: str, given: Sequence[object], expected: int, of_what: str) -> None:
    """Refuse a sequence of the wrong length.

    Parameters
    ----------
    parameter : str
        Name of the parameter, for the message.
    given : sequence
        What was given.
    expected : int
        The length it must have.
    of_what : str
        What the elements stand for: ``"one a harmonic"``.
    """
    if len(given) != expected:
        raise ConfigurationError(
            parameter, len(given), "elements", f"{expected}, {of_what},", "give as many"
        )


def require_increasing(parameter: str, values: Sequence[float], unit: str) -> None:
    """Refuse a sequence that does not increase from element to element.

    Parameters
    ----------
    parameter : str
        Name of the parameter, for the message.
    values : sequence of float
        What was given, finite numbers.
    unit : str
        Unit of the values.
    """
    for before, after in pairwise(values):
        if not after > before:
            raise ConfigurationError(
                parameter, after, unit, f"a number above the one before it, {before:g}"
            )
