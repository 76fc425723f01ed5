"""`python -m benchmarks.accuracy`: runs the bench, prints the table, writes the results."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

# Matrices of fifteen rows gain nothing from threads, and a process per core is at work already.
# Set before numpy reads it, in the children too.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

RESULTS = Path(__file__).resolve().parents[1] / "results"


def rounded(value: Any) -> Any:
    """Round every number to six digits, so that rounding on another machine makes no difference.

    Parameters
    ----------
    value : Any
        Plain values.

    Returns
    -------
    Any
        The same, rounded.
    """
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {name: rounded(each) for name, each in value.items()}
    return [rounded(each) for each in value] if isinstance(value, list | tuple) else value


def main() -> int:
    """Run the bench.

    Returns
    -------
    int
        0, whatever is found: a figure that misses its limit is printed as such.
    """
    # Imported here, so that the variables above come first.
    from rich.console import Console  # noqa: PLC0415

    from benchmarks.accuracy.bench import run_bench  # noqa: PLC0415
    from benchmarks.accuracy.figures import error_figure, kuka_figure  # noqa: PLC0415
    from benchmarks.accuracy.path_table import markdown_of, path_table  # noqa: PLC0415
    from benchmarks.accuracy.recordings import (  # noqa: PLC0415
        ENVIRONMENT_VARIABLE,
        recordings_folder,
    )
    from benchmarks.accuracy.table import (  # noqa: PLC0415
        coverage_table,
        main_table,
        memory_table,
        phase_table,
        target_table,
    )
    from benchmarks.accuracy.targets import targets  # noqa: PLC0415

    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy", description=__doc__)
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder for results")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    console = Console(highlight=False, width=None if sys.stdout.isatty() else 190)
    folder = recordings_folder()
    started_s = time.monotonic()
    results = run_bench(folder, options.processes)
    found = targets(results)
    console.print(phase_table(results))
    console.print(memory_table(results))
    console.print(coverage_table(results))
    console.print(path_table(results))
    console.print(main_table(results))
    console.print(target_table(found))
    if results["recordings"] is None:
        console.print(
            f"Recordings skipped: there is no folder {folder}; {ENVIRONMENT_VARIABLE} names another"
        )
    else:
        for name, reason in results["recordings"]["refused"].items():
            console.print(f"{name} on the Med7: {reason}")
    results["targets"] = [
        {"what": t.what, "measured": t.measured, "limit": t.limit, "met": t.met} for t in found
    ]
    options.out.mkdir(parents=True, exist_ok=True)
    plain = rounded(results)
    text = json.dumps(plain, indent=1, allow_nan=False) + "\n"
    (options.out / "accuracy.json").write_text(text, encoding="utf-8")
    for name, content in (
        ("accuracy-error.svg", error_figure(results)),
        ("accuracy-med7.svg", kuka_figure(results)),
        ("accuracy-paths.md", markdown_of(plain)),
    ):
        if content is not None:
            (options.out / name).write_text(content, encoding="utf-8")
    console.print(f"{options.out} written after {time.monotonic() - started_s:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
