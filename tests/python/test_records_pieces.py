"""Rows put together into pieces, and a long recording filtered in them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.speed.filter_command import write_log
from benchmarks.speed.inputs import make
from helpers.log_files import command, read_result
from strainwave.records.pieces import LEAST_ROWS, in_pieces
from strainwave.records.signals import Rows
from strainwave.samples import Samples

BASE = ("--map", "time=t_s,angle=q_rad,torque=tau_Nm", "--angle-side", "motor")
Call = Any


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


def _rows(start: int, count: int) -> Rows:
    numbers = np.arange(start, start + count, dtype=np.float64)
    samples = Samples(numbers + 0.1, numbers + 0.2, numbers + 0.3, numbers + 0.4)
    return Rows(numbers, samples, numbers.astype(np.uint32))


@pytest.mark.parametrize("lengths", [[7], [3, 3, 3, 3], [10, 1, 9, 0, 4], []])
def test_pieces_are_the_same_rows(lengths: list[int]) -> None:
    starts = np.cumsum([0, *lengths])
    parts = [_rows(int(start), count) for start, count in zip(starts, lengths, strict=False)]
    pieces = list(in_pieces(parts, 6))
    assert all(len(piece) >= 6 for piece in pieces[:-1])
    rows = sum(lengths)
    whole = _rows(0, rows)
    for name in ("log_time_s", "gauge_status"):
        found = np.concatenate([np.empty(0), *(getattr(piece, name) for piece in pieces)])
        np.testing.assert_array_equal(found, getattr(whole, name))
    for name in ("time_s", "motor_angle_rad", "torque_Nm", "expected_torque_Nm"):
        found = np.concatenate([np.empty(0), *(getattr(each.samples, name) for each in pieces)])
        np.testing.assert_array_equal(found, getattr(whole.samples, name))


@pytest.mark.parametrize("method", [("ripple",), ("taghirad1999", "--ratio", 100)])
def test_a_long_recording_is_filtered_in_chunks_and_says_so(
    tmp_path: Path, call: Call, method: tuple[Any, ...]
) -> None:
    log = tmp_path / "log.parquet"
    write_log(log, LEAST_ROWS, make(200_000, 1999))
    base = ("filter", log, *BASE, "--rated-torque", 30, "--method", *method, "--out")
    chunked = json.loads(call(*base, tmp_path / "chunks.parquet", "--json").out)
    sequence = json.loads(call(*base, tmp_path / "sequence.parquet", "--json", "--in-sequence").out)
    assert sequence["time_chunks"] is None
    chunks = chunked["time_chunks"]
    assert chunks["count"] > 4
    assert chunks["repeated"] < chunks["count"] / 2
    assert 0.0 < chunks["rms_difference_Nm"] <= chunks["largest_difference_Nm"] <= 1e-4
    found, exact = (read_result(tmp_path / f"{name}.parquet") for name in ("chunks", "sequence"))
    difference_Nm = found["torque_Nm"] - exact["torque_Nm"]
    assert 0.0 < math.sqrt(np.mean(difference_Nm**2)) < 1e-4
    for name in ("time_s", "torque_measured_Nm", "status"):
        np.testing.assert_array_equal(found[name], exact[name])
    assert chunked["rows_by_flag"] == sequence["rows_by_flag"]
    assert chunked["ripple_rms_Nm"] == pytest.approx(sequence["ripple_rms_Nm"], rel=1e-5)
    said = call(*base, tmp_path / "chunks.parquet").out
    assert f"in {chunks['count']} time chunks" in said
    assert "from --in-sequence" in said


def test_a_shorter_recording_is_filtered_in_sequence(tmp_path: Path, call: Call) -> None:
    log = tmp_path / "log.parquet"
    write_log(log, LEAST_ROWS - 1, make(200_000, 1999))
    base = ("filter", log, *BASE, "--rated-torque", 30, "--out")
    assert json.loads(call(*base, tmp_path / "a.parquet", "--json").out)["time_chunks"] is None
    call(*base, tmp_path / "b.parquet", "--in-sequence")
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
