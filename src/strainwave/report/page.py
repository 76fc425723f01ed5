"""A self-contained HTML page from parts that are already text, tables and figures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import jinja2

from strainwave.report.style import data_uri, svg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from strainwave.reproduce.comparison import Comparison


@dataclass(frozen=True)
class PlainTable:
    """Headings, and rows of text.

    Attributes
    ----------
    headings : tuple of str
        Column headings.
    rows : tuple of tuple of str
        Cells, row by row.
    numeric : tuple of int
        Columns of numbers, counted from 0, which are set to the right.
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numeric: tuple[int, ...] = ()


@dataclass(frozen=True)
class Item:
    """One figure or table with its words.

    Attributes
    ----------
    title : str
        Heading.
    paragraphs : tuple of str
        Text before the figure.
    figure : matplotlib.figure.Figure or None
        The figure.
    caption : str
        What the figure shows; it says what is simulated.
    alternative : str
        The figure in words, for who does not see it.
    table : PlainTable or None
        A table after the figure.
    comparisons : tuple of Comparison
        Published numbers beside ours, after the figure.
    narrow : matplotlib.figure.Figure or None
        The figure for a narrow screen, where there is one.
    code : str
        Text to be copied, after the table.
    is_folded : bool
        Whether it opens only on demand.
    """

    title: str
    paragraphs: tuple[str, ...] = ()
    figure: Figure | None = None
    caption: str = ""
    alternative: str = ""
    table: PlainTable | None = None
    comparisons: tuple[Comparison, ...] = ()
    narrow: Figure | None = None
    code: str = ""
    is_folded: bool = False

    @property
    def image(self) -> str:
        """The figure as a data address, or nothing."""
        return "" if self.figure is None else data_uri(svg(self.figure))

    @property
    def narrow_image(self) -> str:
        """The figure for a narrow screen as a data address, or nothing."""
        return "" if self.narrow is None else data_uri(svg(self.narrow))


@dataclass(frozen=True)
class Part:
    """A section of the page.

    Attributes
    ----------
    anchor : str
        Its address within the page.
    title : str
        Heading.
    paragraphs : tuple of str
        Text at its head.
    warning : str
        Text that stands out, or nothing.
    items : tuple of Item
        Figures and tables.
    """

    anchor: str
    title: str
    paragraphs: tuple[str, ...] = ()
    warning: str = ""
    items: tuple[Item, ...] = ()


@dataclass(frozen=True)
class Tile:
    """A number at the head of the page.

    Attributes
    ----------
    value : str
        The number with its unit.
    label : str
        What it is.
    """

    value: str
    label: str


@dataclass(frozen=True)
class Page:
    """Everything the template needs.

    Attributes
    ----------
    title : str
        Title of the page.
    lead : tuple of str
        First paragraphs.
    signal_flow : str
        The signal's way, in one line.
    tiles : tuple of Tile
        Numbers at the head.
    notice : str
        What a reader must know before the rest.
    parts : tuple of Part
        Sections.
    command : str
        Command that repeats the page.
    version : str
        Version of strainwave.
    """

    title: str
    lead: tuple[str, ...]
    signal_flow: str
    tiles: tuple[Tile, ...]
    notice: str
    parts: tuple[Part, ...]
    command: str
    version: str


def templates() -> jinja2.Environment:
    """Open the folder of templates.

    Returns
    -------
    jinja2.Environment
        Escapes what is put into a page; a name that is not there is an error.
    """
    return jinja2.Environment(
        loader=jinja2.PackageLoader("strainwave.report", "templates"),
        autoescape=jinja2.select_autoescape(["html", "j2"]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def render(page: Page) -> str:
    """Render a page; it needs no other file and no network.

    Parameters
    ----------
    page : Page
        The content.

    Returns
    -------
    str
        An HTML document.
    """
    template = templates().get_template("demo.html.j2")
    return template.render(
        title=page.title,
        lead=page.lead,
        signal_flow=page.signal_flow,
        tiles=page.tiles,
        notice=page.notice,
        parts=page.parts,
        command=page.command,
        version=page.version,
    )


def all_comparisons(parts: Sequence[Part]) -> tuple[Comparison, ...]:
    """Collect the comparisons of a page in their order.

    Parameters
    ----------
    parts : sequence of Part
        Sections of the page.

    Returns
    -------
    tuple of Comparison
        Every comparison.
    """
    return tuple(entry for part in parts for item in part.items for entry in item.comparisons)
