"""Reads Parquet recordings in batches: the mapped columns alone, whatever kind of number they hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from strainwave.errors import InputError
from strainwave.records.arrow_arrays import from_arrow, missing_in
from strainwave.records.raw import RawChunk, Stamps

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.records.columns import FoundColumn

ROWS_PER_CHUNK: Final = 1 << 16
_PAGE_BUFFER_BYTES = 1 << 20
# Names of columns that are no text come as the last one.
_DAMAGED = (pa.ArrowException, OSError, UnicodeDecodeError)


class ParquetRecording:
    """A recording in a Parquet file.

    Parameters
    ----------
    path : Path
        The file.
    rows_per_chunk : int
        How many rows are read at a time.

    Raises
    ------
    InputError
        If the file is not Parquet or holds no rows.
    """

    def __init__(self, path: Path, *, rows_per_chunk: int = ROWS_PER_CHUNK) -> None:
        self._path = path
        self._rows_per_chunk = rows_per_chunk
        self.source = str(path)
        try:
            with self._open() as file:
                self._schema = file.schema_arrow
                self._rows = file.metadata.num_rows
        except _DAMAGED as error:
            raise self._unreadable(error) from error
        self.names: Sequence[str] | None = tuple(self._schema.names)
        self.column_count = len(self._schema.names)
        if self._rows == 0:
            raise InputError(
                f"{path}: it holds no rows; expected rows of numbers, so record it again"
            )

    def _open(self) -> pq.ParquetFile:
        # Pages are read as they are needed: a row group of any size fits into memory.
        return pq.ParquetFile(self._path, buffer_size=_PAGE_BUFFER_BYTES, pre_buffer=False)

    def _unreadable(self, error: Exception) -> InputError:
        words = (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")
        if self._path.is_file() and self._path.stat().st_size == 0:
            words = "it is empty"
        return InputError(
            f"{self._path}: it cannot be read as Parquet ({words}); expected a whole Parquet file, "
            "so check whether it was written to its end"
        )

    def chunks(self, columns: Mapping[str, FoundColumn], /) -> Iterator[tuple[RawChunk, float]]:
        """Read the columns from the first row to the last.

        Parameters
        ----------
        columns : mapping
            What to read, by key; ``"time"`` is read as stamps.

        Yields
        ------
        tuple
            Consecutive rows, and the share of the rows that has been read, 0 to 1.

        Raises
        ------
        InputError
            If a column holds something else than numbers, or the file is damaged.
        """
        for key, column in columns.items():
            self._check_type(key, column)
        schema_names = self._schema.names
        names = list(dict.fromkeys(schema_names[column.index] for column in columns.values()))
        # Columns come in the order in which they are asked for by name, and names may repeat.
        read = [
            index for name in names for index, other in enumerate(schema_names) if other == name
        ]
        places = {key: read.index(column.index) for key, column in columns.items()}
        done = 0
        try:
            with self._open() as file:
                for batch in file.iter_batches(
                    self._rows_per_chunk, columns=names, use_threads=False
                ):
                    done += batch.num_rows
                    found = {key: batch.column(place) for key, place in places.items()}
                    time = _stamps(found.pop("time")) if "time" in found else None
                    values = {key: _numbers(array) for key, array in found.items()}
                    yield RawChunk(batch.num_rows, values, time), done / self._rows
        except _DAMAGED as error:
            raise self._unreadable(error) from error

    def texts(self, column: FoundColumn, /) -> tuple[str, ...]:
        """Read a whole column as text.

        Parameters
        ----------
        column : FoundColumn
            The column.

        Returns
        -------
        tuple of str
            A text for every row; empty where there is none. Whole numbers have no decimal point.

        Raises
        ------
        InputError
            If the file is damaged.
        """
        try:
            with self._open() as file:
                values = file.read(columns=None).column(column.index).to_pylist()
        except _DAMAGED as error:
            raise self._unreadable(error) from error
        return tuple("" if value is None else str(value).strip() for value in values)

    def _check_type(self, key: str, column: FoundColumn) -> None:
        kind = self._schema.types[column.index]
        if pa.types.is_dictionary(kind):
            kind = kind.value_type
        if _is_number(kind) or (key == "time" and _is_time(kind)):
            return
        what = "text" if pa.types.is_string(kind) or pa.types.is_large_string(kind) else str(kind)
        expected = "numbers or time stamps" if key == "time" else "numbers"
        raise InputError(
            f"{self._path}: {column.label} for {key} holds {what}, from row 1 on; expected "
            f"{expected}, so map another column or convert this one"
        )


def _is_number(kind: pa.DataType) -> bool:
    is_kind = (
        pa.types.is_integer,
        pa.types.is_floating,
        pa.types.is_decimal,
        pa.types.is_boolean,
        pa.types.is_null,
    )
    return any(check(kind) for check in is_kind)


def _is_time(kind: pa.DataType) -> bool:
    return bool(pa.types.is_timestamp(kind) or pa.types.is_duration(kind) or pa.types.is_time(kind))


def _decoded(array: pa.Array) -> pa.Array:
    return array.dictionary_decode() if pa.types.is_dictionary(array.type) else array


def _numbers(array: pa.Array) -> NDArray[np.float64]:
    array = _decoded(array)
    if pa.types.is_boolean(array.type):
        array = array.cast(pa.int8())
    if not pa.types.is_float64(array.type):
        # Not "safe": a whole number beyond 2^53 is rounded, as every other number is.
        array = array.cast(pa.float64(), safe=False)
    return from_arrow(array, np.nan)


def _stamps(array: pa.Array) -> Stamps:
    array = _decoded(array)
    unit: str | None = None
    if _is_time(array.type):
        unit = array.type.unit
        array = array.cast(pa.int32() if array.type.bit_width == 32 else pa.int64())
    if pa.types.is_integer(array.type) and not pa.types.is_uint64(array.type):
        whole = array.cast(pa.int64())
        return Stamps(from_arrow(whole, 0), missing_in(whole), unit)
    values = _numbers(array)
    return Stamps(values, ~np.isfinite(values), unit)
