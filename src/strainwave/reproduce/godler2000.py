"""Godler et al. 2000: signal fluctuation and linearity of two, four and three gauges.

Three simulated builds turn one revolution without load and are then loaded at standstill, as the
paper's were. Every signal is given in %FS of the sum of all gauges, as the paper plots it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.calibrate.fluctuation import (
    FluctuationFit,
    compensation_conditions,
    equally_spaced_positions_rad,
    fit_fluctuation,
)
from strainwave.calibrate.gains import CompensatingGains, compensating_gains
from strainwave.calibrate.torque import SensorGain, sensor_gain
from strainwave.reproduce import published
from strainwave.reproduce.gauge_count import GaugeCount, Phasor, gauge_counts, vectors
from strainwave.simulate.presets.godler2000 import (
    RATED_TORQUE_NM,
    godler2000,
    linearity_experiment,
    one_turn,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Harmonics of the fit; the stations have two, so that a third or fourth would be noise.
HARMONICS: Final = 4
#: Seed of the turn on which the gains are tried; they were found on another.
TRIAL_SEED: Final = 30


@dataclass(frozen=True)
class Build:
    """One build of the paper, run.

    Attributes
    ----------
    gauges : int
        Number of gauges.
    angle_rad : numpy.ndarray
        Input shaft angle over one turn, shape (samples,), rad.
    signals_FS : numpy.ndarray
        Gauge signals without their mean, shape (samples, gauges), fraction of full scale.
    sum_FS : numpy.ndarray
        Their sum with equal gains.
    fit : FluctuationFit
        Amplitudes and phase errors of the gauges' harmonics.
    sum_harmonics_FS : numpy.ndarray
        Amplitudes of the harmonics in the sum, shape (harmonics,), fraction of full scale.
    periodic_FS : numpy.ndarray
        These harmonics over the turn, shape (samples,): the sum without its noise.
    loads_Nm : numpy.ndarray
        Torque applied at standstill, shape (loads,), Nm.
    linearity_error_FS : numpy.ndarray
        Distance of the indicated from the applied torque, shape (loads,), fraction of full scale.
    line : SensorGain
        Straight line through the loading.
    """

    gauges: int
    angle_rad: NDArray[np.float64]
    signals_FS: NDArray[np.float64]
    sum_FS: NDArray[np.float64]
    fit: FluctuationFit
    sum_harmonics_FS: NDArray[np.float64]
    periodic_FS: NDArray[np.float64]
    loads_Nm: NDArray[np.float64]
    linearity_error_FS: NDArray[np.float64]
    line: SensorGain

    @property
    def fluctuation_FS(self) -> float:
        """Half of the peak-to-peak fluctuation of the sum."""
        return half_peak_to_peak(self.sum_FS)

    @property
    def dominant_harmonic(self) -> int:
        """Harmonic of the largest amplitude in the sum: 1 for two cycles per turn, 2 for four."""
        return int(np.argmax(self.sum_harmonics_FS)) + 1

    @property
    def linearity_FS(self) -> float:
        """Largest linearity error, hysteresis included, as a magnitude."""
        return float(np.max(np.abs(self.linearity_error_FS)))


@dataclass(frozen=True)
class Compensation:
    """Gains for the three gauges.

    Attributes
    ----------
    from_paper : CompensatingGains
        From the amplitudes and phases that the paper prints.
    from_run : CompensatingGains
        From the simulated run's own fit of the basic harmonic.
    """

    from_paper: CompensatingGains
    from_run: CompensatingGains


@dataclass(frozen=True)
class Godler2000:
    """Everything the paper shows with numbers.

    Attributes
    ----------
    two, four, three : Build
        The paper's builds, by number of gauges.
    three_compensated : Build
        The third build with its gains, on another turn than the one they were found on.
    compensation : Compensation
        Gains of the third build.
    vectors_two, vectors_three : tuple of Phasor
        Vectors of fig. 8, gains included.
    gauge_counts : tuple of GaugeCount
        M_min = 2N + 1, tried.
    """

    two: Build
    four: Build
    three: Build
    three_compensated: Build
    compensation: Compensation
    vectors_two: tuple[Phasor, ...]
    vectors_three: tuple[Phasor, ...]
    gauge_counts: tuple[GaugeCount, ...]


def half_peak_to_peak(signal: NDArray[np.float64]) -> float:
    """Half of the range of a signal, the +- of the paper's words.

    Parameters
    ----------
    signal : numpy.ndarray
        Signal in any unit.

    Returns
    -------
    float
        In the signal's unit.
    """
    return float(np.ptp(signal)) / 2


def run_build(
    gauges: int, gains: NDArray[np.float64] | None = None, *, seed: int | None = None
) -> Build:
    """Turn one build and load it.

    Parameters
    ----------
    gauges : int
        2, 4 or 3.
    gains : numpy.ndarray, optional
        Gains of the gauges; all 1 without.
    seed : int, optional
        Seed of the turn; the number of gauges without.

    Returns
    -------
    Build
        Signals, fit and linearity error.
    """
    station = godler2000(gauges)
    weights = _core.Gains(np.ones(gauges).tolist() if gains is None else gains.tolist())
    scale = station.sensor_gain_Nm_per_V / RATED_TORQUE_NM
    turning = one_turn(gauges, seed=gauges if seed is None else seed)
    signals = turning.volts * scale
    signals -= signals.mean(axis=0)
    angle = turning.truth.motor_angle_rad
    fit = fit_fluctuation(
        signals,
        angle,
        positions_rad=[gauge.position_rad for gauge in station.gauges],
        harmonics=HARMONICS,
        wave_factor=station.wave_factor,
    )
    total = weights.weighted_sum(np.ascontiguousarray(signals))
    harmonics, periodic = _harmonics(total, angle, station.wave_factor)
    loads, line, error = _linearity(gauges, weights)
    return Build(
        gauges=gauges,
        angle_rad=angle,
        signals_FS=signals,
        sum_FS=total,
        fit=fit,
        sum_harmonics_FS=harmonics,
        periodic_FS=periodic,
        loads_Nm=loads,
        linearity_error_FS=error,
        line=line,
    )


def _harmonics(
    total: NDArray[np.float64], angle: NDArray[np.float64], wave_factor: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Amplitudes of the sum's harmonics, and what they make over the turn."""
    fit = fit_fluctuation(
        total[:, np.newaxis],
        angle,
        positions_rad=[0.0],
        harmonics=HARMONICS,
        wave_factor=wave_factor,
    )
    amplitudes, phases_rad = fit.amplitudes[:, 0], fit.phase_errors_rad[:, 0]
    order = 2 * wave_factor * np.arange(1, HARMONICS + 1)
    return amplitudes, np.sin(np.outer(angle, order) + phases_rad) @ amplitudes


