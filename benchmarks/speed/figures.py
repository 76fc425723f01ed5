"""Curves of the results: channels and threads, length of a log, states; nothing is computed here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from strainwave.report import style

HEIGHT_IN: Final = 3.0
WIDTH_IN: Final = 4.8


def _row(results: Mapping[str, Any], which: str, name: str) -> Mapping[str, Any]:
    row: Mapping[str, Any] = next(
        each
        for each in results["implementations"]
        if (each["filter"], each["name"]) == (which, name)
    )
    return row


def channels_figure(results: Mapping[str, Any]) -> str:
    """Draw the time of a channel-sample by channels, for one and two threads.

    Parameters
    ----------
    results : mapping
        From `benchmarks.speed.bench.run_bench`.

    Returns
    -------
    str
        SVG.
    """
    with style.figure_style():
        figure = style.new_figure(HEIGHT_IN, WIDTH_IN)
        axes = figure.subplots()
        for threads, colour in ((1, style.BLUE), (2, style.ORANGE)):
            found = [
                each
                for each in results["scaling"]["channels"]
                if each["threads"] == threads and each["ns_per_sample"] is not None
            ]
            axes.plot(
                [each["channels"] for each in found],
                [each["ns_per_sample"] for each in found],
                marker="o",
                color=colour,
                label="one thread" if threads == 1 else "two threads",
            )
        eigen = _row(results, "published", "eigen")["ns_per_sample"]
        if eigen is not None:
            axes.axhline(eigen, color=style.GREY, linestyle="--", label="Eigen, one by one")
        axes.set_xscale("log", base=4)
        axes.set_yscale("log")
        axes.set_xticks(
            ticks := [each["channels"] for each in found], [str(each) for each in ticks]
        )
        axes.set_xlabel("channels")
        axes.set_ylabel("ns by channel and sample")
        axes.legend()
        return style.svg(figure)


def log_figure(results: Mapping[str, Any]) -> str:
    """Draw the time of a sample by the length of one log.

    Parameters
    ----------
    results : mapping
        From `benchmarks.speed.bench.run_bench`.

    Returns
    -------
    str
        SVG.
    """
    ways = (
        ("sequential", style.GREY, "in sequence"),
        ("1_threads", style.BLUE, "in chunks, one thread"),
        ("2_threads", style.ORANGE, "in chunks, two threads"),
    )
    with style.figure_style():
        figure = style.new_figure(HEIGHT_IN, WIDTH_IN)
        axes = figure.subplots()
        for way, colour, label in ways:
            found = [
                (log["samples"], log["ways"][way]["ns_per_sample"])
                for log in results["scaling"]["log_length"]
                if "ns_per_sample" in log["ways"].get(way, {})
            ]
            axes.plot(*zip(*found, strict=True), marker="o", color=colour, label=label)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("samples of one log")
        axes.set_ylabel("ns a sample")
        axes.legend()
        return style.svg(figure)


def states_figure(results: Mapping[str, Any]) -> str:
    """Draw the time of a sample by the number of states.

    Parameters
    ----------
    results : mapping
        From `benchmarks.speed.bench.run_bench`.

    Returns
    -------
    str
        SVG.
    """
    with style.figure_style():
        figure = style.new_figure(HEIGHT_IN, WIDTH_IN)
        axes = figure.subplots()
        for which, colour in (("published", style.BLUE), ("default", style.GREEN)):
            found = [
                (each["states"], each["ns_per_sample"])
                for each in results["scaling"]["states"]
                if each["filter"] == which
            ]
            label = f"{which} filter"
            axes.plot(*zip(*found, strict=True), marker="o", color=colour, label=label)
        axes.set_xlabel("states")
        axes.set_ylabel("ns a sample, one channel, float")
        axes.set_ylim(bottom=0)
        axes.legend()
        return style.svg(figure)


#: File names and what draws them.
FIGURES: Final = {
    "speed-channels.svg": channels_figure,
    "speed-log-length.svg": log_figure,
    "speed-states.svg": states_figure,
}
