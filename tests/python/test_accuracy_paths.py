"""The accuracy bench's joints on every path: the same errors, and what is not is seen."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from benchmarks.accuracy.joint import FULL_SCALE_NM, NOISE_NM, make_joint, simulate
from benchmarks.accuracy.long_run import long_run
from benchmarks.accuracy.methods.on_paths import PATH_FILTERS, Outcome
from benchmarks.accuracy.methods.ours import IN_LANES, OURS
from benchmarks.accuracy.methods.published import PUBLISHED_TUNED
from benchmarks.accuracy.motion import LEARNING, PHASES
from benchmarks.accuracy.path_table import HEADINGS, REFUSED, legend, markdown_of, path_rows
from benchmarks.accuracy.paths import (
    SETS,
    STEP_BY_STEP,
    Comparison,
    scores_in_chunks,
    scores_in_lanes,
)
from benchmarks.accuracy.ripple import MISMATCH, RIGHT
from benchmarks.accuracy.targets import MOST_ERROR_PERCENT, path_targets
from strainwave.batch import available_vector_levels
from strainwave.errors import InputError

PUBLISHED_TUNING = {"process_over_measurement": 1e-5, "minimum_speed_rad_s": 10.0}
TUNINGS = {
    OURS.name: dict.fromkeys(SETS, IN_LANES),
    PUBLISHED_TUNED.name: dict.fromkeys(SETS, PUBLISHED_TUNING),
}
#: Furthest sample from step by step in lanes, Nm: at least and at most. Float rounds at 4e-6 Nm and
#: learns from it; in double, how little a term is known is judged in a frame that lanes move at
#: other samples, which the published filter does not have.
LANES_NM = {
    (OURS.name, "double"): (1e-13, 1e-6),
    (OURS.name, "float"): (1e-6, 4e-3),
    (PUBLISHED_TUNED.name, "double"): (1e-15, 1e-11),
    (PUBLISHED_TUNED.name, "float"): (1e-6, 4e-3),
}
#: Between chunks, where 1e-4 Nm of ripple may be left at a boundary and a hundred times as much of a
#: coefficient that is hardly seen there.
CHUNKS_NM = (1e-9, 4e-3)


@pytest.mark.parametrize(("method", "precision"), LANES_NM)
def test_lanes_have_the_errors_of_step_by_step(method, precision):
    scores = scores_in_lanes(method, TUNINGS[method], precision, seeds=(1,))
    # Every level but one by one, and the highest one on two threads.
    assert len(scores) == 1 + len(available_vector_levels())
    least_Nm, most_Nm = LANES_NM[method, precision]
    for score in scores[1:]:
        assert least_Nm <= score.furthest_Nm <= most_Nm, score
        assert 0 < score.change_percent <= 5e-4, score
        assert score.other_statuses == 0, score
        assert not score.refused
        for scenario, error in score.error_percent.items():
            assert error == pytest.approx(scores[0].error_percent[scenario], abs=5e-4)
    assert scores[-1] == replace(scores[-2], path=scores[-1].path)  # threads change nothing


def test_chunks_have_the_errors_of_step_by_step_and_keep_the_limits():
    scores = scores_in_chunks(OURS.name, TUNINGS[OURS.name], "float", minutes=10)
    assert [score.path for score in scores] == [
        STEP_BY_STEP,
        "time chunks",
        "time chunks, 2 threads",
    ]
    for score in scores[1:]:
        assert CHUNKS_NM[0] <= score.furthest_Nm <= CHUNKS_NM[1]
        assert 0 < score.change_percent <= 5e-4
        assert score.other_statuses == 0
        assert min(score.chunks) > 1
        assert 2 * score.repeated_chunks < sum(score.chunks)
    for score in scores:
        for scenario, most in MOST_ERROR_PERCENT.items():
            # The noise alone is 0.1.
            assert 100 * NOISE_NM / FULL_SCALE_NM < score.error_percent[scenario] <= most


def test_the_published_filter_is_cut_into_chunks_too():
    scores = scores_in_chunks(
        PUBLISHED_TUNED.name, TUNINGS[PUBLISHED_TUNED.name], "double", minutes=10
    )
    for score in scores[1:]:
        assert CHUNKS_NM[0] <= score.furthest_Nm <= CHUNKS_NM[1]
        assert score.other_statuses == 0
        assert min(score.chunks) > 4
        assert 2 * score.repeated_chunks < sum(score.chunks)


@pytest.fixture(scope="module")
def compared():
    runs = [(scenario, simulate(make_joint(scenario, 1))) for scenario in SETS]
    return Comparison(OURS.name, TUNINGS[OURS.name], runs, "float", "2 x 1 min")


def test_a_path_that_is_wrong_is_seen(compared):
    alone = [
        compared.filter.alone(config, log, compared.dtype)
        for config, log in zip(compared.configs, compared.logs, strict=True)
    ]
    assert compared.score("same", alone).furthest_Nm == 0
    spoilt = alone[1].torque_Nm.copy()
    spoilt[30_000:31_000] += np.float32(0.1)
    status = alone[1].status.copy()
    status[77] ^= 1
    score = compared.score("spoilt", [alone[0], Outcome(spoilt, status)])
    assert score.furthest_Nm == pytest.approx(0.1, rel=1e-3)
    assert score.other_statuses == 1
    assert score.change_percent > 1e-3
    assert score.error_percent[RIGHT] == compared.step_by_step().error_percent[RIGHT]
    assert score.error_percent[MISMATCH] > compared.step_by_step().error_percent[MISMATCH]
    missed = [t.what for t in path_targets([asdict(score)]) if not t.met]
    assert missed == [
        "change of an error by a path, %FS",
        "furthest sample from step by step, %FS",
        "samples with another status than step by step",
    ]


def test_a_filter_that_a_path_refuses_is_said(monkeypatch):
    def refuse(*_, **__):
        raise InputError("configs have more than 10 pairs")

    refusing = replace(PATH_FILTERS[OURS.name], side_by_side=refuse)
    monkeypatch.setitem(PATH_FILTERS, OURS.name, refusing)
    step_by_step, *refused = scores_in_lanes(OURS.name, TUNINGS[OURS.name], "float", seeds=(1,))
    rows = path_rows([asdict(score) for score in refused])
    assert rows
    for row in rows:
        assert len(row) == len(HEADINGS)
        assert REFUSED in row
    assert legend([asdict(score) for score in refused])[-1].endswith("more than 10 pairs")
    found = path_targets([asdict(each) for each in (step_by_step, *refused)])
    missed = {target.what: target.measured for target in found if not target.met}
    assert missed == {"paths that refuse a filter": len(rows)}


def test_the_table_has_a_row_for_each_path(compared):
    scores = [asdict(compared.step_by_step()) | {"chunks": ()}]
    text = markdown_of({"paths": [*scores, {**scores[0], "path": "time chunks", "chunks": (3, 4)}]})
    rows = [line for line in text.splitlines() if line.startswith("| 1 ours")]
    assert len(rows) == 2
    assert "3, 4 (0)" in rows[1]
    assert f"1. ours: memory_turns {IN_LANES['memory_turns']:g}" in text
    assert all(line.count("|") == len(HEADINGS) + 1 for line in rows)


def test_a_long_run_goes_on_where_the_last_minute_ended():
    run = long_run(MISMATCH, 2, 3)
    assert len(run.motion.time_s) == 3 * 60_700
    assert np.ptp(np.diff(run.motion.time_s)) < 1e-9
    assert set(run.motion.phase) == {LEARNING, *PHASES}
    # No sample moves by more than the fastest motion does in a millisecond.
    assert 0.15 < np.max(np.abs(np.diff(run.motion.angle_rad))) < 0.25
    noise_Nm = run.measured_torque_Nm - run.true_torque_Nm - run.ripple_Nm
    minutes = noise_Nm.reshape(3, -1)
    assert np.std(minutes) == pytest.approx(NOISE_NM, rel=0.01)
    assert abs(np.corrcoef(minutes[0], minutes[1])[0, 1]) < 0.02
