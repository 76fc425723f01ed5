"""Whether the ripple turns with the motor or with the wave, from simulated recordings."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strainwave.identify.wave_factor import find_wave_factor

RATIO = Fraction(100)


def _recording(
    factor: float, output_turns: float, *, seed: int = 3, reversals: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(seed)
    rows = 20_000
    there = np.linspace(0.0, output_turns * float(RATIO) * 2 * np.pi, rows)
    angle_rad = np.concatenate([there, *[there[:: (-1) ** (n + 1)] for n in range(reversals)]])
    slow_Nm = 20.0 * np.sin(angle_rad / float(RATIO) + 0.3)
    ripple_Nm = 1.6 * np.cos(2 * factor * angle_rad + 0.4) + 0.6 * np.cos(4 * factor * angle_rad)
    return angle_rad, slow_Nm + ripple_Nm + 0.05 * generator.standard_normal(len(angle_rad))


@pytest.mark.parametrize("factor", [Fraction(1), Fraction(101, 100)])
@pytest.mark.parametrize("output_turns", [0.35, 1.0, 3.0])
@pytest.mark.parametrize("reversals", [0, 2])
def test_tells_the_two_factors_apart(factor: Fraction, output_turns: float, reversals: int) -> None:
    found = find_wave_factor(*_recording(float(factor), output_turns, reversals=reversals), RATIO)
    assert found.is_decided
    assert found.factor == factor


def test_says_when_the_recording_cannot_tell() -> None:
    angle_rad, torque_Nm = _recording(1.01, 0.2)
    too_short = find_wave_factor(angle_rad, torque_Nm, RATIO)
    assert (too_short.factor, too_short.is_decided, too_short.windows) == (Fraction(1), False, 0)
    angle_rad, torque_Nm = _recording(1.01, 1.0)
    noise = np.random.default_rng(0).standard_normal(len(angle_rad))
    assert not find_wave_factor(angle_rad, np.zeros(len(angle_rad)), RATIO).is_decided
    assert not find_wave_factor(angle_rad, noise, RATIO).is_decided
    assert not find_wave_factor(angle_rad, torque_Nm, None).is_decided
    assert not find_wave_factor(np.empty(0), np.empty(0), RATIO).is_decided
    assert not find_wave_factor(np.zeros(1000), noise[:1000], RATIO).is_decided


@given(st.integers(0, 19_999), st.integers(1, 500))
def test_rows_without_a_number_are_passed_over(start: int, length: int) -> None:
    angle_rad, torque_Nm = _recording(1.01, 1.0)
    angle_rad[start : start + length] = np.nan
    torque_Nm[(start + 700) % 20_000] = np.nan
    found = find_wave_factor(angle_rad, torque_Nm, RATIO)
    assert found.is_decided
    assert found.factor == Fraction(101, 100)
