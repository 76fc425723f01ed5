"""Every wrong joint file gets one clear sentence: file, section, key, value, what to do."""

import os
import re
from pathlib import Path

import pytest

from strainwave.errors import ConfigurationError, InputError, StrainwaveError
from strainwave.joint import build_section, new_joint, parse_joint, read_joint

TEXT = (Path(__file__).parents[1] / "data/joints/elbow.toml").read_text(encoding="utf-8")


def message_of(text: str) -> str:
    with pytest.raises(InputError) as caught:
        parse_joint(text, "arm.toml")
    message = str(caught.value)
    assert message.startswith("arm.toml")
    assert "\n" not in message
    assert "pydantic" not in message
    return message


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("ratio = 51", "ratio = -3", ["[gear] ratio = -3", "at least 1", "correct this value"]),
        ("ratio = 51", "ration = 51", ["[gear]", '"ration"', 'did you mean "ratio"?']),
        ("ratio = 51", 'ratio = "51"', ['[gear] ratio = "51"', "expected a number"]),
        ("ratio = 51", "ratio = true", ["[gear] ratio = true", "expected a number"]),
        ("ratio = 51", "ratio = nan", ["[gear] ratio = nan", "a finite number"]),
        ("ratio = 51", "ratio = inf", ["[gear] ratio = inf", "a finite number"]),
        ("ratio = 51", "ratio = 52", ["[gear] has ratio = 52", "100 and 102", "give 51"]),
        ("ratio = 51", "ratio = " + "9" * 400, ["[gear] ratio", "double precision"]),
        ("ratio = 51\n", "", ['[gear] lacks the key "ratio"', "motor turns per output", "add it"]),
        ("_teeth = 100", "_teeth = 100.0", ["flexspline_teeth = 100.0", "a whole number"]),
        ("= 100  ", "= 0  ", ["rated_torque_Nm = 0", "greater than 0, in Nm"]),
        (
            '"fixed_flexspline"',
            '"fixed"',
            ['configuration = "fixed"', '"fixed_circular_spline" or "fixed_flexspline"'],
        ),
        ("[gear]", "[gaer]", ["[gaer] is not a section", 'did you mean "gear"?', "rename"]),
        ("[gear]", "[[gear]]", ["[gear] = [", "a table of keys and values"]),
        (
            "[temperature]",
            "[viscosity]",
            ["[viscosity] is not a section", "known are joint, gear", "remove it"],
        ),
        ("schema_version = 1", "schema_version = 1\nnme = 2", ['"nme" outside the sections']),
        ('name = "elbow"', "name = 7", ["[joint] name = 7", "a text in quotation marks"]),
        ('name = "elbow"', 'name = ""', ['[joint] name = ""', "not empty"]),
        (
            'name = "elbow"',
            f'name = "{"x" * 501}"',
            ["[joint] name = ", "a text of at most 500 characters"],
        ),
        ('name = "elbow"', 'name = "a\\u0007b"', ["[joint] name", "printable characters"]),
        ('unit = "ms"', 'unit = "rad"', ["[signals.time] unit", "s, ms, us, ns", "convert the"]),
        ('unit = "ms"', "unit = 3", ["[signals.time] unit = 3", "a text in quotation marks"]),
        ('"Timestamp"', "0", ["[signals.time] column = 0", "counted from 1"]),
        ('"Timestamp"', "1.5", ["[signals.time] column = 1.5", "the name of the column"]),
        ("sign = -1", "sign = 2", ["[signals.motor_speed] sign = 2", "expected 1 or -1"]),
        ("sign = -1", "sign = true", ["[signals.motor_speed] sign = true", "not true or false"]),
        (
            'gauge_2", unit = "V"',
            'gauge_2", unit = "N"',
            ["[signals.gauges] entry 2, unit", "a unit of voltage"],
        ),
        (
            "radius_m = 0.0231",
            "radius_m = 23.1",
            ["[gauges.rosettes] entry 3, radius_m = 23.1", "at most 10", "in m"],
        ),
        (
            "radius_m = 0.0231",
            "radius_mm = 23.1",
            ["[gauges.rosettes] entry 3 has the unknown", 'did you mean "radius_m"?'],
        ),
        ("converter_bits = 16", "converter_bits = 64", ["converter_bits = 64", "at most 24"]),
        ("[1.0586, 0.9966, 0.9448]", "1.0", ["[gains] gains = 1.0", "a list in square brackets"]),
        ("[1.0586, 0.9966, 0.9448]", "[]", ["[gains] gains = []", "a list of at least 1"]),
        ("[1.0586, 0.9966", '[1.0586, "x"', ['[gains] gains, entry 2 = "x"', "a number"]),
        ("[1.0586, 0.9966, 0.9448]", "[1.0, 1.0]", ["2 gains but 3 torque_sensitivities"]),
        ("[0.0, -0.004]", str([0.1] * 5), ["linearisation", "a list of at most 4"]),
        ('[2, 4, "1/R"]', '[2, "R"]', ['orders, entry 2 = "R"', '"1/100"']),
        ('[2, 4, "1/R"]', '[2, "m"]', ['[ripple_filter] orders, entry 2 = "m"', '"2m"']),
        (
            "variances_Nm2 = [1000.0]",
            "variances_Nm2 = [-1.0]",
            ["[ripple_filter] process_noise_variances_Nm2, entry 1 = -1.0", "at least 0, in Nm^2"],
        ),
        (
            "sample_period_s = 0.001",
            "memory_turns = 30",
            ['[ripple_filter] has the unknown key "memory_turns"', "known are provenance, method"],
        ),
        (
            'method = "oscillator"',
            'method = "magic"',
            ['[ripple_filter] method = "magic": expected "oscillator" or "ripple" (the filter'],
        ),
        ('method = "oscillator"', "method = 3", ['[ripple_filter] method = 3: expected "osc']),
        (
            'method = "oscillator"\n',
            "",
            ['[ripple_filter] lacks the key "method" (the filter', 'as "oscillator" or "ripple"'],
        ),
        ("2026-11-01T08:30:00Z", "2026-11-01T08:30:00", ["[gear.provenance] created", "zone"]),
        ("2026-11-01T08:30:00Z", "2026-11-01", ["[gear.provenance] created", "date and time"]),
        ("2026-11-01T08:30:00Z", '"today"', ['created = "today"', "2026-11-01T12:00:00Z"]),
        ('"9f86d081', '"zz86d081', ["[gains.provenance] input_sha256", "64 hexadecimal digits"]),
        (
            'gear.provenance]\ninput = "entered by hand"',
            "gear.provenance]",
            ['[gear.provenance] lacks the key "input"', "source of the values", "add it"],
        ),
        ("[gear.provenance]", "[gear.origin]", ['[gear] has the unknown key "origin"']),
        ("schema_version = 1\n", "", ["the key schema_version is missing", "add the line"]),
        ("schema_version = 1", "schema_version = 3", ["a newer strainwave (schema 3", "up to 1"]),
        ("schema_version = 1", "schema_version = 0", ["schema_version = 0", "number from 1"]),
        ("schema_version = 1", "schema_version = 1.0", ["schema_version = 1.0", "whole number"]),
        ("schema_version = 1", "schema_version = true", ["schema_version = true", "whole"]),
        ("schema_version = 1", 'schema_version = "1"', ['schema_version = "1"', "whole number"]),
    ],
)
def test_wrong_value(old: str, new: str, parts: list[str]) -> None:
    assert TEXT.count(old) >= 1
    message = message_of(TEXT.replace(old, new, 1))
    for part in parts:
        assert part in message


