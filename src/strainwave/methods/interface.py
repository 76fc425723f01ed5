"""What every method of removing ripple takes and gives: chunks of samples in, chunks of torque out.

A method is asked in chunks, so that a log of any length fits into memory; how a log is cut makes no
difference to the result. A method that looks ahead (a smoother) holds rows back and hands them out
later; over a whole log every method gives exactly one row for each row it was given.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from strainwave.samples import Samples

Number = TypeVar("Number", bound=np.generic)


@dataclass(frozen=True)
class Cleaned:
    """What a method makes of consecutive rows.

    Attributes
    ----------
    torque_Nm : numpy.ndarray
        Torque without ripple, shape (rows,), Nm; a rejected row holds the last good value.
    ripple_Nm : numpy.ndarray
        What was removed, shape (rows,), Nm.
    status : numpy.ndarray
        Bits of `strainwave.StatusFlag`, shape (rows,), uint32.
    """

    torque_Nm: NDArray[np.float64]
    ripple_Nm: NDArray[np.float64]
    status: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.torque_Nm)

    def part(self, rows: slice) -> Cleaned:
        """Take some of the rows.

        Parameters
        ----------
        rows : slice
            Which.

        Returns
        -------
        Cleaned
            These, without a copy.
        """
        return Cleaned(self.torque_Nm[rows], self.ripple_Nm[rows], self.status[rows])


class Method(Protocol):
    """One way of removing ripple, with its state between chunks."""

    def process(self, samples: Samples, /) -> Cleaned:
        """Take the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            Rows that are ready, in order: as many as were taken, or fewer where the method looks
            ahead.
        """
        ...

    def finish(self) -> Cleaned:
        """Hand out the rows held back, at the end of the recording.

        Returns
        -------
        Cleaned
            The rest; no rows where the method does not look ahead.
        """
        ...


def nothing() -> Cleaned:
    """No rows: what `Method.finish` returns for a method that does not look ahead.

    Returns
    -------
    Cleaned
        Arrays of length 0.
    """
    return Cleaned(np.empty(0), np.empty(0), np.empty(0, np.uint32))


def joined(parts: Iterable[Cleaned]) -> Cleaned:
    """Put consecutive results together.

    Parameters
    ----------
    parts : iterable of Cleaned
        Results in order.

    Returns
    -------
    Cleaned
        All their rows; the only part that has any as it is.
    """
    listed = [part for part in parts if len(part)] or [nothing()]
    return Cleaned(
        together([part.torque_Nm for part in listed]),
        together([part.ripple_Nm for part in listed]),
        together([part.status for part in listed]),
    )


def together(arrays: list[NDArray[Number]]) -> NDArray[Number]:
    """Put consecutive arrays together; a single one is handed back as it is.

    Parameters
    ----------
    arrays : list of numpy.ndarray
        One at least, each of shape (rows,).

    Returns
    -------
    numpy.ndarray
        All their rows.
    """
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
