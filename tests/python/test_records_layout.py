"""Options and joint file together: an option wins, and that is said."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from strainwave.errors import InputError
from strainwave.joint import Joint, parse_joint
from strainwave.records.layout import build_layout
from strainwave.records.mapping import MappedColumn, parse_mapping
from strainwave.records.options import Options, parse_ratio

MAP = "time=t,angle=q,torque=tau"
PROVENANCE = """
[{section}.provenance]
input = "entered by hand"
created = 2026-11-01T08:30:00Z
version = "0.1.0"
"""


def joint(signals: str = "", gear: str = "") -> Joint:
    text = 'schema_version = 1\n[joint]\nname = "x"\n'
    for section, body in (("signals", signals), ("gear", gear)):
        if body:
            text += f"[{section}]\n{body}\n{PROVENANCE.format(section=section)}"
    return parse_joint(text).joint


GEAR = 'configuration = "fixed_flexspline"\nratio = 80.4\nrated_torque_Nm = 40'
SIGNALS = """
time = {column = 1, unit = "ms"}
output_angle = {column = "q, out", unit = "deg", sign = -1}
output_speed = {column = "w", unit = "deg/s"}
torque = {column = "tau", unit = "mNm"}
"""


def options(text: str = "", **more: Any) -> Options:
    return Options(parse_mapping([text] if text else []), **more)


def test_the_joint_file_alone() -> None:
    layout = build_layout(options(), joint(SIGNALS, GEAR))
    assert layout.columns == {
        "time": MappedColumn(1, "ms"),
        "angle": MappedColumn("q, out", "deg", -1),
        "torque": MappedColumn("tau", "mNm"),
    }
    assert (layout.angle_side, layout.ratio) == ("output", Fraction(402, 5))
    assert (layout.rated_torque_Nm, layout.rated_torque_source) == (40.0, "joint file")
    assert layout.remarks == ()


def test_options_win_and_that_is_said() -> None:
    layout = build_layout(
        options(
            "torque=tau2,time=t",
            ratio=Fraction(81),
            rated_torque_Nm=50.0,
            rate_Hz=100.0,
        ),
        joint(SIGNALS, GEAR),
    )
    assert layout.columns["torque"] == MappedColumn("tau2", "Nm")
    assert (layout.ratio, layout.rated_torque_Nm, layout.rate_Hz) == (81, 50.0, None)
    assert layout.remarks == (
        "--ratio 81 is used instead of 80.4 in the joint file",
        "--map torque 'tau2' in Nm is used instead of 'tau' in mNm in the joint file",
        "--map time 't' in s is used instead of 1 in ms in the joint file",
        "--rate 100 is not used: the recording has a column of time",
        "--rated-torque 50 is used instead of 40 in the joint file",
    )


def test_the_same_in_both_is_not_worth_a_word() -> None:
    layout = build_layout(
        options("torque=tau:mNm", rated_torque_Nm=40.0, angle_side="output"), joint(SIGNALS, GEAR)
    )
    assert layout.remarks == ()


def test_a_speed_stands_in_for_the_angle() -> None:
    layout = build_layout(options("time=t,speed=w,torque=tau", angle_side="motor"))
    assert set(layout.columns) == {"time", "speed", "torque"}
    layout = build_layout(options("speed=w:rad/s"), joint(SIGNALS, GEAR))
    assert set(layout.columns) == {"time", "speed", "torque"}
    assert "the mapped speed is used instead of the angle in the joint file" in layout.remarks
    layout = build_layout(options(MAP + ",speed=w", angle_side="motor"))
    assert "speed" not in layout.columns
    assert layout.remarks == ("the mapped speed is not used: an angle is there",)


def test_the_other_side_of_the_joint_file_is_no_angle() -> None:
    signals = 'torque = {column = "tau", unit = "Nm"}\nsampling_rate_Hz = 500\n'
    signals += 'motor_angle = {column = "qm", unit = "rad"}'
    with pytest.raises(InputError, match="nothing is mapped for the angle"):
        build_layout(options(angle_side="output", ratio=Fraction(50)), joint(signals))
    layout = build_layout(options(), joint(signals))
    assert (layout.angle_side, layout.rate_Hz) == ("motor", 500.0)


def test_a_speed_in_the_joint_file_says_its_side() -> None:
    signals = 'torque = {column = "tau", unit = "Nm"}\nsampling_rate_Hz = 500\n'
    layout = build_layout(
        options(), joint(signals + 'output_speed = {column = "w", unit = "rad/s"}', GEAR)
    )
    assert layout.angle_side == "output"
    layout = build_layout(
        options(), joint(signals + 'motor_speed = {column = "w", unit = "rad/s"}')
    )
    assert layout.angle_side == "motor"


def test_the_inertia_needs_a_ratio_at_the_motor() -> None:
    signals = "load_inertia_kg_m2 = 1.5"
    side = {"angle_side": "motor"}
    layout = build_layout(options(MAP, **side), joint(signals))
    assert layout.load_inertia_kg_m2 is None
    assert "load_inertia_kg_m2 in the joint file is not used" in layout.remarks[0]
    assert build_layout(options(MAP, **side), joint(signals, GEAR)).load_inertia_kg_m2 == 1.5
    with_column = build_layout(options(MAP + ",expected-torque=e", **side), joint(signals, GEAR))
    assert with_column.load_inertia_kg_m2 is None


def test_the_ratio_of_the_teeth_is_exact() -> None:
    gear = (
        'configuration = "fixed_circular_spline"\nratio = 66.66666666666667\nrated_torque_Nm = 1\n'
        "flexspline_teeth = 200\ncircular_spline_teeth = 203"
    )
    layout = build_layout(options(MAP, angle_side="output"), joint(gear=gear))
    assert layout.ratio == Fraction(200, 3)
    assert layout.output_direction == -1


@pytest.mark.parametrize(
    ("text", "ratio"), [("160", 160), ("120.5", Fraction(241, 2)), ("200/3", Fraction(200, 3))]
)
def test_a_ratio_is_read_as_written(text: str, ratio: Fraction) -> None:
    assert parse_ratio(text) == ratio
