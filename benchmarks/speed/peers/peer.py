"""One implementation of a filter, as the worker runs it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray


def as_it_is(result: Any) -> NDArray[Any]:
    """Return a result that is the ripple already.

    Parameters
    ----------
    result : numpy.ndarray
        Of a run.

    Returns
    -------
    numpy.ndarray
        The same.
    """
    ripple: NDArray[Any] = result
    return ripple


@dataclass(frozen=True)
class Peer:
    """One implementation of a filter.

    Attributes
    ----------
    version : str
        Of the package that does the work.
    run : callable
        Filters so many samples from the start; this is timed.
    ripple_Nm : callable
        Takes the predicted ripple from what `run` returned; this is not.
    """

    version: str
    run: Callable[[int], Any]
    ripple_Nm: Callable[[Any], NDArray[Any]] = as_it_is
