"""A recording of all gauges in, gains in the joint file out: `strainwave calibrate fluctuation`.

Godler et al. 2000, section III: amplitudes and phases against the wave-generator angle, then the
gains that cancel them.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.angle_from_gauges import AMBIGUITY, calibrate_without_angle
from strainwave.calibrate.circuit import parse_circuit
from strainwave.calibrate.fluctuation_run import FluctuationRun, fit_run, rms_left
from strainwave.calibrate.gain_solution import OverGrid, solve_gains
from strainwave.calibrate.gains import MOST_NOISE
from strainwave.calibrate.quantise import quantise_gains
from strainwave.calibrate.wave_timing import delayed_in_stretches
from strainwave.commissioning.conditions import Condition, conditions_of
from strainwave.commissioning.fluctuation_result import FluctuationCalibration
from strainwave.commissioning.fluctuation_warnings import warnings_of_fit, warnings_of_gains
from strainwave.commissioning.gains_section import gains_section
from strainwave.commissioning.gauge_table import (
    gauge_positions_rad,
    read_gauges,
    require_signals,
    saturation_warnings,
)
from strainwave.commissioning.lost_gauges import check_harmonics_without, sets_without
from strainwave.commissioning.told import GearConfiguration, parse_sensitivities, told_factor
from strainwave.commissioning.watch_values import watch_values
from strainwave.commissioning.wave_angle import Timing, found_timing
from strainwave.errors import InputError
from strainwave.joint import Provenance, write_joint
from strainwave.records.joint_output import check_joint_output, started_joint
from strainwave.records.mapping import MapKeys

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from strainwave.joint import Joint
    from strainwave.records.table import Table

FLUCTUATION_KEYS: Final = MapKeys(
    {
        "angle": "angle",
        "gauges": "voltage",
        "time": "time",
        "load": "torque",
        "temperature": "temperature",
        "experiment": None,
    },
    frozenset({"gauges"}),
    "--map angle=beta_rad,gauges=g1_V+g2_V+g3_V",
)
"""What can be mapped."""

#: Harmonics beyond those to be cancelled that are fitted, to say what they leave.
HARMONICS_BEYOND: Final = 3
MOST_HARMONICS: Final = 16


@dataclass(frozen=True)
class FluctuationOptions:
    """What was asked for beside the recording.

    Attributes
    ----------
    mapping : tuple of str
        What followed ``--map``.
    harmonics : int
        N, harmonics to cancel.
    ratio : fractions.Fraction or None
        Motor turns per output turn.
    configuration : {"flexspline-fixed", "circular-spline-fixed"} or None
        The part that is fixed.
    torque_sensitivity : str or None
        Sensitivities by commas.
    quantise : str or None
        A circuit, see `strainwave.calibrate.circuit.parse_circuit`.
    fit_factor, fit_delay : bool
        Whether factor m and the delay of the gauges are taken from the recording.
    over_grid : {"sum", "worst"}
        What is least over several conditions.
    most_noise : float
        Largest noise factor that is accepted.
    without_gauge_harmonics : int or None
        How many harmonics the gains for a lost gauge cancel, the lowest first; all without.
    """

    mapping: tuple[str, ...]
    harmonics: int
    ratio: Fraction | None = None
    configuration: GearConfiguration | None = None
    torque_sensitivity: str | None = None
    quantise: str | None = None
    fit_factor: bool = False
    fit_delay: bool = False
    over_grid: OverGrid = "sum"
    most_noise: float = MOST_NOISE
    without_gauge_harmonics: int | None = None


def calibrate_fluctuation(
    log: Path,
    out: Path,
    options: FluctuationOptions,
    *,
    joint_path: Path | None = None,
    command: str | None = None,
    before_writing: Callable[[FluctuationCalibration], None] | None = None,
) -> FluctuationCalibration:
    """Find gains that cancel the fluctuation, and write them to ``[gains]`` of a joint file.

    Parameters
    ----------
    log : Path
        The recording: gauges against the wave-generator angle at about constant torque, or at
        several loads and temperatures.
    out : Path
        The joint file; written whole or not at all. It may be `joint_path`.
    options : FluctuationOptions
        How the recording is read and what is asked for.
    joint_path : Path, optional
        A joint file to start from.
    command : str, optional
        The command line, for the provenance.
    before_writing : callable, optional
        Called with the result just before the joint file is written, such as for its figure: where
        that fails, nothing is written.

    Returns
    -------
    FluctuationCalibration
        What was found.

    Raises
    ------
    InputError
        If something that was given cannot be used, or no useful gains exist; nothing is written.
    """
    log, out = Path(log), Path(out)
    check_joint_output(out, log, joint_path)
    _check_harmonics(options.harmonics)
    circuit = None if options.quantise is None else parse_circuit(options.quantise)
    joint_file = started_joint(log, joint_path)
    joint = None if joint_path is None else joint_file.joint
    table = read_gauges(log, options.mapping, FLUCTUATION_KEYS, joint)
    volts = table.values["gauges"]
    gauges = volts.shape[1]
    if gauges < 2:
        raise InputError(
            f"--map: {gauges} gauge column is mapped; expected at least two that can be weighed "
            "against each other, 2N + 1 to cancel N harmonics, so map gauges=COLUMN+COLUMN+..."
        )
    check_harmonics_without(options.without_gauge_harmonics, options.harmonics, gauges)
    require_signals(table, volts)
    sensitivities, has_sensitivities = parse_sensitivities(
        options.torque_sensitivity, joint, gauges
    )
    positions_rad, said = gauge_positions_rad(joint, gauges)
    conditions, more = conditions_of(table)
    said += more + saturation_warnings(volts, joint)
    timing, more = _timing(table, conditions, joint, options)
    said += more
    angles = [_angle(table, each, positions_rad, timing, sensitivities) for each in conditions]
    runs = tuple(
        _run(table, condition, angle, positions_rad, options.harmonics, timing)
        for condition, angle in zip(conditions, angles, strict=True)
    )
    present, more = _present(table, runs, options.harmonics)
    said += more + warnings_of_fit(conditions, runs, options.harmonics)
    solution = solve_gains(
        runs,
        present,
        sensitivities,
        over_grid=options.over_grid,
        most_noise=options.most_noise,
    )
    quantised = None
    if circuit is not None:
        stacked = np.vstack([run.conditions(present) for run in runs])
        quantised = quantise_gains(circuit, solution.gains, stacked, sensitivities)
    gains = solution.gains if quantised is None else quantised.gains
    lost = sets_without(
        runs,
        present,
        sensitivities,
        gains,
        harmonics=options.without_gauge_harmonics,
        most_noise=options.most_noise,
    )
    said += warnings_of_gains(conditions, runs, solution, gains) + lost.warnings
    watch = watch_values(
        table,
        conditions,
        runs,
        None if timing.factor is None else [timing.factor * angle for angle in angles],
        sensitivities,
        delay_s=timing.delay_s,
        joint=joint,
    )
    result = FluctuationCalibration(
        log=log,
        out=out,
        conditions=conditions,
        runs=runs,
        harmonics=options.harmonics,
        solution=solution,
        quantised=quantised,
        held_out=_held_out(
            table, conditions, positions_rad, options, timing, sensitivities, present
        ),
        lost_gauges=lost,
        watch=watch,
        factor=timing.factor,
        timing=timing.found,
        delay_s=timing.delay_s,
        rms_left=rms_left(runs, gains),
        warnings=said,
    )
    section = gains_section(result, sensitivities if has_sensitivities else None, joint)
    joint_file.set_section("gains", section, Provenance.of_file(log, command=command))
    if before_writing is not None:
        before_writing(result)
    write_joint(joint_file, out)
    return result


def _check_harmonics(harmonics: int) -> None:
    if not 1 <= harmonics <= MOST_HARMONICS:
        raise InputError(
            f"--harmonics {harmonics}: expected a whole number from 1 to {MOST_HARMONICS}, 1 for "
            "the two cycles per turn alone; correct this value"
        )


def _timing(
    table: Table,
    conditions: Sequence[Condition],
    joint: Joint | None,
    options: FluctuationOptions,
) -> tuple[Timing, tuple[str, ...]]:
    if "angle" not in table:
        for name, given in (
            ("--fit-factor", options.fit_factor),
            ("--fit-delay", options.fit_delay),
        ):
            if given:
                raise InputError(
                    f"{name} is given, and no angle is mapped; expected a column of the angle to "
                    "compare the wave with, so map angle=COLUMN or leave the option out"
                )
        return Timing(None, None, 0.0), (
            f"no angle is mapped and it is found from the gauges themselves: {AMBIGUITY}",
        )
    told = told_factor(joint, options.ratio, options.configuration)
    return found_timing(
        table,
        conditions,
        joint,
        told,
        harmonics=options.harmonics,
        fit_factor=options.fit_factor,
        fit_delay=options.fit_delay,
    )


def _angle(
    table: Table,
    condition: Condition,
    positions_rad: NDArray[np.float64],
    timing: Timing,
    sensitivities: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Angle of the motor when the gauges were read; that of the wave where no angle is mapped."""
    rows = condition.rows
    with _naming(table, condition):
        if timing.factor is None:
            return calibrate_without_angle(
                table.values["gauges"][rows],
                positions_rad=positions_rad,
                torque_sensitivities=sensitivities,
            ).wave_angle_rad
        angle = table.values["angle"][rows]
        if timing.delay_s == 0:
            return angle
        time_s = table.values["time"][rows]
        return delayed_in_stretches(angle, time_s, timing.delay_s, condition.stretches)


