"""How fast this machine could be: flops at the measured rate, bytes at the measured bandwidth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

#: Additions, multiplications and divisions of one update, checks left out. A test counts 221 and, of
#: a sample in motion, 971 in lean forms; less is asked for here, so that the limit is a stricter one.
#: Who does more work for the same answer is not nearer to it.
FLOPS: Final = {"published": 212, "default": 800}
#: Torque and speed read, torque written, float.
LONG_LOG_BYTES: Final = 12


def flops_ns(which: str, level: str, precision: str, limits: Mapping[str, Any]) -> float:
    """Return the least time of one update on one core.

    Parameters
    ----------
    which : str
        ``published`` or ``default``.
    level : str
        Vector level.
    precision : str
        ``float`` or ``double``.
    limits : mapping
        From `benchmarks.speed.machine.limits`.

    Returns
    -------
    float
        ns; reached by no single channel, whose operations wait for each other.
    """
    return float(1e9 * FLOPS[which] / limits["operations_per_s"][level][precision])


def copy_ns(threads: int, limits: Mapping[str, Any]) -> float:
    """Return the least time in which a sample of a long log can be read and written.

    Parameters
    ----------
    threads : int
        How many move data.
    limits : mapping
        From `benchmarks.speed.machine.limits`.

    Returns
    -------
    float
        ns.
    """
    bandwidth = limits["bandwidth_bytes_per_s"][str(threads)]
    return float(1e9 * LONG_LOG_BYTES / max(bandwidth["copy"], bandwidth["triad"]))
