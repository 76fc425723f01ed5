"""`strainwave calibrate tune`: G's screwdriver, guided, on the simulated gear of three gauges."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.gauge_logs import columns_of, station_of, turns_of
from helpers.log_files import command, write_parquet
from strainwave.calibrate.tuning import advise, gauge_phasors, trial_turn
from strainwave.errors import InputError

Call = Any


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str]) -> Call:
    return command(capsys)


class Bench:
    """A gear with potentiometers: only their sum is recorded."""

    def __init__(self, folder: Path, gauges: int) -> None:
        self.folder = folder
        self.station = station_of(gauges)
        self.gains = np.ones(gauges)
        self.runs: list[Path] = []
        self.settings: list[str] = []

    def record(self, misread: float = 0.0) -> None:
        number = len(self.runs)
        run = turns_of(self.station, 1.0, 200 + number)
        columns = columns_of(run, tuple(self.gains))
        self.runs.append(write_parquet(self.folder / f"run{number}.parquet", columns))
        shown = self.gains * (1 + misread * np.cos(number + np.arange(len(self.gains))))
        self.settings.append(",".join(f"{gain:.6f}" for gain in shown))

    def turn(self, turns: list[dict[str, float]]) -> None:
        for each in turns:
            self.gains[int(each["gauge"]) - 1] += each["change"]

    def words(self, *more: object) -> list[object]:
        given: list[object] = ["calibrate", "tune", *self.runs, "--map", "angle=beta_rad,sum=sum_V"]
        for text in self.settings:
            given += ["--gauge-gains", text]
        return [*given, *more, "--json"]


def tune(call: Call, bench: Bench, *more: object, misread: float = 0.0, most: int = 9) -> Any:
    """Record and turn as told until the line is gone."""
    for _ in range(most):
        bench.record(misread)
        ended = call(*bench.words(*more))
        assert ended.code == 0, ended.err
        if ended.result["is_done"]:
            return ended.result
        bench.turn(ended.result["turns"])
    raise AssertionError("the line is still there")


@pytest.mark.parametrize(("gauges", "harmonics", "runs"), [(3, 1, 4), (5, 2, 6)])
def test_the_sum_alone_is_enough(
    tmp_path: Path, call: Call, gauges: int, harmonics: int, runs: int
) -> None:
    bench = Bench(tmp_path, gauges)
    result = tune(call, bench, "--harmonics", harmonics)
    # One run a gauge tells its phasor, the next one shows that the line is gone.
    assert len(bench.runs) <= runs
    largest = np.max(result["amplitudes"])
    assert max(result["residual"][-1]) <= 1e-3 * largest
    assert max(result["residual"][0]) > 20 * max(result["residual"][-1])
    if gauges == 3:
        shape = 3 * bench.gains / bench.gains.sum()
        assert shape == pytest.approx([1.0586, 0.9966, 0.9448], abs=0.002)


def test_settings_read_off_badly_take_a_run_more(tmp_path: Path, call: Call) -> None:
    bench = Bench(tmp_path, 3)
    tune(call, bench, misread=0.005)
    assert 4 <= len(bench.runs) <= 9


def test_every_gauge_recorded_takes_one_run(tmp_path: Path, call: Call) -> None:
    bench = Bench(tmp_path, 3)
    bench.record()
    words = ("calibrate", "tune", "--map", "angle=beta_rad,gauges=g1_V+g2_V+g3_V")
    ended = call(*words, bench.runs[0], "--gauge-gains", "1,1,1", "--json")
    assert ended.code == 0
    turns = {each["gauge"]: each["then"] for each in ended.result["turns"]}
    assert [turns[j] for j in (1, 2, 3)] == pytest.approx([1.0586, 0.9966, 0.9448], abs=0.002)
    text = ",".join(f"{turns[j]:.6f}" for j in (1, 2, 3))
    again = call(*words, bench.runs[0], "--gauge-gains", text)
    assert again.code == 0
    assert "The line is gone" in again.out


def test_steps_of_potentiometers(tmp_path: Path, call: Call) -> None:
    bench = Bench(tmp_path, 3)
    bench.gains = np.full(3, 128 * 2 / 255)
    result = tune(call, bench, "--potentiometer", "256")
    steps = bench.gains * 255 / 2
    assert steps == pytest.approx(np.round(steps), abs=1e-3)
    # As near as steps of 0.8 % go.
    assert max(result["residual"][-1]) < 0.005


def test_what_a_person_reads(tmp_path: Path, call: Call) -> None:
    bench = Bench(tmp_path, 3)
    bench.record()
    ended = call(*bench.words()[:-1])
    assert "Turn potentiometer 3 down by 0.1000" in ended.out
    assert "2 more setting(s) are needed" in ended.out


def test_runs_that_contradict_each_other_are_said(tmp_path: Path, call: Call) -> None:
    bench = Bench(tmp_path, 3)
    for gains in ((1, 1, 1), (1, 1, 0.9), (1, 0.9, 1), (0.9, 1, 1), (1, 0.95, 0.95)):
        bench.gains = np.array(gains)
        bench.record()
    bench.settings[4] = "1,0.95,0.8"
    assert "contradict each other" in call(*bench.words()).err


@given(st.integers(3, 7), st.integers(0, 2**31))
def test_phasors_from_settings_and_turns_that_cancel(gauges: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    lead = np.exp(2j * np.pi * np.arange(gauges) / gauges)
    phasors = (rng.uniform(0.8, 1.2, gauges) * lead)[np.newaxis]
    settings = [np.ones(gauges)]
    while gauge_phasors(np.array(settings) @ phasors.T, np.array(settings)) is None:
        turn = trial_turn(np.array(settings))
        following = settings[-1].copy()
        following[turn.gauge - 1] = turn.then
        settings.append(following)
    assert len(settings) == gauges
    sums = np.array(settings) @ phasors.T
    found = gauge_phasors(sums, np.array(settings))
    assert found is not None
    assert found == pytest.approx(phasors, abs=1e-9)
    torque = rng.uniform(0.9, 1.1, gauges)
    advice = advise(found, sums[-1], settings[-1], torque)
    then = settings[-1].copy()
    for turn in advice.turns:
        then[turn.gauge - 1] = turn.then
    assert np.abs(phasors @ then)[0] < 1e-9
    assert then @ torque == pytest.approx(settings[-1] @ torque)


def test_gauges_on_a_line_cannot_be_tuned() -> None:
    phasors = np.array([[1.0, 1.01, 0.99 + 0.001j]])
    with pytest.raises(InputError, match="no potentiometer settings cancel"):
        advise(phasors, phasors.sum(axis=1), np.ones(3), np.ones(3))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"--map": "sum=sum_V"}, "nothing is mapped for angle"),
        ({"--map": "angle=beta_rad"}, "expected either gauges="),
        ({"--map": "angle=beta_rad,sum=sum_V,gauges=g1_V+g2_V"}, "expected either gauges="),
        ({"--map": "angle=beta_rad,gauges=g1_V+g2_V"}, "2 gauge column(s) are mapped"),
        ({"--gauge-gains": "1,a,1"}, "numbers by commas"),
        ({"--gauge-gains": "1"}, "expected the same number every time"),
        ({"--gauge-gains": "0,0,0"}, "all gains 0"),
        ({"--gauge-gains": None}, "gauge-gains"),
        ({"--harmonics": "0"}, "--harmonics 0: expected"),
        ({"--harmonics": "1.5"}, "--harmonics 1.5: expected a whole number"),
        ({"--until": "-1"}, "--until -1: expected"),
        ({"--until": "nan"}, "--until nan: expected"),
        ({"--potentiometer": "1"}, "--potentiometer potentiometer:1: expected"),
        ({"--torque-sensitivity": "1,1"}, "expected 3 numbers"),
        ({"--ratio": "0"}, "--ratio 0: expected"),
        ({"--ratio": "50"}, "without --configuration"),
        ({"--joint": "nowhere.toml"}, "nowhere.toml"),
    ],
)
def test_what_cannot_be_used_is_refused(
    tmp_path: Path, call: Call, changed: dict[str, str | None], words: str
) -> None:
    bench = Bench(tmp_path, 3)
    bench.record()
    options: dict[str, str | None] = {
        "--map": "angle=beta_rad,sum=sum_V",
        "--gauge-gains": "1,1,1",
        **changed,
    }
    line: list[object] = ["calibrate", "tune", bench.runs[0]]
    for name, value in options.items():
        line += [] if value is None else [name, value]
    ended = call(*line)
    assert ended.code == 2
    assert words in ended.err
    assert "Traceback" not in ended.err


def test_runs_and_settings_belong_together(tmp_path: Path, call: Call) -> None:
    bench = Bench(tmp_path, 3)
    bench.record()
    words = ("--map", "angle=beta_rad,sum=sum_V", "--gauge-gains", "1,1,1")
    none = call("calibrate", "tune", *words)
    assert none.code == 2
    assert "no run is given" in none.err
    many = call("calibrate", "tune", bench.runs[0], *words, "--gauge-gains", "1,1,0.9")
    assert many.code == 2
    assert "is given 2 times for 1 run(s)" in many.err
    missing = call("calibrate", "tune", tmp_path / "gone.csv", *words)
    assert missing.code == 2
