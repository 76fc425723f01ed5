"""The demo's last part: the main job on a simulated joint, and the README's table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave.records.identified_log import measured_text
from strainwave.report.figures_main_job import main_job_figure
from strainwave.report.page import Item, Part, PlainTable
from strainwave.report.style import true_minus
from strainwave.walkthrough.main_job import FILTER_COMMAND, IDENTIFY_COMMAND, MEASURED, OURS

if TYPE_CHECKING:
    from strainwave.walkthrough.main_job import MainJob


def main_job_part(job: MainJob) -> Part:
    """Show the main job.

    Parameters
    ----------
    job : MainJob
        One joint, from its recording to clean torque.

    Returns
    -------
    Part
        A section of the page.
    """
    before, after = job.score(MEASURED), job.score(OURS)
    return Part(
        anchor="main-job",
        title="The main job: a recording in, clean torque out",
        paragraphs=(
            "A simulated joint is recorded for 40 s of ordinary motion, its torque 2 ms later than "
            f"its angle. {IDENTIFY_COMMAND} finds out what there is to know of it.",
            f"Another 20 s of work are then filtered: {FILTER_COMMAND}. Recordings, joint file, "
            "clean torque and both reports, identified.html and cleaned.html, are beside this page.",
        ),
        items=(
            Item(title="What was identified", table=_identified(job)),
            Item(
                title="Before and after",
                figure=main_job_figure(job),
                caption="Simulated. The true torque is the transmitted one without the mesh's "
                "ripple; the sensor's own gain error, zero and hysteresis are in what is left.",
                alternative=(
                    f"Torque with a ripple of {before.order_2_Nm:.1f} newton metres; after the "
                    f"filter it lies on the true torque, {after.error_rms_Nm:.2f} newton metres rms "
                    "away, through touches and a reversal."
                ),
                table=main_job_table(job),
            ),
            Item(title="Distance from the true torque, rms", table=_phases(job)),
        ),
    )


def main_job_table(job: MainJob) -> PlainTable:
    """Make the table of what was removed beside what was left alone.

    Parameters
    ----------
    job : MainJob
        One joint, from its recording to clean torque.

    Returns
    -------
    PlainTable
        A row for each torque.
    """
    return PlainTable(
        (
            "Torque",
            "Error, rms",
            "Ripple, order 2",
            "Ripple, order 4",
            "10 Nm touch in motion, after 20 ms",
            "10 Nm touch at rest, after 20 ms",
        ),
        tuple(
            (
                score.name,
                f"{score.error_rms_Nm:.2f} Nm",
                f"{score.order_2_Nm:.2g} Nm",
                f"{score.order_4_Nm:.2g} Nm",
                true_minus(f"{score.touch_in_motion_Nm:.2f} Nm"),
                true_minus(f"{score.touch_at_rest_Nm:.2f} Nm"),
            )
            for score in job.scores
        ),
    )


def as_markdown(table: PlainTable) -> str:
    """Write a table for the README.

    Parameters
    ----------
    table : PlainTable
        The table.

    Returns
    -------
    str
        Markdown, ending in a line feed.
    """
    rows = [table.headings, ("---",) * len(table.headings), *table.rows]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def _identified(job: MainJob) -> PlainTable:
    ripple = job.identified.ripple
    rows = [("noise", f"{ripple.noise_Nm:.3g} Nm")]
    if ripple.delay is not None:
        delay = ripple.delay
        found = measured_text(1e3 * delay.delay_s, 1e3 * delay.standard_uncertainty_s)
        rows.append(("delay of the torque", f"{found} ms"))
    if ripple.settings is not None:
        rows.append(("memory", f"{ripple.settings.config.memory_turns:g} motor turns"))
    for order in ripple.present:
        amplitude = measured_text(order.amplitude_Nm, order.amplitude_standard_uncertainty_Nm)
        rows.append((f"order {order.order:g} of the wave", f"{amplitude} Nm"))
    return PlainTable(
        ("Quantity", "Found"), tuple((name, true_minus(value)) for name, value in rows)
    )


def _phases(job: MainJob) -> PlainTable:
    return PlainTable(
        ("Phase", *(score.name for score in job.scores)),
        tuple(
            (phase, *(f"{score.by_phase_Nm[phase]:.2f} Nm" for score in job.scores))
            for phase in job.scores[0].by_phase_Nm
        ),
    )
