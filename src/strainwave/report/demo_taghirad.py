"""The demo's part on Taghirad & Belanger 1999: words, figures and tables from results."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.report import figures_taghirad as figures
from strainwave.report.page import Item, Part, PlainTable
from strainwave.reproduce.taghirad1999_motion import STEADY_FROM_S
from strainwave.simulate.presets.taghirad1999 import ARM_ERROR, TORQUE_SHARES

if TYPE_CHECKING:
    from strainwave.reproduce.comparison import Comparison
    from strainwave.reproduce.taghirad1999 import StaticCalibration, Taghirad1999
    from strainwave.reproduce.taghirad1999_motion import Experiment

#: Where the scatter of the simulated gains comes from.
_PUT_IN = (
    "The scatter here was put in: the strain that the torque makes is uneven around the simulated "
    f"flexspline, by {100 * TORQUE_SHARES[1]:g} % in a part that gauges at 90° do not cancel, so "
    "that the gain depends on where the wave generator stands. That share was set so that about "
    "2 % come out; hysteresis, bearing, temperature and an arm that is wrong by "
    f"{100 * ARM_ERROR:g} % (standard deviation) add little. The agreement is no evidence for "
    "the cause."
)
_STANDSTILL = (
    "The true torque's spike at 2.4 s is real: where the motor comes to rest, friction stops it "
    "and the load swings on the flexspline. The filter removes it with the ripple."
)


def taghirad_part(result: Taghirad1999, comparisons: dict[str, tuple[Comparison, ...]]) -> Part:
    """Write the part on the first paper.

    Parameters
    ----------
    result : Taghirad1999
        What was run.
    comparisons : dict
        Published numbers beside ours, by figure.

    Returns
    -------
    Part
        A section of the page.
    """
    support = result.calibration.result
    return Part(
        anchor="taghirad",
        title="Taghirad & Bélanger 1999: the sensor and its filter",
        paragraphs=(
            "A gear of 100:1 with a rated torque of 40 Nm, four rosettes in one full bridge (10 V, "
            "amplifier gain 1000), a tachometer on the motor, 1 kHz. What follows was run on a "
            "simulation of that station; the signal went through strainwave's own chain from "
            "converter codes to torque.",
        ),
        items=(
            Item(
                title="Table I and figure 7: static calibration",
                paragraphs=(
                    "The wave generator is locked, weights hang on an arm. Eight experiments at "
                    "four positions, in both directions, over low and full range, at 5 to 35 °C; "
                    "least squares through the origin for each, then mean and scatter. The paper "
                    "prints the mean and the scatter; it prints no number for figure 7. "
                    f"{_PUT_IN}",
                    f"What a scatter of {100 * support.consistency:.1f} % over eight experiments "
                    "supports: a standard uncertainty of the mean of "
                    f"{100 * support.standard_uncertainty:.2f} %, a gain at one more position "
                    f"within ±{100 * support.prediction_95:.1f} % (95 %), and a true scatter "
                    f"anywhere from {100 * support.consistency_low:.1f} to "
                    f"{100 * support.consistency_high:.1f} % (95 %).",
                ),
                figure=figures.calibration_figure(result.calibration),
                caption="Simulated. Left: one full-range loading and its line. Right: the gain of "
                "each experiment; the band is one standard deviation about the mean.",
                alternative="Applied torque against sensor output on a straight line, and eight "
                "gains between 6.4 and 6.8 newton metres per volt.",
                comparisons=comparisons["table1"],
                table=_calibration_table(result.calibration),
            ),
            Item(
                title="Figure 8: free motion and its spectrum",
                paragraphs=(
                    "The motor runs up to 156 rad/s. The torque's spectrum between 0.8 and 1.1 s "
                    "has two peaks. The paper reads 312 and 624 rad/s, twice and four times its "
                    "“about 156”. Ours lie 1 % higher, at 2.02 and 4.04 times the motor speed, "
                    "because the circular spline of the simulated gear is fixed: the teeth then "
                    "mesh 2 (R + 1)/R times a motor turn. The paper does not say which part of its "
                    "gear was fixed.",
                ),
                figure=figures.spectrum_figure(result.ripple[0], result.spectrum),
                caption="Simulated. The grey band is the interval of the spectrum.",
                alternative="Torque with ripple, motor speed rising to 156 radians per second, and "
                "a spectrum with peaks at about 315 and 630 radians per second.",
                comparisons=comparisons["fig8"],
            ),
            Item(
                title="Figure 9: the published filter on ripple",
                paragraphs=(
                    "Orders 2 and 4, Q = 1000 I, R = 1. The expected torque is the load's inertia "
                    "times its acceleration, taken from the tachometer. In free motion that is "
                    "nearly all the torque there is, and the filter looks as good as the paper "
                    "says; the paper prints no number for this figure. The section on its tuning shows what happens to torque that was not "
                    "expected.",
                ),
                figure=figures.filter_figure(result.ripple),
                caption="Simulated. Two experiments; the right column is a part of the left one, with "
                "a scale of its own. On the left the measured torque is the band between its "
                "extremes over 20 ms. " + _STANDSTILL,
                alternative="Measured torque with ripple, and the filter's output close to the "
                "true torque.",
                table=_filter_table(result.ripple),
            ),
            Item(
                title="Figure 10: misalignment",
                paragraphs=(
                    "At constant speed the expected torque is constant, but the measured torque "
                    "swings once per output turn. Re-assembly made the paper's swing smaller; "
                    "aligning everything perfectly is, in the paper's words, expensive in practice "
                    "and probably infeasible.",
                ),
                figure=figures.misalignment_figure(result.signatures),
                caption="Simulated, over one output turn; the measured torque is the band between its "
                "extremes over 20 ms. Peak to peak of the sine at one cycle per "
                "output turn that fits best; the mean over a motor turn is drawn from 0.85 s on, "
                "when the speed is constant.",
                alternative="Torque swinging by 10 newton metres, and by 1.6 after re-assembly.",
                comparisons=comparisons["fig10"],
            ),
            Item(
                title="Figure 11: ripple and misalignment together",
                paragraphs=(
                    "A third oscillator at once per output turn takes the misalignment with it, "
                    "here as first mounted, 10 Nm peak to peak. It takes any other slow torque, "
                    "gravity and contact among them, just as well. For this figure, too, the paper "
                    "prints no number.",
                ),
                figure=figures.filter_figure(result.misalignment),
                caption="Simulated. Two experiments with six states, drawn like figure 9. "
                + _STANDSTILL,
                alternative="Measured torque with ripple and misalignment, and the filter's output "
                "close to the true torque.",
                table=_filter_table(result.misalignment),
            ),
        ),
    )


_DIRECTIONS = {1: "+", -1: "\N{MINUS SIGN}", 0: "both"}


def _calibration_table(calibration: StaticCalibration) -> PlainTable:
    rows = tuple(
        (
            str(number),
            f"{np.rad2deg(loading.position_rad):g}°",
            f"{loading.range_Nm:.0f} Nm",
            _DIRECTIONS[loading.direction],
            f"{loading.temperature_degC:.1f} °C",
            f"{loading.line.gain_Nm_per_V:.3f} Nm/V",
            f"{loading.line.largest_residual_Nm:.2f} Nm",
        )
        for number, loading in enumerate(calibration.loadings, start=1)
    )
    return PlainTable(
        (
            "Experiment",
            "Wave generator at",
            "Range",
            "Direction",
            "Temperature",
            "Gain",
            "Largest residual",
        ),
        rows,
    )


def _filter_table(experiments: tuple[Experiment, ...]) -> PlainTable:
    rows = tuple(
        (
            experiment.title,
            f"{experiment.ripple_rms_Nm():.2f} Nm",
            f"{experiment.left_rms_Nm():.2f} Nm",
            f"{experiment.raw_error_rms_Nm():.2f} Nm",
            f"{experiment.error_rms_Nm():.2f} Nm",
        )
        for experiment in experiments
    )
    return PlainTable(
        (
            f"Experiment (rms from {STEADY_FROM_S:g} s on)",
            "Ripple, measured",
            "Ripple, filtered",
            "Distance from the true torque, measured",
            "the same, filtered",
        ),
        rows,
    )
