"""Writes cleaned torque as CSV or Parquet, rows at a time, through a temporary file."""

from __future__ import annotations

import contextlib
import itertools
import os
from typing import TYPE_CHECKING, Any, Final

import pyarrow as pa

from strainwave.atomic import replaced_atomically
from strainwave.records.arrow_arrays import to_arrow
from strainwave.records.threads import done_behind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray
    from pyarrow.csv import CSVWriter
    from pyarrow.parquet import ParquetWriter

    from strainwave.methods.interface import Cleaned

COLUMNS: Final = ("time_s", "torque_measured_Nm", "torque_Nm", "ripple_Nm", "status")
_KINDS: Final = (*(pa.float64() for _ in COLUMNS[:-1]), pa.uint32())
_ROWS_PER_WRITE = 1 << 17
#: Writes after which the rows so far are sent to the disk, so that little is left to wait for at the
#: end.
_WRITES_PER_SYNC: Final = 8
_CSV_HEADER = (",".join(COLUMNS) + "\n").encode()


@contextlib.contextmanager
def result_file(
    path: Path,
) -> Iterator[Callable[[NDArray[np.float64], NDArray[np.float64], Cleaned], None]]:
    """Write a result whole or not at all.

    Parameters
    ----------
    path : Path
        Ends in .csv or .parquet; numbers in CSV have the digits that give them back exactly, and a
        value that is not there is an empty field.

    Yields
    ------
    callable
        Writes consecutive rows: time, s, measured torque, Nm, and what a method made of them.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    is_csv = path.suffix.lower() == ".csv"
    # In Parquet a value that is not there is NaN: that none is null need not be written for each.
    schema = pa.schema(
        [pa.field(name, kind, is_csv) for name, kind in zip(COLUMNS, _KINDS, strict=True)]
    )
    with (
        replaced_atomically(path) as stream,
        done_behind(os.fdatasync, most_waiting=1) as send_to_disk,
    ):
        writer: CSVWriter | ParquetWriter
        if is_csv:
            from pyarrow.csv import CSVWriter, WriteOptions  # noqa: PLC0415 - where it is used

            # Arrow puts names in quotes, which no reader of ours needs.
            stream.write(_CSV_HEADER)
            writer = CSVWriter(stream, schema, write_options=WriteOptions(include_header=False))
        else:
            from pyarrow.parquet import ParquetWriter  # noqa: PLC0415 - where it is used

            # Measured numbers hardly repeat: a dictionary of them takes longer than all the rest.
            writer = ParquetWriter(stream, schema, use_dictionary=["status"])

        pending: list[pa.RecordBatch] = []
        writes = itertools.count(1)

        def flush() -> None:
            # One write is one row group of Parquet: few large ones are read faster.
            writer.write_table(pa.Table.from_batches(pending, schema))
            pending.clear()
            if next(writes) % _WRITES_PER_SYNC == 0:
                stream.flush()
                send_to_disk(stream.fileno())

        def write(
            time_s: NDArray[np.float64], measured_Nm: NDArray[np.float64], cleaned: Cleaned
        ) -> None:
            columns: list[NDArray[Any]] = [time_s, measured_Nm, cleaned.torque_Nm]
            columns += [cleaned.ripple_Nm, cleaned.status]
            arrays = [
                to_arrow(field.type, values, gaps=is_csv)
                for field, values in zip(schema, columns, strict=True)
            ]
            pending.append(pa.record_batch(arrays, schema=schema))
            if sum(batch.num_rows for batch in pending) >= _ROWS_PER_WRITE:
                flush()

        with writer:
            yield write
            flush()
