"""Figures of what a tuning does to true torque."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.report.style import BLACK, GREY, SERIES, figure_style, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strainwave.reproduce.tuning import TuningStudy

#: Delays are not drawn nearer to a notch, nor where less than a hundredth passes.
_NOTCH_HZ: Final = 3.0
_LEAST_GAIN: Final = 0.01


def pass_through_figure(study: TuningStudy) -> Figure:
    """Gain and group delay of true torque against frequency.

    Parameters
    ----------
    study : TuningStudy
        Responses of the tunings.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels, one above the other.
    """
    with figure_style():
        figure = new_figure(5.8)
        gain, delay = figure.subplots(2, 1, sharex=True)
        for response, colour in zip(study.responses, SERIES, strict=False):
            measured = response.pass_through
            gain.semilogx(
                measured.frequency_Hz, measured.gain_dB, color=colour, label=response.name
            )
            notches_Hz = np.array([2, 4]) * measured.motor_speed_rad_s / (2 * np.pi)
            away = np.abs(measured.frequency_Hz - notches_Hz[:, np.newaxis]).min(axis=0)
            shown = (measured.gain > _LEAST_GAIN) & (away > _NOTCH_HZ)
            delay_ms = np.where(shown, 1e3 * measured.delay_s, np.nan)
            delay.semilogx(measured.frequency_Hz, delay_ms, color=colour)
        for axes in (gain, delay):
            axes.axhline(0.0, color=BLACK, linewidth=0.8, linestyle=(0, (4, 3)))
        gain.set(ylabel="gain (dB)", ylim=(-62, 10), title="True torque that reaches the output")
        gain.annotate("0 dB: untouched", (0.21, 3.0), color=BLACK, fontsize=8)
        gain.annotate(
            "6 states: on towards nothing",
            (0.3, -58),
            xytext=(0.42, -57),
            color=SERIES[1],
            fontsize=8,
            verticalalignment="center",
        )
        delay.annotate(
            "6 states: longer still",
            (0.8, 55),
            xytext=(0.95, 55),
            color=SERIES[1],
            fontsize=8,
            verticalalignment="center",
        )
        delay.set(
            xlabel="frequency of the true torque (Hz)",
            ylabel="group delay (ms)",
            ylim=(-5, 60),
            title="Its delay",
        )
        delay.set_xticks([0.2, 0.5, 1, 2, 5, 10, 20, 50, 100])
        delay.xaxis.set_major_formatter("{x:g}")
        delay.tick_params(axis="x", which="minor", bottom=False)
        gain.tick_params(axis="x", which="both", bottom=False)
        delay.set_xlim(0.2, 120)
        figure.legend(*gain.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        return figure


def contact_figure(study: TuningStudy) -> Figure:
    """Answer to a contact torque.

    Parameters
    ----------
    study : TuningStudy
        Responses of the tunings.

    Returns
    -------
    matplotlib.figure.Figure
        One panel.
    """
    with figure_style():
        figure = new_figure(3.2)
        axes = figure.subplots()
        height_Nm = study.responses[0].contact.contact_torque_Nm
        axes.plot(
            [-20, 0, 0, 200],
            [0, 0, height_Nm, height_Nm],
            color=GREY,
            linewidth=3,
            alpha=0.5,
            label="true torque",
        )
        for response, colour in zip(study.responses, SERIES, strict=False):
            contact = response.contact
            axes.plot(1e3 * contact.time_s, contact.torque_Nm, color=colour, label=response.name)
        axes.axvline(20, color=BLACK, linewidth=0.8, linestyle=(0, (2, 2)))
        axes.annotate("20 ms", (21, -6.3), fontsize=8)
        axes.set(
            xlim=(-20, 200),
            ylim=(-7, 12.5),
            xlabel="time since the contact (ms)",
            ylabel="torque (Nm)",
            title=f"A contact of {height_Nm:g} Nm, as each tuning shows it",
        )
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
        return figure
