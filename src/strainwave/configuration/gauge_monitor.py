"""From a joint file to the core's watch over the gauges."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave import _core
from strainwave.calibrate.gauge_watch import fluctuation_rms, signal_directions, stuck_samples
from strainwave.configuration.gear import gear_of
from strainwave.configuration.sections import required

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.joint import Gains, Gauges, Joint

#: For how long a gauge is seen to be wrong until it is lost.
DETECTION_TIME_S: Final = 0.01
#: How often chance may make sound gauges look stuck.
STUCK_PER_HOUR: Final = 1e-4
#: Longest run of one code that is waited for; a converter that needs more does not show the noise.
LONGEST_STUCK_S: Final = 1.0
#: Band in which a shorted or stuck gauge stays, in standard deviations of the noise and in steps.
BAND_NOISE: Final = 8.0
BAND_STEPS: Final = 3.0
#: Turns of the motor in which the wave passes a gauge once at least, with either part fixed.
TURNS_OF_A_WAVE: Final = 0.5
#: Growth of the fluctuation under load that does not take a sound gauge to its rail unseen.
GROWTH_UNDER_LOAD: Final = 1.5


def gauge_monitor_of(joint: Joint, sample_period_s: float) -> _core.GaugeMonitorConfig | None:
    """Build the watch over a joint's gauges.

    Parameters
    ----------
    joint : Joint
        A joint with ``[gauges]``, converter included, and with ``without_gauge`` or
        ``gauge_signals`` in ``[gains]``. With the latter, ``consistency_limit_V`` and
        ``consistency_limit_share`` the gauges are held against each other, with ``noise_V`` a code that stands is found at rest.
    sample_period_s : float
        Time from one sample to the next, s.

    Returns
    -------
    GaugeMonitorConfig or None
        None where ``[gains]`` says nothing of lost gauges.

    Raises
    ------
    InputError
        If ``[gauges]`` or, for the angle of the wave, ``[gear]`` is missing, or the core cannot
        use a value.
    """
    gains = joint.gains
    if gains is None or not (gains.without_gauge or gains.gauge_signals) or len(gains.gains) < 2:
        return None
    gauges = required(joint, "gauges", joint.gauges)
    low_V, high_V, step_V = _range_of(gauges)
    samples = _detection_samples(gains, sample_period_s)
    wave_V = conditions_of(gains)
    noise_V = gains.noise_V or 0.0
    band_V = max(BAND_NOISE * noise_V, BAND_STEPS * step_V)
    sweeps = _least_amplitude(wave_V) > 2 * band_V
    rail_V = min(abs(low_V), abs(high_V)) if low_V < 0 < high_V else (high_V - low_V) / 2
    largest_wave_V = _largest_amplitude(wave_V)
    overload_V = rail_V - GROWTH_UNDER_LOAD * largest_wave_V if largest_wave_V > 0 else rail_V / 2
    return _core.GaugeMonitorConfig(
        rail_samples=samples,
        torn_gauge_rail=gauges.torn_gauge_rail or "unknown",
        overload_V=max(overload_V, rail_V / 4),
        stuck_samples=_stuck_samples(gains, step_V, sample_period_s, samples),
        flat_travel_turns=TURNS_OF_A_WAVE if sweeps else 0.0,
        flat_band_V=band_V,
        amplifier_zero_V=gauges.amplifier_offset_V,
        short_band_V=band_V,
        consistency=_consistency_of(joint, sample_period_s),
        residual_fluctuation_V=gains.residual_fluctuation_V or 0.0,
        without=_gains_without(gains, wave_V),
    )


def conditions_of(gains: Gains) -> NDArray[np.float64]:
    """Build the matrix of Godler 2000, eq. (9), from the gauges' fluctuation in V.

    Parameters
    ----------
    gains : Gains
        The section ``[gains]``.

    Returns
    -------
    numpy.ndarray
        Shape (2 harmonics, gauges), as from `strainwave.calibrate.compensation_conditions`; without
        ``gauge_signals`` no rows.
    """
    if not gains.gauge_signals:
        return np.zeros((0, len(gains.gains)))
    amplitude = np.array([signal.amplitudes_V for signal in gains.gauge_signals]).T
    phase = np.array([signal.phases_rad for signal in gains.gauge_signals]).T
    rows = np.stack([amplitude * np.cos(phase), amplitude * np.sin(phase)], axis=1)
    return np.asarray(rows.reshape(-1, len(gains.gains)))


def _range_of(gauges: Gauges) -> tuple[float, float, float]:
    """Return both ends of the converter and its step, V; any voltage where it is not described."""
    low_V, high_V = gauges.converter_minimum_V, gauges.converter_maximum_V
    if gauges.converter_bits is None or low_V is None or high_V is None:
        return -1e9, 1e9, 0.0
    return low_V, high_V, (high_V - low_V) / 2**gauges.converter_bits


def _amplitudes(wave_V: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.hypot(wave_V[::2], wave_V[1::2])


def _least_amplitude(wave_V: NDArray[np.float64]) -> float:
    """Return the least first harmonic of a gauge, which its signal runs through twice a turn."""
    return float(np.min(_amplitudes(wave_V)[0])) if len(wave_V) else 0.0


def _largest_amplitude(wave_V: NDArray[np.float64]) -> float:
    return float(np.max(np.sum(_amplitudes(wave_V), axis=0))) if len(wave_V) else 0.0


def _stuck_samples(gains: Gains, step_V: float, sample_period_s: float, least: int) -> int:
    if gains.noise_V is None or step_V <= 0:
        return 0
    needed = stuck_samples(
        gains.noise_V,
        step_V,
        most_per_hour=STUCK_PER_HOUR,
        rate_Hz=1 / sample_period_s,
        gauges=len(gains.gains),
    )
    needed = max(needed, least)
    return needed if needed * sample_period_s <= LONGEST_STUCK_S else 0


@dataclass(frozen=True)
class ConsistencySettings:
    """What holds the gauges against each other, as plain values.

    Attributes
    ----------
    samples : int
        This many more samples beyond the limit than within it, until a gauge is lost.
    signal_directions : numpy.ndarray
        Orthonormal, shape (directions, gauges); the first is that of the torque.
    gauge_zero_V : numpy.ndarray
        Signal of each gauge without torque, the wave taken out, shape (gauges,), V.
    limit_V : float
        Length of what may be left at no torque, V.
    limit_per_V : float
        Growth of that with the length of the torque's share.
    fluctuation_V : numpy.ndarray
        Rows of sine and cosine by harmonic, shape (2 harmonics, gauges), V.
    wave_factor : Rational or int
        Factor m of the gear.
    delay_samples : float
        By how many samples the gauges are behind the angle.
    """

    samples: int
    signal_directions: NDArray[np.float64]
    gauge_zero_V: NDArray[np.float64]
    limit_V: float
    limit_per_V: float
    fluctuation_V: NDArray[np.float64]
    wave_factor: _core.Rational | int
    delay_samples: float


def consistency_settings_of(joint: Joint, sample_period_s: float) -> ConsistencySettings | None:
    """Collect what holds a joint's gauges against each other.

    Parameters
    ----------
    joint : Joint
        A joint with ``[gains]``.
    sample_period_s : float
        Time from one sample to the next, s.

    Returns
    -------
    ConsistencySettings or None
        None where too little is known or there are too few gauges.

    Raises
    ------
    InputError
        If ``[gear]`` is missing, which the wave's angle needs.
    """
    gains = joint.gains
    if gains is None or not gains.gauge_signals or len(gains.gains) < 3:
        return None
    limit_V, share = gains.consistency_limit_V, gains.consistency_limit_share
    # Without its growth the limit holds without torque alone, and sound gauges exceed it under load.
    if limit_V is None or share is None:
        return None
    delay_s = 0.0
    if joint.signals is not None and joint.signals.angle_to_torque_delay_s is not None:
        delay_s = joint.signals.angle_to_torque_delay_s
    wave_V = conditions_of(gains)
    return ConsistencySettings(
        samples=_detection_samples(gains, sample_period_s),
        signal_directions=signal_directions(
            gains.torque_sensitivities or (1.0,) * len(gains.gains)
        ),
        gauge_zero_V=np.array([signal.zero_V for signal in gains.gauge_signals]),
        limit_V=limit_V,
        limit_per_V=share,
        fluctuation_V=wave_V,
        wave_factor=gear_of(joint).wave_factor if len(wave_V) else 1,
        delay_samples=delay_s / sample_period_s,
    )


def _detection_samples(gains: Gains, sample_period_s: float) -> int:
    return max(3, round((gains.detection_time_s or DETECTION_TIME_S) / sample_period_s))


def _consistency_of(joint: Joint, sample_period_s: float) -> _core.ConsistencyCheck | None:
    settings = consistency_settings_of(joint, sample_period_s)
    return None if settings is None else _core.ConsistencyCheck(**vars(settings))


def _gains_without(gains: Gains, wave_V: NDArray[np.float64]) -> list[_core.GainsWithoutGauge]:
    zero_V = np.zeros(len(gains.gains))
    if gains.gauge_signals:
        zero_V = np.array([signal.zero_V for signal in gains.gauge_signals])
    sets = []
    for entry in gains.without_gauge:
        residual_V = entry.residual_fluctuation_V
        if residual_V is None:
            residual_V = fluctuation_rms(wave_V, entry.gains)
        shift_V = float((np.array(entry.gains) - np.array(gains.gains)) @ zero_V)
        sets.append(
            _core.GainsWithoutGauge(
                entry.gauge,
                list(entry.gains),
                zero_shift_V=shift_V,
                residual_fluctuation_V=residual_V if math.isfinite(residual_V) else 0.0,
            )
        )
    return sets
