"""Recordings in free motion in, ``[misalignment]`` of a joint file out."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave.calibrate.free_motion import FreeMotion, free_motion
from strainwave.calibrate.misalignment import (
    MapCheck,
    MisalignmentFit,
    check_map,
    fit_misalignment,
)
from strainwave.calibrate.misalignment_design import Gravity, GravityKnowledge, MapTerm
from strainwave.commissioning.misalignment_result import (
    CommissionedMisalignment,
    nothing_found,
    remarks_on,
)
from strainwave.errors import InputError
from strainwave.joint import Provenance, build_section, write_joint
from strainwave.records.checks import check_survey
from strainwave.records.columns import find_columns
from strainwave.records.findings import warnings_of
from strainwave.records.joint_output import check_joint_output, started_joint
from strainwave.records.layout import build_layout
from strainwave.records.method_setting import choose_wave_factor, joint_as_asked, read_excerpt
from strainwave.records.opening import open_recording
from strainwave.records.passes import sample_rows, survey_recording

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strainwave.joint import Joint
    from strainwave.records.layout import Layout
    from strainwave.records.options import Options
    from strainwave.samples import Samples

#: Rows of a recording that are read.
MOST_ROWS: Final = 2_000_000
#: A run that passes its range so many times, to and fro added up, checks itself: the map of its first
#: part on the rest.
PASSES_FOR_CHECK: Final = 3.0
FIRST_PART: Final = 0.6


#: Sine of half an angle below which a housing is not turned.
_LEAST_TURNED: Final = 1e-3


@dataclass(frozen=True)
class FreeMotionTask:
    """What is to be commissioned, and what is known beforehand.

    Attributes
    ----------
    gravity : Gravity or None
        Torque of the load's weight; None where it is not known.
    turned : tuple of (Path, float)
        More recordings, with the housing turned by so many degrees about the joint's axis, in the
        output's positive sense, against the first one.
    check : Path or None
        A recording that checks the map; without, the last part of the first one does.
    cycles : tuple of int or None
        Cycles per output turn; those with evidence without.
    zero_angle_deg : float
        Output angle from which the map counts.
    """

    gravity: Gravity | None = None
    turned: tuple[tuple[Path, float], ...] = ()
    check: Path | None = None
    cycles: tuple[int, ...] | None = None
    zero_angle_deg: float = 0.0


def commission_misalignment(
    path: Path,
    out: Path,
    options: Options,
    task: FreeMotionTask,
    *,
    joint_path: Path | None = None,
    command: str | None = None,
) -> CommissionedMisalignment:
    """Find the misalignment over the output's angle, and write it to a joint file.

    Parameters
    ----------
    path : Path
        The recording in free motion.
    out : Path
        The joint file; written whole or not at all.
    options : Options
        How recordings are read; what it leaves open the joint file says.
    task : FreeMotionTask
        What is to be found, and what is known.
    joint_path : Path, optional
        The joint file to start from.
    command : str, optional
        The command line, for the provenance.

    Returns
    -------
    CommissionedMisalignment
        What was found.

    Raises
    ------
    InputError
        If something that was given cannot be used, or nothing can be told; nothing is written then.
    """
    check_joint_output(out, path, joint_path)
    joint_file = started_joint(path, joint_path)
    joint = None if joint_path is None else joint_file.joint
    gravity = _knowledge(task)
    run, layout, remarks = _read_run(path, options, joint, 0.0)
    runs = [run]
    for turned, degrees in task.turned:
        runs.append(_read_run(turned, options, joint, math.radians(degrees))[0])
    zero_rad = math.radians(task.zero_angle_deg)
    if "expected-torque" in layout.columns and gravity == "unknown":
        gravity = Gravity(0.0)
    fit = fit_misalignment(runs, gravity, cycles=task.cycles, zero_rad=zero_rad)
    if not fit.terms:
        raise InputError(nothing_found(path, fit))
    check, checked_on, why_not = _check(run, fit, gravity, task, options, joint, zero_rad)
    section = build_section("misalignment", _section(fit, zero_rad), "what was found")
    joint_file.set_section("misalignment", section, Provenance.of_file(path, command=command))
    result = CommissionedMisalignment(
        path,
        out,
        fit,
        check,
        checked_on,
        zero_rad,
        _gravity_word(gravity),
        (*remarks, *remarks_on(runs, fit, check, layout, joint), *why_not),
    )
    write_joint(joint_file, out)
    return result


def _knowledge(task: FreeMotionTask) -> GravityKnowledge:
    if not task.turned:
        return "unknown" if task.gravity is None else task.gravity
    if task.gravity is not None:
        raise InputError(
            "--turned-run: gravity is told as well; expected one of both, so leave out --axis, "
            "--gravity-torque and --payload-mass, or the runs with the housing turned"
        )
    if all(abs(math.sin(math.radians(degrees) / 2)) < _LEAST_TURNED for _, degrees in task.turned):
        raise InputError(
            "--turned-deg: every run has the housing where the first one has it; expected at least "
            "one angle that is no multiple of 360 degrees (90 to 180 tell most), so correct it"
        )
    return "turned"


def _gravity_word(gravity: GravityKnowledge) -> str:
    if isinstance(gravity, Gravity):
        return "told" if gravity.amplitude_Nm else "none"
    return gravity


def _read_run(
    path: Path, options: Options, joint: Joint | None, mounting_rad: float
) -> tuple[FreeMotion, Layout, tuple[str, ...]]:
    # What of the torque is inertia is found, not told.
    layout = replace(build_layout(options, joint), load_inertia_kg_m2=None)
    if "angle" not in layout.columns:
        raise InputError(
            f"{path}: only a speed is mapped; expected an angle, which says where the output is, so "
            "map angle=COLUMN"
        )
    if layout.ratio is None:
        raise InputError(
            "--ratio: it is missing; the output's angle follows from the motor's by it, so add "
            "--ratio N or a [gear] in the joint file"
        )
    if layout.angle_side == "motor" and (joint is None or joint.gear is None):
        raise InputError(
            "--joint: a [gear] is missing; the angle is the motor's, and the sense in which the output "
            "turns with it is the gear's, so give a joint file with it, or map the output's angle"
        )
    recording = open_recording(path)
    found = find_columns(layout.columns, recording.names, recording.column_count, recording.source)
    survey = survey_recording(recording, layout, found)
    check_survey(recording.source, layout, found, survey)
    samples = read_excerpt(sample_rows(recording, layout, found, survey), MOST_ROWS)
    wave = choose_wave_factor(joint_as_asked(joint, options), layout.ratio, samples)
    delay_s = 0.0
    if joint is not None and joint.signals is not None:
        delay_s = joint.signals.angle_to_torque_delay_s or 0.0
    run = free_motion(
        samples.time_s,
        _output_angle(samples, layout),
        samples.torque_Nm,
        expected_torque_Nm=samples.expected_torque_Nm,
        ripple_angle_rad=float(wave.factor) * samples.motor_angle_rad,
        delay_s=delay_s,
        mounting_rad=mounting_rad,
        source=str(path),
    )
    # Full scale does not matter here, so that nothing is to be said of it.
    remarks = warnings_of(
        replace(layout, rated_torque_source="option"), survey, survey.largest_torque_Nm or 1.0
    )
    if survey.rows > MOST_ROWS:
        remarks = (*remarks, f"only the first {MOST_ROWS} of {survey.rows} rows are used")
    return run, layout, remarks


def _output_angle(samples: Samples, layout: Layout) -> np.ndarray:
    assert layout.ratio is not None
    sense = layout.output_direction if layout.angle_side == "motor" else 1
    return np.asarray(sense * samples.motor_angle_rad / float(layout.ratio))


def _check(
    run: FreeMotion,
    fit: MisalignmentFit,
    gravity: GravityKnowledge,
    task: FreeMotionTask,
    options: Options,
    joint: Joint | None,
    zero_rad: float,
) -> tuple[MapCheck | None, str | None, tuple[str, ...]]:
    of_check: GravityKnowledge = gravity
    terms: Sequence[MapTerm] = fit.terms
    if gravity == "turned":
        assert fit.gravity is not None
        of_check = Gravity(
            fit.gravity.amplitude_Nm, math.atan2(fit.gravity.sine_Nm, fit.gravity.cosine_Nm)
        )
    if task.check is not None:
        other = _read_run(task.check, options, joint, 0.0)[0]
        return check_map(other, terms, of_check, zero_rad=zero_rad), str(task.check), ()
    whole_rad = min(float(np.ptp(run.output_angle_rad)), 2 * np.pi)
    passes = float(run.travel_rad[-1]) / whole_rad
    if passes < PASSES_FOR_CHECK:
        return (
            None,
            None,
            (
                f"the map is checked on nothing: the output passed its range {passes:.2g} times, to "
                f"and fro added up, and from {PASSES_FOR_CHECK:g} on the last part checks the first; "
                "give another run with --check",
            ),
        )
    cut = int(np.searchsorted(run.travel_rad, FIRST_PART * run.travel_rad[-1]))
    cycles = [term.cycles_per_output_turn for term in terms]
    try:
        first = fit_misalignment(
            [run.part(slice(None, cut))], of_check, cycles=cycles, zero_rad=zero_rad
        )
        check = check_map(run.part(slice(cut, None)), first.terms, of_check, zero_rad=zero_rad)
    except InputError:
        return (
            None,
            None,
            (
                "the map is checked on nothing: neither part of the run tells its terms apart by "
                "itself; give another run with --check",
            ),
        )
    return check, "the last part, by the map of the first", ()


def _section(fit: MisalignmentFit, zero_rad: float) -> dict[str, Any]:
    values: dict[str, Any] = {
        "zero_of_output_angle_rad": zero_rad,
        "terms": [
            {
                "cycles_per_output_turn": term.cycles_per_output_turn,
                "cosine_Nm": term.cosine_Nm,
                "sine_Nm": term.sine_Nm,
                "standard_uncertainty_Nm": term.amplitude_standard_uncertainty_Nm,
            }
            for term in fit.terms
        ],
    }
    if fit.lowest_output_angle_rad is not None:
        values["lowest_output_angle_rad"] = fit.lowest_output_angle_rad
        values["highest_output_angle_rad"] = fit.highest_output_angle_rad
    return values
