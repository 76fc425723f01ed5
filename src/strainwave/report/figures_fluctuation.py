"""The vector diagram of gauges: Godler et al. 2000, fig. 8, for any number of gauges and harmonics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.report.style import BLACK, SERIES, figure_style, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

#: Height of the panels of one harmonic, inches.
_ROW_IN = 3.5
#: Length of the sum, over that of the longest vector, below which it is drawn as a point.
_POINT = 0.01


def fluctuation_vectors_figure(
    phasors: NDArray[np.complex128], gains: NDArray[np.float64], unit: str
) -> Figure:
    """Draw the vectors of every gauge put end to end, with equal gains and with the gains found.

    Parameters
    ----------
    phasors : numpy.ndarray
        a exp(j phi) of every gauge at gain 1, shape (harmonics, gauges): the part of the sine to
        the right, that of the cosine upwards.
    gains : numpy.ndarray
        g_j, shape (gauges,).
    unit : str
        Unit of the signals.

    Returns
    -------
    matplotlib.figure.Figure
        A row a harmonic; to the left equal gains, to the right these.
    """
    with figure_style():
        figure = new_figure(_ROW_IN * len(phasors))
        panels = figure.subplots(len(phasors), 2, squeeze=False)
        for i, row in enumerate(panels):
            weighted = phasors[i] * gains
            sides = (("equal gains", phasors[i]), ("gains adjusted", weighted))
            corners = np.concatenate([_corners(vectors) for _, vectors in sides])
            for axes, (title, vectors) in zip(row, sides, strict=True):
                _end_to_end(axes, vectors)
                left = abs(vectors.sum())
                axes.set(
                    title=f"Harmonic {i + 1}, {title}\nsum (black): {_left_text(left, vectors)} {unit}",
                    xlabel=f"part of sin {2 * (i + 1)}mβ ({unit})",
                    ylabel=f"part of cos {2 * (i + 1)}mβ ({unit})",
                )
                _frame(axes, corners)
        return figure


def _corners(vectors: NDArray[np.complex128]) -> NDArray[np.complex128]:
    return np.concatenate([[0.0], np.cumsum(vectors)])


def _left_text(left: float, vectors: NDArray[np.complex128]) -> str:
    # Rounding of a sum that closes is no length.
    return f"{left:.3g}" if left > 1e-9 * float(np.abs(vectors).max()) else "0"


def _frame(axes: Axes, corners: NDArray[np.complex128]) -> None:
    """Give both panels of a harmonic one scale, with room for the numbers of the gauges."""
    middle_x = (corners.real.min() + corners.real.max()) / 2
    middle_y = (corners.imag.min() + corners.imag.max()) / 2
    half = 0.62 * max(float(np.ptp(corners.real)), float(np.ptp(corners.imag)), 1e-300)
    axes.set(
        xlim=(middle_x - half, middle_x + half),
        ylim=(middle_y - half, middle_y + half),
        aspect="equal",
    )


def _end_to_end(axes: Axes, vectors: NDArray[np.complex128]) -> None:
    corners = _corners(vectors)
    longest = float(np.abs(vectors).max())
    middle = corners[:-1].mean()
    for j, (start, step) in enumerate(zip(corners[:-1], vectors, strict=True)):
        colour = SERIES[j % len(SERIES)]
        _arrow(axes, start, start + step, colour, 1.8)
        outward = step * -1j / (abs(step) or 1.0)
        centre = start + step / 2
        if (np.conj(outward) * (centre - middle)).real < 0:
            outward = -outward
        place = centre + 0.1 * longest * outward
        axes.text(
            float(place.real),
            float(place.imag),
            f"{j + 1}",
            color=colour,
            fontsize=9,
            fontweight="bold",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.8},
            horizontalalignment="center",
            verticalalignment="center",
        )
    axes.plot([0], [0], "o", color=BLACK, markersize=4)
    if abs(corners[-1]) > _POINT * longest:
        _arrow(axes, 0j, corners[-1], BLACK, 2.4)


def _arrow(axes: Axes, start: complex, end: complex, colour: str, width: float) -> None:
    axes.annotate(
        "",
        (end.real, end.imag),
        (start.real, start.imag),
        arrowprops={
            "arrowstyle": "-|>",
            "color": colour,
            "linewidth": width,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 12,
        },
    )
