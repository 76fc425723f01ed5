"""Pieces of a long recording: many rows at once for who cuts them into time chunks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from strainwave.methods.time_chunks import in_time_chunks
from strainwave.records.signals import joined_rows
from strainwave.records.threads import made_ahead

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from strainwave.methods.interface import Method
    from strainwave.methods.time_chunks import InTimeChunks
    from strainwave.records.signals import Rows
    from strainwave.records.survey import Survey

#: A shorter recording is filtered in sequence: nobody would notice what time chunks save.
LEAST_ROWS: Final = 1 << 19
#: Short pieces where warm-ups are short, else long ones; those that are there at a time take less
#: than a gigabyte.
SHORT_PIECE_ROWS: Final = 1 << 20
LONG_PIECE_ROWS: Final = 1 << 21
#: Warm-ups that would fit into a piece where they hardly cost anything, and where chunks are still
#: twice as quick as sequence.
_MANY_WARM_UPS: Final = 64
_LEAST_WARM_UPS: Final = 4


class LongRun(NamedTuple):
    """How a long recording is filtered.

    Attributes
    ----------
    method : InTimeChunks
        Takes pieces.
    piece_rows : int
        How long they are.
    """

    method: InTimeChunks
    piece_rows: int


def long_run(method: Method, survey: Survey) -> LongRun | None:
    """Choose how a recording is filtered in time chunks.

    Parameters
    ----------
    method : Method
        The method in its state before the first row.
    survey : Survey
        What the recording holds.

    Returns
    -------
    LongRun or None
        None where it is filtered in sequence: it is short, the method has to, or its memory leaves
        too few chunks to a piece.
    """
    chunked = None if survey.rows < LEAST_ROWS else in_time_chunks(method)
    if chunked is None:
        return None
    if chunked.warm_up_turns == 0.0:
        return LongRun(chunked, SHORT_PIECE_ROWS)
    speed_rad_s = (survey.moving.typical_speed_rad_s or 0.0) * (1.0 - survey.share_at_rest)
    turns_per_piece = SHORT_PIECE_ROWS * survey.sample_period_s * speed_rad_s / (2.0 * math.pi)
    if turns_per_piece >= _MANY_WARM_UPS * chunked.warm_up_turns:
        return LongRun(chunked, SHORT_PIECE_ROWS)
    turns_per_piece *= LONG_PIECE_ROWS / SHORT_PIECE_ROWS
    if turns_per_piece >= _LEAST_WARM_UPS * chunked.warm_up_turns:
        return LongRun(chunked, LONG_PIECE_ROWS)
    return None


def in_pieces(parts: Iterable[Rows], piece_rows: int) -> Iterator[Rows]:
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
