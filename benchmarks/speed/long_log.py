"""One log of up to 1e8 samples: in sequence, and in chunks of time on lanes and threads."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.speed.comparison import Setting
from benchmarks.speed.rounds import ratio
from benchmarks.speed.worker_process import NotAvailableError, Worker


def measure(
    which: str, samples: int, threads: Iterable[int], rounds: int, setting: Setting
) -> dict[str, Any]:
    """Time one length in turn.

    Parameters
    ----------
    which : str
        ``published`` or ``default``.
    samples : int
        Length of the log.
    threads : iterable of int
        Numbers of threads for the chunks.
    rounds : int
        How often.
    setting : Setting
        What it takes.

    Returns
    -------
    dict
        ``ways``: for the sequence and each number of threads the median of ns a sample, how many
        times as fast as the sequence, peak memory, and what the program says beside.
    """
    ways = {"sequential": (f"sequential_{which}", "native", 1)}
    for count in threads:
        case = f"long_{which}:level={setting.level}:threads={count}"
        ways[f"{count}_threads"] = (case, "dispatched", count)
    times: dict[str, list[float]] = {name: [] for name in ways}
    found: dict[str, dict[str, Any]] = {name: {} for name in ways}
    for number in range(rounds):
        for name, (case, program, cores) in ways.items():
            setting.say(
                f"log of {samples:.0e} samples, {which}, {name}, round {number + 1} of {rounds}"
            )
            command: list[str | Path] = [
                setting.programs.cpp / f"strainwave_{program}",
                case,
                setting.inputs,
            ]
            try:
                # One at a time: two logs would not fit into the memory that is allowed.
                with Worker(command, cores) as worker:
                    answer = worker.ask(f"time {samples} {setting.effort.block_s}")
                    answer["peak_memory_bytes"] = worker.peak_memory_bytes
            except NotAvailableError as error:
                found[name]["not_available"] = str(error)
                continue
            times[name].append(answer.pop("ns_per_sample"))
            answer.pop("runs")
            found[name] |= answer
    for name, each in times.items():
        if each:
            found[name] |= {
                "ns_per_sample": float(np.median(each)),
                "ratio": ratio(times["sequential"], each),
            }
    return {"filter": which, "samples": samples, "ways": found}
