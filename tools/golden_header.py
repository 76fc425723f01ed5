"""Writes the golden vectors as a C++ header: `golden_header.py golden.json golden_vectors.hpp`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any


def number(value: float) -> str:
    """Return a constant of the same bits."""
    return str(value) if isinstance(value, int) else value.hex()


def braces(values: list[Any]) -> str:
    """Return a list of constants, lists within it included."""
    inner = (braces(each) if isinstance(each, list) else number(each) for each in values)
    return "{" + ", ".join(inner) + "}"


def array(kind: str, name: str, values: list[Any]) -> str:
    """Return the definition of an array."""
    return f"inline constexpr {kind} {name}[] = {braces(values)};"


def fields(path: str, values: dict[str, Any]) -> list[str]:
    """Return assignments to the fields of a configuration, which have the same names."""
    lines = []
    for key, value in values.items():
        if isinstance(value, list):
            lines += [f"  {path}.{key}[{i}] = {number(each)};" for i, each in enumerate(value)]
        else:
            lines.append(f"  {path}.{key} = {number(value)};")
    return lines


def chain(told: dict[str, Any]) -> list[str]:
    """Return a function that makes the chain's configuration but for its filter."""
    count = len(told["gains"])
    lines = [
        "template <class Config>",
        "constexpr Config sensor_config() {",
        "  Config config;",
        f"  config.gains = {{{count}, {braces(told['gains'])}}};",
        *fields("config.converter", told["converter"]),
        *fields("config.calibration", told["calibration"]),
        "  config.monitor.active = true;",
        *fields("config.monitor", told["monitor"]),
        *fields("config.monitor.consistency", told["consistency"]),
        f"  config.monitor.consistency.harmonic_count = {len(told['wave_V']) // 2};",
        *fields("config.monitor.consistency", {"zero_V": told["gauge_zero_V"]}),
        *fields("config.monitor.consistency", {"directions[0]": told["directions"]}),
    ]
    for j in range(count):
        for i in range(len(told["wave_V"]) // 2):
            cosine, sine = told["wave_V"][2 * i][j], told["wave_V"][2 * i + 1][j]
            lines.append(
                f"  config.monitor.consistency.wave_V[{j}][{i}] = "
                f"{{{number(cosine)}, {number(sine)}}};"
            )
        lines.append(
            f"  config.monitor.without[{j}] = {{true, {{{count}, "
            f"{braces(told['gains_without'][j])}}}, {number(told['zero_shift_V'][j])}, "
            f"{number(told['residual_without_V'][j])}}};"
        )
    return [*lines, "  return config;", "}"]


def header(golden: dict[str, Any]) -> str:
    """Return the header's text."""
    defined = golden["definition"]
    events = ", ".join(
        f"{{Happening::{kind}, {first}, {length}, {value}LL}}"
        for kind, first, length, value in defined["events"]
    )
    gauges = [[gauge["zero"], len(gauge["wave"]), gauge["wave"]] for gauge in defined["gauges"]]
    lines = [
        "// Written by tools/golden_header.py from tests/data/golden/golden.json.",
        "#pragma once",
        '#include "golden_types.hpp"',
        "namespace golden {",
        f"inline constexpr std::uint32_t sample_count = {defined['samples']};",
        f"inline constexpr std::uint32_t every = {defined['every']};",
        f"inline constexpr double full_scale_Nm = {number(defined['full_scale_Nm'])};",
        f"inline constexpr std::int64_t speed_step = {defined['speed_step_a_sample']};",
        f"inline constexpr std::int64_t encoder_start = {defined['encoder_start']}LL;",
        f"inline constexpr std::int64_t sequence_start = {defined['sequence_start']}LL;",
        f"inline constexpr std::int64_t codes_a_torque_step = {defined['codes_a_torque_step_2e16']};",
        f"inline constexpr std::uint32_t inputs_checksum = {golden['inputs_checksum']}U;",
        array("std::int64_t", "loads_Nm", defined["loads_Nm"]),
        array("std::uint32_t", "orders", defined["orders"]),
        array("Segment", "segments", defined["segments"]),
        array("Wave", "ripple", defined["ripple"]),
        array("GaugeMakeup", "gauges", gauges),
        f"inline constexpr Event events[] = {{{events}}};",
        *chain(defined["chain"]),
    ]
    for name, answers in golden["answers"].items():
        for precision, found in answers.items():
            torques = ", ".join(found["torque_Nm"])
            lines.append(f"inline constexpr double {name}_{precision}_Nm[] = {{{torques}}};")
            lines.append(array("std::uint32_t", f"{name}_{precision}_status", found["status"]))
        lines.append(
            f'inline constexpr Golden {name} = {{"{name}", {name}_double_Nm, '
            f"{name}_double_status, {answers['double']['checksum']}U, {name}_float_Nm, "
            f"{name}_float_status, {answers['float']['checksum']}U}};"
        )
    return "\n".join([*lines, "}  // namespace golden", ""])


if __name__ == "__main__":
    source, target = map(Path, sys.argv[1:])
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(header(json.loads(source.read_text(encoding="utf-8"))), encoding="utf-8")
