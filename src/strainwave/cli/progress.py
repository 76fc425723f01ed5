"""A bar on the terminal that says how far a command is."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import Console

    from strainwave.records.passes import Progress


@contextlib.contextmanager
def progress_bar(console: Console) -> Iterator[Progress]:
    """Show a bar while a recording is read and filtered.

    Parameters
    ----------
    console : rich.console.Console
        Where it is drawn.

    Yields
    ------
    callable
        Takes what is being done, and the share of it that is done; where nobody watches, a bar is
        noise, and it goes nowhere.
    """
    if not console.is_terminal:
        yield lambda _step, _share, /: None
        return
    # Who draws no bar does not wait for the library.
    from rich.progress import (
        BarColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
    )
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn())
    with Bar(*columns, TimeElapsedColumn(), console=console, transient=True) as bar:
        task = bar.add_task("reading", total=1.0)

        def progress(step: str, share: float, /) -> None:
            bar.update(task, description=step, completed=share)

        yield progress
