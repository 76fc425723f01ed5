"""The sections of a recording's page: figures with their words, and tables."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from strainwave.evidence.contacts import CONTACT_SHARE
from strainwave.report.figures_orders import (
    MOST_ORDERS,
    contact_title,
    contacts_figure,
    orders_figure,
)
from strainwave.report.figures_recording import both_widths, map_figure, spectrum_figure
from strainwave.report.page import Item, Part, PlainTable
from strainwave.report.recording_words import (
    change_text,
    fidelity_beside,
    number_text,
    sentences,
    share_text,
)
from strainwave.report.style import true_minus

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.evidence import Contact, Evidence, FlaggedRows
    from strainwave.records import FilteredLog
    from strainwave.report.zoom_plot import ZoomPlot


def recording_parts(
    log: FilteredLog, evidence: Evidence, plot: ZoomPlot, command: str, joint_text: str
) -> tuple[Part, ...]:
    """Build all sections of a filtered recording.

    Parameters
    ----------
    log : FilteredLog
        What was done.
    evidence : Evidence
        What is known of it.
    plot : ZoomPlot
        Says how time is counted.
    command : str
        The command that repeats it.
    joint_text : str
        The joint file, or nothing.

    Returns
    -------
    tuple of Part
        The sections, in order.
    """
    return (
        _ripple_part(evidence),
        _speed_part(evidence),
        _orders_part(evidence, plot),
        _fidelity_part(evidence),
        _rows_part(evidence, plot),
        _settings_part(log, evidence, command, joint_text),
    )


def _ripple_part(evidence: Evidence) -> Part:
    items = [Item("Each order", table=_orders_table(evidence), paragraphs=_on_table(evidence))]
    spectrum = evidence.spectrum
    if spectrum is not None:
        wide, narrow = both_widths(lambda width: spectrum_figure(spectrum, evidence.lines, width))
        gaps = ""
        if spectrum.windows_with_gaps:
            gaps = f" {spectrum.windows_with_gaps} windows with gaps in the angle were left out."
        items.append(
            Item(
                "Order spectrum",
                figure=wide,
                narrow=narrow,
                caption="Amplitude (zero to peak) against cycles per motor turn: root mean square "
                f"over {spectrum.windows} windows of at least {number_text(spectrum.window_turns)} "
                "motor turns in one direction. A single line is as wide as "
                f"{number_text(4 / spectrum.window_turns)} orders. Where the rows of some "
                f"windows are too far apart for an order, the others are shown.{gaps} "
                f"{fidelity_beside(evidence)}",
                alternative="Order spectrum before and after; the removed orders are marked.",
            )
        )
    warning = "" if spectrum is not None else _TOO_SHORT
    return Part("ripple", "Ripple", _looked_at(evidence), warning, tuple(items))


_TOO_SHORT = (
    "The motor never turns three turns in one direction without a gap: there is no order spectrum."
)


def _looked_at(evidence: Evidence) -> tuple[str, ...]:
    if evidence.rows_looked_at == evidence.rows:
        return ()
    return (
        f"Orders, maps and contacts are those of the first {evidence.rows_looked_at} of "
        f"{evidence.rows} rows; torque over time and the rows that were not used are those of the "
        "whole recording.",
    )


def _orders_table(evidence: Evidence) -> PlainTable:
    rows = [
        (
            f"{line.order:.6g}",
            number_text(line.before_rms_Nm),
            number_text(line.after_rms_Nm),
            change_text(line.change_dB),
            number_text(line.noise_Nm),
            "kept: real torque"
            if line.is_kept
            else "removed"
            if line.is_told
            else "only looked at",
        )
        for line in evidence.lines
    ]
    rows += [
        (f"{order:.6g}", *4 * ("\N{EN DASH}",), "not told apart")
        for order in evidence.orders_not_told
    ]
    headings = ("Order", "Before (Nm)", "After (Nm)", "Change", "Noise reads (Nm)", "")
    return PlainTable(headings, tuple(rows), numeric=(1, 2, 3, 4))


def _on_table(evidence: Evidence) -> tuple[str, ...]:
    if not evidence.lines:
        return (
            "No order can be measured: that takes windows of at least three motor turns in one "
            "direction.",
        )
    line = evidence.lines[0]
    text = [
        "Orders count cycles per motor turn. Amplitudes are zero to peak, root mean square over "
        f"{len(line.time_s)} windows of at least {number_text(line.window_turns)} motor turns, by "
        "least squares beside a slow torque, the time in which the filter learns included. What "
        f"noise alone would read stands beside them. {fidelity_beside(evidence)}"
    ]
    if evidence.orders_not_told:
        text.append(
            "Orders that are not told apart lie too close to slow torque, or to one another, for "
            "windows of this length, or turn too fast for the rate of the rows."
        )
    return tuple(text)


def _speed_part(evidence: Evidence) -> Part:
    speed_map = evidence.speed_map
    if speed_map is None:
        return Part("speed", "Order against speed", (_TOO_SHORT,))
    wide, narrow = both_widths(lambda width: map_figure(speed_map, evidence.lines, width))
    filled = int((speed_map.windows > 0).sum())
    item = Item(
        "",
        figure=wide,
        narrow=narrow,
        caption=f"Amplitude against motor speed and order, from {int(speed_map.windows.sum())} "
        f"windows of at least {number_text(speed_map.window_turns)} motor turns in {filled} {'bin' if filled == 1 else 'bins'} of "
        "speed; grey where the recording has none, and where the rows are too far apart. The darkest "
        "colour stands for a three hundredth of the highest amplitude and all below. What lies "
        "level belongs to the angle; what bends with speed does not. Marks at the left: the orders "
        f"of the table. {fidelity_beside(evidence)}",
        alternative="Amplitude against speed and order, before and after.",
    )
    return Part("speed", "Order against speed", items=(item,))


def _orders_part(evidence: Evidence, plot: ZoomPlot) -> Part:
    title = "Each order over time and load"
    lines = (*evidence.removed, *(line for line in evidence.lines if line.is_kept))
    if not lines:
        return Part("orders", title, ("There is no order to show; see above.",))
    wide, narrow = both_widths(
        lambda width: orders_figure(lines, plot.origin_s, plot.time_label, width)
    )
    shown = ""
    if len(lines) > MOST_ORDERS:
        shown = f" The {MOST_ORDERS} strongest of {len(lines)} orders are drawn."
    item = Item(
        "",
        figure=wide,
        narrow=narrow,
        caption="One pair of points for each window of travel. Load is the mean of the torque "
        f"without ripple in the window.{shown} {fidelity_beside(evidence)}",
        alternative="Amplitude of each order over time and against load, before and after.",
    )
    return Part("orders", title, items=(item,))


def _fidelity_part(evidence: Evidence) -> Part:
    title = "What came through of true torque"
    if not evidence.contacts:
        text = "The recording has no stretch of motion or rest long enough to add a contact to."
        return Part("fidelity", title, (text,))
    wide, narrow = both_widths(lambda width: contacts_figure(evidence.contacts, width))
    headings = ("Added", "At (s)", "Torque (Nm)", "Wrong after 20 ms", "Largest error")
    table = PlainTable(
        headings, tuple(_contact_row(each) for each in evidence.contacts), numeric=(1, 2, 3, 4)
    )
    item = Item(
        "",
        figure=wide,
        narrow=narrow,
        caption="Grey: torque that was added to this recording. Blue: what the output shows more "
        "than without it. Errors count in parts of the contact's height.",
        alternative="Contacts that were added, and what came through of each.",
        table=table,
    )
    how = (
        f"Torque of {100 * CONTACT_SHARE:g} % of the rated torque is added to the recording, one "
        "contact at a time, and the same method with the same settings runs over it again from its "
        "first row. Rows that repeat the row before repeat the contact too, and rows that are not "
        "used do not count."
    )
    near = [each for each in evidence.contacts if each.is_near_order]
    remark = (
        "At the speeds the motor has meanwhile, the push comes within 0.3 order of a removed order: no "
        "filter that removes that order can let all of it pass.",
    )
    return Part("fidelity", title, (how, *(remark if near else ())), items=(item,))


def _contact_row(contact: Contact) -> tuple[str, ...]:
    return (
        contact_title(contact),
        f"{contact.begins_s:.7g}",
        number_text(contact.height_Nm),
        share_text(contact.error_at_20_ms),
        share_text(contact.largest_error),
    )


def _rows_part(evidence: Evidence, plot: ZoomPlot) -> Part:
    title = "Rows that were not used, and remarks"
    if not evidence.flags:
        return Part("rows", title, ("Every row was used, and there is nothing to remark.",))
    headings = ("Flag", "Rows", "Share", "", "Where first", "What it means")
    rows = tuple(_flag_row(each, evidence.rows, plot.origin_s) for each in evidence.flags)
    text = (
        "Rows count from 1. A row may bear more than one flag. The flags are bits of the column "
        "status in the result."
    )
    return Part("rows", title, (text,), items=(Item("", table=PlainTable(headings, rows, (1, 2))),))


def _flag_row(flagged: FlaggedRows, rows: int, origin_s: float) -> tuple[str, ...]:
    places = []
    for stretch in flagged.stretches[:3]:
        last = "" if stretch.last_row == stretch.first_row else f"\N{EN DASH}{stretch.last_row}"
        time_s = stretch.first_time_s - origin_s
        at = f" ({true_minus(f'{time_s:.6g}')} s)" if math.isfinite(time_s) else ""
        places.append(f"{stretch.first_row}{last}{at}")
    more = ", \N{HORIZONTAL ELLIPSIS}" if len(flagged.stretches) > len(places) else ""
    return (
        flagged.name,
        str(flagged.rows),
        share_text(flagged.rows / rows),
        flagged.kind,
        ", ".join(places) + more,
        flagged.meaning,
    )


def _settings_part(log: FilteredLog, evidence: Evidence, command: str, joint_text: str) -> Part:
    result = log.as_dict()
    origin = evidence.provenance
    about = {
        "recording": origin.input,
        "SHA-256 of the recording": origin.input_sha256,
        "rows": log.survey.rows,
        "rate_Hz": result["rate_Hz"],
        "method": log.method,
        "rated_torque_Nm": f"{log.rated_torque_Nm:g} ({log.layout.rated_torque_source})",
        **result["settings"],
        **{
            name: result[name]
            for name in ("torque_before_rms_Nm", "torque_after_rms_Nm", "ripple_rms_Nm")
        },
        "version of strainwave": origin.version,
        "report made": f"{origin.created:%Y-%m-%d %H:%M} UTC",
    }
    items = [
        Item("The command that repeats it", code=command),
        Item("Settings", table=_values_table(about)),
        Item("What the recording holds", table=_values_table(result["survey"]), is_folded=True),
    ]
    if joint_text:
        items.append(Item("The joint file", code=joint_text, is_folded=True))
    if log.warnings:
        items.insert(0, Item("Warnings", paragraphs=sentences(log.warnings)))
    return Part("settings", "Warnings, settings, and how to repeat it", items=tuple(items))


def _values_table(values: dict[str, Any]) -> PlainTable:
    rows = tuple((name, text) for name, value in values.items() for text in _texts(value))
    return PlainTable(("What", "Value"), rows)


def _texts(value: Any) -> Iterator[str]:
    if value is None:
        yield "none"
    elif isinstance(value, bool):
        yield "yes" if value else "no"
    elif isinstance(value, float):
        yield true_minus(f"{value:.9g}")
    elif isinstance(value, list):
        yield ", ".join(true_minus(f"{each:.9g}") for each in value) or "none"
    elif isinstance(value, dict):
        yield json.dumps(value)
    else:
        yield str(value)
