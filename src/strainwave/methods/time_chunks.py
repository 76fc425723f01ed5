"""Methods for a long recording: pieces of it in time chunks, side by side on vector lanes.

One thread: those that read and write have the other cores. Each chunk is warmed up on the rows
before it and held against where the chunk before ended; one that differs too much is filtered again
in sequence (docs/design/batch.md). The state goes on from piece to piece.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from strainwave import _core
from strainwave.batch import LongOscillatorFilter
from strainwave.batch_ripple import LongRippleFilter, pairs_of, warm_up_turns
from strainwave.methods.interface import Cleaned, nothing
from strainwave.methods.motion import BackwardDifference
from strainwave.methods.published import Published
from strainwave.methods.ripple import Ripple

if TYPE_CHECKING:
    from collections.abc import Callable

    from strainwave.batch import LongResult
    from strainwave.methods.interface import Method
    from strainwave.samples import Samples


@dataclass(frozen=True)
class TimeChunks:
    """How a recording was cut, and how far its chunks are from sequence where they meet.

    Attributes
    ----------
    count : int
        Chunks, those at the start of a piece among them: each of these goes on from the state in
        which the piece before ended.
    repeated : int
        Chunks that were filtered again in sequence, because they differed too much.
    warm_up_rows : int
        Rows that were filtered twice.
    largest_difference_Nm, rms_difference_Nm : float
        Of the ripple at the boundaries that were kept, Nm.
    """

    count: int = 0
    repeated: int = 0
    warm_up_rows: int = 0
    largest_difference_Nm: float = 0.0
    rms_difference_Nm: float = 0.0


class _Tally:
    """Adds up what the pieces report."""

    def __init__(self) -> None:
        self._pieces = 0
        self._squares_Nm2 = 0.0
        self.chunks = TimeChunks()

    def cleaned(self, result: LongResult) -> Cleaned:
        """Take note of a piece's report, and hand on the rest."""
        report, before = result.report, self.chunks
        self._pieces += 1
        kept = report.chunk_count - 1 - report.repeated_chunks
        self._squares_Nm2 += kept * report.rms_ripple_difference_Nm**2
        count = before.count + report.chunk_count
        repeated = before.repeated + report.repeated_chunks
        all_kept = max(1, count - self._pieces - repeated)
        self.chunks = TimeChunks(
            count,
            repeated,
            before.warm_up_rows + report.warm_up_samples,
            max(before.largest_difference_Nm, report.largest_ripple_difference_Nm),
            math.sqrt(self._squares_Nm2 / all_kept),
        )
        assert result.ripple_Nm is not None
        assert result.status is not None
        return Cleaned(result.torque_Nm, result.ripple_Nm, result.status)


class InTimeChunks:
    """A method over long pieces of a recording.

    Parameters
    ----------
    run : callable
        Filters the next piece.
    warm_up_turns : float
        Motor turns by which a chunk begins early; 0 where that is not a matter of turns.
    """

    def __init__(self, run: Callable[[Samples], LongResult], warm_up_turns: float) -> None:
        self._run = run
        self._tally = _Tally()
        self.warm_up_turns = warm_up_turns

    @property
    def time_chunks(self) -> TimeChunks:
        """How the pieces so far were cut."""
        return self._tally.chunks

    def process(self, samples: Samples, /) -> Cleaned:
        """Remove the ripple from the next piece.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call: many, so that there is room for chunks.

        Returns
        -------
        Cleaned
            One row for each.
        """
        return self._tally.cleaned(self._run(samples))

    def finish(self) -> Cleaned:
        """Hand out nothing: no rows are held back.

        Returns
        -------
        Cleaned
            No rows.
        """
        return nothing()


def in_time_chunks(method: Method) -> InTimeChunks | None:
    """Make a method for long pieces of one that has taken no rows yet.

    Parameters
    ----------
    method : Method
        As `strainwave.methods.registry.build_method` builds it.

    Returns
    -------
    InTimeChunks or None
        One that starts as the given one would; None where the method has to go in sequence.
    """
    if isinstance(method, Ripple) and pairs_of(method.filter.config) <= _core.MOST_LANE_PAIRS:
        return InTimeChunks(_ripple(method), warm_up_turns(method.filter.config))
    if isinstance(method, Published) and method.turns_by_speed:
        return InTimeChunks(_published(method), 0.0)
    return None


def _ripple(method: Ripple) -> Callable[[Samples], LongResult]:
    long_filter = LongRippleFilter(method.filter.config, learned=method.learned_before)

    def run(samples: Samples) -> LongResult:
        return long_filter.process(
            samples.time_s,
            samples.motor_angle_rad,
            samples.torque_Nm,
            expected_torque_Nm=samples.expected_torque_Nm,
        )

    return run


def _published(method: Published) -> Callable[[Samples], LongResult]:
    long_filter = LongOscillatorFilter(method.config)
    motion = BackwardDifference()

    def run(samples: Samples) -> LongResult:
        return long_filter.process(
            samples.torque_Nm,
            motor_speed_rad_s=motion.speeds(samples.time_s, samples.motor_angle_rad),
            expected_torque_Nm=samples.expected_torque_Nm,
            ripple=True,
            status=True,
        )

    return run