def test_missing_provenance() -> None:
    start = TEXT.index("[gear.provenance]")
    message = message_of(TEXT[:start] + TEXT[TEXT.index("[signals]") :])
    assert "[gear] lacks the section [gear.provenance]" in message
    assert "add it with the keys input, created and version" in message


def test_missing_joint() -> None:
    message = message_of("schema_version = 1\n")
    assert "the section [joint] is missing" in message
    assert "add it" in message


def test_further_problems_are_counted() -> None:
    text = TEXT.replace("ratio = 51", "ratio = 0").replace("_teeth = 100", "_teeth = 0")
    assert "(1 more problem after this)" in message_of(text)
    text = text.replace("_teeth = 102", "_teeth = 0")
    assert "(2 more problems after this)" in message_of(text)


def line_of(text: str) -> int:
    return TEXT[: TEXT.index(text)].count("\n") + 1


@pytest.mark.parametrize(
    ("old", "new", "column", "parts"),
    [
        ("ratio = 51", "ratio 51", 7, ["not valid TOML", "in: ratio 51", "correct this line"]),
        ("ratio = 51", "ratio = ", 9, ["not valid TOML", "in: ratio =", "correct this line"]),
        ("ratio = 51", "configuration = 51", 19, ["given twice", "remove one of the two"]),
        ("[signals]\n", "[gear]\n", 6, ["given twice", "([gear])", "remove one of the two"]),
    ],
)
def test_invalid_toml_says_line_and_column(
    old: str, new: str, column: int, parts: list[str]
) -> None:
    message = message_of(TEXT.replace(old, new, 1))
    assert message.startswith(f"arm.toml, line {line_of(old)}, column {column}: ")
    for part in parts:
        assert part in message


