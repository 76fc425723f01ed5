"""Cycles of a Cortex-M4F from the instructions it executed.

The numbers are those of the Cortex-M4 Technical Reference Manual (r0p1, tables of instruction and
of floating-point timings), taken as an upper estimate: memory without wait states, three cycles to
refill the pipeline after every branch taken, no load or store hidden behind another one, and 12
cycles for every integer division.
"""

import re

_refill = 3
_divide = 12
_by_name = {
    "vdiv": 14, "vsqrt": 14,
    "vfma": 3, "vfms": 3, "vfnma": 3, "vfnms": 3, "vmla": 3, "vmls": 3, "vnmla": 3, "vnmls": 3,
    "vldr": 2, "vstr": 2,
    "mla": 2, "mls": 2,
    "udiv": _divide, "sdiv": _divide,
}  # fmt: skip
_multiple = re.compile(r"(v?ldm|v?stm|v?push|v?pop)")
_single_access = re.compile(r"(ldr|str)")


def _registers(operands: str) -> int:
    """How many registers a list such as {r4-r7, lr} or {s16-s23} names."""
    count = 0
    for part in re.search(r"\{([^}]*)\}", operands)[1].split(","):
        ends = re.findall(r"[a-z]+(\d+)", part)
        words = 2 if part.strip().startswith("d") else 1
        count += words * (int(ends[1]) - int(ends[0]) + 1 if len(ends) == 2 else 1)
    return count


def cycles_of(instruction: str, branched: bool) -> int:
    """Cycles of one instruction; `branched`: the next one executed is not the next in memory."""
    name, _, operands = instruction.partition("\t")
    name = name.split(".")[0]
    refill = _refill if branched else 0
    if _multiple.match(name):
        return 1 + _registers(operands) + refill
    if re.match(r"(ldrd|strd)", name):
        return 3 + refill
    if _single_access.match(name):
        return 2 + refill
    for stem in (name, re.sub(r"(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le|s)$", "", name)):
        if stem in _by_name:
            return _by_name[stem] + refill
    return 1 + refill
