"""One figure of what a method does to true torque and to ripple."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.fidelity import GAIN_ERROR_LIMIT, delay_limit_s
from strainwave.fidelity.tones import HIGHEST_HZ, LOWEST_HZ
from strainwave.report.style import BLACK, GREY, SERIES, figure_style, new_figure, separate

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from strainwave.fidelity import Assessment
    from strainwave.fidelity.tones import SpeedResponse

#: Colour of what happens while the motor stands.
_REST = BLACK
#: No delay beyond this is drawn, ms.
_MOST_MS = 60.0


def fidelity_figure(assessment: Assessment, name: str) -> Figure:
    """Gain, delay, contact and attenuation of one method.

    Parameters
    ----------
    assessment : Assessment
        What was measured.
    name : str
        Name of the joint.

    Returns
    -------
    matplotlib.figure.Figure
        Four panels.
    """
    with figure_style():
        figure = new_figure(6.6)
        (gain, delay), (contact, ripple) = figure.subplots(2, 2)
        separate(figure)
        figure.suptitle(
            f"{name}: method {assessment.subject.name} {assessment.verdict}",
            fontsize=11,
            fontweight="bold",
            x=0.01,
            horizontalalignment="left",
        )
        _draw_gain(gain, assessment)
        _draw_delay(delay, assessment)
        _draw_contact(contact, assessment)
        _draw_ripple(ripple, assessment)
        figure.legend(
            *contact.get_legend_handles_labels(),
            loc="outside lower center",
            ncols=5,
            title="motor speed",
            title_fontsize=8.5,
        )
        return figure


def _coloured(assessment: Assessment) -> Iterator[tuple[SpeedResponse, str]]:
    return zip(assessment.responses, SERIES, strict=False)


def _draw_gain(axes: Axes, assessment: Assessment) -> None:
    for response, colour in _coloured(assessment):
        outside = np.where(response.is_within_notch, np.nan, response.gain)
        beside = np.where(_with_neighbours(response.is_within_notch), response.gain, np.nan)
        axes.semilogx(response.frequency_Hz, beside, color=colour, linewidth=0.8, linestyle=":")
        axes.semilogx(response.frequency_Hz, outside, color=colour)
    axes.fill_between(
        [LOWEST_HZ, HIGHEST_HZ],
        1 - GAIN_ERROR_LIMIT,
        1 + GAIN_ERROR_LIMIT,
        color=GREY,
        alpha=0.25,
        linewidth=0,
    )
    highest = max(1.2, *(float(each.gain.max()) * 1.05 for each in assessment.responses))
    axes.set(ylim=(0, highest), ylabel="gain", title="True torque that passes (dotted: in a notch)")
    _finish_frequency(axes, assessment)


def _draw_delay(axes: Axes, assessment: Assessment) -> None:
    largest_ms = 2.0
    for response, colour in _coloured(assessment):
        delay_ms = 1e3 * response.delay_s
        outside = np.where(response.is_within_notch, np.nan, delay_ms)
        axes.semilogx(response.frequency_Hz, outside, color=colour)
        limit_ms = 1e3 * delay_limit_s(assessment.subject, response)
        limit_ms[~response.is_judged] = np.nan
        axes.semilogx(response.frequency_Hz, limit_ms, color=colour, alpha=0.35, linewidth=3)
        largest_ms = max(largest_ms, float(np.nanmax([*np.abs(outside), *limit_ms, 0.0])))
    top_ms = min(1.1 * largest_ms, _MOST_MS)
    axes.set(
        ylim=(-0.25 * top_ms, top_ms),
        ylabel="group delay (ms)",
        title="Its delay (pale: limit)",
    )
    _finish_frequency(axes, assessment)


def _draw_contact(axes: Axes, assessment: Assessment) -> None:
    axes.plot([-20, 0, 0, 200], [0, 0, 100, 100], color=GREY, linewidth=4, alpha=0.4, label="true")
    for contact, colour in zip(assessment.contacts, (*SERIES[:3], _REST), strict=False):
        speed = contact.motor_speed_rad_s
        axes.plot(
            1e3 * contact.time_s,
            100 * contact.response,
            color=colour,
            linestyle="-" if speed else "--",
            label=f"{speed:g} rad/s" if speed else "standstill",
        )
    axes.axvline(20, color=BLACK, linewidth=0.8, linestyle=(0, (2, 2)))
    axes.annotate("20 ms", (24, 4), fontsize=8)
    axes.set(
        xlim=(-20, 200),
        xlabel="time since the contact (ms)",
        ylabel="output (% of the contact)",
        title="A contact of 25 % of rated torque",
    )


def _draw_ripple(axes: Axes, assessment: Assessment) -> None:
    orders = assessment.subject.ripple_orders
    width = 0.8 / len(assessment.responses)
    for n, (response, colour) in enumerate(_coloured(assessment)):
        values = [response.attenuation_dB[order] for order in orders]
        places = np.arange(len(orders)) + (n + 0.5) * width - 0.4
        heights = [np.nan if value is None else value for value in values]
        axes.bar(places, heights, 0.9 * width, color=colour)
    axes.set_xticks(np.arange(len(orders)), [f"{order:.4g}" for order in orders])
    axes.set_xlim(-0.6, len(orders) - 0.4)
    axes.set_axisbelow(True)
    axes.grid(visible=False, axis="x")
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    axes.set(
        xlabel="order (cycles per motor turn)",
        ylabel="attenuation (dB)",
        title="Ripple that is removed",
    )


def _finish_frequency(axes: Axes, assessment: Assessment) -> None:
    axes.set_xlabel("frequency of the true torque (Hz)")
    axes.set_xlim(LOWEST_HZ, float(assessment.responses[0].frequency_Hz[-1]))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.tick_params(axis="x", which="minor", bottom=False)


def _with_neighbours(marks: np.ndarray) -> np.ndarray:
    """Mark the neighbours too, so that the lines of both kinds meet."""
    return np.convolve(marks, [1, 1, 1], mode="same") > 0
