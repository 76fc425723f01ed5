"""What the ripple filter learns: memory, attenuation and notch against theory."""

import math

import numpy as np
import pytest

from helpers.ripple_runs import WALK, NOISE_Nm, configured, learning_time_turns, steady
from strainwave import (
    RippleFilter,
    RippleOrder,
)


@pytest.mark.parametrize("speed_rad_s", [20.0, 156.0, 300.0])
@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("memory_turns", [10.0, 30.0, 90.0])
def test_memory_is_the_same_number_of_turns_everywhere(order, speed_rad_s, memory_turns):
    """Q_c = 2 R_eff (dtheta / (2 pi n))^2 makes the steady gain dtheta / (2 pi n) a sample."""
    measured = learning_time_turns(order, speed_rad_s, memory_turns, [2, 4])
    assert 0.9 < measured / memory_turns < 1.1


@pytest.mark.parametrize("memory_turns", [10.0, 30.0])
@pytest.mark.parametrize(
    "terms",
    [
        {"with_speed": True},
        {"with_direction": True},
        {"with_speed": True, "with_direction": True},
    ],
    ids=["speed", "direction", "both"],
)
def test_further_terms_do_not_shorten_the_memory(terms, memory_turns):
    """At constant speed an order's pairs are seen as one; together they gain what one would.

    Not so a load pair: this torque wanders, and with it the pair's uncertainty comes to be seen.
    """
    orders = [RippleOrder(2, **terms), 4]
    measured = learning_time_turns(2, 156.0, memory_turns, orders)
    assert 0.9 < measured / memory_turns < 1.1


@pytest.mark.parametrize("rate_Hz", [400.0, 8000.0])
def test_memory_does_not_depend_on_the_sample_rate(rate_Hz):
    memory = 20.0
    time, angle, torque = steady(100.0, 10 * memory, rate_Hz)
    turns = angle / (2 * np.pi)
    stepped = torque + 1e-3 * np.cos(2 * angle) * (turns >= 8 * memory)
    config = configured(orders=[2], memory_turns=memory)
    amplitudes = []
    for y in (torque, stepped):
        ours = RippleFilter(config)
        till = np.searchsorted(turns, 9 * memory)
        ours.process(time[:till], angle[:till], y[:till])
        amplitudes.append(ours.state()[0][1])
    learned = (amplitudes[1] - amplitudes[0]) / 1e-3
    assert learned == pytest.approx(1 - np.exp(-1), rel=0.1)


@pytest.mark.parametrize("speed_rad_s", [20.0, 156.0, 300.0])
def test_steady_ripple_is_removed_as_well_as_theory_says(speed_rad_s):
    """Noise at each order, averaged over the memory: variance R_eff dtheta / (2 pi n)."""
    memory, orders = 30.0, (2, 4)
    time, angle, torque = steady(speed_rad_s, 60 * memory, seed=5)
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    result = RippleFilter(configured(orders=list(orders), memory_turns=memory)).process(
        time, angle, torque + ripple
    )
    late = angle > 2 * np.pi * 10 * memory
    rms = np.sqrt(np.mean((result.ripple_Nm - ripple)[late] ** 2))
    dt = 1e-3
    turned = speed_rad_s * dt
    variance = sum(
        (NOISE_Nm**2 + WALK**2 * dt / (2 - 2 * np.cos(k * turned))) * turned / (2 * np.pi * memory)
        for k in orders
    )
    assert rms == pytest.approx(np.sqrt(variance), rel=0.15)


@pytest.mark.parametrize("beside", [0.5, 1.0, 3.0, 10.0])
@pytest.mark.parametrize("side", [-1, 1])
def test_notch_is_as_wide_as_its_memory(beside, side):
    """Torque at an order beside: of it 1 / sqrt(1 + (2 pi n delta)^2) is taken for ripple."""
    memory = 30.0
    time, angle, torque = steady(156.0, 40 * memory)
    delta = side * beside / (2 * np.pi * memory)
    added = 1e-3 * np.cos((2 + delta) * angle)
    config = configured(orders=[2, 4], memory_turns=memory)
    runs = [
        RippleFilter(config).process(time, angle, y).ripple_Nm for y in (torque, torque + added)
    ]
    late = angle > 2 * np.pi * 10 * memory
    taken = (runs[1] - runs[0])[late] / 1e-3
    phasor = 2 * np.mean(taken * np.exp(-1j * (2 + delta) * angle[late]))
    assert abs(phasor) == pytest.approx(1 / np.hypot(1, beside), rel=0.1, abs=0.003)
    assert np.angle(phasor) == pytest.approx(-side * math.atan(beside), abs=0.12)


def test_torque_away_from_the_orders_passes_whole():
    """A notch of half width w at f_k turns a torque at f by 2 f w / (f^2 - f_k^2), and no more."""
    memory, speed = 30.0, 156.0
    time, angle, torque = steady(speed, 800)
    config = configured(orders=[2, 4], memory_turns=memory)
    base = RippleFilter(config).process(time, angle, torque).torque_Nm
    late = angle > 2 * np.pi * 300
    turn_Hz = speed / (2 * np.pi)
    width_Hz = turn_Hz / (2 * np.pi * memory)
    for hertz in (1.0, 5.0, 20.0, 130.0, 310.0, 450.0):
        wave = 0.01 * np.sin(2 * np.pi * hertz * time)
        passed = RippleFilter(config).process(time, angle, torque + wave).torque_Nm - base
        turner = np.exp(-2j * np.pi * hertz * time)
        answer = np.mean((passed * turner)[late]) / np.mean((wave * turner)[late])
        assert abs(answer) == pytest.approx(1.0, abs=0.005), hertz
        theory = sum(2 * hertz * width_Hz / (hertz**2 - (k * turn_Hz) ** 2) for k in (2, 4))
        if hertz <= 20:
            assert np.angle(answer) == pytest.approx(theory, rel=0.25, abs=1e-4), hertz
            assert abs(np.angle(answer)) / (2 * np.pi * hertz) < 3e-5, hertz  # delay, s
