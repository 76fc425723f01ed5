"""From a station's motion to its recording: strain, bridge, amplifier, converter, rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import strainwave._core as core
from strainwave.simulate.acquisition import Rows
from strainwave.simulate.description import StationDescription
from strainwave.simulate.faults import (
    Fault,
    FaultKind,
    faulty_bridge_V,
    faulty_codes,
    remaining_strain,
)
from strainwave.simulate.motion import Motion
from strainwave.simulate.results import Run, Truth
from strainwave.simulate.strain_field import FieldInputs, GaugePlacement, strain_at
from strainwave.simulate.trajectories import FloatArray


@dataclass(frozen=True)
class _Gauges:
    """Strains of all rosettes, each (n, M), and what they mean as torque."""

    first: FloatArray
    second: FloatArray
    fluctuation_Nm: FloatArray
    sensed_torque_Nm: FloatArray
    rosettes: list[core.Rosette]


def _rosette(gauge: GaugePlacement) -> core.Rosette:
    return core.Rosette(
        position_rad=gauge.position_rad,
        radius_m=gauge.radius_m,
        orientation_error_rad=gauge.orientation_error_rad,
        gauge_factor=gauge.gauge_factor,
    )


def _gauge_strains(
    station: StationDescription,
    inputs: FieldInputs,
    instant_s: FloatArray,
    temperature_degC: FloatArray,
) -> _Gauges:
    """Strains along every gauge, with temperature and bonds that give way."""
    count = len(station.gauges)
    shape = (len(instant_s), count)
    first, second, fluctuation = np.empty(shape), np.empty(shape), np.empty(shape)
    sensed = np.zeros(len(instant_s))
    temperature = station.temperature
    gain_Nm_per_V = station.sensor_gain_Nm_per_V
    rosettes = [_rosette(gauge) for gauge in station.gauges]
    for j, (gauge, rosette) in enumerate(zip(station.gauges, rosettes, strict=True)):
        strain = strain_at(station.strain_field, gauge, inputs)
        seen = temperature.gain(temperature_degC) * remaining_strain(station.faults, j, instant_s)
        drift = temperature.apparent_strain(temperature_degC, j)
        first[:, j], second[:, j] = rosette.strain(
            seen * strain.radial,
            seen * strain.circumferential,
            seen * (strain.torsional + strain.wave_shear) + drift,
        )
        wave = rosette.strain(
            seen * strain.radial, seen * strain.circumferential, seen * strain.wave_shear
        )
        Nm_per_strain = gain_Nm_per_V * station.bridge.volts_per_strain(gauge, count)
        fluctuation[:, j] = (wave[0] - wave[1]) * Nm_per_strain
        sensed += (first[:, j] - second[:, j]) * Nm_per_strain
    return _Gauges(first, second, fluctuation, sensed, rosettes)


def _channel_faults(station: StationDescription, channel: int) -> tuple[Fault, ...]:
    shared = station.bridge.wiring == "full_bridge"
    return tuple(fault for fault in station.faults if shared or fault.gauge == channel)


def _codes(
    station: StationDescription,
    gauges: _Gauges,
    instant_s: FloatArray,
    generator: np.random.Generator,
) -> NDArray[np.int32]:
    """Bridge, noise, amplifier and converter of every channel: shape (n, C)."""
    bridge = station.bridge
    amplifier = bridge.amplifier
    # Noise is stated at the output and enters in front, so that the rails end it as well.
    noise_V = station.acquisition.noise_V / float(amplifier.gain)
    codes = np.empty((len(instant_s), station.channel_count), dtype=np.int32)
    for channel in range(station.channel_count):
        if bridge.wiring == "full_bridge":
            sound_V = core.full_bridge_V(
                gauges.rosettes, gauges.first, gauges.second, bridge.supply_V
            )
        else:
            sound_V = gauges.rosettes[channel].half_bridge_V(
                np.ascontiguousarray(gauges.first[:, channel]),
                np.ascontiguousarray(gauges.second[:, channel]),
                bridge.supply_V,
            )
        faults = _channel_faults(station, channel)
        bridge_V = faulty_bridge_V(faults, sound_V, instant_s, bridge.supply_V)
        noisy_V = bridge_V + noise_V * generator.standard_normal(len(instant_s))
        converted = bridge.converter.to_code(amplifier.amplified_V(noisy_V))
        codes[:, channel] = faulty_codes(faults, converted, instant_s)
    return codes


def _fault_mask(station: StationDescription, instant_s: FloatArray) -> NDArray[np.bool_]:
    mask = np.zeros((len(instant_s), station.channel_count), dtype=bool)
    for channel in range(station.channel_count):
        for fault in _channel_faults(station, channel):
            if fault.kind is not FaultKind.DETACHED or fault.remaining < 1.0:
                mask[:, channel] |= fault.active(instant_s)
    return mask


def measure(
    station: StationDescription, motion: Motion, rows: Rows, generators: list[np.random.Generator]
) -> Run:
    """Record a motion with a station's sensor and data acquisition.

    Parameters
    ----------
    station : StationDescription
        The station.
    motion : Motion
        What its mechanics did, on a grid finer than the rows.
    rows : Rows
        When the rows are taken.
    generators : list of numpy.random.Generator
        Sources of the noise of bridge, tachometer and current, apart from each other, so that a
        change of one leaves the others as they are.

    Returns
    -------
    Run
        Recording and truth.
    """
    for_bridge, for_tachometer, for_current = generators
    acquisition = station.acquisition
    instant = rows.instant_s
    torque_instant = np.maximum(instant - acquisition.angle_to_torque_delay_s, 0.0)

    def at(when_s: FloatArray, quantity: FloatArray) -> FloatArray:
        return np.asarray(np.interp(when_s, motion.time_s, quantity), dtype=np.float64)

    direction = float(station.gear.output_direction)
    torque = at(torque_instant, motion.torque_Nm)
    smooth = at(torque_instant, motion.torque_without_ripple_Nm)
    hysteresis = at(torque_instant, motion.hysteresis_Nm)
    angle_at_torque = at(torque_instant, motion.motor_angle_rad)
    misalignment = station.misalignment.torque_Nm(
        direction * at(torque_instant, motion.output_angle_rad)
    )
    field = station.strain_field
    bypassed = field.bypassed_hysteresis * hysteresis
    torsion = at(torque_instant, motion.torsion_rad)
    inputs = FieldInputs(
        wave_angle_rad=station.wave_factor * angle_at_torque,
        motor_speed_rad_s=at(torque_instant, motion.motor_speed_rad_s),
        strained_torque_Nm=torque - bypassed + misalignment,
        windup=torsion * station.flexspline.stiffness_Nm_per_rad / field.rated_torque_Nm,
    )
    temperature = station.temperature.value_degC(torque_instant)
    gauges = _gauge_strains(station, inputs, torque_instant, temperature)
    codes = _codes(station, gauges, torque_instant, for_bridge)

    angle = at(instant, motion.motor_angle_rad)
    speed = at(instant, motion.motor_speed_rad_s)
    motor_torque = at(instant, motion.motor_torque_Nm)
    output = direction * at(instant, motion.output_angle_rad)
    current = motor_torque / station.motor.torque_constant_Nm_per_A
    current = current + acquisition.current_noise_A * for_current.standard_normal(len(instant))
    shown_speed = station.tachometer.speed_rad_s(speed, angle, for_tachometer)
    motor_counts = station.motor_encoder.counts(angle)[rows.source]
    output_counts = station.output_encoder.counts(output)[rows.source]
    truth = Truth(
        instant_s=instant,
        torque_instant_s=torque_instant,
        torque_Nm=torque,
        torque_without_ripple_Nm=smooth,
        mesh_ripple_Nm=torque - smooth,
        hysteresis_Nm=hysteresis,
        unsensed_hysteresis_Nm=bypassed,
        misalignment_Nm=misalignment,
        sensing_ripple_Nm=gauges.fluctuation_Nm.sum(axis=1),
        fluctuation_Nm=gauges.fluctuation_Nm,
        sensed_torque_Nm=gauges.sensed_torque_Nm,
        strain=gauges.first - gauges.second,
        motor_angle_rad=angle,
        motor_speed_rad_s=speed,
        motor_acceleration_rad_s2=at(instant, motion.motor_acceleration_rad_s2),
        motor_angle_at_torque_rad=angle_at_torque,
        motor_torque_Nm=motor_torque,
        output_angle_rad=output,
        output_speed_rad_s=direction * at(instant, motion.output_speed_rad_s),
        temperature_degC=temperature,
        faulty=_fault_mask(station, torque_instant),
        repeated=rows.source != np.arange(len(instant)),
    )
    return Run(
        time_s=rows.stamp_s,
        codes=codes[rows.source],
        motor_speed_rad_s=shown_speed[rows.source],
        motor_angle_rad=station.motor_encoder.angle_rad(motor_counts),
        motor_counts=motor_counts,
        output_counts=output_counts,
        output_angle_rad=station.output_encoder.angle_rad(output_counts),
        current_A=current[rows.source],
        temperature_degC=temperature[rows.source],
        sequence=rows.sequence,
        truth=truth,
        converter=station.bridge.converter,
        sensor_gain_Nm_per_V=station.sensor_gain_Nm_per_V,
    )
