"""What a run of a test station gives: the recording, and beside it the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import strainwave._core as core
from strainwave.simulate.trajectories import FloatArray


@dataclass(frozen=True)
class Truth:
    """What was really there; n rows, M gauges, C channels.

    What belongs to the torque is taken when the row's bridge was sampled, what belongs to the
    motion when its angle was; the two differ by angle_to_torque_delay_s.  A repeated row has the
    truth of its own instant, not of the sample that it repeats.

    torque_Nm = torque_without_ripple_Nm + mesh_ripple_Nm, and
    sensed_torque_Nm = torque_Nm - unsensed_hysteresis_Nm + misalignment_Nm + sensing_ripple_Nm,
    up to gain errors (temperature, detached gauges) and zero drift.

    Parameters
    ----------
    instant_s : ndarray, shape (n,)
        When angle, speed and current were sampled, s.
    torque_instant_s : ndarray, shape (n,)
        When the bridge was sampled, s.
    torque_Nm : ndarray, shape (n,)
        Transmitted torque at the output side, real mesh ripple included.
    torque_without_ripple_Nm : ndarray, shape (n,)
        The same without mesh ripple.
    mesh_ripple_Nm : ndarray, shape (n,)
        Real ripple, as transmitted.
    hysteresis_Nm : ndarray, shape (n,)
        Hysteresis torque of the flexspline, a part of torque_without_ripple_Nm.
    unsensed_hysteresis_Nm : ndarray, shape (n,)
        What of it passes by the gauges.
    misalignment_Nm : ndarray, shape (n,)
        Crosstalk of the misaligned load: read, not transmitted.
    sensing_ripple_Nm : ndarray, shape (n,)
        What the strain that turns with the wave adds to the sum of all gauges with equal gains:
        read, not transmitted.
    fluctuation_Nm : ndarray, shape (n, M)
        What each gauge adds to that sum.
    sensed_torque_Nm : ndarray, shape (n,)
        What perfect electronics would read, by the station's sensor gain.
    strain : ndarray, shape (n, M)
        epsilon_1 - epsilon_2 of each rosette.
    motor_angle_rad, motor_speed_rad_s, motor_acceleration_rad_s2 : ndarray, shape (n,)
        Motor, exact.
    motor_angle_at_torque_rad : ndarray, shape (n,)
        Motor angle when the bridge was sampled.
    motor_torque_Nm : ndarray, shape (n,)
        Torque of the motor's current.
    output_angle_rad, output_speed_rad_s : ndarray, shape (n,)
        Output, in its own sense of rotation.
    temperature_degC : ndarray, shape (n,)
        Temperature of the flexspline.
    faulty : ndarray of bool, shape (n, C)
        True while a channel has a fault.
    repeated : ndarray of bool, shape (n,)
        True where the row repeats an earlier one.
    """

    instant_s: FloatArray
    torque_instant_s: FloatArray
    torque_Nm: FloatArray
    torque_without_ripple_Nm: FloatArray
    mesh_ripple_Nm: FloatArray
    hysteresis_Nm: FloatArray
    unsensed_hysteresis_Nm: FloatArray
    misalignment_Nm: FloatArray
    sensing_ripple_Nm: FloatArray
    fluctuation_Nm: FloatArray
    sensed_torque_Nm: FloatArray
    strain: FloatArray
    motor_angle_rad: FloatArray
    motor_speed_rad_s: FloatArray
    motor_acceleration_rad_s2: FloatArray
    motor_angle_at_torque_rad: FloatArray
    motor_torque_Nm: FloatArray
    output_angle_rad: FloatArray
    output_speed_rad_s: FloatArray
    temperature_degC: FloatArray
    faulty: NDArray[np.bool_]
    repeated: NDArray[np.bool_]


@dataclass(frozen=True)
class Run:
    """One simulated recording; n rows, C channels.

    Parameters
    ----------
    time_s : ndarray, shape (n,)
        Time stamps, s, with their jitter.
    codes : ndarray of int32, shape (n, C)
        Converter codes: a channel a gauge, or one for a full bridge.
    motor_speed_rad_s : ndarray, shape (n,)
        Tachometer.
    motor_angle_rad : ndarray, shape (n,)
        Motor encoder as an angle.
    motor_counts, output_counts : ndarray of int64, shape (n,)
        Counts of both encoders.
    output_angle_rad : ndarray, shape (n,)
        Output encoder as an angle, in the output's own sense of rotation: with the circular
        spline fixed it falls as the motor angle rises.
    current_A : ndarray, shape (n,)
        Measured motor current.
    temperature_degC : ndarray, shape (n,)
        Thermometer on the station.
    sequence : ndarray of uint32, shape (n,)
        Number of the sample in the row; repeats keep it, losses leave a gap.
    truth : Truth
        What was really there.
    converter : strainwave._core.Converter
        What the codes mean.
    sensor_gain_Nm_per_V : float
        Torque by the sum of all channels' voltages, as the station was built.
    """

    time_s: FloatArray
    codes: NDArray[np.int32]
    motor_speed_rad_s: FloatArray
    motor_angle_rad: FloatArray
    motor_counts: NDArray[np.int64]
    output_counts: NDArray[np.int64]
    output_angle_rad: FloatArray
    current_A: FloatArray
    temperature_degC: FloatArray
    sequence: NDArray[np.uint32]
    truth: Truth
    converter: core.Converter
    sensor_gain_Nm_per_V: float

    @property
    def volts(self) -> FloatArray:
        """Voltages of the codes at the amplifiers' outputs, V, shape (n, C)."""
        columns = [
            self.converter.to_volts(np.ascontiguousarray(self.codes[:, channel]))
            for channel in range(self.codes.shape[1])
        ]
        return np.stack(columns, axis=1)

    @property
    def raw_torque_Nm(self) -> FloatArray:
        """Sum of all channels times the sensor gain, Nm, shape (n,): torque before any filter."""
        return np.asarray(self.volts.sum(axis=1) * self.sensor_gain_Nm_per_V)
