"""Taghirad & Belanger 1999: static calibration, and all of the paper's results in one place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.torque import Consistency, SensorGain, consistency, sensor_gain
from strainwave.reproduce.taghirad1999_motion import (
    Experiment,
    Signature,
    experiment,
    signature,
    two_motions,
)
from strainwave.reproduce.taghirad1999_spectrum import Spectrum, spectrum
from strainwave.simulate.presets.taghirad1999 import calibration_experiments

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from strainwave.simulate.loading import LoadingExperiment

CALIBRATION_SEED: Final = 1999


@dataclass(frozen=True)
class Loading:
    """One loading experiment and its gain.

    Attributes
    ----------
    position_rad : float
        Angle at which the wave generator was locked, rad.
    range_Nm : float
        Largest torque, Nm.
    direction : int
        +1 or -1; 0 for loads in both directions.
    temperature_degC : float
        Temperature, degrees Celsius.
    volts : numpy.ndarray
        Readings, shape (loads,), V.
    torque_Nm : numpy.ndarray
        Applied torque, shape (loads,), Nm.
    line : SensorGain
        Least-squares line through the origin.
    """

    position_rad: float
    range_Nm: float
    direction: int
    temperature_degC: float
    volts: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    line: SensorGain


@dataclass(frozen=True)
class StaticCalibration:
    """Table I and fig. 7.

    Attributes
    ----------
    loadings : tuple of Loading
        Eight experiments.
    result : Consistency
        Final gain, consistency measure, and what they support.
    full_range : Loading
        The full-range experiment of fig. 7.
    """

    loadings: tuple[Loading, ...]
    result: Consistency
    full_range: Loading


@dataclass(frozen=True)
class Taghirad1999:
    """Everything the paper shows with numbers.

    Attributes
    ----------
    calibration : StaticCalibration
        Table I, fig. 7.
    spectrum : Spectrum
        Fig. 8.
    ripple : tuple of Experiment
        Fig. 9: two experiments with four states.
    signatures : tuple of Signature
        Fig. 10: as first mounted, and reassembled.
    misalignment : tuple of Experiment
        Fig. 11: two experiments with six states.
    """

    calibration: StaticCalibration
    spectrum: Spectrum
    ripple: tuple[Experiment, ...]
    signatures: tuple[Signature, ...]
    misalignment: tuple[Experiment, ...]


def _loading(measured: LoadingExperiment) -> Loading:
    volts = measured.volts[:, 0]
    return Loading(
        position_rad=measured.position_rad,
        range_Nm=measured.range_Nm,
        direction=measured.direction,
        temperature_degC=measured.temperature_degC,
        volts=volts,
        torque_Nm=measured.applied_torque_Nm,
        line=sensor_gain(volts, measured.applied_torque_Nm),
    )


def static_calibration() -> StaticCalibration:
    """Load the simulated station in eight experiments and combine their gains.

    Returns
    -------
    StaticCalibration
        Final gain and its consistency.
    """
    loadings = tuple(_loading(each) for each in calibration_experiments(CALIBRATION_SEED))
    result = consistency([loading.line.gain_Nm_per_V for loading in loadings])
    full_range = max(loadings, key=lambda loading: loading.range_Nm)
    return StaticCalibration(loadings, result, full_range)


def run(on_step: Callable[[str], None] = lambda _: None) -> Taghirad1999:
    """Calibrate the simulated station, move it, and filter its torque.

    Parameters
    ----------
    on_step : callable
        Told what begins.

    Returns
    -------
    Taghirad1999
        Every result.
    """
    on_step("eight calibration experiments")
    calibration = static_calibration()
    gain = calibration.result.gain_Nm_per_V
    on_step("free motion and its ripple")
    ripple = tuple(
        experiment(title, motion, gain, "taghirad1999-4") for title, motion in two_motions("none")
    )
    on_step("misalignment before and after re-assembly")
    signatures = (
        signature("as first mounted", "as_first_mounted", gain),
        signature("reassembled", "reassembled", gain),
    )
    on_step("ripple and misalignment together")
    misalignment = tuple(
        experiment(title, motion, gain, "taghirad1999")
        for title, motion in two_motions("as_first_mounted")
    )
    return Taghirad1999(calibration, spectrum(ripple[0]), ripple, signatures, misalignment)
