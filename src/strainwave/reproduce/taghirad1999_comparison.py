"""Taghirad & Belanger 1999 beside the simulated station, place by place.

Figures 7, 9 and 11 are run as well, but the paper prints no number for them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.reproduce import published
from strainwave.reproduce.comparison import Comparison, within

if TYPE_CHECKING:
    from strainwave.reproduce.taghirad1999 import StaticCalibration, Taghirad1999
    from strainwave.reproduce.taghirad1999_motion import Signature
    from strainwave.reproduce.taghirad1999_spectrum import Spectrum


def comparisons(result: Taghirad1999) -> dict[str, tuple[Comparison, ...]]:
    """Compare with the paper, place by place.

    Parameters
    ----------
    result : Taghirad1999
        What was run here.

    Returns
    -------
    dict
        Comparisons by place: "table1", "fig8", "fig10".
    """
    return {
        "table1": _table1(result.calibration),
        "fig8": _fig8(result.spectrum),
        "fig10": _fig10(*result.signatures),
    }


def _table1(calibration: StaticCalibration) -> tuple[Comparison, ...]:
    return (
        within(
            "T Table I",
            "torque sensor gain, mean of eight experiments",
            f"{published.SENSOR_GAIN_NM_PER_V:.2f} Nm/V",
            calibration.result.gain_Nm_per_V,
            unit="Nm/V",
            decimals=2,
            expected=published.SENSOR_GAIN_NM_PER_V,
            tolerance=2 * published.CONSISTENCY_MEASURE / np.sqrt(8),
            band="two standard uncertainties of a mean of eight that scatter by 2 %",
            kind="recovered",
        ),
        Comparison(
            source="T Table I",
            quantity="consistency measure over eight experiments",
            published=f"{100 * published.CONSISTENCY_MEASURE:g} %",
            ours=100 * calibration.result.consistency,
            unit="%",
            decimals=1,
            lowest=1.3,
            highest=4.1,
            band="95 % interval of a standard deviation of 2 % over eight",
            kind="matched",
        ),
    )


def _fig8(spectrum: Spectrum) -> tuple[Comparison, ...]:
    # A line of 0.3 s is 2 pi / 0.3 s wide between half heights.
    width_rad_s = 2 * np.pi / (published.SPECTRUM_END_S - published.SPECTRUM_START_S)
    return (
        Comparison(
            source="T fig. 8",
            quantity="motor speed from 0.8 to 1.1 s",
            published=f"about {published.MOTOR_SPEED_RAD_S:g} rad/s",
            ours=spectrum.speed_rad_s,
            unit="rad/s",
            decimals=1,
            lowest=published.MOTOR_SPEED_RAD_S - 2.0,
            highest=published.MOTOR_SPEED_RAD_S + 2.0,
            band="±2 rad/s for “about”",
            kind="recovered",
        ),
        *(
            Comparison(
                source="T fig. 8",
                quantity=f"{name} peak of the torque's spectrum",
                published=f"{expected:g} rad/s",
                ours=peak,
                unit="rad/s",
                decimals=1,
                lowest=expected - width_rad_s / 2,
                highest=expected + width_rad_s / 2,
                band="line width of a window of 0.3 s",
                kind="recovered",
            )
            for name, expected, peak in zip(
                ("first", "second"),
                (published.FUNDAMENTAL_RAD_S, published.FIRST_HARMONIC_RAD_S),
                spectrum.peaks_rad_s,
                strict=True,
            )
        ),
    )


def _fig10(as_mounted: Signature, reassembled: Signature) -> tuple[Comparison, ...]:
    return (
        within(
            "T fig. 10",
            "misalignment as first mounted, peak to peak",
            f"{published.MISALIGNMENT_MOUNTED_NM:g} Nm",
            as_mounted.peak_to_peak_Nm,
            unit="Nm",
            decimals=2,
            expected=published.MISALIGNMENT_MOUNTED_NM,
            tolerance=0.05,
            band="±5 %: the paper gives two digits",
            kind="recovered",
        ),
        Comparison(
            source="T section VI",
            quantity="misalignment reassembled, peak to peak",
            published=f"less than {published.MISALIGNMENT_REASSEMBLED_NM:g} Nm",
            ours=reassembled.peak_to_peak_Nm,
            unit="Nm",
            decimals=2,
            lowest=0.5,
            highest=published.MISALIGNMENT_REASSEMBLED_NM,
            band="below the paper's bound, and not nothing",
            kind="matched",
        ),
    )
