"""Checks of what a person hands to a fit: one clear sentence for what cannot be used."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, SupportsFloat, SupportsIndex

import numpy as np

from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray


def whole_number(name: str, value: SupportsIndex) -> int:
    """Take a whole number of at least 1, or say what was given instead.

    Parameters
    ----------
    name : str
        Name of the parameter, for the message.
    value : int
        What was given.

    Returns
    -------
    int
        The number.
    """
    try:
        number = operator.index(value)
    except TypeError:
        number = 0
    if number < 1:
        raise InputError(
            f"{name} = {shown(value)}: expected a whole number of at least 1; correct this value"
        )
    return number


def real_number(name: str, value: SupportsFloat) -> float:
    """Take a number, or say what was given instead.

    Parameters
    ----------
    name : str
        Name of the parameter, for the message.
    value : float
        What was given; may be infinite.

    Returns
    -------
    float
        The number.
    """
    try:
        number = float("nan") if isinstance(value, str | bytes) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = float("nan")
    if np.isnan(number):
        raise InputError(f"{name} = {shown(value)}: expected a number; correct this value")
    return number


def shown(value: object) -> str:
    """Show what was given in a few words.

    Parameters
    ----------
    value : object
        What was given.

    Returns
    -------
    str
        Its representation where that is short, its type otherwise.
    """
    words = repr(value)
    return words if len(words) <= 40 and "\n" not in words else f"a {type(value).__name__}"


def require_finite(name: str, values: NDArray[np.float64], *axes: str) -> None:
    """Refuse arrays with a value that is not finite, by its place.

    Parameters
    ----------
    name : str
        Name of the parameter, for the message.
    values : numpy.ndarray
        What was given.
    *axes : str
        What each axis counts: "row", "column", "gauge", "harmonic".
    """
    finite = np.isfinite(values)
    if not np.all(finite):
        # Rows and columns count from 0 as indices do, gauges and harmonics from 1 as in the paper.
        where = ", ".join(
            f"{axis} {index + (axis in {'gauge', 'harmonic'})}"
            for axis, index in zip(axes, np.argwhere(~finite)[0], strict=True)
        )
        raise InputError(
            f"{name} is not finite at {where}: expected numbers; leave that measurement out or "
            "repeat it"
        )
