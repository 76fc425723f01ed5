"""What machine the numbers are from, without its name."""

from __future__ import annotations

import json
import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

from benchmarks.speed.programs import Programs

#: Features that an x86-64 level needs beyond the one before, as Linux names them.
_LEVEL_FLAGS: Final = {
    "v2": {"sse4_2", "ssse3", "popcnt", "cx16"},
    "v3": {"avx2", "bmi1", "bmi2", "fma", "f16c", "movbe", "abm"},
    "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}


def best_level(flags: set[str]) -> str:
    """Return the highest x86-64 level.

    Parameters
    ----------
    flags : set of str
        From /proc/cpuinfo.

    Returns
    -------
    str
        ``v1`` to ``v4``.
    """
    level = "v1"
    for name, needed in _LEVEL_FLAGS.items():
        if not needed <= flags:
            break
        level = name
    return level


def _cpu_info() -> dict[str, str]:
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8").split("\n\n")[0]
    pairs = (line.partition(":") for line in text.splitlines())
    return {key.strip(): value.strip() for key, _, value in pairs}


def _caches() -> dict[str, str]:
    found = {}
    for index in sorted(Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        level, kind, size = (
            (index / name).read_text(encoding="ascii").strip() for name in ("level", "type", "size")
        )
        found[f"L{level} {kind.lower()}"] = size
    return found


def description() -> dict[str, Any]:
    """Describe the machine and what was built with.

    Returns
    -------
    dict
        Processor, caches, cores, memory, compiler, Python.
    """
    info = _cpu_info()
    compiler = subprocess.run(  # noqa: S603
        [os.environ.get("CXX", "c++"), "--version"],
        capture_output=True,
        text=True,
        check=False,
    ).stdout.splitlines()
    pages = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return {
        "processor": info.get("model name", platform.machine()),
        "family_model_stepping": [
            int(info.get(key, 0)) for key in ("cpu family", "model", "stepping")
        ],
        "vector_level": best_level(set(info.get("flags", "").split())),
        "cores": len(os.sched_getaffinity(0)),
        "caches": _caches(),
        "memory_bytes": pages,
        "system": f"{platform.system()} {platform.release()}",
        "compiler": compiler[0] if compiler else "unknown",
        "compiler_options": {
            "one channel and Eigen": "-O3 -march=native -fno-math-errno",
            "many channels and long logs": "-O3 -fno-math-errno, vector level found at run time",
            "Rust": "opt-level 3, lto, target-cpu native",
        },
        "python": platform.python_version(),
        "numpy": version("numpy"),
    }


def limits(programs: Programs, seconds: float, bytes_of_arrays: float) -> dict[str, Any]:
    """Measure what the machine can do at best.

    Parameters
    ----------
    programs : Programs
        With the program that measures.
    seconds : float
        For each value.
    bytes_of_arrays : float
        Size of each array that is copied; several times the last cache.

    Returns
    -------
    dict
        Operations a second by vector level and precision, bytes a second by threads.
    """
    ended = subprocess.run(  # noqa: S603
        [programs.cpp / "strainwave_limits", str(seconds), str(bytes_of_arrays)],
        capture_output=True,
        text=True,
        check=True,
    )
    found: dict[str, Any] = json.loads(ended.stdout)
    return found
