"""Figures of one filtered recording: torque, order spectrum, order against speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.colors import LogNorm

from strainwave.report.style import (
    BLUE,
    GREY,
    NARROW_WIDTH_IN,
    ORANGE,
    PAGE_WIDTH_IN,
    figure_style,
    new_figure,
    true_minus,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from strainwave.evidence import Envelope, OrderLine, OrderMap, OrderSpectrum

BEFORE: Final[dict[str, Any]] = {"color": GREY, "linewidth": 0.8, "label": "as recorded"}
AFTER: Final[dict[str, Any]] = {"color": BLUE, "linewidth": 1.1, "label": "ripple removed"}
#: Columns of the drawing of torque over time.
_COLUMNS: Final = 1200
#: Highest over lowest amplitude of the colours.
_COLOUR_RANGE: Final = 300.0
#: So few speeds stand side by side instead of on a scale.
_FEW_SPEEDS: Final = 5


def both_widths(draw: Callable[[float], Figure]) -> tuple[Figure, Figure]:
    """Draw a figure for a page and for a narrow screen.

    Parameters
    ----------
    draw : callable
        Takes the width in inches.

    Returns
    -------
    tuple of matplotlib.figure.Figure
        The wide one and the narrow one.
    """
    return draw(PAGE_WIDTH_IN), draw(NARROW_WIDTH_IN)


def torque_figure(envelope: Envelope, origin_s: float, time_label: str, width_in: float) -> Figure:
    """Draw torque before and after over the whole recording.

    Parameters
    ----------
    envelope : Envelope
        What is drawn.
    origin_s : float
        Time that is shown as 0, s.
    time_label : str
        Label of the axis of time.
    width_in : float
        Width, inches.

    Returns
    -------
    matplotlib.figure.Figure
        One panel.
    """
    shown = envelope.thinned(int(_COLUMNS * width_in / PAGE_WIDTH_IN))
    time_s = shown.time_s - origin_s
    with figure_style():
        figure = new_figure(3.0, width_in)
        axes = figure.subplots()
        for low, high, look in (
            (shown.before_lowest_Nm, shown.before_highest_Nm, BEFORE),
            (shown.after_lowest_Nm, shown.after_highest_Nm, AFTER),
        ):
            # Up and down within a block: its line fills what the block covers.
            axes.plot(np.repeat(time_s, 2), np.stack([low, high], axis=1).ravel(), **look)
        if shown.is_rejected.any():
            rejected_s = time_s[shown.is_rejected]
            axes.plot(
                rejected_s,
                np.zeros(len(rejected_s)),
                "|",
                color=ORANGE,
                markersize=9,
                transform=axes.get_xaxis_transform(),
                label="not used",
            )
        axes.set(xlabel=time_label, ylabel="torque (Nm)")
        axes.margins(x=0)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
        return figure


def spectrum_figure(
    spectrum: OrderSpectrum, lines: tuple[OrderLine, ...], width_in: float
) -> Figure:
    """Draw amplitude against order, before and after.

    Parameters
    ----------
    spectrum : OrderSpectrum
        What is drawn.
    lines : tuple of OrderLine
        Orders that are marked.
    width_in : float
        Width, inches.

    Returns
    -------
    matplotlib.figure.Figure
        One panel.
    """
    with figure_style():
        figure = new_figure(3.2, width_in)
        axes = figure.subplots()
        _mark(axes.axvline, lines)
        axes.semilogy(spectrum.order, spectrum.before_Nm, **BEFORE)
        axes.semilogy(spectrum.order, spectrum.after_Nm, **AFTER)
        axes.set(
            xlim=(0, 12),
            xlabel="order (cycles per motor turn)",
            ylabel="amplitude (Nm)",
        )
        axes.set_xticks(range(0, 13, 1 if width_in > NARROW_WIDTH_IN else 2))
        axes.yaxis.set_major_formatter("{x:g}")
        _keep_in_sight(axes, spectrum)
        figure.legend(
            *axes.get_legend_handles_labels(),
            loc="outside upper center",
            ncols=4 if width_in > NARROW_WIDTH_IN else 2,
        )
        return figure


def _mark(line: Callable[..., Any], lines: tuple[OrderLine, ...]) -> None:
    said = set()
    for each in lines:
        name = "kept: real torque" if each.is_kept else "removed order" if each.is_told else ""
        look = {
            "color": ORANGE,
            "linewidth": 0.9,
            "linestyle": ":" if each.is_kept else (0, (4, 3)),
        }
        line(each.order, label=name if name and name not in said else None, alpha=0.8, **look)
        said.add(name)


def _keep_in_sight(axes: Axes, spectrum: OrderSpectrum) -> None:
    """Leave out of the axis what a smoother takes to nothing."""
    both = np.concatenate([spectrum.before_Nm, spectrum.after_Nm])
    both = both[np.isfinite(both) & (both > 0.0)]
    if len(both):
        low = max(float(both.min()), 0.1 * float(np.quantile(both, 0.05)))
        axes.set_ylim(0.7 * low, 1.5 * float(both.max()))


def map_figure(speed_map: OrderMap, lines: tuple[OrderLine, ...], width_in: float) -> Figure:
    """Draw amplitude against speed and order, before and after.

    Parameters
    ----------
    speed_map : OrderMap
        What is drawn.
    lines : tuple of OrderLine
        Orders that are marked.
    width_in : float
        Width, inches.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels with one scale of colours.
    """
    wide = width_in > NARROW_WIDTH_IN
    with figure_style():
        figure = new_figure(3.6 if wide else 5.6, width_in)
        panels = figure.subplots(*((1, 2) if wide else (2, 1)), sharex=True, sharey=True)
        both = np.concatenate([speed_map.before_Nm.ravel(), speed_map.after_Nm.ravel()])
        highest = float(np.nanmax(both)) if np.isfinite(both).any() else 1.0
        highest = highest or 1.0
        lowest = highest / _COLOUR_RANGE
        norm = LogNorm(lowest, highest)
        bins, places, names = _columns(speed_map)
        half = 0.5 * (speed_map.order[1] - speed_map.order[0])
        edges = np.append(speed_map.order - half, speed_map.order[-1] + half)
        for axes, amplitude_Nm, title in zip(
            panels,
            (speed_map.before_Nm, speed_map.after_Nm),
            ("As recorded", "Ripple removed"),
            strict=True,
        ):
            axes.set_facecolor("#EEEEEE")
            axes.grid(visible=False)
            image = axes.pcolormesh(
                places,
                edges,
                np.ma.masked_invalid(np.maximum(amplitude_Nm[bins], lowest).T),
                norm=norm,
                cmap="viridis",
                rasterized=True,
            )
            for each in lines:
                axes.annotate(
                    "",
                    (0.0, each.order),
                    (-5, 0),
                    xycoords=("axes fraction", "data"),
                    textcoords="offset points",
                    arrowprops={"arrowstyle": "-", "color": ORANGE, "linewidth": 2.5},
                )
            axes.set(title=title, ylim=(0, 12), yticks=range(0, 13, 2))
            if names:
                axes.set_xticks(0.5 * (places[1:] + places[:-1]), names)
            if wide or axes is panels[-1]:
                axes.set_xlabel("motor speed (rad/s)")
        figure.supylabel("order (cycles per motor turn)", fontsize=9)
        bar = figure.colorbar(
            image, ax=list(panels), location="right" if wide else "bottom", fraction=0.05, aspect=30
        )
        bar.set_label("amplitude (Nm)")
        bar.ax.minorticks_off()
        (bar.ax.yaxis if wide else bar.ax.xaxis).set_major_formatter("{x:g}")
        return figure


def _columns(
    speed_map: OrderMap,
) -> tuple[NDArray[np.intp], NDArray[np.float64], list[str]]:
    """Choose bins of speed, their edges on the axis, and names where the axis is no scale."""
    filled = np.flatnonzero(speed_map.windows)
    if len(filled) > _FEW_SPEEDS:
        return np.arange(len(speed_map.windows)), speed_map.speed_edges_rad_s, []
    # A few speeds would be slivers on a scale: they stand side by side.
    middle = 0.5 * (speed_map.speed_edges_rad_s[1:] + speed_map.speed_edges_rad_s[:-1])
    names = [true_minus(f"{middle[n]:.3g}") for n in filled]
    return filled, np.arange(len(filled) + 1.0), names
