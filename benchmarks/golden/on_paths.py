"""The golden chains' filters in lanes, on threads and in time chunks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import DTypeLike

import strainwave as sw
from benchmarks.golden.chains import Answers, motor_angle_rad, numbers, ripple_config
from benchmarks.golden.inputs import SPEED_STEP_RAD_S, TICK_S, TORQUE_STEP_NM, Samples
from benchmarks.golden.vectors import PRECISIONS, answers_of, deviations
from strainwave.batch import OscillatorBatch, available_vector_levels, filter_long
from strainwave.batch_ripple import RippleBatch, filter_ripple_long

#: Memories of the filter that a chunk is warmed up by: for some less than usual, because the golden
#: log is short. The chain of gauges is whole in C++ alone; a filter with twelve pairs has no lanes.
CHUNK_MEMORIES: Final = {"published_4": 16.0, "published_6": 8.0, "default_3_orders": 16.0}


@dataclass(frozen=True)
class PathDeviation:
    """How far one chain is from step by step and from the golden file on one path.

    Attributes
    ----------
    chain, precision, path : str
        What is run, and how.
    furthest_FS : float
        Largest difference of any sample's torque or ripple from step by step.
    from_golden_FS, from_double_FS : float
        Largest difference from the file's torques in this precision, and in double.
    other_statuses : int
        Samples with another status than step by step.
    chunks, repeated_chunks : int
        Chunks, and how many of them were filtered again in sequence; 0 where there are none.
    """

    chain: str
    precision: str
    path: str
    furthest_FS: float
    from_golden_FS: float
    from_double_FS: float
    other_statuses: int
    chunks: int = 0
    repeated_chunks: int = 0


class GoldenFilter:
    """A golden chain's filter and the signals that it is fed.

    Parameters
    ----------
    definition : dict
        As in ``golden.json``.
    samples : Samples
        The samples.
    name : str
        A chain of `CHUNK_MEMORIES`.
    dtype : dtype_like
        float32 or float64.
    """

    def __init__(
        self, definition: dict[str, Any], samples: Samples, name: str, dtype: DTypeLike
    ) -> None:
        self._dtype = dtype
        self._memories = CHUNK_MEMORIES[name]
        self._is_published = name.startswith("published")
        torque_Nm = numbers(samples.torque, TORQUE_STEP_NM, dtype)
        expected_Nm = numbers(samples.expected, TORQUE_STEP_NM, dtype)
        if self._is_published:
            preset = "taghirad1999-4" if name == "published_4" else "taghirad1999"
            self._config: Any = sw.oscillator_preset(preset)
            self._signals = {
                "torque_Nm": torque_Nm,
                "motor_speed_rad_s": numbers(samples.speed, SPEED_STEP_RAD_S, dtype),
                "expected_torque_Nm": expected_Nm,
            }
            self._wanted = {"ripple": True, "status": True}
        else:
            self._config = ripple_config(definition)
            self._signals = {
                "time_s": samples.ticks * TICK_S,
                "motor_angle_rad": motor_angle_rad(samples),
                "torque_Nm": torque_Nm,
                "expected_torque_Nm": expected_Nm,
            }
            self._wanted = {}

    def in_lanes(self, level: Any, threads: int, channels: int) -> Answers:
        """Run beside later parts of the same motion.

        Parameters
        ----------
        level : VectorLevel
            Of `strainwave.batch.available_vector_levels`.
        threads : int
            Threads that share the channels.
        channels : int
            This one and others.

        Returns
        -------
        Answers
            Of this one.
        """
        kind: Any = OscillatorBatch if self._is_published else RippleBatch
        columns = {
            name: [
                values,
                *(values[2500 + 1000 * i : 9000 + 3000 * i] for i in range(channels - 1)),
            ]
            for name, values in self._signals.items()
        }
        found = kind([self._config] * channels, dtype=self._dtype).process(
            **columns, **self._wanted, level=level, threads=threads
        )
        return Answers(found.torque_Nm[0], found.ripple_Nm[0], found.status[0])

    def in_chunks(self, level: Any, threads: int) -> tuple[Answers, Any]:
        """Run in time chunks.

        Parameters
        ----------
        level : VectorLevel
            Of `strainwave.batch.available_vector_levels`.
        threads : int
            Threads that share the chunks.

        Returns
        -------
        answers : Answers
            Of every sample.
        report : LongReport
            Chunks, and how they met.
        """
        filter_log: Any = filter_long if self._is_published else filter_ripple_long
        found = filter_log(
            self._config,
            **self._signals,
            **self._wanted,
            dtype=self._dtype,
            level=level,
            threads=threads,
            warm_up_memories=self._memories,
        )
        return Answers(found.torque_Nm, found.ripple_Nm, found.status), found.report


def path_deviations(
    golden: dict[str, Any], samples: Samples, name: str, precision: str
) -> Iterator[PathDeviation]:
    """Run one chain's filter on every path.

    Parameters
    ----------
    golden : dict
        From `benchmarks.golden.vectors.read_golden`.
    samples : Samples
        The samples.
    name : str
        A chain of `CHUNK_MEMORIES`.
    precision : str
        ``double`` or ``float``.

    Yields
    ------
    PathDeviation
        Lanes alone and beside others at every level, then chunks; on one thread and on two.
    """
    step_by_step = answers_of(golden["definition"], name, precision)
    scale_Nm = golden["definition"]["full_scale_Nm"]
    filtered = GoldenFilter(golden["definition"], samples, name, PRECISIONS[precision])

    def deviation(path: str, answers: Answers, *chunks: int) -> PathDeviation:
        apart = (
            answers.torque_Nm - step_by_step.torque_Nm,
            answers.ripple_Nm - step_by_step.ripple_Nm,
        )
        kept = deviations(golden, name, answers)
        return PathDeviation(
            name,
            precision,
            path,
            max(float(np.max(np.abs(each))) for each in apart) / scale_Nm,
            kept[f"from_{precision}_FS"],
            kept["from_double_FS"],
            int(np.count_nonzero(answers.status != step_by_step.status)) + kept["other_status"],
            *chunks,
        )

    for level in available_vector_levels()[1:]:
        where = level.name.replace("_", "-")
        yield deviation(f"{where}, alone", filtered.in_lanes(level, 1, 1))
        for threads in (1, 2):
            answers = filtered.in_lanes(level, threads, 19)
            yield deviation(f"{where}, one of 19, {threads} threads", answers)
        for threads in (1, 2):
            answers, report = filtered.in_chunks(level, threads)
            yield deviation(
                f"{where}, time chunks, {threads} threads",
                answers,
                report.chunk_count,
                report.repeated_chunks,
            )
