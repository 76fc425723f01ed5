"""`strainwave export`: a joint file as a C++ header and a C interface, or the proof of one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from strainwave.export import ExportedJoint


def export_command(
    joint: Path,
    /,
    *,
    out: Path | None = None,
    check: Path | None = None,
    name: str | None = None,
    precision: Literal["float", "double"] | None = None,
    json: bool = False,
) -> None:
    """Write a joint's configuration as a C++ header of constants and a C interface, or check one.

    Example: strainwave export elbow.toml --out firmware/joint

    Example: strainwave export elbow.toml --check firmware/joint/elbow.hpp

    Parameters
    ----------
    joint : Path
        The joint file, with [gear], [gauges], [torque_calibration], [ripple_filter] and, for the
        ripple filter, the sampling rate in [signals].
    out : Path
        Existing folder for NAME.hpp, strainwave_joint.h and strainwave_joint.cpp; files of an earlier
        export are replaced.
    check : Path
        A header that was exported; exit code 0 where it and the joint file agree, else 2.
    name : str
        Name of the header and its namespace; the joint's own name without.
    precision : {"float", "double"}
        Type of the real numbers; float without, and with --check that of the header.
    json : bool
        Print the result as JSON.
    """
    from strainwave.errors import InputError
    from strainwave.export import check_header, exported, rendered, write_source
    from strainwave.joint import read_joint

    if (out is None) == (check is None):
        raise InputError(
            "expected either --out DIR, to write the header, or --check HEADER, to hold one against "
            "the joint file; give one of them"
        )
    content = read_joint(joint).joint
    try:
        if check is not None:
            agreement = check_header(content, check, name=name, precision=precision)
            _say(joint, agreement.joint, list(agreement.files), "agrees", json=json)
            return
        ready = exported(content, name=name, precision=precision or "float")
    except InputError as error:
        raise InputError(f"{joint}: {error}") from error
    assert out is not None
    files = write_source(rendered(ready), out)
    _say(joint, ready, files, "written", json=json)


def _say(path: Path, ready: ExportedJoint, files: list[Path], what: str, *, json: bool) -> None:
    from strainwave.cli.output import print_json, result_console

    values = ready.values
    room = "pairs" if values.filter == "ripple" else "orders"
    if json:
        result: dict[str, Any] = {
            "joint": str(path),
            "name": ready.joint_name,
            "namespace": f"strainwave::joints::{ready.identifier}",
            "hash": ready.joint_hash,
            "checksum": f"{ready.checksum:08x}",
            "version": ready.version,
            "precision": ready.precision,
            "filter": values.filter,
            "gauges": values.gauges,
            room: values.capacity,
            "has_monitor": values.config.monitor is not None,
            "has_learned": values.learned is not None,
            "state_bytes": ready.state_bytes,
            "learned_words": ready.learned_words,
            "header": str(files[0]),
            "files": [str(file) for file in files],
            "result": what,
        }
        print_json(result)
        return
    lines = result_console()
    for line in (
        f"{files[0]}: {what}, joint {ready.joint_name!r}, {ready.precision}, hash {ready.joint_hash}",
        f"  {values.gauges} gauges, {values.filter} filter with {values.capacity} {room}, "
        f"{'a' if values.config.monitor is not None else 'no'} gauge monitor, "
        f"{'with' if values.learned is not None else 'without'} learned coefficients",
        f"  checksum {ready.checksum:08x}, at most {ready.state_bytes} bytes of state",
        *(f"  {file}: {what}" for file in files[1:]),
    ):
        lines.print(line, soft_wrap=True, markup=False)
