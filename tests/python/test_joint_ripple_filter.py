"""The section [ripple_filter] of method ripple: read, checked, changed, told from the other one."""

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from helpers.elbow import PROVENANCE
from helpers.elbow import TEXT as ELBOW
from helpers.joint_sections import OSCILLATOR
from strainwave.errors import InputError
from strainwave.joint import (
    Gear,
    Identity,
    Joint,
    OscillatorFilter,
    RippleFilter,
    build_section,
    canonical_form,
    canonical_hash,
    order_value,
    parse_joint,
    read_joint,
    write_joint,
)

PATH = Path(__file__).parents[1] / "data/joints/shoulder.toml"
TEXT = PATH.read_text(encoding="utf-8")
HASH = "dca97ce5180d7a0807e9eeec2678def952db42a957f2ae41ef5ee06bb0a7aeef"

SMALLEST: dict[str, Any] = {
    "method": "ripple",
    "orders": (2.0, "4m", "1/R"),
    "memory_turns": 30.0,
    "torque_noise_Nm": 0.04,
    "torque_walk_Nm_per_sqrt_s": 1.3,
}


def section(**more: Any) -> RippleFilter:
    return RippleFilter.model_validate({**SMALLEST, **more})


def test_the_example_is_read_as_written() -> None:
    ripple_filter = read_joint(PATH).joint.ripple_filter
    assert isinstance(ripple_filter, RippleFilter)
    assert ripple_filter.orders == (1.0, "2m", "4m", "6m")
    assert ripple_filter.kept_orders == (1.0,)
    assert ripple_filter.speed_orders == ()
    assert ripple_filter.minimum_speed_rad_s is None
    assert ripple_filter.learned_coefficients_Nm is not None
    assert len(ripple_filter.learned_coefficients_Nm) == ripple_filter.coefficient_count == 12


def test_hash_stays_what_it_was() -> None:
    joint = read_joint(PATH).joint
    assert canonical_hash(joint) == HASH
    # Empty lists are written out and what is left out stays out, as the reference says.
    assert '"speed_orders":[]' in canonical_form(joint)
    assert "reference_speed_rad_s" not in canonical_form(joint)


@pytest.mark.parametrize(
    ("old", "new", "is_same"),
    [
        ("memory_turns = 30", "memory_turns = 30.0", True),
        ("kept_orders = [1] ", "speed_orders = []\nkept_orders = [1.0] ", True),
        ("memory_turns = 30", "memory_turns = 31", False),
        ('"6m"]', '"966/160"]', False),
        ("0.21, -0.04", "0.21, -0.05", False),
        ("learned_innovation_scale_Nm = 0.071\n", "", False),
    ],
)
def test_hash_depends_on_values_alone(old: str, new: str, is_same: bool) -> None:
    assert old in TEXT
    assert (canonical_hash(parse_joint(TEXT.replace(old, new, 1)).joint) == HASH) is is_same


def test_reading_and_writing_changes_no_byte(tmp_path: Path) -> None:
    path = tmp_path / "shoulder.toml"
    path.write_bytes(TEXT.encode())
    write_joint(read_joint(path), path)
    assert path.read_bytes() == TEXT.encode()


def test_comments_in_the_lists_stay_when_a_coefficient_changes() -> None:
    joint_file = parse_joint(TEXT)
    ripple_filter = joint_file.joint.ripple_filter
    assert isinstance(ripple_filter, RippleFilter)
    assert ripple_filter.learned_coefficients_Nm is not None
    values = (0.25, *ripple_filter.learned_coefficients_Nm[1:])
    changed = ripple_filter.model_copy(update={"learned_coefficients_Nm": values})
    joint_file.set_section("ripple_filter", changed, PROVENANCE)
    assert re.search(r"^    0\.25, -0\.04, +# order 1$", joint_file.text(), re.MULTILINE)
    assert "# order 4m: constant, then direction" in joint_file.text()
    assert joint_file.joint.ripple_filter == changed.model_copy(update={"provenance": PROVENANCE})


def test_a_section_can_change_its_method() -> None:
    joint_file = parse_joint(ELBOW)
    oscillators = joint_file.joint.ripple_filter
    assert isinstance(oscillators, OscillatorFilter)
    joint_file.set_section("ripple_filter", section(), PROVENANCE)
    assert isinstance(parse_joint(joint_file.text()).joint.ripple_filter, RippleFilter)
    assert "process_noise_variances_Nm2" not in joint_file.text()
    joint_file.set_section("ripple_filter", oscillators, PROVENANCE)
    again = parse_joint(joint_file.text()).joint.ripple_filter
    assert again == oscillators.model_copy(update={"provenance": PROVENANCE})
    gear = joint_file.joint.gear
    assert gear is not None
    with pytest.raises(TypeError, match="expected OscillatorFilter or RippleFilter, got Gear"):
        joint_file.set_section("ripple_filter", gear, PROVENANCE)


