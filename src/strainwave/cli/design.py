"""`strainwave design`: what a sensor will be worth, before anyone bonds a gauge."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import cyclopts

from strainwave.cli.whole import Whole

if TYPE_CHECKING:
    from rich.console import Console

    from strainwave.design.case import LayoutCase
    from strainwave.design.comparison import Comparison
    from strainwave.design.layout import LayoutStudy

design_app = cyclopts.App(
    name="design", help="Decide how many gauges, where, and how carefully they are bonded."
)


@design_app.command
def layout(
    *,
    gauges: Whole,
    harmonics: Whole,
    position_tolerance_deg: float = 0.0,
    amplitude_tolerance: float = 0.0,
    phase_tolerance_deg: float = 0.0,
    gauge_factor_tolerance: float = 0.0,
    radial_tolerance_mm: float = 0.0,
    angular_tolerance_deg: float = 0.0,
    trials: Whole = 100_000,
    limit_FS: Annotated[float, cyclopts.Parameter(name="--limit-FS")] = 0.5,
    wave_FS: Annotated[str | None, cyclopts.Parameter(name="--wave-FS", show_default=False)] = None,
    normal_strain_ratio: float = 1.0,
    wave_radius_exponent: float = 1.0,
    radius_mm: float = 22.0,
    measurement_error_FS: Annotated[
        float, cyclopts.Parameter(name="--measurement-error-FS")
    ] = 0.01,
    quantise: str | None = None,
    most_noise: float = 10.0,
    lost_gauge: bool = False,
    compare: bool = False,
    careless: str = "5,0.15",
    careful: str = "0.5,0.02",
    careful_gauges: Whole = 8,
    seed: Whole = 1,
    out: Path | None = None,
    json: bool = False,
) -> None:
    """Say by Monte Carlo what is left of the wave with M gauges, how noisy, and how many pass.

    Example: strainwave design layout --gauges 3 --harmonics 1 --position-tolerance-deg 5
    --amplitude-tolerance 0.15 --compare --out layout.svg

    Parameters
    ----------
    gauges : int
        M, 2 to 9, equally spaced but for their errors.
    harmonics : int
        N, 1 to 4: harmonics that the gains are solved against.
    position_tolerance_deg : float
        Standard deviation of the position, mechanical; harmonic i sees 2 i times it.
    amplitude_tolerance : float
        Of the amplitudes, relative; each harmonic of each gauge for itself.
    phase_tolerance_deg : float
        Of the phases, electrical; each harmonic of each gauge for itself.
    gauge_factor_tolerance : float
        Of the gauge factor, relative.
    radial_tolerance_mm : float
        Of the distance from the axis.
    angular_tolerance_deg : float
        Of the turn of the pad out of its +-45 degrees.
    trials : int
        Layouts that are drawn.
    limit_FS : float
        Limit of the residual, %FS zero to peak: what counts for the yield.
    wave_FS : str
        Amplitudes of harmonics 1, 2, ... in % of one gauge's signal at rated torque, as 56.7,2.8.
    normal_strain_ratio : float
        The wave's radial minus circumferential strain over its shear strain.
    wave_radius_exponent : float
        Power of the radius with which the wave's strain grows.
    radius_mm : float
        Nominal distance of the gauges from the axis.
    measurement_error_FS : float
        Standard deviation of the measured phasors, of sine and cosine each.
    quantise : str
        Gains that the circuit has: potentiometer:STEPS[:LOW:HIGH], E24, E96, or a step such as 0.001.
    most_noise : float
        Noise factor above which a layout is refused.
    lost_gauge : bool
        Study every layout with its worst gauge lost as well.
    compare : bool
        Compare 2 to 9 gauges, bonded carelessly and carefully.
    careless : str
        Position tolerance in degrees and amplitude tolerance of careless gauges.
    careful : str
        The same of careful ones.
    careful_gauges : int
        Careful gauges in the question that the comparison answers.
    seed : int
        Seed of everything random.
    out : Path
        A figure of the comparison: .svg, .pdf or .png.
    json : bool
        Print the result as JSON.
    """
    from strainwave.calibrate.circuit import parse_circuit
    from strainwave.cli.design_result import as_dict
    from strainwave.cli.output import print_json, result_console
    from strainwave.cli.reporting import check_figure
    from strainwave.design.case import LayoutCase
    from strainwave.design.checks import numbers_of_text
    from strainwave.design.comparison import Care, compare_gauge_counts
    from strainwave.design.layout import study_layout
    from strainwave.design.placement import Tolerances, Wave

    amplitudes = Wave().amplitudes_FS
    if wave_FS is not None:
        amplitudes = numbers_of_text("wave_FS", wave_FS, "amplitudes in %FS, as 56.7,2.8")
    case = LayoutCase(
        gauges=gauges,
        harmonics=harmonics,
        tolerances=Tolerances(
            position_deg=position_tolerance_deg,
            amplitude=amplitude_tolerance,
            phase_deg=phase_tolerance_deg,
            gauge_factor=gauge_factor_tolerance,
            radial_mm=radial_tolerance_mm,
            angular_deg=angular_tolerance_deg,
        ),
        wave=Wave(amplitudes, normal_strain_ratio, wave_radius_exponent),
        radius_mm=radius_mm,
        measurement_error_FS=measurement_error_FS,
        circuit=None if quantise is None else parse_circuit(quantise),
        most_noise=most_noise,
        lost_gauge=lost_gauge,
    )
    cares = Care.of_text("careless", careless), Care.of_text("careful", careful)
    check_figure(out, None, option="--out")
    study = study_layout(case, limit_FS, trials, seed)
    comparison = None
    if compare or out is not None:
        comparison = compare_gauge_counts(
            case,
            limit_FS,
            careless=cares[0],
            careful=cares[1],
            many=careful_gauges,
            trials=trials,
            seed=seed,
        )
    if out is not None and comparison is not None:
        _write_figure(comparison, out)
    if json:
        print_json(as_dict(study, comparison))
        return
    console = result_console()
    _print_study(console, study)
    _print_sensitivities(console, case)
    if comparison is not None:
        _print_comparison(console, comparison)
    if out is not None:
        console.print(f"figure: {out}", soft_wrap=True, markup=False)


def _write_figure(comparison: Comparison, out: Path) -> None:
    from strainwave.report.figure_file import write_figure
    from strainwave.report.figures_layout import layout_figure

    write_figure(layout_figure(comparison), out)


def _print_study(console: Console, study: LayoutStudy) -> None:
    from rich.table import Table

    from strainwave.design.case import assumptions, remarks

    case = study.case
    console.print(
        f"{case.gauges} gauges, {case.harmonics} harmonic(s) cancelled: {study.trials} layouts, "
        f"yield {study.tuned.met_limit:.2%} +- {study.tuned.met_limit_error:.2%} within "
        f"{study.limit_FS:g} %FS",
        soft_wrap=True,
        markup=False,
    )
    for sentence in (*assumptions(case), *remarks(case)):
        console.print(f"  {sentence}", soft_wrap=True, markup=False)
    table = Table(title="Percentiles 5 / 50 / 95 over the layouts; residual zero to peak")
    table.add_column("")
    for heading in ("residual (%FS)", "noise factor", "negative gain", "refused", "yield"):
        table.add_column(heading, justify="right")
    rows = {
        "gains tuned": study.tuned,
        "equal gains": study.untuned,
        "worst gauge lost, tuned again": study.lost_tuned,
        "worst gauge lost, equal gains": study.lost_untuned,
    }
    for name, found in rows.items():
        if found is not None:
            table.add_row(
                name,
                _three(found.residual_FS),
                _three(found.noise_factor),
                f"{found.negative_gain_share:.2%}",
                f"{found.refused_share:.2%}",
                f"{found.met_limit:.2%}",
            )
    console.print(table)
    console.print(_parts_table(study))
    if study.tuned.refused_share > 0:
        console.print(
            f"Refused: {study.tuned.refused_share:.2%} of the layouts, because their gains raise "
            f"the noise power to more than {case.most_noise:g} times that of equal gains (or "
            "cancel torque as well); they count as failed, and in the percentiles.",
            soft_wrap=True,
            markup=False,
        )


def _parts_table(study: LayoutStudy) -> object:
    from rich.table import Table

    table = Table(title="What the tuned residual consists of, %FS at percentiles 5 / 50 / 95")
    table.add_column("part")
    table.add_column("%FS", justify="right")
    number = study.case.harmonics
    names = {
        "above_N": f"harmonics above {number}: not compensated",
        "up_to_N_solved": f"harmonics up to {number}: left by the gains as solved",
        "up_to_N": f"harmonics up to {number}: left by the gains as the circuit has them",
    }
    for key, name in names.items():
        table.add_row(name, _three(study.parts_FS[key]))
    return table


def _three(values: dict[int, float]) -> str:
    return " / ".join(f"{value:.3g}" for value in values.values())


def _print_sensitivities(console: Console, case: LayoutCase) -> None:
    from rich.table import Table

    from strainwave.design.sensitivity import sensitivities

    table = Table(title="One gauge misplaced: change of torque signal and ripple, equal gains")
    table.add_column("error")
    table.add_column("per")
    table.add_column("its torque (%)", justify="right")
    table.add_column("torque of the sum (%)", justify="right")
    shown = min(2, len(case.wave.amplitudes_FS))
    for number in range(1, shown + 1):
        table.add_column(f"ripple, order {2 * number} (%FS)", justify="right")
    for each in sensitivities(case):
        table.add_row(
            each.error,
            each.per,
            f"{each.gauge_torque_percent:.3f}",
            f"{each.sum_torque_percent:.3f}",
            *(f"{ripple:.4f}" for ripple in each.ripple_FS[:shown]),
        )
    console.print(table)


def _print_comparison(console: Console, comparison: Comparison) -> None:
    from rich.table import Table

    console.print(f"{comparison.question} {comparison.verdict}", soft_wrap=True, markup=False)
    for answer in comparison.answers:
        console.print(f"  {answer}.", soft_wrap=True, markup=False)
    table = Table(
        title="Residual at the 95th percentile (%FS) and yield: careless "
        f"({comparison.careless}) and careful ({comparison.careful})"
    )
    for heading in ("M", "N", "careless, equal", "careless, tuned", "careful, equal"):
        table.add_column(heading, justify="right")
    table.add_column("careful, tuned", justify="right")
    for few, many in zip(comparison.careless_studies, comparison.careful_studies, strict=True):
        cells = [
            f"{found.residual_FS[95]:.3g} ({found.met_limit:.1%})"
            for found in (few.untuned, few.tuned, many.untuned, many.tuned)
        ]
        table.add_row(str(few.case.gauges), str(few.case.harmonics), *cells)
    console.print(table)
