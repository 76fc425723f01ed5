"""The ripple filter against its equations written anew with dense matrices, and against theory."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strainwave import (
    ConfigurationError,
    FrozenTerm,
    InputError,
    LearnedRipple,
    RippleFilter,
    RippleFilterConfig,
    RippleOrder,
    StatusFlag,
)

FS_Nm = 40.0
NOISE_Nm = 0.04
WALK = 1.3  # Nm per square root of a second
COUNT_rad = 2 * np.pi / 2**20  # angles of whole counts are phases without rounding
FAULTS = 0xFFF


def configured(orders, **parameters):
    """Memory of 30 turns unless a test says otherwise."""
    return RippleFilterConfig(orders=orders, **{"memory_turns": 30.0, **parameters})


def flattened(load_Nm):
    """The load a pair is multiplied by: linear for small ones, half of that at the rated one."""
    share = np.asarray(load_Nm) / FS_Nm
    return share / (1 + np.abs(share))


def counts(angle_rad):
    return np.round(np.asarray(angle_rad) / COUNT_rad) * COUNT_rad


def angle_of(speed_rad_s, time_s):
    steps = 0.5 * (speed_rad_s[1:] + speed_rad_s[:-1]) * np.diff(time_s)
    return counts(np.concatenate([[0.0], np.cumsum(steps)]))


def walk(rng, samples, dt, walk_Nm=WALK):
    return np.cumsum(rng.standard_normal(samples)) * walk_Nm * np.sqrt(dt)


def has(status, flag):
    return (np.asarray(status) & int(flag)) != 0


# ---- the equations, written anew -----------------------------------------------------------------


def single(value):
    """The core's fixed numbers are float, on every platform and in double too."""
    return float(np.float32(value))


