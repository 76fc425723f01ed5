"""Recordings for tests: a joint that moves to and fro with ripple of orders 2 and 4, and its files."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq
import pytest

from strainwave.cli.application import main
from strainwave.methods.interface import Cleaned
from strainwave.records import Layout, MappedColumn, Survey
from strainwave.records.columns import FoundColumn
from strainwave.records.conversion import Converter
from strainwave.records.raw import RawChunk, Stamps
from strainwave.records.signals import SampleBuilder
from strainwave.records.survey import Surveyor
from strainwave.samples import Samples

RATIO = 100
MAP = "time=t_s,angle=q_rad,torque=tau_Nm"
METHOD = "taghirad1999-4"

Columns = dict[str, Any]


def healthy(rows: int = 1000, rate_Hz: float = 1000.0) -> Columns:
    """Columns of a recording that nothing is wrong with; the motor turns at about 10 rad/s."""
    t_s = np.arange(rows) / rate_Hz
    q_rad = 10.0 * t_s + 0.2 * np.sin(3.0 * t_s)
    ripple_Nm = 3.0 * np.cos(2.0 * q_rad) + np.cos(4.0 * q_rad + 0.3)
    return {"t_s": t_s, "q_rad": q_rad, "tau_Nm": 20.0 * np.sin(2.0 * t_s) + ripple_Nm}


def write_csv(path: Path, columns: Mapping[str, Sequence[Any]], delimiter: str = ",") -> Path:
    """Write columns with all their digits; None is an empty field."""
    rows = zip(*columns.values(), strict=True)
    lines = [delimiter.join(columns), *(delimiter.join(map(_text, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _text(cell: Any) -> str:
    if cell is None:
        return ""
    return repr(float(cell)) if isinstance(cell, float | np.floating) else str(cell)


def write_parquet(path: Path, columns: Mapping[str, Any]) -> Path:
    """Write columns as they are."""
    pq.write_table(pa.table(dict(columns)), path)
    return path


def read_result(path: Path) -> dict[str, np.ndarray]:
    """Read what the command wrote."""
    table = pyarrow.csv.read_csv(path) if path.suffix == ".csv" else pq.read_table(path)
    return {name: table.column(name).to_numpy() for name in table.column_names}


class Outcome:
    """How a call of the command line ended."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code = code
        self.out = out
        self.err = " ".join(err.split())

    @property
    def result(self) -> dict[str, Any]:
        """The one JSON object on the standard output."""
        found: dict[str, Any] = json.loads(self.out)
        return found


def command(capsys: pytest.CaptureFixture[str]) -> Callable[..., Outcome]:
    """Give what calls the command line within this process."""

    def call(*arguments: object) -> Outcome:
        code = 0
        capsys.readouterr()
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as ended:
            code = int(ended.code or 0)
        shown = capsys.readouterr()
        return Outcome(code, shown.out, shown.err)

    return call


UNITS = {"time": "s", "angle": "rad", "speed": "rad/s", "torque": "Nm", "expected-torque": "Nm"}


def layout_of(
    keys: Any, units: dict[str, str] | None = None, side: Any = "motor", **more: Any
) -> Layout:
    units = {**UNITS, **(units or {})}
    return Layout({key: MappedColumn(key, units[key]) for key in keys}, side, **more)


def run(
    columns: dict[str, np.ndarray], layout: Layout, cuts: list[int] | None = None
) -> tuple[np.ndarray, Survey]:
    """Take columns through conversion, survey and samples; rows of the result are rows of a log."""
    rows = len(columns["torque"])
    edges = [0, *sorted(cuts or []), rows]
    found = {key: FoundColumn(0, key, 1) for key in columns}

    def chunks() -> Any:
        for start, end in itertools.pairwise(edges):
            part = {key: values[start:end] for key, values in columns.items()}
            time = part.pop("time", None)
            stamps = None
            if time is not None:
                missing = ~np.isfinite(time.astype(float))
                stamps = Stamps(time, missing)
            values = {key: value.astype(float) for key, value in part.items()}
            yield RawChunk(end - start, values, stamps)

    surveyor, converter = Surveyor(layout), Converter(layout, found)
    for chunk in chunks():
        surveyor.take(converter.convert(chunk))
    survey = surveyor.finish()
    builder, converter = SampleBuilder(layout, survey), Converter(layout, found)
    parts = [builder.take(converter.convert(chunk)) for chunk in chunks()]
    parts.append(builder.finish())
    table = [
        (
            part.log_time_s,
            part.samples.time_s,
            part.samples.motor_angle_rad,
            part.samples.torque_Nm,
            part.samples.expected_torque_Nm,
        )
        for part in parts
    ]
    return np.concatenate([np.stack(part, axis=1) for part in table]), survey


class Halving:
    """A method for tests: ripple is half the torque; optionally it hands everything out at the end."""

    def __init__(self, holds_back: bool = False) -> None:
        self.holds_back = holds_back
        self.seen: list[Samples] = []

    def process(self, samples: Samples, /) -> Cleaned:
        self.seen.append(samples)
        return halved(samples.torque_Nm[: 0 if self.holds_back else len(samples)])

    def finish(self) -> Cleaned:
        torques = [samples.torque_Nm for samples in self.seen] if self.holds_back else []
        return halved(np.concatenate([*torques, np.empty(0)]))


def halved(torque_Nm: np.ndarray) -> Cleaned:
    """Take half of the torque for ripple."""
    return Cleaned(0.5 * torque_Nm, 0.5 * torque_Nm, np.zeros(len(torque_Nm), np.uint32))


def recording_path(*parts: str) -> Path:
    """Path of a real recording; the test is skipped where the folder is absent."""
    beside = Path(__file__).parents[4] / "shared" / "recordings"
    folder = Path(os.environ.get("STRAINWAVE_RECORDINGS", beside))
    path = folder.joinpath(*parts)
    if not path.is_file():
        pytest.skip(f"the real recordings are not here: {path} is missing")
    return path
