"""The golden vectors through Python's lanes, threads and time chunks."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from benchmarks.golden import vectors
from benchmarks.golden.__main__ import main
from benchmarks.golden.inputs import samples_of
from benchmarks.golden.on_paths import CHUNK_MEMORIES, GoldenFilter, path_deviations
from strainwave._core import best_vector_level
from strainwave.batch import available_vector_levels

#: Largest difference from step by step, FS, by chain and precision: some times what was found, and
#: in float no more than the fused float of a Cortex-M4F may differ.
LANES_FS = {
    ("published_4", "float"): 1e-5,
    ("published_4", "double"): 3e-14,
    ("published_6", "float"): 5e-5,
    ("published_6", "double"): 1e-13,
    ("default_3_orders", "float"): 5e-5,
    ("default_3_orders", "double"): 1e-13,
}
#: What is left of a wrong start is the same in either precision.
CHUNKS_FS = 1e-4
#: Less than this is no other rounding but the same filter.
LEAST_FS = {"float": 1e-8, "double": 1e-16}
LEAST_CHUNKS = {"published_4": 16, "published_6": 2, "default_3_orders": 3}


@pytest.fixture(scope="module")
def golden():
    return vectors.read_golden()


@pytest.fixture(scope="module")
def samples(golden):
    return samples_of(golden["definition"], golden["definition"]["samples"])


@pytest.mark.parametrize("precision", vectors.PRECISIONS)
@pytest.mark.parametrize("name", CHUNK_MEMORIES)
def test_every_path_has_the_golden_answers_to_rounding(golden, samples, name, precision):
    found = list(path_deviations(golden, samples, name, precision))
    # Alone and beside others, one thread and two, chunks likewise, at every level but one by one.
    assert len(found) == 5 * (len(available_vector_levels()) - 1)
    for each in found:
        most_FS = CHUNKS_FS if each.chunks else LANES_FS[name, precision]
        assert LEAST_FS[precision] <= each.furthest_FS <= most_FS, each
        assert each.from_golden_FS <= most_FS, each
        assert each.from_double_FS <= 1e-4, each
        assert each.other_statuses == 0, each
        if each.chunks:
            assert each.chunks >= LEAST_CHUNKS[name], each
            assert 2 * each.repeated_chunks <= each.chunks, each


def test_threads_and_neighbours_change_no_bit(golden, samples):
    filtered = GoldenFilter(golden["definition"], samples, "default_3_orders", np.float32)
    alone = filtered.in_lanes(best_vector_level(), 1, 1)
    for threads in (1, 2):
        beside = filtered.in_lanes(best_vector_level(), threads, 19)
        np.testing.assert_array_equal(beside.records(), alone.records())


def test_the_command_prints_a_row_for_each_chain_precision_and_kind(monkeypatch, capsys):
    monkeypatch.setattr("benchmarks.golden.__main__.CHUNK_MEMORIES", {"published_4": 16.0})
    monkeypatch.setattr(sys, "argv", ["golden", "--paths"])
    assert main() == 0
    head, _, *rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 2 * len(vectors.PRECISIONS)
    for row in rows:
        assert row.count("|") == head.count("|")
        cells = [cell.strip() for cell in row.split("|")]
        assert cells[1] == "published_4"
        assert 0 < float(cells[5]) <= float(cells[4]) < 1e-4
        assert cells[6] == "0"
        assert bool(cells[7]) == (cells[3] == "time chunks")
