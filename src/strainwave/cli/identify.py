"""`strainwave identify`: find out from a recording what a joint file needs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import cyclopts

if TYPE_CHECKING:
    from strainwave.identify.ripple_settings import RippleSettings
    from strainwave.identify.torque_or_artefact import OrderVerdict
    from strainwave.records.identified_log import IdentifiedLog


def identify_command(
    log: Path,
    /,
    *,
    out: Path,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)] = (),
    angle_side: Literal["motor", "output"] | None = None,
    ratio: str | None = None,
    rated_torque: float | None = None,
    rate: float | None = None,
    joint: Path | None = None,
    reference: Annotated[str | None, cyclopts.Parameter(allow_leading_hyphen=True)] = None,
    report: Path | None = None,
    json: bool = False,
) -> None:
    """Find ratio, orders, delay, noise, memory and terms in a recording; write a joint file.

    Example: strainwave identify run.csv --map time=t_s,angle=q:deg,torque=tau_Nm --angle-side output
    --rated-torque 100 --out joint.toml

    Parameters
    ----------
    log : Path
        The recording: .csv, .tsv, .txt, .parquet or .pq.
    out : Path
        The joint file that is written: .toml.
    map_ : tuple of str
        Which columns are what, as for `strainwave filter`; motor-angle beside angle gives both.
    angle_side : {"motor", "output"}
        The side that angle or speed was measured on.
    ratio : str
        Motor turns per output turn, roughly; refined, or searched for without.
    rated_torque : float
        Full scale, Nm.
    rate : float
        Rows a second, Hz, where the recording has no column of time.
    joint : Path
        A joint file to start from; what is not identified stays as it is there.
    reference : str
        Column of a reference torque sensor, as COLUMN[:UNIT]; decides which orders are torque.
    report : Path
        A page that shows what was found, and the recording filtered with it: .html.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_json, progress_console, result_console
    from strainwave.cli.repeat import LINE_AFTER_LINE, command_line, command_text
    from strainwave.cli.reporting import check_report
    from strainwave.records import Options, parse_ratio
    from strainwave.records.identifying import identify_log
    from strainwave.records.reference_torque import parse_with_reference

    check_report(report, out, log, joint)
    mapping, reference_column = parse_with_reference(map_, reference)
    options = Options(
        mapping=mapping,
        angle_side=angle_side,
        ratio=None if ratio is None else parse_ratio(ratio),
        rated_torque_Nm=rated_torque,
        rate_Hz=rate,
    )
    given: dict[str, object] = {
        "--map": map_,
        "--angle-side": angle_side,
        "--ratio": ratio,
        "--rated-torque": rated_torque,
        "--rate": rate,
        "--joint": joint,
        "--reference": reference,
        "--out": out,
    }
    result = identify_log(
        log,
        out,
        options,
        joint_path=joint,
        reference=reference_column,
        command=command_text(("identify", log), given),
    )
    shown = {}
    if report is not None:
        from strainwave.evidence import filter_as_identified
        from strainwave.report.recording import write_recording_report

        filtered, evidence = filter_as_identified(result, options)
        given["--report"] = report
        command = command_line(("identify", log), given, between=LINE_AFTER_LINE)
        write_recording_report(
            report, filtered, evidence, command, joint_path=out, identified=result
        )
        shown = {"report": str(report), "evidence": evidence.as_dict()}
    console = progress_console()
    for warning in result.warnings:
        console.print(f"strainwave: warning: {log}: {warning}", soft_wrap=True, markup=False)
    if json:
        print_json(result.as_dict() | shown)
        return
    lines = result_console()
    for line in _table(result):
        lines.print(line, soft_wrap=True, markup=False)
    if report is not None:
        lines.print(f"report: {report}", soft_wrap=True, markup=False)


def _table(result: IdentifiedLog) -> list[str]:
    from strainwave.records.identified_log import measured_text

    gearing, ripple = result.gearing, result.ripple
    sections = ", ".join(f"[{name}]" for name in result.sections)
    lines = [f"{result.out}: {sections} from {result.survey.rows} rows of {result.path}"]

    def row(name: str, value: str) -> None:
        lines.append(f"  {name:<14} {value}")

    ratio = "not known"
    if gearing.ratio is not None:
        spread = gearing.ratio_standard_uncertainty
        ratio = f"{float(gearing.ratio):.7g} as told"
        if spread is not None:
            ratio = measured_text(float(gearing.ratio), spread)
    row("ratio", f"{ratio}, m = {float(gearing.factor):.6g}")
    delay = ripple.delay
    row(
        "delay",
        "0 (not told)"
        if delay is None
        else f"{measured_text(1e3 * delay.delay_s, 1e3 * delay.standard_uncertainty_s)} ms",
    )
    noise = ripple.noise
    spread_Nm = noise.standard_uncertainty_Nm
    noise_text = (
        f"{noise.noise_Nm:.3g}" if not spread_Nm else measured_text(noise.noise_Nm, spread_Nm)
    )
    known = {"rest": "at rest", "innovations": "an upper bound", "standard": "not told"}
    row("noise", f"{noise_text} Nm, {known[noise.source]}")
    settings = ripple.settings
    if settings is not None:
        row(
            "memory",
            f"{settings.config.memory_turns:g} motor turns{_interval(settings)}, {settings.terms}",
        )
    for order in ripple.present:
        phase = f"phase {order.phase_rad:+.3f} rad" if order.is_steady else "phase wanders"
        row(
            f"order {order.order:g}",
            f"{measured_text(order.amplitude_Nm, order.amplitude_standard_uncertainty_Nm)} Nm, "
            f"{phase}, {_decision_text(result.judged.of(order.order))}",
        )
    for each in ripple.output_cycles:
        row(
            f"{each.cycles} per output",
            f"{measured_text(each.amplitude_Nm, each.amplitude_standard_uncertainty_Nm)} Nm, "
            "not removed",
        )
    row("rate", _rate(result))
    if result.survey.share_repeated >= 0.0005:
        row(
            "held",
            f"{result.survey.share_repeated:.1%} of the rows in motion repeat the one before",
        )
    return lines


def _decision_text(verdict: OrderVerdict) -> str:
    from strainwave.records.identified_log import measured_text

    if verdict.share is None:
        return verdict.decision
    share = measured_text(verdict.share.value, verdict.share.standard_uncertainty)
    return f"torque's share {share} by {verdict.basis}: {verdict.decision}"


def _interval(settings: RippleSettings) -> str:
    interval = settings.memory_interval_turns
    if interval is None:
        return " (not told)"
    return "" if interval[0] == interval[1] else f" ({interval[0]:g} to {interval[1]:g} do as well)"


def _rate(result: IdentifiedLog) -> str:
    from strainwave.records.identified_log import measured_text

    timing = result.survey.timing
    rate_Hz = timing.rate_Hz or 0.0
    if not result.has_time:
        return f"{rate_Hz:.7g} Hz as told"
    shortest_s, longest_s = timing.smallest_interval_s or 0.0, timing.largest_interval_s or 0.0
    return (
        f"{measured_text(rate_Hz, timing.rate_standard_uncertainty_Hz or 0.0)} Hz, rows "
        f"{1e3 * shortest_s:.4g} to {1e3 * longest_s:.4g} ms apart"
    )
