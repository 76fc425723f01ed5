"""The page of one recording: what `--report` of `strainwave filter` and `identify` writes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.atomic import write_atomically
from strainwave.errors import InputError
from strainwave.report.figures_recording import both_widths, torque_figure
from strainwave.report.identified_part import identified_part
from strainwave.report.page import Item, Part, templates
from strainwave.report.recording_parts import recording_parts
from strainwave.report.recording_words import head_sentences, verdict
from strainwave.report.zoom_plot import ZoomPlot

if TYPE_CHECKING:
    from pathlib import Path

    from strainwave.evidence import Envelope, Evidence
    from strainwave.records import FilteredLog
    from strainwave.records.identified_log import IdentifiedLog

#: A recording whose time begins later than this counts from its first row: a clock, not a run.
_LONGEST_RUN_S: Final = 1e6
#: Characters of a joint file that are shown.
_MOST_JOINT_TEXT: Final = 200_000


@dataclass(frozen=True)
class RecordingPage:
    """Everything the template needs.

    Attributes
    ----------
    title : str
        Title of the page.
    sentences : tuple of str
        What a technician reads.
    verdict : str
        Whether true torque comes through; empty where nothing can be said.
    verdict_is_good : bool
        Whether it does.
    plot : ZoomPlot
        Torque before and after.
    first : Item
        The same as a picture, for print.
    parts : tuple of Part
        Sections.
    footer : str
        Last line.
    """

    title: str
    sentences: tuple[str, ...]
    verdict: str
    verdict_is_good: bool
    plot: ZoomPlot
    first: Item
    parts: tuple[Part, ...]
    footer: str


def write_recording_report(
    path: Path,
    log: FilteredLog,
    evidence: Evidence,
    command: str,
    *,
    joint_path: Path | None = None,
    identified: IdentifiedLog | None = None,
) -> None:
    """Write the page of a recording, whole or not at all.

    Parameters
    ----------
    path : Path
        The page: .html.
    log : FilteredLog
        What was done.
    evidence : Evidence
        What is known of it.
    command : str
        The command that repeats it.
    joint_path : Path, optional
        The joint file, which is shown.
    identified : IdentifiedLog, optional
        What was identified in the recording before.

    Raises
    ------
    InputError
        If the page cannot be written.
    """
    page = recording_page(
        log, evidence, command, joint_text=_text_of(joint_path), identified=identified
    )
    text = templates().get_template("recording.html.j2").render(page=page)
    # What is no text, such as half a character in a name, is shown as a question mark.
    write_atomically(path, text.encode("utf-8", errors="replace"))


def recording_page(
    log: FilteredLog,
    evidence: Evidence,
    command: str,
    *,
    joint_text: str = "",
    identified: IdentifiedLog | None = None,
) -> RecordingPage:
    """Put the page of a recording together.

    Parameters
    ----------
    log : FilteredLog
        What was done.
    evidence : Evidence
        What is known of it.
    command : str
        The command that repeats it.
    joint_text : str
        The joint file, or nothing.
    identified : IdentifiedLog, optional
        What was identified in the recording before.

    Returns
    -------
    RecordingPage
        The content.
    """
    plot = _plot(evidence.envelope)
    wide, narrow = both_widths(
        lambda width: torque_figure(evidence.envelope, plot.origin_s, plot.time_label, width)
    )
    per_point = evidence.envelope.rows_per_point
    points = "" if per_point == 1 else f" Each point spans the range of {per_point} rows."
    marks = " Marks at the bottom: rows that were not used." if evidence.rejected_rows else ""
    first = Item(
        "",
        figure=wide,
        narrow=narrow,
        caption=f"Torque as recorded and with the ripple removed.{points}{marks}",
        alternative="Torque over time, as recorded and with the ripple removed.",
    )
    said, is_good = verdict(log, evidence)
    parts = recording_parts(log, evidence, plot, command, joint_text)
    name = evidence.provenance.input
    if identified is not None:
        parts = (identified_part(identified), *parts)
    return RecordingPage(
        f"{name}: {'its joint identified, ' if identified else ''}its ripple removed",
        head_sentences(log, evidence),
        said,
        is_good,
        plot,
        first,
        parts,
        f"strainwave {evidence.provenance.version}, {evidence.provenance.created:%Y-%m-%d %H:%M} UTC",
    )


def _plot(envelope: Envelope) -> ZoomPlot:
    known = envelope.time_s[np.isfinite(envelope.time_s)]
    first_s = float(known[0]) if len(known) else 0.0
    if abs(first_s) < _LONGEST_RUN_S:
        return ZoomPlot(envelope, 0.0, "time (s)")
    return ZoomPlot(envelope, first_s, "time since the first row (s)")


def _text_of(joint_path: Path | None) -> str:
    if joint_path is None:
        return ""
    try:
        text = joint_path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise InputError(
            f"{joint_path}: it cannot be read again for the report "
            f"({(error.strerror or str(error)).lower()}); expected the joint file to stay, so repeat "
            "the command"
        ) from error
    return text[:_MOST_JOINT_TEXT]
