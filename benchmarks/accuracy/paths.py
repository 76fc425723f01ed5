"""The same joints on every path through the core: step by step, lanes, threads, time chunks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from benchmarks.accuracy.evaluation import SEEDS, SIMULATED, log_of
from benchmarks.accuracy.joint import FULL_SCALE_NM, Run, make_joint, simulate
from benchmarks.accuracy.long_run import long_run
from benchmarks.accuracy.methods.on_paths import PATH_FILTERS, Outcome, configure
from benchmarks.accuracy.metrics import error_by_phase
from benchmarks.accuracy.motion import PHASES
from benchmarks.accuracy.ripple import MISMATCH, RIGHT
from strainwave._core import VectorLevel
from strainwave.batch import available_vector_levels
from strainwave.errors import InputError

#: The sets of joints that have limits.
SETS: Final = (RIGHT, MISMATCH)
PRECISIONS: Final = {"double": np.float64, "float": np.float32}
STEP_BY_STEP: Final = "step by step"
#: A log that is cut into chunks: one joint, minute after minute with its own noise. A filter with
#: terms is warmed up over 12 x 16 memories, and a chunk is twice as long or longer.
LONG_MINUTES: Final = 30
LONG_SEED: Final = SEEDS[0]


@dataclass(frozen=True)
class PathScore:
    """One filter on one path.

    Attributes
    ----------
    method, tuning : str
        What is run.
    joints : str
        On what.
    precision : str
        ``double`` or ``float``.
    path : str
        How.
    error_percent : mapping of str to float
        Mean error by set, percent of full scale; empty where the path refuses the filter.
    change_percent : float
        Largest change of any joint's error in any phase from step by step, percent of full scale.
    furthest_Nm : float
        Largest difference of any sample's torque from step by step.
    other_statuses : int
        Samples with another status than step by step.
    chunks : tuple of int
        How many each log was cut into; empty where that is not the path.
    repeated_chunks : int
        How many of them were filtered again in sequence.
    refused : str
        Why the path does not take the filter; empty where it does.
    """

    method: str
    tuning: str
    joints: str
    precision: str
    path: str
    error_percent: Mapping[str, float]
    change_percent: float = 0.0
    furthest_Nm: float = 0.0
    other_statuses: int = 0
    chunks: tuple[int, ...] = ()
    repeated_chunks: int = 0
    refused: str = ""


class Comparison:
    """Joints, their truth and what step by step makes of them.

    Parameters
    ----------
    method : str
        One of `benchmarks.accuracy.methods.on_paths.PATH_FILTERS`.
    tunings : mapping
        Tuning by set.
    runs : sequence of tuple
        Set and run of each joint.
    precision : str
        One of `PRECISIONS`.
    joints : str
        What the joints are called.
    """

    def __init__(
        self,
        method: str,
        tunings: Mapping[str, Mapping[str, Any]],
        runs: Sequence[tuple[str, Run]],
        precision: str,
        joints: str,
    ) -> None:
        self.filter = PATH_FILTERS[method]
        self.configs = [configure(method, SIMULATED, tunings[scenario]) for scenario, _ in runs]
        self.logs = [log_of(run) for _, run in runs]
        self.dtype = PRECISIONS[precision]
        self._runs = runs
        self._said = (method, _text(tunings), joints, precision)
        self._alone = [
            self.filter.alone(config, log, self.dtype)
            for config, log in zip(self.configs, self.logs, strict=True)
        ]
        self._errors = self._errors_of(self._alone)

    def step_by_step(self) -> PathScore:
        """Score the filters as they are measured in all other tables.

        Returns
        -------
        PathScore
            No difference.
        """
        return self.score(STEP_BY_STEP, self._alone)

    def score(self, path: str, found: Sequence[Outcome], reports: Sequence[Any] = ()) -> PathScore:
        """Score a path by what it made of the joints.

        Parameters
        ----------
        path : str
            Its name.
        found : sequence of Outcome
            Of each joint.
        reports : sequence of LongReport
            Of each joint, where it was cut into chunks.

        Returns
        -------
        PathScore
            Errors, and differences from step by step.
        """
        errors = self._errors_of(found)
        pairs = list(zip(found, self._alone, strict=True))
        return PathScore(
            *self._said,
            path,
            {
                each: float(
                    np.mean(
                        [
                            error["mean"]
                            for error, (scenario, _) in zip(errors, self._runs, strict=True)
                            if scenario == each
                        ]
                    )
                )
                for each in SETS
            },
            max(
                abs(error[phase] - alone[phase])
                for error, alone in zip(errors, self._errors, strict=True)
                for phase in PHASES
            ),
            max(float(np.max(np.abs(a.torque_Nm - b.torque_Nm))) for a, b in pairs),
            sum(int(np.count_nonzero(a.status != b.status)) for a, b in pairs),
            tuple(report.chunk_count for report in reports),
            sum(report.repeated_chunks for report in reports),
        )

    def refused(self, path: str, why: InputError) -> PathScore:
        """Say that a path does not take the filter.

        Parameters
        ----------
        path : str
            Its name.
        why : InputError
            What it said.

        Returns
        -------
        PathScore
            Without errors.
        """
        return PathScore(*self._said, path, {}, refused=str(why))

    def _errors_of(self, found: Sequence[Outcome]) -> list[dict[str, float]]:
        return [
            error_by_phase(
                outcome.torque_Nm - run.true_torque_Nm, run.motion.phase, PHASES, FULL_SCALE_NM
            )
            for outcome, (_, run) in zip(found, self._runs, strict=True)
        ]


def scores_in_lanes(
    method: str,
    tunings: Mapping[str, Mapping[str, Any]],
    precision: str,
    seeds: Sequence[int] = SEEDS,
) -> list[PathScore]:
    """Run all joints of both sets side by side, at every vector level, and on two threads.

    Parameters
    ----------
    method : str
        One of `benchmarks.accuracy.methods.on_paths.PATH_FILTERS`.
    tunings : mapping
        Tuning by set.
    precision : str
        One of `PRECISIONS`.
    seeds : sequence of int
        Which joints of each set.

    Returns
    -------
    list of PathScore
        Step by step, then each path.
    """
    runs = [(scenario, simulate(make_joint(scenario, seed))) for scenario in SETS for seed in seeds]
    compared = Comparison(method, tunings, runs, precision, f"{len(runs)} x 1 min")
    levels = available_vector_levels()
    paths = [(f"lanes, {_level(level)}", level, 1) for level in levels[1:]]
    paths.append((f"lanes, {_level(levels[-1])}, 2 threads", levels[-1], 2))
    scores = [compared.step_by_step()]
    for path, level, threads in paths:
        try:
            found = compared.filter.side_by_side(
                compared.configs, compared.logs, compared.dtype, threads=threads, level=level
            )
        except InputError as error:
            scores.append(compared.refused(path, error))
        else:
            scores.append(compared.score(path, found))
    return scores


def scores_in_chunks(
    method: str,
    tunings: Mapping[str, Mapping[str, Any]],
    precision: str,
    minutes: int = LONG_MINUTES,
) -> list[PathScore]:
    """Run one joint of each set for long enough to be cut, at the highest vector level.

    Parameters
    ----------
    method : str
        One of `benchmarks.accuracy.methods.on_paths.PATH_FILTERS`.
    tunings : mapping
        Tuning by set.
    precision : str
        One of `PRECISIONS`.
    minutes : int
        Length of the logs.

    Returns
    -------
    list of PathScore
        Step by step, then in chunks on one thread and on two.
    """
    runs = [(scenario, long_run(scenario, LONG_SEED, minutes)) for scenario in SETS]
    compared = Comparison(method, tunings, runs, precision, f"{len(runs)} x {minutes} min")
    scores = [compared.step_by_step()]
    for path, threads in (("time chunks", 1), ("time chunks, 2 threads", 2)):
        try:
            found = [
                compared.filter.in_chunks(config, log, compared.dtype, threads=threads)
                for config, log in zip(compared.configs, compared.logs, strict=True)
            ]
        except InputError as error:
            scores.append(compared.refused(path, error))
        else:
            scores.append(
                compared.score(path, [each for each, _ in found], [report for _, report in found])
            )
    return scores


def _level(level: VectorLevel) -> str:
    return str(level.name).replace("_", "-")


def _text(tunings: Mapping[str, Mapping[str, Any]]) -> str:
    texts = [
        ", ".join(f"{key} {value:.3g}" for key, value in tuning.items())
        for tuning in tunings.values()
    ]
    return " / ".join(dict.fromkeys(texts))
