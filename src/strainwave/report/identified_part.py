"""The section of a page that says what was identified, how sure it is, and what was not told."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave.records.identified_log import measured_text
from strainwave.report.page import Item, Part, PlainTable
from strainwave.report.recording_words import number_text, sentences, with_plus_minus
from strainwave.report.style import true_minus

if TYPE_CHECKING:
    from strainwave.identify.orders import FoundOrder
    from strainwave.identify.torque_or_artefact import OrderVerdict
    from strainwave.records.identified_log import IdentifiedLog

_SOURCES = {
    "line": "the line of the ripple's order 2",
    "angles": "both angles, one against the other",
    "told": "as told",
    "unknown": "not known",
}
_NOISE = {
    "rest": "differences at rest",
    "innovations": "the filter's innovations: an upper bound",
    "standard": "not told: a share of the rated torque",
}
_FULL_SCALE = {
    "option": "as told",
    "joint file": "as told in the joint file",
    "estimated": "estimated: the largest torque, rounded up",
}
_DASH = "\N{EN DASH}"


def identified_part(result: IdentifiedLog) -> Part:
    """Build the section on what was identified.

    Parameters
    ----------
    result : IdentifiedLog
        What was found.

    Returns
    -------
    Part
        Quantities with uncertainty and source, orders with their evidence, and what the recording
        does not tell.
    """
    items = [
        Item(
            "",
            table=PlainTable(("What", "Value", "Where it comes from"), tuple(_quantities(result))),
        ),
        _orders(result),
    ]
    if result.judged.verdicts:
        items.append(_torque_or_artefact(result))
    if result.ripple.output_cycles:
        items.append(_cycles(result))
    if result.warnings:
        says = sentences(result.warnings)
        items.append(Item("What it does not tell, and what to know", paragraphs=says))
    sections = ", ".join(f"[{name}]" for name in result.sections)
    text = (
        f"Written to {result.out.name}: {sections}. Uncertainties are standard uncertainties. "
        "Everything else on this page shows the recording filtered with that file."
    )
    return Part("identified", "What was identified", (text,), items=tuple(items))


def _measured(value: float, uncertainty: float | None) -> str:
    text = f"{value:.7g}" if uncertainty is None else measured_text(value, uncertainty)
    return true_minus(with_plus_minus(text))


def _quantities(result: IdentifiedLog) -> list[tuple[str, str, str]]:
    gearing, ripple, settings = result.gearing, result.ripple, result.ripple.settings
    ratio = _DASH
    if gearing.ratio is not None:
        ratio = _measured(float(gearing.ratio), gearing.ratio_standard_uncertainty)
    delay, delay_source = "0 (not told)", "does not show in this recording"
    if ripple.delay is not None:
        delay = _measured(1e3 * ripple.delay.delay_s, 1e3 * ripple.delay.standard_uncertainty_s)
        delay, delay_source = f"{delay} ms", "likelihood of the filter's innovations"
    memory, chosen, terms = _DASH, "no order stands out", "none"
    if settings is not None:
        memory = f"{settings.config.memory_turns:g} motor turns"
        chosen = "likelihood, 3 to 160 turns tried"
        if not settings.is_chosen:
            chosen = "standard: too little motion to choose"
        interval = settings.memory_interval_turns
        if interval is not None and interval[0] != interval[1]:
            memory += f" ({interval[0]:g} to {interval[1]:g} do as well)"
        terms = str(settings.terms)
    tried = "load, speed and direction, tried by likelihood where there are turns enough"
    noise = result.ripple.noise
    survey = result.survey
    return [
        ("ratio R", ratio, _SOURCES.get(gearing.source, gearing.source)),
        ("factor m", f"{float(gearing.factor):.7g}", "with the ratio"),
        (
            "sense of the output",
            {1: "as the motor", -1: "against the motor"}.get(gearing.output_direction, "not told"),
            "both angles, where they are there",
        ),
        ("delay of the torque behind the angle", delay, delay_source),
        (
            "noise of one sample",
            f"{_measured(noise.noise_Nm, noise.standard_uncertainty_Nm)} Nm",
            _NOISE[noise.source],
        ),
        ("memory", memory, chosen),
        ("terms", terms, tried),
        (
            "rated torque",
            f"{result.rated_torque_Nm:g} Nm",
            _FULL_SCALE[result.layout.rated_torque_source],
        ),
        ("motor turns", number_text(ripple.motor_turns), "the angle"),
        (
            "rows that repeat the row before",
            f"{100 * survey.share_repeated:.3g} %",
            "rows in motion",
        ),
    ]


def _orders(result: IdentifiedLog) -> Item:
    headings = ("Order", "Amplitude (Nm)", "Phase (rad)", "Evidence", "There?")
    rows = tuple(_order_row(each) for each in result.ripple.orders)
    if not rows:
        return Item("Orders", paragraphs=("No order could be looked at in this recording.",))
    text = (
        "Cycles per turn of the wave (per motor turn, over m). Evidence is the logarithm of the "
        "likelihood that an order gains, less what its coefficients cost: it is there where that is "
        "above 0. Where the phase wanders, the amplitude is a root mean square."
    )
    return Item("Orders", paragraphs=(text,), table=PlainTable(headings, rows, (1, 2, 3)))


def _order_row(order: FoundOrder) -> tuple[str, ...]:
    return (
        f"{order.order:g}",
        _measured(order.amplitude_Nm, order.amplitude_standard_uncertainty_Nm),
        true_minus(f"{order.phase_rad:+.3f}") if order.is_steady else "wanders",
        true_minus(f"{order.evidence:.1f}"),
        "yes" if order.is_present else "no",
    )


def _torque_or_artefact(result: IdentifiedLog) -> Item:
    headings = (
        "Order",
        "Decision",
        "Torque's share",
        "Torque (Nm)",
        "Artefact (Nm)",
        "By, and why",
    )
    text = (
        "An order whose torque has a share above one half is real torque and kept, one below is "
        "removed; one that is undecidable is removed, unless an earlier file keeps it. What the file "
        "says stands in the table of orders under Ripple."
    )
    rows = tuple(_verdict_row(each) for each in result.judged.verdicts)
    return Item("Torque or artefact", paragraphs=(text,), table=PlainTable(headings, rows))


def _verdict_row(verdict: OrderVerdict) -> tuple[str, ...]:
    share = verdict.share
    return (
        f"{verdict.order:g}",
        verdict.decision,
        _DASH if share is None else _measured(share.value, share.standard_uncertainty),
        _measured_or_dash(verdict.torque_Nm, verdict.torque_standard_uncertainty_Nm),
        _measured_or_dash(verdict.artefact_Nm, verdict.artefact_standard_uncertainty_Nm),
        "; ".join(text for text in (verdict.basis, verdict.reason) if text) or _DASH,
    )


def _measured_or_dash(value: float | None, uncertainty: float | None) -> str:
    return _DASH if value is None else _measured(value, uncertainty)


def _cycles(result: IdentifiedLog) -> Item:
    rows = tuple(
        (str(each.cycles), _measured(each.amplitude_Nm, each.amplitude_standard_uncertainty_Nm))
        for each in result.ripple.output_cycles
    )
    text = "Gravity and misalignment; reported, not removed."
    table = PlainTable(("Cycles per output turn", "Amplitude (Nm)"), rows, (1,))
    return Item("Torque that repeats with the output", paragraphs=(text,), table=table)
