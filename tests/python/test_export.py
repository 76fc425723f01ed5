"""An exported header computes what the package computes, and a changed one is found."""

from __future__ import annotations

import random
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.elbow import FOLDER
from helpers.exported_joints import (
    FREESTANDING,
    ROOT,
    STRICT,
    WRIST,
    build_c,
    build_cpp,
    in_python,
    raised,
    random_joint,
    run_program,
    samples_of,
    wrist,
)
from strainwave import GaugeFault, StatusFlag
from strainwave.export import check_header, exported, rendered, write_source
from strainwave.export.source import state_bytes
from strainwave.export.values import Precision
from strainwave.joint import Joint, read_joint

ROWS = 12_000


def _written(joint: Joint, folder: Path, precision: Precision = "float") -> str:
    ready = exported(joint, precision=precision)
    write_source(rendered(ready), folder)
    return ready.identifier


def _compile(source: Path, *more: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["g++", "-std=c++20", "-fsyntax-only", *STRICT, *more, source],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("precision", ["double", "float"])
def test_the_header_computes_what_the_package_does(tmp_path: Path, precision: Precision) -> None:
    """Bit for bit, over reversals, rest, NaN, saturation, gaps, wrapped numbers and torn gauges."""
    joint = wrist()
    name = _written(joint, tmp_path, precision)
    samples = samples_of(joint, ROWS)
    expected = in_python(joint, samples, np.float64 if precision == "double" else np.float32)
    assert {
        *("gauge_saturated", "gauges_insufficient", "rotation_invalid", "sample_repeated"),
        *("samples_missing", "temperature_not_finite", "gauge_lost", "at_rest"),
    } <= raised(expected["status"])
    assert np.ptp(expected["ripple"]) > 0.5
    assert expected["left_out"][85 * ROWS // 100] == 1
    for program in (build_cpp(tmp_path, name), build_c(tmp_path)):
        found = run_program(program, samples)
        for column, values in expected.items():
            np.testing.assert_array_equal(found[column], values, err_msg=f"{program} {column}")


def test_the_published_filter_too(tmp_path: Path) -> None:
    joint = read_joint(FOLDER / "elbow.toml").joint
    name = _written(joint, tmp_path, "double")
    samples = samples_of(joint, 3000)
    expected = in_python(joint, samples, np.float64)
    assert np.ptp(expected["ripple"]) > 0.01
    for program in (build_cpp(tmp_path, name), build_c(tmp_path)):
        found = run_program(program, samples)
        for column, values in expected.items():
            np.testing.assert_array_equal(found[column], values, err_msg=f"{program} {column}")


def test_any_joint_compiles_with_its_checksum(tmp_path: Path) -> None:
    """The header's static_asserts hold the exporter's checksum and values against the compiler's."""
    seed = random.Random(5)
    lines, filters = [], set()
    for place in range(8):
        joint = random_joint(seed)
        precision: Precision = "float" if place % 2 else "double"
        ready = exported(joint, name=f"any_{place}", precision=precision)
        filters.add((ready.values.filter, ready.values.config.monitor is None))
        (tmp_path / f"any_{place}.hpp").write_text(rendered(ready).header, encoding="utf-8")
        lines.append(f'#include "any_{place}.hpp"')
    assert {name for name, _ in filters} == {"ripple", "oscillator"}
    assert {has_none for _, has_none in filters} == {True, False}
    source = tmp_path / "all.cpp"
    source.write_text("\n".join(lines) + "\n", encoding="utf-8")
    compiled = _compile(source, *FREESTANDING, "-Wconversion", "-Wdouble-promotion", "-I", tmp_path)
    assert compiled.returncode == 0, compiled.stderr


@pytest.mark.parametrize(
    ("written", "changed"),
    [
        (".gain_Nm_per_V = 6.6F", ".gain_Nm_per_V = 6.7F"),
        (".with_speed = true", ".with_speed = false"),
        (".bits = 16U", ".bits = 12U"),
        ("TornGaugeRail::upper", "TornGaugeRail::lower"),
        ("-0.26F", "0.26F"),
    ],
)
def test_a_value_changed_by_hand_does_not_compile(
    tmp_path: Path, written: str, changed: str
) -> None:
    joint = wrist()
    path = tmp_path / f"{_written(joint, tmp_path)}.hpp"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(written, changed, 1), encoding="utf-8")
    compiled = _compile(tmp_path / "strainwave_joint.cpp", "-I", tmp_path)
    assert compiled.returncode != 0
    assert "export the joint again" in compiled.stderr


def test_a_value_that_the_core_refuses_does_not_compile(tmp_path: Path) -> None:
    joint = wrist()
    path = tmp_path / f"{_written(joint, tmp_path)}.hpp"
    text = path.read_text(encoding="utf-8")
    path.write_text(
        text.replace(".memory_turns = 30.0F", ".memory_turns = -1.0F"), encoding="utf-8"
    )
    compiled = _compile(tmp_path / "strainwave_joint.cpp", "-I", tmp_path)
    assert "this configuration is refused by the core" in compiled.stderr


def _place_in_file(program: Path, symbol: str) -> tuple[int, int]:
    """Offset and size of an object in an executable file, as binutils see it."""
    symbols = subprocess.run(
        ["nm", "-S", "-C", program], capture_output=True, text=True, check=True
    )
    match = re.search(rf"^(\w+) (\w+) \w {re.escape(symbol)}$", symbols.stdout, re.MULTILINE)
    assert match
    address, size = int(match[1], 16), int(match[2], 16)
    sections = subprocess.run(
        ["readelf", "-S", "-W", program], capture_output=True, text=True, check=True
    )
    found = re.search(r"\.rodata\s+PROGBITS\s+(\w+) (\w+)", sections.stdout)
    assert found
    return address - int(found[1], 16) + int(found[2], 16), size


def test_flipped_bits_in_the_image_are_found_at_start_up(tmp_path: Path) -> None:
    """Bytes of gear, configuration, coefficients and checksum, one after the other, C++ and C."""
    joint = wrist()
    name = _written(joint, tmp_path)
    few = samples_of(joint, 100).as_bytes()
    random_numbers = np.random.default_rng(8)
    for program in (build_cpp(tmp_path, name), build_c(tmp_path)):
        image = program.read_bytes()
        assert (
            subprocess.run([program], input=few, capture_output=True, check=False).returncode == 0
        )
        wrong = 0
        for part in ("gear", "config", "learned", "checksum"):
            start, size = _place_in_file(program, f"strainwave::joints::{name}::{part}")
            # The last bytes are values in all four, and so are most of the others.
            places = {size - 1, *random_numbers.integers(0, size, 12).tolist()}
            for place in places:
                flipped = bytearray(image)
                flipped[start + place] ^= 1 << int(random_numbers.integers(8))
                bad = tmp_path / "bad_program"
                bad.write_bytes(flipped)
                bad.chmod(0o755)
                run = subprocess.run([bad], input=few, capture_output=True, check=False)
                assert run.returncode in (0, 3)
                wrong += run.returncode == 3
                if place == size - 1:
                    assert run.returncode == 3, part
                if run.returncode == 3:
                    assert run.stdout == b""
        # A few of the places are padding.
        assert wrong >= 30


def test_the_reference_s_example_compiles(tmp_path: Path) -> None:
    page = (ROOT / "docs/reference/export-command.md").read_text(encoding="utf-8")
    shown = re.search(r"```cpp\n(.*?)```", page, re.DOTALL)
    assert shown
    source = tmp_path / "example.cpp"
    source.write_text(shown[1], encoding="utf-8")
    compiled = _compile(source, *FREESTANDING, "-I", WRIST.parent)
    assert compiled.returncode == 0, compiled.stderr


def test_the_c_header_has_the_core_s_flags() -> None:
    text = (ROOT / "include/strainwave/strainwave.h").read_text(encoding="utf-8")
    flags = {
        name.lower(): 1 << int(bit)
        for name, bit in re.findall(r"STRAINWAVE_(\w+) = 1 << (\d+)", text)
    }
    assert flags == {flag.name: flag.value for flag in StatusFlag}
    faults = re.findall(r"STRAINWAVE_GAUGE_FAULT_(\w+) = (\d+)", text)
    assert {name.lower(): int(value) for name, value in faults} == {
        each.name: each.value for each in GaugeFault
    }


def test_room_for_the_state_is_enough_and_not_much_more(tmp_path: Path) -> None:
    cases = [
        (kind, gauges, capacity, real)
        for kind in ("ripple", "oscillator")
        for real in (4, 8)
        for gauges, capacity in ((1, 1), (2, 3), (4, 9), (5, 4), (6, 12), (32, 32))
    ]
    lines = [
        "#include <cstdio>",
        '#include "strainwave/torque_sensor.hpp"',
        "using namespace strainwave;",
        "template <class State> struct Storage { std::uint32_t mark; State state; };",
        "int main() {",
    ]
    for kind, gauges, capacity, real in cases:
        state = "RippleSensorState" if kind == "ripple" else "TorqueSensorState"
        number = "float" if real == 4 else "double"
        of_joint = f"Storage<{state}<{number}, {gauges}, {capacity}>>"
        lines.append(f'  std::printf("%zu\\n", sizeof({of_joint}));')
    source, program = tmp_path / "sizes.cpp", tmp_path / "sizes"
    source.write_text("\n".join([*lines, "}", ""]), encoding="utf-8")
    subprocess.run(["g++", "-std=c++20", *STRICT, source, "-o", program], check=True)
    sizes = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    for case, size in zip(cases, sizes, strict=True):
        assert 0 <= state_bytes(*case) - int(size) <= 64, case


def test_the_example_s_files_are_those_of_its_joint_file() -> None:
    agreement = check_header(wrist(), WRIST.with_suffix(".hpp"))
    assert len(agreement.files) == 3


def test_the_header_is_found_by_its_version_and_reads_on_a_line() -> None:
    ready = exported(wrist())
    older = rendered(replace(ready, version="0.0.9"))
    assert 'software_version[] = "0.0.9"' in older.header
    assert older.header.replace("0.0.9", ready.version) == rendered(ready).header
