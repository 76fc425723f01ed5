"""Runs of the ripple filter for its tests, and its equations written anew in dense form."""

import math
from fractions import Fraction

import numpy as np

from strainwave import (
    RippleFilter,
    RippleFilterConfig,
    RippleOrder,
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

    def walk(self, h, turned, interval):
        """Process noise of the coefficients, after a sample: an order's over its squares in h.

        A pair gains the less, the less it is known; as little as in the beginning: nothing. The
        first pair of an order is judged by the ripple that all of them make.
        """
        c = self.config
        R, walk = c.torque_noise_Nm**2, c.torque_walk_Nm_per_sqrt_s**2
        # Over a gap the noise is that of the typical intervals in it.
        gap = self.typical > 0 and interval > 2 * self.typical
        pieces = interval / self.typical if gap else 1.0
        share = min(1.0, (turned / (2 * np.pi * c.memory_turns)) ** 2 / pieces)
        variances = np.diag(self.P)
        added = np.zeros(len(self.x))
        for a, order in enumerate(self.orders):
            arc = min(abs(order * turned) / pieces, np.pi)
            rows = np.flatnonzero(self.block == a)
            seen = np.sum(h[rows] ** 2)
            if arc == 0:
                continue
            each = 2 * share * (R + walk * interval / pieces / (4 * np.sin(arc / 2) ** 2)) / seen
            most = 2 * c.initial_amplitude_Nm**2
            for i in rows[2::2]:
                added[i : i + 2] = each * max(0.0, 1 - (variances[i] + variances[i + 1]) / most)
            factors = h[rows[0::2]] / h[rows[0]]
            ripple = sum(
                factors @ self.P[np.ix_(rows[side::2], rows[side::2])] @ factors for side in (0, 1)
            )
            added[rows[:2]] = each * max(0.0, 1 - ripple / (seen * most))
        self.P += np.diag(added)

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
                self.walk(h, turned, interval)
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


def driving(samples=6000, seed=9, dt=1e-3):
    rng = np.random.default_rng(seed)
    time = 100 + np.arange(samples) * dt
    angle = counts(150 * (time - 100) + 5 * np.sin(time))
    true = 5 * np.sin(2 * time) + NOISE_Nm * rng.standard_normal(samples)
    return time, angle, true, 1.6 * np.cos(2 * angle + 0.3) + 0.6 * np.sin(4 * angle)


WILD = [np.nan, np.inf, -np.inf, 1e30, -1e30, 1e300, 5e-324, 0.0, -3.0]
