"""Figures 3 to 11 of Godler et al. 2000, from simulated runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.report.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    SERIES,
    figure_style,
    new_figure,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from strainwave.reproduce.gauge_count import Phasor
    from strainwave.reproduce.godler2000 import Build, Godler2000

_QUARTERS = (0, 90, 180, 270, 360)


def fluctuation_figure(build: Build, limit_percent: float) -> Figure:
    """Figs. 3, 6 and 9: signals of the gauges, and their sum.

    Parameters
    ----------
    build : Build
        One build.
    limit_percent : float
        Range of the lower panel, %FS.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels over one turn of the input shaft.
    """
    with figure_style():
        figure = new_figure(3.1)
        each, total = figure.subplots(1, 2)
        turn_deg = np.rad2deg(build.angle_rad)
        for j, colour in zip(range(build.gauges), SERIES, strict=False):
            each.plot(turn_deg, 100 * build.signals_FS[:, j], color=colour, label=f"$e_{j + 1}$")
        each.plot(
            turn_deg,
            100 * build.sum_FS,
            color=BLACK,
            linewidth=1,
            linestyle=(0, (4, 2)),
            label="sum",
        )
        each.set(ylabel="signal fluctuation (%FS)", title="Each gauge, and the sum")
        each.legend(ncols=build.gauges + 1, loc="upper right", handlelength=1.2, columnspacing=1)
        each.margins(y=0.25)
        _sum_panel(total, turn_deg, build.sum_FS, limit_percent)
        total.set(title=f"The sum alone, own scale: ±{100 * build.fluctuation_FS:.2f} %FS")
        for axes in (each, total):
            axes.set(xlabel="input shaft angle (°)", xticks=_QUARTERS, xlim=(0, 360))
        return figure


def compensation_figure(three: Build, compensated: Build) -> Figure:
    """Fig. 10: the sum of three gauges before and after adjusting the gains.

    Parameters
    ----------
    three : Build
        The build with equal gains.
    compensated : Build
        The build with adjusted gains, on another turn.

    Returns
    -------
    matplotlib.figure.Figure
        One panel.
    """
    with figure_style():
        figure = new_figure(2.9)
        axes = figure.subplots()
        turn_deg = np.rad2deg(three.angle_rad)
        axes.plot(turn_deg, 100 * three.sum_FS, color=GREY, label="equal gains (fig. 9b)")
        axes.plot(
            np.rad2deg(compensated.angle_rad),
            100 * compensated.sum_FS,
            color=BLUE,
            label="gains adjusted (fig. 10)",
        )
        axes.set(
            xlabel="input shaft angle (°)",
            ylabel="sum of three gauges (%FS)",
            xticks=_QUARTERS,
            xlim=(0, 360),
            ylim=(-3.2, 3.2),
            title="Signal fluctuation before and after",
        )
        axes.legend(loc="upper right", ncols=2)
        return figure


def linearity_figure(builds: Sequence[tuple[str, Build]]) -> Figure:
    """Figs. 4, 7 and 11: linearity error at standstill.

    Parameters
    ----------
    builds : sequence of tuple
        Title and build.

    Returns
    -------
    matplotlib.figure.Figure
        One panel a build, all with one scale.
    """
    with figure_style():
        figure = new_figure(2.9)
        panels = figure.subplots(1, len(builds), sharey=True)
        for axes, (title, build) in zip(panels, builds, strict=True):
            axes.axhline(0, color=BLACK, linewidth=0.8)
            axes.plot(
                build.loads_Nm,
                100 * build.linearity_error_FS,
                "o-",
                color=BLUE,
                markersize=3,
                linewidth=0.9,
            )
            axes.set(
                xlabel="applied torque (Nm)",
                title=f"{title}\n±{100 * build.linearity_FS:.2f} %FS",
                xticks=(-100, -50, 0, 50, 100),
            )
        panels[0].set(ylabel="linearity error (%FS)", ylim=(-3, 3))
        return figure


def vector_figure(result: Godler2000) -> Figure:
    """Fig. 8: two gauges cannot cancel the basic frequency, three can.

    Parameters
    ----------
    result : Godler2000
        Vectors with their gains.

    Returns
    -------
    matplotlib.figure.Figure
        Vectors put end to end for two and for three gauges.
    """
    with figure_style():
        figure = new_figure(2.6)
        panels = figure.subplots(1, 2, sharey=True)
        cases = (
            ("Two gauges: the least that is left", result.vectors_two),
            ("Three gauges: closed", result.vectors_three),
        )
        for axes, (title, vectors) in zip(panels, cases, strict=True):
            _end_to_end(axes, vectors)
            axes.set(
                title=title,
                xlabel="part of sin 2mβ (relative to $a_{11}$)",
                aspect="equal",
                xlim=(-0.7, 1.5),
                ylim=(-0.2, 1.1),
            )
        panels[0].set(ylabel="part of cos 2mβ")
        return figure


def _end_to_end(axes: Axes, vectors: Sequence[Phasor]) -> None:
    steps = np.array([[vector.sine, vector.cosine] for vector in vectors])
    corners = np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])
    middle = corners[:-1].mean(axis=0)
    for number, (step, corner, colour) in enumerate(
        zip(steps, corners[:-1], SERIES, strict=False), start=1
    ):
        axes.annotate(
            "",
            corner + step,
            corner,
            arrowprops={
                "arrowstyle": "-|>",
                "color": colour,
                "linewidth": 1.8,
                "shrinkA": 0,
                "shrinkB": 0,
                "mutation_scale": 12,
            },
        )
        length = float(np.hypot(*step))
        normal = np.array([step[1], -step[0]]) / length
        centre = corner + step / 2
        outward = normal if normal @ (centre - middle) >= 0 else -normal
        axes.text(
            float(centre[0] + 0.06 * outward[0]),
            float(centre[1] + 0.06 * outward[1]),
            f"$g_{number}\\,a_{{1{number}}}$ = {length:.3f}",
            color=colour,
            fontsize=8.5,
            horizontalalignment=_side(outward[0], "right", "center", "left"),
            verticalalignment=_side(outward[1], "top", "center", "bottom"),
        )
    left = float(np.hypot(*corners[-1]))
    axes.plot([0], [0], "o", color=BLACK, markersize=4)
    axes.plot(*corners[-1], "s", color=ORANGE, markersize=5, markerfacecolor="none")
    axes.annotate(
        f"left: {left:.3f}" if left > 5e-4 else "left: nothing",
        (0, 0),
        xytext=(-8, -4),
        textcoords="offset points",
        horizontalalignment="right",
        fontsize=8.5,
    )


def _side(component: float, low: str, middle: str, high: str) -> str:
    if abs(component) < 0.3:
        return middle
    return high if component > 0 else low


def _sum_panel(axes: Axes, turn_deg: np.ndarray, total: np.ndarray, limit_percent: float) -> None:
    axes.plot(turn_deg, 100 * total, color=BLUE)
    axes.axhline(0, color=BLACK, linewidth=0.8)
    axes.set(ylabel="sum (%FS)", ylim=(-limit_percent, limit_percent))
