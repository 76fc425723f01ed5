"""Static calibration on a test station: arm and weight, wave generator locked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.errors import ConfigurationError
from strainwave.simulate.checks import require_number
from strainwave.simulate.driving import loading_sequence
from strainwave.simulate.results import Run
from strainwave.simulate.station import Station
from strainwave.simulate.temperature import constant_temperature
from strainwave.simulate.trajectories import FloatArray

DWELL_S = 0.4
CHANGE_S = 0.1


@dataclass(frozen=True)
class LoadingExperiment:
    """One series of weights; k weights, C channels.

    Parameters
    ----------
    position_rad : float
        Angle at which the wave generator was locked, rad.
    temperature_degC : float
        Temperature, degrees C.
    applied_torque_Nm : ndarray, shape (k,)
        Torque by weight and nominal arm, Nm, in the order of loading.
    increasing : ndarray of bool, shape (k,)
        True where the torque's magnitude was reached from below.
    volts : ndarray, shape (k, C)
        Mean voltage while each weight hung, less zero_V.
    zero_V : ndarray, shape (C,)
        Mean voltage before the first weight.
    arm_error : float
        Truth: relative error of the arm's length, which is unknown to the experimenter.
    run : Run
        The whole recording with its truth.
    """

    position_rad: float
    temperature_degC: float
    applied_torque_Nm: FloatArray
    increasing: NDArray[np.bool_]
    volts: FloatArray
    zero_V: FloatArray
    arm_error: float
    run: Run

    @property
    def direction(self) -> int:
        """+1 or -1: sense of the torque; 0 where both occur."""
        positive = bool(np.any(self.applied_torque_Nm > 0))
        negative = bool(np.any(self.applied_torque_Nm < 0))
        return int(positive) - int(negative)

    @property
    def range_Nm(self) -> float:
        """Largest torque applied, Nm."""
        return float(np.max(np.abs(self.applied_torque_Nm)))


def load_by_weights(
    station: Station,
    torques_Nm: Sequence[float],
    seed: int,
    *,
    position_rad: float = 0.0,
    temperature_degC: float | None = None,
    arm_error: float = 0.0,
) -> LoadingExperiment:
    """Hang weights on a station's arm one after another and read the sensor.

    Parameters
    ----------
    station : Station
        The station.
    torques_Nm : sequence of float
        Torque of each weight with the nominal arm, Nm, in the order of loading, without the zero
        reading before the first, which is always taken.  `up_and_down` makes such a series.
    seed : int
        Seed of everything random.
    position_rad : float
        Angle at which the wave generator is locked, rad.
    temperature_degC : float, optional
        Temperature of the experiment; the station's own where not given.
    arm_error : float
        Relative error of the arm's length as mounted, within +-0.5.

    Returns
    -------
    LoadingExperiment
        Readings, recording and truth.
    """
    if not isinstance(torques_Nm, Sequence | np.ndarray):
        raise ConfigurationError("torques_Nm", torques_Nm, "", "a list of torques")
    if len(torques_Nm) == 0:
        raise ConfigurationError("torques_Nm", 0, "weights", "at least 1")
    for torque in torques_Nm:
        require_number("torques_Nm", torque, "Nm")
    require_number("arm_error", arm_error, "", minimum=-0.5, maximum=0.5)
    if temperature_degC is not None:
        steady = constant_temperature(station.temperature, temperature_degC)
        station = station.with_changes(temperature=steady)
    nominal = np.array([0.0, *torques_Nm])
    applied = loading_sequence((nominal * (1 + arm_error)).tolist(), DWELL_S, CHANGE_S)
    step_s = DWELL_S + CHANGE_S
    run = station.hold(applied, len(nominal) * step_s, seed, position_rad)
    # The second half of every dwell: the first lets the reader's hand leave the weight.
    within = np.floor(run.time_s / step_s).astype(np.int64)
    since = run.time_s - within * step_s
    settled = (since > DWELL_S / 2) & (since < DWELL_S)
    volts = np.stack([run.volts[settled & (within == k)].mean(axis=0) for k in range(len(nominal))])
    before = np.abs(np.concatenate(([0.0], nominal[1:-1])))
    return LoadingExperiment(
        position_rad=position_rad,
        temperature_degC=float(run.temperature_degC[0]),
        applied_torque_Nm=nominal[1:],
        increasing=np.asarray(np.abs(nominal[1:]) > before),
        volts=volts[1:] - volts[0],
        zero_V=volts[0],
        arm_error=arm_error,
        run=run,
    )
