"""`strainwave calibrate torque`: known loads and volts to gain, zero, curve and their uncertainty."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import cyclopts

from strainwave.cli.whole import Whole

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.calibrate.uncertainty import Budget
    from strainwave.commissioning.torque_result import TorqueCalibrated, TorqueFit


def calibrate_torque_command(
    loads: Path,
    /,
    *,
    out: Path,
    map_: Annotated[tuple[str, ...], cyclopts.Parameter(name="--map", show_default=False)] = (),
    joint: Path | None = None,
    rated_torque: float | None = None,
    ratio: str | None = None,
    configuration: Literal["flexspline-fixed", "circular-spline-fixed"] | None = None,
    harmonics: Whole = 2,
    load_uncertainty: float | None = None,
    resolution: float | None = None,
    through_origin: bool = False,
    figure: Path | None = None,
    json: bool = False,
) -> None:
    """Calibrate torque from known loads: gain, zero, curve, and how far they can be trusted.

    Example: strainwave calibrate torque loads.csv --map load=load_Nm,voltage=bridge_V,experiment=run
    --map position=beta_deg:deg --rated-torque 40 --out joint.toml

    Parameters
    ----------
    loads : Path
        The table of readings, or a filled sheet of `strainwave calibrate plan`.
    out : Path
        The joint file that is written: .toml.
    map_ : tuple of str
        Which columns are what, KEY=COLUMN[:UNIT]: load, voltage, experiment, position, temperature,
        direction, mounting, phase, axial-force, radial-force, tilting-moment. Not needed for a sheet.
    joint : Path
        A joint file to start from; other sections stay as they are there.
    rated_torque : float
        Full scale, Nm, where the joint file does not say it.
    ratio : str
        Motor turns per output turn, for [gear] in a new joint file.
    configuration : {"flexspline-fixed", "circular-spline-fixed"}
        The part that is fixed, for [gear] in a new joint file.
    harmonics : int
        Harmonics of the fluctuation that the positions have to average out.
    load_uncertainty : float
        Standard uncertainty of the loads, percent of the load.
    resolution : float
        Smallest step of the voltage readings, V.
    through_origin : bool
        Fit lines through the origin, as Taghirad & Belanger do.
    figure : Path
        A figure of residuals and gains: .svg, .pdf or .png.
    json : bool
        Print the result as JSON.
    """
    from strainwave.cli.output import print_outcome
    from strainwave.cli.repeat import command_text
    from strainwave.cli.reporting import check_figure
    from strainwave.commissioning.torque_calibration import TorqueOptions, calibrate_torque
    from strainwave.records import parse_ratio

    check_figure(figure, out, loads, joint)
    options = TorqueOptions(
        map_,
        rated_torque,
        None if ratio is None else float(parse_ratio(ratio)),
        configuration,
        harmonics,
        through_origin,
        load_uncertainty,
        resolution,
    )
    command = command_text(
        ("calibrate", "torque", loads),
        {
            "--map": map_,
            "--joint": joint,
            "--rated-torque": rated_torque,
            "--ratio": ratio,
            "--configuration": configuration,
            "--harmonics": None if harmonics == 2 else harmonics,
            "--load-uncertainty": load_uncertainty,
            "--resolution": resolution,
            "--through-origin": through_origin,
            "--out": out,
        },
    )

    def draw(found: TorqueCalibrated) -> None:
        if figure is not None:
            _write_figure(found, figure)

    result = calibrate_torque(
        loads, out, options, joint_path=joint, command=command, before_writing=draw
    )
    print_outcome(result, _table, of=loads, as_json=json)


def _write_figure(result: TorqueCalibrated, figure: Path) -> None:
    from strainwave.report.figure_file import write_figure
    from strainwave.report.figures_calibrate_torque import torque_calibration_figure

    write_figure(torque_calibration_figure(result.fit), figure)


def _table(result: TorqueCalibrated) -> Iterator[str]:
    fit = result.fit
    sections = ", ".join(f"[{name}]" for name in result.sections)
    yield (
        f"{result.out}: {sections} from {len(fit.loadings)} readings in {len(fit.lines)} "
        f"experiment{'s' if len(fit.lines) > 1 else ''} of {result.path}"
    )
    yield from _gain(fit)
    yield from _errors(fit)
    yield from _drift(fit)
    yield from _budget("gain", fit.gain_budget, "Nm/V")
    yield from _budget(
        "torque at full scale, read once at another position", fit.torque_budget, "%FS"
    )
    yield from _experiments(fit)


def _row(name: str, value: str) -> str:
    return f"  {name:<18} {value}"


def _gain(fit: TorqueFit) -> Iterator[str]:
    gain, u = fit.gain_Nm_per_V, fit.gain_budget.combined
    known = (
        f"{u:.2g} Nm/V ({100 * u / abs(gain):.2g} %)" if fit.gain_budget.components else "not told"
    )
    yield _row("gain", f"{gain:.5g} Nm/V, standard uncertainty {known}")
    yield _row("zero", f"{fit.zero_V:.4g} V")
    scatter = fit.scatter
    if scatter is not None:
        yield _row(
            "consistency",
            f"{100 * scatter.consistency:.3g} % over {len(fit.lines)} experiments; 95 % confidence "
            f"{100 * scatter.consistency_low:.2g} to {100 * scatter.consistency_high:.2g} %",
        )
        interval = fit.prediction_interval()
        assert interval is not None
        yield _row(
            "another position",
            f"gain {interval[0]:.4g} to {interval[1]:.4g} Nm/V with 95 % "
            f"(+-{100 * scatter.prediction_95:.2g} %)",
        )
    origin = fit.origin_scatter
    if origin is not None and not fit.through_origin:
        yield _row(
            "through the origin",
            f"gain {origin.gain_Nm_per_V:.5g} Nm/V, consistency {100 * origin.consistency:.3g} %",
        )
    order = len(fit.linearisation.curve.coefficients) + 1
    words = "straight line"
    if order > 1:
        terms = ", ".join(
            f"c{n} = {c:.4g}" for n, c in enumerate(fit.linearisation.curve.coefficients, 2)
        )
        words = f"order {order}: {terms}{'' if fit.coefficients else ' (not written)'}"
    yield _row("curve", words)


def _errors(fit: TorqueFit) -> Iterator[str]:
    import numpy as np

    errors = fit.errors
    full = "rated torque" if fit.is_rated else "largest load"
    yield _row("full scale", f"{fit.full_scale_Nm:g} Nm, the {full}")
    for name, values in (
        ("linearity error", errors.linearity_Nm),
        ("hysteresis", errors.hysteresis_Nm),
        ("reversibility", errors.reversibility_Nm),
        ("zero return", errors.zero_return_Nm),
        ("repeatability", errors.repeatability_Nm),
        ("reproducibility", errors.reproducibility_Nm),
        ("interpolation", fit.interpolation_error_Nm),
        ("total error", fit.total_error_Nm),
    ):
        finite = np.abs(np.atleast_1d(values))
        finite = finite[np.isfinite(finite)]
        told = f"{fit.percent(float(finite.max())):.3g} %FS" if len(finite) else "not told"
        yield _row(name, told)


def _drift(fit: TorqueFit) -> Iterator[str]:
    from strainwave.commissioning.torque_result import crosstalk_dict

    drift = fit.drift
    if drift is not None:
        yield _row(
            "temperature",
            f"gain {1e6 * drift.gain_per_K:+.3g} +- {1e6 * drift.gain_standard_error_per_K:.2g} "
            f"ppm/K, zero {1e3 * drift.zero_V_per_K:+.3g} +- "
            f"{1e3 * drift.zero_standard_error_V_per_K:.2g} mV/K from "
            f"{drift.reference_degC:.4g} degC, {drift.lowest_degC:g} to {drift.highest_degC:g} degC",
        )
    for each in fit.position_dependence:
        yield _row(
            f"harmonic {each.harmonic}",
            f"gain +-{100 * each.gain_amplitude:.2g} %, zero "
            f"+-{fit.percent(abs(fit.gain_Nm_per_V) * each.zero_amplitude_V):.2g} %FS over the "
            "positions",
        )
    for what, found in (("positions", fit.over_positions), ("mountings", fit.over_mountings)):
        if found is not None:
            yield _row(
                what,
                f"gain scatters by {100 * found.within:.2g} % within and {100 * found.between:.2g} "
                f"% between {found.groups}; by their means u = "
                f"{100 * found.of_groups.standard_uncertainty:.2g} %, another one "
                f"+-{100 * found.of_groups.prediction_95:.2g} %",
            )
    for side in fit.crosstalk:
        told = crosstalk_dict(fit, side)
        yield _row(
            side.name,
            f"{told['sensitivity']:.3g} +- {told['standard_uncertainty']:.2g} {told['unit']}, "
            f"{told['error_at_largest_FS']:.2g} %FS at {told['largest_applied']:g}",
        )


def _budget(of: str, budget: Budget, unit: str) -> Iterator[str]:
    import math

    from strainwave.calibrate.uncertainty import freedom_text

    if not budget.components:
        return
    yield f"uncertainty of the {of}"
    for part in budget.components:
        freedom = part.degrees_of_freedom
        degrees = "known" if math.isinf(freedom) else freedom_text(f"{freedom:g}")
        yield f"  {part.standard_uncertainty:10.3g} {unit:<5} {part.kind}  {part.name} ({degrees})"
    freedom = budget.degrees_of_freedom
    degrees = "" if math.isinf(freedom) else ", " + freedom_text(f"{freedom:.3g}")
    yield (
        f"  {budget.combined:10.3g} {unit:<5}    combined{degrees}; expanded (95 %, "
        f"k = {budget.coverage_factor:.3g}) {budget.expanded:.3g} {unit}"
    )


def _experiments(fit: TorqueFit) -> Iterator[str]:
    import numpy as np

    loadings = fit.loadings
    yield "experiments"
    heading = f"  {'name':<12} {'Nm/V':>9} {'zero V':>10} {'linear %FS':>11} {'hyst. %FS':>10}"
    heading += f" {'loads Nm':>15}"
    heading += "" if loadings.position_rad is None else f" {'deg':>7}"
    yield heading + ("" if loadings.temperature_degC is None else f" {'degC':>6}")

    def shown(value_Nm: float) -> str:
        return f"{fit.percent(value_Nm):.3f}" if np.isfinite(value_Nm) else "-"

    for index, name in enumerate(loadings.names):
        loads = loadings.load_Nm[loadings.experiment == index]
        line = f"  {name:<12} {fit.gains_Nm_per_V[index]:9.4f} {fit.zeros_V[index]:10.4f}"
        line += f" {shown(fit.errors.linearity_Nm[index]):>11}"
        line += f" {shown(fit.errors.hysteresis_Nm[index]):>10}"
        line += f" {f'{loads.min():g} to {loads.max():g}':>15}"
        if loadings.position_rad is not None:
            line += f" {np.degrees(loadings.position_rad[index]):7.1f}"
        if loadings.temperature_degC is not None:
            line += f" {loadings.temperature_degC[index]:6.1f}"
        yield line
