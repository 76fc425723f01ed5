"""What a reader hands out: chunks of the mapped columns, as recorded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from strainwave.records.columns import FoundColumn


@dataclass(frozen=True)
class Stamps:
    """Time stamps as recorded.

    Attributes
    ----------
    values : numpy.ndarray
        Stamps, shape (rows,); int64 where the column holds whole numbers, so that nanoseconds since
        1970 keep their digits, else float64.
    missing : numpy.ndarray
        Where there is none, shape (rows,).
    unit : str or None
        Unit that the column itself has; None where the mapping says.
    """

    values: NDArray[np.int64] | NDArray[np.float64]
    missing: NDArray[np.bool_]
    unit: str | None = None


@dataclass(frozen=True)
class RawChunk:
    """Consecutive rows of a recording.

    Attributes
    ----------
    rows : int
        How many.
    values : dict
        Columns by key, each of shape (rows,), float64 in the recording's units; NaN where empty.
    time : Stamps or None
        The column of time, where one is mapped.
    """

    rows: int
    values: dict[str, NDArray[np.float64]]
    time: Stamps | None


class Recording(Protocol):
    """A recording that can be read any number of times."""

    @property
    def source(self) -> str:
        """Name for messages."""
        ...

    @property
    def names(self) -> Sequence[str] | None:
        """Names of the columns; None where there are none."""
        ...

    @property
    def column_count(self) -> int:
        """Number of columns."""
        ...

    def chunks(self, columns: Mapping[str, FoundColumn], /) -> Iterator[tuple[RawChunk, float]]:
        """Read the columns from the first row to the last.

        Parameters
        ----------
        columns : mapping
            What to read, by key; ``"time"`` is read as stamps.

        Yields
        ------
        tuple
            Consecutive rows, and the share of the recording that has been read, 0 to 1.
        """
        ...

    def texts(self, column: FoundColumn, /) -> tuple[str, ...]:
        """Read a whole column as it is written.

        Parameters
        ----------
        column : FoundColumn
            The column.

        Returns
        -------
        tuple of str
            A text for every row; empty where there is none.
        """
        ...
