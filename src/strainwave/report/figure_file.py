"""A figure to a file: vector or pixel by its name, whole or not at all."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Final

from strainwave.atomic import write_atomically
from strainwave.errors import InputError
from strainwave.report.style import figure_style, svg

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

FORMATS: Final = (".svg", ".pdf", ".png")


def check_figure_file(path: Path, option: str = "--figure") -> None:
    """Make sure that a figure can be written, before the work.

    Parameters
    ----------
    path : Path
        The file.
    option : str
        Name of the option, for messages.

    Raises
    ------
    InputError
        If its name ends in nothing known, or its folder is missing.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            f"{option} {path}: the name ends in {path.suffix!r}; expected {', '.join(FORMATS)}, so "
            "choose another name"
        )
    if path.is_dir() or not path.resolve().parent.is_dir():
        raise InputError(
            f"{option} {path}: there is no such folder, or it is one itself; expected a file in an "
            "existing folder, so choose another place"
        )


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
