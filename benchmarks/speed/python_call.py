"""`python -m benchmarks.speed.python_call`: a step of the filter from Python, beside an empty one."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from typing import Final

import strainwave
from benchmarks.speed.worker_process import pinned
from strainwave import _core
from strainwave.filter import oscillator_preset

_CALLS: Final = 100_000


def _ns(step: Callable[[float, float], object]) -> float:
    # Values that change, as in a loop; both ways of calling pay for them alike.
    samples = [(0.01 * (k % 97), 0.5 * (k % 89)) for k in range(_CALLS)]
    began = time.perf_counter()
    for torque_Nm, speed_rad_s in samples:
        step(torque_Nm, speed_rad_s)
    return 1e9 * (time.perf_counter() - began) / _CALLS


def main() -> int:
    """Time both in rounds and print them.

    Returns
    -------
    int
        0.
    """
    os.sched_setaffinity(0, pinned(1))
    step = strainwave.OscillatorFilter(oscillator_preset("taghirad1999"), dtype="float32").step
    empty = _core._EmptyStep().step  # noqa: SLF001
    found: dict[str, list[float]] = {"step": [], "empty": []}
    for _ in range(int(sys.argv[1])):
        found["step"].append(_ns(step))
        found["empty"].append(_ns(empty))
    sys.stdout.write(json.dumps(found) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
