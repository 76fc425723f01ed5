"""What the linker made of an image: its functions, their instructions, who calls whom."""

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path


def tool(name: str, *arguments: str) -> str:
    """Run one of the compiler's tools; what it prints."""
    done = subprocess.run(
        [f"arm-none-eabi-{name}", *arguments], capture_output=True, text=True, check=True
    )
    return done.stdout


@dataclass
class Function:
    """One function: its size with its constants, its instructions by address, what it calls."""

    name: str
    size_bytes: int
    instructions: dict[int, str] = field(default_factory=dict)
    calls: set[str] = field(default_factory=set)


def symbols(image: Path) -> set[str]:
    """List the names of all symbols in an image."""
    return {line.split()[-1] for line in tool("nm", str(image)).splitlines()}


def functions(image: Path) -> dict[str, Function]:
    """Read all functions of an image, by name."""
    sizes = {}
    for line in tool("nm", "-S", str(image)).splitlines():
        parts = line.split()
        if len(parts) == 4 and parts[2] in "tTwW":
            sizes[parts[3]] = int(parts[1], 16)
    found: dict[str, Function] = {}
    current: Function | None = None
    for line in tool("objdump", "-d", "--no-show-raw-insn", str(image)).splitlines():
        if heading := re.fullmatch(r"[0-9a-f]+ <(.+)>:", line):
            name = heading[1]
            current = found.setdefault(name, Function(name, sizes.get(name, 0)))
        elif current and (body := re.match(r"\s*([0-9a-f]+):\t(.*)", line)):
            current.instructions[int(body[1], 16)] = body[2]
            if call := re.match(r"bl?x?(?:\.[nw])?\s+[0-9a-f]+ <([^+>]+)>", body[2]):
                current.calls.add(call[1])
    for function in found.values():
        function.calls.discard(function.name)
    return found


def reachable(all_functions: dict[str, Function], start: str) -> list[Function]:
    """Find a function and all that it can call."""
    todo, seen = [start], set()
    while todo:
        name = todo.pop()
        if name not in seen and name in all_functions:
            seen.add(name)
            todo.extend(all_functions[name].calls)
    return [all_functions[name] for name in sorted(seen)]
