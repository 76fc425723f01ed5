"""Figures of a certificate: errors and hysteresis under load, fluctuation before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave.report.style import BLACK, BLUE, GREY, ORANGE, SERIES, figure_style, new_figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from strainwave.certificate.evidence import FluctuationEvidence, LoadEvidence

_MOST_NAMED: Final = 12


def load_errors_figure(loads: LoadEvidence) -> Figure:
    """Draw the error of every reading over the load, and the hysteresis of every experiment.

    Parameters
    ----------
    loads : LoadEvidence
        Readings under known loads.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels, one above the other.
    """
    with figure_style():
        figure = new_figure(5.6)
        above, below = figure.subplots(2, 1, height_ratios=(3, 2))
        loadings = loads.loadings
        for index, rows in enumerate(loadings.rows()):
            colour = SERIES[index % len(SERIES)]
            load, error = loadings.load_Nm[rows], loads.error_percent[rows]
            above.plot(load, error, color=colour, linewidth=0.5, alpha=0.6)
            for way, marker in ((1, "^"), (0, "o"), (-1, "v")):
                chosen = loadings.path[rows] == way
                above.plot(load[chosen], error[chosen], marker, color=colour, markersize=4)
        above.axhline(0.0, color=BLACK, linewidth=0.8)
        above.set(
            xlabel="load (Nm)",
            ylabel="error (%FS)",
            title="Linearity: torque by the joint file \N{MINUS SIGN} load; "
            "\N{BLACK UP-POINTING TRIANGLE} from below, \N{BLACK DOWN-POINTING TRIANGLE} from above",
        )
        places = np.arange(1, len(loadings.names) + 1)
        colours = [SERIES[index % len(SERIES)] for index in range(len(places))]
        below.set_axisbelow(True)
        below.bar(places, np.nan_to_num(loads.hysteresis_percent), color=colours, width=0.6)
        below.set(xlabel="experiment", ylabel="%FS", title="Hysteresis of each experiment")
        if len(places) <= _MOST_NAMED:
            below.set_xticks(places, loadings.names)
        return figure


def fluctuation_figure(found: FluctuationEvidence) -> Figure:
    """Draw the amplitude of every harmonic with equal gains and with those of the joint file.

    Parameters
    ----------
    found : FluctuationEvidence
        Gauges against the wave's angle.

    Returns
    -------
    matplotlib.figure.Figure
        One panel, logarithmic.
    """
    with figure_style():
        figure = new_figure(2.9)
        axes = figure.subplots()
        axes.set_axisbelow(True)
        places = np.arange(1, len(found.phasors) + 1)
        axes.bar(places - 0.2, found.before_V, 0.38, color=GREY, label="before: equal gains")
        axes.bar(
            places + 0.2, found.after_V, 0.38, color=BLUE, label="after: gains of the joint file"
        )
        spread = 2.0 * found.standard_uncertainty_V
        axes.plot(
            places + 0.2, spread, "_", color=ORANGE, markersize=22, label="uncertainty, k = 2"
        )
        axes.set(
            yscale="log",
            ylabel="amplitude (V)",
            title="Fluctuation of the weighted sum",
        )
        axes.set_xticks(places, [f"harmonic {i}\n{2 * i} cycles per wave turn" for i in places])
        axes.set_ylim(bottom=0.3 * _least_positive(found.after_V, spread))
        axes.legend(loc="outside right upper" if len(places) > 4 else "best")
        return figure


def _least_positive(*values: np.ndarray[Any, np.dtype[np.float64]]) -> float:
    every = np.concatenate(values)
    positive = every[every > 0]
    return float(positive.min()) if len(positive) else 1e-12


def limits_figure(judged: Sequence[dict[str, Any]]) -> Figure:
    """Draw every judged value as a share of its limit.

    Parameters
    ----------
    judged : sequence of dict
        The judgements of a certificate that have a value.

    Returns
    -------
    matplotlib.figure.Figure
        A bar a value; hatched and marked where it fails.
    """
    with figure_style():
        figure = new_figure(0.9 + 0.34 * len(judged))
        axes = figure.subplots()
        axes.set_axisbelow(True)
        places = np.arange(len(judged))[::-1]
        for place, each in zip(places, judged, strict=True):
            fails = each["verdict"] == "fail"
            share = 100.0 * each["value"] / each["limit"]
            axes.barh(
                place,
                share,
                0.6,
                color=ORANGE if fails else BLUE,
                hatch="//" if fails else None,
                edgecolor="white",
            )
            note = f" {share:.3g} %" + (" FAIL" if fails else "")
            axes.text(share, place, note, va="center", fontsize=8.5)
        axes.axvline(100.0, color=BLACK, linewidth=1.4)
        shares = [100.0 * each["value"] / each["limit"] for each in judged]
        axes.set_xlim(0.0, 1.25 * max(100.0, *shares))
        axes.set_yticks(places, [each["label"] for each in judged])
        axes.set(xlabel="share of the limit (%)", title="Judged values; line: the limit")
        axes.grid(visible=False, axis="y")
        return figure