class Dense:
    """[T; c] with full matrices and Joseph's form; samples that are sound and new, and no others."""

    def __init__(self, config):
        self.config = config
        self.orders = [float(o.order) for o in config.orders]
        self.terms = [[True, o.with_load, o.with_speed, o.with_direction] for o in config.orders]
        self.keep = [o.keep for o in config.orders]
        self.block = np.concatenate(
            [[-1]] + [[a] * (2 * sum(t)) for a, t in enumerate(self.terms)]
        ).astype(int)
        n = len(self.block)
        self.x = np.zeros(n)
        self.P = config.initial_amplitude_Nm**2 * np.eye(n)
        self.scale = 3 * config.torque_noise_Nm
        self.load = 0.0
        self.weights = []
        # Process noise waits by pairs; pair i has the states 1 + 2 i and 2 + 2 i.
        self.waiting = np.zeros(n // 2)
        self.turn = 0
        self.typical = 0.0

    def h(self, angle, speed):
        share = self.load / self.config.rated_torque_Nm
        factors = np.array(
            [
                1.0,
                share / (1 + abs(share)),
                abs(speed) / self.config.reference_speed_rad_s,
                speed / (abs(speed) + 1.0),
            ]
        )
        row = [1.0]
        for order, terms in zip(self.orders, self.terms, strict=True):
            for factor in factors[terms]:
                row += [factor * math.cos(order * angle), factor * math.sin(order * angle)]
        return np.array(row)

    def gained(self, h, turned, interval):
        """What each pair's variances gain: its order's noise over the sum of its squares in h."""
        c = self.config
        R, walk = c.torque_noise_Nm**2, c.torque_walk_Nm_per_sqrt_s**2
        # Over a gap the noise is that of the typical intervals in it.
        gap = self.typical > 0 and interval > 2 * self.typical
        pieces = interval / self.typical if gap else 1.0
        each = np.zeros(len(self.waiting))
        for a, order in enumerate(self.orders):
            arc = abs(order * turned) / pieces
            chord = arc**2 if gap else 4 * np.sin(min(arc, np.pi) / 2) ** 2
            chord = 4.0 if arc > np.pi else min(chord, 4.0)
            share = min(1.0, (turned / (2 * np.pi * c.memory_turns)) ** 2 / pieces)
            seen = np.sum(h[self.block == a] ** 2)
            of_order = self.block[1::2] == a
            each[of_order] = 2 * share * (R + walk * interval / pieces / chord) / seen
        return each

    def predict(self, h, turned, interval):
        """Coefficients' process noise: gained by every pair, given to one in turn."""
        if turned != 0:
            self.waiting += self.gained(h, turned, interval)
        self.turn = (self.turn + 1) % len(self.waiting)
        for i in (1 + 2 * self.turn, 2 + 2 * self.turn):
            shrink = min(1.0, self.config.initial_amplitude_Nm / math.sqrt(self.P[i, i]))
            self.P[i, :] *= shrink
            self.P[:, i] *= shrink
            self.P[i, i] += self.waiting[self.turn]
        self.waiting[self.turn] = 0.0

    def run(self, time, angle, torque, expected):
        c = self.config
        R = c.torque_noise_Nm**2
        delay = c.angle_to_torque_delay_s
        at = np.interp(time - max(delay, 0.0), time, angle)
        speed = smooth = known = 0.0  # known: how far back the angle is
        started = False
        since_update = 0.0
        removed = np.empty(len(time))
        everything = np.empty(len(time))
        n = len(self.x)
        for k in range(len(time)):
            dt = time[k] - time[k - 1] if k else 0.0
            known += dt
            since_update += dt
            if k:
                raw = (angle[k] - angle[k - 1]) / dt
                speed += dt / (dt + single(0.01)) * (raw - speed)
                smooth += dt / (dt + single(0.05)) * (raw - smooth)
            where = at[k]
            if known < delay:
                where = angle[0] - speed * (delay - known)
            if delay < 0:
                where = at[k] - speed * delay
            h = self.h(where, speed)
            parts = [h[self.block == a] @ self.x[self.block == a] for a in range(len(self.keep))]
            removed[k] = sum(p for p, keep in zip(parts, self.keep, strict=True) if not keep)
            everything[k] = sum(parts)
            if known < delay:  # good enough to remove with, not to learn from
                continue
            rest = torque[k] - expected[k] - everything[k]
            interval, since_update = since_update, 0.0
            typical = self.typical
            if not started:  # T = rest - (h c - h c_true) - v: what an unknown T becomes
                started = True
                self.x[0] = rest
                cc = self.P[1:, 1:]
                self.P[0, 1:] = self.P[1:, 0] = -cc @ h[1:]
                self.P[0, 0] = h[1:] @ cc @ h[1:] + R
                self.load = torque[k] - everything[k]
                self.typical = interval
                last = where
                continue
            turned = where - last
            last = where
            moving = abs(smooth) >= c.minimum_speed_rad_s
            self.P[0, 0] += c.torque_walk_Nm_per_sqrt_s**2 * min(interval, single(0.1))
            if moving:
                self.predict(h, turned, interval)
            P = self.P.copy()
            e = rest - self.x[0]
            s = h @ P @ h + R
            limit = 3 * max(self.scale, math.sqrt(h[1:] @ P[1:, 1:] @ h[1:]))
            likely = min(1.0, (limit / abs(e)) ** 2) if moving and e != 0 else 1.0
            self.weights.append(likely if moving else np.nan)
            P[0, 0] += s * (1 / likely - 1)  # a jump of T that brings e back to the limit
            s /= likely
            gain = P @ h / s
            if not moving:
                gain[1:] = 0.0
            closed = np.eye(n) - np.outer(gain, h)
            self.P = closed @ P @ closed.T + R * np.outer(gain, gain)
            self.x = self.x + gain * e
            if moving:
                change = single(0.06) * min(abs(turned), 3) * ((abs(e) > self.scale) - single(0.3))
                self.scale *= 1 + change + change**2 / 2
                self.scale = max(self.scale, 0.5 * c.torque_noise_Nm)
            share = interval / (interval + single(1 / (2 * np.pi * 15)))
            self.load += share * (torque[k] - everything[k] - self.load)
            self.typical += (min(interval, 2 * typical) - typical) / 64 if typical else interval
        return removed, everything


def busy_day(seed=1):
    """Constant speed, reversal, standstill, crawl, jitter and a gap; load, contact, outliers."""
    rng = np.random.default_rng(seed)
    samples = 7000
    dt = np.where(np.arange(samples) % 3 == 0, 1e-3, 1e-3 * rng.uniform(0.6, 1.7, samples))
    dt[:1500] = 1e-3
    dt[6000] = 0.7
    time = 5.0 + np.cumsum(dt)
    u = np.arange(samples)
    speed = np.select(
        [u < 1500, u < 3500, u < 4200, u < 5000],
        [120.0, 120.0 * np.cos(2 * np.pi * (u - 1500) / 1000.0), 0.0, 1.7 + 0.001 * (u - 4200)],
        60.0,
    )
    angle = angle_of(speed, time)
    expected = 3.0 * np.sin(time)
    load = expected + 12.0 * np.sin(1.7 * time) + np.where(u > 3800, 10.0, 0.0)
    torque = (
        load
        + (1.6 + 0.02 * load) * np.cos(2 * angle + 0.4)
        + (0.6 + 0.003 * np.abs(speed)) * np.sin(4 * angle)
        + 0.1 * np.sign(speed) * np.cos(7 * angle)
        + NOISE_Nm * rng.standard_normal(samples)
    )
    torque[rng.integers(500, samples, 40)] += 3.0
    return time, angle, torque, expected


STRUCTURES = {
    "constant": [2, 4],
    "rational": [2, Fraction(7, 3), Fraction(13, 5)],
    "load and speed": [
        RippleOrder(2, with_load=True, with_speed=True),
        RippleOrder(4, with_load=True, with_speed=True),
        7,
    ],
    "direction and keep": [
        RippleOrder(2, with_direction=True),
        RippleOrder(4, keep=True, with_speed=True),
        RippleOrder(7, keep=True, with_direction=True),
    ],
}


@pytest.mark.parametrize("orders", STRUCTURES.values(), ids=STRUCTURES)
@pytest.mark.parametrize("memory_turns", [3.0, 30.0])
def test_double_is_the_dense_form(orders, memory_turns):
    config = configured(orders=orders, memory_turns=memory_turns)
    arrays = busy_day()
    dense = Dense(config)
    removed, everything = dense.run(*arrays)
    ours = RippleFilter(config)
    time, angle, torque, expected = arrays
    result = ours.process(time, angle, torque, expected_torque_Nm=expected)
    # The phase of an order that is no whole number is rounded to 2^-32 cycle.
    tolerance = 1e-6 if Fraction(7, 3) in orders else 2e-10
    assert np.abs(result.ripple_Nm - removed).max() < tolerance
    assert np.abs(torque - result.torque_all_removed_Nm - everything).max() < tolerance
    np.testing.assert_array_equal(result.torque_Nm, torque - result.ripple_Nm)
    states, covariance = ours.state()
    assert np.abs(states - dense.x).max() < 5 * tolerance
    assert np.abs(covariance - dense.P).max() < 5 * tolerance * np.abs(dense.P).max()
    np.testing.assert_array_equal(covariance, covariance.T)
    # The run is one in which weights act, learning stops, and ripple is there to be found.
    weights = np.array(dense.weights)
    assert 0.003 < np.mean(weights[~np.isnan(weights)] < 1) < 0.3
    assert 0.1 < np.isnan(weights).mean() < 0.4
    assert has(result.status, StatusFlag.samples_missing).sum() == 1
    assert not (result.status & FAULTS).any()


@pytest.mark.parametrize("delay_s", [0.0023, 0.001, 0.0066, -0.002])
def test_double_is_the_dense_form_with_a_delay(delay_s):
    orders = [2, RippleOrder(4, with_speed=True)]
    config = configured(orders=orders, angle_to_torque_delay_s=delay_s)
    # Before the gap; with a lead before the rest, where the speed fades in steps below a phase's unit.
    rows = 3500 if delay_s < 0 else 6000
    time, angle, torque, expected = (a[:rows] for a in busy_day())
    removed, _ = Dense(config).run(time, angle, torque, expected)
    result = RippleFilter(config).process(time, angle, torque, expected_torque_Nm=expected)
    # The offset is rounded to a phase; a sample of delay too much would be 0.3 Nm.
    assert np.abs(result.ripple_Nm - removed).max() < 1e-6


@pytest.mark.parametrize("name", STRUCTURES)
def test_float_is_the_dense_form(name):
    config = configured(orders=STRUCTURES[name])
    time, angle, torque, expected = busy_day()
    torque, expected = torque.astype(np.float32), expected.astype(np.float32)
    removed, _ = Dense(config).run(
        time, angle, torque.astype(np.float64), expected.astype(np.float64)
    )
    result = RippleFilter(config, dtype=np.float32).process(
        time, angle, torque, expected_torque_Nm=expected
    )
    assert result.ripple_Nm.dtype == np.float32
    difference = result.ripple_Nm - removed
    # Where two pairs cannot be told apart for a while, float splits their sum a little differently.
    assert 1e-8 < np.sqrt(np.mean(difference**2)) < 1e-4
    assert np.abs(difference).max() < 2e-3


# ---- memory, attenuation, notch ------------------------------------------------------------------


def steady(speed_rad_s, turns, rate_Hz=1000.0, seed=2):
    """Time, angle and true torque plus noise exactly as the filter's model has them."""
    rng = np.random.default_rng(seed)
    samples = int(turns * 2 * np.pi / speed_rad_s * rate_Hz)
    time = np.arange(samples) / rate_Hz
    torque = walk(rng, samples, 1 / rate_Hz) + NOISE_Nm * rng.standard_normal(samples)
    return time, counts(speed_rad_s * time), torque


def learning_time_turns(order, speed_rad_s, memory_turns, orders):
    """Time constant of the answer to a small step of amplitude, from two runs with one noise."""
    settle, watched = 8 * memory_turns, 2 * memory_turns
    time, angle, torque = steady(speed_rad_s, settle + watched)
    turns = angle / (2 * np.pi)
    step_Nm = 1e-3
    stepped = torque + step_Nm * np.cos(order * angle) * (turns >= settle)
    config = configured(orders=orders, memory_turns=memory_turns)
    runs = [RippleFilter(config).process(time, angle, y).ripple_Nm for y in (torque, stepped)]
    answer = (runs[1] - runs[0]) / step_Nm
    window = memory_turns / 15
    centres, rest = [], []
    for begin in np.arange(settle + 0.2 * memory_turns, settle + 1.6 * memory_turns, window):
        inside = (turns >= begin) & (turns < begin + window)
        basis = np.stack([np.cos(order * angle[inside]), np.sin(order * angle[inside])], axis=1)
        amplitude = np.linalg.lstsq(basis, answer[inside], rcond=None)[0]
        centres.append(begin + window / 2 - settle)
        rest.append(1 - amplitude[0])
    slope, offset = np.polyfit(centres, np.log(rest), 1)
    assert abs(offset) < 0.1  # an exponential that begins at the step
    return -1 / slope


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


# ---- standstill ----------------------------------------------------------------------------------


def drive_and_stop(load_Nm, speed_then_rad_s, seed=4, encoder_counts=None, dither=False):
    """20 s of driving at changing load, 3 s of standstill, and on at a speed."""
    rng = np.random.default_rng(seed)
    samples = 25000
    time = np.arange(samples) * 1e-3
    ramp = np.clip((time - 23.0) / 0.3, 0, 1)
    speed = np.where(time < 20, 120 + 30 * np.sin(time), speed_then_rad_s * ramp)
    speed = np.where((time > 19) & (time < 20), speed * (20 - time), speed)
    angle = angle_of(speed, time)
    if encoder_counts:
        at_rest = (time > 20) & (time < 23)
        jitter = rng.integers(0, 2, samples) * at_rest if dither else 0
        angle = (np.floor(angle / (2 * np.pi) * encoder_counts) + jitter) * (
            2 * np.pi / encoder_counts
        )
    base = 8 * np.sin(0.9 * time) * (time < 19.5) + NOISE_Nm * rng.standard_normal(samples)
    contact = np.where((time > 21) & (time < 22), load_Nm, 0.0)
    return time, angle, base + contact, contact


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("dither", [False, True])
def test_contact_at_standstill_passes_bit_by_bit(dither, dtype):
    orders = [2, RippleOrder(4, with_speed=True, with_direction=True)]
    config = configured(orders=orders)
    ripples, states = [], []
    for contact_Nm in (0.0, 10.0):
        time, angle, torque, _ = drive_and_stop(contact_Nm, 0.0, encoder_counts=4096, dither=dither)
        y = torque + 1.6 * np.cos(2 * angle) + 0.6 * np.sin(4 * angle)
        ours = RippleFilter(config, dtype=dtype)
        result = ours.process(time, angle, y.astype(dtype))
        ripples.append(result.ripple_Nm)
        states.append(ours.state()[0][1:])
        rest = (time > 20.5) & (time < 23)
        assert has(result.status[rest], StatusFlag.at_rest).all()
        if not dither:
            # |speed| and direction are still fading in the first tenths of a second
            assert np.ptp(result.ripple_Nm[(time > 20.9) & (time < 23)]) == pytest.approx(
                0.0, abs=1e-6
            )
    assert ripples[0].tobytes() == ripples[1].tobytes()
    np.testing.assert_array_equal(states[0], states[1])
    assert 0.1 < np.abs(ripples[0]).max() < 3


def test_contact_at_standstill_with_load_terms_is_within_a_thousandth():
    orders = [RippleOrder(2, with_load=True), RippleOrder(4, with_load=True)]
    config = configured(orders=orders, rated_torque_Nm=FS_Nm)
    time, angle, torque, contact = drive_and_stop(10.0, 0.0)
    smooth = 8 * np.sin(0.9 * time) * (time < 19.5) + contact
    y = torque + (1.6 + 0.8 * flattened(smooth)) * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    result = RippleFilter(config).process(time, angle, y)
    error = result.torque_Nm - torque
    settled = (time > 21.1) & (time < 22)  # the load is low-passed at 15 Hz
    before = (time > 20.5) & (time < 21)
    assert abs(error[settled].mean() - error[before].mean()) < 1e-3 * FS_Nm
    # Without load terms it would be 0.16 Nm times the cosine, which must not be near 0 here.
    cosine = np.cos(2 * angle[before][0] + 0.3)
    assert abs(0.8 * flattened(10.0) * cosine) > 1e-3 * FS_Nm


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_no_bump_from_standstill_to_speed(dtype):
    config = configured(orders=[2, 4])
    time, angle, torque, _ = drive_and_stop(10.0, 100.0)
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    result = RippleFilter(config, dtype=dtype).process(time, angle, (torque + ripple).astype(dtype))
    error = result.ripple_Nm - ripple

    def rms(begin, end):
        return np.sqrt(np.mean(error[(time >= begin) & (time < end)] ** 2))

    assert rms(23.0, 23.5) < 2 * rms(15.0, 19.0)
    assert np.abs(error[(time >= 23) & (time < 23.5)]).max() < 0.03
    assert 1e-4 < rms(15.0, 19.0) < 0.02


def test_reversal_leaves_no_ripple():
    rng = np.random.default_rng(8)
    time = np.arange(40000) * 1e-3
    angle = angle_of(100 * np.sin(1.5 * time), time)
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    torque = walk(rng, len(time), 1e-3, 0.3) + NOISE_Nm * rng.standard_normal(len(time))
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, torque + ripple)
    late = time > 20
    rms = np.sqrt(np.mean((result.ripple_Nm - ripple)[late] ** 2))
    assert 1e-3 < rms < 0.02


