"""The canonical hash depends on every value, and on nothing but the values."""

import hashlib
import json
import random
import struct
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
import tomlkit
from hypothesis import given
from hypothesis import strategies as st

from strainwave.errors import InputError
from strainwave.joint import (
    SECTION_NAMES,
    Joint,
    canonical_form,
    canonical_hash,
    parse_joint,
    section_hash,
)
from strainwave.joint.canonical import canonical_number

TEXT = (Path(__file__).parents[1] / "data/joints/elbow.toml").read_text(encoding="utf-8")
JOINT = parse_joint(TEXT).joint
HASH = "422fad390438f8f480b7474489e6a7a634be3f470c264e30ddee605d637d1d9d"


def test_hash_stays_what_it_was() -> None:
    assert canonical_hash(JOINT) == HASH


def test_hash_can_be_recomputed_from_the_description() -> None:
    values: dict[str, Any] = tomlkit.parse(TEXT).unwrap()
    del values["schema_version"]
    values["gear"]["output_direction"] = 1
    values["signals"]["angle_side"] = "motor"
    columns = [*values["signals"]["gauges"], values["signals"]["time"]]
    columns.append(values["signals"]["motor_angle"])
    for column in columns:
        column["sign"] = 1
    values["gauges"]["amplifier_offset_V"] = 0.0
    values["gauges"]["converter_lowest_code"] = 0
    for rosette in values["gauges"]["rosettes"]:
        rosette.setdefault("orientation_error_rad", 0.0)
    values["gains"]["without_gauge"] = []
    values["ripple_filter"]["rotation_source"] = "speed"

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items()}
        if isinstance(value, list):
            return [plain(item) for item in value]
        if isinstance(value, datetime):
            return value.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ")
        if isinstance(value, float) and value.is_integer():
            return int(value)
        return value

    # For the numbers of this file Python's shortest form is ECMAScript's, whole ones aside.
    text = json.dumps(plain(values), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    assert canonical_form(JOINT) == text
    assert hashlib.sha256(text.encode()).hexdigest() == HASH
    gear = json.dumps(plain(values["gear"]), sort_keys=True, separators=(",", ":"))
    assert section_hash(JOINT, "gear") == hashlib.sha256(gear.encode()).hexdigest()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# Elbow joint", "# Elbow"),
        ("ratio = 51\n", "ratio = 5.1e1   # one turn more\n\n"),
        ("ratio = 51\n", "ratio = 51\noutput_direction = 1\n"),
        ("ratio = 51\nrated_torque_Nm = 100", "rated_torque_Nm = 100.0\nratio = 51"),
        ("amplifier_gain = 1000.0", "amplifier_gain = 1_000\namplifier_offset_V = 0"),
        ("2026-11-02T14:05:00+01:00", "2026-11-02T13:05:00.000Z"),
        ('"9f86d081', '"9F86D081'),
        ("sampling_rate_Hz = 1000", 'sampling_rate_Hz = 1000\nangle_side = "motor"'),
        ("zero_V = 0.012", "zero_V = 12e-3"),
        ("orders = [2, 4", "orders = [2.0, 4.0"),
        ('time = {column = "Timestamp", unit = "ms"}', 'time.unit = "ms"\ntime.column="Timestamp"'),
    ],
)
def test_hash_is_independent_of_how_it_is_said(old: str, new: str) -> None:
    assert old in TEXT
    assert canonical_hash(parse_joint(TEXT.replace(old, new, 1)).joint) == HASH


@given(st.randoms(use_true_random=False))
def test_hash_is_independent_of_the_order_of_keys(shuffle: random.Random) -> None:
    def shuffled(value: Any) -> Any:
        if isinstance(value, dict):
            items = [(key, shuffled(item)) for key, item in value.items()]
            shuffle.shuffle(items)
            return dict(items)
        return [shuffled(item) for item in value] if isinstance(value, list) else value

    values = tomlkit.parse(TEXT).unwrap()
    del values["schema_version"]
    assert canonical_hash(Joint.model_validate(shuffled(values))) == HASH


