"""Runs everything, a process per core, and puts the results into one document."""

from __future__ import annotations

import multiprocessing
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.accuracy.basis import basis_residual_percent
from benchmarks.accuracy.coverage import all_coverage
from benchmarks.accuracy.evaluation import SEEDS, Score, choose_tuning, score
from benchmarks.accuracy.joint import make_joint, simulate
from benchmarks.accuracy.kuka import JOINTS, read_kuka_joint, score_on_kuka
from benchmarks.accuracy.methods.catalogue import BY_NAME, METHODS
from benchmarks.accuracy.methods.ours import BY_MEMORY, IN_LANES, KUKA_GRID, OURS
from benchmarks.accuracy.methods.published import PUBLISHED_TUNED
from benchmarks.accuracy.other_recordings import run_through
from benchmarks.accuracy.pass_through import FREQUENCIES_HZ, fidelity
from benchmarks.accuracy.paths import PRECISIONS, SETS, scores_in_chunks, scores_in_lanes
from benchmarks.accuracy.ripple import RIGHT, SCENARIOS
from strainwave.errors import InputError


def run_bench(folder: Path, processes: int) -> dict[str, Any]:
    """Run the bench.

    Parameters
    ----------
    folder : pathlib.Path
        Folder of the recordings; where it is absent they are skipped.
    processes : int
        How many processes work.

    Returns
    -------
    dict
        All results, plain values; see docs/design/accuracy-bench.md.
    """
    # Spawned, so that children see the environment and nothing else of the parent.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        tunings = {
            (method.name, scenario): pool.submit(choose_tuning, method.name, scenario)
            for method in METHODS
            for scenario in SCENARIOS
        }
        chosen = {key: future.result() for key, future in tunings.items()}
        scores = {
            (name, scenario): [pool.submit(score, name, tuning, scenario, s) for s in SEEDS]
            for (name, scenario), tuning in chosen.items()
        }
        passing = {
            method.name: pool.submit(fidelity, method.name, chosen[method.name, RIGHT])
            for method in METHODS
        }
        without_load = pool.submit(
            fidelity, OURS.name, {**chosen[OURS.name, RIGHT], "load_terms": False}
        )
        real = pool.submit(_recordings, folder)
        covered = pool.submit(all_coverage)
        by_memory = [
            (
                tuning,
                {
                    sc: [pool.submit(score, OURS.name, tuning, sc, s) for s in SEEDS]
                    for sc in SCENARIOS
                },
                pool.submit(fidelity, OURS.name, tuning),
            )
            for tuning in BY_MEMORY
        ]
        by_path = [
            pool.submit(scores_of, name, tunings_by_set, precision)
            for name, tunings_by_set in (
                (OURS.name, {s: chosen[OURS.name, s] for s in SETS}),
                (OURS.name, dict.fromkeys(SETS, IN_LANES)),
                (PUBLISHED_TUNED.name, {s: chosen[PUBLISHED_TUNED.name, s] for s in SETS}),
            )
            for precision in PRECISIONS
            for scores_of in (scores_in_lanes, scores_in_chunks)
        ]
        residuals = {
            scenario: [basis_residual_percent(simulate(make_joint(scenario, s))) for s in SEEDS]
            for scenario in SCENARIOS
        }
        methods = {
            method.name: {
                "remark": method.remark,
                "scenarios": {
                    scenario: {
                        "tuning": dict(chosen[method.name, scenario]),
                        **_mean([future.result() for future in scores[method.name, scenario]]),
                    }
                    for scenario in SCENARIOS
                },
                "fidelity": _plain(asdict(passing[method.name].result())),
            }
            for method in METHODS
        }
        return {
            "seeds": list(SEEDS),
            "frequencies_Hz": list(FREQUENCIES_HZ),
            "basis_residual_percent": residuals,
            "methods": methods,
            "ours_without_load_terms": _plain(asdict(without_load.result())),
            "ours_by_memory": [
                {
                    "tuning": dict(tuning),
                    "scenarios": {
                        scenario: _mean([future.result() for future in futures])
                        for scenario, futures in scored.items()
                    },
                    "fidelity": _plain(asdict(passed.result())),
                }
                for tuning, scored, passed in by_memory
            ],
            "coverage_percent": covered.result(),
            "paths": [_plain(asdict(each)) for future in by_path for each in future.result()],
            "recordings": real.result(),
        }


def _mean(scores: list[Score]) -> dict[str, Any]:
    names = scores[0].error_percent
    return {
        "error_percent": {
            name: float(np.mean([s.error_percent[name] for s in scores])) for name in names
        },
        "mean_error_percent_by_joint": [s.error_percent["mean"] for s in scores],
        "attenuation_steady_dB": _mean_dB([s.attenuation_steady_dB for s in scores]),
        "attenuation_overall_dB": _mean_dB([s.attenuation_overall_dB for s in scores]),
        "outside_dB": max((s.outside_dB for s in scores), key=abs),
        "outside_worst_dB": max((s.outside_worst_dB for s in scores), key=abs),
    }


def _mean_dB(values: list[tuple[float, ...]]) -> list[float]:
    # Decibels of the mean share of power that is left: a bad joint is not hidden by a good one.
    return [float(v) for v in -10 * np.log10(np.mean(10 ** (-np.array(values) / 10), axis=0))]


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    def plain(value: Any) -> Any:
        if isinstance(value, tuple | list):
            return [plain(each) for each in value]
        # JSON knows no NaN.
        return None if isinstance(value, float) and not np.isfinite(value) else value

    return {name: plain(value) for name, value in values.items()}


def _recordings(folder: Path) -> dict[str, Any] | None:
    if not folder.is_dir():
        return None
    scores, refused = [], {}
    for joint in JOINTS:
        recording = read_kuka_joint(folder, joint)
        for method in BY_NAME.values():
            for tuning in KUKA_GRID if method.grid is OURS.grid else method.grid:
                try:
                    scores.append(score_on_kuka(method, tuning, recording, joint).as_dict())
                except InputError as error:
                    refused[method.name] = str(error)
    return {
        "kuka": scores,
        "refused": refused,
        "run_through": [each.as_dict() for each in run_through(folder)],
    }
