"""What follows `--map`, and how a column is found by it."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strainwave.errors import InputError
from strainwave.records.columns import FoundColumn, find_columns
from strainwave.records.mapping import (
    QUANTITIES,
    MappedColumn,
    format_mapping,
    gauge_key,
    parse_mapping,
)

UNITS = {
    "time": ["s", "ms", "us", "ns"],
    "angle": ["rad", "deg", "turn", "counts/16777216"],
    "speed": ["rad/s", "turn/min", "counts/4096/s"],
    "torque": ["Nm", "mNm"],
    "temperature": ["degC", "K", "degF"],
    "voltage": ["V", "mV", "counts"],
}


@st.composite
def mappings(draw: st.DrawFn) -> dict[str, MappedColumn]:
    keys = draw(st.lists(st.sampled_from(list(QUANTITIES)), unique=True, min_size=1))
    return {
        key: MappedColumn(
            draw(st.text(min_size=0, max_size=12)),
            draw(st.sampled_from(UNITS[QUANTITIES[key]])),
            draw(st.sampled_from([1, -1])),
            quoted=True,
        )
        for key in keys
    }


@given(mappings())
def test_whatever_a_column_is_called_it_can_be_mapped(mapping: dict[str, MappedColumn]) -> None:
    found = parse_mapping([format_mapping(mapping)])
    assert found == mapping
    assert all(column.quoted for column in found.values())


@given(st.lists(st.text(max_size=12), min_size=1, max_size=5), st.sampled_from(UNITS["voltage"]))
def test_gauges_are_mapped_together_in_their_order(names: list[str], unit: str) -> None:
    mapping = {
        gauge_key(number): MappedColumn(name, unit, -1 if number % 2 else 1, quoted=True)
        for number, name in enumerate(names, 1)
    }
    assert parse_mapping([format_mapping(mapping)]) == mapping


@given(st.text(alphabet='abt=:,"- +', max_size=20))
def test_any_text_is_read_or_refused_with_a_sentence(text: str) -> None:
    try:
        parse_mapping([text])
    except InputError as error:
        assert str(error).startswith("--map ")  # noqa: PT017 - either outcome is right


def test_pairs_units_and_repeated_options() -> None:
    found = parse_mapping(["time=t [s] : ms , angle=q:counts/65536", 'torque=-"a,""b":mNm'])
    assert found == {
        "time": MappedColumn("t [s]", "ms"),
        "angle": MappedColumn("q", "counts/65536"),
        "torque": MappedColumn('a,"b', "mNm", -1),
    }


@pytest.mark.parametrize(
    ("text", "names", "index", "sign"),
    [
        ("torque=b", ("a", "b"), 1, 1),
        ("torque=-b", ("a", "b"), 1, -1),
        ("torque=-b", ("b", "-b"), 1, 1),
        ('torque="-b"', ("b", "-b"), 1, 1),
        ('torque=-"-b"', ("b", "-b"), 1, -1),
        ("torque=2", ("a", "b"), 1, 1),
        ("torque=2", ("2", "b"), 0, 1),
        ("torque=-2", ("a", "b"), 1, -1),
        ("torque=2", None, 1, 1),
    ],
)
def test_a_name_to_the_letter_comes_before_minus_and_number(
    text: str, names: tuple[str, ...] | None, index: int, sign: int
) -> None:
    found = find_columns(parse_mapping([text]), names, 2, "log.csv")["torque"]
    assert (found.index, found.sign) == (index, sign)


@pytest.mark.parametrize("text", ['torque="2"', 'torque="-b"', "torque=3", "torque=0", "torque=-"])
def test_a_column_that_is_not_there(text: str) -> None:
    with pytest.raises(InputError, match="there is no column"):
        find_columns(parse_mapping([text]), ("a", "b"), 2, "log.csv")


def test_the_joint_files_numbers() -> None:
    mapping = {"time": MappedColumn(1, "s"), "torque": MappedColumn(2, "Nm", -1)}
    assert find_columns(mapping, None, 2, "x") == {
        "time": FoundColumn(0, "column 1", 1),
        "torque": FoundColumn(1, "column 2", -1),
    }
    with pytest.raises(InputError, match="expected a number from 1 to 1"):
        find_columns(mapping, None, 1, "x")
