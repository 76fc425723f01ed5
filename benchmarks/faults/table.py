"""The campaign's table in Markdown, as the documentation shows it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from scipy.stats import chi2

_HEADINGS: Final = (
    "motor",
    "fault",
    "runs",
    "found",
    "wrong gauge",
    "left out after, ms (median)",
    "lost after, ms: median / 95 % / longest",
    "error until found, %FS (95 %)",
    "error where not found, %FS (largest)",
    "gains: before -> after, %FS rms",
    "stated",
    "ripple removed: before -> at the end",
)


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _most_an_hour(events: int, hours: float) -> str:
    """Say how many an hour they can be, 95 % sure, if each comes by chance."""
    most = float(chi2.ppf(0.95, 2 * (events + 1))) / 2 / hours
    return f", at most {most:.2g} an hour (95 %)"


def markdown_of(results: Mapping[str, Any]) -> str:
    """Write the table and what sound gauges gave.

    Parameters
    ----------
    results : mapping
        From `benchmarks.faults.campaign.run_campaign`.

    Returns
    -------
    str
        Markdown.
    """
    lines = [
        "| " + " | ".join(_HEADINGS) + " |",
        "|" + "---|" * len(_HEADINGS),
    ]
    for row in results["rows"]:
        times = " / ".join(
            _number(row[key], 0) for key in ("time_median_ms", "time_95_ms", "time_largest_ms")
        )
        found = f"{100 * row['found'] / row['runs']:.0f} %"
        if row["condition"] == "rest" and row["found"] < row["runs"]:
            found += f", moving on {100 * row['found_when_moving_on'] / row['runs']:.0f} %"
        lines.append(
            f"| {row['condition']} | {row['fault']} | {row['runs']} | {found} "
            f"| {row['wrong_gauge']} | {_number(row['left_out_median_ms'], 1)} | {times} | {_number(row['error_until_found_95'], 2)} "
            f"| {_number(row['error_not_found_largest'], 2)} "
            f"| {_number(row['before'], 2)} -> {_number(row['after'], 2)} "
            f"| {_number(row['stated'], 2)} "
            f"| {_number(row['clean_before'], 2)} -> {_number(row['clean_at_last'], 2)} |"
        )
    sound = results["sound"]
    if sound:
        lines += [
            "",
            f"Sound gauges, {sound['hours']:.1f} h ({sound['rest_hours']:.1f} h of it at rest): "
            f"{sound['losses']} false losses{_most_an_hour(sound['losses'], sound['hours'])}; "
            f"{sound['suspected_samples']} samples with a suspicion.",
        ]
    return "\n".join(lines) + "\n"