def test_a_section_is_built_by_its_method() -> None:
    assert build_section("ripple_filter", SMALLEST, "console") == section()
    oscillators = build_section("ripple_filter", {**OSCILLATOR, "orders": ["2m"]}, "console")
    assert isinstance(oscillators, OscillatorFilter)


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("memory_turns = 30\n", "", ['[ripple_filter] lacks the key "memory_turns" (memory in']),
        ("memory_turns = 30", "memory_turns = 0", ["[ripple_filter] memory_turns = 0", "0.1 and"]),
        ("memory_turns = 30", "memory = 30", ['unknown key "memory"', '"memory_turns"?']),
        (
            "memory_turns = 30",
            "sample_period_s = 1e-3",
            ['[ripple_filter] has the unknown key "sa'],
        ),
        ("0.06\n", "-0.06\n", ["torque_noise_Nm = -0.06", "at least 1e-09", "in Nm"]),
        ('"6m"]', '"6 m"]', ['[ripple_filter] orders, entry 4 = "6 m"', '"2m"', "correct this"]),
        ('"6m"]', '"4m"]', ["[ripple_filter] has the order 4m twice in orders", "ratio 160 and"]),
        ('"6m"]', "2.0125]", ["[ripple_filter] has the order 2.0125 twice", "factor m 1.00625"]),
        (
            "orders = [1]",
            'orders = ["8m"]',
            ['"8m" in kept_orders, but not', '1, "2m", "4m", "6m"'],
        ),
        ("orders = [1]", "orders = [1, 1]", ["[ripple_filter] has the order 1 twice in kept_"]),
        ("orders = [1]", "orders = 1", ["kept_orders = 1: expected a list in square brackets"]),
        (
            'load_orders = ["2m"]',
            "",
            ["has 12 learned_coefficients_Nm; expected 10", "remove them"],
        ),
        (
            "    -0.08, 0.13, ",
            "    -0.08, ",
            ["[ripple_filter] has 11 learned_coeff", "expected 12"],
        ),
        ("0.011, 0.012", "0.011, -0.012", ["deviations_Nm, entry 2 = -0.012", "at least 0 and"]),
        ("0.011, 0.012", "0.011, nan", ["[ripple_filter] learned_stand", "a finite number"]),
        (
            "learned_coefficients_Nm = [",
            "initial_speeds = [",
            ['[ripple_filter] has the unknown key "initial_speeds"'],
        ),
        ("le_Nm = 0.071", "le_Nm = -1", ["[ripple_filter] learned_innovation_scale_Nm = -1"]),
    ],
)
def test_wrong_value(old: str, new: str, parts: list[str]) -> None:
    assert TEXT.count(old) >= 1
    with pytest.raises(InputError) as caught:
        parse_joint(TEXT.replace(old, new, 1), "arm.toml")
    message = str(caught.value)
    assert message.startswith("arm.toml: ")
    assert "\n" not in message
    for part in parts:
        assert part in message


@pytest.mark.parametrize(
    "part",
    [
        {"learned_coefficients_Nm": (0.0,) * 6},
        {"learned_standard_deviations_Nm": (0.1,) * 6},
        {"learned_innovation_scale_Nm": 0.1},
    ],
)
def test_what_was_learned_is_there_whole(part: dict[str, Any]) -> None:
    with pytest.raises(ValidationError, match="only a part of what was learned; expected learned_"):
        section(**part)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"orders": ("1/R",)}, r'the order "1/R", where R is the ratio of the gear, but there is'),
        ({"orders": ("2m",)}, r'the order "2m", where m is the factor m of the gear, but there is'),
        ({"orders": (2.0,), "load_orders": (2.0,)}, r"has load_orders, whose load is relative to"),
    ],
)
def test_what_needs_the_gear(values: dict[str, Any], words: str) -> None:
    with_provenance = section(**values).model_copy(update={"provenance": PROVENANCE})
    with pytest.raises(ValidationError, match=words):
        Joint(joint=Identity(name="shoulder"), ripple_filter=with_provenance)


def test_without_what_needs_it_there_is_no_gear_needed() -> None:
    plain = section(orders=(2.0, "7/2"), speed_orders=("7/2",), provenance=PROVENANCE)
    assert Joint(joint=Identity(name="shoulder"), ripple_filter=plain).gear is None


@pytest.mark.parametrize(
    ("order", "expected"),
    [
        ("2m+1/R", Fraction(203, 100)),
        ("2m-1/R", Fraction(201, 100)),
        ("4m-3/R", Fraction(401, 100)),
        ("2+1/R", Fraction(201, 100)),
        ("2-1/R", Fraction(199, 100)),
    ],
)
def test_orders_beside_another_one_are_exact(order: str, expected: Fraction) -> None:
    gear = Gear(
        configuration="fixed_circular_spline",
        ratio=100.0,
        rated_torque_Nm=40.0,
        provenance=PROVENANCE,
    )
    assert order_value(order, gear) == expected


@pytest.mark.parametrize("order", ["2m+", "m+1/R", "2m*1/R", "2m+0/R", "2m+1/100", "+1/R"])
def test_sums_that_are_no_orders_are_refused(order: str) -> None:
    with pytest.raises(ValueError, match='"2m\\+1/R"'):
        order_value(order, None)
