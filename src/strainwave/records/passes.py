"""The two passes over a recording: what it holds, and its rows as methods take them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from strainwave.records.conversion import Converter
from strainwave.records.gauge_watch import gauge_watch_of
from strainwave.records.signals import Rows, SampleBuilder
from strainwave.records.survey import Survey, Surveyor
from strainwave.records.threads import made_ahead

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.records.columns import FoundColumn
    from strainwave.records.gauge_watch import GaugeWatch
    from strainwave.records.layout import Layout
    from strainwave.records.raw import Recording


class Progress(Protocol):
    """What is told how far the work is."""

    def __call__(self, step: str, share: float, /) -> None:
        """Take what is being done, and the share of it that is done, 0 to 1."""
        ...


def untold(_step: str, _share: float, /) -> None:
    """Tell nobody."""


def survey_recording(
    recording: Recording,
    layout: Layout,
    found: dict[str, FoundColumn],
    progress: Progress = untold,
) -> Survey:
    """Pass over a recording once, and say what it holds.

    Parameters
    ----------
    recording : Recording
        The recording.
    layout : Layout
        How it is read.
    found : dict
        Its columns, by key.
    progress : Progress
        Is told how far the work is.

    Returns
    -------
    Survey
        What it holds.
    """
    converter = Converter(layout, found)
    surveyor = Surveyor(layout)
    parts = ((converter.convert(chunk), share) for chunk, share in recording.chunks(found))
    for columns, share in made_ahead(parts):
        surveyor.take(columns)
        progress("surveying", share)
    return surveyor.finish()


def sample_rows(
    recording: Recording,
    layout: Layout,
    found: dict[str, FoundColumn],
    survey: Survey,
    progress: Progress = untold,
    watch: GaugeWatch | None = None,
) -> Iterator[Rows]:
    """Read a recording as the samples that methods take.

    Parameters
    ----------
    recording : Recording
        The recording.
    layout : Layout
        How it is read.
    found : dict
        Its columns, by key.
    survey : Survey
        What it holds.
    progress : Progress
        Is told how far the work is.
    watch : GaugeWatch, optional
        One that has not begun, for who wants to know what it found; without, one is begun where
        the joint file has what it needs.

    Yields
    ------
    Rows
        Consecutive rows.
    """
    converter = Converter(layout, found)
    builder = SampleBuilder(layout, survey, watch or gauge_watch_of(layout, survey, found))
    parts = (
        (builder.take(converter.convert(chunk)), share) for chunk, share in recording.chunks(found)
    )
    for rows, share in made_ahead(parts):
        yield rows
        progress("filtering", share)
    yield builder.finish()
