"""The process of the filter command: its bar, and its memory."""

from __future__ import annotations

import ctypes
import io
import subprocess
import sys

import pytest
from rich.console import Console

from strainwave.cli.progress import progress_bar


@pytest.mark.parametrize("is_terminal", [True, False])
def test_a_bar_is_drawn_where_somebody_watches(is_terminal: bool) -> None:
    drawn = io.StringIO()
    console = Console(file=drawn, force_terminal=is_terminal, width=100)
    with progress_bar(console) as progress:
        progress("surveying", 0.25)
        progress("filtering", 0.75)
    assert ("75%" in drawn.getvalue()) == is_terminal
    assert ("filtering" in drawn.getvalue()) == is_terminal
    assert bool(drawn.getvalue()) == is_terminal


_FAULTS = """
import resource, sys
import numpy as np
from strainwave.cli.memory import keep_freed_memory
if sys.argv[1] == "keep":
    keep_freed_memory()
def use():
    np.ones(5_000_000)
use()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(20):
    use()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallopt"), reason="not glibc")
def test_freed_memory_is_used_again() -> None:
    faults = {}
    for how in ("keep", "plain"):
        ended = subprocess.run(
            [sys.executable, "-c", _FAULTS, how], capture_output=True, text=True, check=True
        )
        faults[how] = int(ended.stdout)
    # One for each page, large or small, that the kernel has to clear.
    assert faults["plain"] > 100
    assert faults["keep"] < faults["plain"] / 4
