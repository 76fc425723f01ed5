"""Tables of measurements: numbers in base units, texts, lists of columns, and bad tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from strainwave.errors import InputError
from strainwave.records.mapping import MapKeys, parse_columns
from strainwave.records.table import read_table

if TYPE_CHECKING:
    from pathlib import Path

KEYS = MapKeys(
    {
        "time": "time",
        "load": "torque",
        "gauges": "voltage",
        "experiment": None,
        "temperature": "temperature",
        "share": "number",
    },
    lists=frozenset({"gauges"}),
    example="--map load=load_Nm",
)
CSV = """run,load,g1,g2,T,t
a b,1.5,0.1,-0.2,68,1000000000001
3,-2,0.3,0.4,32,1000000000003
,4,0.5,,,1000000000007
"""


def _csv(folder: Path, text: str = CSV) -> Path:
    path = folder / "loads.csv"
    path.write_text(text, encoding="utf-8")
    return path


MAP = ["experiment=run,load=load:mNm,gauges=g1+-g2:mV", "temperature=T:degF,time=t:ms"]


def test_columns_come_in_base_units(tmp_path: Path) -> None:
    table = read_table(_csv(tmp_path), MAP, KEYS, required=("load",))
    assert table.rows == 3
    np.testing.assert_allclose(table.values["load"], [1.5e-3, -2e-3, 4e-3])
    np.testing.assert_allclose(
        table.values["gauges"], np.array([[0.1, 0.2], [0.3, -0.4], [0.5, np.nan]]) * 1e-3
    )
    np.testing.assert_allclose(table.values["temperature"], [20.0, 0.0, np.nan], atol=1e-12)
    np.testing.assert_array_equal(table.values["time"], [0.0, 0.002, 0.006])
    assert table.texts["experiment"] == ("a b", "3", "")
    assert "gauges" in table
    assert "share" not in table


def test_parquet_says_the_same(tmp_path: Path) -> None:
    path = tmp_path / "loads.parquet"
    columns = {"run": ["a b", "3", None], "load": [1.5, -2.0, 4.0], "g1": [1, 2, 3]}
    pq.write_table(pa.table(columns), path)
    table = read_table(path, ["experiment=run,load=load,gauges=g1"], KEYS)
    assert table.texts["experiment"] == ("a b", "3", "")
    assert table.values["gauges"].shape == (3, 1)
    numbers = read_table(path, ["experiment=g1"], KEYS)
    assert numbers.texts["experiment"] == ("1", "2", "3")
    assert numbers.rows == 3


def test_codes_become_volts_where_a_converter_is_known(tmp_path: Path) -> None:
    path = _csv(tmp_path)
    table = read_table(path, ["gauges=-load:counts"], KEYS, codes_to_volts=lambda code: code * 2.0)
    np.testing.assert_array_equal(table.values["gauges"][:, 0], [-3.0, 4.0, -8.0])
    with pytest.raises(InputError, match=r"gauges is in counts.*--joint"):
        read_table(path, ["gauges=load:counts"], KEYS)


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        ("load=g1,gauges=g1+g2", r"column 'g1' is mapped for load and for gauges"),
        ("load=load,gauges=g1+g1", r"column 'g1' is mapped twice for gauges"),
        ("gauges=g1", r"nothing is mapped for load; expected load=COLUMN"),
        ("load=load+g1", r"contains '\+'"),
        ("load=load,gauges=g1+", r"no column follows gauges="),
        ("load=load,experiment=run:s", r"unit 's' follows the column of experiment"),
        ("load=load,share=g1:V", r"unit 'V' of share is unknown; expected one of 1;"),
        ("load=run", r"row 1 \(line 2\), column 'run' holds 'a b'"),
        ("load=lod", r"no column 'lod' for load.*did you mean 'load'"),
    ],
)
def test_bad_mappings_are_told(tmp_path: Path, mapping: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_table(_csv(tmp_path), [mapping], KEYS, required=("load",))


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("experiment", r"row 3, column 'run' for experiment is empty.*expected a text"),
        ("gauges", r"row 3, column 'g2' for gauges is empty"),
        ("temperature", r"row 3, column 'T' for temperature"),
    ],
)
def test_an_empty_field_is_named(tmp_path: Path, key: str, words: str) -> None:
    table = read_table(_csv(tmp_path), MAP, KEYS)
    table.require_complete(["load", "share"])
    with pytest.raises(InputError, match=words):
        table.require_complete([key])


def test_a_list_keeps_its_order_and_signs() -> None:
    columns = parse_columns(['gauges=b+-"a+1"+c:mV,load=x'], KEYS)["gauges"]
    assert [(each.column, each.sign, each.unit) for each in columns] == [
        ("b", 1, "mV"),
        ("a+1", -1, "mV"),
        ("c", 1, "mV"),
    ]
