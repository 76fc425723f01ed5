"""Would the filter's own deviations do as an uncertainty of the torque? How often they cover it.

A standard uncertainty is calibrated where twice of it covers the truth in about 95 of 100 samples, in
every phase and not on average. Two candidates are measured: the noise the filter is told, and what
it expects of an innovation, which has the uncertainty of its coefficients in it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

import strainwave
from benchmarks.accuracy.evaluation import SEEDS, SIMULATED, log_of
from benchmarks.accuracy.joint import make_joint, simulate
from benchmarks.accuracy.methods.ours import OURS, config_of
from benchmarks.accuracy.motion import PHASES
from benchmarks.accuracy.ripple import SCENARIOS

if TYPE_CHECKING:
    from numpy.typing import NDArray

CANDIDATES: Final = ("noise as told", "expected innovation")


def coverage_percent(scenario: str) -> dict[str, dict[str, float]]:
    """Measure both candidates on the joints of a scenario.

    Parameters
    ----------
    scenario : str
        One of `benchmarks.accuracy.ripple.SCENARIOS`.

    Returns
    -------
    dict
        By candidate and phase: percent of the samples whose error is at most twice the deviation.
    """
    covered: dict[str, dict[str, list[float]]] = {
        name: {phase: [] for phase in PHASES} for name in CANDIDATES
    }
    for seed in SEEDS:
        run = simulate(make_joint(scenario, seed))
        log = log_of(run)
        config = config_of(SIMULATED, **OURS.grid[0])
        result = strainwave.RippleFilter(config).process(
            log.time_s, log.wave_angle_rad, log.torque_Nm
        )
        error = np.abs(result.torque_Nm - run.true_torque_Nm)
        deviations: tuple[Any, NDArray[np.float64]] = (
            config.torque_noise_Nm,
            np.sqrt(result.innovation_variance_Nm2),
        )
        for name, deviation in zip(CANDIDATES, deviations, strict=True):
            within = error <= 2 * deviation
            for phase in PHASES:
                share = float(np.mean(within[run.motion.phase == phase]))
                covered[name][phase].append(100 * share)
    return {
        name: {phase: float(np.mean(shares)) for phase, shares in phases.items()}
        for name, phases in covered.items()
    }


def all_coverage() -> dict[str, dict[str, dict[str, float]]]:
    """Measure every scenario.

    Returns
    -------
    dict
        By scenario, see `coverage_percent`.
    """
    return {scenario: coverage_percent(scenario) for scenario in SCENARIOS}
