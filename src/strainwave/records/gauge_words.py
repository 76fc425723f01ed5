"""What a person should know of the gauges of a recording, in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strainwave.records.gauge_watch import can_watch, turned_gauges

if TYPE_CHECKING:
    from collections.abc import Mapping

    from strainwave.records.columns import FoundColumn
    from strainwave.records.gauge_watch import GaugeWatch, LostGauge
    from strainwave.records.layout import Layout


def gauge_sentences(
    layout: Layout, columns: Mapping[str, FoundColumn], watch: GaugeWatch | None
) -> tuple[str, ...]:
    """Say what a person should know of the gauges.

    Parameters
    ----------
    layout : Layout
        How the recording is read.
    columns : mapping
        Its columns, by key.
    watch : GaugeWatch or None
        From `gauge_watch_of`, after the last row.

    Returns
    -------
    tuple of str
        A sentence each; empty where all gauges are sound, or nothing says how they should be.
    """
    if watch is None:
        if layout.chain is None or not can_watch(layout.chain.joint):
            return ()
        return (
            f"{', '.join(turned_gauges(columns))}: mapped with a minus, which no code of the converter is "
            "for, so that lost gauges are not watched for: map gauges as they were recorded, here and "
            "in `strainwave calibrate fluctuation`",
        )
    found = watch.result()
    says = []
    if found.lost is not None:
        says.append(_sentence_of(found.lost))
    if found.rows_insufficient:
        says.append(
            f"{found.rows_insufficient} row(s) have no torque, as no gains of the joint file do "
            "without what is wrong with the gauges; they hold the last one and are flagged "
            "gauges_insufficient"
        )
    if found.lost is None and found.rows_suspected:
        says.append(
            f"a gauge is wrong in {found.rows_suspected} row(s), never for long enough to be lost; "
            "the torque does without it there, flagged gauge_suspected: look for a loose contact"
        )
    if found.rows_disagree:
        says.append(
            f"the gauges do not fit each other in {found.rows_disagree} row(s), flagged "
            "gauges_disagree, and it is not one gauge alone: check that the angle counts from the "
            "zero of `strainwave calibrate fluctuation`, and calibrate again under the loads of use"
        )
    return tuple(says)


def _sentence_of(lost: LostGauge) -> str:
    when = "" if lost.log_time_s is None else f" at {lost.log_time_s:.10g} s"
    words = f"gauge {lost.gauge} is lost ({lost.fault}){when}, row {lost.row}: "
    repair = (
        "check its bond, leads and converter channel, and calibrate again after the repair "
        "(`strainwave calibrate fluctuation`)"
    )
    if not lost.goes_on:
        return (
            f"{words}no gains in the joint file do without it and the torque is not known from row "
            f"{lost.left_out_from_row} on; {repair}"
        )
    before = ""
    if lost.residual_before_Nm is not None:
        before = f" instead of {lost.residual_before_Nm:.3g} Nm"
    return (
        f"{words}the torque does without it from row {lost.left_out_from_row} on, with a fluctuation "
        f"of {lost.residual_Nm:.3g} Nm rms{before} left by the gains; {repair}"
    )
