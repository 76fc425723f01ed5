"""What the speed bench times computes the same as the dense references, and who does not is left out."""

from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import strainwave as sw
from benchmarks.speed import programs
from benchmarks.speed.agreement import TOLERANCE_NM, agreement, references
from benchmarks.speed.comparison import Setting, compare
from benchmarks.speed.implementations import DEFAULT, PUBLISHED, Implementation, batch, start
from benchmarks.speed.inputs import Recording, make, read
from benchmarks.speed.rounds import Effort, ratio
from benchmarks.speed.worker_process import NotAvailableError
from strainwave.filter import oscillator_preset

SAMPLES = 4000
LIMITS = {
    "operations_per_s": {"v3": {"float": 1e11, "double": 5e10}},
    "bandwidth_bytes_per_s": {"1": {"copy": 1e10, "triad": 1e10}},
}
#: What a peer in Python needs, where it is not its name.
MODULES = {"numba_fastmath": "numba"}


@pytest.fixture(scope="module")
def recording() -> Recording:
    return make(2 * SAMPLES, 11)


@pytest.fixture(scope="module")
def found(recording) -> dict[str, np.ndarray]:
    return references(recording, SAMPLES)


@pytest.fixture(scope="module")
def inputs(recording, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("inputs")
    recording.write(folder)
    return folder


def test_recording_reverses_rests_and_comes_back(recording):
    speed = recording.motor_speed_rad_s
    assert np.count_nonzero(np.diff(np.sign(speed[speed != 0]))) >= 4
    assert np.count_nonzero(speed[1:-1] == 0) > 100
    assert np.max(np.abs(speed)) > 75
    # Repeated, it goes on at the angle where it ended.
    assert recording.motor_angle_rad[-1] + 1e-3 * speed[-1] == pytest.approx(0, abs=1e-9)


def test_recording_is_read_as_written(recording, inputs):
    again = read(inputs)
    np.testing.assert_array_equal(again.torque_Nm, recording.torque_Nm)
    np.testing.assert_array_equal(again.motor_angle_rad, recording.motor_angle_rad)


@pytest.mark.parametrize("precision", ["float", "double"])
def test_package_agrees_with_both_references(recording, found, precision):
    dtype = {"float": "float32", "double": "float64"}[precision]
    torque = recording.torque_Nm[:SAMPLES]
    published = sw.OscillatorFilter(oscillator_preset("taghirad1999"), dtype=dtype)
    ripple = published.process(
        torque, motor_speed_rad_s=recording.motor_speed_rad_s[:SAMPLES]
    ).ripple_Nm
    assert agreement("published", precision, ripple, found["published"]).ok
    with_terms = [sw.RippleOrder(n, with_load=True, with_speed=True) for n in (2, 4)]
    config = sw.RippleFilterConfig(orders=[*with_terms, Fraction(1, 100)], memory_turns=300.0)
    ripple = (
        sw.RippleFilter(config, dtype=dtype)
        .process(recording.time_s[:SAMPLES], recording.motor_angle_rad[:SAMPLES], torque)
        .ripple_Nm
    )
    assert agreement("default", precision, ripple, found["default"]).ok


PEERS = [each for each in (*PUBLISHED, *DEFAULT) if each.program == "peers"]


@pytest.mark.parametrize("each", PEERS, ids=lambda each: each.key)
def test_peers_that_are_there_agree(each, inputs, found):
    there = programs.find()
    if there.peers.is_relative_to(programs.BUILD):
        pass  # an environment with all of them
    elif find_spec(MODULES.get(each.name, each.name)) is None:
        pytest.skip(f"{each.name} is not installed; make bench installs it")
    with start(each, there, inputs) as worker:
        ripple = worker.ripple_Nm(SAMPLES, inputs)
        assert worker.version
        assert worker.peak_memory_bytes > 1e6
    assert agreement(each.reference, each.precision, ripple, found[each.reference]).ok


#: What finds the vector level when it runs: many channels, and a log that may be cut into chunks.
DISPATCHED = [
    each
    for which in ("published", "default")
    for each in (
        *(batch(which, level, threads) for level, threads in (("v2", 1), ("v3", 1), ("v3", 2))),
        Implementation(
            "long", which, "dispatched", f"long_{which}:level=v3:threads=2", "float", "a long log"
        ),
    )
]


@pytest.mark.slow
def test_programs_in_cpp_agree_on_every_path(inputs, found):
    assert programs.build_cpp() == ""
    there = programs.find()
    native = [each for each in (*PUBLISHED, *DEFAULT) if each.program == "native"]
    checked = 0
    for each in (*native, *DISPATCHED):
        try:
            with start(each, there, inputs) as worker:
                ripple = worker.ripple_Nm(SAMPLES, inputs)
        except NotAvailableError as error:
            assert "eigen" in each.name, error  # noqa: PT017
            continue
        assert agreement(each.reference, each.precision, ripple, found[each.reference]).ok, each
        checked += 1
    assert checked >= 6 + len(DISPATCHED)


def _setting(found, inputs, said: list[str]) -> Setting:
    return Setting(
        programs.find(), inputs, 2 * SAMPLES, found, LIMITS, "v3", Effort(2, 0.001), say=said.append
    )


NUMPY = next(each for each in PUBLISHED if each.name == "numpy")


def test_comparison_times_who_agrees(inputs, found):
    said: list[str] = []
    rows, times = compare([NUMPY], _setting({"published": found["published"][:500]}, inputs, said))
    (row,) = rows
    assert row["not_available"] is None
    assert row["ratio"] == 1.0
    assert row["difference_rms_Nm"] < TOLERANCE_NM["published", "double"]
    assert len(times["numpy"]) == 2
    if (programs.BUILD / "cpp" / "strainwave_dispatched").exists():
        assert 1e-6 < row["share_of_limit"] < 1e-2
    else:
        assert row["share_of_limit"] is None


def test_who_disagrees_is_said_and_not_timed(inputs, found):
    said: list[str] = []
    wrong = {"published": found["published"][:500] + 1e-6}
    rows, times = compare([NUMPY], _setting(wrong, inputs, said))
    assert times == {}
    assert rows[0]["ns_per_sample"] is None
    assert "disagrees" in rows[0]["not_available"]
    assert any("numpy" in line and "not available" in line for line in said)


def test_who_is_missing_is_said_and_the_others_go_on(inputs, found):
    said: list[str] = []
    missing = Implementation("nobody", "published", "peers", "published_nobody", "float", "nobody")
    setting = _setting({"published": found["published"][:500]}, inputs, said)
    rows, times = compare([NUMPY, missing], setting)
    assert list(times) == ["numpy"]
    assert "nobody" in rows[1]["not_available"]
    assert any("nobody" in line and "not available" in line for line in said)


@pytest.mark.parametrize("spoilt", [np.nan, np.inf])
def test_what_is_no_number_agrees_with_nothing(found, spoilt):
    ripple = found["published"].copy()
    assert agreement("published", "double", ripple, found["published"]).ok
    ripple[7] = spoilt
    assert not agreement("published", "float", ripple, found["published"]).ok
    assert not agreement("published", "float", ripple[:-1], found["published"]).ok


def test_ratio_is_the_median_within_rounds():
    # A round in which everything took four times as long changes nothing.
    assert ratio([10.0, 40.0, 12.0], [1.0, 4.0, 2.0]) == 10.0