# ---- delay ---------------------------------------------------------------------------------------


def delayed_run(rate_Hz, jitter, delay_s, compensated_s, seed=6):
    """RMS of what is left of the ripple while the motor speeds up and slows down."""
    rng = np.random.default_rng(seed)
    samples = int(20 * rate_Hz)
    dt = np.full(samples, 1 / rate_Hz) * (1 + jitter * rng.uniform(-1, 1, samples))
    time = np.cumsum(dt)

    def angle_at(t):
        return 80 * t - 60 / 2.0 * np.cos(2.0 * t)  # 20 to 140 rad/s, 120 rad/s^2

    angle = angle_at(time)
    ripple = 1.6 * np.cos(2 * angle_at(time - delay_s)) + 0.6 * np.sin(4 * angle_at(time - delay_s))
    torque = ripple + 0.01 * rng.standard_normal(samples)
    config = configured(
        orders=[2, 4], angle_to_torque_delay_s=compensated_s, torque_walk_Nm_per_sqrt_s=0.3
    )
    result = RippleFilter(config).process(time, angle, torque)
    late = time > time[0] + 10
    return np.sqrt(np.mean((result.ripple_Nm - ripple)[late] ** 2))


@pytest.mark.parametrize(("rate_Hz", "jitter"), [(1000, 0.0), (8000, 0.0), (1000, 0.5)])
@pytest.mark.parametrize("delay_s", [0.0023, 0.0101])
def test_a_delay_is_compensated_while_the_speed_changes(rate_Hz, jitter, delay_s):
    right = delayed_run(rate_Hz, jitter, delay_s, delay_s)
    none = delayed_run(rate_Hz, jitter, delay_s, 0.0)
    floor = delayed_run(rate_Hz, jitter, 0.0, 0.0)
    assert none > 20 * right
    assert 0.05 < none < 2.0
    assert right < 1.2 * floor + 1e-3
    assert floor > 3e-5


