"""`strainwave calibrate misalignment`: what a run in free motion shows over the output's angle."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import cyclopts

if TYPE_CHECKING:
    from strainwave.calibrate.misalignment_design import Gravity
    from strainwave.commissioning.misalignment_result import CommissionedMisalignment


def calibrate_misalignment(
    log: Path,
    /,
    *,
    out: Path,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)] = (),
    angle_side: Literal["motor", "output"] | None = None,
    ratio: str | None = None,
    rate: float | None = None,
    joint: Path | None = None,
    axis: Literal["vertical", "horizontal"] | None = None,
    gravity_torque: float | None = None,
    payload_mass: float | None = None,
    lever_arm: float | None = None,
    gravity: float = 9.80665,
    axis_tilt_deg: float = 0.0,
    horizontal_angle_deg: float | None = None,
    turned_run: Annotated[tuple[Path, ...], cyclopts.Parameter(show_default=False)] = (),
    turned_deg: Annotated[tuple[float, ...], cyclopts.Parameter(show_default=False)] = (),
    cycles: str | None = None,
    zero_angle_deg: float = 0.0,
    check: Path | None = None,
    json: bool = False,
) -> None:
    """Find the misalignment torque over the output's angle in a run in free motion.

    Example: strainwave calibrate misalignment free.csv --map time=t_s,angle=q:deg,torque=tau_Nm
    --angle-side output --joint joint.toml --axis vertical --out joint.toml

    Parameters
    ----------
    log : Path
        The recording, nothing touching the output: .csv, .tsv, .txt, .parquet or .pq.
    out : Path
        The joint file that is written: .toml.
    map_ : tuple of str
        Which columns are what, as for `strainwave filter`: time, angle, torque, and expected-torque
        where a model of the load gives it, gravity included.
    angle_side : {"motor", "output"}
        The side that the angle was measured on.
    ratio : str
        Motor turns per output turn.
    rate : float
        Rows a second, Hz, where the recording has no column of time.
    joint : Path
        A joint file to start from; its other sections stay.
    axis : {"vertical", "horizontal"}
        How the joint's axis stands; vertical: weight makes no torque.
    gravity_torque : float
        Largest torque of the load's weight at the output, Nm; with --horizontal-angle-deg.
    payload_mass : float
        Mass of the load, kg, in place of its torque; with --lever-arm and --horizontal-angle-deg.
    lever_arm : float
        Distance of the mass from the axis, m.
    gravity : float
        Acceleration of free fall, m/s^2.
    axis_tilt_deg : float
        Angle of the joint's axis against the horizontal, degrees.
    horizontal_angle_deg : float
        Output angle at which the weight's torque is largest, degrees.
    turned_run : tuple of Path
        Another run with the housing turned about the joint's axis; tells gravity from misalignment.
    turned_deg : tuple of float
        By how much, degrees, in the output's positive sense; one for each --turned-run.
    cycles : str
        Cycles per output turn, such as 1,2,4,8; those of 1 to 8 that the run has evidence for
        without.
    zero_angle_deg : float
        Output angle from which the map counts, degrees.
    check : Path
        A run that the map is tried on; without, the last part of a long run.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_outcome
    from strainwave.cli.repeat import command_text
    from strainwave.commissioning.gravity import Payload
    from strainwave.commissioning.misalignment import FreeMotionTask, commission_misalignment
    from strainwave.records import Options, parse_mapping, parse_ratio

    payload = Payload(payload_mass, lever_arm, gravity, axis_tilt_deg, horizontal_angle_deg)
    command = command_text(
        ("calibrate", "misalignment", log),
        {
            "--map": map_,
            "--angle-side": angle_side,
            "--ratio": ratio,
            "--rate": rate,
            "--joint": joint,
            "--axis": axis,
            "--gravity-torque": gravity_torque,
            "--payload-mass": payload_mass,
            "--lever-arm": lever_arm,
            "--gravity": None if payload_mass is None else gravity,
            "--axis-tilt-deg": axis_tilt_deg or None,
            "--horizontal-angle-deg": horizontal_angle_deg,
            "--turned-run": turned_run,
            "--turned-deg": turned_deg,
            "--cycles": cycles,
            "--zero-angle-deg": zero_angle_deg or None,
            "--check": check,
            "--out": out,
        },
    )
    task = FreeMotionTask(
        gravity=_gravity(payload, axis, gravity_torque),
        turned=_turned(turned_run, turned_deg),
        check=check,
        cycles=None if cycles is None else _cycles(cycles),
        zero_angle_deg=_degrees("--zero-angle-deg", zero_angle_deg),
    )
    options = Options(
        mapping=parse_mapping(map_),
        angle_side=angle_side,
        ratio=None if ratio is None else parse_ratio(ratio),
        rate_Hz=rate,
    )
    result = commission_misalignment(log, out, options, task, joint_path=joint, command=command)
    print_outcome(result, _summary, of=log, as_json=json)


