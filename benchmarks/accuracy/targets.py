"""What the default filter is asked to reach, and whether it does: measured figures beside limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from benchmarks.accuracy.basis import LEAST_RESIDUAL_PERCENT
from benchmarks.accuracy.joint import FULL_SCALE_NM
from benchmarks.accuracy.kuka import JOINTS
from benchmarks.accuracy.methods.ours import KUKA_GENTLE_TURNS, KUKA_STRONG_TURNS, OURS
from benchmarks.accuracy.ripple import MISMATCH, RIGHT, SCENARIOS, TEETH

#: Attenuation of order 2, dB, that must be passed at no more than this error, %: joints 1 to 4.
KUKA_STRONG: Final = ((15.0, 4.0), (19.0, 8.0), (16.5, 4.0), (19.0, 4.5))
KUKA_GENTLE: Final = ((10.5, 2.0), (12.5, 4.0), (10.5, 2.0), (13.0, 2.0))
#: Mean error over the phases, %FS.
MOST_ERROR_PERCENT: Final = {RIGHT: 0.11, MISMATCH: 0.17}
#: What a path may change of an error in any phase: less than any table shows.
MOST_CHANGE_PERCENT: Final = 0.0005
#: What a torque may differ on a path: as much as the golden vectors' float may be off double.
MOST_FURTHEST_PERCENT: Final = 0.01
#: Change of power more than 0.3 order beside the removed lines.
MOST_OUTSIDE_DB: Final = 0.3


@dataclass(frozen=True)
class Target:
    """A figure and its limit.

    Attributes
    ----------
    what : str
        What is measured, with its unit.
    measured : float
        The figure.
    limit : float
        What it must reach.
    at_least : bool
        Whether the figure must not be below the limit; else it must not be above.
    """

    what: str
    measured: float
    limit: float
    at_least: bool

    @property
    def met(self) -> bool:
        """Whether the limit is kept."""
        if self.at_least:
            return self.measured >= self.limit
        return self.measured <= self.limit


def targets(results: Mapping[str, Any]) -> list[Target]:
    """Put the figures of the default filter beside their limits.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    list of Target
        One for each limit.
    """
    scenarios = results["methods"][OURS.name]["scenarios"]
    passing = results["methods"][OURS.name]["fidelity"]
    without_load = results["ours_without_load_terms"]
    right = scenarios[RIGHT]
    residual = min(
        min(results["basis_residual_percent"][s]) for s in SCENARIOS if s in (MISMATCH, TEETH)
    )
    found = [
        Target("least basis residual with mismatch, %FS", residual, LEAST_RESIDUAL_PERCENT, True),
        *(
            Target(f"mean error, {s}, %FS", scenarios[s]["error_percent"]["mean"], limit, False)
            for s, limit in MOST_ERROR_PERCENT.items()
        ),
        *(
            Target(
                f"order {k} down, right structure, dB", right["attenuation_steady_dB"][n], 55, True
            )
            for n, k in enumerate((2, 4))
        ),
        Target("largest gain error 1-20 Hz, %", gain_error_percent(passing), 0.5, False),
        Target("largest added delay 1-20 Hz, ms", largest_delay_ms(passing), 0.02, False),
        Target(
            "10 Nm at standstill without load terms, bit-exact",
            float(without_load["bit_exact"]),
            1,
            True,
        ),
        Target(
            "10 Nm at standstill with load terms, %FS", passing["contact_error_percent"], 0.1, False
        ),
        Target("power outside the lines, dB", abs(right["outside_dB"]), MOST_OUTSIDE_DB, False),
    ]
    found += path_targets(results["paths"])
    if results["recordings"] is not None:
        found += _kuka_targets(results["recordings"]["kuka"])
        through = results["recordings"]["run_through"]
        share = sum(each["finite"] for each in through) / len(through)
        found.append(Target("other recordings run through, share", share, 1, True))
    return found


def path_targets(scores: Sequence[Mapping[str, Any]]) -> list[Target]:
    """Put the figures of every path through the core beside their limits.

    Parameters
    ----------
    scores : sequence of mapping
        Fields of `benchmarks.accuracy.paths.PathScore`.

    Returns
    -------
    list of Target
        Errors of the default filter as everywhere; differences from step by step of both filters.
    """
    taken = [score for score in scores if not score["refused"]]
    ours = [score for score in taken if score["method"] == OURS.name]
    furthest_percent = 100 * max(score["furthest_Nm"] for score in taken) / FULL_SCALE_NM
    return [
        *(
            Target(
                f"mean error, {s}, worst of all paths, %FS",
                max(score["error_percent"][s] for score in ours),
                limit,
                False,
            )
            for s, limit in MOST_ERROR_PERCENT.items()
        ),
        Target(
            "change of an error by a path, %FS",
            max(score["change_percent"] for score in taken),
            MOST_CHANGE_PERCENT,
            False,
        ),
        Target(
            "furthest sample from step by step, %FS", furthest_percent, MOST_FURTHEST_PERCENT, False
        ),
        Target(
            "samples with another status than step by step",
            sum(score["other_statuses"] for score in taken),
            0,
            False,
        ),
        Target("paths that refuse a filter", len(scores) - len(taken), 0, False),
    ]


def gain_error_percent(passing: Mapping[str, Any]) -> float:
    """Largest departure of a gain from 1.

    Parameters
    ----------
    passing : mapping
        A method's fidelity.

    Returns
    -------
    float
        Percent.
    """
    return 100 * max(abs(gain - 1) for gain in passing["gain"])


def largest_delay_ms(passing: Mapping[str, Any]) -> float:
    """Largest group delay, of either sign; frequencies at which nothing passes do not count.

    Parameters
    ----------
    passing : mapping
        A method's fidelity.

    Returns
    -------
    float
        Milliseconds.
    """
    return max(abs(delay) for delay in passing["delay_ms"] if delay is not None)


def _kuka_targets(scores: list[dict[str, Any]]) -> list[Target]:
    found = []
    for memory_turns, limits in (
        (KUKA_STRONG_TURNS, KUKA_STRONG),
        (KUKA_GENTLE_TURNS, KUKA_GENTLE),
    ):
        shown = {
            score["joint"]: score
            for score in scores
            if score["method"] == OURS.name
            and score["tuning"].startswith(f"memory_turns {memory_turns:g},")
        }
        for joint, (least_dB, most_percent) in zip(JOINTS, limits, strict=True):
            where = f"Med7 J{joint}, memory {memory_turns:g} turns"
            found += [
                Target(
                    f"{where}: order 2 down, dB", shown[joint]["attenuation_dB"][0], least_dB, True
                ),
                Target(
                    f"{where}: largest error, %",
                    shown[joint]["injection_error_percent"],
                    most_percent,
                    False,
                ),
                Target(
                    f"{where}: power outside the lines, dB",
                    abs(shown[joint]["outside_dB"]),
                    MOST_OUTSIDE_DB,
                    False,
                ),
            ]
    return found