@pytest.mark.parametrize("rate_Hz", [1000, 8000])
def test_a_lead_is_compensated(rate_Hz):
    right = delayed_run(rate_Hz, 0.0, -0.002, -0.002)
    none = delayed_run(rate_Hz, 0.0, -0.002, 0.0)
    assert none > 5 * right  # the speed is that of 10 ms ago: at 120 rad/s^2 it is behind
    assert 0.05 < none < 2.0


def test_longest_delay_at_the_highest_rate():
    right = delayed_run(20000, 0.0, 0.05, 0.05)
    assert right < 0.02  # points 4 ms apart: 120 rad/s^2 bends the angle by 0.5 mrad between them
    assert right > 1e-4


def test_longest_delay_at_the_speed_of_a_fast_motor():
    """50 ms at 10,000 rpm are 52 rad; the ripple is removed there as anywhere."""
    time = np.arange(8000) / 4000.0
    angle = 1047.0 * time
    ripple = 1.6 * np.cos(2 * (angle - 1047.0 * 0.05))
    config = configured(orders=[2], angle_to_torque_delay_s=0.05, memory_turns=10)
    result = RippleFilter(config).process(time, angle, ripple)
    late = time > 1
    assert np.sqrt(np.mean((result.ripple_Nm - ripple)[late] ** 2)) < 0.01
    assert np.ptp(result.ripple_Nm[late]) > 3


# ---- time ----------------------------------------------------------------------------------------


def driving(samples=6000, seed=9, dt=1e-3):
    rng = np.random.default_rng(seed)
    time = 100 + np.arange(samples) * dt
    angle = counts(150 * (time - 100) + 5 * np.sin(time))
    true = 5 * np.sin(2 * time) + NOISE_Nm * rng.standard_normal(samples)
    return time, angle, true, 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)


def test_jitter_costs_nothing():
    rng = np.random.default_rng(1)
    time = np.cumsum(1e-3 * rng.uniform(0.3, 1.7, 20000))
    angle = counts(150 * time)
    ripple = 1.6 * np.cos(2 * angle + 0.3)
    noise = NOISE_Nm * rng.standard_normal(len(time))
    rms = []
    for t, a in ((time, angle), (np.arange(20000) * 1e-3, counts(0.15 * np.arange(20000)))):
        r = 1.6 * np.cos(2 * a + 0.3)
        out = RippleFilter(configured(orders=[2])).process(t, a, noise + r)
        assert out.status[1:].sum() == 0
        rms.append(np.sqrt(np.mean((out.ripple_Nm - r)[10000:] ** 2)))
    assert rms[0] == pytest.approx(rms[1], rel=0.3)
    assert ripple.std() > 1


def test_a_gap_while_moving_is_bridged_and_said():
    time, angle, true, ripple = driving()
    keep = (np.arange(len(time)) < 3000) | (np.arange(len(time)) >= 4000)
    result = RippleFilter(configured(orders=[2, 4])).process(
        time[keep], angle[keep], (true + ripple)[keep]
    )
    error = (result.ripple_Nm - ripple[keep])[2800:]
    assert np.abs(error[:1200]).max() < 0.06
    missing = np.flatnonzero(has(result.status, StatusFlag.samples_missing))
    np.testing.assert_array_equal(missing, [3000])
    assert not (result.status & FAULTS).any()


def test_stamps_that_are_older_are_refused_named_and_forgotten():
    time, angle, true, ripple = driving()
    y = true + ripple
    config = configured(orders=[2, 4])
    bad = time.copy()
    bad[2000] = bad[1999]  # the same
    bad[2500] = 3.0  # older
    bad[3000] = np.nan
    bad[3500] = -np.inf
    ours = RippleFilter(config)
    result = ours.process(bad, angle, y)
    late = has(result.status, StatusFlag.sample_out_of_order)
    np.testing.assert_array_equal(np.flatnonzero(late), [2000, 2500])
    unknown = has(result.status, StatusFlag.time_not_finite)
    np.testing.assert_array_equal(np.flatnonzero(unknown), [3000, 3500])
    np.testing.assert_array_equal(np.flatnonzero(result.status & FAULTS), [2000, 2500, 3000, 3500])
    for k in (2000, 2500, 3000, 3500):
        assert result.torque_Nm[k] == result.torque_Nm[k - 1]
    # A refused row is a row that was not there.
    there = np.setdiff1d(np.arange(len(time)), [2000, 2500, 3000, 3500])
    without = RippleFilter(config).process(time[there], angle[there], y[there])
    np.testing.assert_array_equal(result.ripple_Nm[there], without.ripple_Nm)
    assert ours.counters["sample_out_of_order"] == ours.counters["time_not_finite"] == 2
    assert ours.counters["faults"] == 4
    assert ours.counters["samples"] == len(time)


