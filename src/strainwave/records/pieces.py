"""Pieces of a long recording: many rows at once for who cuts them into time chunks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from strainwave.records.signals import joined_rows
from strainwave.records.threads import made_ahead

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from strainwave.records.signals import Rows

#: A shorter recording is filtered in sequence: nobody would notice what time chunks save.
LEAST_ROWS: Final = 1 << 19
#: Room for the chunks of two threads with their warm-ups, and half a dozen pieces at a time fit into
#: half a gigabyte.
PIECE_ROWS: Final = 1 << 20


def in_pieces(parts: Iterable[Rows], piece_rows: int = PIECE_ROWS) -> Iterator[Rows]:
    """Put consecutive rows together into pieces, one ahead of the one that is used.

    Parameters
    ----------
    parts : iterable of Rows
        Consecutive rows.
    piece_rows : int
        A piece ends with the part that fills it.

    Yields
    ------
    Rows
        The same rows.
    """
    yield from made_ahead(_pieces(parts, piece_rows), most_waiting=1)


def _pieces(parts: Iterable[Rows], piece_rows: int) -> Iterator[Rows]:
    waiting: list[Rows] = []
    for part in parts:
        waiting.append(part)
        if sum(map(len, waiting)) >= piece_rows:
            yield joined_rows(waiting)
            waiting.clear()
    yield joined_rows(waiting)
