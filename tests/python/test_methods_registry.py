"""What holds for every method of removing ripple: by name, row for row, however it is cut."""

import itertools
import warnings
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.joint_sections import OSCILLATOR, PROVENANCE, gear
from strainwave import ConfigurationError, InputError, StatusFlag
from strainwave.joint import Joint
from strainwave.methods.interface import joined
from strainwave.methods.registry import METHOD_NAMES, Setting, build_method
from strainwave.samples import Samples

PERIOD_S = 1e-3
ROWS = 1200
TORQUE_FAULT = StatusFlag.torque_not_finite.value
ROTATION_FAULT = StatusFlag.rotation_invalid.value


def joint():
    section = {**OSCILLATOR, "orders": [2, 4, "1/R"], "provenance": PROVENANCE}
    return Joint.model_validate(
        {"joint": {"name": "elbow"}, "gear": gear(), "ripple_filter": section}
    )


SETTING = Setting(PERIOD_S, Fraction(100), 40.0, joint())


def recording(rows=ROWS, seed=5):
    """Rows with jitter, a gap, a stop, ripple, noise, and unusable values, the first among them."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(rows) * PERIOD_S + 1e-5 * rng.random(rows)
    time_s[700:] += 0.3
    angle_rad = 40.0 * time_s + 60.0 * np.maximum(time_s - 0.5, 0.0) ** 2
    torque_Nm = 5.0 + np.cos(2 * angle_rad) + 0.3 * np.sin(4 * angle_rad)
    torque_Nm += 0.05 * rng.standard_normal(rows)
    torque_Nm[[0, 1, 400, 401, 402, 650]] = np.nan
    torque_Nm[500] = np.inf
    torque_Nm[501] = -1e200
    angle_rad[[0, 300, 301, 402, 800]] = np.nan
    angle_rad[900] = np.inf
    time_s[850] = time_s[849]
    return Samples(time_s, angle_rad, torque_Nm, 0.1 * rng.standard_normal(rows))


def cut(samples, start, stop):
    return Samples(
        samples.time_s[start:stop],
        samples.motor_angle_rad[start:stop],
        samples.torque_Nm[start:stop],
        samples.expected_torque_Nm[start:stop],
    )


def run(name, samples, cuts=()):
    method = build_method(name, SETTING)
    edges = [0, *sorted(cuts), len(samples)]
    parts = [method.process(cut(samples, start, stop)) for start, stop in itertools.pairwise(edges)]
    return joined([*parts, method.finish()])


@pytest.mark.parametrize("name", METHOD_NAMES)
@given(cuts=st.lists(st.integers(0, ROWS), max_size=8))
def test_how_a_recording_is_cut_makes_no_difference_to_the_last_bit(name, cuts):
    samples = recording()
    whole = run(name, samples)
    pieces = run(name, samples, cuts)
    np.testing.assert_array_equal(pieces.torque_Nm, whole.torque_Nm)
    np.testing.assert_array_equal(pieces.ripple_Nm, whole.ripple_Nm)
    np.testing.assert_array_equal(pieces.status, whole.status)


@pytest.mark.parametrize("name", METHOD_NAMES)
def test_row_by_row_is_the_same_too(name):
    samples = recording()
    whole = run(name, samples)
    pieces = run(name, samples, range(1, ROWS))
    np.testing.assert_array_equal(pieces.torque_Nm, whole.torque_Nm)
    np.testing.assert_array_equal(pieces.status, whole.status)


@pytest.mark.parametrize("rows", [0, 1, 2, 333])
@pytest.mark.parametrize("name", METHOD_NAMES)
def test_one_row_comes_out_for_each_that_went_in(name, rows):
    cleaned = run(name, cut(recording(), 0, rows))
    assert len(cleaned) == len(cleaned.ripple_Nm) == len(cleaned.status) == rows
    assert cleaned.torque_Nm.dtype == cleaned.ripple_Nm.dtype == np.float64
    assert cleaned.status.dtype == np.uint32


@pytest.mark.parametrize("name", METHOD_NAMES)
def test_unusable_rows_are_flagged_hold_the_last_torque_and_say_nothing(name):
    samples = recording()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cleaned = run(name, samples)
    assert np.isfinite(cleaned.torque_Nm).all()
    assert np.isfinite(cleaned.ripple_Nm).all()
    usable = np.abs(samples.torque_Nm) <= 1e15
    np.testing.assert_array_equal((cleaned.status & TORQUE_FAULT) != 0, ~usable)
    bad = np.flatnonzero(~usable)
    held = np.where(bad > 1, cleaned.torque_Nm[np.maximum(bad - 1, 0)], 0.0)
    np.testing.assert_array_equal(cleaned.torque_Nm[bad], held)
    # A method that integrates real time does not take a row whose time stands still.
    taken = usable & ((cleaned.status & StatusFlag.sample_out_of_order.value) == 0)
    assert set(np.flatnonzero(usable & ~taken)) <= {850}
    np.testing.assert_allclose(
        (cleaned.torque_Nm + cleaned.ripple_Nm)[taken], samples.torque_Nm[taken], atol=1e-12
    )


@pytest.mark.parametrize("name", [name for name in METHOD_NAMES if name != "low-pass"])
def test_rows_without_an_angle_are_flagged(name):
    samples = recording()
    flagged = np.flatnonzero(run(name, samples).status & ROTATION_FAULT)
    unknown = np.flatnonzero(~np.isfinite(samples.motor_angle_rad))
    assert set(unknown) <= set(flagged)
    # Where the speed is needed, a row that repeats a time stamp has none.
    assert set(flagged) - set(unknown) <= {850}


@pytest.mark.parametrize("name", METHOD_NAMES)
def test_two_of_a_name_share_no_state(name):
    samples = recording()
    alone = run(name, samples)
    first = build_method(name, SETTING)
    second = build_method(name, SETTING)
    first.process(samples)
    again = joined([second.process(samples), second.finish()])
    np.testing.assert_array_equal(again.torque_Nm, alone.torque_Nm)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("tagirad1999", "did you mean taghirad1999"),
        ("lowpass", "did you mean low-pass?"),
        ("Notch", "did you mean notch?"),
        ("xyz", "check the spelling"),
    ],
)
def test_an_unknown_name_gets_the_nearest(name, hint):
    with pytest.raises(InputError, match=r"expected one of .*taghirad1999, .*notch") as caught:
        build_method(name, SETTING)
    assert hint in str(caught.value)


@pytest.mark.parametrize("name", METHOD_NAMES)
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_an_unusable_setting_is_refused(name, value):
    with pytest.raises(ConfigurationError, match="sample_period_s"):
        build_method(name, Setting(value, Fraction(100), 40.0, joint()))
    with pytest.raises(ConfigurationError, match="rated_torque_Nm"):
        build_method(name, Setting(PERIOD_S, Fraction(100), value, joint()))
