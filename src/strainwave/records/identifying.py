"""A recording in, a joint file out: the whole work of `strainwave identify`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from strainwave.identify.judgement import judge_ripple
from strainwave.identify.recording import identify_ripple
from strainwave.identify.torque_or_artefact import UNDECIDABLE
from strainwave.joint import Provenance, write_joint
from strainwave.joint.orders import order_text
from strainwave.joint.ripple_filter import RippleFilter
from strainwave.records.checks import check_survey
from strainwave.records.columns import find_columns
from strainwave.records.findings import warnings_of
from strainwave.records.gauge_watch import gauge_watch_of
from strainwave.records.gauge_words import gauge_sentences
from strainwave.records.gearing import gearing_of_both, gearing_of_motor, gearing_of_output
from strainwave.records.identified_joint import columns_of, fill_joint
from strainwave.records.identified_log import Gearing, IdentifiedLog
from strainwave.records.joint_output import check_joint_output, started_joint
from strainwave.records.layout import build_layout
from strainwave.records.method_setting import MOST_ROWS, read_excerpt
from strainwave.records.opening import open_recording
from strainwave.records.options import Options
from strainwave.records.passes import Progress, sample_rows, survey_recording, untold
from strainwave.records.reference_torque import read_reference_Nm
from strainwave.records.survey import estimated_rated_torque_Nm

if TYPE_CHECKING:
    from strainwave.identify.recording import Ripple
    from strainwave.identify.torque_or_artefact import TorqueOrArtefact
    from strainwave.joint import Joint
    from strainwave.records.columns import FoundColumn
    from strainwave.records.layout import Layout
    from strainwave.records.mapping import MappedColumn
    from strainwave.records.raw import Recording
    from strainwave.records.survey import Survey
    from strainwave.samples import Samples

#: Stands in for a ratio that is still to be found.
_PROVISIONAL = Fraction(100)


def identify_log(
    path: Path,
    out: Path,
    options: Options | None = None,
    *,
    joint_path: Path | None = None,
    reference: MappedColumn | None = None,
    command: str | None = None,
    progress: Progress = untold,
) -> IdentifiedLog:
    """Find out what a recording says of its joint, and write it to a joint file.

    Parameters
    ----------
    path : Path
        The recording: CSV or Parquet.
    out : Path
        The joint file; written whole or not at all. It may be `joint_path`, and no other file that
        is there already.
    options : Options, optional
        How the recording is read; what it leaves open the joint file says. With ``motor-angle``
        mapped beside ``angle``, the latter is the output's.
    joint_path : Path, optional
        A joint file to start from: sections that are not identified stay.
    reference : MappedColumn, optional
        The column of a reference torque sensor, by which orders are torque or artefact.
    command : str, optional
        The command line, for the provenance.
    progress : Progress
        Is told how far the work is.

    Returns
    -------
    IdentifiedLog
        What was found.

    Raises
    ------
    InputError
        If something that was given cannot be used; nothing is written then.
    """
    path, out, options = Path(path), Path(out), options or Options()
    check_joint_output(out, path, joint_path)
    joint_file = started_joint(path, joint_path)
    joint = None if joint_path is None else joint_file.joint
    recording = open_recording(path)
    reading, gearing, columns = _read(recording, options, joint, progress)
    layout = replace(reading.layout, ratio=gearing.ratio)
    # Once more with the ratio that was found: speeds and expected torque follow from it.
    survey = survey_recording(recording, layout, reading.found, progress)
    check_survey(recording.source, layout, reading.found, survey)
    rated_Nm = layout.rated_torque_Nm or estimated_rated_torque_Nm(survey)
    gauge_watch = gauge_watch_of(layout, survey, reading.found)
    samples = read_excerpt(sample_rows(recording, layout, reading.found, survey, watch=gauge_watch))
    reference_Nm = None
    if reference is not None:
        reference_Nm = read_reference_Nm(recording, layout, reference, len(samples))
    has_gear = gearing.ratio is not None and layout.rated_torque_Nm is not None
    ripple = identify_ripple(
        samples, gearing.factor, gearing.ratio, rated_Nm, may_have_load=has_gear
    )
    judged = judge_ripple(samples, reference_Nm, ripple, float(gearing.factor), rated_Nm)
    provenance = Provenance.of_file(path, command=command)
    sections = fill_joint(joint_file, layout, survey, columns, gearing, ripple, judged, provenance)
    # The file may be the one that was read, unless somebody has changed it since.
    write_joint(joint_file, out)
    warnings = (
        *warnings_of(layout, survey, rated_Nm),
        *gauge_sentences(layout, reading.found, gauge_watch),
        *gearing.says,
        *ripple.cannot_tell,
        *judged.says,
        *_kept_as_before(joint_file.joint, ripple, judged),
        *_on_the_file(survey, gearing, has_gear=has_gear),
    )
    return IdentifiedLog(
        path, out, layout, survey, rated_Nm, gearing, ripple, judged, sections, warnings
    )


@dataclass(frozen=True)
class _Reading:
    """A recording's rows under one layout."""

    layout: Layout
    found: dict[str, FoundColumn]
    samples: Samples


