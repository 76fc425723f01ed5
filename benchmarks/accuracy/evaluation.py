"""Methods on simulated joints: what is run, what is measured, how tunings are chosen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from benchmarks.accuracy.joint import (
    FULL_SCALE_NM,
    NOISE_NM,
    RATIO,
    WAVE_FACTOR,
    Run,
    make_joint,
    simulate,
)
from benchmarks.accuracy.methods.catalogue import BY_NAME
from benchmarks.accuracy.methods.interface import Log, Removal, Setting
from benchmarks.accuracy.metrics import (
    attenuation_dB,
    error_by_phase,
    even_windows,
    line_powers,
    power_change_outside_dB,
)
from benchmarks.accuracy.motion import FULL_SPEED_RAD_S, PHASES, SAMPLE_PERIOD_S, STEADY
from benchmarks.accuracy.ripple import ORDERS

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The joint of each scenario on which tunings are chosen, and those that are shown; none is both.
TRAINING_SEED: Final = 100
SEEDS: Final = (1, 2, 3, 4, 5, 6, 7, 8)
#: Errors that differ by no more of themselves are taken for equal when a tuning is chosen.
TIE: Final = 0.01
#: Lines are fitted in windows of these lengths: at constant speed, where what is left of a line is
#: told from coefficients that noise moves to and fro; and wherever the motor turns.
STEADY_WINDOW_SAMPLES: Final = 5000
TURNING_WINDOW_SAMPLES: Final = 1000
#: Windows with fewer turns of the wave cannot tell the orders apart.
LEAST_TURNS: Final = 3.0
SIMULATED: Final = Setting(
    SAMPLE_PERIOD_S, RATIO, FULL_SCALE_NM, NOISE_NM, orders=ORDERS, modulated_orders=ORDERS[:2]
)


@dataclass(frozen=True)
class Score:
    """One method on one joint.

    Attributes
    ----------
    error_percent : mapping of str to float
        RMS error by phase, and ``"mean"``; percent of full scale.
    attenuation_steady_dB, attenuation_overall_dB : tuple of float
        Attenuation of orders 2 and 4 at constant speed, and wherever the motor turns.
    outside_dB, outside_worst_dB : float
        Change of power beside the lines at constant speed: whole, and of the worst band of half an
        order.
    """

    error_percent: Mapping[str, float]
    attenuation_steady_dB: tuple[float, ...]
    attenuation_overall_dB: tuple[float, ...]
    outside_dB: float
    outside_worst_dB: float


def log_of(run: Run) -> Log:
    """Show a run to a method, without its truth.

    Parameters
    ----------
    run : Run
        The run.

    Returns
    -------
    Log
        Time, angle, torque.
    """
    return Log(
        run.motion.time_s,
        WAVE_FACTOR * run.motor_angle_rad,
        run.measured_torque_Nm,
        np.zeros(len(run.measured_torque_Nm)),
    )


def mean_error_percent(
    method_name: str, tuning: Mapping[str, Any], scenario: str, seed: int
) -> float:
    """Error on one joint, mean over the phases.

    Parameters
    ----------
    method_name : str
        The method.
    tuning : mapping
        Its tuning.
    scenario : str
        Scenario of the joint.
    seed : int
        Seed of the joint.

    Returns
    -------
    float
        Percent of full scale; infinite where the output is not finite.
    """
    run = simulate(make_joint(scenario, seed))
    removal = BY_NAME[method_name].remove(log_of(run), SIMULATED, **tuning)
    if not np.all(np.isfinite(removal.torque_Nm)):
        return float("inf")
    return _errors(run, removal)["mean"]


def choose_tuning(method_name: str, scenario: str) -> Mapping[str, Any]:
    """Choose from a method's grid what has the least mean error on the training joint.

    Of those within a hundredth of the least, the first is taken, which does least to true torque.

    Parameters
    ----------
    method_name : str
        The method.
    scenario : str
        Scenario of the training joint.

    Returns
    -------
    mapping
        The choice.
    """
    grid = BY_NAME[method_name].grid
    if len(grid) == 1:
        return grid[0]
    errors = [mean_error_percent(method_name, tuning, scenario, TRAINING_SEED) for tuning in grid]
    return grid[int(np.argmax(np.array(errors) <= (1 + TIE) * min(errors)))]


def score(method_name: str, tuning: Mapping[str, Any], scenario: str, seed: int) -> Score:
    """Measure a method on one joint.

    Parameters
    ----------
    method_name : str
        The method.
    tuning : mapping
        Its tuning.
    scenario : str
        Scenario of the joint.
    seed : int
        Seed of the joint.

    Returns
    -------
    Score
        Errors, attenuation, collateral power.
    """
    run = simulate(make_joint(scenario, seed))
    removal = BY_NAME[method_name].remove(log_of(run), SIMULATED, **tuning)
    steady = np.flatnonzero(run.motion.phase == STEADY)
    inside = slice(steady[0], steady[-1] + 1)
    total_dB, worst_dB = power_change_outside_dB(
        run.measured_torque_Nm[inside],
        removal.torque_Nm[inside],
        sample_rate_Hz=1 / SAMPLE_PERIOD_S,
        turn_Hz=WAVE_FACTOR * FULL_SPEED_RAD_S / (2 * np.pi),
        orders=ORDERS,
    )
    return Score(
        _errors(run, removal),
        _attenuation(run, removal, even_windows(inside.start, inside.stop, STEADY_WINDOW_SAMPLES)),
        _attenuation(run, removal, _turning_windows(run)),
        total_dB,
        worst_dB,
    )


def _errors(run: Run, removal: Removal) -> dict[str, float]:
    error = removal.torque_Nm - run.true_torque_Nm
    return error_by_phase(error, run.motion.phase, PHASES, FULL_SCALE_NM)


def _turning_windows(run: Run) -> list[slice]:
    wave = WAVE_FACTOR * run.motion.angle_rad
    learned = int(np.argmax(run.motion.phase == STEADY))
    return [
        window
        for window in even_windows(learned, len(wave), TURNING_WINDOW_SAMPLES)
        if np.ptp(wave[window]) >= 2 * np.pi * LEAST_TURNS
    ]


def _attenuation(run: Run, removal: Removal, windows: list[slice]) -> tuple[float, ...]:
    # Ripple that is left: output minus truth minus noise, the same as true minus removed ripple.
    # With the noise in it, a window could not show more than some 60 dB at order 2.
    left: NDArray[np.float64] = run.ripple_Nm - (run.measured_torque_Nm - removal.torque_Nm)
    wave = WAVE_FACTOR * run.motion.angle_rad
    before, after = (
        line_powers(values, wave, ORDERS[:2], windows, polynomial_degree=2)
        for values in (run.ripple_Nm, left)
    )
    return tuple(float(value) for value in attenuation_dB(before, after))
