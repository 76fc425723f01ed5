"""Curves: time a sample by channels and threads, by the length of a log, by states."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from benchmarks.speed.comparison import Setting
from benchmarks.speed.worker_process import NotAvailableError, Worker

CHANNELS: Final = (1, 4, 16, 64, 256, 1024, 4096)
STATES: Final = {
    "published": (4, 6, 8, 12, 16, 24, 30),
    "default": (5, 7, 11, 15, 19, 23, 31),
}
#: Channel-samples of a run, so that the memory is the same for any number of channels.
_CHANNEL_SAMPLES: Final = 4_000_000
_MOST_SAMPLES: Final = 100_000
_ROUNDS: Final = 3


def _median_ns(setting: Setting, program: str, case: str, samples: int, cores: int) -> float | None:
    try:
        with Worker(
            [setting.programs.cpp / f"strainwave_{program}", case, setting.inputs], cores
        ) as worker:
            worker.time_ns(samples, 0.01)
            times = [worker.time_ns(samples, setting.effort.block_s) for _ in range(_ROUNDS)]
    except NotAvailableError as error:
        setting.say(f"{case}: not available, {error}")
        return None
    return float(np.median(times))


def by_channels(setting: Setting) -> list[dict[str, Any]]:
    """Time the published filter on 1 to 4096 channels.

    Parameters
    ----------
    setting : Setting
        What it takes.

    Returns
    -------
    list of dict
        ``channels``, ``threads`` and ``ns_per_sample``, by channel-sample.
    """
    found = []
    for threads in setting.threads:
        for channels in CHANNELS:
            setting.say(f"{channels} channels, {threads} threads")
            case = f"batch_published:channels={channels}:level={setting.level}:threads={threads}"
            samples = min(_MOST_SAMPLES, _CHANNEL_SAMPLES // channels)
            ns = _median_ns(setting, "dispatched", case, samples, threads)
            found.append({"channels": channels, "threads": threads, "ns_per_sample": ns})
    return found


def by_states(setting: Setting) -> list[dict[str, Any]]:
    """Time both filters with 4 to 31 states, one channel, float.

    Parameters
    ----------
    setting : Setting
        What it takes.

    Returns
    -------
    list of dict
        ``filter``, ``states`` and ``ns_per_sample``.
    """
    found = []
    for which, sizes in STATES.items():
        for states in sizes:
            setting.say(f"{which} filter, {states} states")
            case = f"states_{which}_{states}"
            ns = _median_ns(setting, "native", case, 20_000, 1)
            found.append({"filter": which, "states": states, "ns_per_sample": ns})
    return found
