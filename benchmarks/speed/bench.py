"""The whole bench: what is measured in one run, and what follows from it."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from benchmarks.speed import filter_command, long_log, machine, scaling
from benchmarks.speed.agreement import TOLERANCE_NM, references
from benchmarks.speed.bounds import FLOPS, LONG_LOG_BYTES, copy_ns
from benchmarks.speed.comparison import Setting, compare
from benchmarks.speed.implementations import DEFAULT, PUBLISHED, batch
from benchmarks.speed.inputs import make
from benchmarks.speed.programs import ROOT, Programs
from benchmarks.speed.rounds import Effort, ratio
from benchmarks.speed.targets import targets
from benchmarks.speed.worker_process import NotAvailableError

SEED: Final = 1999
_RECORDING_SAMPLES: Final = 200_000
_AGREEMENT_SAMPLES: Final = 20_000
_PEERS: Final = (
    "eigen",
    "filterpy",
    "statsmodels",
    "pykalman",
    "simdkalman",
    "numba",
    "jax",
    "minikalman",
    "numpy",
)


@dataclass(frozen=True)
class Extent:
    """How much is measured.

    Attributes
    ----------
    effort : Effort
        Rounds and blocks of the comparisons.
    limits_s : float
        For each limit of the machine.
    log_samples, default_log_samples : int
        Longest log, with the published and the default filter.
    log_rounds : int
        How often.
    rows : int
        Of the log for the command line.
    scaling : bool
        Whether curves are measured.
    """

    effort: Effort
    limits_s: float
    log_samples: int
    default_log_samples: int
    log_rounds: int
    rows: int
    scaling: bool


FULL: Final = Extent(Effort(11, 0.25), 1.5, 100_000_000, 100_000_000, 3, 10_000_000, scaling=True)
QUICK: Final = Extent(Effort(3, 0.2), 0.3, 10_000_000, 20_000_000, 1, 1_000_000, scaling=False)


def run_bench(programs: Programs, extent: Extent, say: Callable[[str], None]) -> dict[str, Any]:
    """Measure everything.

    Parameters
    ----------
    programs : Programs
        What there is.
    extent : Extent
        How much.
    say : callable
        Takes the progress.

    Returns
    -------
    dict
        What latest.json holds.
    """
    began = time.monotonic()
    described = machine.description()
    level = described["vector_level"]
    recording = make(_RECORDING_SAMPLES, SEED)
    with tempfile.TemporaryDirectory() as folder:
        inputs = Path(folder)
        recording.write(inputs)
        say("what this machine can do")
        limits = machine.limits(programs, extent.limits_s, 4e8)
        say("dense references in double")
        setting = Setting(
            programs,
            inputs,
            recording.samples,
            references(recording, _AGREEMENT_SAMPLES),
            limits,
            level,
            extent.effort,
            say,
        )
        found: dict[str, Any] = {}
        values = _values_of_comparisons(setting, found)
        values |= _values_of_long_logs(setting, extent, found)
        values |= _values_of_python(setting, extent, found)
        values |= _values_of_command(programs, extent, found, inputs, say)
        curves = _curves(setting, extent, found["long_logs"]) if extent.scaling else None
    names = targets(level)
    acceptance = {
        name: target.result(*values.get(name, (None, "it was not measured")))
        for name, target in names.items()
    }
    return {
        **acceptance,
        "run": {
            "seed": SEED,
            "samples": _RECORDING_SAMPLES,
            "rounds": extent.effort.rounds,
            "block_s": extent.effort.block_s,
            "quick": extent is QUICK,
            "duration_s": time.monotonic() - began,
        },
        "machine": described,
        "limits": limits | {"flops": FLOPS, "long_log_bytes": LONG_LOG_BYTES},
        "agreement": {
            "samples": _AGREEMENT_SAMPLES,
            "tolerance_rms_Nm": {"_".join(key): each for key, each in TOLERANCE_NM.items()},
        },
        **found,
        "scaling": curves,
    }


#: A value, or None and why there is none.
_Value = tuple[float | None, str]


def _ratio_of(times: Mapping[str, list[float]], slower: str, faster: str) -> _Value:
    missing = [name for name in (slower, faster) if name not in times]
    if missing:
        return None, f"{' and '.join(missing)} could not be timed"
    return ratio(times[slower], times[faster]), ""


def _share_of(rows: list[dict[str, Any]], name: str) -> _Value:
    row = next(row for row in rows if row["name"] == name)
    return row["share_of_limit"], row["not_available"] or ""


def _values_of_comparisons(setting: Setting, found: dict[str, Any]) -> dict[str, _Value]:
    levels = [lv for lv in ("v2", "v3", "v4") if lv in setting.limits["operations_per_s"]]
    found["implementations"] = []
    values: dict[str, _Value] = {}
    for which, singles in (("published", PUBLISHED), ("default", DEFAULT)):
        batches = [batch(which, level) for level in levels]
        batches += [batch(which, levels[-1], threads) for threads in setting.threads[1:]]
        rows, times = compare((*singles, *batches), setting)
        found["implementations"] += rows
        best = f"batch_{levels[-1]}"
        if which == "published":
            for peer in _PEERS:
                values[f"published_single_vs_{peer}"] = _ratio_of(times, peer, "core")
            values["published_batch_vs_eigen"] = _ratio_of(times, "eigen", best)
            values["batch_share_of_issue_bound"] = _share_of(rows, best)
            values["batch_two_cores_vs_one"] = _ratio_of(times, best, f"{best}_2_threads")
        else:
            for peer in ("eigen", "numba"):
                values[f"default_single_vs_{peer}"] = _ratio_of(times, peer, "core")
            values["default_batch_vs_numba"] = _ratio_of(times, "numba", best)
            values["default_batch_share_of_issue_bound"] = _share_of(rows, best)
    return values


def _values_of_long_logs(
    setting: Setting, extent: Extent, found: dict[str, Any]
) -> dict[str, _Value]:
    lengths = {"published": extent.log_samples, "default": extent.default_log_samples}
    found["long_logs"] = [
        long_log.measure(which, samples, setting.threads, extent.log_rounds, setting)
        for which, samples in lengths.items()
    ]
    none = {"not_available": "there is one core"}
    published, default = (each["ways"].get("2_threads", none) for each in found["long_logs"])
    values: dict[str, _Value] = {
        "long_log_vs_sequential": (
            published.get("ratio"),
            published.get("not_available", ""),
        ),
        "default_long_log_vs_sequential": (
            default.get("ratio"),
            default.get("not_available", ""),
        ),
        "long_log_difference_rms_Nm": (
            published.get("difference_rms_Nm"),
            published.get("not_available", ""),
        ),
    }
    share = None
    if "ns_per_sample" in published:
        share = copy_ns(2, setting.limits) / published["ns_per_sample"]
    values["long_log_share_of_bandwidth"] = (share, published.get("not_available", ""))
    return values


def _values_of_python(setting: Setting, extent: Extent, found: dict[str, Any]) -> dict[str, _Value]:
    setting.say("step() called from Python")
    ended = subprocess.run(  # noqa: S603
        [
            sys.executable,
            "-m",
            "benchmarks.speed.python_call",
            str(10 * extent.effort.rounds),
        ],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    if ended.returncode != 0:
        return {"step_vs_empty_bound_function": (None, ended.stderr.strip().splitlines()[-1])}
    times = json.loads(ended.stdout)
    found["python_step_ns"] = {name: sorted(each)[len(each) // 2] for name, each in times.items()}
    return {"step_vs_empty_bound_function": (ratio(times["step"], times["empty"]), "")}


def _values_of_command(
    programs: Programs,
    extent: Extent,
    found: dict[str, Any],
    folder: Path,
    say: Callable[[str], None],
) -> dict[str, _Value]:
    recording = make(_RECORDING_SAMPLES, SEED)
    try:
        measured = filter_command.measure(
            programs, recording, extent.rows, extent.log_rounds, folder, say
        )
    except NotAvailableError as error:
        reason = str(error)
        return {
            "filter_command_vs_polars": (None, reason),
            "filter_command_peak_memory_bytes": (None, reason),
        }
    found["filter_command"] = measured
    return {
        "filter_command_vs_polars": (measured["ratio"], ""),
        "filter_command_peak_memory_bytes": (measured["strainwave_peak_memory_bytes"], ""),
    }


def _curves(
    setting: Setting, extent: Extent, long_logs: list[dict[str, Any]]
) -> dict[str, list[dict[str, Any]]]:
    lengths = [10**power for power in range(4, 9) if 10**power < extent.log_samples]
    logs = [
        long_log.measure("published", samples, setting.threads, extent.log_rounds, setting)
        for samples in lengths
    ]
    logs.append(long_logs[0])
    return {
        "channels": scaling.by_channels(setting),
        "log_length": logs,
        "states": scaling.by_states(setting),
    }
