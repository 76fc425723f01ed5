"""Which implementations there are, of which filter, and how they are started."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from benchmarks.speed.programs import Programs
from benchmarks.speed.worker_process import NotAvailableError, Worker


@dataclass(frozen=True)
class Implementation:
    """One implementation of a filter.

    Attributes
    ----------
    name : str
        In the results, and of the acceptance values that compare with it.
    filter : str
        ``published`` or ``default``.
    program : str
        ``native``, ``dispatched``, ``rust``, ``peers`` (Python) or ``package`` (this Python).
    case : str
        What the program is asked for.
    precision : str
        ``float`` or ``double``: what its agreement is held to.
    what : str
        In words, for the table.
    channels : int
        How many at once.
    cores : int
        How many it may use.
    """

    name: str
    filter: str
    program: str
    case: str
    precision: str
    what: str
    channels: int = 1
    cores: int = 1

    @property
    def key(self) -> str:
        """What it is called across filters."""
        return f"{self.filter}_{self.name}"

    @property
    def reference(self) -> str:
        """What it has to agree with: the peers do not hold variances to their limit."""
        is_peer = self.program == "peers" or self.name.startswith("eigen")
        return "default_unlimited" if is_peer and self.filter == "default" else self.filter


def _peers(which: str, *names: tuple[str, str, str]) -> tuple[Implementation, ...]:
    return tuple(
        Implementation(name, which, "peers", f"{which}_{name}", precision, what)
        for name, precision, what in names
    )


_BY_STEP: Final = "strainwave, step by step"


def _core(which: str, case: str, own: str) -> tuple[Implementation, ...]:
    return (
        Implementation("core", which, "native", f"{case}_float", "float", own),
        Implementation("core_double", which, "native", f"{case}_double", "double", own),
        Implementation(
            "core_run_time",
            which,
            "native",
            f"{case}_float_run_time",
            "float",
            f"{own}, configuration read at run time",
        ),
    )


def _eigen(which: str) -> tuple[Implementation, ...]:
    what = "Eigen, fixed size, dense"
    return (
        Implementation("eigen", which, "native", f"{which}_eigen_float", "float", what),
        Implementation("eigen_double", which, "native", f"{which}_eigen_double", "double", what),
    )


_NUMBA: Final = (
    ("numba", "float", "numba, dense"),
    ("numba_fastmath", "float", "numba, dense, with fastmath"),
)
#: The first one is what the others are compared with.
PUBLISHED: Final = (
    *_core("published", "published_series", "strainwave, all samples in one call"),
    Implementation("core_by_step", "published", "native", "published_float", "float", _BY_STEP),
    *_eigen("published"),
    Implementation(
        "minikalman", "published", "rust", "published_minikalman", "float", "minikalman"
    ),
    *_peers(
        "published",
        *_NUMBA,
        ("jax", "float", "JAX scan on the processor"),
        ("statsmodels", "double", "statsmodels"),
        ("numpy", "double", "numpy, dense"),
        ("filterpy", "double", "filterpy"),
        ("simdkalman", "double", "simdkalman's primitives"),
        ("pykalman", "double", "pykalman"),
    ),
)
DEFAULT: Final = (
    *_core("default", "default", _BY_STEP),
    *_eigen("default"),
    *_peers("default", *_NUMBA),
)

BATCH_CHANNELS: Final = 64


def batch(which: str, level: str, threads: int = 1) -> Implementation:
    """Return the core's batch of channels.

    Parameters
    ----------
    which : str
        ``published`` or ``default``.
    level : str
        Vector level.
    threads : int
        And cores.

    Returns
    -------
    Implementation
        For so many channels that all lanes are in use.
    """
    case = f"batch_{which}:channels={BATCH_CHANNELS}:level={level}:threads={threads}"
    name = f"batch_{level}" + (f"_{threads}_threads" if threads > 1 else "")
    on = f"{threads} threads" if threads > 1 else "one thread"
    what = f"strainwave, {BATCH_CHANNELS} channels, {level}, {on}"
    return Implementation(
        name, which, "dispatched", case, "float", what, BATCH_CHANNELS, cores=threads
    )


def issue(level: str, precision: str) -> Implementation:
    """Return products and sums alone: what an update could take at best.

    Parameters
    ----------
    level : str
        Vector level.
    precision : str
        ``float`` or ``double``.

    Returns
    -------
    Implementation
        One whose samples are operations.
    """
    case = f"multiply_add:level={level}:double={int(precision == 'double')}"
    name = f"issue_{level}_{precision}"
    return Implementation(name, "no", "dispatched", case, precision, f"products and sums, {level}")


def start(each: Implementation, programs: Programs, inputs: Path) -> Worker:
    """Start a worker.

    Parameters
    ----------
    each : Implementation
        Which.
    programs : Programs
        What there is.
    inputs : Path
        The recording.

    Returns
    -------
    Worker
        Ready to be asked.

    Raises
    ------
    NotAvailableError
        If it cannot be run here.
    """
    if each.program == "rust":
        if programs.rust is None:
            raise NotAvailableError("its program was not built")
        return Worker([programs.rust, each.case, inputs], each.cores)
    if each.program == "peers":
        module = "benchmarks.speed.peers.worker"
        return Worker([programs.peers, "-m", module, each.case, inputs], each.cores)
    return Worker([programs.cpp / f"strainwave_{each.program}", each.case, inputs], each.cores)
