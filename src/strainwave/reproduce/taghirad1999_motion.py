"""Taghirad & Belanger 1999, sections V and VI: free motion, its ripple, and the published filter.

The simulated station moves freely; its codes go through the sensor's chain with the gain from the
static calibration and the published filter. The truth that a simulation knows is used for one
thing only: to say what the filter took away that was no ripple.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy import signal

from strainwave import _core
from strainwave.filter import oscillator_preset
from strainwave.reproduce import published
from strainwave.sensor import TorqueSensor
from strainwave.simulate.commands import SpeedCommand
from strainwave.simulate.presets.taghirad1999 import RATED_TORQUE_NM, free_motion, taghirad1999
from strainwave.simulate.trajectories import Sine

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.simulate.results import Run

STATION: Final = taghirad1999()
RATIO: Final = float(STATION.gear.ratio)
SAMPLE_PERIOD_S: Final = 1e-3
STEADY_FROM_S: Final = 0.85


@dataclass(frozen=True)
class Experiment:
    """One free motion through the sensor's chain.

    Attributes
    ----------
    title : str
        What it is.
    time_s : numpy.ndarray
        Time stamps, shape (samples,), s.
    speed_rad_s : numpy.ndarray
        Tachometer, rad/s.
    measured_Nm : numpy.ndarray
        Calibrated torque, Nm.
    filtered_Nm : numpy.ndarray
        Output of the published filter, Nm.
    expected_Nm : numpy.ndarray
        Load inertia times acceleration, from the tachometer, Nm.
    true_Nm : numpy.ndarray
        Torque transmitted without its ripple, from the simulation, Nm.
    rejected : int
        Samples with a fault.
    """

    title: str
    time_s: NDArray[np.float64]
    speed_rad_s: NDArray[np.float64]
    measured_Nm: NDArray[np.float64]
    filtered_Nm: NDArray[np.float64]
    expected_Nm: NDArray[np.float64]
    true_Nm: NDArray[np.float64]
    rejected: int

    def ripple_rms_Nm(self) -> float:
        """Root mean square of the measured torque about its own slow course, once moving."""
        return _fast_rms(self._steady(self.measured_Nm))

    def left_rms_Nm(self) -> float:
        """Root mean square of the filter's output about its own slow course, once moving."""
        return _fast_rms(self._steady(self.filtered_Nm))

    def error_rms_Nm(self) -> float:
        """Root mean square distance of the output from the true torque, once moving."""
        return _rms(self._steady(self.filtered_Nm - self.true_Nm))

    def raw_error_rms_Nm(self) -> float:
        """Root mean square distance of the measured from the true torque, once moving."""
        return _rms(self._steady(self.measured_Nm - self.true_Nm))

    def _steady(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return values[self.time_s >= STEADY_FROM_S]


@dataclass(frozen=True)
class Signature:
    """Misalignment at constant speed over one output turn.

    Attributes
    ----------
    title : str
        As first mounted, or reassembled.
    time_s : numpy.ndarray
        Time stamps, s.
    measured_Nm : numpy.ndarray
        Calibrated torque, Nm.
    slow_Nm : numpy.ndarray
        Its mean over a motor turn at full speed, Nm; of no meaning before `STEADY_FROM_S`.
    expected_Nm : numpy.ndarray
        Load inertia times acceleration, Nm.
    peak_to_peak_Nm : float
        Peak to peak of the sine at one cycle per output turn that fits the slow course, Nm.
    """

    title: str
    time_s: NDArray[np.float64]
    measured_Nm: NDArray[np.float64]
    slow_Nm: NDArray[np.float64]
    expected_Nm: NDArray[np.float64]
    peak_to_peak_Nm: float


def sensor_chain(gain_Nm_per_V: float, preset: str) -> TorqueSensor:
    """Build the sensor of the station: one full bridge, a calibrated gain, a published filter.

    Parameters
    ----------
    gain_Nm_per_V : float
        Sensor gain from the static calibration, Nm/V.
    preset : str
        Name of the published filter.

    Returns
    -------
    TorqueSensor
        The chain in its initial state.
    """
    return TorqueSensor(
        _core.TorqueSensorConfig(
            converter=STATION.bridge.converter,
            gains=_core.Gains([1.0]),
            calibration=_core.TorqueCalibration(
                gain_Nm_per_V=gain_Nm_per_V, full_scale_Nm=RATED_TORQUE_NM
            ),
            filter=oscillator_preset(preset, STATION.gear.ratio),
        )
    )


def expected_torque_Nm(run: Run) -> NDArray[np.float64]:
    """Crude model of the torque: load inertia times acceleration, from the tachometer.

    Parameters
    ----------
    run : Run
        Recording of a free motion.

    Returns
    -------
    numpy.ndarray
        T_exp of section V, shape (samples,), Nm.
    """
    smooth = signal.savgol_filter(run.motor_speed_rad_s, 101, 2, deriv=1, delta=SAMPLE_PERIOD_S)
    return np.asarray(smooth / RATIO * STATION.load.inertia_kg_m2)


def experiment(title: str, run: Run, gain_Nm_per_V: float, preset: str) -> Experiment:
    """Run a recording through the chain.

    Parameters
    ----------
    title : str
        What it is.
    run : Run
        Recording.
    gain_Nm_per_V : float
        Sensor gain, Nm/V.
    preset : str
        Name of the published filter.

    Returns
    -------
    Experiment
        Torque before and after, beside the truth.
    """
    sensor = sensor_chain(gain_Nm_per_V, preset)
    expected = expected_torque_Nm(run)
    result = sensor.process(
        run.codes,
        motor_speed_rad_s=run.motor_speed_rad_s,
        expected_torque_Nm=expected,
        sequence=run.sequence,
    )
    return Experiment(
        title=title,
        time_s=run.time_s,
        speed_rad_s=run.motor_speed_rad_s,
        measured_Nm=np.asarray(result.torque_measured_Nm),
        filtered_Nm=np.asarray(result.torque_Nm),
        expected_Nm=expected,
        true_Nm=run.truth.torque_without_ripple_Nm,
        rejected=sensor.counters["faults"],
    )


def two_motions(misalignment: str) -> tuple[tuple[str, Run], tuple[str, Run]]:
    """Two typical experiments of figures 9 and 11.

    Parameters
    ----------
    misalignment : str
        Variant of the station.

    Returns
    -------
    tuple
        Title and recording of a run-up to constant speed and of a speed that swings.
    """
    swinging = taghirad1999(misalignment=misalignment).drive(
        SpeedCommand(Sine(60.0, 0.4, phase_rad=-np.pi / 2, offset=60.0), 0.05, 0.4), 4.8, seed=92
    )
    return (
        (
            f"run-up to {published.MOTOR_SPEED_RAD_S:g} rad/s",
            free_motion(91, misalignment=misalignment),
        ),
        ("speed swinging between 0 and 120 rad/s", swinging),
    )


def signature(title: str, misalignment: str, gain_Nm_per_V: float) -> Signature:
    """Misalignment at constant speed.

    Parameters
    ----------
    title : str
        What it is.
    misalignment : str
        Variant of the station.
    gain_Nm_per_V : float
        Sensor gain, Nm/V.

    Returns
    -------
    Signature
        Course and peak-to-peak value.
    """
    run = free_motion(101, misalignment=misalignment)
    measured = sensor_chain(gain_Nm_per_V, "taghirad1999-4").process(
        run.codes, motor_speed_rad_s=run.motor_speed_rad_s
    )
    torque = np.asarray(measured.torque_measured_Nm)
    turn = round(2 * np.pi / published.MOTOR_SPEED_RAD_S / SAMPLE_PERIOD_S)
    slow = np.convolve(torque, np.ones(turn) / turn, mode="same")
    steady = (run.time_s > STEADY_FROM_S) & (run.time_s < run.time_s[-1] - 0.05)
    angle = run.motor_angle_rad[steady] / RATIO
    basis = np.column_stack([np.sin(angle), np.cos(angle), np.ones_like(angle)])
    sine, cosine, _ = np.linalg.lstsq(basis, slow[steady], rcond=None)[0]
    return Signature(
        title,
        run.time_s,
        torque,
        slow,
        expected_torque_Nm(run),
        2 * float(np.hypot(sine, cosine)),
    )


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _fast_rms(values: NDArray[np.float64]) -> float:
    """Root mean square above 5 Hz, where ripple is and the motion is not."""
    fast = signal.butter(4, 5.0, "highpass", fs=1 / SAMPLE_PERIOD_S, output="sos")
    return _rms(np.asarray(signal.sosfiltfilt(fast, values)))
