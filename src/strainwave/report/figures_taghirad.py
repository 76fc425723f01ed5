"""Figures 7 to 11 of Taghirad & Belanger 1999, from simulated runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.report.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    SERIES,
    figure_style,
    new_figure,
    separate,
)
from strainwave.reproduce.taghirad1999_motion import STEADY_FROM_S

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from strainwave.reproduce.taghirad1999 import StaticCalibration
    from strainwave.reproduce.taghirad1999_motion import Experiment, Signature
    from strainwave.reproduce.taghirad1999_spectrum import Spectrum

#: Samples of a block whose extremes are drawn, 20 ms.
_BAND = 20


def calibration_figure(calibration: StaticCalibration) -> Figure:
    """Fig. 7, and the gain of every experiment behind Table I.

    Parameters
    ----------
    calibration : StaticCalibration
        The eight experiments.

    Returns
    -------
    matplotlib.figure.Figure
        Loading with its line, and eight gains with their mean.
    """
    with figure_style():
        figure = new_figure(3.3)
        line, gains = figure.subplots(1, 2, width_ratios=(1.25, 1))
        full = calibration.full_range
        reach_V = 1.08 * np.array([full.volts.min(), full.volts.max()])
        line.plot(reach_V, full.line.gain_Nm_per_V * reach_V, color=GREY, label="least squares")
        line.plot(full.volts, full.torque_Nm, "o", color=BLUE, markersize=4, label="weights")
        line.set(
            xlabel="sensor output (V)",
            ylabel="applied torque (Nm)",
            title="Full-range loading (fig. 7)",
        )
        line.legend(loc="lower right" if full.direction < 0 else "upper left")
        numbers = np.arange(1, len(calibration.loadings) + 1)
        mean = calibration.result.gain_Nm_per_V
        spread = mean * calibration.result.consistency
        gains.axhspan(mean - spread, mean + spread, color=BLUE, alpha=0.12, linewidth=0)
        gains.axhline(mean, color=BLUE, linewidth=1)
        for full_range, marker in ((True, "o"), (False, "s")):
            chosen = [
                (number, loading.line.gain_Nm_per_V)
                for number, loading in zip(numbers, calibration.loadings, strict=True)
                if (loading.range_Nm == full.range_Nm) == full_range
            ]
            gains.plot(
                *zip(*chosen, strict=True),
                marker,
                color=ORANGE if full_range else GREEN,
                label="full range" if full_range else "low range",
            )
        gains.set(
            xlabel="experiment",
            ylabel="sensor gain (Nm/V)",
            title="Eight experiments (Table I)",
            xticks=numbers,
            ylim=(mean * 0.94, mean * 1.08),
        )
        gains.legend(loc="upper left", ncols=2)
        return figure


def spectrum_figure(experiment: Experiment, spectrum: Spectrum) -> Figure:
    """Fig. 8: torque, speed and the torque's power spectrum.

    Parameters
    ----------
    experiment : Experiment
        The run-up.
    spectrum : Spectrum
        Spectrum between 0.8 and 1.1 s.

    Returns
    -------
    matplotlib.figure.Figure
        Three panels.
    """
    with figure_style():
        figure = new_figure(5.6)
        axes = figure.subplot_mosaic("ab;cc", height_ratios=(1, 1.15))
        separate(figure)
        shown = experiment.time_s <= 1.4
        time_s = experiment.time_s[shown]
        for name in ("a", "b"):
            axes[name].axvspan(0.8, 1.1, color=GREY, alpha=0.15, linewidth=0)
            axes[name].set(xlabel="time (s)", xlim=(0, 1.4))
        axes["a"].plot(time_s, experiment.measured_Nm[shown], color=BLUE, linewidth=0.8)
        axes["a"].set(ylabel="torque (Nm)", title="Measured torque")
        axes["b"].plot(time_s, experiment.speed_rad_s[shown], color=GREEN, linewidth=0.8)
        axes["b"].set(ylabel="motor speed (rad/s)", title="Motor speed")
        below = spectrum.frequency_rad_s <= 1000
        axes["c"].plot(spectrum.frequency_rad_s[below], spectrum.power_Nm2[below], color=BLUE)
        top = float(spectrum.power_Nm2[spectrum.frequency_rad_s > 100].max())
        for peak in spectrum.peaks_rad_s:
            height = float(np.interp(peak, spectrum.frequency_rad_s, spectrum.power_Nm2))
            axes["c"].annotate(
                f"{peak:.0f} rad/s, order {peak / spectrum.speed_rad_s:.2f}",
                (peak, height),
                xytext=(8, 2),
                textcoords="offset points",
                fontsize=8.5,
            )
        axes["c"].set(
            xlabel="angular frequency (rad/s)",
            ylabel="power (Nm²)",
            title="Power spectrum of the torque, 0.8 to 1.1 s",
            xlim=(0, 1000),
            ylim=(0, 1.2 * top),
        )
        return figure


def filter_figure(experiments: Sequence[Experiment]) -> Figure:
    """Figs. 9 and 11: torque before and after the published filter in two experiments.

    Parameters
    ----------
    experiments : sequence of Experiment
        Two experiments.

    Returns
    -------
    matplotlib.figure.Figure
        For each the whole run, and a window of it.
    """
    with figure_style():
        figure = new_figure(5.8)
        separate(figure)
        rows = figure.subplots(len(experiments), 2, width_ratios=(1.4, 1), squeeze=False)
        for (whole, window), experiment in zip(rows, experiments, strict=True):
            _before_and_after(whole, experiment, 0.0, float(experiment.time_s[-1]), band=True)
            _before_and_after(window, experiment, 2.0, 2.25, band=False)
            whole.set(
                title=experiment.title[0].upper() + experiment.title[1:], ylabel="torque (Nm)"
            )
            window.set(title="0.25 s of it, own scale")
        for axes in rows[-1]:
            axes.set(xlabel="time (s)")
        figure.legend(*rows[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
        return figure


def _before_and_after(
    axes: Axes, experiment: Experiment, from_s: float, to_s: float, *, band: bool
) -> None:
    shown = (experiment.time_s >= from_s) & (experiment.time_s <= to_s)
    time_s = experiment.time_s[shown]
    measured = experiment.measured_Nm[shown]
    if band:
        _extremes(axes, time_s, measured)
    else:
        axes.plot(time_s, measured, color=GREY, linewidth=0.8)
    axes.plot(
        time_s,
        experiment.filtered_Nm[shown],
        color=BLUE,
        linewidth=0.7 if band else 1.2,
        label="published filter",
    )
    axes.plot(
        time_s,
        experiment.true_Nm[shown],
        color=ORANGE,
        linewidth=1,
        linestyle=(0, (4, 2)),
        label="true torque (simulation)",
    )
    axes.set(xlim=(from_s, to_s))


def _extremes(axes: Axes, time_s: NDArray[np.float64], measured_Nm: NDArray[np.float64]) -> None:
    """Draw the band between extremes: hundreds of ripples as lines would be a solid block."""
    blocks = measured_Nm[: len(measured_Nm) // _BAND * _BAND].reshape(-1, _BAND)
    axes.fill_between(
        time_s[: blocks.size].reshape(-1, _BAND).mean(axis=1),
        blocks.min(axis=1),
        blocks.max(axis=1),
        color=GREY,
        alpha=0.35,
        linewidth=0,
        label="measured",
    )


def misalignment_figure(signatures: Sequence[Signature]) -> Figure:
    """Fig. 10: the misalignment's signature at constant speed.

    Parameters
    ----------
    signatures : sequence of Signature
        As first mounted and reassembled.

    Returns
    -------
    matplotlib.figure.Figure
        One panel a mounting.
    """
    with figure_style():
        figure = new_figure(3.2)
        panels = figure.subplots(1, len(signatures), sharey=True)
        for axes, signature in zip(panels, signatures, strict=True):
            steady = (signature.time_s > STEADY_FROM_S) & (
                signature.time_s < signature.time_s[-1] - 0.05
            )
            _extremes(axes, signature.time_s, signature.measured_Nm)
            axes.plot(
                signature.time_s[steady],
                signature.slow_Nm[steady],
                color=SERIES[0],
                label="its mean over a motor turn",
            )
            axes.plot(
                signature.time_s,
                signature.expected_Nm,
                color=BLACK,
                linewidth=0.9,
                linestyle=(0, (4, 2)),
                label="expected (inertia)",
            )
            axes.set(
                xlabel="time (s)",
                title=f"{signature.title.capitalize()}: {signature.peak_to_peak_Nm:.1f} Nm "
                "peak to peak",
            )
        panels[0].set(ylabel="torque (Nm)")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
        return figure
