"""`strainwave calibrate fluctuation`: gains of the gauges from one recording."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import cyclopts

from strainwave.cli.whole import Whole

if TYPE_CHECKING:
    from strainwave.commissioning.fluctuation_result import FluctuationCalibration


def fluctuation(
    log: Path,
    /,
    *,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)],
    harmonics: Whole,
    out: Path,
    ratio: str | None = None,
    configuration: Literal["flexspline-fixed", "circular-spline-fixed"] | None = None,
    joint: Path | None = None,
    torque_sensitivity: str | None = None,
    quantise: str | None = None,
    fit_factor: bool = False,
    fit_delay: bool = False,
    over_grid: Literal["sum", "worst"] = "sum",
    most_noise: float = 10.0,
    without_gauge_harmonics: Whole | None = None,
    figure: Path | None = None,
    json: bool = False,
) -> None:
    """Find the gains that cancel the gauges' fluctuation; write them to a joint file.

    Example: strainwave calibrate fluctuation run.csv --map angle=beta_rad,gauges=g1_V+g2_V+g3_V
    --harmonics 1 --ratio 51 --configuration flexspline-fixed --out joint.toml

    Parameters
    ----------
    log : Path
        Gauges against the wave-generator angle, turning at about constant torque, or at several
        loads and temperatures: .csv, .tsv, .txt, .parquet or .pq.
    map_ : tuple of str
        Which columns are what: gauges (with plus signs between them); angle of the motor (found
        from three gauges or more without), time, load, temperature, experiment. Units follow a
        colon.
    harmonics : int
        How many harmonics are cancelled: 2N + 1 gauges cancel N.
    out : Path
        The joint file that is written: .toml.
    ratio : str
        Motor turns per output turn.
    configuration : {"flexspline-fixed", "circular-spline-fixed"}
        The part that is fixed; without, [gear] of --joint, or a fixed flexspline.
    joint : Path
        A joint file to start from.
    torque_sensitivity : str
        Relative torque sensitivity of every gauge, by commas; equal without.
    quantise : str
        What gains can be set to: potentiometer:STEPS[:LOW:HIGH], E24, E96, or a step such as 0.001.
    fit_factor : bool
        Take the factor m from the recording.
    fit_delay : bool
        Take the time by which the gauges lag the angle from the recording.
    over_grid : {"sum", "worst"}
        With several loads or temperatures: the least sum of squares, or the least worst residual.
    most_noise : float
        Largest noise power over that of equal gains that is accepted.
    without_gauge_harmonics : int
        How many harmonics the gains for a lost gauge cancel; as many as those of all without.
    figure : Path
        The vector diagram: .svg, .pdf or .png.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_outcome
    from strainwave.cli.repeat import command_text
    from strainwave.cli.reporting import check_figure
    from strainwave.commissioning.fluctuation import FluctuationOptions, calibrate_fluctuation
    from strainwave.records import parse_ratio

    check_figure(figure, out, log, joint)
    options = FluctuationOptions(
        mapping=map_,
        harmonics=harmonics,
        ratio=None if ratio is None else parse_ratio(ratio),
        configuration=configuration,
        torque_sensitivity=torque_sensitivity,
        quantise=quantise,
        fit_factor=fit_factor,
        fit_delay=fit_delay,
        over_grid=over_grid,
        most_noise=most_noise,
        without_gauge_harmonics=without_gauge_harmonics,
    )
    command = command_text(
        ("calibrate", "fluctuation", log),
        {
            "--map": map_,
            "--harmonics": harmonics,
            "--ratio": ratio,
            "--configuration": configuration,
            "--joint": joint,
            "--torque-sensitivity": torque_sensitivity,
            "--quantise": quantise,
            "--fit-factor": fit_factor,
            "--fit-delay": fit_delay,
            "--over-grid": None if over_grid == "sum" else over_grid,
            "--most-noise": None if most_noise == 10.0 else most_noise,
            "--without-gauge-harmonics": without_gauge_harmonics,
            "--out": out,
        },
    )

    def draw(found: FluctuationCalibration) -> None:
        if figure is not None:
            _write_figure(found, figure)

    result = calibrate_fluctuation(
        log, out, options, joint_path=joint, command=command, before_writing=draw
    )
    print_outcome(result, _table, of=log, as_json=json)


def _write_figure(result: FluctuationCalibration, figure: Path) -> None:
    from strainwave.report.figure_file import write_figure
    from strainwave.report.figures_fluctuation import fluctuation_vectors_figure

    phasors = result.mean_phasors[: result.harmonics]
    write_figure(fluctuation_vectors_figure(phasors, result.gains, "V"), figure)


def _table(result: FluctuationCalibration) -> list[str]:
    found = result.as_dict()
    rows = sum(run.rows for run in result.runs)
    lines = [f"{result.out}: [gains] from {rows} rows of {result.log}"]
    factor = "the angle is found from the gauges"
    if result.factor is not None:
        factor = f"m = {result.factor:.7g}"
        if result.timing is not None:
            factor += (
                f" (the wave shows {result.timing.factor:.7g} +- "
                f"{result.timing.factor_standard_uncertainty:.1g})"
            )
    lines.append(f"  wave           {factor}")
    if result.delay_s:
        lines.append(f"  delay          {1e3 * result.delay_s:.4g} ms")
    settings = None if result.quantised is None else result.quantised.settings
    for j, gain in enumerate(result.gains):
        spread = result.solution.standard_uncertainties[j]
        shown = f"{gain:.5f} +- {spread:.1g}" if settings is None else f"{gain:.5f}, {settings[j]}"
        sizes = ", ".join(
            f"{found['amplitudes'][i][j]:.4g} V at {found['phases_rad'][i][j]:+.3f} rad"
            for i in range(result.harmonics)
        )
        lines.append(f"  gauge {j + 1:<8} {shown}; {sizes}")
    lines.append(
        f"  worth          noise factor {result.noise_factor:.4g}, condition number "
        f"{result.solution.condition_number:.4g}"
    )
    lines += [
        f"  harmonic {i + 1:<5} {found['residual_before'][i]:.3g} V in the sum with equal gains, "
        f"{found['residual_after'][i]:.2g} +- {found['residual_standard_uncertainty'][i]:.1g} V "
        "with these"
        for i in range(result.harmonics)
    ]
    lines += [
        f"  harmonic {each['harmonic']:<5} {each['residual_after']:.3g} V, not cancelled"
        for each in found["not_cancelled"]
        if each["is_present"]
    ]
    if len(result.runs) > 1:
        lines += [
            f"  {each['name']}: {' '.join(f'{left:.3g}' for left in each['residual_after'])} V left"
            for each in found["conditions"]
        ]
    sets = result.lost_gauges.sets
    if sets:
        lost = ", ".join(str(each.gauge) for each in sets)
        worst_V = max(each["residual_rms"] for each in found["without_gauge"])
        lines.append(
            f"  lost gauge     gains without gauge {lost} are stored; they leave up to "
            f"{worst_V:.2g} V rms"
        )
    lines += [f"  lost gauge     {words}" for words in found["gauge_watch"]["missing"]]
    return lines
