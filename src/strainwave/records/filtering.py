"""A recording in, a file of cleaned torque out: the whole work of `strainwave filter`."""

from __future__ import annotations

import math
from collections import deque
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from strainwave import _core
from strainwave.errors import InputError
from strainwave.fidelity.warning import fidelity_warnings
from strainwave.methods.interface import Cleaned, together
from strainwave.methods.registry import METHOD_NAMES, Setting, build_method
from strainwave.records.checks import check_method, check_output, check_survey
from strainwave.records.columns import find_columns
from strainwave.records.filtered_log import FilteredLog
from strainwave.records.findings import warnings_of
from strainwave.records.gauge_watch import gauge_watch_of, joined_status
from strainwave.records.gauge_words import gauge_sentences
from strainwave.records.in_order import InOrder
from strainwave.records.layout import build_layout
from strainwave.records.method_setting import (
    choose_wave_factor,
    joint_as_asked,
    method_name,
    read_excerpt,
    remarks_on,
)
from strainwave.records.misalignment import misalignment_as_read
from strainwave.records.opening import open_recording
from strainwave.records.options import Options
from strainwave.records.passes import Progress, sample_rows, survey_recording, untold
from strainwave.records.pieces import in_pieces, long_run
from strainwave.records.survey import estimated_rated_torque_Nm
from strainwave.records.threads import MOST_WAITING, done_behind
from strainwave.records.writer import result_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from strainwave.joint import Joint
    from strainwave.methods.interface import Method
    from strainwave.records.signals import Rows
    from strainwave.records.watching import Watch


_Part = tuple[NDArray[np.float64], NDArray[np.float64], Cleaned]

_ROWS_PER_SLICE: Final = 1 << 16
_FLAGS: Final = tuple(_core.StatusFlag)
_FAULTS: Final = np.uint32(_core.FAULT_MASK)


def filter_log(
    path: Path,
    out: Path | None,
    options: Options | None = None,
    *,
    joint_path: Path | None = None,
    method: str | None = None,
    build: Callable[[str, Setting], Method] | None = None,
    in_sequence: bool = False,
    progress: Progress = untold,
    watch: Watch | None = None,
) -> FilteredLog:
    """Remove the ripple from a recording of any length.

    The recording is passed over twice in chunks: once to see what it holds, and once to filter it.
    Reading, filtering and writing go on at the same time. A long recording is filtered in time
    chunks side by side, where the method can; how far that is from sequence is measured.

    Parameters
    ----------
    path : Path
        The recording: CSV or Parquet.
    out : Path or None
        Where the result goes: .csv or .parquet; written whole or not at all. None writes nothing,
        for who wants to know what would be done.
    options : Options, optional
        How the recording is read; what it leaves open the joint file says.
    joint_path : Path, optional
        The joint file.
    method : str, optional
        Name of the method; without, that of the joint file, else the ripple filter.
    build : callable, optional
        Builds a method from its name and a `Setting`; that of `strainwave.methods.registry`
        without.
    in_sequence : bool
        Row after row, however long the recording is.
    progress : Progress
        Is told how far the work is.
    watch : Watch, optional
        Is shown the method and everything that it gives.

    Returns
    -------
    FilteredLog
        What was done.

    Raises
    ------
    InputError
        If something that was given cannot be used; nothing is written then.
    """
    path, options = Path(path), options or Options()
    out = None if out is None else Path(out)
    if out is not None:
        check_output(out, path, joint_path)
    joint = None if joint_path is None else _read_joint(joint_path)
    name = method_name(method, joint)
    is_known = build is None
    if build is None:
        check_method(name, METHOD_NAMES)
        build = build_method
    layout = build_layout(options, joint)
    recording = open_recording(path)
    found = find_columns(layout.columns, recording.names, recording.column_count, recording.source)
    survey = survey_recording(recording, layout, found, progress)
    check_survey(recording.source, layout, found, survey)
    rated_Nm = layout.rated_torque_Nm or estimated_rated_torque_Nm(survey)
    misalignment = misalignment_as_read(
        joint_as_asked(joint, options), name, layout, survey, is_absolute=options.absolute_angle
    )
    joint = misalignment.joint
    excerpt = read_excerpt(sample_rows(recording, layout, found, survey))
    wave = choose_wave_factor(joint, layout.ratio, excerpt)
    setting = Setting(survey.sample_period_s, layout.ratio, rated_Nm, joint, wave.factor, excerpt)
    remover = build(name, setting)
    swallowed = fidelity_warnings(name, setting, remover) if is_known else ()
    log = FilteredLog(
        path,
        out,
        layout,
        survey,
        name,
        rated_Nm,
        (*warnings_of(layout, survey, rated_Nm), *misalignment.says, *remarks_on(wave), *swallowed),
        wave_factor=float(wave.factor),
        wave_factor_source=wave.source,
        ripple_settings=getattr(remover, "settings", None),
        misalignment_terms=misalignment.terms,
    )
    if watch is not None:
        # With what was chosen: who builds it once more gets the same.
        watch.begin(survey.rows, name, replace(setting, ripple_settings=log.ripple_settings), build)
    gauge_watch = gauge_watch_of(layout, survey, found)
    rows = sample_rows(recording, layout, found, survey, progress, gauge_watch)
    long = None if in_sequence else long_run(remover, survey)
    if long is None:
        log = _filter(log, InOrder(remover), rows, watch)
    else:
        pieces = in_pieces(rows, long.piece_rows)
        log = _filter(log, InOrder(long.method), pieces, watch, most_waiting=1)
    return replace(
        log,
        time_chunks=None if long is None else long.method.time_chunks,
        gauges=None if gauge_watch is None else gauge_watch.result(),
        warnings=(*log.warnings, *gauge_sentences(layout, found, gauge_watch)),
    )


