"""A result is written whole or not at all, and in little memory."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from helpers.log_files import (
    MAP,
    METHOD,
    Halving,
    healthy,
    write_csv,
)
from strainwave.errors import InputError
from strainwave.methods.interface import Cleaned, Method
from strainwave.records import Options, filter_log, parse_mapping

COMMAND = Path(sys.executable).parent / "strainwave"
BASE = ("--map", MAP, "--angle-side", "motor", "--method", METHOD, "--rated-torque", 30)


class _Interrupted(Halving):
    def finish(self) -> Cleaned:
        raise KeyboardInterrupt


class _FullDisk(Halving):
    def finish(self) -> Cleaned:
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize(
    ("method", "raised"), [(_Interrupted(), KeyboardInterrupt), (_FullDisk(), InputError)]
)
@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_what_fails_half_way_leaves_what_was_there(
    tmp_path: Path, method: Method, raised: type[BaseException], ending: str
) -> None:
    log = write_csv(tmp_path / "log.csv", healthy())
    out = tmp_path / f"o.{ending}"
    out.write_text("what was there before")
    options = Options(parse_mapping([MAP]), "motor")
    with pytest.raises(raised):
        filter_log(log, out, options, method="any", build=lambda *_: method)
    assert out.read_text() == "what was there before"
    assert sorted(tmp_path.iterdir()) == [log, out]


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_full_disk_is_said_and_leaves_nothing(tmp_path: Path, ending: str) -> None:
    log = _long_log(tmp_path / "log.parquet", 300_000)
    # A limit on the size of a file fails as a full disk does: when something is written.
    program = (
        "import os, resource, sys\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, 1_000_000))\n"
        "os.execv(sys.argv[1], sys.argv[1:])\n"
    )
    arguments = [COMMAND, "filter", log, *map(str, BASE), "--out", tmp_path / f"o.{ending}"]
    ended = subprocess.run(
        [sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2
    assert "it cannot be written (file too large)" in " ".join(ended.stderr.split())
    assert "Traceback" not in ended.stderr
    assert sorted(tmp_path.iterdir()) == [log]


def test_killed_half_way_nothing_stands_under_the_final_name(tmp_path: Path) -> None:
    log = _long_log(tmp_path / "log.parquet", 3_000_000)
    out = tmp_path / "o.csv"
    process = subprocess.Popen([COMMAND, "filter", log, *map(str, BASE), "--out", out])
    deadline = time.monotonic() + 60.0
    # Only when a good part of the result lies in the temporary file.
    while sum(path.stat().st_size for path in tmp_path.glob(".o.csv*")) < 1_000_000:
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    left = [path for path in tmp_path.iterdir() if path != log]
    assert not out.exists()
    assert all(path.name.startswith(".o.csv.") and path.name.endswith(".tmp") for path in left)


def _long_log(path: Path, rows: int) -> Path:
    """Write a recording of one large row group, piece by piece."""
    schema = pa.schema([(name, pa.float64()) for name in ("t_s", "q_rad", "tau_Nm")])
    piece = 1_000_000
    tables = []
    for start in range(0, rows, piece):
        row = np.arange(start, min(rows, start + piece), dtype=float)
        q_rad = 0.02 * row
        noise = 0.1 * np.sin(1e6 * np.sin(row))
        tables.append(
            pa.table([1e-3 * row, q_rad, 20.0 * np.cos(2.0 * q_rad) + noise], schema=schema)
        )
    pq.write_table(pa.concat_tables(tables), path, row_group_size=rows)
    return path


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_ten_million_rows_fit_into_a_gigabyte(tmp_path: Path, ending: str) -> None:
    log = _long_log(tmp_path / "log.parquet", 10_000_000)
    program = (
        "import resource, subprocess, sys\n"
        "subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)\n"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)\n"
    )
    out = tmp_path / f"o.{ending}"
    # Measured from a small process: a child's peak includes what its parent held when it forked.
    ended = subprocess.run(
        [sys.executable, "-c", program, COMMAND, "filter", log, *map(str, BASE), "--out", out],
        capture_output=True,
        text=True,
        check=True,
    )
    peak_bytes = int(ended.stdout) * 1024
    assert 50e6 < peak_bytes < 1e9
    rows = pq.read_metadata(out).num_rows if ending == "parquet" else _lines(out) - 1
    assert rows == 10_000_000


def _lines(path: Path) -> int:
    with path.open("rb") as stream:
        return sum(block.count(b"\n") for block in iter(lambda: stream.read(1 << 20), b""))