def test_a_clock_that_is_set_back_is_followed_after_ten_rows():
    time, angle, true, ripple = driving()
    set_back = np.where(np.arange(len(time)) < 3000, time, time - 50.0)
    result = RippleFilter(configured(orders=[2, RippleOrder(4, with_speed=True)])).process(
        set_back, angle, true + ripple
    )
    late = has(result.status, StatusFlag.sample_out_of_order)
    np.testing.assert_array_equal(np.flatnonzero(late), np.arange(3000, 3010))
    assert has(result.status[3010], StatusFlag.samples_missing)
    assert not (result.status[3010:] & FAULTS).any()
    # The step back is as long as the rows that were refused: no leap of the speed, none of the ripple.
    assert np.abs((result.ripple_Nm - ripple)[3010:]).max() < 0.1


@pytest.mark.parametrize(("stamp_s", "first_refused"), [(1e9, 3000), (9e5, 3001)])
def test_one_stamp_of_the_far_future_costs_eleven_rows(stamp_s, first_refused):
    """Beyond 1e6 s the interval itself is refused; then the clock is 'set back' in any case."""
    time, angle, true, ripple = driving()
    time[3000] = stamp_s
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, true + ripple)
    refused = np.flatnonzero(result.status & FAULTS)
    np.testing.assert_array_equal(refused, np.arange(first_refused, 3011))
    unknown = np.flatnonzero(has(result.status, StatusFlag.time_not_finite))
    np.testing.assert_array_equal(unknown, [3000] if first_refused == 3000 else [])
    assert np.abs((result.ripple_Nm - ripple)[3011:]).max() < 0.1


def test_a_log_that_begins_without_time_loses_no_good_row():
    time, angle, true, ripple = driving(2000)
    time[:3] = np.nan
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, true + ripple)
    np.testing.assert_array_equal(
        np.flatnonzero(has(result.status, StatusFlag.time_not_finite)), [0, 1, 2]
    )
    np.testing.assert_array_equal(np.flatnonzero(result.status & FAULTS), [0, 1, 2])


def test_constant_time_changes_nothing():
    _, angle, true, ripple = driving(500)
    ours = RippleFilter(configured(orders=[2]))
    result = ours.process(np.full(500, 7.0), angle, true + ripple)
    assert has(result.status[1:], StatusFlag.sample_out_of_order).all()
    assert (result.torque_Nm == result.torque_Nm[0]).all()
    np.testing.assert_array_equal(ours.state()[0][1:], [0.0, 0.0])


@pytest.mark.parametrize(
    "orders",
    [[2, 4], [2, RippleOrder(4, with_speed=True)], [RippleOrder(2, with_load=True), 4]],
    ids=["constant", "speed", "load"],
)
@pytest.mark.parametrize("delay_s", [0.0, 0.0063])
def test_held_rows_count_once(orders, delay_s):
    """Three rows of four repeat the last: as if they were not there."""
    time, angle, true, ripple = driving(4000, dt=4e-3)
    y = true + ripple
    config = configured(orders=orders, angle_to_torque_delay_s=delay_s)
    start = 500  # before, nothing repeats: the first rows do not know yet that the motor turns
    fine = np.arange(4 * (len(time) - start))
    held_time = np.concatenate([time[:start], time[start] + fine * 1e-3])
    row = np.concatenate([np.arange(start), start + fine // 4])
    ours = RippleFilter(config)
    held = ours.process(held_time, angle[row], y[row])
    alone = RippleFilter(config).process(time, angle, y)
    fresh = np.concatenate([[True], np.diff(row) > 0])
    np.testing.assert_array_equal(has(held.status, StatusFlag.sample_repeated), ~fresh)
    assert ours.counters["sample_repeated"] == 3 * (len(time) - start)
    assert np.abs(held.ripple_Nm[fresh] - alone.ripple_Nm).max() < 1e-9
    for k in range(1, 4):
        again = held.torque_Nm[start + k :: 4]
        np.testing.assert_array_equal(again, held.torque_Nm[start::4][: len(again)])


def test_equal_torques_of_a_coarse_converter_are_not_held_rows():
    time, angle, true, ripple = driving()
    coarse = np.round((true + ripple) / 2.0) * 2.0
    assert (np.diff(coarse) == 0).mean() > 0.5
    result = RippleFilter(configured(orders=[2, 4])).process(time, angle, coarse)
    assert not has(result.status, StatusFlag.sample_repeated).any()


def test_standing_with_the_same_torque_is_not_held():
    n = 1000
    result = RippleFilter(configured(orders=[2])).process(
        np.arange(n) * 1e-3, np.full(n, 3.0), np.full(n, 5.0)
    )
    assert not (result.status & FAULTS).any()
    assert has(result.status, StatusFlag.at_rest).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_chunks_equal_one_call_to_the_last_bit(dtype):
    time, angle, torque, expected = busy_day()
    time, angle = time.copy(), angle.copy()
    torque, expected = torque.astype(dtype), expected.astype(dtype)
    torque[[100, 999, 1000, 2500]] = np.nan
    angle[[1200, 1201]] = np.nan
    time[3000] = time[2990]
    config = configured(orders=STRUCTURES["load and speed"], angle_to_torque_delay_s=0.0023)
    whole = RippleFilter(config, dtype=dtype)
    one = whole.process(time, angle, torque, expected_torque_Nm=expected)
    pieces = RippleFilter(config, dtype=dtype)
    cuts = [0, 1, 1, 17, 1000, 1001, 1201, 3000, 6001, len(time)]
    parts = [
        pieces.process(time[a:b], angle[a:b], torque[a:b], expected_torque_Nm=expected[a:b])
        for a, b in itertools.pairwise(cuts)
    ]
    for name in vars(one):
        joined = np.concatenate([getattr(part, name) for part in parts])
        assert joined.tobytes() == getattr(one, name).tobytes(), name
    assert pieces.counters == whole.counters


# ---- faults --------------------------------------------------------------------------------------

WILD = [np.nan, np.inf, -np.inf, 1e30, -1e30, 1e300, 5e-324, 0.0, -3.0]


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.integers(0, 1999),
            st.integers(1, 30),
            st.sampled_from(["time", "angle", "torque", "expected"]),
            st.sampled_from(WILD),
        ),
        min_size=1,
        max_size=25,
    ),
    st.sampled_from([np.float32, np.float64]),
    st.sampled_from([0.0, 0.0023, 0.05, -0.004]),
)
def test_wild_numbers_are_survived(faults, dtype, delay_s):
    n = 12000
    time = np.arange(n) * 1e-3
    angle = 150.0 * time
    ripple = 2.0 * np.cos(2 * (angle - 150.0 * delay_s))
    orders = [RippleOrder(2, with_load=True, with_speed=True), RippleOrder(4, with_direction=True)]
    config = configured(orders=orders, memory_turns=10, angle_to_torque_delay_s=delay_s)
    with np.errstate(over="ignore"):
        arrays = {
            "time": time.copy(),
            "angle": angle.copy(),
            "torque": ripple.astype(dtype),
            "expected": np.zeros(n, dtype),
        }
        for at, count, name, value in faults:
            arrays[name][at : at + count] = value
    ours = RippleFilter(config, dtype=dtype)
    result = ours.process(
        arrays["time"], arrays["angle"], arrays["torque"], expected_torque_Nm=arrays["expected"]
    )
    for name in vars(result):
        assert np.isfinite(getattr(result, name)).all(), name
    states, covariance = ours.state()
    assert np.isfinite(states).all()
    assert np.linalg.eigvalsh(covariance)[0] > -1e-6 * covariance.max()
    # 10 s, 240 turns, 24 memories later nothing is left of it.
    assert np.abs(result.ripple_Nm - ripple)[-500:].max() < 0.02
    assert ours.counters["samples"] == n


