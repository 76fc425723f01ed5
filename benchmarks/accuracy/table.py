"""The table: every method, simulated joints and the Med7 in one row; limits below it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from rich import box
from rich.table import Table

from benchmarks.accuracy.kuka import JOINTS
from benchmarks.accuracy.motion import PHASES
from benchmarks.accuracy.ripple import MISMATCH, RIGHT, SCENARIOS, TEETH
from benchmarks.accuracy.targets import Target, gain_error_percent, largest_delay_ms

#: On the Med7 the table shows each method's strongest tuning below this mean error.
KUKA_MOST_PERCENT: Final = 10.0


def main_table(results: Mapping[str, Any]) -> Table:
    """Lay out the one table.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    rich.table.Table
        A row for each method.
    """
    table = Table(
        title="Error RMS in %FS, attenuation, fidelity; Med7: order 2 down @ largest error",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    table.add_column("method", no_wrap=True)
    for heading in (
        "right\nmean",
        "mism.\nmean",
        "teeth\nmean",
        "order 2\ndB",
        "order 4\ndB",
        "gain\n1-20 Hz %",
        "delay\nms",
        "contact\nat rest %",
        "beside\nlines dB",
        *(f"Med7 J{joint}\ndB @ %" for joint in JOINTS),
    ):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, method in results["methods"].items():
        scenarios, passing = method["scenarios"], method["fidelity"]
        table.add_row(
            name,
            *(f"{scenarios[s]['error_percent']['mean']:.3f}" for s in (RIGHT, MISMATCH, TEETH)),
            # Adding 0 takes the sign off a rounded zero.
            *(f"{round(dB, 1) + 0.0:.1f}" for dB in scenarios[RIGHT]["attenuation_steady_dB"]),
            f"{gain_error_percent(passing):.3f}",
            f"{largest_delay_ms(passing):.3f}",
            f"{passing['contact_error_percent']:.3f}",
            f"{scenarios[RIGHT]['outside_dB']:.2f}",
            *_kuka_cells(results, name),
        )
    return table


def phase_table(results: Mapping[str, Any]) -> Table:
    """Lay out the errors phase by phase.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    rich.table.Table
        A row for each scenario and method.
    """
    table = Table(title="Error RMS by phase, %FS", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("scenario", no_wrap=True)
    table.add_column("method", no_wrap=True)
    for phase in (*PHASES, "mean"):
        table.add_column(phase, justify="right")
    table.add_column("tuning, chosen on another joint")
    for scenario in SCENARIOS:
        for name, method in results["methods"].items():
            found = method["scenarios"][scenario]
            table.add_row(
                scenario,
                name,
                *(f"{found['error_percent'][phase]:.3f}" for phase in (*PHASES, "mean")),
                ", ".join(f"{key} {value:.3g}" for key, value in found["tuning"].items()),
            )
        table.add_section()
    return table


def memory_table(results: Mapping[str, Any]) -> Table:
    """Lay out what the one parameter of the default filter trades for what.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    rich.table.Table
        A row for each memory.
    """
    table = Table(title="Ours by memory", box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in (
        "memory\nturns",
        *(f"{scenario}\nmean %FS" for scenario in SCENARIOS),
        "order 2\ndB",
        "order 4\ndB",
        "gain\n1-20 Hz %",
        "delay\nms",
        "contact\nat rest %",
        "the same,\nwith edges",
        "the same,\nin the log",
    ):
        table.add_column(heading, justify="right", no_wrap=True)
    for found in results["ours_by_memory"]:
        scenarios, passing = found["scenarios"], found["fidelity"]
        table.add_row(
            f"{found['tuning']['memory_turns']:g}"
            + (" with output turn" if found["tuning"].get("output_turn") else ""),
            *(f"{scenarios[s]['error_percent']['mean']:.3f}" for s in SCENARIOS),
            *(f"{dB:.1f}" for dB in scenarios[RIGHT]["attenuation_steady_dB"]),
            f"{gain_error_percent(passing):.3f}",
            f"{largest_delay_ms(passing):.3f}",
            f"{passing['contact_error_percent']:.3f}",
            f"{passing['contact_peak_percent']:.3f}",
            f"{passing['injected_error_percent']:.3f}",
        )
    return table


def coverage_table(results: Mapping[str, Any]) -> Table:
    """Lay out how often twice a candidate's deviation covers the truth.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    rich.table.Table
        A row for each scenario and candidate.
    """
    table = Table(
        title="Twice the deviation covers the truth, % (calibrated: 93 to 97 in every phase)",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    table.add_column("scenario", no_wrap=True)
    table.add_column("deviation", no_wrap=True)
    for phase in PHASES:
        table.add_column(phase, justify="right")
    for scenario, candidates in results["coverage_percent"].items():
        for name, phases in candidates.items():
            table.add_row(scenario, name, *(f"{phases[phase]:.1f}" for phase in PHASES))
    return table


def target_table(found: list[Target]) -> Table:
    """Lay out figures and limits.

    Parameters
    ----------
    found : list of Target
        From `benchmarks.accuracy.targets.targets`.

    Returns
    -------
    rich.table.Table
        A row for each.
    """
    table = Table(title="Ours against its limits", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("figure", no_wrap=True)
    table.add_column("measured", justify="right")
    table.add_column("limit", justify="right")
    table.add_column("")
    for target in found:
        sign = "≥" if target.at_least else "≤"
        table.add_row(
            target.what,
            f"{target.measured:.3g}",
            f"{sign} {target.limit:g}",
            "met" if target.met else "NOT MET",
        )
    return table


def kuka_choice(scores: list[dict[str, Any]], name: str) -> list[dict[str, Any]] | None:
    """Choose the tuning that is shown of a method on the Med7.

    Parameters
    ----------
    scores : list of dict
        All of the Med7's scores.
    name : str
        The method.

    Returns
    -------
    list of dict or None
        Scores of joints 1 to 4: the strongest tuning whose mean error is at most
        `KUKA_MOST_PERCENT`, or else the one with the least error. None where it did not run.
    """
    tunings: dict[str, list[dict[str, Any]]] = {}
    for each in scores:
        if each["method"] == name:
            tunings.setdefault(each["tuning"], []).append(each)
    if not tunings:
        return None

    def error(one: list[dict[str, Any]]) -> float:
        return float(np.mean([each["injection_error_percent"] for each in one]))

    def strength(one: list[dict[str, Any]]) -> float:
        return float(np.mean([each["attenuation_dB"][0] for each in one]))

    gentle = [one for one in tunings.values() if error(one) <= KUKA_MOST_PERCENT]
    return max(gentle, key=strength) if gentle else min(tunings.values(), key=error)


def _kuka_cells(results: Mapping[str, Any], name: str) -> list[str]:
    if results["recordings"] is None:
        return ["skipped"] * len(JOINTS)
    chosen = kuka_choice(results["recordings"]["kuka"], name)
    if chosen is None:
        return ["refused"] * len(JOINTS)
    return [
        f"{each['attenuation_dB'][0]:.1f} @ {each['injection_error_percent']:.1f}"
        for each in chosen
    ]