def _linearity(
    gauges: int, weights: _core.Gains
) -> tuple[NDArray[np.float64], SensorGain, NDArray[np.float64]]:
    """Load at standstill, and take the straight line through what the sensor shows."""
    loading = linearity_experiment(gauges, seed=10 + gauges)
    # What comes before the first full load runs the hysteresis in and is not read.
    full = int(np.argmax(loading.applied_torque_Nm))
    loads = loading.applied_torque_Nm[full:]
    volts = weights.weighted_sum(np.ascontiguousarray(loading.volts[full:]))
    line = sensor_gain(volts, loads, intercept=True)
    shown_Nm = line.gain_Nm_per_V * (volts - line.zero_V)
    return loads, line, (shown_Nm - loads) / RATED_TORQUE_NM


def _published_gains(gauges: int) -> CompensatingGains:
    """Gains of the first gauges from the amplitudes and phases that the paper prints."""
    return compensating_gains(
        compensation_conditions(
            [published.THREE_GAUGE_AMPLITUDES[:gauges]],
            np.deg2rad([published.THREE_GAUGE_PHASE_ERRORS_DEG[:gauges]]),
            equally_spaced_positions_rad(gauges),
        )
    )


def _run_gains(three: Build) -> CompensatingGains:
    return compensating_gains(
        compensation_conditions(
            three.fit.amplitudes[:1],
            three.fit.phase_errors_rad[:1],
            equally_spaced_positions_rad(3),
        )
    )


def run() -> Godler2000:
    """Run all three builds and find the gains of the third.

    Returns
    -------
    Godler2000
        Every result.
    """
    three = run_build(3)
    from_paper, from_run = _published_gains(3), _run_gains(three)
    compensated = run_build(3, from_run.gains, seed=TRIAL_SEED)
    phases_rad = np.deg2rad(published.THREE_GAUGE_PHASE_ERRORS_DEG)
    amplitudes = published.THREE_GAUGE_AMPLITUDES
    return Godler2000(
        two=run_build(2),
        four=run_build(4),
        three=three,
        three_compensated=compensated,
        compensation=Compensation(from_paper, from_run),
        vectors_two=vectors(amplitudes[:2], phases_rad[:2], _published_gains(2).gains),
        vectors_three=vectors(amplitudes, phases_rad, from_paper.gains),
        gauge_counts=gauge_counts(),
    )
