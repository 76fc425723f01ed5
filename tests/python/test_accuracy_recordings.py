"""The accuracy bench on the real recordings; skipped where they are absent."""

import numpy as np
import pytest

from benchmarks.accuracy import kuka
from benchmarks.accuracy.methods.catalogue import BY_NAME
from benchmarks.accuracy.metrics import line_powers
from benchmarks.accuracy.other_recordings import run_through
from benchmarks.accuracy.recordings import (
    ENVIRONMENT_VARIABLE,
    KUKA_CONSTANT_SPEED,
    read_joint,
    recordings_folder,
)

pytestmark = pytest.mark.skipif(
    not recordings_folder().is_dir(),
    reason=f"no recordings at {recordings_folder()}; {ENVIRONMENT_VARIABLE} names their folder",
)


@pytest.fixture(scope="module")
def joints():
    return {joint: kuka.read_kuka_joint(recordings_folder(), joint) for joint in kuka.JOINTS}


def test_three_rows_of_four_only_repeat(joints):
    rows = len(
        read_joint(
            recordings_folder() / KUKA_CONSTANT_SPEED,
            time="t_s",
            angle="q1_rad",
            torque="tau1_Nm",
            ratio=kuka.RATIO,
        ).time_s
    )
    for recording in joints.values():
        assert 3.9 < rows / len(recording.time_s) < 4.1
        assert np.median(np.diff(recording.time_s)) == pytest.approx(0.01, abs=2e-4)


def test_order_2_is_as_strong_as_was_found_before(joints):
    # README of the recordings: zero to peak, fitted independently of this project.
    for joint, amplitude_Nm in {1: 0.9, 2: 1.8, 3: 0.6, 4: 0.64}.items():
        recording = joints[joint]
        first, last = np.searchsorted(recording.time_s, kuka.EVALUATED_S)
        found = line_powers(
            recording.torque_Nm, recording.motor_angle_rad, (2, 4), [slice(first, last)], 5
        )
        assert np.sqrt(found[0]) == pytest.approx(amplitude_Nm, rel=0.35)


def test_raw_changes_nothing_and_ours_what_the_study_found(joints):
    # An independent study, memory 2 turns: decibels, and the largest error that is allowed.
    limits = {1: (15.5, 4.0), 2: (19.1, 8.0), 3: (16.8, 4.0), 4: (19.3, 4.5)}
    for joint, (attenuation_dB, most_percent) in limits.items():
        raw = kuka.score_on_kuka(BY_NAME["raw"], {}, joints[joint], joint)
        assert raw.attenuation_dB == (0.0, 0.0)
        assert raw.injection_error_percent < 1e-9
        tuning = {"memory_turns": 2.0, "torque_walk_over_noise": 1.0}
        ours = kuka.score_on_kuka(BY_NAME["ours"], tuning, joints[joint], joint)
        assert ours.attenuation_dB[0] == pytest.approx(attenuation_dB, abs=1.0)
        assert 0.0 < ours.injection_error_percent < most_percent
        assert abs(ours.outside_dB) < 0.3


def test_the_others_run_through():
    found = run_through(recordings_folder())
    assert len(found) == 10
    assert all(each.finite for each in found)
    lara_3 = [each for each in found if "validate" in each.file and each.joint == 3]
    assert lara_3[0].attenuation_dB > 3
