"""The gear of Godler et al. 2000 with five gauges, and its joint file made from its own runs.

Amplitudes and phases scatter as in the paper's three-gauge build. What a sensor knows of the joint
is fitted to recordings with noise and converter, as at commissioning; nothing is taken from the
station's description but the torque gain, which stands for a calibration with weights.
"""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from strainwave.calibrate.fluctuation import compensation_conditions, fit_fluctuation
from strainwave.calibrate.gains import compensating_gains
from strainwave.calibrate.gauge_watch import (
    consistency_limits,
    fluctuation_rms,
)
from strainwave.calibrate.lost_gauge import gains_without_each
from strainwave.joint import (
    Gains,
    GainsWithoutGauge,
    Gauges,
    GaugeSignal,
    Gear,
    Identity,
    Joint,
    Provenance,
    RippleFilter,
    Rosette,
    Signals,
    TorqueCalibration,
)
from strainwave.simulate import (
    GaugePlacement,
    PiecewiseLinear,
    Run,
    Station,
    Temperature,
    constant_speed,
    godler2000,
)

GAUGES: Final = 5
RATED_TORQUE_NM: Final = 100.0
RATE_HZ: Final = 1000.0
#: Of harmonics 1 to 3; the first three gauges are those of the paper's build.
SCALES: Final = (
    (1.0, 1.0, 1.0),
    (1.07, 1.07, 1.0),
    (1.15, 0.96, 1.0),
    (0.94, 1.04, 1.0),
    (1.03, 0.95, 1.0),
)
PHASE_ERRORS_DEG: Final = (
    (0.0, 0.0, 0.0),
    (-1.5, 3.0, 0.0),
    (-0.4, -4.0, 0.0),
    (1.8, 2.0, 0.0),
    (-0.9, -2.5, 0.0),
)
#: The gauges' zeros do not drift alike: this times the station's 2e-7 strain per kelvin.
DRIFTS: Final = (1.0, 1.4, 0.7, 1.2, 0.8)
#: Harmonics that all five cancel, and that four have to.
HARMONICS: Final = 2
HARMONICS_WITHOUT: Final = 1


def five_gauge_station() -> Station:
    """Return the station.

    Returns
    -------
    Station
        Five gauges at 36 degrees, flexspline fixed, ratio 51.
    """
    three = godler2000(3)
    gauges = tuple(
        GaugePlacement(
            position_rad=math.pi * j / GAUGES,
            radius_m=three.gauges[0].radius_m,
            wave_scale=SCALES[j],
            wave_phase_error_rad=tuple(math.radians(each) for each in PHASE_ERRORS_DEG[j]),
        )
        for j in range(GAUGES)
    )
    drift = three.temperature.zero_strain_per_K
    assert isinstance(drift, float)
    temperature = Temperature(
        zero_strain_per_K=tuple(drift * each for each in DRIFTS),
        gain_per_K=three.temperature.gain_per_K,
    )
    return three.with_changes(gauges=gauges, temperature=temperature)


def volts_of(run: Run) -> NDArray[np.float64]:
    """Return the gauges' voltages of a recording.

    Parameters
    ----------
    run : Run
        The recording.

    Returns
    -------
    ndarray, shape (n, gauges)
        V.
    """
    converter = run.converter
    step_V = (converter.maximum_V - converter.minimum_V) / 2**converter.bits
    return np.asarray(converter.minimum_V + (run.codes - converter.lowest_code) * step_V)


def changing_load(
    generator: np.random.Generator, duration_s: float, largest_Nm: float
) -> PiecewiseLinear:
    """Return contacts: torques that come within 20 ms, stay, drift and go.

    Parameters
    ----------
    generator : numpy.random.Generator
        Source of the torques and times.
    duration_s : float
        Length, s.
    largest_Nm : float
        Largest torque of either sign, Nm.

    Returns
    -------
    PiecewiseLinear
        Torque, Nm.
    """
    times, torques, now = [0.0], [float(generator.uniform(-largest_Nm, largest_Nm))], 0.0
    while now < duration_s:
        now += float(generator.uniform(0.1, 1.0))
        times += [now, now + 0.02]
        drifted = torques[-1] * float(generator.uniform(0.8, 1.0))
        torques += [drifted, float(generator.uniform(-largest_Nm, largest_Nm))]
        now += 0.02
    return PiecewiseLinear(tuple(times), tuple(torques))


def changing_speed(
    generator: np.random.Generator, duration_s: float, largest_rad_s: float
) -> PiecewiseLinear:
    """Return speeds of either direction with rests between, for hours of use.

    Parameters
    ----------
    generator : numpy.random.Generator
        Source of speeds and times.
    duration_s : float
        Length, s.
    largest_rad_s : float
        Largest motor speed, rad/s.

    Returns
    -------
    PiecewiseLinear
        Motor speed, rad/s.
    """
    times, speeds = [0.0], [0.0]
    while times[-1] < duration_s:
        speed = float(generator.uniform(-largest_rad_s, largest_rad_s))
        target = speed if generator.random() > 0.3 else 0.0
        times.append(times[-1] + float(generator.uniform(0.3, 1.0)))
        speeds.append(target)
        times.append(times[-1] + float(generator.uniform(0.5, 4.0)))
        speeds.append(target)
    return PiecewiseLinear(tuple(times), tuple(speeds))


