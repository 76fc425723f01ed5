"""What makes a recording or a place to write to unusable; each with its sentence."""

from __future__ import annotations

import difflib
import os
import secrets
from typing import TYPE_CHECKING, Final

from strainwave.errors import InputError
from strainwave.records.moving import LARGEST_MOTOR_SPEED_RAD_S

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from pathlib import Path

    from strainwave.records.columns import FoundColumn
    from strainwave.records.layout import Layout
    from strainwave.records.survey import Survey

SHORTEST_INTERVAL_S: Final = 1e-9
OUTPUT_ENDINGS: Final = (".csv", ".parquet")
#: What a certificate holds and no other page or figure does: its block, and its title.
_CERTIFICATE_MARKS: Final = {
    ".html": b'id="strainwave-certificate"',
    ".pdf": b"Calibration certificate ",
}


def check_output(
    out: Path,
    *inputs: Path | None,
    option: str = "--out",
    endings: Sequence[str] = OUTPUT_ENDINGS,
) -> None:
    """Make sure that a result can be written, before anything is computed.

    Parameters
    ----------
    out : Path
        Where the result goes.
    *inputs : Path or None
        What is read; the result must not replace it.
    option : str
        The option that names the place.
    endings : sequence of str
        Endings that its name may have.

    Raises
    ------
    InputError
        If the name, the folder or the permission is wrong.
    """
    if out.suffix.lower() not in endings:
        raise InputError(
            f"{option} {out}: the name ends in {out.suffix!r}; expected "
            f"{' or '.join(endings)}, so choose another name"
        )
    if out.is_dir():
        raise InputError(f"{option} {out}: it is a folder; expected a file, so add a file name")
    if _is_certificate(out):
        raise InputError(
            f"{option} {out}: it is an issued certificate, which is never written over; expected a "
            "name of its own, so choose another name"
        )
    for path in inputs:
        if path is not None and os.path.realpath(out) == os.path.realpath(path):
            raise InputError(
                f"{option} {out}: it is the file that is read; expected another one, so choose "
                "another name"
            )
    folder = out.resolve().parent
    probe = folder / f".{out.name[:100]}.{secrets.token_hex(8)}.tmp"
    try:
        # Asked by doing it: permissions, full disks and read-only mounts all answer here.
        probe.touch(exist_ok=False)
        probe.unlink()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            f"{option} {out}: it cannot be written ({reason}); expected an existing folder with "
            "permission to write, so choose another place"
        ) from error


def _is_certificate(path: Path) -> bool:
    mark = _CERTIFICATE_MARKS.get(path.suffix.lower())
    try:
        return mark is not None and path.is_file() and mark in path.read_bytes()
    except OSError:
        return False


def check_method(name: str, known: Collection[str]) -> None:
    """Make sure that a method is known, before a recording is read for it.

    Parameters
    ----------
    name : str
        Its name.
    known : collection of str
        All names.

    Raises
    ------
    InputError
        If it is unknown, with the nearest names.
    """
    if name not in known:
        near = difflib.get_close_matches(name.lower(), known, n=2, cutoff=0.5)
        advice = f"did you mean {' or '.join(near)}?" if near else "check the spelling"
        raise InputError(
            f"--method {name}: it is unknown; expected one of {', '.join(known)}; {advice}"
        )


def check_survey(
    source: str, layout: Layout, found: dict[str, FoundColumn], survey: Survey
) -> None:
    """Refuse a recording that nothing sensible can be computed from.

    Parameters
    ----------
    source : str
        Its name, for messages.
    layout : Layout
        How it is read.
    found : dict
        Its columns, by key.
    survey : Survey
        What it holds.

    Raises
    ------
    InputError
        With the reason.
    """
    if survey.rows == 0:
        raise InputError(
            f"{source}: it holds no rows; expected rows of numbers, so record it again"
        )
    for key, count in survey.missing_by_key.items():
        if count == survey.rows and key in found:
            raise InputError(
                f"{source}: {found[key].label} for {key} holds no number in any of its "
                f"{survey.rows} rows; expected numbers, so map another column"
            )
    if survey.rows == 1:
        raise InputError(
            f"{source}: it holds one row; expected a recording over time, so record it again"
        )
    if "time" in layout.columns:
        _check_time(source, found["time"], survey)
    if survey.timing.median_interval_s is None:
        raise InputError(
            f"{source}: no two of its {survey.rows} rows have time stamps that differ; expected "
            "time that goes on"
        )
    if survey.timing.median_interval_s < SHORTEST_INTERVAL_S:
        raise InputError(
            f"{source}: its rows are {survey.timing.median_interval_s:.3g} s apart as a rule; "
            f"expected at least {SHORTEST_INTERVAL_S:g} s, so check the unit of time"
        )
    if survey.angle_looks_like_degrees and layout.columns["angle"].unit == "rad":
        raise InputError(
            f"{source}: {found['angle'].label} for angle goes back to its start after 360 rad; "
            "expected a turn of 6.283 rad; are the angles in degrees (then map "
            f"angle={layout.columns['angle'].column}:deg)?"
        )
    _check_speed(source, layout, found, survey)


def _check_time(source: str, column: FoundColumn, survey: Survey) -> None:
    timing = survey.timing
    if timing.backward_steps > timing.forward_steps:
        raise InputError(
            f"{source}: {column.label} for time goes backwards at {timing.backward_steps} of "
            f"{survey.rows} rows (first: row {timing.first_out_of_order_row}); expected time that "
            "goes on, so sort the rows or map another column"
        )
    if timing.forward_steps == 0:
        raise InputError(
            f"{source}: {column.label} for time is constant from row 1 to row {survey.rows}; "
            "expected time that goes on, so map another column, or none and give --rate HZ"
        )


def _check_speed(
    source: str, layout: Layout, found: dict[str, FoundColumn], survey: Survey
) -> None:
    moving = survey.moving
    typical, high = moving.typical_speed_rad_s, moving.speed_99th_percentile_rad_s
    if typical is None or high is None or high <= LARGEST_MOTOR_SPEED_RAD_S:
        return
    key = "speed" if "speed" in layout.columns else "angle"
    mapped = layout.columns[key]
    unit = {"rad": "deg", "rad/s": "deg/s"}.get(mapped.unit)
    questions = []
    if unit is not None:
        plural = "angles in degrees" if key == "angle" else "speeds in degrees a second"
        questions.append(f"are the {plural} (then map {key}={mapped.column}:{unit})?")
    if layout.angle_side == "output":
        assert layout.ratio is not None
        questions.append(
            f"is --ratio {float(layout.ratio):g} right, and was it measured on the output?"
        )
    questions.append(
        "are the time stamps in the right unit?" if "time" in found else "is --rate right?"
    )
    raise InputError(
        f"{source}: with {found[key].label} for {key} in {mapped.unit} the motor would turn at "
        f"{typical:.4g} rad/s as a rule and at {high:.4g} rad/s in one row of a hundred; expected "
        f"at most {LARGEST_MOTOR_SPEED_RAD_S:g} rad/s, as no strain wave gear turns faster: "
        + " ".join(questions)
    )
