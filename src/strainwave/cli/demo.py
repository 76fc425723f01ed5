"""`strainwave demo`: both papers on simulated stations, and a report of theirs beside ours."""

from __future__ import annotations

from pathlib import Path


def demo(*, out: Path = Path("demo"), json: bool = False) -> None:
    """Run both papers' experiments on simulated stations and write an HTML report.

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
    from strainwave.report.demo import STEPS, write_demo

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
    missed = [entry for entry in finished.comparisons if not entry.reproduced]
    if json:
        print_json(
            {
                "report": str(finished.page),
                "reproduced": len(finished.comparisons) - len(missed),
                "compared": len(finished.comparisons),
                "comparisons": [entry.as_dict() for entry in finished.comparisons],
            }
        )
        return
    table = Table(title="Both papers, theirs beside ours (simulated stations)")
    for heading in ("source", "quantity", "paper", "here", "accepted", ""):
        table.add_column(heading, justify="right" if heading in ("paper", "here") else "left")
    for entry in finished.comparisons:
        table.add_row(
            entry.source,
            entry.quantity,
            f"{entry.published} {entry.unit}",
            f"{entry.ours:.5g} {entry.unit}",
            f"{entry.lowest:.5g} to {entry.highest:.5g}",
            "reproduced" if entry.reproduced else "MISSED",
        )
    console = result_console()
    console.print(table)
    console.print(
        f"{len(finished.comparisons) - len(missed)} of {len(finished.comparisons)} numbers "
        f"reproduced; open {finished.page}",
        soft_wrap=True,
    )