def test_faults_have_their_flags_and_hold_the_torque():
    time, angle, true, ripple = driving()
    y = true + ripple
    expected = np.zeros_like(y)
    y[1000:1003] = [np.nan, np.inf, -1e30]
    expected[1500:1502] = [np.nan, 1e30]
    angle[2000:2003] = [np.nan, np.inf, 1e30]
    angle[3000] += 500.0
    result = RippleFilter(configured(orders=[2, 4])).process(
        time, angle, y, expected_torque_Nm=expected
    )
    flagged = {
        StatusFlag.torque_not_finite: [1000, 1001, 1002],
        StatusFlag.expected_torque_not_finite: [1500, 1501],
        StatusFlag.rotation_invalid: [2000, 2001, 2002, 3000, 3001],
    }
    for flag, rows in flagged.items():
        np.testing.assert_array_equal(np.flatnonzero(has(result.status, flag)), rows)
    assert (result.torque_Nm[1000:1003] == result.torque_Nm[999]).all()
    every = sorted(itertools.chain.from_iterable(flagged.values()))
    assert (result.innovation_Nm[every] == 0).all()
    assert (result.innovation_variance_Nm2[every] == 0).all()
    assert (result.innovation_variance_Nm2[4000:] > NOISE_Nm**2).all()
    # Without an angle for three samples the ripple goes on at the last speed.
    assert np.abs((result.ripple_Nm - ripple)[2000:2003]).max() < 0.06
    assert np.abs((result.ripple_Nm - ripple)[3002:]).max() < 0.06


def test_without_any_angle_nothing_is_removed():
    time, angle, true, ripple = driving(2000)
    y = true + ripple
    ours = RippleFilter(configured(orders=[2, 4]))
    result = ours.process(time, np.full_like(angle, np.nan), y)
    np.testing.assert_array_equal(result.torque_Nm, y)
    assert (result.ripple_Nm == 0).all()
    assert has(result.status, StatusFlag.rotation_invalid).all()
    # and when the angle comes, it is learned as from the start
    time2, angle2, true2, ripple2 = driving(8000)
    late = ours.process(time2 + 2.0, angle2, true2 + ripple2)
    assert np.abs((late.ripple_Nm - ripple2)[6000:]).max() < 0.06


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_stuck_torque_is_forgotten(dtype):
    """Two seconds at the rail of a converter: back within a few memories, and bounded meanwhile."""
    time, angle, true, ripple = driving(30000)
    y = (true + ripple).astype(dtype)
    y[8000:10000] = 60.0
    config = configured(orders=[2, 4], memory_turns=20)
    result = RippleFilter(config, dtype=dtype).process(time, angle, y)
    turns = (angle - angle[10000]) / (2 * np.pi)
    error = np.abs(result.ripple_Nm - ripple)
    assert error[:10000][8000:].max() < 10
    assert error[turns > 8 * 20].max() < 0.1
    assert error[7000:8000].max() < 0.1


def test_an_outlier_does_not_shake_the_ripple():
    """The weight: at most 3 scales of an innovation reach the coefficients."""
    time, angle, true, ripple = driving()
    clean = RippleFilter(configured(orders=[2, 4])).process(time, angle, true + ripple)
    y = true + ripple
    y[4000] += 50.0
    spiked = RippleFilter(configured(orders=[2, 4])).process(time, angle, y)
    shaken = np.abs(spiked.ripple_Nm - clean.ripple_Nm)[4001:].max()
    # One sample of 3 scales, 0.2 to 0.5 Nm, through a gain of about 2 dtheta / (2 pi n) an order;
    # T's own answer to the spike, which all samples after it see, is weighted alike.
    assert 1e-5 < shaken < 0.05


# ---- capacity, keep, frozen terms, learned -------------------------------------------------------


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("orders", [[2, 4], [RippleOrder(2, with_load=True, with_speed=True)]])
def test_capacity_does_not_change_a_bit(orders, dtype):
    time, angle, torque, expected = busy_day()
    results = []
    for least, capacity in ((1, 3), (4, 8), (9, 32)):
        ours = RippleFilter(
            configured(orders=orders, frozen=[FrozenTerm(1, cosine_Nm=1, sine_Nm=2)]),
            dtype=dtype,
            least_capacity=least,
        )
        assert ours.capacity == capacity
        results.append(
            ours.process(
                time, angle, torque.astype(dtype), expected_torque_Nm=expected.astype(dtype)
            )
        )
    for other in results[1:]:
        for name in vars(other):
            assert getattr(other, name).tobytes() == getattr(results[0], name).tobytes()


def test_a_kept_order_is_learned_and_left_in():
    time, angle, torque, _ = busy_day()
    removing = RippleFilter(configured(orders=[2, 4]))
    keeping = RippleFilter(configured(orders=[RippleOrder(2, keep=True), 4]))
    both = [f.process(time, angle, torque) for f in (removing, keeping)]
    assert np.abs(removing.state()[0] - keeping.state()[0]).max() < 1e-11
    assert np.abs(both[0].innovation_Nm - both[1].innovation_Nm).max() < 1e-11
    assert np.abs(both[0].torque_all_removed_Nm - both[1].torque_all_removed_Nm).max() < 1e-11
    np.testing.assert_array_equal(both[0].torque_Nm, both[0].torque_all_removed_Nm)
    stays = both[1].torque_Nm - both[1].torque_all_removed_Nm
    amplitude = np.sqrt(2 * np.mean(stays[1000:1500] ** 2))
    assert amplitude == pytest.approx(1.6, abs=0.4)


