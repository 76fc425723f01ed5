"""Which tunings pass true torque, and which swallow it."""

from __future__ import annotations

from fractions import Fraction

import pytest

from helpers.fidelity_joints import GEAR, of_method, of_sections, oscillator, ripple, signals
from strainwave.fidelity import (
    PASSES,
    SWALLOWS,
    assess,
    assess_shortly,
    subject_of_setting,
)
from strainwave.methods.registry import METHOD_NAMES, Setting

EXPECTED = {
    "ripple": PASSES,
    "smoother": PASSES,
    "taghirad1999": SWALLOWS,
    "taghirad1999-4": SWALLOWS,
    "low-pass": SWALLOWS,
    "notch": SWALLOWS,
}


@pytest.mark.parametrize("period_s", [1e-3, 2.5e-4])
@pytest.mark.parametrize("method", EXPECTED)
def test_verdicts_of_the_methods(method: str, period_s: float) -> None:
    assert set(EXPECTED) == set(METHOD_NAMES) - {"oscillator"}
    found = assess(subject_of_setting(method, Setting(period_s, Fraction(100), 80.0)))
    assert found.verdict == EXPECTED[method]
    assert bool(found.reasons) is (found.verdict == SWALLOWS)
    if method == "taghirad1999":
        assert found.gain_error_worst is not None
        assert found.gain_error_worst.value == pytest.approx(1.0, abs=0.02)
        assert found.step_error_at_20_ms == pytest.approx(1.0, abs=0.05)
    if method == "low-pass":
        # 18.1 ms at 20 Hz, of theory too; the gain is within its limit.
        assert found.delay_worst is not None
        assert found.delay_worst.value == pytest.approx(18.06e-3, rel=0.01)
        assert "late" in found.reasons[0]
    if method in {"ripple", "smoother"}:
        assert found.gain_error_worst is not None
        assert found.gain_error_worst.value < 0.02
        assert found.step_error_at_20_ms < 0.01
        assert all(
            value is not None and 40 < value < 120
            for response in found.responses
            for value in response.attenuation_dB.values()
        )


@pytest.mark.parametrize(
    ("process_noise", "verdict"),
    [(1e-7, PASSES), (1e-6, PASSES), (1e-4, SWALLOWS), (1e3, SWALLOWS)],
)
def test_verdicts_of_oscillator_tunings(process_noise: float, verdict: str) -> None:
    found = assess(of_sections(GEAR, oscillator(process_noise)))
    assert found.subject.removed_orders == (2.0, 4.0)
    assert found.verdict == verdict


@pytest.mark.parametrize(
    ("memory_turns", "verdict"), [(1, SWALLOWS), (3, PASSES), (10, PASSES), (40, PASSES)]
)
def test_verdicts_of_memories(memory_turns: float, verdict: str) -> None:
    found = assess(of_sections(GEAR, signals(1000), ripple(memory_turns)))
    assert found.verdict == verdict
    terms = 'load_orders = ["2m"]\nspeed_orders = ["2m"]\n'
    found = assess(of_sections(GEAR, signals(1000), ripple(memory_turns, terms)))
    assert found.verdict == verdict


@pytest.mark.parametrize("method", EXPECTED)
def test_the_short_measurement_agrees_where_its_speed_tells(method: str) -> None:
    subject = of_method(method)
    if method == "notch":
        # It takes too much at 20 rad/s, not at 50.
        assert assess_shortly(subject).verdict == PASSES
    else:
        assert assess_shortly(subject).verdict == EXPECTED[method]
