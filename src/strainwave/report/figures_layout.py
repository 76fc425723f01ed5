"""Residual against the number of gauges: careless and careful, with equal gains and tuned."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.report.style import BLACK, BLUE, ORANGE, figure_style, new_figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from strainwave.design.comparison import Care, Comparison
    from strainwave.design.layout import Distribution, LayoutStudy

#: How far beside the number of gauges careless and careful ones stand.
_BESIDE = 0.16


def layout_figure(comparison: Comparison) -> Figure:
    """Answer "few careless gauges or many careful ones" in two panels.

    Parameters
    ----------
    comparison : Comparison
        Studies over the number of gauges.

    Returns
    -------
    matplotlib.figure.Figure
        Percentiles 5 to 95 of the residual, the limit, and the yield under every bar.
    """
    untuned, tuned, _, replacement = comparison.answers
    with figure_style():
        figure = new_figure(7.4)
        figure.suptitle(
            f"{comparison.question} {comparison.verdict}",
            fontsize=13,
            fontweight="bold",
            x=0.01,
            horizontalalignment="left",
        )
        panels = figure.subplots(2, 1, sharex=True, sharey=True)
        titles = (untuned, f"{tuned}.\n{replacement}")
        for axes, title, is_tuned in zip(panels, titles, (False, True), strict=True):
            _draw(axes, comparison, is_tuned=is_tuned)
            axes.set_title(title, fontsize=9.5, fontweight="normal", x=-0.09)
        _finish(panels[0], panels[1], comparison)
        figure.legend(
            *panels[0].get_legend_handles_labels(),
            loc="outside lower left",
            ncols=2,
            fontsize=9.5,
            title="Bars: 5th to 95th percentile, marks: median, titles: 95th; yield: share within the limit",
            title_fontsize=9.0,
            alignment="left",
        )
        return figure


def _draw(axes: Axes, comparison: Comparison, *, is_tuned: bool) -> None:
    kinds = (
        (comparison.careless_studies, "careless", comparison.careless, ORANGE, -_BESIDE, "o"),
        (comparison.careful_studies, "careful", comparison.careful, BLUE, _BESIDE, "s"),
    )
    for studies, name, care, colour, beside, marker in kinds:
        found = [study.tuned if is_tuned else study.untuned for study in studies]
        places = np.array([study.case.gauges for study in studies]) + beside
        _draw_percentiles(axes, places, found, colour, marker, _label(name, care))
        asked = comparison.few if name == "careless" else comparison.many
        _ring(axes, studies, found, asked, beside)
    limit_FS = comparison.careless_studies[0].limit_FS
    axes.axhline(
        limit_FS, color=BLACK, linewidth=1.4, linestyle="--", label=f"limit, {limit_FS:g} %FS"
    )
    axes.set_yscale("log")
    axes.grid(visible=False, axis="x")


def _label(name: str, care: Care) -> str:
    return f"{name}: {care.position_deg:g}°, {100 * care.amplitude:g} % (std. dev.)"


def _draw_percentiles(
    axes: Axes,
    places: np.ndarray,
    found: Sequence[Distribution],
    colour: str,
    marker: str,
    label: str,
) -> None:
    low, middle, high = (
        np.array([each.residual_FS[percentile] for each in found]) for percentile in (5, 50, 95)
    )
    axes.vlines(places, low, high, color=colour, linewidth=6, alpha=0.45)
    axes.plot(
        places, middle, marker=marker, linestyle="", color=colour, markersize=5.5, label=label
    )
    row = 0.075 if marker == "o" else 0.01
    for place, each in zip(places, found, strict=True):
        axes.annotate(
            _percent(each.met_limit),
            (round(place), row),
            xycoords=("data", "axes fraction"),
            color=colour,
            fontsize=9.5,
            fontweight="bold",
            horizontalalignment="center",
            verticalalignment="bottom",
        )


def _percent(share: float) -> str:
    """Write a share so that 100 % means all and 0 % none."""
    if 0.995 <= share < 1:
        return ">99 %"
    return "<1 %" if 0 < share < 0.005 else f"{100 * share:.0f} %"


def _ring(
    axes: Axes,
    studies: Sequence[LayoutStudy],
    found: Sequence[Distribution],
    asked: int,
    beside: float,
) -> None:
    """Mark the two layouts that the question asks about."""
    for study, each in zip(studies, found, strict=True):
        if study.case.gauges == asked:
            axes.plot(
                asked + beside,
                each.residual_FS[50],
                marker="o",
                linestyle="",
                markersize=13,
                markerfacecolor="none",
                markeredgecolor=BLACK,
                markeredgewidth=1.4,
            )


def _finish(upper: Axes, lower: Axes, comparison: Comparison) -> None:
    studies = comparison.careless_studies
    counts = [study.case.gauges for study in studies]
    lower.set_xticks(
        counts,
        [f"{study.case.gauges}\nN = {study.case.harmonics}" for study in studies],
        fontsize=9.5,
    )
    lower.set_xlabel("number of gauges M, and harmonics N that tuning cancels", fontsize=10)
    lowest, highest = lower.get_ylim()
    # Room for two rows of yields below the lowest bar.
    lower.set_ylim(10 ** (np.log10(lowest) - 0.22 * np.log10(highest / lowest)), highest)
    lower.set_xlim(counts[0] - 0.9, counts[-1] + 0.5)
    for axes in (upper, lower):
        axes.set_ylabel("residual (%FS, zero to peak)", fontsize=10)
        axes.yaxis.set_major_formatter("{x:g}")
        axes.tick_params(axis="y", labelsize=9.5)
        axes.annotate(
            "yield",
            (0.005, 0.04),
            xycoords="axes fraction",
            fontsize=9.5,
            verticalalignment="bottom",
        )
