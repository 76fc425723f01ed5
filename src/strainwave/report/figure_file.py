"""A figure to a file: vector or pixel by its name, whole or not at all."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Final

from strainwave.atomic import write_atomically
from strainwave.report.style import figure_style, svg

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

#: Endings that the name of a figure may have.
FORMATS: Final = (".svg", ".pdf", ".png")


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure; the same bytes for the same data.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.
    path : Path
        The file, one of `FORMATS`; replaced where it is there.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    kind = path.suffix.lower()
    if kind == ".svg":
        write_atomically(path, svg(figure).encode())
        return
    stream = io.BytesIO()
    metadata = {"CreationDate": None} if kind == ".pdf" else {}
    with figure_style():
        figure.savefig(stream, format=kind[1:], dpi=150, metadata=metadata)
    write_atomically(path, stream.getvalue())
