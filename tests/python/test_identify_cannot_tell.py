"""Every sentence of `strainwave identify` on what a recording does not tell, each by its own log.

A sentence says what is missing, what is used in its place, and what to do.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.log_files import command, write_parquet

RATIO = 100.0
ROWS = 12_000
MOTOR = ("--angle-side", "motor")
OUTPUT = ("--angle-side", "output")
KNOWN = ("--ratio", "100", "--rated-torque", "40")
Columns = dict[str, Any]


def _log(
    rows: int = ROWS,
    *,
    factor: float = 1.0,
    ripple_Nm: float = 1.6,
    noise_Nm: float = 0.04,
    at_rest_s: float = 1.5,
    speeds: tuple[float, ...] = (150.0, 60.0, 200.0),
) -> Columns:
    """Rest, then the motor at some speeds for the same time each; 1 kHz."""
    time_s = np.arange(rows) * 1e-3
    moving_s = max(rows * 1e-3 - at_rest_s, 1e-9)
    place = np.clip((time_s - at_rest_s) / moving_s, 0.0, 0.999) * len(speeds)
    speed = np.where(time_s < at_rest_s, 0.0, np.array(speeds)[place.astype(int)])
    angle = 0.3 + np.cumsum(speed) * 1e-3
    wave = factor * angle
    noise = noise_Nm * np.random.default_rng(3).standard_normal(rows)
    torque = 8.0 * np.sin(0.4 * time_s) + ripple_Nm * (
        np.cos(2 * wave + 0.4) + 0.4 * np.cos(4 * wave)
    )
    return {"t": time_s, "q": angle, "tau": torque + noise, "q_out": angle / RATIO}


def _changed(columns: Columns, **values: Any) -> Columns:
    return {**columns, **values}


def _wrapped(columns: Columns) -> Columns:
    return _changed(columns, q=np.mod(columns["q"], 2 * np.pi))


def _held(columns: Columns) -> Columns:
    names = ("q", "tau", "q_out")
    return _changed(columns, **{name: np.repeat(columns[name][::4], 4) for name in names})


def _jittering(columns: Columns) -> Columns:
    away_s = 4e-4 * np.random.default_rng(4).uniform(-1.0, 1.0, len(columns["t"]))
    return _changed(columns, t=columns["t"] + away_s)


def _with_gap(columns: Columns) -> Columns:
    time_s = columns["t"].copy()
    time_s[6000:] += 1.0
    return _changed(columns, t=time_s)


def _out_of_order(columns: Columns) -> Columns:
    time_s = columns["t"].copy()
    time_s[5000] = time_s[4000]
    return _changed(columns, t=time_s)


def _with_holes(columns: Columns) -> Columns:
    torque_Nm = columns["tau"].copy()
    torque_Nm[7000:7010] = np.nan
    return _changed(columns, tau=torque_Nm)


def _jumping(columns: Columns) -> Columns:
    angle = columns["q"].copy()
    angle[8000:] += 400.0
    return _changed(columns, q=angle)


def _wandering_phase() -> Columns:
    """Ripple whose phase goes with the time of day and not with the speed."""
    columns = _log(20_000, speeds=(150.0, 60.0, 200.0, 90.0, 170.0))
    phase = np.cumsum(np.random.default_rng(5).standard_normal(20_000)) * 0.05
    torque_Nm = columns["tau"] + 3.0 * np.cos(2 * columns["q"] + phase)
    return _changed(columns, tau=torque_Nm)


PLAIN = "time=t,angle=q,torque=tau"
OUT = "time=t,angle=q_out,torque=tau"
BOTH = "time=t,angle=q_out,motor-angle=q,torque=tau"

Case = tuple[Callable[[], Columns], str, tuple[str, ...], tuple[str, ...]]
CASES: dict[str, Case] = {
    "one speed": (
        lambda: _log(speeds=(150.0,)),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("speed hardly changes", "delay", "left at 0", "two speeds or more"),
    ),
    "delay not trusted": (
        _wandering_phase,
        PLAIN,
        (*MOTOR, *KNOWN),
        ("delay between angle and torque", "left at 0", "at several speeds"),
    ),
    "fewer than three turns": (
        lambda: _log(2400, at_rest_s=2.3),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("fewer than 3", "orders, delay and memory", "left at their defaults", "longer motion"),
    ),
    "no order": (
        lambda: _log(ripple_Nm=0.0),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("no order stands out", "left at their defaults", "check torque column"),
    ),
    "few turns": (
        lambda: _log(3050, at_rest_s=2.5, speeds=(200.0,)),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("too few to choose a memory", "left at 10 turns", "record a longer motion"),
    ),
    "never at rest": (
        lambda: _log(at_rest_s=0.0),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("never at rest", "innovations, an upper bound", "at rest as well"),
    ),
    "never at rest, no order": (
        lambda: _log(at_rest_s=0.0, ripple_Nm=0.0),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("never at rest", "0.1% of the rated torque", "at rest as well"),
    ),
    "ratio by the motor alone": (
        _log,
        PLAIN,
        (*MOTOR, "--rated-torque", "40"),
        ("motor's angle alone does not show the ratio", "m is taken as 1", "give --ratio N"),
    ),
    "ratio by the motor and a wave that turns": (
        lambda: _log(40_000, factor=1.01),
        PLAIN,
        (*MOTOR, "--rated-torque", "40"),
        ("the ripple turns 1.01", "fixed circular spline", "m = (R + 1)/R"),
    ),
    "factor m": (
        lambda: _log(2500),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("motor or with the wave does not show", "m is taken as 1", "a third of an output turn"),
    ),
    "the product alone, ratio given": (
        _log,
        OUT,
        (*OUTPUT, *KNOWN),
        ("only the product of ratio and factor m", "agrees with the ratio of 100"),
    ),
    "the product alone, ratio wrong": (
        _log,
        OUT,
        (*OUTPUT, "--ratio", "100.3", "--rated-torque", "40"),
        ("only the product of ratio and factor m", "replaces the ratio of 100.3"),
    ),
    "the product alone, no ratio": (
        _log,
        OUT,
        (*OUTPUT, "--rated-torque", "40"),
        ("only the product of ratio and factor m", "1 less", "give --ratio N"),
    ),
    "no line": (
        lambda: _log(ripple_Nm=0.0),
        OUT,
        (*OUTPUT, *KNOWN),
        ("no clear line near the ratio", "100 is kept", "check the ratio"),
    ),
    "two angles, ratio wrong": (
        _log,
        BOTH,
        (*OUTPUT, "--ratio", "100.3", "--rated-torque", "40"),
        ("by the two angles' slope", "replaces the ratio of 100.3"),
    ),
    "two angles of two joints": (
        lambda: _changed(_log(), q_out=np.random.default_rng(6).standard_normal(ROWS) * 1e-3),
        BOTH,
        (*OUTPUT, *KNOWN),
        ("does not follow the motor's", "100 that was given is kept", "check the mapping"),
    ),
    "no rated torque": (
        _log,
        PLAIN,
        (*MOTOR, "--ratio", "100"),
        ("has no [gear]", "no load terms", "give --rated-torque", "taken as an estimate"),
    ),
    "long": (
        lambda: _log(100_500),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("first 100000 of 100500 rows", "cut the recording"),
    ),
    "wrapped": (
        lambda: _wrapped(_log()),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("goes back to its start after every turn", "unwrapped"),
    ),
    "held": (
        lambda: _held(_log()),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("only repeat the angle and the torque", "75.0%"),
    ),
    "jitter": (
        lambda: _jittering(_log()),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("the time stamps jitter", "used as they are"),
    ),
    "gap": (lambda: _with_gap(_log()), PLAIN, (*MOTOR, *KNOWN), ("1 gap in time", "row 6001")),
    "out of order": (
        lambda: _out_of_order(_log()),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("time goes back or stands still", "row 5001", "rejected"),
    ),
    "holes": (
        lambda: _with_holes(_log()),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("10 rows of 12000 have no torque", "rejected"),
    ),
    "jump": (
        lambda: _jumping(_log()),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("which none does", "the angle jumps"),
    ),
    "at rest": (
        lambda: _changed(_log(), q=np.zeros(ROWS)),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("the motor is never faster than", "check the units"),
    ),
    "no torque": (
        lambda: _changed(_log(), tau=np.zeros(ROWS)),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("the torque is 0 throughout", "right column"),
    ),
    "small torque": (
        lambda: _changed(_log(), tau=1e-3 * _log()["tau"]),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("in volts?",),
    ),
    "large torque": (
        lambda: _changed(_log(), tau=1e3 * _log()["tau"]),
        PLAIN,
        (*MOTOR, *KNOWN),
        ("in mNm or in counts?",),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_it_is_said(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    make, mapping, options, words = CASES[name]
    log = write_parquet(tmp_path / "log.parquet", make())
    ended = command(capsys)(
        *("identify", log, "--map", mapping, *options, "--out", tmp_path / "j.toml", "--json")
    )
    assert ended.code == 0
    for each in words:
        assert each in ended.err
    for warning in ended.result["warnings"]:
        assert "nan" not in warning
        assert not warning.endswith(".")


@pytest.mark.parametrize(
    ("columns", "mapping", "words"),
    [
        (_log(ripple_Nm=0.0), OUT, ("no line of the ripple", "25 to 330", "--ratio N")),
        (
            _changed(_log(), q_out=np.random.default_rng(6).standard_normal(ROWS) * 1e-3),
            BOTH,
            ("does not follow the motor's", "check the mapping"),
        ),
    ],
)
def test_without_a_ratio_nothing_is_written(
    columns: Columns,
    mapping: str,
    words: tuple[str, ...],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    log = write_parquet(tmp_path / "log.parquet", columns)
    ended = command(capsys)(
        *("identify", log, "--map", mapping, *OUTPUT, "--out", tmp_path / "j.toml")
    )
    assert ended.code == 2
    for each in words:
        assert each in ended.err
    assert not (tmp_path / "j.toml").exists()


def test_a_good_log_is_told_nothing_of_what_it_lacks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = write_parquet(tmp_path / "log.parquet", _log(30_000))
    ended = command(capsys)(
        *("identify", log, "--map", BOTH, *OUTPUT, *KNOWN),
        *("--out", tmp_path / "j.toml", "--json"),
    )
    assert ended.code == 0
    assert "product" not in ended.err
    # Which angle is used is said always; torque or artefact is another question.
    others = ("not the output's beside it", "torque or artefact")
    said = [text for text in ended.result["warnings"] if not any(each in text for each in others)]
    assert said == []
