"""The table of paths: for the terminal and as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from rich import box
from rich.table import Table

from benchmarks.accuracy.paths import SETS, STEP_BY_STEP

TITLE: Final = "Every path through the core: error RMS in %FS, and how far from step by step"
HEADINGS: Final = (
    "filter",
    "joints",
    "precision",
    "path",
    *(f"{scenario}, mean" for scenario in SETS),
    "change of an error",
    "furthest sample, Nm",
    "other statuses",
    "chunks (repeated)",
)
#: Columns of numbers begin here.
FIRST_NUMBER: Final = 4


def path_rows(scores: Sequence[Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """Put the scores into words and digits.

    Parameters
    ----------
    scores : sequence of mapping
        Fields of `benchmarks.accuracy.paths.PathScore`.

    Returns
    -------
    list of tuple of str
        A row for each, a cell for each of `HEADINGS`.
    """
    rows = []
    for score in scores:
        head = (
            f"{score['method']}: {score['tuning']}",
            score["joints"],
            score["precision"],
            score["path"],
        )
        if score["refused"]:
            rows.append((*head, score["refused"], *[""] * (len(HEADINGS) - len(head) - 1)))
            continue
        errors = [f"{score['error_percent'][scenario]:.4f}" for scenario in SETS]
        if score["path"] == STEP_BY_STEP:
            rows.append((*head, *errors, "", "", "", ""))
            continue
        chunks = ", ".join(str(each) for each in score["chunks"])
        rows.append(
            (
                *head,
                *errors,
                f"{score['change_percent']:.1e}",
                f"{score['furthest_Nm']:.1e}",
                str(score["other_statuses"]),
                f"{chunks} ({score['repeated_chunks']})" if chunks else "",
            )
        )
    return rows


def path_table(results: Mapping[str, Any]) -> Table:
    """Lay out the paths for the terminal.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    rich.table.Table
        A row for each filter, precision and path.
    """
    table = Table(title=TITLE, box=box.SIMPLE_HEAD, pad_edge=False)
    for number, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="right" if number >= FIRST_NUMBER else "left")
    for row in path_rows(results["paths"]):
        table.add_row(*row)
    return table


def markdown_of(results: Mapping[str, Any]) -> str:
    """Write the paths as Markdown.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    str
        A table with its title.
    """
    lines = [
        f"# {TITLE}",
        "",
        "Written by `make bench-accuracy`; what it means: [the accuracy bench]"
        "(../../docs/design/accuracy-bench.md#every-path).",
        "",
        f"| {' | '.join(HEADINGS)} |",
        "|" + "---|" * FIRST_NUMBER + "---:|" * (len(HEADINGS) - FIRST_NUMBER),
        *(f"| {' | '.join(row)} |" for row in path_rows(results["paths"])),
    ]
    return "\n".join(lines) + "\n"