def _gravity(payload: object, axis: str | None, torque_Nm: float | None) -> Gravity | None:
    """Take what was said of gravity, once; None where nothing was."""
    from math import isfinite, radians

    from strainwave.calibrate.misalignment_design import Gravity
    from strainwave.commissioning.gravity import Payload
    from strainwave.errors import InputError

    assert isinstance(payload, Payload)
    said = [
        name
        for name, is_said in (
            ("--axis vertical", axis == "vertical"),
            ("--gravity-torque", torque_Nm is not None),
            ("--payload-mass", payload.is_given),
        )
        if is_said
    ]
    if len(said) > 1:
        raise InputError(
            f"{' and '.join(said)}: gravity is told more than once; expected one of them, so leave "
            "out the others"
        )
    if torque_Nm is not None and not (isfinite(torque_Nm) and abs(torque_Nm) <= 1e9):
        raise InputError(
            f"--gravity-torque {torque_Nm:g}: expected a torque in Nm, up to 1e9; correct this value"
        )
    if axis == "vertical":
        return Gravity(0.0)
    amplitude_Nm = payload.largest_torque_Nm if payload.is_given else torque_Nm
    if amplitude_Nm is None:
        return None
    if amplitude_Nm != 0.0 and payload.horizontal_angle_deg is None:
        raise InputError(
            f"{said[0]} is given without --horizontal-angle-deg; expected the output angle at which "
            "the weight's torque is largest, so add it"
        )
    return Gravity(amplitude_Nm, radians(payload.horizontal_angle_deg or 0.0))


def _turned(runs: tuple[Path, ...], degrees: tuple[float, ...]) -> tuple[tuple[Path, float], ...]:
    from strainwave.errors import InputError

    if len(runs) != len(degrees):
        raise InputError(
            f"--turned-run is given {len(runs)} times and --turned-deg {len(degrees)} times; expected "
            "an angle for each run, so add what is missing"
        )
    angles = [_degrees("--turned-deg", each) for each in degrees]
    return tuple(zip(runs, angles, strict=True))


def _degrees(option: str, value: float) -> float:
    from strainwave.errors import InputError

    if not abs(value) <= 1e6:
        raise InputError(f"{option} {value:g}: expected an angle in degrees; correct this value")
    return value


def _cycles(text: str) -> tuple[int, ...]:
    from strainwave.errors import InputError

    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError as error:
        raise InputError(
            f"--cycles {text}: expected whole numbers by commas, such as 1,2,4,8; correct this value"
        ) from error


def _summary(result: CommissionedMisalignment) -> list[str]:
    from strainwave.records.identified_log import measured_text

    fit = result.fit
    lines = [
        f"{result.out}: [misalignment] from {result.path}, {fit.output_turns:.3g} output turns; gravity "
        f"{result.gravity}; {fit.residual_rms_Nm:.3g} Nm rms left"
    ]
    for term in fit.terms:
        amplitude = measured_text(term.amplitude_Nm, term.amplitude_standard_uncertainty_Nm)
        lines.append(
            f"  {term.cycles_per_output_turn} per output turn {amplitude} Nm "
            f"(cosine {term.cosine_Nm:+.4g}, sine {term.sine_Nm:+.4g})"
        )
    check = result.check
    if check is not None:
        lines.append(f"  removed {check.share_removed:.1%} of it on {result.checked_on}")
        lines += [
            f"    {term.cycles_per_output_turn} per output turn: {term.before_Nm:.3g} Nm before, "
            f"{term.after_Nm:.2g} Nm after"
            for term in check.terms
        ]
    return lines
