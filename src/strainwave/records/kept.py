"""A recording that is read once where it is short enough to be kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from strainwave.records.columns import FoundColumn
    from strainwave.records.raw import RawChunk, Recording

#: Columns of ten million rows of time, angle and torque fit in, beside all else in a gigabyte.
MOST_KEPT_BYTES: Final = 256 << 20


class KeptRecording:
    """Keeps the columns that were read from the first row to the last, for the next time.

    Parameters
    ----------
    recording : Recording
        What is read.
    most_bytes : int
        A recording of more is read again each time.
    """

    def __init__(self, recording: Recording, *, most_bytes: int = MOST_KEPT_BYTES) -> None:
        self._recording = recording
        self._most_bytes = most_bytes
        self._columns: dict[str, FoundColumn] | None = None
        self._kept: list[tuple[RawChunk, float]] = []

    @property
    def source(self) -> str:
        """Name for messages."""
        return self._recording.source

    @property
    def names(self) -> Sequence[str] | None:
        """Names of the columns; None where there are none."""
        return self._recording.names

    @property
    def column_count(self) -> int:
        """Number of columns."""
        return self._recording.column_count

    def chunks(self, columns: Mapping[str, FoundColumn], /) -> Iterator[tuple[RawChunk, float]]:
        """Read the columns from the first row to the last, or hand out what was kept of them.

        Parameters
        ----------
        columns : mapping
            What to read, by key; ``"time"`` is read as stamps.

        Yields
        ------
        tuple
            Consecutive rows, and the share of the recording that has been read, 0 to 1.
        """
        if self._columns == columns:
            yield from self._kept
            return
        kept: list[tuple[RawChunk, float]] = []
        room = self._most_bytes
        for part in self._recording.chunks(columns):
            room -= _bytes_of(part[0])
            if room >= 0:
                kept.append(part)
            else:
                kept.clear()
            yield part
        if room >= 0:
            self._kept, self._columns = kept, dict(columns)

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
        return self._recording.texts(column)


def _bytes_of(chunk: RawChunk) -> int:
    size = sum(values.nbytes for values in chunk.values.values())
    if chunk.time is not None:
        size += chunk.time.values.nbytes + chunk.time.missing.nbytes
    return size