def _read(
    recording: Recording, options: Options, joint: Joint | None, progress: Progress
) -> tuple[_Reading, Gearing, dict[str, object]]:
    told = _told_ratio(options, joint)
    if {"angle", "motor-angle"} <= options.mapping.keys():
        motor = _rows(recording, options, joint, progress)
        kept = {key: each for key, each in options.mapping.items() if key != "motor-angle"}
        of_output = replace(
            options, mapping=kept, angle_side="output", ratio=options.ratio or _PROVISIONAL
        )
        output = _rows(recording, of_output, None, progress)
        gain = output.layout.motor_turns_per_turn
        angle_rad = output.samples.motor_angle_rad / gain
        gearing = gearing_of_both(recording.source, motor.samples, angle_rad, told)
        columns = columns_of(output.layout, output.found, recording.names)
        columns |= columns_of(motor.layout, motor.found, recording.names)
        return motor, gearing, columns
    with_ratio = options
    if told is None and _side(options, joint) == "output":
        with_ratio = replace(options, ratio=_PROVISIONAL)
    reading = _rows(recording, with_ratio, joint, progress)
    columns = columns_of(reading.layout, reading.found, recording.names)
    if reading.layout.angle_side == "motor":
        return reading, gearing_of_motor(reading.samples, told), columns
    samples = reading.samples
    angle_rad = samples.motor_angle_rad / reading.layout.motor_turns_per_turn
    samples = replace(samples, motor_angle_rad=angle_rad)
    return reading, gearing_of_output(recording.source, samples, told), columns


def _rows(
    recording: Recording, options: Options, joint: Joint | None, progress: Progress
) -> _Reading:
    layout = build_layout(options, joint)
    found = find_columns(layout.columns, recording.names, recording.column_count, recording.source)
    survey = survey_recording(recording, layout, found, progress)
    check_survey(recording.source, layout, found, survey)
    return _Reading(layout, found, read_excerpt(sample_rows(recording, layout, found, survey)))


def _told_ratio(options: Options, joint: Joint | None) -> Fraction | None:
    if options.ratio is not None or joint is None or joint.gear is None:
        return options.ratio
    return Fraction(repr(joint.gear.ratio))


def _side(options: Options, joint: Joint | None) -> str | None:
    if "motor-angle" in options.mapping:
        return "motor"
    if options.angle_side is None and joint is not None and joint.signals is not None:
        return joint.signals.angle_side
    return options.angle_side


def _on_the_file(survey: Survey, gearing: Gearing, *, has_gear: bool) -> tuple[str, ...]:
    says = []
    if survey.rows > MOST_ROWS:
        says.append(
            f"the joint is identified on the first {MOST_ROWS} of {survey.rows} rows; cut the "
            "recording if another part is the better one"
        )
    if not has_gear:
        missing = "ratio" if gearing.ratio is None else "rated torque"
        says.append(
            f"the joint file has no [gear], and the filter no load terms, as the {missing} is not "
            f"known: give --{missing.replace(' ', '-')}"
        )
    return tuple(says)


def _kept_as_before(joint: Joint, ripple: Ripple, judged: TorqueOrArtefact) -> tuple[str, ...]:
    section = joint.ripple_filter
    if not ripple.present or not isinstance(section, RippleFilter):
        return ()
    kept = [
        order_text(name)
        for name, found in zip(section.orders, ripple.present, strict=True)
        if name in section.kept_orders and judged.of(found.order).decision == UNDECIDABLE
    ]
    if not kept:
        return ()
    return (f"order {', '.join(kept)} stays kept, as the joint file has it",)
