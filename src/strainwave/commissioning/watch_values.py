"""What the watch over the gauges has to know, from the recording that the gains are found in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.fluctuation_run import wave_columns
from strainwave.calibrate.gauge_watch import consistency_limits, signal_directions, white_noise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.fluctuation_run import FluctuationRun
    from strainwave.commissioning.conditions import Condition
    from strainwave.joint import Joint
    from strainwave.records.table import Table

#: Harmonics that the joint file keeps of a gauge, and the core predicts.
MOST_KEPT: Final = 4
#: Rows in a row below which nothing is said about noise.
FEWEST_ROWS: Final = 100
#: By how much the torque of conditions has to differ, in standard deviations within one of them.
LOADED: Final = 10.0


@dataclass(frozen=True)
class WatchValues:
    """Sound gauges, as ``gauge_signals`` and the limits of ``[gains]`` have them.

    Attributes
    ----------
    zeros_V : numpy.ndarray
        Signals without fluctuation and, where several loads tell it, without torque, shape
        (gauges,), V.
    phasors : numpy.ndarray
        a exp(j phi) of the harmonics 1, 2, ..., shape (harmonics, gauges), V; no harmonics where
        the angle was found from the gauges, because its zero is none of the motor's.
    noise_V : float or None
        The least noise of a gauge, V.
    limit_V, share : float or None
        How far sound gauges are from torque and fluctuation, and how that grows with the torque.
    says : tuple of str
        What is missing and why, a sentence each.
    """

    zeros_V: NDArray[np.float64]
    phasors: NDArray[np.complex128]
    noise_V: float | None
    limit_V: float | None
    share: float | None
    says: tuple[str, ...]


def watch_values(
    table: Table,
    conditions: Sequence[Condition],
    runs: Sequence[FluctuationRun],
    wave_angles_rad: Sequence[NDArray[np.float64]] | None,
    sensitivities: NDArray[np.float64],
    *,
    delay_s: float = 0.0,
    joint: Joint | None = None,
) -> WatchValues:
    """Find zeros, fluctuation, noise and limits of the gauges.

    Parameters
    ----------
    table : Table
        With ``gauges``.
    conditions : sequence of Condition
        Loads and temperatures.
    runs : sequence of FluctuationRun
        The fit of each.
    wave_angles_rad : sequence of numpy.ndarray or None
        m times the motor angle when the gauges were read, for each; None where no angle is mapped.
    sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    delay_s : float
        Delay that was taken out of the angle.
    joint : Joint, optional
        Its converter has the step, and its ``[signals]`` the delay that the watch goes by.

    Returns
    -------
    WatchValues
        What was found.
    """
    weights = _at_no_load(conditions)
    zeros_V = np.asarray(weights @ np.array([run.offsets for run in runs]))
    known = [run.is_present for run in runs]
    kept = min(MOST_KEPT, *(len(each) for each in known))
    present = np.flatnonzero(np.any([each[:kept] for each in known], axis=0))
    kept = int(present[-1]) + 1 if len(present) else 0
    phasors = np.asarray(np.tensordot(weights, [run.phasors[:kept] for run in runs], 1))
    says = []
    noise_V = _noise_V(table, conditions, runs, wave_angles_rad, joint)
    if noise_V is None:
        says.append(
            "the noise of the gauges does not show in this recording, and a gauge whose code stands "
            "is not found at rest: record voltages or codes with their noise, row after row"
        )
    limit_V = share = None
    reason = _no_comparison(len(zeros_V), wave_angles_rad, delay_s, joint)
    if reason is not None:
        says.append(reason)
    if wave_angles_rad is None:
        phasors = phasors[:0]
    elif reason is None:
        limit_V, share = _limits(
            table, conditions, wave_angles_rad, zeros_V, phasors, sensitivities
        )
        if share is None:
            says.append(
                "under one load alone nothing tells how far sound gauges part under others: a lost "
                "gauge is found by its own signal, and gauges are not compared before a recording "
                "at several loads, up to those of use (map load=COLUMN or experiment=COLUMN)"
            )
    return WatchValues(zeros_V, phasors, noise_V, limit_V, share, tuple(says))


def _at_no_load(conditions: Sequence[Condition]) -> NDArray[np.float64]:
    """Weights of the conditions that make what holds without load of them, shape (conditions,).

    A straight line over the load where loads lie on both sides of none, or one is none; else their
    mean. A torque left in all zeros alike is in the torque's direction, and does no harm.
    """
    mean = np.full(len(conditions), 1 / len(conditions))
    loads = [each.load_Nm for each in conditions]
    if None in loads:
        return mean
    load = np.array(loads, dtype=np.float64)
    reach = float(np.ptp(load))
    if not reach > 0 or not load.min() <= 0.05 * reach or not load.max() >= -0.05 * reach:
        return mean
    away = load - load.mean()
    return np.asarray(mean - load.mean() * away / (away @ away))


def _no_comparison(
    gauges: int,
    wave_angles_rad: Sequence[NDArray[np.float64]] | None,
    delay_s: float,
    joint: Joint | None,
) -> str | None:
    """Say why gauges cannot be compared with each other; None where they can."""
    if wave_angles_rad is None:
        return (
            "without an angle the wave is not known against the motor, and gauges are not compared "
            "with each other to find a lost one: map angle=COLUMN"
        )
    if gauges < 3:
        return "two gauges say that they part, and not which one is wrong: a third would"
    signals = None if joint is None else joint.signals
    told_s = 0.0 if signals is None else signals.angle_to_torque_delay_s or 0.0
    if delay_s != told_s:
        return (
            f"the gauges lag the angle by {1e3 * delay_s:.4g} ms and the joint file says "
            f"{1e3 * told_s:.4g} ms, so that gauges are not compared with each other: put "
            f"angle_to_torque_delay_s = {delay_s:.4g} into its [signals] and calibrate again"
        )
    return None


def _limits(
    table: Table,
    conditions: Sequence[Condition],
    wave_angles_rad: Sequence[NDArray[np.float64]],
    zeros_V: NDArray[np.float64],
    phasors: NDArray[np.complex128],
    sensitivities: NDArray[np.float64],
) -> tuple[float, float | None]:
    volts = table.values["gauges"]
    direction = signal_directions(sensitivities)[0]
    torques = [(volts[each.rows] - zeros_V) @ direction for each in conditions]
    # Neighbouring rows share the ripple: only what is constant in a condition is its load.
    within = max(float(np.std(each)) for each in torques)
    reach = float(np.ptp([np.mean(each) for each in torques]))
    parts = np.stack([phasors.real, phasors.imag], axis=1)
    found = consistency_limits(
        volts[np.concatenate([each.rows for each in conditions])],
        np.concatenate(wave_angles_rad),
        zeros=zeros_V,
        conditions=parts.reshape(-1, len(zeros_V)),
        torque_sensitivities=sensitivities,
        is_loaded=reach > LOADED * within,
    )
    return found.limit, found.share


def _noise_V(
    table: Table,
    conditions: Sequence[Condition],
    runs: Sequence[FluctuationRun],
    wave_angles_rad: Sequence[NDArray[np.float64]] | None,
    joint: Joint | None,
) -> float | None:
    """Return the least noise of a gauge: with more, a sound gauge would look stuck."""
    volts = table.values["gauges"]
    step_V = _step_V(volts, joint)
    found, rows_of = [], []
    for place, (condition, run) in enumerate(zip(conditions, runs, strict=True)):
        parts_V = [volts[condition.rows]]
        if wave_angles_rad is not None:
            phasors = np.stack([run.phasors.real, run.phasors.imag], axis=1)
            columns = wave_columns(wave_angles_rad[place], len(run.phasors))
            parts_V.append(parts_V[0] - columns @ phasors.reshape(-1, volts.shape[1]))
        for stretch in np.unique(condition.stretches):
            rows = condition.stretches == stretch
            if np.count_nonzero(rows) >= FEWEST_ROWS:
                # A fast wave is in the one, the encoder's counts are in the other: both say at most.
                each = [white_noise(part_V[rows], step=step_V) for part_V in parts_V]
                found.append(np.min(each, axis=0))
                rows_of.append(np.count_nonzero(rows))
    if not found or not np.all(np.isfinite(found)):
        return None
    of_gauges_V = np.sqrt(np.average(np.square(found), axis=0, weights=rows_of))
    least_V = float(of_gauges_V.min())
    return least_V if least_V > 0 else None


def _step_V(volts: NDArray[np.float64], joint: Joint | None) -> float:
    """Return the converter's step: as the joint file has it, else the least that a gauge changes by."""
    gauges = None if joint is None else joint.gauges
    if gauges is not None and gauges.converter_bits is not None:
        assert gauges.converter_maximum_V is not None
        assert gauges.converter_minimum_V is not None
        range_V = gauges.converter_maximum_V - gauges.converter_minimum_V
        return float(range_V / 2.0**gauges.converter_bits)
    least = []
    for column in volts.T:
        apart = np.diff(np.unique(column))
        # What binary fractions of decimals differ by is no step.
        apart = apart[apart > 1e-9 * max(1e-12, float(np.max(np.abs(column))))]
        least.append(float(apart.min()) if len(apart) else 0.0)
    return max(least)
