"""Taghirad & Belanger 1999: static calibration, and all of the paper's results in one place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.torque import Consistency, SensorGain, consistency, sensor_gain
from strainwave.reproduce import published
from strainwave.reproduce.comparison import Comparison, within
from strainwave.reproduce.taghirad1999_motion import (
    Experiment,
    Signature,
    Spectrum,
    experiment,
    signature,
    spectrum,
    two_motions,
)
from strainwave.simulate.presets.taghirad1999 import RATED_TORQUE_NM, calibration_experiments

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
        +1 or -1.
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


def comparisons(result: Taghirad1999) -> dict[str, tuple[Comparison, ...]]:
    """Compare with the paper, figure by figure.

    Parameters
    ----------
    result : Taghirad1999
        What was run here.

    Returns
    -------
    dict
        Comparisons by place: "table1", "fig7", "fig8", "fig10".
    """
    calibration = result.calibration
    # A line of 0.3 s is 2 pi / 0.3 s wide, which is as near as a peak can be read.
    width_rad_s = 2 * np.pi / (published.SPECTRUM_END_S - published.SPECTRUM_START_S)
    as_mounted, reassembled = result.signatures
    return {
        "table1": (
            within(
                "T Table I",
                "torque sensor gain, mean of eight experiments",
                "6.60",
                calibration.result.gain_Nm_per_V,
                unit="Nm/V",
                expected=published.SENSOR_GAIN_NM_PER_V,
                tolerance=0.0142,  # twice the standard uncertainty of a mean of eight, 0.71 %
            ),
            Comparison(
                "T Table I",
                "consistency measure over eight experiments",
                "2",
                100 * calibration.result.consistency,
                "%",
                # 95 % confidence interval of a standard deviation of 2 % over eight experiments
                1.3,
                4.1,
                "simulated",
            ),
        ),
        "fig7": (
            within(
                "T fig. 7",
                "gain of a full-range loading",
                "6.60 (line)",
                calibration.full_range.line.gain_Nm_per_V,
                unit="Nm/V",
                expected=published.SENSOR_GAIN_NM_PER_V,
                tolerance=0.05,  # 95 % prediction for one more position
            ),
        ),
        "fig8": (
            Comparison(
                "T fig. 8",
                "speed from 0.8 to 1.1 s",
                "about 156",
                result.spectrum.speed_rad_s,
                "rad/s",
                154.0,
                158.0,
                "simulated",
            ),
            *(
                Comparison(
                    "T fig. 8",
                    name,
                    f"{expected:g}",
                    peak,
                    "rad/s",
                    expected - width_rad_s / 2,
                    expected + width_rad_s / 2,
                    "simulated",
                )
                for name, expected, peak in zip(
                    ("larger peaks of the torque's spectrum, first", "second"),
                    (published.FUNDAMENTAL_RAD_S, published.FIRST_HARMONIC_RAD_S),
                    result.spectrum.peaks_rad_s,
                    strict=True,
                )
            ),
        ),
        "fig10": (
            within(
                "T fig. 10",
                "misalignment as first mounted, peak to peak",
                "10",
                as_mounted.peak_to_peak_Nm,
                unit="Nm",
                expected=published.MISALIGNMENT_MOUNTED_NM,
                tolerance=0.1,
            ),
            Comparison(
                "T section VI",
                "misalignment reassembled, peak to peak",
                "less than 2",
                reassembled.peak_to_peak_Nm,
                "Nm",
                0.5,
                published.MISALIGNMENT_REASSEMBLED_NM,
                "simulated",
            ),
        ),
    }


__all__ = [
    "RATED_TORQUE_NM",
    "Loading",
    "StaticCalibration",
    "Taghirad1999",
    "comparisons",
    "run",
    "static_calibration",
]