def test_toml_that_ends_too_early() -> None:
    message = message_of('schema_version = 1\n[joint]\nname = """elbow\n')
    assert message.startswith("arm.toml, line 4, column 1: it is not valid TOML")


def test_nested_too_deeply() -> None:
    message = message_of("schema_version = 1\nx = " + "[" * 5000)
    assert "nested too deeply" in message


def message_of_file(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_joint(path)
    message = str(caught.value)
    assert message.startswith(str(path))
    return message.removeprefix(str(path))


def test_files_that_are_none(tmp_path: Path) -> None:
    assert "there is no such file" in message_of_file(tmp_path / "none.toml")
    assert "it is a directory" in message_of_file(tmp_path)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert "not a regular file" in message_of_file(pipe)
    below_a_file = tmp_path / "file"
    below_a_file.write_text(TEXT)
    assert "cannot be read (not a directory)" in message_of_file(below_a_file / "arm.toml")


@pytest.mark.parametrize("content", [b"", b"\n \n", b"\xef\xbb\xbf"])
def test_empty_file(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "arm.toml"
    path.write_bytes(content)
    assert "it is empty" in message_of_file(path)


def test_binary_file(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_bytes(b"schema_version = 1\n\x89PNG\r\n")
    message = message_of_file(path)
    assert message.startswith(", line 2: it is not UTF-8 text (byte 0x89 at position 19)")
    path.write_bytes(b"PAR1\x00\x01\x02")
    assert message_of_file(path).startswith(", line 1, column 5: it is not valid TOML")


def test_recording_in_place_of_a_joint_file(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    with path.open("wb") as stream:
        stream.truncate(4_000_001)
    assert "4000001 bytes" in message_of_file(path)
    assert "a recording was given in its place" in message_of_file(path)


def test_unreadable_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(TEXT)

    def refuse(_: Path) -> bytes:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", refuse)
    message = message_of_file(path)
    assert "cannot be read (permission denied)" in message
    assert "check its permissions" in message


def test_values_from_a_person() -> None:
    with pytest.raises(InputError, match=re.escape("command line: [gear] ratio = -1: expected")):
        build_section(
            "gear",
            {"configuration": "fixed_flexspline", "ratio": -1, "rated_torque_Nm": 1},
            "command line",
        )
    with pytest.raises(
        InputError, match=r'^console: \[ripple_filter\] method = "a": expected "osc'
    ):
        build_section("ripple_filter", {"method": "a"}, "console")
    with pytest.raises(InputError, match=r'^console: \[ripple_filter\] lacks the key "method"'):
        build_section("ripple_filter", {}, "console")
    with pytest.raises(InputError, match=r"^console: \[ripple_filter\] orders = \[\]: expected a"):
        build_section("ripple_filter", {"method": "ripple", "orders": []}, "console")
    with pytest.raises(InputError, match=r'\[gears\] is not a section .*did you mean "gear"'):
        build_section("gears", {}, "command line")
    with pytest.raises(InputError, match=r'\[joint\] name = "": expected a text that is not empty'):
        new_joint("")


def test_configuration_error_names_value_unit_and_range() -> None:
    error = ConfigurationError("memory_turns", -2.0, "turns", "a number greater than 0")
    expected = "memory_turns = -2.0 turns: expected a number greater than 0; correct this value"
    assert str(error) == expected
    assert isinstance(error, InputError)
    assert isinstance(error, StrainwaveError)
    assert isinstance(error, ValueError)
    assert str(ConfigurationError("order", 0, "1", "a number from 1")).startswith("order = 0: ")
