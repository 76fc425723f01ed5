"""Recordings and options that cannot be used: each has its sentence, code 2, and leaves no file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.log_files import MAP, METHOD, command, healthy, write_csv, write_parquet

BASE = ("--angle-side", "motor", "--method", METHOD, "--rated-torque", 30)


def _changed(key: str, change: Callable[[Any], Any]) -> Callable[[Path], Path]:
    def write(path: Path) -> Path:
        columns = healthy()
        columns[key] = change(columns[key])
        return write_csv(path, columns)

    return write


def _with_text(text: str, row: int) -> Callable[[Path], Path]:
    def change(values: Any) -> list[Any]:
        listed = list(values)
        listed[row - 1] = text
        return listed

    return _changed("tau_Nm", change)


def _text(content: str | bytes) -> Callable[[Path], Path]:
    def write(path: Path) -> Path:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


def _folder(path: Path) -> Path:
    path.mkdir()
    return path


BAD_LOGS = {
    "missing": (lambda path: path, "log.csv: there is no such file"),
    "folder": (_folder, "log.csv: it is a folder"),
    "empty": (_text(""), "log.csv: it is empty"),
    "blank": (_text("\n\n\n"), "log.csv: it is empty"),
    "header only": (_text("t_s,q_rad,tau_Nm\n"), "it holds a header and no data"),
    "one row": (_text("t_s,q_rad,tau_Nm\n0,0,1\n"), "it holds one row"),
    "utf-16": (_text("t_s,q_rad,tau_Nm\n0,0,1\n".encode("utf-16")), "it is text in UTF-16"),
    "binary": (_text(b"\x7fELF\0\0\0\0"), "it is no text"),
    "short line": (
        _text("t_s,q_rad,tau_Nm\n0,0,1\n\n1,1,1\n2,1\n"),
        "row 3 (line 5) has 2 fields, but the first line has 3",
    ),
    "missing column": (
        _text("t_s,q_rad,tau_NM\n0,0,1\n1,1,1\n"),
        "there is no column 'tau_Nm' for torque; expected the name of one of its 3 columns; did "
        "you mean 'tau_NM'?",
    ),
    "column twice": (
        _text("t_s,q_rad,tau_Nm,q_rad\n0,0,1,1\n1,1,1,1\n"),
        "the column 'q_rad' for angle is there 2 times (columns 2, 4)",
    ),
    "text": (
        _with_text("n.a.!", 517),
        "log.csv: row 517 (line 518), column 'tau_Nm' holds 'n.a.!'; expected a number",
    ),
    "decimal comma": (
        _text("t_s;q_rad;tau_Nm\n0;0;1\n1;1;1,5\n"),
        "row 2 (line 3), column 'tau_Nm' holds '1,5'; expected a number, so write a decimal point",
    ),
    "all nan": (
        _changed("tau_Nm", lambda values: [None] * len(values)),
        "column 'tau_Nm' for torque holds no number in any of its 1000 rows",
    ),
    "backwards": (
        _changed("t_s", lambda values: values[::-1]),
        "column 't_s' for time goes backwards at 999 of 1000 rows (first: row 2)",
    ),
    "constant time": (
        _changed("t_s", lambda values: 0.0 * values),
        "column 't_s' for time is constant from row 1 to row 1000",
    ),
    "slow degrees": (
        _changed("q_rad", lambda values: np.rad2deg(values) % 360.0),
        "goes back to its start after 360 rad; expected a turn of 6.283 rad; are the angles in "
        "degrees (then map angle=q_rad:deg)?",
    ),
    "degrees": (
        _changed("q_rad", lambda values: 30.0 * np.rad2deg(values)),
        "expected at most 1500 rad/s, as no strain wave gear turns faster: are the angles in "
        "degrees (then map angle=q_rad:deg)?",
    ),
}


@pytest.mark.parametrize("case", BAD_LOGS)
def test_a_bad_log_has_its_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], case: str
) -> None:
    make, words = BAD_LOGS[case]
    log = make(tmp_path / "log.csv")
    before = sorted(tmp_path.iterdir())
    ended = command(capsys)("filter", log, "--map", MAP, *BASE, "--out", tmp_path / "o.csv")
    assert ended.code == 2
    assert words in ended.err
    assert ended.err.count("strainwave: ") == 1
    assert "Traceback" not in ended.err
    assert ended.out == ""
    assert sorted(tmp_path.iterdir()) == before


def _columns(**changes: Any) -> dict[str, Any]:
    return {**healthy(), **changes}


BAD_PARQUET = {
    "text": (
        _columns(tau_Nm=["1.0"] * 1000),
        "column 'tau_Nm' for torque holds text, from row 1 on",
    ),
    "no rows": ({"t_s": [], "q_rad": [], "tau_Nm": []}, "it holds no rows"),
    "one row": ({"t_s": [0.0], "q_rad": [0.0], "tau_Nm": [1.0]}, "it holds one row"),
    "list": (_columns(q_rad=[[1.0]] * 1000), "column 'q_rad' for angle holds list"),
}


@pytest.mark.parametrize("case", BAD_PARQUET)
def test_bad_parquet_has_its_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], case: str
) -> None:
    columns, words = BAD_PARQUET[case]
    log = write_parquet(tmp_path / "log.parquet", columns)
    ended = command(capsys)("filter", log, "--map", MAP, *BASE, "--out", tmp_path / "o.csv")
    assert ended.code == 2
    assert words in ended.err
    assert sorted(tmp_path.iterdir()) == [log]


@pytest.mark.parametrize("content", [b"", b"no Parquet at all, whatever the name says"])
def test_damaged_parquet(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: bytes
) -> None:
    log = _text(content)(tmp_path / "log.parquet")
    ended = command(capsys)("filter", log, "--map", MAP, *BASE, "--out", tmp_path / "o.csv")
    assert ended.code == 2
    assert "it cannot be read as Parquet" in ended.err


SIDE = ("--angle-side", "motor")
GOOD_MAP = ("--map", MAP)
BAD_OPTIONS = {
    "no angle": (
        ("--map", "time=t_s,torque=tau_Nm", *SIDE),
        "nothing is mapped for the angle",
    ),
    "no torque": (("--map", "time=t_s,angle=q_rad", *SIDE), "nothing is mapped for the torque"),
    "no time": (("--map", "angle=q_rad,torque=tau_Nm", *SIDE), "nothing is mapped for time"),
    "no side": (GOOD_MAP, "--angle-side: it is missing; expected motor or output"),
    "no ratio": (
        (*GOOD_MAP, "--angle-side", "output"),
        "--ratio: it is missing; an angle of the output needs",
    ),
    "ratio 0": ((*GOOD_MAP, *SIDE, "--ratio", "0"), "--ratio 0: expected motor turns"),
    "ratio text": ((*GOOD_MAP, *SIDE, "--ratio", "100:1"), "--ratio 100:1: expected motor turns"),
    "ratio by zero": ((*GOOD_MAP, *SIDE, "--ratio", "1/0"), "--ratio 1/0: expected motor turns"),
    "ratio not finite": ((*GOOD_MAP, *SIDE, "--ratio", "inf"), "--ratio inf: expected motor"),
    "rate": ((*GOOD_MAP, *SIDE, "--rate", "0"), "--rate 0: expected rows a second"),
    "rate nan": ((*GOOD_MAP, *SIDE, "--rate", "nan"), "--rate nan: expected rows a second"),
    "rated torque": (
        (*GOOD_MAP, *SIDE, "--rated-torque=-3"),
        "--rated-torque -3: expected a rated torque in Nm",
    ),
    "rated text": ((*GOOD_MAP, *SIDE, "--rated-torque", "much"), "--rated-torque"),
    "method": (
        (*GOOD_MAP, *SIDE, "--method", "taghirad1998"),
        "--method taghirad1998: it is unknown; expected one of",
    ),
    "near method": (
        (*GOOD_MAP, *SIDE, "--method", "taghirad1998"),
        "did you mean taghirad1999 or taghirad1999-4?",
    ),
    "unknown key": (
        ("--map", "tim=t_s,angle=q_rad,torque=tau_Nm", *SIDE),
        "'tim' is no signal; expected one of time, angle, motor-angle, speed, torque, "
        "expected-torque, temperature, gauges; did you mean time?",
    ),
    "twice": ((*GOOD_MAP, "--map", "time=t_s", *SIDE), "time is mapped twice"),
    "no pair": (("--map", "t_s", *SIDE), "'t_s' is no pair; expected key=column pairs"),
    "no column": (("--map", "time=,angle=q_rad", *SIDE), "no column follows time="),
    "plus": (("--map", "torque=a+b", *SIDE), "the column of torque contains '+'; a name with"),
    "open quote": (("--map", 'torque="a', *SIDE), "the quoted column of torque does not end"),
    "after quote": (("--map", 'torque="a"b', *SIDE), "'b' follows the quoted column of torque"),
    "unit": (
        ("--map", "angle=q_rad:gon", *SIDE),
        "the unit 'gon' of angle is unknown; expected one of rad, deg, turn, counts/N",
    ),
    "number": (("--map", "time=t_s,angle=q_rad,torque=9", *SIDE), "no column '9' for torque"),
    "joint": ((*GOOD_MAP, *SIDE, "--joint", "gone.toml"), "gone.toml: there is no such file"),
    "side": ((*GOOD_MAP, "--angle-side", "left"), "left"),
}


@pytest.mark.parametrize("case", BAD_OPTIONS)
def test_bad_options_have_their_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], case: str
) -> None:
    options, words = BAD_OPTIONS[case]
    log = write_csv(tmp_path / "log.csv", healthy())
    with_method = () if "--method" in options else ("--method", METHOD)
    ended = command(capsys)("filter", log, *options, *with_method, "--out", tmp_path / "o.csv")
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err
    assert sorted(tmp_path.iterdir()) == [log]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("no/such/folder/o.csv", "it cannot be written (no such file or directory)"),
        ("log.csv/o.csv", "it cannot be written (not a directory)"),
        ("o.txt", "the name ends in '.txt'; expected .csv or .parquet"),
        ("log.csv", "it is the file that is read"),
        ("link.csv", "it is the file that is read"),
        ("folder.csv", "it is a folder"),
        ("/proc/o.csv", "it cannot be written"),
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, words: str
) -> None:
    # The recording itself is bad too: what is said is that the place is.
    log = write_csv(tmp_path / "log.csv", {"t_s": [0.0], "q_rad": [0.0], "tau_Nm": ["text"]})
    (tmp_path / "link.csv").symlink_to(log)
    (tmp_path / "folder.csv").mkdir()
    content = log.read_bytes()
    ended = command(capsys)("filter", log, *GOOD_MAP, *BASE, "--out", tmp_path / name)
    assert ended.code == 2
    assert words in ended.err
    assert log.read_bytes() == content
    assert len(list(tmp_path.iterdir())) == 3


def test_an_unknown_ending_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = _text("x")(tmp_path / "log.xlsx")
    ended = command(capsys)("filter", log, *GOOD_MAP, *BASE, "--out", tmp_path / "o.csv")
    assert ended.code == 2
    assert "the name ends in '.xlsx'; expected .csv, .tsv, .txt, .parquet, .pq" in ended.err


def test_far_columns_are_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = write_csv(tmp_path / "log.csv", healthy())
    ended = command(capsys)(
        "filter", log, "--map", MAP.replace("tau_Nm", "xyz"), *BASE, "--out", tmp_path / "o.csv"
    )
    assert "its columns are 't_s', 'q_rad', 'tau_Nm'" in ended.err
