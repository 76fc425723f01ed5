"""A recording that is kept is read once, gives the same, and is given up where it is too long."""

from pathlib import Path

import numpy as np
import pytest

from helpers.log_files import healthy, write_csv
from strainwave.records.columns import find_columns
from strainwave.records.csv_reader import CsvRecording
from strainwave.records.kept import KeptRecording
from strainwave.records.mapping import parse_mapping
from strainwave.records.opening import open_recording

MAP = parse_mapping(["time=t_s,angle=q_rad,torque=tau_Nm"])


class Counting:
    """A recording that counts how often it is read to its end."""

    def __init__(self, recording):
        self.recording = recording
        self.source, self.names = recording.source, recording.names
        self.column_count = recording.column_count
        self.readings = 0

    def chunks(self, columns, /):
        yield from self.recording.chunks(columns)
        self.readings += 1


@pytest.fixture
def counting(tmp_path: Path) -> Counting:
    path = write_csv(tmp_path / "log.csv", healthy(5000))
    return Counting(CsvRecording(path, block_bytes=1 << 14))


def _found(recording, mapping=MAP):
    return find_columns(mapping, recording.names, recording.column_count, recording.source)


def _read(recording, columns):
    return [
        (
            chunk.rows,
            chunk.time.values.tolist(),
            *(v.tolist() for v in chunk.values.values()),
            share,
        )
        for chunk, share in recording.chunks(columns)
    ]


def test_what_was_read_once_is_handed_out_again(counting: Counting) -> None:
    kept = KeptRecording(counting)
    columns = _found(counting)
    first = _read(kept, columns)
    assert len(first) > 5
    assert _read(kept, dict(columns)) == first
    assert counting.readings == 1
    assert (kept.source, kept.names) == (counting.source, counting.names)
    assert kept.column_count == counting.column_count


def test_other_columns_are_read(counting: Counting) -> None:
    kept = KeptRecording(counting)
    columns = _found(counting)
    _read(kept, columns)
    turned = _found(counting, parse_mapping(["time=t_s,angle=q_rad,torque=-tau_Nm"]))
    assert turned != columns
    _read(kept, turned)
    assert counting.readings == 2


def test_what_was_read_in_part_is_not_kept(counting: Counting) -> None:
    kept = KeptRecording(counting)
    columns = _found(counting)
    next(kept.chunks(columns))
    whole = _read(kept, columns)
    assert counting.readings == 1
    assert _read(kept, columns) == whole
    assert counting.readings == 1


@pytest.mark.parametrize(("most_bytes", "readings"), [(5000 * 25, 1), (5000 * 25 - 1, 2)])
def test_a_long_recording_is_read_again(counting: Counting, most_bytes: int, readings: int) -> None:
    # A row is three numbers, and whether its time is missing.
    kept = KeptRecording(counting, most_bytes=most_bytes)
    columns = _found(counting)
    assert _read(kept, columns) == _read(kept, columns)
    assert counting.readings == readings


def test_text_is_kept(tmp_path: Path) -> None:
    path = write_csv(tmp_path / "log.csv", healthy(100))
    recording = open_recording(path)
    columns = _found(recording)
    first = _read(recording, columns)
    path.unlink()
    assert _read(recording, columns) == first
    assert np.size(first[0][1]) == 100
