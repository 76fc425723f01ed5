"""What a person should know of a torque calibration before trusting it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.fluctuation import minimum_gauges
from strainwave.calibrate.locked_positions import count_positions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.commissioning.torque_fit import FitOptions
    from strainwave.commissioning.torque_result import TorqueFit
    from strainwave.commissioning.torque_table import LoadTable

#: Shares of a harmonic that pass for zero and gain, from which on that is said.
LARGEST_ALIAS: Final = 0.05
FEWEST_EXPERIMENTS: Final = 4
_HALF: Final = 0.5
_LEVEL: Final = 0.05
_LISTED: Final = 5


def warnings_of(table: LoadTable, fit: TorqueFit, options: FitOptions) -> tuple[str, ...]:
    """Say what is doubtful.

    Parameters
    ----------
    table : LoadTable
        What was read.
    fit : TorqueFit
        What was found.
    options : FitOptions
        What the fit was told.

    Returns
    -------
    tuple of str
        Sentences; empty where nothing is.
    """
    return (
        *table.remarks,
        *_units(table, fit),
        *_loads(fit),
        *_experiments(fit),
        *_positions(fit, options.harmonics),
        *_temperature(table, fit),
        *_curve(fit, options),
        *_outliers(table, fit),
        *_side_loads(fit),
    )


def _units(table: LoadTable, fit: TorqueFit) -> Iterator[str]:
    loadings = fit.loadings
    largest = loadings.largest_load_Nm
    if fit.is_rated and largest >= 100.0 * fit.full_scale_Nm:
        yield (
            f"the largest load, {largest:g} Nm, is {largest / fit.full_scale_Nm:.0f} times the "
            "rated torque: check its unit, such as load=COLUMN:mNm"
        )
    elif fit.is_rated and largest > 1.5 * fit.full_scale_Nm:
        yield (
            f"the largest load, {largest:g} Nm, is {largest / fit.full_scale_Nm:.3g} times the "
            "rated torque: check its unit and --rated-torque"
        )
    volts = float(np.max(np.abs(loadings.voltage_V)))
    if volts > 100.0:
        yield (
            f"the largest voltage is {volts:g} V: check its unit, such as voltage=COLUMN:mV for "
            "millivolts"
        )
    positions = loadings.position_rad
    if positions is not None and table.position_unit == "rad":
        farthest = float(np.max(np.abs(positions)))
        if farthest > 4 * np.pi:
            yield (
                f"the positions reach {farthest:g} rad, more than two turns: check their unit, "
                "such as position=COLUMN:deg"
            )
    temperatures = loadings.temperature_degC
    if temperatures is not None and float(np.max(temperatures)) > 150.0:
        yield (
            f"the temperatures reach {np.max(temperatures):g} degC: check their unit, such as "
            "temperature=COLUMN:K"
        )


def _loads(fit: TorqueFit) -> Iterator[str]:
    load = fit.loadings.load_Nm
    lowest, highest = float(load.min()), float(load.max())
    smallest = 2e-3 * fit.loadings.largest_load_Nm
    if lowest > -smallest or highest < smallest:
        with_zero = [line.gain_Nm_per_V for line in fit.lines]
        origin = [line.gain_Nm_per_V for line in fit.origin_lines]
        if fit.through_origin:
            says = "and lines through the origin turn any zero error into a gain error"
        elif not origin:
            says = "where a line through the origin would give no gain at all"
        else:
            off = 100.0 * (float(np.mean(origin)) / float(np.mean(with_zero)) - 1.0)
            says = (
                f"where a line through the origin would give a gain {off:+.2f} % off the one "
                "with a zero of its own, which was used"
            )
        yield (
            f"only one direction was loaded, {says}; gain and zero of the other direction are "
            "not known: load both"
        )
    if fit.is_rated:
        for name, end in (("positive", highest), ("negative", -lowest)):
            if smallest < end < _HALF * fit.full_scale_Nm:
                yield (
                    f"{name} loads reach {end:g} Nm, {100 * end / fit.full_scale_Nm:.0f} % of the "
                    "rated torque: under half of the range is calibrated in that direction"
                )
    if not np.any(np.isfinite(fit.errors.linearity_Nm)):
        yield "no experiment has three different loads: linearity cannot be told"
    if not np.any(np.isfinite(fit.errors.hysteresis_Nm)):
        yield (
            "no load was reached from below and from above in one experiment: hysteresis cannot be "
            "told; load up and down"
        )


def _experiments(fit: TorqueFit) -> Iterator[str]:
    count = len(fit.lines)
    if count == 1:
        yield (
            "there is one experiment only: how far its gain holds at other positions cannot be "
            "told, and its uncertainty is that of the residuals alone; repeat the loading at other "
            "positions"
        )
    elif count < FEWEST_EXPERIMENTS:
        scatter = fit.scatter
        assert scatter is not None
        low, high = sorted((abs(scatter.consistency_low), abs(scatter.consistency_high)))
        yield (
            f"{count} experiments are too few to know their scatter: the consistency measure lies "
            f"between {100 * low:.2g} and {100 * high:.2g} % with 95 % confidence; "
            f"make {FEWEST_EXPERIMENTS} or more"
        )
    for what, found in (("position", fit.over_positions), ("mounting", fit.over_mountings)):
        if found is not None and found.p_value < _LEVEL:
            of_groups = found.of_groups
            yield (
                f"the {count} experiments were made at {found.groups} {what}s, and gains scatter "
                f"by {100 * found.between:.2g} % between {what}s and {100 * found.within:.2g} % "
                f"within: counted by {what}s, the gain has a standard uncertainty of "
                f"{100 * of_groups.standard_uncertainty:.2g} %, and another {what} may differ by "
                f"{100 * of_groups.prediction_95:.2g} % (95 %)"
            )


def _positions(fit: TorqueFit, harmonics: int) -> Iterator[str]:
    positions = fit.loadings.position_rad
    fewest = minimum_gauges(harmonics)
    if positions is None:
        yield (
            "no positions of the wave generator are told: the fluctuation may pass for zero and "
            f"gain; lock it at {fewest} or more positions equally spread over 180 degrees, and map "
            "position"
        )
        return
    count = count_positions(positions)
    if count < fewest:
        yield (
            f"the wave generator was locked at {count} position{'s' if count > 1 else ''}, and "
            f"{fewest} tell {harmonics} harmonics of the fluctuation from zero and gain: plan "
            f"{fewest} equally spread over 180 degrees"
        )
    for number, share in enumerate(fit.alias_shares, 1):
        if share > LARGEST_ALIAS:
            yield (
                f"the positions are not spread equally over 180 degrees: {100 * share:.0f} % of "
                f"harmonic {number} of the fluctuation ({2 * number} cycles a turn) passes for "
                "zero and gain"
            )


def _temperature(table: LoadTable, fit: TorqueFit) -> Iterator[str]:
    if fit.loadings.temperature_degC is None:
        return
    if table.temperature_span_K > 2.0:
        yield (
            f"the temperature changed by up to {table.temperature_span_K:.2g} K within an "
            "experiment: its mean was taken; let the sensor settle, or make experiments of its "
            "parts"
        )
    drift = fit.drift
    if drift is None:
        yield (
            "the drift with temperature cannot be told: expected three or more experiments at "
            "temperatures that differ by 2 K or more"
        )
        return
    for name, is_told in (("gain", drift.gain_is_told), ("zero", drift.zero_is_told)):
        if not is_told:
            yield (
                f"the drift of the {name} with temperature is not told from none (5 % level): it "
                "is written as 0"
            )


def _curve(fit: TorqueFit, options: FitOptions) -> Iterator[str]:
    order = len(fit.linearisation.curve.coefficients) + 1
    if order > 1 and not fit.coefficients:
        why = (
            "lines pass the origin"
            if options.through_origin
            else "it is relative to the rated torque, and no [gear] says it; give --joint with "
            "[gear], or --rated-torque, --ratio and --configuration"
        )
        yield f"a polynomial of order {order} fits better than a line and is not written: {why}"


def _outliers(table: LoadTable, fit: TorqueFit) -> Iterator[str]:
    worst = fit.outlying_experiment
    if worst is not None:
        yield (
            f"the gain of experiment {fit.loadings.names[worst]}, "
            f"{fit.gains_Nm_per_V[worst]:.5g} Nm/V, stands out (Grubbs' test, 5 %); it was kept: "
            "look for the reason and repeat it"
        )
    names = np.array(fit.loadings.names)
    rows = table.rows[np.isin(np.array(table.loadings.names)[table.loadings.experiment], names)]
    found = rows[fit.outlying_rows]
    if len(found):
        shown = ", ".join(str(row) for row in found[:_LISTED])
        more = f" and {len(found) - _LISTED} more" if len(found) > _LISTED else ""
        yield (
            f"row{'s' if len(found) > 1 else ''} {shown}{more} stand{'' if len(found) > 1 else 's'}"
            " out from the other readings of the experiment (5 % over all readings); kept: check "
            "load, voltage and sign"
        )


def _side_loads(fit: TorqueFit) -> Iterator[str]:
    if fit.crosstalk:
        names = " and ".join(each.name for each in fit.crosstalk)
        yield (
            f"gain and zero hold without {names}: in use it adds to the torque, unless sensitivity "
            "times side load is subtracted where it is measured"
        )
