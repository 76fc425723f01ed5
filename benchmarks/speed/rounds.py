"""Interleaved rounds: every implementation once a round, ratios within it, medians over all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from benchmarks.speed.worker_process import Worker

#: A run is not longer than this, so that a round stays short; nor has it fewer samples than that.
_LONGEST_RUN_S: Final = 0.2
_LEAST_SAMPLES: Final = 400


@dataclass(frozen=True)
class Effort:
    """How long everything is measured.

    Attributes
    ----------
    rounds : int
        How many.
    block_s : float
        Least time of an implementation in a round.
    """

    rounds: int
    block_s: float


def samples_for(worker: Worker, most: int) -> int:
    """Choose how many samples a run has.

    Parameters
    ----------
    worker : Worker
        Which is run a few times, so that it is warm as well.
    most : int
        For those that are fast.

    Returns
    -------
    int
        As many as take a fifth of a second.
    """
    for _ in range(2):  # the first time it may be compiled
        ns = worker.time_ns(_LEAST_SAMPLES, 0.01)
    samples = int(min(most, max(_LEAST_SAMPLES, 1e9 * _LONGEST_RUN_S / ns)))
    worker.time_ns(samples, 0.001)
    return samples


def timed(
    workers: Mapping[str, Worker],
    most_samples: Mapping[str, int],
    effort: Effort,
    say: Callable[[str], None],
) -> dict[str, list[float]]:
    """Time workers in rounds.

    Parameters
    ----------
    workers : mapping of Worker
        By name.
    most_samples : mapping of int
        Samples of a channel in a run of those that are fast, by name.
    effort : Effort
        How long.
    say : callable
        Takes the progress.

    Returns
    -------
    dict of list of float
        ns a sample in each round, by name.
    """
    samples = {name: samples_for(worker, most_samples[name]) for name, worker in workers.items()}
    found: dict[str, list[float]] = {name: [] for name in workers}
    for number in range(effort.rounds):
        say(f"round {number + 1} of {effort.rounds}, {len(workers)} implementations")
        for name, worker in workers.items():
            found[name].append(worker.time_ns(samples[name], effort.block_s))
    return found


def ratio(slower: list[float], faster: list[float]) -> float:
    """Take the median of the rounds' ratios.

    Parameters
    ----------
    slower, faster : list of float
        Times of the same rounds.

    Returns
    -------
    float
        How many times the first is the second.
    """
    return float(np.median(np.array(slower) / np.array(faster)))
