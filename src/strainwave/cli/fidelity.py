"""`strainwave fidelity`: what a tuning of any method does to true torque and to ripple."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

    from strainwave.fidelity import Assessment


def fidelity(
    joint: Path,
    /,
    *,
    method: str | None = None,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Say whether a tuning passes true torque or swallows it, and what it does to ripple.

    Example: strainwave fidelity shoulder.toml --out fidelity.svg

    Parameters
    ----------
    joint : Path
        The joint file; its section [ripple_filter] is the tuning.
    method : str
        Another method instead of the joint file's; an unknown name lists all.
    out : Path
        A figure of all curves: .svg, .pdf or .png.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_json, progress_console, result_console
    from strainwave.cli.reporting import check_figure
    from strainwave.errors import InputError
    from strainwave.fidelity import assess, subject_of_joint
    from strainwave.joint import read_joint

    check_figure(out, None, joint, option="--out")
    described = read_joint(joint).joint
    try:
        assessment = assess(subject_of_joint(described, method))
    except InputError as error:
        raise InputError(f"{joint}: {error}") from error
    if out is not None:
        _write_figure(assessment, described.identity.name, out)
    if json:
        print_json({"joint": str(joint), "name": described.identity.name, **assessment.as_dict()})
        return
    remarks = progress_console()
    for assumption in assessment.subject.assumptions:
        remarks.print(f"strainwave: {joint}: {assumption}", soft_wrap=True, markup=False)
    console = result_console()
    console.print(
        f"{joint}: method {assessment.subject.name} {assessment.verdict}",
        soft_wrap=True,
        markup=False,
    )
    for reason in assessment.reasons:
        console.print(f"  {reason}", soft_wrap=True, markup=False)
    console.print(_torque_table(assessment))
    console.print(_ripple_table(assessment))
    if out is not None:
        console.print(f"figure: {out}", soft_wrap=True, markup=False)


def _write_figure(assessment: Assessment, name: str, out: Path) -> None:
    from strainwave.report.figure_file import write_figure
    from strainwave.report.figures_fidelity import fidelity_figure

    write_figure(fidelity_figure(assessment, name), out)


def _torque_table(assessment: Assessment) -> Table:
    from rich.table import Table

    from strainwave.fidelity import worst_delay, worst_gain_error

    table = Table(title="True torque: worst from 1 to 20 Hz outside the notches, and a contact")
    table.add_column("motor speed")
    for heading in ("gain error", "delay", "contact after 20 ms", "contact, largest"):
        table.add_column(heading, justify="right")
    speeds = {each.motor_speed_rad_s: each for each in assessment.responses}
    for contact in assessment.contacts:
        response = speeds.get(contact.motor_speed_rad_s)
        gain_text = delay_text = ""
        if response is not None:
            gain = worst_gain_error(response, response.is_judged)
            delay = worst_delay(response, response.is_judged)
            gain_text, delay_text = "-", "-"
            if gain is not None:
                gain_text = f"{gain.value:.2%} at {gain.frequency_Hz:.1f} Hz"
            if delay is not None:
                delay_text = f"{1e3 * delay.value:.2f} ms at {delay.frequency_Hz:.1f} Hz"
        speed = contact.motor_speed_rad_s
        table.add_row(
            f"{speed:g} rad/s" if speed else "standstill",
            gain_text,
            delay_text,
            f"{contact.error_at_20_ms:.2%}",
            f"{contact.largest_error:.2%}",
        )
    return table


def _ripple_table(assessment: Assessment) -> Table:
    from rich.table import Table

    table = Table(title="Ripple: attenuation of each order, dB")
    table.add_column("order", justify="right")
    for response in assessment.responses:
        table.add_column(f"{response.motor_speed_rad_s:g} rad/s", justify="right")
    for order in assessment.subject.ripple_orders:
        values = [each.attenuation_dB[order] for each in assessment.responses]
        shown = ["-" if value is None else f"{value:.1f}" for value in values]
        table.add_row(f"{order:.6g}", *shown)
    return table