def test_frozen_terms_are_their_formula_and_wait_for_a_reference():
    time, angle, true, _ = driving(3000)
    terms = [
        FrozenTerm(Fraction(1, 100), cosine_Nm=2.0, sine_Nm=-1.0),
        FrozenTerm(3, cosine_Nm=0, sine_Nm=0.5),
    ]
    formula = 2 * np.cos(angle / 100) - np.sin(angle / 100) + 0.5 * np.sin(3 * angle)
    plain = RippleFilter(configured(orders=[2])).process(time, angle, true)
    frozen = RippleFilter(configured(orders=[2], frozen=terms))
    result = frozen.process(time, angle, true + formula)
    assert np.abs(result.ripple_Nm - plain.ripple_Nm - formula).max() < 1e-7
    assert np.abs(result.torque_Nm - plain.torque_Nm).max() < 1e-7
    waiting = RippleFilter(configured(orders=[2], frozen=terms))
    result = waiting.process(time, angle, true, angle_referenced=False)
    np.testing.assert_array_equal(result.ripple_Nm, plain.ripple_Nm)


def test_power_up_with_kept_coefficients_is_clean():
    time, angle, true, ripple = driving(20000)
    config = configured(orders=[2, 4])
    before = RippleFilter(config)
    before.process(time, angle, true + ripple)
    kept = before.learned()
    rng = np.random.default_rng(3)
    for at in (0.3, 1.0, 2.2):
        here = 1.6 * np.cos(2 * at + 0.3) + 0.6 * np.sin(4 * at)
        y = here + NOISE_Nm * rng.standard_normal(500)
        standing = (np.arange(500) * 1e-3, np.full(500, at), y)
        restored = RippleFilter(config, learned=kept).process(*standing)
        assert np.abs(restored.ripple_Nm - here).max() < 0.01 * 2.2
        fresh = RippleFilter(config).process(*standing)
        assert np.abs(fresh.ripple_Nm).max() == 0.0


def test_learned_round_trip():
    time, angle, torque, _ = busy_day()
    config = configured(orders=STRUCTURES["load and speed"])
    ours = RippleFilter(config)
    ours.process(time, angle, torque)
    kept = ours.learned()
    states, covariance = ours.state()
    np.testing.assert_array_equal(kept.coefficients_Nm, states[1:])
    np.testing.assert_allclose(
        kept.standard_deviations_Nm, np.sqrt(np.diag(covariance))[1:], rtol=1e-15
    )
    assert kept.orders == config.orders
    again = LearnedRipple(
        orders=kept.orders,
        coefficients_Nm=kept.coefficients_Nm,
        standard_deviations_Nm=kept.standard_deviations_Nm,
        innovation_scale_Nm=kept.innovation_scale_Nm,
    )
    twin = RippleFilter(config, learned=again)
    other = twin.learned()
    np.testing.assert_array_equal(other.coefficients_Nm, kept.coefficients_Nm)
    np.testing.assert_allclose(
        other.standard_deviations_Nm, kept.standard_deviations_Nm, rtol=1e-14
    )
    assert other.innovation_scale_Nm == kept.innovation_scale_Nm
    twin.process(time, angle, torque)
    twin.reset()
    np.testing.assert_array_equal(twin.learned().coefficients_Nm, kept.coefficients_Nm)


def test_coefficients_of_other_orders_are_refused():
    kept = RippleFilter(configured(orders=[2, 4])).learned()
    for orders in ([2], [4, 2], [2, 4, 6], [2, RippleOrder(4, with_load=True)], [2, 5]):
        with pytest.raises(ConfigurationError, match=r"learned\.orders"):
            RippleFilter(configured(orders=orders), learned=kept)
    for bad in ([np.nan, 0, 0, 0], [np.inf, 0, 0, 0], [0, 2e9, 0, 0]):
        with pytest.raises(ConfigurationError, match=r"learned\.coefficients_Nm"):
            RippleFilter(
                configured(orders=[2, 4]),
                learned=LearnedRipple(
                    orders=[2, 4], coefficients_Nm=bad, standard_deviations_Nm=[1] * 4
                ),
            )
    with pytest.raises(ConfigurationError, match=r"learned\.standard_deviations_Nm"):
        RippleFilter(
            configured(orders=[2, 4]),
            learned=LearnedRipple(
                orders=[2, 4], coefficients_Nm=[1] * 4, standard_deviations_Nm=[1, 1, -1, 1]
            ),
        )
    with pytest.raises(InputError, match="coefficients_Nm"):
        LearnedRipple(orders=[2, 4], coefficients_Nm=[1] * 3, standard_deviations_Nm=[1] * 4)
    # A kept order is learned like any other.
    RippleFilter(configured(orders=[2, RippleOrder(4, keep=True)]), learned=kept)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_amplitude_and_phase_are_the_true_ones(dtype):
    time, angle, true, _ = driving(20000)
    for phase in (-3.0, -1.2, 0.0, 0.4, 2.5):
        y = true + 1.6 * np.cos(2 * angle - phase) + 0.6 * np.cos(4 * angle + phase)
        ours = RippleFilter(configured(orders=[2, 4]), dtype=dtype)
        ours.process(time, angle, y.astype(dtype))
        amplitude, measured = ours.order_ripple()
        np.testing.assert_allclose(amplitude, [1.6, 0.6], atol=0.02)
        np.testing.assert_allclose(measured, [phase, -phase], atol=0.03)


def test_amplitude_is_that_of_the_present_load():
    time = np.arange(30000) * 1e-3
    angle = counts(120 * time)
    load = 20 * np.sin(0.5 * time)
    load[25000:] = 15.0
    y = load + (1.6 + 0.8 * flattened(load)) * np.cos(2 * angle)
    ours = RippleFilter(configured(orders=[RippleOrder(2, with_load=True)]))
    ours.process(time, angle, y)
    assert ours.order_ripple()[0][0] == pytest.approx(1.6 + 0.8 * flattened(15.0), abs=0.02)


