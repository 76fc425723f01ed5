"""Two figures of the results; nothing is computed here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from benchmarks.accuracy.kuka import JOINTS
from benchmarks.accuracy.methods.ours import OURS
from benchmarks.accuracy.motion import PHASES
from benchmarks.accuracy.ripple import MISMATCH, RIGHT
from strainwave.report import style

#: Injection errors below are rounding.
SMALLEST_ERROR_PERCENT: Final = 1e-6
#: A colour and mark for each method, the same in both figures.
MARKS: Final = ("o", "s", "D", "^", "v", "<", ">", "P", "p", "*", "h")
COLOURS: Final = (
    style.GREY,
    style.ORANGE,
    style.YELLOW,
    style.PURPLE,
    style.SKY,
    style.GREEN,
    "#A65628",
    style.BLACK,
    "#9ECAE1",
    style.BLUE,
    "#08306B",
)


def error_figure(results: Mapping[str, Any]) -> str:
    """Draw the error by phase, for the right structure and with mismatch.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    str
        SVG.
    """
    with style.figure_style():
        figure = style.new_figure(4.5)
        axes = figure.subplots(1, 2, sharey=True)
        columns = (*PHASES, "mean")
        for panel, scenario in zip(axes, (RIGHT, MISMATCH), strict=True):
            for n, (name, method) in enumerate(results["methods"].items()):
                errors = method["scenarios"][scenario]["error_percent"]
                panel.plot(
                    range(len(columns)),
                    [errors[column] for column in columns],
                    marker=MARKS[n],
                    color=COLOURS[n],
                    markersize=8 if name == OURS.name else 4,
                    linewidth=0.6,
                    label=name,
                )
            panel.axhline(0.1, color=style.BLACK, linewidth=0.8, linestyle=":")
            panel.set_yscale("log")
            panel.set_xticks(range(len(columns)), columns, rotation=45, ha="right")
            panel.set_title(scenario)
        axes[0].set_ylabel("error RMS, %FS (dotted: noise)")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
        return style.svg(figure)


def kuka_figure(results: Mapping[str, Any]) -> str | None:
    """Draw attenuation against fidelity on the Med7, all tunings of every method.

    Parameters
    ----------
    results : mapping
        From `benchmarks.accuracy.bench.run_bench`.

    Returns
    -------
    str or None
        SVG; None without the recordings.
    """
    if results["recordings"] is None:
        return None
    scores = results["recordings"]["kuka"]
    with style.figure_style():
        figure = style.new_figure(5.6)
        axes = figure.subplots(2, 2, sharex=True, sharey=True)
        for panel, joint in zip(axes.flat, JOINTS, strict=True):
            for n, name in enumerate(results["methods"]):
                found = [s for s in scores if s["method"] == name and s["joint"] == joint]
                found.sort(key=lambda s: s["injection_error_percent"])
                error = [s["injection_error_percent"] for s in found]
                # Raw has none but rounding, which a logarithm cannot show.
                if not error or error[-1] < SMALLEST_ERROR_PERCENT:
                    continue
                panel.plot(
                    error,
                    [s["attenuation_dB"][0] for s in found],
                    marker=MARKS[n],
                    color=COLOURS[n],
                    markersize=8 if name == OURS.name else 4,
                    linewidth=0.6,
                    label=name,
                )
            panel.set_xscale("log")
            panel.set_title(f"Med7 J{joint}")
        for panel in axes[:, 0]:
            panel.set_ylabel("order 2 removed, dB")
        for panel in axes[1]:
            panel.set_xlabel("largest error of injected contact, %")
        style.separate(figure)
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
        return style.svg(figure)
