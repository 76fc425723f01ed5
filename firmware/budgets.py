"""What one update costs on a Cortex-M4F, and what it may cost."""

import itertools
from pathlib import Path

import cycles
import emulator
import listing

subjects = (
    "published_4",
    "published_6",
    "default_3_orders",
    "default_3_orders_load_speed",
    "chain_4_gauges",
)
limits = {
    ("published_6", "instructions"): 270,
    ("chain_4_gauges", "instructions"): 1800,
    ("default_3_orders", "state_bytes"): 1024,
}
worst_over_typical = 1.1

_start = "sample_path"
_last_traced = 18  # of the updates traced: a whole number of rounds through all pairs
# Double arithmetic, a heap, and mathematics whose time nobody bounds.
_forbidden = ("__aeabi_d", "__aeabi_f2d", "__aeabi_cd", "__aeabi_l2d", "__aeabi_ul2d",
              "malloc", "free", "_sbrk", "_Znw", "_Zdl", "__cxa", "printf")  # fmt: skip
_mathematics = {"sinf", "cosf", "sqrtf", "fmodf", "floorf", "powf", "expf", "logf", "atan2f"}


class MismatchError(AssertionError):
    """A figure that contradicts another one, or something in an image that must not be there."""


def _forbidden_in(names: set[str]) -> list[str]:
    return sorted(n for n in names if n.startswith(_forbidden) or n in _mathematics)


def _traced(image: Path, functions: dict[str, listing.Function]) -> tuple[float, float]:
    """Instructions and cycles of an update, from every instruction of the last ones traced."""
    text = {a: i for f in functions.values() for a, i in f.instructions.items()}
    order = sorted(text)
    following = dict(itertools.pairwise(order))
    entry = min(functions[_start].instructions)
    addresses = emulator.executed(image, image.with_suffix(".log"))
    starts = [i for i, address in enumerate(addresses) if address == entry]
    first, last = starts[-_last_traced - 1], starts[-1]
    # From call to call there are also the few instructions of the loop around them.
    total = 0
    for here, after in itertools.pairwise(addresses[first : last + 1]):
        total += cycles.cycles_of(text[here], following.get(here) != after)
    return (last - first) / _last_traced, total / _last_traced


def measure(image: Path) -> dict[str, float]:
    """Measure one subject: all its figures."""
    rows = (line.split("=") for line in emulator.run(image, "count").splitlines())
    printed = {key: int(value) for key, value in rows}
    functions = listing.functions(image)
    path = listing.reachable(functions, _start)
    wrong = _forbidden_in({f.name for f in path} | listing.symbols(image))
    if wrong:
        raise MismatchError(f"{image.name} contains {', '.join(wrong)}")
    typical = printed["instructions_x100"] / 100
    traced, traced_cycles = _traced(image, functions)
    if abs(traced - typical) > 0.05 * typical + 20:
        raise MismatchError(
            f"{image.name}: {typical} instructions by the clock, {traced} by the trace"
        )
    return {
        "instructions": round(typical, 1),
        "dearest_sound_instructions": printed["dearest_sound_instructions"],
        "worst_instructions": printed["worst_instructions"],
        "cycles_estimated": round(traced_cycles),
        "code_bytes": sum(f.size_bytes for f in path),
        "state_bytes": printed["state_bytes"],
        "stack_bytes": printed["stack_bytes"],
    }


def over_limits(results: dict[str, dict[str, float]]) -> list[str]:
    """Say what is over what it may be."""
    found = [
        f"{subject}: {key} is {results[subject][key]}, over {limit}"
        for (subject, key), limit in limits.items()
        if results[subject][key] > limit
    ]
    for subject, figures in results.items():
        ratio = figures["worst_instructions"] / figures["instructions"]
        if ratio > worst_over_typical:
            found.append(f"{subject}: the worst update takes {ratio:.2f} times the typical one")
    return found


def grown(before: dict[str, dict[str, float]], after: dict[str, dict[str, float]]) -> list[str]:
    """Say what costs over 2 % more than what is on record."""
    return [
        f"{subject}: {key} was {figures[key]:g} and is {after[subject][key]:g}"
        for subject, figures in before.items()
        for key in figures
        if subject in after and after[subject][key] > 1.02 * figures[key]
    ]
