"""One filter's implementations beside each other: agreement first, then interleaved rounds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from benchmarks.speed.agreement import agreement
from benchmarks.speed.bounds import FLOPS
from benchmarks.speed.implementations import BATCH_CHANNELS, Implementation, issue, start
from benchmarks.speed.inputs import Array
from benchmarks.speed.programs import Programs
from benchmarks.speed.rounds import Effort, ratio, timed
from benchmarks.speed.worker_process import NotAvailableError, Worker

#: Samples of one channel in a run, and of each of many channels: so many that to start a thread
#: counts for little.
_SINGLE_SAMPLES: Final = 50_000
_BATCH_SAMPLES: Final = 100_000
#: Of products and sums in a run, where these are measured.
_OPERATIONS: Final = 10_000_000


@dataclass(frozen=True)
class Setting:
    """What all comparisons have in common.

    Attributes
    ----------
    programs : Programs
        What there is.
    inputs : Path
        The recording, written.
    samples : int
        Its length.
    references : mapping
        Ripple of the dense references by filter.
    limits : mapping
        From `benchmarks.speed.machine.limits`.
    level : str
        Best vector level.
    effort : Effort
        How long.
    say : callable
        Takes the progress.
    """

    programs: Programs
    inputs: Path
    samples: int
    references: Mapping[str, Array]
    limits: Mapping[str, Any]
    level: str
    effort: Effort
    say: Callable[[str], None]

    @property
    def threads(self) -> list[int]:
        """Numbers of threads that are compared: one, and two where there are two cores."""
        return sorted(int(each) for each in self.limits["bandwidth_bytes_per_s"])


def _row(each: Implementation) -> dict[str, Any]:
    return {
        "filter": each.filter,
        "name": each.name,
        "what": each.what,
        "precision": each.precision,
        "channels": each.channels,
        "cores": each.cores,
        "version": None,
        "difference_rms_Nm": None,
        "ns_per_sample": None,
        "ratio": None,
        "peak_memory_bytes": None,
        "flops": FLOPS[each.filter],
        "limit_ns": None,
        "share_of_limit": None,
        "not_available": None,
    }


def _agrees(each: Implementation, worker: Worker, row: dict[str, Any], setting: Setting) -> bool:
    reference = setting.references[each.reference]
    ripple = worker.ripple_Nm(len(reference), setting.inputs)
    found = agreement(each.reference, each.precision, ripple, reference)
    row["version"] = worker.version
    row["difference_rms_Nm"] = found.difference_rms_Nm if np.isfinite(ripple).all() else None
    if not found.ok:
        row["not_available"] = (
            f"it disagrees with the dense reference by {found.difference_rms_Nm:.2g} Nm rms, "
            f"{found.tolerance_Nm:.2g} are allowed, and was not timed"
        )
    return found.ok


def _level_of(each: Implementation, setting: Setting) -> str:
    # A batch is held against the limit of its own level.
    return next((lv for lv in ("v2", "v3", "v4") if f"level={lv}" in each.case), setting.level)


def _limit_of(each: Implementation, setting: Setting) -> Implementation:
    return issue(_level_of(each, setting), each.precision)


def _limit(
    each: Implementation, times_ns: list[float], operation_ns: list[float] | None
) -> dict[str, float]:
    if operation_ns is None:
        return {}
    # At best: its flops at the rate that products and sums have in the same round.
    at_best_ns = [ns * FLOPS[each.filter] / each.cores for ns in operation_ns]
    return {
        "limit_ns": float(np.median(at_best_ns)),
        "share_of_limit": ratio(at_best_ns, times_ns),
    }


def _time(
    workers: dict[Implementation, Worker], setting: Setting
) -> dict[Implementation, list[float]]:
    # Single channels and batches differ in the length of a run only.
    by_key = {each.key: worker for each, worker in workers.items()}
    batch = {each.key for each in workers if each.channels == BATCH_CHANNELS}
    most = {
        key: min(setting.samples, _BATCH_SAMPLES if key in batch else _SINGLE_SAMPLES)
        for key in by_key
    }
    most |= {each.key: _OPERATIONS for each in workers if each.filter == "no"}
    found = timed(by_key, most, setting.effort, setting.say)
    return {each: found[each.key] for each in workers}


def compare(
    implementations: Iterable[Implementation], setting: Setting
) -> tuple[list[dict[str, Any]], dict[str, list[float]]]:
    """Compare implementations of one filter.

    The limit of each is measured in the same rounds.

    Parameters
    ----------
    implementations : iterable of Implementation
        The first one is what the others' ratios refer to.
    setting : Setting
        What it takes.

    Returns
    -------
    list of dict
        A row for each, those that are not available included.
    dict of list of float
        ns a sample in every round, by name.
    """
    rows = {each: _row(each) for each in implementations}
    workers: dict[Implementation, Worker] = {}
    with ExitStack() as stack:
        for each, row in rows.items():
            setting.say(f"{each.key}: does it agree?")
            try:
                worker = start(each, setting.programs, setting.inputs)
                stack.callback(worker.close)
                if _agrees(each, worker, row, setting):
                    workers[each] = worker
            except NotAvailableError as error:
                row["not_available"] = str(error)
            if row["not_available"]:
                setting.say(f"{each.what} ({each.filter}): not available, {row['not_available']}")
        for limit in {_limit_of(each, setting) for each in workers}:
            try:
                workers[limit] = start(limit, setting.programs, setting.inputs)
                stack.callback(workers[limit].close)
            except NotAvailableError as error:
                setting.say(f"{limit.what}: not available, {error}")
        times = _time(workers, setting)
        first = times.get(next(iter(rows)))
        for each, row in rows.items():
            if each in times:
                row.update(
                    ns_per_sample=float(np.median(times[each])),
                    ratio=None if first is None else ratio(times[each], first),
                    peak_memory_bytes=workers[each].peak_memory_bytes,
                )
                row.update(_limit(each, times[each], times.get(_limit_of(each, setting))))
    return list(rows.values()), {each.name: times[each] for each in rows if each in times}
