"""Figure of a torque calibration: what is left beside the straight lines, and the gains."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.report.style import BLACK, GREY, SERIES, figure_style, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from strainwave.commissioning.torque_result import TorqueFit

_MARKERS: Final = {1: "^", -1: "v", 0: "o"}
_MOST_NAMED: Final = 12


def torque_calibration_figure(fit: TorqueFit) -> Figure:
    """Residuals against load, and gains of the experiments.

    Parameters
    ----------
    fit : TorqueFit
        The calibration.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels, one above the other.
    """
    with figure_style():
        figure = new_figure(6.2)
        above, below = figure.subplots(2, 1, height_ratios=(3, 2))
        _residuals(above, fit)
        _gains(below, fit)
        count = len(fit.loadings.names)
        if count <= _MOST_NAMED:
            handles, labels = above.get_legend_handles_labels()
            figure.legend(
                handles,
                labels,
                loc="outside lower center",
                ncols=min(6, count + 3),
                title="experiment",
            )
        return figure


def _colour(index: int) -> str:
    return SERIES[index % len(SERIES)]


def _residuals(axes: Axes, fit: TorqueFit) -> None:
    loadings = fit.loadings
    for index, rows in enumerate(loadings.rows()):
        line = fit.lines[index]
        load = loadings.load_Nm[rows]
        read_Nm = line.gain_Nm_per_V * (loadings.voltage_V[rows] - line.zero_V)
        residual = 100.0 * (load - read_Nm) / fit.full_scale_Nm
        filled = index < len(SERIES)
        axes.plot(load, residual, color=_colour(index), linewidth=0.5, alpha=0.6)
        for path, marker in _MARKERS.items():
            chosen = loadings.path[rows] == path
            axes.plot(
                load[chosen],
                residual[chosen],
                linestyle="",
                marker=marker,
                markersize=4,
                markerfacecolor=_colour(index) if filled else "white",
                color=_colour(index),
            )
        axes.plot(
            [],
            [],
            marker="o",
            linestyle="",
            color=_colour(index),
            label=loadings.names[index],
            markerfacecolor=_colour(index) if filled else "white",
        )
    curve = fit.linearisation.curve.coefficients
    if curve:
        u = np.linspace(loadings.load_Nm.min(), loadings.load_Nm.max(), 200) / fit.full_scale_Nm
        bent = sum((c * u**n for n, c in enumerate(curve, 2)), start=np.zeros_like(u))
        # The straight lines of the experiments hold part of the curve; what is left is drawn.
        bent = bent - np.polyval(np.polyfit(u, bent, 1), u)
        axes.plot(
            fit.full_scale_Nm * u,
            100.0 * bent,
            color=BLACK,
            linewidth=1.8,
            label=f"polynomial of order {len(curve) + 1}",
        )
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    axes.set(
        xlabel="load (Nm)",
        ylabel="load \N{MINUS SIGN} line (%FS)",
        title="What each experiment's own line leaves: \N{BLACK UP-POINTING TRIANGLE} from below, "
        "\N{BLACK DOWN-POINTING TRIANGLE} from above",
    )


def _gains(axes: Axes, fit: TorqueFit) -> None:
    count = len(fit.lines)
    places = np.arange(1, count + 1)
    interval = fit.prediction_interval()
    if interval is not None:
        axes.axhspan(*interval, color=GREY, alpha=0.15, linewidth=0)
    axes.axhline(fit.gain_Nm_per_V, color=BLACK, linewidth=0.8)
    for index, line in enumerate(fit.lines):
        error = line.gain_standard_error_Nm_per_V
        axes.errorbar(
            places[index],
            fit.gains_Nm_per_V[index],
            yerr=2.0 * error if np.isfinite(error) else None,
            marker="o",
            markersize=5,
            markerfacecolor=_colour(index) if index < len(SERIES) else "white",
            color=_colour(index),
        )
    positions = fit.loadings.position_rad
    names = list(fit.loadings.names)
    if positions is not None:
        names = [
            f"{name}\n{np.degrees(angle):.4g}\N{DEGREE SIGN}"
            for name, angle in zip(names, positions, strict=True)
        ]
    if count <= _MOST_NAMED:
        axes.set_xticks(places, names)
    axes.set_xlim(0.4, count + 0.6)
    shade = "; shaded: 95 % for another position" if interval is not None else ""
    axes.set(ylabel="gain (Nm/V)", title=f"Gain of each experiment, line: mean{shade}")
    axes.set_xlabel("experiment" if positions is None else "experiment, position")
