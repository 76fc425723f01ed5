"""The demo: both papers run, theirs beside ours; then the main job, with the README's picture."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final

from strainwave.atomic import write_atomically
from strainwave.errors import InputError
from strainwave.report.demo_godler import godler_part
from strainwave.report.demo_main_job import as_markdown, main_job_part, main_job_table
from strainwave.report.demo_taghirad import taghirad_part
from strainwave.report.demo_tuning import tuning_part
from strainwave.report.figures_main_job import main_job_figure
from strainwave.report.page import Item, Page, Part, PlainTable, Tile, all_comparisons, render
from strainwave.report.recording import write_recording_report
from strainwave.report.style import svg
from strainwave.reproduce import (
    godler2000,
    godler2000_comparison,
    taghirad1999,
    taghirad1999_comparison,
)
from strainwave.reproduce.comparison import KINDS, tallies
from strainwave.reproduce.tuning import tuning_study
from strainwave.walkthrough.main_job import FILTER_COMMAND, IDENTIFY_COMMAND, main_job

if TYPE_CHECKING:
    from collections.abc import Callable

    from strainwave.reproduce.comparison import Comparison
    from strainwave.walkthrough.main_job import MainJob

STEPS: Final = (
    "static calibration and free motion (Taghirad & Bélanger)",
    "two, four and three gauges (Godler et al.)",
    "what the published tuning does to true torque",
    "the main job: identify one recording, filter another",
    "figures and page",
)
SIGNAL_FLOW: Final = (
    "gauges -> bridge volts -> converter codes -> gains -> torque (Nm) -> ripple removed"
)


@dataclass(frozen=True)
class DemoReport:
    """What the demo wrote.

    Attributes
    ----------
    page : Path
        The HTML report.
    picture : Path
        Torque before and after, as SVG.
    comparisons : tuple of Comparison
        Every published number beside ours.
    job : MainJob
        The main job; its recordings, joint file and clean torque are in the same folder.
    """

    page: Path
    picture: Path
    comparisons: tuple[Comparison, ...]
    job: MainJob


def make_folder(folder: Path) -> None:
    """Make the folder of a report, before anything is computed for it.

    Parameters
    ----------
    folder : Path
        The folder; it may exist.

    Raises
    ------
    InputError
        If it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder}: it cannot be made a folder ({(error.strerror or str(error)).lower()}); "
            "expected a place for the report, choose another one"
        ) from error


def write_demo(
    folder: Path,
    *,
    on_step: Callable[[str], None] = lambda _: None,
    on_done: Callable[[], None] = lambda: None,
) -> DemoReport:
    """Run both papers and write the report.

    Parameters
    ----------
    folder : Path
        Where to; made where it does not exist.
    on_step : callable
        Told what begins.
    on_done : callable
        Told when a step has ended.

    Returns
    -------
    DemoReport
        What was written, and every comparison.

    Raises
    ------
    InputError
        If the folder cannot be made or written.
    """
    make_folder(folder)
    steps = iter(STEPS)
    on_step(next(steps))
    taghirad = taghirad1999.run()
    on_done()
    on_step(next(steps))
    godler = godler2000.run()
    on_done()
    on_step(next(steps))
    tuning = tuning_study()
    on_done()
    on_step(next(steps))
    job = main_job(folder)
    on_done()
    on_step(next(steps))
    parts = (
        taghirad_part(taghirad, taghirad1999_comparison.comparisons(taghirad)),
        tuning_part(tuning),
        godler_part(godler, godler2000_comparison.comparisons(godler)),
        main_job_part(job),
    )
    compared = all_comparisons(parts)
    every = _every_number(compared)
    page = folder / "report.html"
    picture = folder / "before-and-after.svg"
    write_atomically(page, render(_page((*parts, every), compared)).encode())
    write_atomically(picture, svg(main_job_figure(job)).encode())
    joint = job.identified.out
    write_recording_report(
        folder / "identified.html",
        *job.of_identified,
        IDENTIFY_COMMAND,
        joint_path=joint,
        identified=job.identified,
    )
    write_recording_report(folder / "cleaned.html", *job.of_work, FILTER_COMMAND, joint_path=joint)
    write_atomically(folder / "main-job.md", as_markdown(main_job_table(job)).encode())
    on_done()
    return DemoReport(page, picture, compared, job)


def _every_number(compared: tuple[Comparison, ...]) -> Part:
    return Part(
        anchor="all",
        title="Every number, theirs beside ours",
        paragraphs=(
            "T: Taghirad & Bélanger 1999. G: Godler et al. 2000. A number agrees where ours lies "
            "within the accepted band. The bands were chosen here, not by the papers; the reason "
            "for each stands beneath it. What an agreement is worth depends on its kind. Even what "
            "was found could be expected: the simulated fluctuation has the form of the paper's "
            "eq. (6), which the gains assume.",
        ),
        items=(
            Item(
                title="Kinds",
                table=PlainTable(
                    ("Kind", "What it means", "Compared", "Agree"),
                    tuple(
                        (tally.kind, KINDS[tally.kind], str(tally.compared), str(tally.agree))
                        for tally in tallies(compared)
                    ),
                ),
            ),
            Item(title="Comparison", comparisons=compared),
        ),
    )


def _page(parts: tuple[Part, ...], compared: tuple[Comparison, ...]) -> Page:
    agree = sum(entry.agrees for entry in compared)
    by_kind = {tally.kind: tally.compared for tally in tallies(compared)}

    def value(quantity: str) -> str:
        return next(entry for entry in compared if entry.quantity.startswith(quantity)).ours_text

    return Page(
        title="The torque sensor inside a strain wave gear: two papers, run again",
        lead=(
            "A strain wave gear carries its own torque sensor: strain gauges on the flexspline. "
            "Two papers made it work, and this page runs both again through one signal path.",
        ),
        signal_flow=SIGNAL_FLOW,
        tiles=(
            Tile(
                f"{agree} of {len(compared)}",
                f"numbers agree, mostly because the stations were made so: {by_kind['found']} "
                f"found, {by_kind['matched']} matched, {by_kind['recovered']} recovered, "
                f"{by_kind['computed']} computed",
            ),
            Tile(
                value("torque sensor gain"),
                "sensor gain from the calibration; the station was built to the paper's 6.60 Nm/V",
            ),
            Tile(
                "±" + value("fluctuation of the sum, gains adjusted"),
                "left of the fluctuation, noise aside, with three tuned gauges; the paper has about ±0.2 %FS, "
                "and the station was matched to it",
            ),
        ),
        notice="Everything on this page is simulated or computed; nothing is a measurement. "
        "Physics and electronics of the simulated stations are the papers' where they give them; "
        "what they do not give was chosen so that the published figures come out, as each preset "
        "says. The agreement therefore shows that one signal path carries both papers, not how "
        "good a real sensor is. Of each number the table at the end says whether it was found, "
        "matched, recovered or computed.",
        parts=parts,
        command="strainwave demo --out DIR",
        version=version("strainwave"),
    )