def leaves(value: Any, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    if isinstance(value, dict):
        return [leaf for key, item in value.items() for leaf in leaves(item, (*path, key))]
    if isinstance(value, list | tuple):
        return [leaf for key, item in enumerate(value) for leaf in leaves(item, (*path, key))]
    return [path]


def changed(value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return value + 1
    if isinstance(value, datetime):
        return value.replace(microsecond=value.microsecond + 1)
    return value + "0"


# A method that is none, when it is method's turn to be changed.
@pytest.mark.filterwarnings("ignore:Pydantic serializer warnings")
def test_hash_changes_with_every_value() -> None:
    # Without validation, so that each value can be changed on its own.
    paths = leaves(JOINT.model_dump(exclude_none=True))
    assert len(paths) > 100
    hashes = {HASH}
    for path in paths:
        copy = JOINT.model_copy(deep=True)
        target: Any = copy
        *way, last = path
        chain = []
        for step in way:
            chain.append((target, step))
            target = target[step] if isinstance(step, int) else getattr(target, step)
        value: Any
        if isinstance(last, int):
            value = (*target[:last], changed(target[last]), *target[last + 1 :])
            owner, name = chain[-1]
            object.__setattr__(owner, "__dict__", {**owner.__dict__, name: value})
        else:
            value = changed(getattr(target, last))
            object.__setattr__(target, "__dict__", {**target.__dict__, last: value})
        hashes.add(canonical_hash(copy))
    assert len(hashes) == 1 + len(paths)


def test_hash_without_provenance() -> None:
    other = parse_joint(TEXT.replace("2026-11-01T08:30:00Z", "2026-12-01T08:30:00Z")).joint
    assert canonical_hash(other) != HASH
    assert section_hash(other, "gear") != section_hash(JOINT, "gear")
    assert canonical_hash(other, include_provenance=False) == canonical_hash(
        JOINT, include_provenance=False
    )
    assert section_hash(other, "gear", include_provenance=False) == section_hash(
        JOINT, "gear", include_provenance=False
    )
    slower = parse_joint(TEXT.replace("rated_torque_Nm = 100", "rated_torque_Nm = 99")).joint
    assert canonical_hash(slower, include_provenance=False) != canonical_hash(
        JOINT, include_provenance=False
    )


def test_section_hashes_differ_and_need_the_section() -> None:
    assert len({section_hash(JOINT, name) for name in SECTION_NAMES}) == len(SECTION_NAMES)
    named_only = parse_joint('schema_version = 1\n[joint]\nname = "wrist"').joint
    with pytest.raises(InputError, match=r'"wrist": there is no section \[gear\].*\(none\)'):
        section_hash(named_only, "gear")
    with pytest.raises(InputError, match=r"no section \[identity\].*\(gear, signals"):
        section_hash(JOINT, "identity")


@pytest.mark.parametrize(
    ("bits", "text"),
    [
        # RFC 8785, appendix B.
        ("0000000000000000", "0"),
        ("8000000000000000", "0"),
        ("0000000000000001", "5e-324"),
        ("8000000000000001", "-5e-324"),
        ("7fefffffffffffff", "1.7976931348623157e+308"),
        ("ffefffffffffffff", "-1.7976931348623157e+308"),
        ("4340000000000000", "9007199254740992"),
        ("c340000000000000", "-9007199254740992"),
        ("4430000000000000", "295147905179352830000"),
        ("44b52d02c7e14af5", "9.999999999999997e+22"),
        ("44b52d02c7e14af6", "1e+23"),
        ("44b52d02c7e14af7", "1.0000000000000001e+23"),
        ("444b1ae4d6e2ef4e", "999999999999999700000"),
        ("444b1ae4d6e2ef4f", "999999999999999900000"),
        ("444b1ae4d6e2ef50", "1e+21"),
        ("3eb0c6f7a0b5ed8c", "9.999999999999997e-7"),
        ("3eb0c6f7a0b5ed8d", "0.000001"),
        ("41b3de4355555553", "333333333.3333332"),
        ("41b3de4355555554", "333333333.33333325"),
        ("41b3de4355555555", "333333333.3333333"),
        ("41b3de4355555556", "333333333.3333334"),
        ("41b3de4355555557", "333333333.33333343"),
        ("becbf647612f3696", "-0.0000033333333333333333"),
        ("43143ff3c1cb0959", "1424953923781206.2"),
    ],
)
def test_numbers_are_written_as_the_standard_says(bits: str, text: str) -> None:
    (value,) = struct.unpack(">d", bytes.fromhex(bits))
    assert canonical_number(value) == text


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_canonical_number_is_the_same_number(value: float) -> None:
    assert float(canonical_number(value)) == value


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_a_number_that_is_none_has_no_hash(value: float) -> None:
    with pytest.raises(ValueError, match="no canonical form"):
        canonical_number(value)
