"""Guided tuning of potentiometers from short runs: `strainwave calibrate tune`.

Godler et al. 2000 turned them by hand until the line at twice the speed was gone from the sum.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.circuit import Circuit, parse_circuit
from strainwave.calibrate.fluctuation_run import FluctuationRun, fit_run
from strainwave.calibrate.quantise import quantise_gains
from strainwave.calibrate.tuning import Advice, Turn, advise, gauge_phasors, trial_turn
from strainwave.commissioning.gauge_table import read_gauges, require_signals
from strainwave.commissioning.told import (
    GearConfiguration,
    parse_numbers,
    parse_sensitivities,
    told_factor,
)
from strainwave.commissioning.tune_result import Tuning
from strainwave.errors import InputError
from strainwave.joint import read_joint
from strainwave.records.mapping import MapKeys, parse_columns

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from strainwave.joint import Joint

TUNE_KEYS: Final = MapKeys(
    {"angle": "angle", "gauges": "voltage", "sum": "voltage", "time": "time"},
    frozenset({"gauges"}),
    "--map angle=beta_rad,sum=sum_V",
)
"""What can be mapped: every gauge, or their weighted sum alone."""

#: Share of the largest single gauge's amplitude at which a line is gone: -60 dB.
GONE_SHARE: Final = 1e-3
#: Standard uncertainties within which a line is gone.
GONE_ERRORS: Final = 3.0
#: Standard uncertainties by which runs and settings may disagree.
MOST_DISAGREEMENT: Final = 5.0
MOST_GAUGES: Final = 64
#: By how much all potentiometers together are turned to find better steps: nobody wants to turn far.
TURNED_SCALES: Final = np.linspace(0.98, 1.02, 21)
#: Harmonics beyond those to be cancelled that are fitted, so that they are no noise.
HARMONICS_BEYOND: Final = 3


@dataclass(frozen=True)
class TuneOptions:
    """What was asked for beside the runs.

    Attributes
    ----------
    mapping : tuple of str
        What followed ``--map``.
    harmonics : int
        N, harmonics to cancel.
    gauge_gains : tuple of str
        Potentiometer settings of each run as gains by commas, or of all runs.
    ratio, configuration
        As for `strainwave.commissioning.fluctuation.FluctuationOptions`.
    torque_sensitivity : str or None
        Sensitivities by commas.
    potentiometer : str or None
        ``STEPS`` or ``STEPS:LOW:HIGH``.
    until : float or None
        Amplitude at which a line is gone, V.
    """

    mapping: tuple[str, ...]
    harmonics: int
    gauge_gains: tuple[str, ...]
    ratio: Fraction | None = None
    configuration: GearConfiguration | None = None
    torque_sensitivity: str | None = None
    potentiometer: str | None = None
    until: float | None = None


def guide_tuning(
    runs: Sequence[Path], options: TuneOptions, *, joint_path: Path | None = None
) -> Tuning:
    """Say which potentiometer to turn, which way and how far.

    Parameters
    ----------
    runs : sequence of Path
        Short recordings in the order they were taken; the last one is with the present settings.
        The angle counts from the same zero in all of them.
    options : TuneOptions
        How they are read, and the settings of each.
    joint_path : Path, optional
        A joint file with gear, converter, torque sensitivities.

    Returns
    -------
    Tuning
        What is left, and what to do.

    Raises
    ------
    InputError
        If something that was given cannot be used, or no settings help.
    """
    if not 1 <= options.harmonics <= 16:
        raise InputError(
            f"--harmonics {options.harmonics}: expected a whole number from 1 to 16; correct this "
            "value"
        )
    if options.until is not None and not (np.isfinite(options.until) and options.until > 0):
        raise InputError(
            f"--until {options.until:g}: expected an amplitude above 0, in V; correct this value"
        )
    joint = None if joint_path is None else read_joint(joint_path).joint
    settings = _settings(options.gauge_gains, len(runs))
    circuit = _circuit(options.potentiometer)
    torque, _ = parse_sensitivities(options.torque_sensitivity, joint, settings.shape[1])
    wanted = options.harmonics
    fits = [
        _fit(Path(path), options, joint, gains) for path, gains in zip(runs, settings, strict=True)
    ]
    sums, errors = (
        np.array([of(fit, gains)[:wanted] for fit, gains in zip(fits, settings, strict=True)])
        for of in (_sum, _error)
    )
    # A sum that was recorded is one column; gauges are as many as there are potentiometers.
    is_each = fits[-1].phasors.shape[1] == settings.shape[1] and "sum" not in _mapped(options)
    phasors = fits[-1].phasors[:wanted] if is_each else gauge_phasors(sums, settings)
    threshold = GONE_ERRORS * float(errors[-1].max())
    if phasors is not None:
        threshold = max(threshold, GONE_SHARE * float(np.abs(phasors).max()))
    threshold = options.until or threshold
    is_gone = bool(np.abs(sums[-1]).max() <= threshold)
    advice = Advice(is_trial=False, turns=(), phasors=phasors)
    steps: tuple[str, ...] = ()
    said = () if is_each else _disagreement(sums, errors, settings, phasors)
    if not is_gone and phasors is None:
        missing = settings.shape[1] - int(
            np.linalg.matrix_rank(settings, tol=1e-3 * np.abs(settings).max())
        )
        advice = Advice(True, (_on_a_step(trial_turn(settings), circuit),), None, missing)
    elif not is_gone:
        assert phasors is not None
        advice = advise(phasors, sums[-1], settings[-1], torque)
        if circuit is not None:
            advice, steps = _on_steps(advice, circuit, settings[-1], torque)
    expected = None
    if phasors is not None:
        change = _then(settings[-1], advice.turns) - settings[-1]
        expected = np.abs(sums[-1] + phasors @ change)
    return Tuning(
        left=np.abs(sums),
        standard_uncertainties=errors,
        threshold=threshold,
        is_done=is_gone or not advice.turns,
        advice=advice,
        steps=steps,
        expected=expected,
        warnings=said,
    )


def _settings(texts: Sequence[str], runs: int) -> NDArray[np.float64]:
    rows = [parse_numbers("--gauge-gains", text, "a gain for every gauge") for text in texts]
    if len(rows) == 1:
        rows *= runs
    if len(rows) != runs:
        raise InputError(
            f"--gauge-gains is given {len(rows)} times for {runs} run(s); expected the settings of "
            "every run in their order, or once for all"
        )
    if len({len(row) for row in rows}) > 1 or not 2 <= len(rows[0]) <= MOST_GAUGES:
        raise InputError(
            f"--gauge-gains has {', '.join(str(len(row)) for row in rows)} gains; expected the same "
            f"number every time, a gain for each of 2 to {MOST_GAUGES} gauges"
        )
    settings = np.array(rows)
    if not np.all(np.any(settings, axis=1)):
        raise InputError(
            "--gauge-gains has a run with all gains 0; expected settings that pass a signal, so "
            "correct them"
        )
    return settings


def _circuit(text: str | None) -> Circuit | None:
    return None if text is None else parse_circuit(f"potentiometer:{text}", "--potentiometer")


def _mapped(options: TuneOptions) -> set[str]:
    return set(parse_columns(options.mapping, TUNE_KEYS))


def _fit(
    path: Path, options: TuneOptions, joint: Joint | None, gains: NDArray[np.float64]
) -> FluctuationRun:
    if ("gauges" in _mapped(options)) == ("sum" in _mapped(options)):
        raise InputError(
            "--map: expected either gauges=COLUMN+COLUMN..., each gauge before its potentiometer, "
            "or sum=COLUMN, their weighted sum; map one of them"
        )
    table = read_gauges(path, options.mapping, TUNE_KEYS, joint, required=("angle",))
    key = "sum" if "sum" in table else "gauges"
    volts = table.values[key].reshape(table.rows, -1)
    if key == "gauges" and volts.shape[1] != len(gains):
        raise InputError(
            f"{path}: {volts.shape[1]} gauge column(s) are mapped, and --gauge-gains has "
            f"{len(gains)} gains; expected one a gauge, so correct one of them"
        )
    require_signals(table, volts, key)
    told = told_factor(joint, options.ratio, options.configuration)
    beyond = (table.rows - 2) // 8 - options.harmonics
    try:
        return fit_run(
            volts,
            table.values["angle"],
            positions_rad=np.zeros(volts.shape[1]),
            harmonics=options.harmonics + int(np.clip(beyond, 0, HARMONICS_BEYOND)),
            wave_factor=told.factor,
            time_s=table.values.get("time"),
        )
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _weights(fit: FluctuationRun, gains: NDArray[np.float64]) -> NDArray[np.float64]:
    return gains if fit.phasors.shape[1] == len(gains) else np.ones(1)


def _sum(fit: FluctuationRun, gains: NDArray[np.float64]) -> NDArray[np.complex128]:
    return fit.weighted_sum(_weights(fit, gains))


def _error(fit: FluctuationRun, gains: NDArray[np.float64]) -> NDArray[np.float64]:
    return fit.sum_standard_uncertainty(_weights(fit, gains))


def _then(now: NDArray[np.float64], turns: Sequence[Turn]) -> NDArray[np.float64]:
    then = now.copy()
    for turn in turns:
        then[turn.gauge - 1] = turn.then
    return then


def _on_a_step(turn: Turn, circuit: Circuit | None) -> Turn:
    if circuit is None:
        return turn
    nearest = circuit.values[np.argmin(np.abs(circuit.values - turn.then))]
    return replace(turn, then=float(nearest))


def _on_steps(
    advice: Advice,
    circuit: Circuit,
    now: NDArray[np.float64],
    torque: NDArray[np.float64],
) -> tuple[Advice, tuple[str, ...]]:
    """Take turns to steps that there are; none where no steps are better than the present ones."""
    assert advice.phasors is not None
    phasors = advice.phasors
    conditions = np.stack([phasors.real, phasors.imag], axis=1).reshape(-1, len(now))
    found = quantise_gains(
        circuit, _then(now, advice.turns), conditions, torque, common_scales=TURNED_SCALES
    )
    half = float(circuit.values[1] - circuit.values[0]) / 2
    turns = tuple(
        Turn(int(j) + 1, float(now[j]), float(found.gains[j]))
        for j in np.argsort(-np.abs(found.gains - now), kind="stable")
        if abs(found.gains[j] - now[j]) > half
    )
    return replace(advice, turns=turns), found.settings


def _disagreement(
    sums: NDArray[np.complex128],
    errors: NDArray[np.float64],
    settings: NDArray[np.float64],
    phasors: NDArray[np.complex128] | None,
) -> tuple[str, ...]:
    """Say where more runs than needed contradict each other."""
    if phasors is None or len(sums) <= settings.shape[1]:
        return ()
    away = np.abs(sums - settings @ phasors.T)
    if not np.any(away > MOST_DISAGREEMENT * errors):
        return ()
    return (
        f"the runs and their settings contradict each other by {away.max():.2g} V: a setting may be "
        "read off badly, the angle of a run may count from another zero, or its torque was "
        "another one",
    )
