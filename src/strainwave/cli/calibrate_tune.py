"""`strainwave calibrate tune`: which potentiometer to turn, which way and how far."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import cyclopts

from strainwave.cli.whole import Whole

if TYPE_CHECKING:
    from strainwave.commissioning.tune_result import Tuning


def tune(
    *runs: Path,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)],
    gauge_gains: tuple[str, ...],
    harmonics: Whole = 1,
    ratio: str | None = None,
    configuration: Literal["flexspline-fixed", "circular-spline-fixed"] | None = None,
    joint: Path | None = None,
    torque_sensitivity: str | None = None,
    potentiometer: str | None = None,
    until: float | None = None,
    json: bool = False,
) -> None:
    """Say from short runs which potentiometer to turn until the fluctuation is gone from the sum.

    Example: strainwave calibrate tune a.csv b.csv --map angle=beta_rad,sum=sum_V
    --gauge-gains 1,1,1 --gauge-gains 1,1,0.9

    Parameters
    ----------
    runs : Path
        Recordings in the order they were taken, the last one with the present settings. The angle
        counts from the same zero in all.
    map_ : tuple of str
        Which columns are what: angle, and either sum or gauges (with plus signs between them,
        each before its potentiometer).
    gauge_gains : tuple of str
        Settings of the potentiometers in each run, as gains by commas; once where all runs have
        the same.
    harmonics : int
        How many harmonics are cancelled.
    ratio : str
        Motor turns per output turn.
    configuration : {"flexspline-fixed", "circular-spline-fixed"}
        The part that is fixed; without, [gear] of --joint, or a fixed flexspline.
    joint : Path
        A joint file with gear, converter and torque sensitivities; it is not changed.
    torque_sensitivity : str
        Relative torque sensitivity of every gauge, by commas; equal without.
    potentiometer : str
        STEPS or STEPS:LOW:HIGH, where potentiometers have steps.
    until : float
        Amplitude at which the line is gone, V; without, -60 dB of a gauge's or the noise.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_outcome
    from strainwave.commissioning.tune import TuneOptions, guide_tuning
    from strainwave.errors import InputError
    from strainwave.records import parse_ratio

    if not runs:
        raise InputError("no run is given; expected at least one recording, so name its file")
    options = TuneOptions(
        mapping=map_,
        harmonics=harmonics,
        gauge_gains=gauge_gains,
        ratio=None if ratio is None else parse_ratio(ratio),
        configuration=configuration,
        torque_sensitivity=torque_sensitivity,
        potentiometer=potentiometer,
        until=until,
    )
    result = guide_tuning(runs, options, joint_path=joint)
    print_outcome(result, lambda found: _lines(found, [str(run) for run in runs]), as_json=json)


def _lines(result: Tuning, names: list[str]) -> list[str]:
    lines = []
    for name, left, spread in zip(names, result.left, result.standard_uncertainties, strict=True):
        shown = ", ".join(f"{a:.3g} +- {u:.1g}" for a, u in zip(left, spread, strict=True))
        lines.append(f"{name}: {shown} V left")
    if result.is_done:
        gone = float(result.left[-1].max()) <= result.threshold
        why = f"below {result.threshold:.2g} V" if gone else "as far as these steps go"
        return [*lines, f"The line is gone, {why}: nothing to turn."]
    for turn in result.advice.turns:
        way = "up" if turn.change > 0 else "down"
        setting = f", to {result.steps[turn.gauge - 1]}" if result.steps else ""
        lines.append(
            f"Turn potentiometer {turn.gauge} {way} by {abs(turn.change):.4f}: gain from "
            f"{turn.now:.4f} to {turn.then:.4f}{setting}."
        )
    if result.advice.is_trial:
        lines.append(
            f"Record again and give all runs: {result.advice.runs_missing} more setting(s) are "
            "needed to tell the gauges apart."
        )
    elif result.expected is not None:
        shown = ", ".join(f"{left:.2g}" for left in result.expected)
        lines.append(f"Then {shown} V should be left; record again to see.")
    return lines
