"""CSV and Parquet in all their dialects hold the same numbers."""

from __future__ import annotations

import json
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.log_files import Halving, healthy, read_result, write_csv, write_parquet
from strainwave.errors import InputError
from strainwave.records import Options, filter_log
from strainwave.records.columns import find_columns
from strainwave.records.csv_reader import CsvRecording
from strainwave.records.mapping import parse_mapping
from strainwave.records.opening import open_recording
from strainwave.records.parquet_reader import ParquetRecording
from strainwave.records.raw import Recording

SMALL = "t,q,tau\n0,1,2.5\n1,,nan\n2,3,-4e-1\n"
EXPECTED = {"angle": [1.0, np.nan, 3.0], "torque": [2.5, np.nan, -0.4]}


def read(recording: Recording, text: str = "time=t,angle=q,torque=tau") -> dict[str, np.ndarray]:
    found = find_columns(
        parse_mapping([text]), recording.names, recording.column_count, recording.source
    )
    parts: dict[str, list[Any]] = {}
    share = 0.0
    for chunk, done in recording.chunks(found):
        assert share <= done <= 1.0
        share = done
        for key, values in chunk.values.items():
            assert len(values) == chunk.rows
            parts.setdefault(key, []).append(values)
        if chunk.time is not None:
            parts.setdefault("time", []).append(chunk.time.values)
    assert share == 1.0
    return {key: np.concatenate(values) for key, values in parts.items()}


def file_of(tmp_path: Path, content: str | bytes) -> Path:
    path = tmp_path / "log.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