def commissioned_joint(station: Station, seed: int) -> Joint:
    """Fit everything the sensor knows to recordings of the sound station.

    Parameters
    ----------
    station : Station
        The station.
    seed : int
        Seed of the recordings.

    Returns
    -------
    Joint
        As `strainwave.configuration.sensor_of` takes it.
    """
    slow = station.rotate(constant_speed(2 * math.pi, 0.0), 10.0, seed)
    placed = [gauge.position_rad for gauge in station.gauges]
    factor = station.wave_factor
    volts = volts_of(slow)
    fit = fit_fluctuation(
        volts, slow.motor_angle_rad, positions_rad=placed, harmonics=HARMONICS, wave_factor=factor
    )
    conditions = compensation_conditions(fit.amplitudes, fit.phase_errors_rad, placed)
    solved = compensating_gains(conditions)
    without, _ = gains_without_each([conditions[: 2 * HARMONICS_WITHOUT]], np.ones(GAUGES))
    limits = _limits(station, seed, fit.offsets, conditions)
    phases = fit.phase_errors_rad + 2 * np.outer(np.arange(1, HARMONICS + 1), placed)
    standing = station.rotate(constant_speed(0.0, 0.0), 2.0, seed + 1)
    provenance = Provenance(
        input="simulated station", created=datetime(2026, 1, 1, tzinfo=UTC), version="0"
    )
    converter = station.bridge.converter
    sections: dict[str, Any] = {
        "gear": Gear(
            ratio=float(station.gear.ratio),
            configuration="fixed_flexspline",
            rated_torque_Nm=RATED_TORQUE_NM,
            provenance=provenance,
        ),
        "gauges": Gauges(
            wiring="half_bridge_each",
            bridge_supply_V=station.bridge.supply_V,
            amplifier_gain=float(station.bridge.amplifier.gain),
            converter_bits=converter.bits,
            converter_minimum_V=converter.minimum_V,
            converter_maximum_V=converter.maximum_V,
            converter_lowest_code=converter.lowest_code,
            torn_gauge_rail="upper",
            rosettes=tuple(
                Rosette(position_rad=gauge.position_rad, gauge_factor=gauge.gauge_factor)
                for gauge in station.gauges
            ),
            provenance=provenance,
        ),
        "signals": Signals(sampling_rate_Hz=RATE_HZ, provenance=provenance),
        "gains": Gains(
            gains=tuple(solved.gains.tolist()),
            harmonics=tuple(range(1, HARMONICS + 1)),
            noise_factor=max(1.0, solved.noise_factor),
            residual_fluctuation_V=fluctuation_rms(conditions, solved.gains),
            without_gauge=tuple(
                GainsWithoutGauge(
                    gauge=each.gauge,
                    gains=tuple(each.gains.tolist()),
                    noise_factor=each.noise_factor,
                    residual_fluctuation_V=fluctuation_rms(conditions, each.gains),
                )
                for each in without
            ),
            gauge_signals=tuple(
                GaugeSignal(
                    zero_V=float(fit.offsets[j]),
                    amplitudes_V=tuple(fit.amplitudes[:, j].tolist()),
                    phases_rad=tuple(phases[:, j].tolist()),
                )
                for j in range(GAUGES)
            ),
            noise_V=float(np.mean(np.std(volts_of(standing), axis=0))),
            consistency_limit_V=limits[0],
            consistency_limit_share=limits[1],
            provenance=provenance,
        ),
        "torque_calibration": TorqueCalibration(
            gain_Nm_per_V=station.sensor_gain_Nm_per_V,
            zero_V=float(fit.offsets @ solved.gains),
            provenance=provenance,
        ),
        "ripple_filter": RippleFilter(
            method="ripple",
            orders=(2, 4),
            memory_turns=30.0,
            torque_noise_Nm=0.03,
            torque_walk_Nm_per_sqrt_s=30.0,
            provenance=provenance,
        ),
    }
    return Joint(joint=Identity(name="five gauges"), **sections)


def _limits(
    station: Station,
    seed: int,
    zeros_V: NDArray[np.float64],
    conditions: NDArray[np.float64],
) -> tuple[float, float]:
    """Measure the sound gauges over loads, speeds and 10 K more and less, for two minutes."""
    generator = np.random.default_rng(seed)
    duration_s = 120.0
    warming = Temperature(
        times_s=(0.0, 30.0, 90.0, duration_s),
        values_degC=(20.0, 30.0, 10.0, 20.0),
        zero_strain_per_K=station.temperature.zero_strain_per_K,
        gain_per_K=station.temperature.gain_per_K,
    )
    run = station.with_changes(temperature=warming).rotate(
        changing_speed(generator, duration_s, 150.0),
        duration_s,
        seed + 2,
        contact_torque=changing_load(generator, duration_s, RATED_TORQUE_NM),
    )
    limits = consistency_limits(
        volts_of(run),
        station.wave_factor * run.motor_angle_rad,
        zeros=zeros_V,
        conditions=conditions,
    )
    return limits.limit, limits.share