# ---- covariance ----------------------------------------------------------------------------------


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_steady_load_neither_resets_nor_drifts(dtype):
    """A load pair at constant load is not seen: its variance is limited, its sum with c stays."""
    rng = np.random.default_rng(7)
    samples = 1_000_000
    time = np.arange(samples) * 1e-3
    angle = counts(156 * time)
    ripple = 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)
    y = (12.0 + ripple + NOISE_Nm * rng.standard_normal(samples)).astype(dtype)
    orders = [RippleOrder(k, with_load=True, with_speed=True) for k in (2, 4)]
    ours = RippleFilter(configured(orders=orders), dtype=dtype)
    result = ours.process(time, angle, y)
    assert ours.counters["covariance_reset"] == 0
    error = result.ripple_Nm - ripple
    early, late = (
        np.sqrt(np.mean(error[a:b] ** 2))
        for a, b in ((1e5, 2e5), (9e5, 1e6))
        for a, b in [(int(a), int(b))]
    )
    assert late == pytest.approx(early, rel=0.25)
    assert abs(error[900000:].mean()) < 1e-3
    states, covariance = ours.state()
    assert np.abs(states[1:]).max() < 10
    assert np.linalg.eigvalsh(covariance)[0] > 0
    assert (np.diag(covariance)[1:] <= 4.0 * (1 + 1e-6)).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_covariance_stays_positive_definite_through_stops_and_starts(dtype):
    rng = np.random.default_rng(17)
    samples = 200_000
    time = np.arange(samples) * 1e-3
    speed = 150 * np.sign(np.sin(0.3 * time)) * (np.sin(1.1 * time) > 0)
    angle = angle_of(speed, time)
    y = 5 * np.sin(0.2 * time) + np.cos(2 * angle) + NOISE_Nm * rng.standard_normal(samples)
    orders = [RippleOrder(k, with_load=True, with_speed=True, with_direction=True) for k in (2, 4)]
    ours = RippleFilter(configured(orders=orders, memory_turns=5), dtype=dtype)
    for begin in range(0, samples, 1000):
        cut = slice(begin, begin + 1000)
        ours.process(time[cut], angle[cut], y[cut].astype(dtype))
        np.linalg.cholesky(ours.state()[1])
    assert ours.counters["covariance_reset"] == 0


# ---- configuration -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "bad", "good"),
    [
        ("memory_turns", [0.09, 1.1e6], [0.1, 1e6]),
        ("torque_noise_Nm", [0, -1, 1.1e9], [1e-8, 1e9]),
        ("torque_walk_Nm_per_sqrt_s", [0, 1.1e9], [1e-8, 1e9]),
        ("initial_amplitude_Nm", [0, 1.1e9], [1e-8, 1e9]),
        ("rated_torque_Nm", [0, -40, 1.1e9], [1e-8, 1e9]),
        ("reference_speed_rad_s", [0, 1.1e6], [1, 1e6]),
        ("angle_to_torque_delay_s", [-0.0051, 0.051], [-0.005, 0.05]),
        ("minimum_speed_rad_s", [-0.1, 101], [0, 100]),
    ],
)
def test_every_parameter_has_its_range(name, bad, good):
    for value in [*bad, np.nan, np.inf, -np.inf]:
        with pytest.raises(ConfigurationError, match=rf"^{name} = .*: expected a number from"):
            RippleFilterConfig(orders=[2], **{name: value})
    for value in good:
        config = RippleFilterConfig(orders=[2], **{name: value})
        assert getattr(config, name) == pytest.approx(value, rel=1e-6)
        for dtype in (np.float64, np.float32):
            RippleFilter(config, dtype=dtype)


def test_orders_and_frozen_terms_are_checked():
    for orders, message in (
        ([], "orders"),
        ([2, 2], "each order once"),
        ([2, Fraction(4, 2)], "each order once"),
        ([1001], "at most 1000"),
        (list(range(1, 34)), "orders"),
        ([RippleOrder(k, with_load=True) for k in range(1, 18)], "orders"),
    ):
        with pytest.raises((ConfigurationError, InputError), match=message):
            RippleFilterConfig(orders=orders)
    for order in (0, -2, np.nan, "two"):
        with pytest.raises(InputError, match="order"):
            RippleOrder(order)
    with pytest.raises((ConfigurationError, InputError), match="frozen"):
        RippleFilterConfig(orders=[2], frozen=[FrozenTerm(1, cosine_Nm=1, sine_Nm=0)] * 9)
    with pytest.raises((ConfigurationError, InputError), match="frozen"):
        RippleFilterConfig(orders=[2], frozen=[3])
    for bad in (np.nan, np.inf, 2e9):
        with pytest.raises(ConfigurationError, match=r"frozen\[0\] = .* Nm"):
            RippleFilterConfig(orders=[2], frozen=[FrozenTerm(1, cosine_Nm=bad, sine_Nm=0)])
    assert len(RippleFilterConfig(orders=list(range(1, 33))).orders) == 32


def test_configuration_says_what_it_is():
    config = RippleFilterConfig(
        orders=[2, RippleOrder(Fraction(7, 2), with_load=True, keep=True)],
        frozen=[FrozenTerm(Fraction(1, 100), cosine_Nm=0.5, sine_Nm=-0.25)],
    )
    assert "memory_turns=10" in repr(config)
    assert [float(o.order) for o in config.orders] == [2, 3.5]
    assert [o.keep for o in config.orders] == [False, True]
    assert config.frozen[0].sine_Nm == -0.25


def test_wrong_arguments_are_named():
    config = RippleFilterConfig(orders=[2])
    with pytest.raises(InputError, match="RippleFilterConfig"):
        RippleFilter({"orders": [2]})
    with pytest.raises(InputError, match="LearnedRipple"):
        RippleFilter(config, learned=[1, 2])
    with pytest.raises(InputError, match="least_capacity"):
        RippleFilter(config, least_capacity=33)
    ours = RippleFilter(config)
    good = np.zeros(5)
    for arrays, name in (
        ((np.zeros(4), good, good), "time_s"),
        ((good, np.zeros(4), good), "motor_angle_rad"),
        ((good, good, np.zeros((5, 1))), "torque_Nm"),
    ):
        with pytest.raises(InputError, match=name):
            ours.process(*arrays)
    with pytest.raises(InputError, match="expected_torque_Nm"):
        ours.process(good, good, good, expected_torque_Nm=np.zeros(4))


def test_a_copy_goes_its_own_way():
    time, angle, torque, _ = busy_day()
    ours = RippleFilter(RippleFilterConfig(orders=[2, 4]))
    ours.process(time[:3000], angle[:3000], torque[:3000])
    twin = ours.copy()
    before = ours.state()[0].copy()
    there = twin.process(time[3000:], angle[3000:], torque[3000:])
    np.testing.assert_array_equal(ours.state()[0], before)
    here = ours.process(time[3000:], angle[3000:], torque[3000:])
    assert here.ripple_Nm.tobytes() == there.ripple_Nm.tobytes()
