"""`strainwave calibrate plan`: the loading sequence of a torque calibration, as a sheet."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import cyclopts

from strainwave.cli.whole import Whole

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.commissioning.loading_plan import LoadingPlan


def calibrate_plan(
    *,
    rated_torque: float,
    harmonics: Whole,
    out: Path,
    positions: Whole | None = None,
    experiments: Whole | None = None,
    temperatures: Annotated[str | None, cyclopts.Parameter(show_default=False)] = None,
    steps: Whole = 5,
    preloads: Whole = 3,
    dwell: float = 30.0,
    one_direction: bool = False,
    printable: Path | None = None,
    json: bool = False,
) -> None:
    """Plan the loads of a torque calibration: a sheet to fill in, which `calibrate torque` reads.

    Example: strainwave calibrate plan --rated-torque 40 --harmonics 2 --temperatures 5,20,35
    --out sheet.csv --printable sheet.html

    Parameters
    ----------
    rated_torque : float
        Full scale, Nm.
    harmonics : int
        Harmonics of the fluctuation: 2 N + 1 positions average them out.
    out : Path
        The sheet: .csv.
    positions : int
        Positions of the wave generator, at least 2 N + 1; so many without.
    experiments : int
        Loading experiments, at least one for each position; so many without.
    temperatures : str
        Temperatures, degrees Celsius, by commas.
    steps : int
        Load steps up to full scale.
    preloads : int
        Loadings to full scale before each direction.
    dwell : float
        Wait before each reading, s.
    one_direction : bool
        Load in the positive direction alone.
    printable : Path
        The same as a page to print: .html.
    json : bool
        Print a summary as JSON.
    """
    from strainwave.atomic import write_atomically
    from strainwave.cli.output import print_json, result_console
    from strainwave.commissioning.loading_plan import PlanOptions, make_plan, sheet_csv
    from strainwave.errors import InputError
    from strainwave.records.checks import check_output

    check_output(out, endings=(".csv",))
    if printable is not None:
        check_output(printable, option="--printable", endings=(".html",))
    if printable is not None and printable.exists():
        raise InputError(
            f"--printable {printable}: there is a file already; expected a new name, so choose "
            "another one"
        )
    if out.exists():
        raise InputError(
            f"--out {out}: there is a file already, and it may be a sheet somebody has filled in; "
            "expected a new name, so choose another one"
        )
    plan = make_plan(
        PlanOptions(
            rated_torque,
            harmonics,
            positions,
            experiments,
            _numbers(temperatures),
            steps,
            preloads,
            dwell,
            one_direction,
        )
    )
    if printable is not None:
        from strainwave.report.loading_sheet import loading_sheet_html

        write_atomically(printable, loading_sheet_html(plan, out.name).encode())
    write_atomically(out, sheet_csv(plan).encode())
    if json:
        print_json(
            {
                "positions_deg": plan.positions_deg,
                "experiments": plan.experiments,
                "rows": len(plan.rows),
                "readings": plan.readings,
                "duration_s": plan.duration_s,
                "out": str(out),
            }
        )
        return
    lines = result_console()
    for line in _table(plan, out):
        lines.print(line, soft_wrap=True, markup=False)


def _numbers(text: str | None) -> tuple[float, ...]:
    from strainwave.errors import InputError

    if text is None:
        return ()
    try:
        return tuple(float(each) for each in text.split(","))
    except ValueError as error:
        raise InputError(
            f"--temperatures {text}: expected numbers in degrees Celsius by commas, such as 5,20,35; "
            "correct this value"
        ) from error


def _table(plan: LoadingPlan, out: Path) -> Iterator[str]:
    options = plan.options
    yield (
        f"{out}: {plan.experiments} experiments, {plan.readings} readings, "
        f"{plan.duration_s / 3600:.1f} h of dwell"
    )
    degrees = ", ".join(f"{each:g}" for each in plan.positions_deg)
    yield f"  positions     {degrees} deg of the wave generator against the flexspline"
    directions = "one direction" if options.one_direction else "both directions"
    yield (
        f"  each          {directions}: {options.preloads} preloads to {options.rated_torque_Nm:g} "
        f"Nm, zero, {options.steps} steps up and down, {options.dwell_s:g} s before each reading"
    )
    if options.temperatures_degC:
        degrees = ", ".join(f"{each:g}" for each in options.temperatures_degC)
        yield f"  temperatures  {degrees} degC"
    yield "  fill in       voltage_V, and temperature_degC where it is known; then run"
    yield (
        f"                strainwave calibrate torque {out} --rated-torque "
        f"{options.rated_torque_Nm:g} --out JOINT.toml"
    )
