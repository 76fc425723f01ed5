"""The reference of the joint file says what the models do."""

import math
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from strainwave.joint import (
    SCHEMA_VERSION,
    SECTION_MODELS,
    SECTION_NAMES,
    Joint,
    Provenance,
    canonical_hash,
    parse_joint,
)
from strainwave.joint.fields import kind_of, models_of, unit_of
from strainwave.joint.reference import field_tables

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/reference/joint-file.md").read_text(encoding="utf-8")

SUFFIX_UNITS = {
    "_Nm_per_sqrt_s": "Nm/sqrt(s)",
    "_rad_s": "rad/s",
    "_Nm_per_V": "Nm/V",
    "_Nm_per_N": "Nm/N",
    "_V_per_K": "V/K",
    "_per_K": "1/K",
    "_kg_m2": "kg m^2",
    "_Nm2": "Nm^2",
    "_Nm": "Nm",
    "_V": "V",
    "_rad": "rad",
    "_m": "m",
    "_s": "s",
    "_Hz": "Hz",
    "_degC": "degC",
    "_percent_of_rated_torque": "%FS",
}
UNITS_WITHOUT_SUFFIX = {
    "converter_bits": "bit",
    "orders": "cycles per motor turn",
    "load_orders": "cycles per motor turn",
    "speed_orders": "cycles per motor turn",
    "direction_orders": "cycles per motor turn",
    "kept_orders": "cycles per motor turn",
    "identified_factor_m": "1",
}


def models(model: type[BaseModel] = Joint) -> Iterator[type[BaseModel]]:
    yield model
    for field in model.model_fields.values():
        for inner in models_of(field):
            yield from models(inner)


FIELDS: list[tuple[str, str, FieldInfo]] = sorted(
    {
        (model.__name__, name): (model.__name__, name, field)
        for model in models()
        for name, field in model.model_fields.items()
    }.values(),
    key=lambda entry: entry[:2],
)


def example() -> str:
    match = re.search(r"## Example\n\n```toml\n(.*?)```", PAGE, re.DOTALL)
    assert match is not None
    return match[1]


def test_the_example_can_be_read_and_fills_every_section() -> None:
    joint = parse_joint(example(), "example").joint
    assert all(getattr(joint, name) is not None for name in SECTION_NAMES)
    assert f"`{canonical_hash(joint)}`" in PAGE
    assert example() == (ROOT / "tests/data/joints/elbow.toml").read_text(encoding="utf-8")


def test_the_tables_are_those_of_the_models() -> None:
    match = re.search(r"<!-- keys: begin -->\n(.*?)<!-- keys: end -->", PAGE, re.DOTALL)
    assert match is not None
    assert match[1] == field_tables(), "put what field_tables() returns between the marks"


def test_the_tables_have_every_key_with_its_description() -> None:
    tables = field_tables()
    for name in SECTION_MODELS:
        assert f"### `[{name}]`" in tables
    for model, name, field in FIELDS:
        if model != "Joint" and name != "provenance":
            assert re.search(rf"^\| `{name}` \|.*\|$", tables, re.MULTILINE), (model, name)
        assert field.description
        in_a_table = not model.endswith("Column") and model != "Joint" and name != "provenance"
        assert not in_a_table or field.description in tables
    assert len(FIELDS) > 90


def test_a_section_of_two_methods_has_a_table_for_each() -> None:
    tables = field_tables()
    assert '### `[ripple_filter]` with `method = "oscillator"`\n' in tables
    assert '### `[ripple_filter]` with `method = "ripple"`\n' in tables


def test_the_ripple_filters_example_is_that_of_a_joint_file() -> None:
    match = re.search(r"```toml\n(\[ripple_filter\]\nmethod = \"ripple\"\n.*?)```", PAGE, re.DOTALL)
    assert match is not None
    assert match[1] in (ROOT / "tests/data/joints/shoulder.toml").read_text(encoding="utf-8")


def test_the_page_names_the_present_version() -> None:
    assert f"The present version is {SCHEMA_VERSION}." in PAGE


@pytest.mark.parametrize(
    ("model", "name", "field"), FIELDS, ids=[f"{entry[0]}.{entry[1]}" for entry in FIELDS]
)
def test_a_number_has_a_unit_and_its_name_carries_it(
    model: str, name: str, field: FieldInfo
) -> None:
    unit = unit_of(field)
    if "number" not in kind_of(field) and kind_of(field) != "1 or -1":
        assert unit is None
        return
    if model.endswith("Column") and name == "column":
        return
    expected = next((u for suffix, u in SUFFIX_UNITS.items() if name.endswith(suffix)), "1")
    assert unit == UNITS_WITHOUT_SUFFIX.get(name, expected)


def test_provenance_is_described() -> None:
    for name in Provenance.model_fields:
        assert f"| `{name}` |" in field_tables()


def test_the_python_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    match = re.search(r"## In Python\n\n```python\n(.*?)```", PAGE, re.DOTALL)
    assert match is not None
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(match[1], names)
    joint = names["joint"]
    assert isinstance(joint, Joint)
    assert joint.gear is not None
    assert math.isclose(joint.gear.ratio, 51.0)
    assert (tmp_path / "elbow.toml").exists()
