"""Reads CSV recordings in blocks: the mapped columns alone, with the line of whatever is wrong."""

from __future__ import annotations

import csv
import itertools
import re
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import pyarrow as pa
import pyarrow.csv

from strainwave.errors import InputError
from strainwave.records.csv_text import MISSING_TEXTS, NotANumberError, numbers, whole_numbers
from strainwave.records.raw import RawChunk, Stamps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from strainwave.records.columns import FoundColumn

BLOCK_BYTES: Final = 4 << 20
_DELIMITERS = ",;\t"
_LONGEST_LINE_BYTES = 1 << 20


class CsvRecording:
    """A recording in a CSV file.

    The delimiter (comma, semicolon or tab) is the one that the first line has most of. The first
    line holds the names, unless all of it are numbers that do not simply count the columns.

    Parameters
    ----------
    path : Path
        The file.
    block_bytes : int
        How much is read at a time.

    Raises
    ------
    InputError
        If the file is empty, holds no data row or is not text in UTF-8.
    """

    def __init__(self, path: Path, *, block_bytes: int = BLOCK_BYTES) -> None:
        self._path = path
        self._block_bytes = block_bytes
        self.source = str(path)
        self._header_line, first, second = self._first_lines()
        self._delimiter = max(_DELIMITERS, key=first.count)
        try:
            cells = [cell.strip() for cell in next(csv.reader([first], delimiter=self._delimiter))]
        except csv.Error as error:
            raise InputError(
                f"{path}: its first line cannot be read ({error}); expected lines of fields by "
                "commas, semicolons or tabs that end in a line feed, so save it anew"
            ) from error
        self.column_count = len(cells)
        self._named = not _all_numbers(cells) or _counts_columns(cells)
        self.names: Sequence[str] | None = tuple(cells) if self._named else None
        if self._named and second is None:
            raise InputError(
                f"{path}: it holds a header and no data; expected rows of numbers below the names, "
                "so record it again"
            )

    def _first_lines(self) -> tuple[int, str, str | None]:
        """Return the number of the first line with text, that line, and the next with text."""
        found: list[tuple[int, str]] = []
        try:
            with self._path.open("rb") as stream:
                for number in itertools.count(1):
                    line = stream.readline(_LONGEST_LINE_BYTES)
                    if number == 1 and line.startswith((b"\xff\xfe", b"\xfe\xff")):
                        raise InputError(
                            f"{self._path}: it is text in UTF-16; expected UTF-8, so save it anew "
                            "as CSV (UTF-8)"
                        )
                    if not line or len(found) == 2:
                        break
                    text = _decoded(line.removeprefix(b"\xef\xbb\xbf")).strip("\r\n")
                    if text.strip():
                        found.append((number, text))
        except OSError as error:
            raise self._unreadable(error) from error
        if not found:
            raise InputError(
                f"{self._path}: it is empty; expected a line of column names and rows of numbers, "
                "so record it again"
            )
        if "\0" in found[0][1]:
            raise InputError(
                f"{self._path}: it is no text; expected CSV in UTF-8, so check which file this is"
            )
        return found[0][0], found[0][1], found[1][1] if len(found) > 1 else None

    def _unreadable(self, error: Exception) -> InputError:
        reason = getattr(error, "strerror", None) or str(error)
        return InputError(
            f"{self._path}: it cannot be read ({reason.lower()}); expected a CSV file that you may "
            "read, so check the file"
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
            Consecutive rows, and the share of the file that has been read, 0 to 1.

        Raises
        ------
        InputError
            If a field is no number, or a line has too few or too many fields.
        """
        size = max(1, self._path.stat().st_size)
        first_row, whole = 1, True
        for batch, position in self._batches(columns):
            values = {}
            time: Stamps | None = None
            for key, column in columns.items():
                texts = batch.column(f"f{column.index}")
                try:
                    if key == "time":
                        time, whole = _stamps(texts, whole)
                    else:
                        values[key] = numbers(texts)
                except NotANumberError as error:
                    raise self._no_number(error, column, first_row) from None
            yield RawChunk(batch.num_rows, values, time), min(1.0, position / size)
            first_row += batch.num_rows

    def texts(self, column: FoundColumn, /) -> tuple[str, ...]:
        """Read a whole column as it is written.

        Parameters
        ----------
        column : FoundColumn
            The column.

        Returns
        -------
        tuple of str
            A text for every row, without spaces around it; empty where there is none.

        Raises
        ------
        InputError
            If a line has too few or too many fields.
        """
        return tuple(
            (text or "").strip()
            for batch, _ in self._batches({"": column})
            for text in batch.column(f"f{column.index}").to_pylist()
        )

    def _batches(self, columns: Mapping[str, FoundColumn]) -> Iterator[tuple[pa.RecordBatch, int]]:
        wanted = sorted({f"f{column.index}" for column in columns.values()})
        try:
            with pa.OSFile(str(self._path)) as stream:
                reader = pyarrow.csv.open_csv(
                    stream,
                    read_options=pyarrow.csv.ReadOptions(
                        use_threads=False,
                        block_size=self._block_bytes,
                        # Names of our own: the file's may repeat.
                        autogenerate_column_names=True,
                        skip_rows=self._header_line - (0 if self._named else 1),
                    ),
                    parse_options=pyarrow.csv.ParseOptions(delimiter=self._delimiter),
                    convert_options=pyarrow.csv.ConvertOptions(
                        include_columns=wanted,
                        column_types=dict.fromkeys(wanted, pa.string()),
                        null_values=list(MISSING_TEXTS),
                        strings_can_be_null=True,
                    ),
                )
                for batch in reader:
                    if batch.num_rows:
                        yield batch, stream.tell()
        except pa.ArrowException as error:
            raise self._broken(error) from error
        except OSError as error:
            raise self._unreadable(error) from error

    def _broken(self, error: Exception) -> InputError:
        words = str(error)
        match = re.search(r"Expected (\d+) columns, got (\d+)", words)
        if match:
            place = self._place(lambda _, line: self._field_count(line) != self.column_count)
            return InputError(
                f"{self._path}{place} has {match[2]} fields, but the first line has "
                f"{self.column_count}; expected as many in every line, so complete the line or "
                "remove it (a recording that was cut off ends in such a line)"
            )
        if "UTF8" in words.upper():
            return InputError(
                f"{self._path}: a mapped column holds text that is not UTF-8; expected numbers, so "
                "save it anew as CSV (UTF-8)"
            )
        return InputError(
            f"{self._path}: it cannot be read as CSV ({words.splitlines()[0]}); expected lines of "
            "fields by commas, semicolons or tabs, so check the file"
        )

    def _field_count(self, line: str) -> int:
        try:
            return len(next(csv.reader([line], delimiter=self._delimiter)))
        except csv.Error:
            return 0

    def _no_number(self, bad: NotANumberError, column: FoundColumn, first_row: int) -> InputError:
        wanted = first_row + bad.index
        place = self._place(lambda row, _: row == wanted)
        advice = "correct it, or leave the field empty"
        if re.fullmatch(r"\s*[-+]?\d+,\d+\s*", bad.text):
            advice = "write a decimal point instead of the comma"
        return InputError(
            f"{self._path}{place}, {column.label} holds {bad.text[:60]!r}; expected a number, so "
            f"{advice}"
        )

    def _place(self, is_it: Callable[[int, str], bool]) -> str:
        """Say the row and the line that a message is about; blank lines are no rows."""
        row = 0 if self._named else 1
        with self._path.open("rb") as stream:
            for number, line in enumerate(stream, 1):
                text = _decoded(line.removeprefix(b"\xef\xbb\xbf")).strip("\r\n")
                if not text:
                    continue
                if row and is_it(row, text):
                    return f": row {row} (line {number})"
                row += 1
        return ": a line"


def _stamps(texts: pa.Array, try_whole: bool) -> tuple[Stamps, bool]:
    if try_whole:
        found = whole_numbers(texts)
        if found is not None:
            return Stamps(found[0], found[1]), True
    values = numbers(texts)
    return Stamps(values, ~np.isfinite(values)), False


def _decoded(line: bytes) -> str:
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        # Old loggers write the names (µ, °) in Latin-1; the numbers are the same in both.
        return line.decode("latin-1")


def _all_numbers(cells: Sequence[str]) -> bool:
    try:
        for cell in cells:
            float(cell or "nan")
    except ValueError:
        return False
    return any(cells)


def _counts_columns(cells: Sequence[str]) -> bool:
    """Whether the cells are 0, 1, 2... or 1, 2, 3..., which some tools write where names are not."""
    counted = [cell for cell in cells if cell]
    return len(counted) > 1 and any(
        counted == [str(number) for number in range(start, start + len(counted))]
        for start in (0, 1)
    )
