"""The command line on a long log, beside polars that only reads and writes it."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from benchmarks.speed.inputs import SAMPLE_PERIOD_S, Recording
from benchmarks.speed.programs import ROOT, Programs
from benchmarks.speed.rounds import ratio
from benchmarks.speed.worker_process import NotAvailableError

_ROW_GROUP: Final = 1_000_000
#: As many lines as anyone would write; the same compression as `strainwave filter` has.
_POLARS: Final = """
import sys
import polars
polars.read_parquet(sys.argv[1]).write_parquet(sys.argv[2], compression="snappy")
"""


def write_log(path: Path, rows: int, recording: Recording) -> None:
    """Write a log of time, angle and torque: the recording over and over.

    Parameters
    ----------
    path : Path
        A Parquet file.
    rows : int
        How many.
    recording : Recording
        Signals.
    """
    schema = pa.schema([(name, pa.float64()) for name in ("t_s", "q_rad", "tau_Nm")])
    with pq.ParquetWriter(path, schema) as writer:
        for start in range(0, rows, _ROW_GROUP):
            row = np.arange(start, min(rows, start + _ROW_GROUP))
            at = row % recording.samples
            columns = [
                SAMPLE_PERIOD_S * row,
                recording.motor_angle_rad[at],
                recording.torque_Nm[at],
            ]
            writer.write_table(pa.table(columns, schema=schema), row_group_size=_ROW_GROUP)


def _run(command: list[str | Path]) -> tuple[float, int]:
    """Run a process to its end; return seconds and its peak memory in bytes."""
    began = time.perf_counter()
    process = subprocess.Popen(  # noqa: S603
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=ROOT
    )
    assert process.stderr is not None
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stderr.close()
    if process.returncode != 0:
        raise NotAvailableError(said.strip().splitlines()[-1] if said.strip() else "it failed")
    return time.perf_counter() - began, 1024 * usage.ru_maxrss


def measure(
    programs: Programs,
    recording: Recording,
    rows: int,
    rounds: int,
    folder: Path,
    say: Callable[[str], None],
) -> dict[str, Any]:
    """Time both in turn, on all cores, reading from the page cache.

    Parameters
    ----------
    programs : Programs
        With the Python that has polars.
    recording : Recording
        Signals.
    rows : int
        Length of the log.
    rounds : int
        How often.
    folder : Path
        For the log and what is written.
    say : callable
        Takes the progress.

    Returns
    -------
    dict
        Times in s, ratio and peak memory in bytes.

    Raises
    ------
    NotAvailableError
        If one of both does not run.
    """
    log = folder / "log.parquet"
    write_log(log, rows, recording)
    # This Python's package, wherever it is; the installed command does the same.
    start = "import sys; from strainwave.cli import main; sys.exit(main())"
    ours: list[str | Path] = [sys.executable, "-c", start, "filter", log]
    ours += ["--map", "time=t_s,angle=q_rad,torque=tau_Nm", "--angle-side", "motor"]
    ours += ["--rated-torque", "40", "--out", folder / "ours.parquet"]
    theirs: list[str | Path] = [programs.peers, "-c", _POLARS, log, folder / "theirs.parquet"]
    times: dict[str, list[float]] = {"strainwave": [], "polars": []}
    peaks = {"strainwave": 0, "polars": 0}
    for number in range(rounds):
        say(f"filter command, {rows:.0e} rows, round {number + 1} of {rounds}")
        for name, command in (("strainwave", ours), ("polars", theirs)):
            seconds, peak = _run(command)
            times[name].append(seconds)
            peaks[name] = max(peaks[name], peak)
    return {
        "rows": rows,
        "strainwave_s": float(np.median(times["strainwave"])),
        "polars_s": float(np.median(times["polars"])),
        "ratio": ratio(times["strainwave"], times["polars"]),
        "strainwave_peak_memory_bytes": peaks["strainwave"],
        "polars_peak_memory_bytes": peaks["polars"],
    }
