"""What a person should know before gains are used, a sentence each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.degenerate import reasons

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.calibrate.fluctuation_run import FluctuationRun
    from strainwave.calibrate.gain_solution import GainSolution
    from strainwave.commissioning.conditions import Condition

#: Share of the largest single gauge's amplitude that one set of gains may leave in a condition.
WELL_SERVED: Final = 0.01
#: Standard uncertainties from which something left is there.
LEAST_EVIDENCE: Final = 3.0
#: Standard uncertainty of a gain that is worth a warning.
UNCERTAIN_GAIN: Final = 0.01
#: Wave turns below which a harmonic and a slow change of torque are hard to tell apart.
FEW_TURNS: Final = 1.0


def warnings_of_fit(
    conditions: Sequence[Condition], runs: Sequence[FluctuationRun], harmonics: int
) -> tuple[str, ...]:
    """Say where a run is short or has more in it than what is cancelled.

    Parameters
    ----------
    conditions : sequence of Condition
        Loads and temperatures.
    runs : sequence of FluctuationRun
        The fit of each.
    harmonics : int
        Harmonics to be cancelled.

    Returns
    -------
    tuple of str
        Empty where nothing is unusual.
    """
    said = []
    for condition, run in zip(conditions, runs, strict=True):
        where = f" ({condition.name})" if condition.name else ""
        # The encoder's first and last count are not quite a turn apart.
        if run.wave_turns < 0.99 * FEW_TURNS:
            said.append(
                f"the wave passes {run.wave_turns:.2g} turns{where}: a slow change of torque looks "
                "like it; turn at least once, better several times"
            )
        largest = float(run.amplitudes[:harmonics].max())
        said += [
            f"harmonic {i + 1}, up to {run.amplitudes[i].max():.3g} V on a gauge{where}, is not "
            f"cancelled by gains for {harmonics} harmonic(s)"
            for i in np.flatnonzero(run.is_present[harmonics:]) + harmonics
            if run.amplitudes[i].max() > WELL_SERVED * largest
        ]
    return tuple(said)


def warnings_of_gains(
    conditions: Sequence[Condition],
    runs: Sequence[FluctuationRun],
    solution: GainSolution,
    gains: NDArray[np.float64],
) -> tuple[str, ...]:
    """Say what gains are uncertain, and where one set does not serve every condition.

    Parameters
    ----------
    conditions : sequence of Condition
        Loads and temperatures.
    runs : sequence of FluctuationRun
        The fit of each.
    solution : GainSolution
        Gains as solved.
    gains : numpy.ndarray
        Gains as set, shape (gauges,).

    Returns
    -------
    tuple of str
        Empty where nothing is unusual.
    """
    said = list(solution.warnings)
    if not solution.is_exact:
        stacked = np.vstack([run.conditions(solution.harmonics) for run in runs])
        said += [
            f"what is left has a reason: {clause}"
            for clause in reasons(stacked, solution.harmonics)
        ]
    uncertain = solution.standard_uncertainties
    if uncertain.max() > UNCERTAIN_GAIN:
        said.append(
            f"the gains are known to {uncertain.max():.2g} only: record a longer run, at a "
            "steadier torque"
        )
    chosen = np.array(solution.harmonics) - 1
    for condition, run in zip(conditions, runs, strict=True):
        if len(runs) == 1:
            break
        left = np.abs(run.weighted_sum(gains))[chosen]
        spread = run.sum_standard_uncertainty(gains)[chosen]
        largest = float(run.amplitudes[chosen].max())
        worst = int(np.argmax(left))
        if left[worst] > max(WELL_SERVED * largest, LEAST_EVIDENCE * spread[worst]):
            said.append(
                f"one set of gains does not serve {condition.name}: {left[worst]:.3g} V of harmonic "
                f"{chosen[worst] + 1} is left, {100 * left[worst] / largest:.2g} % of a gauge's "
                "amplitude; calibrate near the load that matters, or add a gauge"
            )
    return tuple(said)