def _read_joint(path: Path) -> Joint:
    # Who has no joint file does not wait for the library that checks it.
    from strainwave.joint import read_joint  # noqa: PLC0415

    return read_joint(path).joint


def _filter(
    log: FilteredLog,
    method: Method,
    parts: Iterator[Rows],
    watch: Watch | None,
    most_waiting: int = MOST_WAITING,
) -> FilteredLog:
    tally = _Tally()
    waiting = _Waiting()
    with nullcontext() if log.out is None else result_file(log.out) as write:

        def count(part: _Part) -> None:
            for _, measured_Nm, cleaned in _slices(part):
                tally.take(measured_Nm, cleaned)

        def hand_out(part: _Part) -> None:
            for time_s, measured_Nm, cleaned in _slices(part):
                if watch is not None:
                    watch.take(time_s, measured_Nm, cleaned)
                if write is not None:
                    write(time_s, measured_Nm, cleaned)

        with (
            done_behind(count, most_waiting=most_waiting) as put_to_count,
            done_behind(hand_out, most_waiting=most_waiting) as put_out,
        ):
            for cleaned in _cleaned(method, parts, waiting):
                if len(cleaned):
                    time_s, measured_Nm, of_gauges = waiting.pop(len(cleaned))
                    status = joined_status(cleaned.status, of_gauges)
                    part = (time_s, measured_Nm, replace(cleaned, status=status))
                    put_to_count(part)
                    put_out(part)
        if tally.rows != log.survey.rows:
            raise InputError(
                f"{log.path}: it had {log.survey.rows} rows at first and {tally.rows} later; "
                "expected a recording that does not change, so wait until it is complete"
            )
    before_Nm, after_Nm, ripple_Nm = tally.rms_Nm()
    return replace(
        log,
        rows_by_flag=tally.rows_by_flag,
        torque_before_rms_Nm=before_Nm,
        torque_after_rms_Nm=after_Nm,
        ripple_rms_Nm=ripple_Nm,
    )


def _slices(part: _Part) -> Iterator[_Part]:
    """Hand out a part in slices that stay in a processor's cache."""
    time_s, measured_Nm, cleaned = part
    for start in range(0, len(cleaned), _ROWS_PER_SLICE):
        rows = slice(start, start + _ROWS_PER_SLICE)
        yield time_s[rows], measured_Nm[rows], cleaned.part(rows)


def _cleaned(method: Method, parts: Iterator[Rows], waiting: _Waiting) -> Iterator[Cleaned]:
    for rows in parts:
        waiting.push(rows)
        yield method.process(rows.samples)
    yield method.finish()


class _Waiting:
    """Time, torque and what is said of the gauges, of the rows that a method still holds back."""

    def __init__(self) -> None:
        self._parts: deque[Rows] = deque()

    def push(self, rows: Rows) -> None:
        if len(rows):
            self._parts.append(rows)

    def pop(
        self, count: int
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.uint32]]:
        taken = []
        while count > 0:
            rows = self._parts.popleft()
            taken.append(rows.part(slice(count)))
            if len(rows) > count:
                self._parts.appendleft(rows.part(slice(count, None)))
            count -= min(count, len(rows))
        return (
            together([each.log_time_s for each in taken]),
            together([each.samples.torque_Nm for each in taken]),
            together([each.gauge_status for each in taken]),
        )


class _Tally:
    """Counts flags and adds up squares of what is written."""

    def __init__(self) -> None:
        self.rows = 0
        self.rows_by_flag = {str(flag.name): 0 for flag in _FLAGS}
        self._good = 0
        self._squares = np.zeros(3)

    def take(self, measured_Nm: NDArray[np.float64], cleaned: Cleaned) -> None:
        self.rows += len(cleaned)
        raised = np.bitwise_or.reduce(cleaned.status, initial=np.uint32(0))
        for flag in _FLAGS:
            bits = np.uint32(flag.value)
            if raised & bits:
                self.rows_by_flag[str(flag.name)] += int(np.count_nonzero(cleaned.status & bits))
        signals = (measured_Nm, cleaned.torque_Nm, cleaned.ripple_Nm)
        squares = _sums_of_squares(signals)
        good = len(cleaned)
        # The sums tell whether all is finite; only where it is not, rows are left out one by one.
        if raised & _FAULTS or not np.isfinite(squares).all():
            rows = (cleaned.status & _FAULTS) == 0
            rows &= np.isfinite(signals).all(axis=0)
            good = int(np.count_nonzero(rows))
            squares = _sums_of_squares([signal[rows] for signal in signals])
        self._good += good
        self._squares += squares

    def rms_Nm(self) -> tuple[float | None, float | None, float | None]:
        if self._good == 0:
            return (None, None, None)
        before, after, ripple = (math.sqrt(squares / self._good) for squares in self._squares)
        return (before, after, ripple)


def _sums_of_squares(signals: Iterable[NDArray[np.float64]]) -> NDArray[np.float64]:
    return np.array([np.sum(np.square(signal)) for signal in signals])
