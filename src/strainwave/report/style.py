"""One look for all figures: sizes, colours and lines that can be read at page width."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

import matplotlib as mpl
from matplotlib.figure import Figure

#: Colours that stay apart for people who do not see red or green (Okabe and Ito).
BLUE: Final = "#0072B2"
ORANGE: Final = "#D55E00"
GREEN: Final = "#009E73"
YELLOW: Final = "#E69F00"
PURPLE: Final = "#CC79A7"
SKY: Final = "#56B4E9"
GREY: Final = "#7F7F7F"
BLACK: Final = "#222222"
SERIES: Final = (BLUE, ORANGE, GREEN, PURPLE, YELLOW, SKY)

PAGE_WIDTH_IN: Final = 7.2
#: For a screen that is held in a hand: its text is then as large as the page's.
NARROW_WIDTH_IN: Final = 3.7
_SETTINGS: Final[Mapping[Any, Any]] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.linewidth": 0.8,
    "grid.color": "#E2E2E2",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.2,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "figure.constrained_layout.use": True,
    "svg.hashsalt": "strainwave",
}


@contextmanager
def figure_style() -> Iterator[None]:
    """Draw with the project's settings, whatever the caller's are.

    Yields
    ------
    None
        Within, figures have the project's look.
    """
    with mpl.rc_context(dict(_SETTINGS)):
        yield


def new_figure(height_in: float, width_in: float = PAGE_WIDTH_IN) -> Figure:
    """Make an empty figure of page width, which belongs to no window.

    Parameters
    ----------
    height_in : float
        Height, inches.
    width_in : float
        Width, inches.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    return Figure(figsize=(width_in, height_in))


def separate(figure: Figure) -> None:
    """Leave room between rows of panels, so that titles keep off the labels above them.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        A figure with more than one row.
    """
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.set(hspace=0.09)  # type: ignore[call-arg]


def svg(figure: Figure) -> str:
    """Render a figure as SVG text, the same bytes for the same data.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.

    Returns
    -------
    str
        The SVG document.
    """
    stream = io.StringIO()
    with figure_style():
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def true_minus(text: str) -> str:
    """Replace hyphens of numbers by minus signs.

    Parameters
    ----------
    text : str
        A number, or numbers without words.

    Returns
    -------
    str
        The same, with minus signs.
    """
    return text.replace("-", "\N{MINUS SIGN}")


def data_uri(svg_text: str) -> str:
    """Embed an SVG document in a page.

    Parameters
    ----------
    svg_text : str
        The document.

    Returns
    -------
    str
        A data address for an image element.
    """
    encoded = base64.b64encode(svg_text.encode()).decode("ascii")
    return f"data:image/svg+xml;base64,{encoded}"
