"""The zero from poses at rest: what the scatter gate lets pass, and how well the zero is known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.static_poses import (
    ANGLES_DEG,
    GAIN_NM_PER_V,
    GRAVITY_NM,
    HORIZONTAL_DEG,
    RATED_NM,
    made_up_poses,
    station_poses,
    weight_Nm,
)
from strainwave.calibrate.poses import Poses, group_poses
from strainwave.calibrate.tare import SensorScatter, Weight, tare
from strainwave.errors import InputError

HORIZONTAL_RAD = float(np.radians(HORIZONTAL_DEG))
SCATTER = SensorScatter(0.03)
RIGHT = Weight(GRAVITY_NM, HORIZONTAL_RAD)


def _poses(columns: dict[str, np.ndarray]) -> Poses:
    return group_poses(columns["tau"], np.radians(columns["q_deg"]), columns["pose"])[0]


@pytest.mark.parametrize("angle_rad", [HORIZONTAL_RAD, None])
def test_the_station_of_1999(angle_rad: float | None) -> None:
    """Simulated: the zero within 0.1 %FS, and a payload that is wrong by 20 % refused."""
    for seed in (1, 2, 3):
        columns = station_poses(seed, 0.15)
        columns["tau"] = GAIN_NM_PER_V * columns["u"]
        poses = _poses(columns)
        scatter = SensorScatter(0.001 * RATED_NM, 0.02)
        right = tare(poses, Weight(GRAVITY_NM, angle_rad), scatter)
        assert right.is_explained
        assert abs(right.zero_Nm - 0.15 * GAIN_NM_PER_V) < 0.001 * RATED_NM
        assert right.horizontal_angle_rad == pytest.approx(HORIZONTAL_RAD, abs=0.03)
        for wrong in (0.8, 1.2):
            found = tare(poses, Weight(wrong * GRAVITY_NM, angle_rad), scatter)
            assert not found.is_explained
            assert found.would_be_explained
            assert found.model_share == pytest.approx(1 / wrong, rel=0.03)


def test_single_readings_keep_the_fluctuation() -> None:
    """Simulated: one motor angle a pose is not enough, and the gate says so."""
    columns = station_poses(1, 0.15, readings=1)
    columns["tau"] = GAIN_NM_PER_V * columns["u"]
    found = tare(_poses(columns), RIGHT, SensorScatter(0.001 * RATED_NM, 0.02))
    assert not found.is_explained
    assert 0.003 < abs(found.zero_Nm - 0.15 * GAIN_NM_PER_V) / RATED_NM < 0.005


@pytest.mark.parametrize("angle_rad", [HORIZONTAL_RAD, None])
def test_gate_and_uncertainty_keep_their_promise(angle_rad: float | None) -> None:
    """Of 600 right models 1 % are refused, and errors over their uncertainties scatter by 1."""
    refused, ratios, shares = 0, [], []
    for seed in range(600):
        poses = _poses(made_up_poses(seed, noise_Nm=0.0))
        found = tare(poses, Weight(GRAVITY_NM, angle_rad), SCATTER)
        refused += not found.is_explained
        ratios.append((found.zero_Nm - 0.9) / found.standard_uncertainty_Nm)
        assert found.model_share is not None
        assert found.model_share_standard_uncertainty is not None
        shares.append((found.model_share - 1) / found.model_share_standard_uncertainty)
    # Binomial: 6 expected, two-sided 99.9 %.
    assert 0 <= refused <= 16
    # Uncertainties only grow with the scatter that is seen, so that the ratio stays a little below 1.
    assert 0.7 < np.mean(np.square(ratios)) < 1.1
    assert 0.6 < np.mean(np.square(shares)) < 1.15


def test_a_payload_wrong_by_what_is_said_is_refused() -> None:
    told = tare(_poses(made_up_poses(0)), RIGHT, SCATTER)
    assert told.refused_share is not None
    refused, hidden = 0, []
    for seed in range(200):
        poses = _poses(made_up_poses(seed))
        wrong = Weight(GRAVITY_NM * (1 + told.refused_share), HORIZONTAL_RAD)
        found = tare(poses, wrong, SCATTER)
        refused += not found.is_explained
        hidden.append(found.zero_Nm - 0.9)
    # 95 %, as the share's: two-sided 99.9 % of 200, and a little more as the readings scatter, too.
    assert 178 <= refused <= 199
    assert abs(np.mean(hidden)) == pytest.approx(told.hidden_zero_Nm, abs=0.01)


def test_repeated_readings_widen_the_gate_by_what_they_scatter() -> None:
    poses = _poses(made_up_poses(1, readings=5, noise_Nm=0.2, scatter_Nm=0.0))
    assert poses.repeatability_freedom == 24
    assert poses.repeatability_Nm == pytest.approx(0.2, rel=0.4)
    assert tare(poses, RIGHT, SCATTER).is_explained
    single = Poses(poses.torque_Nm, poses.output_angle_rad, np.ones(6, np.int64))
    assert not tare(single, RIGHT, SCATTER).is_explained
    assert list(poses.readings) == [5] * 6


def test_poses_keep_their_order() -> None:
    poses, number = group_poses([1, 2, 3, 5], [0, 1, 2, 1], ["b", "a", "c", "a"])
    np.testing.assert_array_equal(number, [0, 1, 2, 1])
    np.testing.assert_allclose(poses.torque_Nm, [1, 3.5, 3])


def test_what_is_no_weight_is_not_explained_by_another_mass() -> None:
    columns = made_up_poses(2)
    columns["tau"] = columns["tau"] + 1.5 * np.sin(3 * np.radians(columns["q_deg"]))
    found = tare(_poses(columns), RIGHT, SCATTER)
    assert not found.is_explained
    assert not found.would_be_explained


def test_torques_of_a_model_do_as_well() -> None:
    columns = made_up_poses(3)
    poses = _poses(columns)
    found = tare(poses, weight_Nm(np.array(ANGLES_DEG)), SCATTER)
    told = tare(poses, RIGHT, SCATTER)
    assert found.zero_Nm == pytest.approx(told.zero_Nm, abs=1e-12)
    assert found.horizontal_angle_rad is None


def test_without_weight_it_is_a_mean() -> None:
    columns = made_up_poses(4)
    columns["tau"] = columns["tau"] - weight_Nm(columns["q_deg"])
    found = tare(_poses(columns), Weight(0.0), SCATTER)
    assert found.zero_Nm == pytest.approx(float(columns["tau"].mean()), abs=1e-12)
    assert (found.model_share, found.refused_share) == (None, None)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-50, 50),
    st.floats(1, 80),
    st.floats(-3.1, 3.1),
    st.floats(0.01, 10),
    st.lists(st.floats(-3.1, 3.1), min_size=6, max_size=12, unique=True),
)
def test_an_exact_model_gives_the_exact_zero(
    zero: float, amplitude: float, angle: float, accuracy: float, poses_rad: list[float]
) -> None:
    angles = np.array(poses_rad)
    torque = amplitude * np.cos(angles - angle) + zero
    poses = Poses(torque, angles, np.ones(len(angles), np.int64))
    scatter = SensorScatter(accuracy)
    if float(np.std(torque)) < 0.2 * amplitude:
        with pytest.raises(InputError, match="too much alike"):
            tare(poses, Weight(amplitude, angle), scatter)
        return
    told = tare(poses, Weight(amplitude, angle), scatter)
    assert told.zero_Nm == pytest.approx(zero, abs=1e-9 * (amplitude + abs(zero)))
    assert told.is_explained
    scaled = tare(
        Poses(-3 * torque, angles, poses.readings),
        Weight(-3 * amplitude, angle),
        SensorScatter(3 * accuracy),
    )
    assert scaled.zero_Nm == pytest.approx(-3 * told.zero_Nm, abs=1e-8 * (amplitude + abs(zero)))


@pytest.mark.parametrize(
    ("angles_deg", "angle_rad", "words"),
    [
        ((0.0, 90.0), HORIZONTAL_RAD, "there are 2 poses: expected at least 3 for the zero"),
        ((0.0, 90.0, 180.0), None, "at least 4 for zero and horizontal angle"),
        ((20.0, 25.0, 15.0, 22.0), HORIZONTAL_RAD, "the poses are too much alike: the weight's"),
        ((20.0, 25.0, 15.0, 22.0, 30.0), None, "tell zero, horizontal angle and weight apart"),
    ],
)
def test_poses_that_do_not_do(
    angles_deg: tuple[float, ...], angle_rad: float | None, words: str
) -> None:
    poses = _poses(made_up_poses(5, angles_deg=angles_deg))
    with pytest.raises(InputError, match=words):
        tare(poses, Weight(GRAVITY_NM, angle_rad), SCATTER)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        (([1, 2, np.nan], [0, 1, 2], None), "torque_Nm is not finite at row 2"),
        (([1, 2, 3], [0, 1], None), "output_angle_rad has 2 elements"),
        (([1, 2, 3], [0, 1, 2], ["a"]), "pose has 1 elements"),
    ],
)
def test_bad_arrays(arrays: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        group_poses(*arrays)
    poses = _poses(made_up_poses(6))
    with pytest.raises(InputError, match="model has 2 elements"):
        tare(poses, [1.0, 2.0], SCATTER)