def _run(
    table: Table,
    condition: Condition,
    angle_rad: NDArray[np.float64],
    positions_rad: NDArray[np.float64],
    harmonics: int,
    timing: Timing,
) -> FluctuationRun:
    rows = condition.rows
    turned = np.ptp(angle_rad) * (timing.factor or 1.0)
    # More harmonics than the run can tell apart are not fitted.
    beyond = int(np.clip((len(rows) - 2) // 8 - harmonics, 0, HARMONICS_BEYOND))
    with _naming(table, condition):
        return fit_run(
            table.values["gauges"][rows],
            angle_rad,
            positions_rad=positions_rad,
            harmonics=harmonics + (beyond if turned >= np.pi else 0),
            wave_factor=timing.factor or 1.0,
            time_s=table.values["time"][rows] if "time" in table else None,
            stretches=condition.stretches,
        )


@contextmanager
def _naming(table: Table, condition: Condition) -> Iterator[None]:
    """Say in which file and condition something cannot be used."""
    try:
        yield
    except InputError as error:
        where = f" ({condition.name})" if condition.name else ""
        raise InputError(f"{table.source}{where}: {error}") from error


def _present(
    table: Table, runs: Sequence[FluctuationRun], harmonics: int
) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """Harmonics that stand out of the noise in some condition; only they can be cancelled."""
    shown = np.any([run.is_present[:harmonics] for run in runs], axis=0)
    if not shown.any():
        raise InputError(
            f"{table.source}: no gauge shows a fluctuation of {harmonics} harmonic(s) above its "
            "noise; expected gauges that see the wave, so check the mapping of angle and gauges, "
            "and the factor m"
        )
    said = tuple(
        f"harmonic {i + 1} does not stand out of the noise on any gauge: there is nothing to "
        "cancel, and the gains leave it alone"
        for i in np.flatnonzero(~shown)
    )
    return tuple(int(i) + 1 for i in np.flatnonzero(shown)), said


def _held_out(
    table: Table,
    conditions: Sequence[Condition],
    positions_rad: NDArray[np.float64],
    options: FluctuationOptions,
    timing: Timing,
    sensitivities: NDArray[np.float64],
    present: Sequence[int],
) -> NDArray[np.float64] | None:
    """Try gains from the first half of a run on the second; None where halves are short."""
    if len(conditions) > 1:
        return None
    (whole,) = conditions
    middle = len(whole.rows) // 2
    halves = [
        Condition("", whole.rows[part], whole.stretches[part], None, None)
        for part in (slice(None, middle), slice(middle, None))
    ]
    try:
        first, second = (
            _run(
                table,
                half,
                _angle(table, half, positions_rad, timing, sensitivities),
                positions_rad,
                options.harmonics,
                timing,
            )
            for half in halves
        )
        gains = solve_gains([first], present, sensitivities, most_noise=options.most_noise).gains
    except InputError:
        return None
    left = np.abs(second.weighted_sum(gains))
    return left if len(left) >= options.harmonics else None