DIALECTS = {
    "plain": SMALL,
    "semicolons": SMALL.replace(",", ";"),
    "tabs": SMALL.replace(",", "\t"),
    "carriage returns": SMALL.replace("\n", "\r\n"),
    "byte order mark": b"\xef\xbb\xbf" + SMALL.encode(),
    "blanks": SMALL.replace(",", " , "),
    "quotes": 't,"q","tau"\n"0",1,"2.5"\n1,"",nan\n2,3,-4e-1\n',
    "no last line end": SMALL.rstrip(),
    "blank lines": "\n" + SMALL.replace("\n1,", "\n\n\n1,") + "\n\n",
    "plus signs": SMALL.replace("2.5", "+2.5").replace(",3,", ",+3,"),
    "words for nothing": SMALL.replace("nan", "N/A").replace(",,", ",NULL,"),
    "other columns hold anything": "t,name,q,tau\n0,µ,1,2.5\n1,x,,nan\n2,,3,-4e-1\n".encode(
        "latin-1"
    ),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_dialects_of_csv(tmp_path: Path, dialect: str) -> None:
    found = read(CsvRecording(file_of(tmp_path, DIALECTS[dialect])))
    for key, values in EXPECTED.items():
        np.testing.assert_array_equal(found[key], values)
    assert found["time"].tolist() == [0, 1, 2]
    assert found["time"].dtype == np.int64


@pytest.mark.parametrize(
    ("content", "names"),
    [
        ("0,1,2\n5,6,7\n", ("0", "1", "2")),
        (",1,2\n5,6,7\n", ("", "1", "2")),
        ("0.5,1,2\n5,6,7\n", None),
        ("5,6,7\n", None),
        ("1\n", None),
    ],
)
def test_columns_without_names(tmp_path: Path, content: str, names: tuple[str, ...] | None) -> None:
    recording = CsvRecording(file_of(tmp_path, content))
    assert recording.names == names
    rows = content.count("\n") - (names is not None)
    assert len(read(recording, "torque=1")["torque"]) == rows


def test_lines_are_counted_where_columns_have_no_names(tmp_path: Path) -> None:
    recording = CsvRecording(file_of(tmp_path, "0.5,1\n\n1.5,x\n"))
    with pytest.raises(InputError, match=r"row 2 \(line 3\), column 2 holds 'x'"):
        read(recording, "time=1,torque=2")


@pytest.mark.parametrize("block_bytes", [1000, 4096, 1 << 20])
def test_text_in_a_late_block_has_its_row(tmp_path: Path, block_bytes: int) -> None:
    columns = healthy(3000)
    columns["tau_Nm"] = [*columns["tau_Nm"][:2500], "12 Nm", *columns["tau_Nm"][2501:]]
    log = write_csv(tmp_path / "log.csv", columns)
    with pytest.raises(InputError, match=r"row 2501 \(line 2502\), column 'tau_Nm' holds '12 Nm'"):
        read(CsvRecording(log, block_bytes=block_bytes), "time=t_s,torque=tau_Nm")


def test_text_that_is_not_utf8_in_a_mapped_column(tmp_path: Path) -> None:
    path = file_of(tmp_path, "t,tau\n0,1\n1,µ\n".encode("latin-1"))
    with pytest.raises(InputError, match="a mapped column holds text that is not UTF-8"):
        read(CsvRecording(path), "time=t,torque=tau")


def test_a_file_that_grows_too_few_fields_late(tmp_path: Path) -> None:
    path = file_of(tmp_path, "t,tau\n" + "1,2\n" * 3000 + "1\n")
    with pytest.raises(InputError, match=r"row 3001 \(line 3002\) has 1 fields, but the first"):
        read(CsvRecording(path, block_bytes=1000), "time=t,torque=tau")


@pytest.mark.parametrize(
    "make",
    [
        lambda path: CsvRecording(write_csv(path, healthy(3000)), block_bytes=1 << 12),
        lambda path: ParquetRecording(write_parquet(path, healthy(3000)), rows_per_chunk=17),
    ],
)
def test_every_digit_is_read(tmp_path: Path, make: Callable[[Path], Recording]) -> None:
    found = read(make(tmp_path / "log.file"), "time=t_s,angle=q_rad,torque=tau_Nm")
    for key, values in zip(("time", "angle", "torque"), healthy(3000).values(), strict=True):
        np.testing.assert_array_equal(found[key], values)


def test_the_same_column_twice(tmp_path: Path) -> None:
    for path in (
        write_csv(tmp_path / "log.csv", healthy(10)),
        write_parquet(tmp_path / "log.parquet", healthy(10)),
    ):
        found = read(open_recording(path), "angle=q_rad,torque=q_rad")
        np.testing.assert_array_equal(found["angle"], found["torque"])


@pytest.mark.parametrize(
    "values",
    [
        pa.array([1, None, -3], pa.int64()),
        pa.array([1, None, -3], pa.int8()),
        pa.array([1.0, None, -3.0], pa.float32()),
        pa.array([1.0, None, -3.0], pa.float16()),
        pa.array([1.0, float("nan"), -3.0]),
        pa.array([Decimal("1.00"), None, Decimal("-3.00")], pa.decimal128(10, 2)),
        pa.array([1.0, None, -3.0]).dictionary_encode(),
    ],
    ids=lambda values: str(values.type),
)
def test_numbers_of_parquet(tmp_path: Path, values: pa.Array) -> None:
    path = write_parquet(tmp_path / "log.parquet", {"a.b": values})
    found = read(ParquetRecording(path), "torque=a.b")
    np.testing.assert_array_equal(found["torque"], [1.0, np.nan, -3.0])


def test_booleans_and_nothing_at_all(tmp_path: Path) -> None:
    columns = {"a": pa.array([True, False, None]), "b": pa.nulls(3)}
    found = read(
        ParquetRecording(write_parquet(tmp_path / "x.parquet", columns)), "angle=a,torque=b"
    )
    np.testing.assert_array_equal(found["angle"], [1.0, 0.0, np.nan])
    assert np.isnan(found["torque"]).all()


@pytest.mark.parametrize(
    ("kind", "unit"),
    [
        (pa.timestamp("ns"), "ns"),
        (pa.timestamp("us", "UTC"), "us"),
        (pa.duration("ms"), "ms"),
        (pa.time32("ms"), "ms"),
        (pa.int64(), None),
        (pa.uint32(), None),
        (pa.uint64(), None),
    ],
    ids=str,
)
def test_time_stamps_of_parquet(tmp_path: Path, kind: pa.DataType, unit: str | None) -> None:
    ticks = pa.array([1000, None, 3000], pa.int32() if kind == pa.time32("ms") else pa.int64())
    path = write_parquet(tmp_path / "x.parquet", {"t": ticks.cast(kind), "tau": pa.nulls(3)})
    recording = ParquetRecording(path)
    found = find_columns(parse_mapping(["time=t,torque=tau"]), recording.names, 2, "x")
    ((chunk, _),) = list(recording.chunks(found))
    assert chunk.time is not None
    assert chunk.time.unit == unit
    assert chunk.time.missing.tolist() == [False, True, False]
    assert chunk.time.values[[0, 2]].tolist() == [1000, 3000]


def test_dates_are_no_torque(tmp_path: Path) -> None:
    columns = {"t": pa.array([0, 1], pa.timestamp("s")), "tau": pa.array([0, 1], pa.timestamp("s"))}
    path = write_parquet(tmp_path / "x.parquet", columns)
    with pytest.raises(InputError, match="holds timestamp"):
        read(ParquetRecording(path), "time=t,torque=tau")


def test_a_name_that_is_there_twice_is_mapped_by_number(tmp_path: Path) -> None:
    first, second = pa.array([1.0, 2.0]), pa.array([3.0, 4.0])
    table = pa.Table.from_arrays([second, first, second, first], names=["b", "a", "a", "z"])
    path = tmp_path / "x.parquet"
    pq.write_table(table, path)
    found = read(ParquetRecording(path), "angle=3,torque=2,expected-torque=z")
    assert found["angle"].tolist() == [3.0, 4.0]
    assert found["torque"].tolist() == [1.0, 2.0]
    assert found["expected-torque"].tolist() == [1.0, 2.0]
    path = file_of(tmp_path, "a,a,b\n1,3,9\n2,4,9\n")
    assert read(CsvRecording(path), "angle=2,torque=1")["angle"].tolist() == [3.0, 4.0]


@given(
    st.one_of(
        st.text(alphabet='0123456789.,;-+e\n\r"t x', max_size=60),
        st.lists(
            st.lists(
                st.sampled_from(["0", "1", "-2.5", "", "nan", "1e400", "x", '"3"']), max_size=4
            ),
            max_size=8,
        ).map(lambda lines: "\n".join(",".join(line) for line in lines)),
    ),
    st.sampled_from([b"", b"\xef\xbb\xbf", b"\xff", b"\0"]),
)
def test_whatever_a_file_holds_it_is_read_or_refused_with_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, text: str, start: bytes
) -> None:
    folder = tmp_path_factory.mktemp("any")
    (folder / "log.csv").write_bytes(start + text.encode())
    options = Options(parse_mapping(["time=1,angle=2,torque=3"]), "motor")
    try:
        done = filter_log(
            folder / "log.csv",
            folder / "o.csv",
            options,
            method="any",
            build=lambda *_: Halving(),
        )
    except InputError as error:
        assert str(error).startswith(str(folder / "log.csv"))  # noqa: PT017 - either is right
        assert not (folder / "o.csv").exists()
    else:
        assert len(read_result(folder / "o.csv")["status"]) == done.survey.rows
        json.dumps(done.as_dict(), allow_nan=False)
