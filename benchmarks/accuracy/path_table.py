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
REFUSED: Final = "refused"
#: Columns of numbers begin here.
FIRST_NUMBER: Final = 4


def filters_of(scores: Sequence[Mapping[str, Any]]) -> list[str]:
    """List the filters and their tunings, each once.

    Parameters
    ----------
    scores : sequence of mapping
        Fields of `benchmarks.accuracy.paths.PathScore`.

    Returns
    -------
    list of str
        In the order in which rows number them, from 1.
    """
    return list(dict.fromkeys(f"{score['method']}: {score['tuning']}" for score in scores))


def legend(scores: Sequence[Mapping[str, Any]]) -> list[str]:
    """Say what the rows' numbers stand for, and why a path refuses a filter.

    Parameters
    ----------
    scores : sequence of mapping
        Fields of `benchmarks.accuracy.paths.PathScore`.

    Returns
    -------
    list of str
        A line for each filter, and one for each reason.
    """
    reasons = dict.fromkeys(score["refused"] for score in scores if score["refused"])
    numbered = [f"{number}. {each}" for number, each in enumerate(filters_of(scores), 1)]
    return [*numbered, *(f"- {REFUSED}: {reason}" for reason in reasons)]


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
    filters = filters_of(scores)
    rows = []
    for score in scores:
        number = 1 + filters.index(f"{score['method']}: {score['tuning']}")
        head = (
            f"{number} {score['method']}",
            score["joints"],
            score["precision"],
            score["path"],
        )
        if score["refused"]:
            cells = [REFUSED] * len(SETS)
            rows.append((*head, *cells, *[""] * (len(HEADINGS) - len(head) - len(cells))))
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
    caption = "\n".join(legend(results["paths"]))
    table = Table(title=TITLE, caption=caption, box=box.SIMPLE_HEAD, pad_edge=False)
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
        *legend(results["paths"]),
        "",
        f"| {' | '.join(HEADINGS)} |",
        "|" + "---|" * FIRST_NUMBER + "---:|" * (len(HEADINGS) - FIRST_NUMBER),
        *(f"| {' | '.join(row)} |" for row in path_rows(results["paths"])),
    ]
    return "\n".join(lines) + "\n"
