"""`strainwave demo`: both papers on simulated stations, and the main job on a simulated joint."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

    from strainwave.report.page import PlainTable


def demo(*, out: Path = Path("demo"), json: bool = False) -> None:
    """Run both papers' experiments and the main job on simulated joints, and report on them.

    Example: strainwave demo --out demo

    Parameters
    ----------
    out : Path
        Folder for the report; it is made where it does not exist.
    json : bool
        Print the comparison as JSON.
    """
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        SpinnerColumn,
        TextColumn,
        TimeElapsedColumn,
    )
    from rich.table import Table

    from strainwave.cli.output import print_json, progress_console, result_console
    from strainwave.report.demo import STEPS, make_folder, write_demo
    from strainwave.report.demo_main_job import main_job_table
    from strainwave.reproduce.comparison import tallies, tally_sentence

    make_folder(out)
    with Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=progress_console(),
    ) as progress:
        task = progress.add_task("starting", total=len(STEPS))
        finished = write_demo(
            out,
            on_step=lambda step: progress.update(task, description=step),
            on_done=lambda: progress.advance(task),
        )
        progress.update(task, description="report written")
    agree = sum(entry.agrees for entry in finished.comparisons)
    if json:
        print_json(
            {
                "report": str(finished.page),
                "compared": len(finished.comparisons),
                "agree": agree,
                "by_kind": {
                    tally.kind: {"compared": tally.compared, "agree": tally.agree}
                    for tally in tallies(finished.comparisons)
                },
                "comparisons": [entry.as_dict() for entry in finished.comparisons],
                "main_job": [asdict(score) for score in finished.job.scores],
            }
        )
        return
    table = Table(title="Both papers, theirs beside ours (simulated stations)")
    for heading in ("source", "quantity", "paper", "here", "accepted", "kind", ""):
        table.add_column(heading, justify="right" if heading == "here" else "left")
    for entry in finished.comparisons:
        table.add_row(
            entry.source,
            entry.quantity,
            entry.published,
            entry.ours_text,
            entry.accepted_text,
            entry.kind,
            entry.verdict,
        )
    console = result_console()
    console.print(table)
    console.print(
        f"{agree} of {len(finished.comparisons)} numbers agree "
        f"({tally_sentence(finished.comparisons)})",
        soft_wrap=True,
    )
    console.print(_job_table(main_job_table(finished.job)))
    reports = ", ".join(str(out / name) for name in ("identified.html", "cleaned.html"))
    console.print(f"open {finished.page}, {reports}", soft_wrap=True)


def _job_table(table: PlainTable) -> Table:
    from rich.table import Table

    shown = Table(
        title="The main job: one recording identified, another filtered (simulated joint)"
    )
    for heading in table.headings:
        shown.add_column(heading, justify="left" if heading == table.headings[0] else "right")
    for row in table.rows:
        shown.add_row(*row)
    return shown
