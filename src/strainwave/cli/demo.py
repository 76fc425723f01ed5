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
    from strainwave.report.demo import STEPS, make_folder, write_demo
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
        f"({tally_sentence(finished.comparisons)}); open {finished.page}",
        soft_wrap=True,
    )
