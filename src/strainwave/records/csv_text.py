"""From the text of CSV fields to numbers; where one is none, the row is found."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from strainwave.records.arrow_arrays import from_arrow, missing_in

if TYPE_CHECKING:
    from numpy.typing import NDArray

MISSING_TEXTS: Final = ("", "nan", "NaN", "NAN", "null", "NULL", "NA", "N/A", "n/a", "None", "none")
"""What stands for a value that is not there."""


class NotANumberError(Exception):
    """A field holds something else than a number.

    Parameters
    ----------
    index : int
        Its place in the chunk, from 0.
    text : str
        What it holds.
    """

    def __init__(self, index: int, text: str) -> None:
        super().__init__(index, text)
        self.index = index
        self.text = text


def numbers(texts: pa.Array) -> NDArray[np.float64]:
    """Convert fields to numbers.

    Parameters
    ----------
    texts : pyarrow.StringArray
        Fields; null where empty.

    Returns
    -------
    numpy.ndarray
        float64, NaN where empty.

    Raises
    ------
    NotANumberError
        If a field holds anything but a number.
    """
    try:
        found = pc.cast(texts, pa.float64())
    except pa.ArrowInvalid:
        found = _patient(texts)
    return from_arrow(found, np.nan)


def whole_numbers(texts: pa.Array) -> tuple[NDArray[np.int64], NDArray[np.bool_]] | None:
    """Convert fields to whole numbers where every one is.

    Parameters
    ----------
    texts : pyarrow.StringArray
        Fields; null where empty.

    Returns
    -------
    tuple or None
        The numbers (0 where empty) and where fields are empty; None where one is no whole number.
    """
    try:
        found = pc.cast(texts, pa.int64())
    except pa.ArrowInvalid:
        try:
            found = pc.cast(_trimmed(texts), pa.int64())
        except pa.ArrowInvalid:
            return None
    return from_arrow(found, 0), missing_in(found)


def _trimmed(texts: pa.Array) -> pa.Array:
    """Remove blanks around a number and a leading plus, which Arrow's own conversion refuses."""
    trimmed = pc.utf8_trim_whitespace(texts)
    missing = pc.is_in(trimmed, value_set=pa.array(MISSING_TEXTS))
    return pc.replace_substring_regex(
        pc.if_else(missing, None, trimmed), pattern=r"^\+([0-9.])", replacement=r"\1"
    )


def _patient(texts: pa.Array) -> pa.Array:
    cleaned = _trimmed(texts)
    try:
        return pc.cast(cleaned, pa.float64())
    except pa.ArrowInvalid:
        index = _first_bad(cleaned)
        raise NotANumberError(index, texts[index].as_py()) from None


def _first_bad(texts: pa.Array) -> int:
    """Halve the chunk until the field is found that Arrow refuses."""
    start, length = 0, len(texts)
    while length > 1:
        half = length // 2
        try:
            pc.cast(texts.slice(start, half), pa.float64())
        except pa.ArrowInvalid:
            length = half
        else:
            start, length = start + half, length - half
    return start
