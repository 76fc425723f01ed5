"""Factor m and delay for a recording: as told, checked against the wave, or taken from it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.wave_timing import WaveTiming, fit_timing
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strainwave.commissioning.conditions import Condition
    from strainwave.commissioning.told import ToldFactor
    from strainwave.joint import Joint
    from strainwave.records.table import Table

#: Motor turns below which the wave does not tell its factor.
FEWEST_TURNS: Final = 1.5
#: Shift of the first harmonic over the whole run, in cycles, that is worth a warning: it takes
#: 0.4 % of the amplitude.
NOTEWORTHY_SHIFT: Final = 0.05
#: Standard uncertainties from which a difference is one.
LEAST_EVIDENCE: Final = 4.0
#: Rows that the factor is checked on.
MOST_ROWS: Final = 100_000


@dataclass(frozen=True)
class Timing:
    """How the wave's angle follows from the recording.

    Attributes
    ----------
    factor : float or None
        m; None where the angle comes from the gauges.
    found : WaveTiming or None
        What the wave itself shows, where it shows anything.
    delay_s : float
        Delay that is taken out of the angle.
    """

    factor: float | None
    found: WaveTiming | None
    delay_s: float


def found_timing(
    table: Table,
    conditions: Sequence[Condition],
    joint: Joint | None,
    told: ToldFactor,
    *,
    harmonics: int,
    fit_factor: bool,
    fit_delay: bool,
) -> tuple[Timing, tuple[str, ...]]:
    """Check the told factor and delay against the wave, or find them.

    Parameters
    ----------
    table : Table
        With ``angle`` and ``gauges``.
    conditions : sequence of Condition
        Loads and temperatures; the wave is looked at where most rows are.
    joint : Joint or None
        Its ``[signals]`` may tell the delay.
    told : ToldFactor
        Factor as it was told.
    harmonics : int
        Harmonics of the wave.
    fit_factor, fit_delay : bool
        Whether they are taken from the recording.

    Returns
    -------
    tuple
        The timing, and what to say about it.

    Raises
    ------
    InputError
        If they cannot be taken from this recording, or its time does not rise.
    """
    longest = max(conditions, key=lambda each: len(each.rows))
    rows = longest.rows[longest.stretches == np.argmax(np.bincount(longest.stretches))]
    angle, volts = table.values["angle"][rows], table.values["gauges"][rows]
    time_s = table.values["time"][rows] if "time" in table else None
    signals = None if joint is None else joint.signals
    delay_s = 0.0 if signals is None else signals.angle_to_torque_delay_s or 0.0
    said: list[str] = []
    if not told.is_told and not fit_factor:
        said.append(
            "nothing tells the gear's factor m, and m = 1 is taken, a fixed flexspline: give --ratio "
            "and --configuration, or a --joint with [gear]"
        )
    if delay_s and time_s is None and not fit_delay:
        said.append(
            f"the joint file says that the gauges lag the angle by {1e3 * delay_s:g} ms, which is "
            "not taken out without a column of time: map time=COLUMN"
        )
        delay_s = 0.0
    if (delay_s or fit_delay) and time_s is not None:
        _require_rising(table, conditions)
    turns = float(np.ptp(angle)) / (2 * np.pi)
    if turns < FEWEST_TURNS or len(angle) < 16 * (harmonics + 2):
        if fit_factor or fit_delay:
            raise InputError(
                f"{table.source}: the angle covers {turns:.2g} turns in {len(angle)} rows; expected "
                f"at least {FEWEST_TURNS:g} turns to find the factor m or a delay, so record more"
            )
        return Timing(told.factor, None, delay_s), tuple(said)
    every = slice(None, None, 1 + len(angle) // MOST_ROWS)
    found = fit_timing(
        volts[every],
        angle[every],
        harmonics=harmonics,
        wave_factor=told.factor,
        time_s=None if time_s is None or not (delay_s or fit_delay) else time_s[every],
        delay_s=delay_s,
        fit_delay=fit_delay,
    )
    if not fit_delay:
        found = replace(found, delay_s=delay_s)
    if fit_factor:
        return Timing(found.factor, found, found.delay_s), tuple(said)
    said += _disagreement(told, found, turns)
    return Timing(told.factor, found, found.delay_s), tuple(said)


def _require_rising(table: Table, conditions: Sequence[Condition]) -> None:
    for condition in conditions:
        stays = np.diff(table.values["time"][condition.rows]) <= 0
        falls = np.flatnonzero(stays & (np.diff(condition.stretches) == 0))
        if len(falls) == 0:
            continue
        row = condition.rows[falls[0] + 1] + 1
        raise InputError(
            f"{table.source}: row {row}, {table.labels['time'][0]} does not rise; "
            "expected times that rise from row to row where a delay is taken out, so sort the "
            "recording or leave the delay out"
        )


def _disagreement(told: ToldFactor, found: WaveTiming, turns: float) -> list[str]:
    shift = found.factor - told.factor
    is_there = abs(shift) > LEAST_EVIDENCE * found.factor_standard_uncertainty
    if not is_there or 2 * abs(shift) * turns < NOTEWORTHY_SHIFT:
        return []
    shown = f"{found.factor:.6f} +- {found.factor_standard_uncertainty:.1g}"
    words = (
        f"the wave turns {shown} times per motor turn, and the gains are found for m = "
        f"{told.factor:.6f}{'' if told.is_told else ', taken as nothing was told'}"
    )
    if found.factor > 1 and not told.is_told:
        return [
            f"{words}: a fixed circular spline of ratio {1 / (found.factor - 1):.4g} turns so; "
            "give --ratio and --configuration, or --fit-factor"
        ]
    return [f"{words}: check --ratio, --configuration and the angle's unit, or give --fit-factor"]
