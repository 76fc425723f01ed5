"""`strainwave filter`: remove the ripple from a recording, and say what was found in it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import cyclopts

if TYPE_CHECKING:
    from strainwave.records import FilteredLog
    from strainwave.records.gauge_watch import WatchedGauges


def filter_command(
    log: Path,
    /,
    *,
    out: Path,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)] = (),
    angle_side: Literal["motor", "output"] | None = None,
    ratio: str | None = None,
    joint: Path | None = None,
    method: str | None = None,
    rated_torque: float | None = None,
    rate: float | None = None,
    absolute_angle: bool = False,
    in_sequence: bool = False,
    report: Path | None = None,
    json: bool = False,
) -> None:
    """Remove the ripple from a recording in CSV or Parquet, of any length.

    Example: strainwave filter run.csv --map time=t_s,angle=q:deg,torque=tau_Nm --angle-side output
    --ratio 160 --rated-torque 100 --out clean.parquet

    Parameters
    ----------
    log : Path
        The recording: .csv, .tsv, .txt, .parquet or .pq.
    out : Path
        Where the result goes: .csv or .parquet, one row for each row of the recording.
    map_ : tuple of str
        Which columns are what: key=column[:unit] pairs by commas, with the keys time, angle, speed,
        motor-angle (beside the output's angle), torque and expected-torque, or in place of torque
        gauges (with plus signs between them) and temperature. Units are s, rad, rad/s, Nm, V and
        degC without; a minus before the column turns its sign. May be given several times.
    angle_side : {"motor", "output"}
        The side that angle or speed was measured on.
    ratio : str
        Motor turns per output turn, such as 160 or 120.5.
    joint : Path
        The joint file, which says what the options leave open.
    method : str
        How the ripple is removed; an unknown name lists all. Without, the joint file's method, else
        the ripple filter.
    rated_torque : float
        Full scale, Nm; estimated from the recording where nothing says it.
    rate : float
        Rows a second, Hz, where the recording has no column of time.
    absolute_angle : bool
        The motor's angle counts from where the output is at 0: removes the joint file's misalignment,
        which is otherwise removed only by an angle of the output.
    in_sequence : bool
        Filter row after row. A recording of more than half a million rows is otherwise filtered in
        time chunks side by side, where the method can, and the difference is said.
    report : Path
        A page that shows what was done, for a browser or to print: .html.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.memory import keep_freed_memory
    from strainwave.cli.output import print_json, progress_console, result_console
    from strainwave.cli.progress import progress_bar
    from strainwave.cli.repeat import LINE_AFTER_LINE, command_line
    from strainwave.cli.reporting import check_report
    from strainwave.records import Options, filter_log, parse_mapping, parse_ratio

    keep_freed_memory()
    check_report(report, out, log, joint)
    options = Options(
        mapping=parse_mapping(map_),
        angle_side=angle_side,
        ratio=None if ratio is None else parse_ratio(ratio),
        rated_torque_Nm=rated_torque,
        rate_Hz=rate,
        absolute_angle=absolute_angle,
    )
    console = progress_console()
    with progress_bar(console) as progress:
        evidence = None
        if report is None:
            result = filter_log(
                log,
                out,
                options,
                joint_path=joint,
                method=method,
                in_sequence=in_sequence,
                progress=progress,
            )
        else:
            from strainwave.evidence import filter_with_evidence
            from strainwave.report.recording import write_recording_report

            result, evidence = filter_with_evidence(
                log,
                out,
                options,
                joint_path=joint,
                method=method,
                in_sequence=in_sequence,
                progress=progress,
            )
            progress("drawing", 0.8)
            given = {
                "--map": map_,
                "--angle-side": angle_side,
                "--ratio": ratio,
                "--joint": joint,
                "--method": method,
                "--rated-torque": rated_torque,
                "--rate": rate,
                "--absolute-angle": absolute_angle,
                "--in-sequence": in_sequence,
                "--out": out,
                "--report": report,
            }
            command = command_line(("filter", log), given, between=LINE_AFTER_LINE)
            write_recording_report(report, result, evidence, command, joint_path=joint)
    for warning in result.warnings:
        console.print(f"strainwave: warning: {log}: {warning}", soft_wrap=True, markup=False)
    if json:
        shown = {} if evidence is None else {"report": str(report), "evidence": evidence.as_dict()}
        print_json(result.as_dict() | shown)
        return
    lines = result_console()
    for line in _summary(result):
        lines.print(line, soft_wrap=True, markup=False)
    if report is not None:
        lines.print(f"  report: {report}", soft_wrap=True, markup=False)


def _summary(result: FilteredLog) -> list[str]:
    survey = result.survey
    lines = [
        f"{result.out}: {survey.rows} rows over {survey.timing.duration_s:.4g} s at "
        f"{survey.timing.rate_Hz or 0.0:.5g} Hz, method {result.method}, rated torque "
        f"{result.rated_torque_Nm:g} Nm ({result.layout.rated_torque_source})"
    ]
    settings = result.ripple_settings
    if settings is not None:
        source = "chosen on the recording" if settings.is_chosen else "as told or standard"
        lines.append(
            f"  memory {settings.config.memory_turns:g} motor turns, {settings.terms}: {source}"
        )
    if result.misalignment_terms:
        lines.append(
            f"  misalignment of the joint file removed, {result.misalignment_terms} terms: the output's "
            "angle has to count from where it did in the commissioning run"
        )
    if result.ripple_rms_Nm is not None:
        lines.append(
            f"  torque {result.torque_before_rms_Nm:.4g} Nm rms before and "
            f"{result.torque_after_rms_Nm:.4g} Nm after; ripple {result.ripple_rms_Nm:.4g} Nm rms"
        )
    chunks = result.time_chunks
    if chunks is not None:
        lines.append(
            f"  in {chunks.count} time chunks ({chunks.repeated} filtered again): where they meet, "
            f"{chunks.rms_difference_Nm:.2g} Nm rms from --in-sequence, at most "
            f"{chunks.largest_difference_Nm:.2g} Nm"
        )
    if result.gauges is not None:
        lines.append(f"  gauges watched: {_gauges(result.gauges)}")
    flagged = [f"{name} {count}" for name, count in result.rows_by_flag.items() if count]
    lines.append(f"  rows with a flag: {', '.join(flagged) or 'none'}")
    return lines


def _gauges(found: WatchedGauges) -> str:
    lost = found.lost
    if lost is None:
        return "none is lost"
    left = "no torque since" if lost.residual_Nm is None else f"{lost.residual_Nm:.3g} Nm rms left"
    time = "" if lost.log_time_s is None else f" at {lost.log_time_s:.10g} s"
    return f"gauge {lost.gauge} lost ({lost.fault}){time}, row {lost.row}; {left}"
