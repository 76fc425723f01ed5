"""Numbers that count what is done with them, and both filters written with as little as is known."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np


@dataclass(frozen=True)
class Counted:
    """A number; sums, products and quotients of it are counted together."""

    value: float
    operations: ClassVar[int] = 0

    @staticmethod
    def of(value: Counted | float) -> float:
        return value.value if isinstance(value, Counted) else value

    def _done(self, value: float) -> Counted:
        Counted.operations += 1
        return Counted(value)

    def __add__(self, other: Counted | float) -> Counted:
        return self._done(self.value + self.of(other))

    def __sub__(self, other: Counted | float) -> Counted:
        return self._done(self.value - self.of(other))

    def __mul__(self, other: Counted | float) -> Counted:
        return self._done(self.value * self.of(other))

    def __truediv__(self, other: Counted | float) -> Counted:
        return self._done(self.value / self.of(other))

    def inverse(self) -> Counted:
        return self._done(1.0 / self.value)


def counted(values: np.ndarray | list[float]) -> list[Counted]:
    return [Counted(float(each)) for each in values]


def cos_sin(angle: Counted) -> tuple[Counted, Counted]:
    """Reduce to an eighth of a turn and take four terms of each series, as float needs.

    The values are exact: it is the operations that are of interest.
    """
    before = Counted.operations
    quarters = angle * (2 / math.pi) + 0.5  # the rounding itself counts as one
    rest = angle - quarters * (math.pi / 2)
    square = rest * rest
    series = square * 1.0 + 1.0
    for _ in range(2):
        series = series * square + 1.0
    _ = rest + rest * square * series  # sine
    series = square * 1.0 + 1.0
    for _ in range(2):
        series = series * square + 1.0
    _ = series * square + 1.0  # cosine
    assert Counted.operations - before > 15
    return Counted(math.cos(angle.value)), Counted(math.sin(angle.value))


def times(a: tuple[Counted, Counted], b: tuple[Counted, Counted]) -> tuple[Counted, Counted]:
    """Turn one wave on by another."""
    return a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]


class LeanPublished:
    """The published filter in a frame that turns with it: P stands still but for the update."""

    def __init__(self) -> None:
        self.x = counted(np.zeros(6))
        self.p = [counted(1e3 * np.eye(6)[i]) for i in range(6)]
        self.waves = [(Counted(1.0), Counted(0.0)) for _ in range(2)]  # order 2 and 1/100

    def step(self, torque: float, speed: float) -> float:
        double = self.waves[0]
        fourth = (
            double[0] * double[0] - double[1] * double[1],
            (double[0] * double[1]) * 2.0,
        )
        row = [*double, *fourth, *self.waves[1]]
        ripple = row[0] * self.x[0]
        for i in range(1, 6):
            ripple = ripple + row[i] * self.x[i]
        innovation = Counted(torque) - ripple
        seen = []
        for i in range(6):
            total = self.p[max(i, 0)][0] * row[0]
            for j in range(1, 6):
                total = total + self.p[max(i, j)][min(i, j)] * row[j]
            seen.append(total)
        variance = seen[0] * row[0] + 1.0
        for i in range(1, 6):
            variance = variance + seen[i] * row[i]
        inverse = variance.inverse()
        for i in range(6):
            gain = seen[i] * inverse
            self.x[i] = self.x[i] + gain * innovation
            for j in range(i + 1):
                self.p[i][j] = self.p[i][j] - gain * seen[j]
            self.p[i][i] = self.p[i][i] + 1e3
        turn = Counted(speed) * 1e-3
        self.waves = [
            times(wave, cos_sin(turn * order))
            for wave, order in zip(self.waves, (2.0, 0.01), strict=True)
        ]
        return ripple.value


class LeanDefault:
    """The default ripple filter with 15 states: one triangle of P, regressors of T all 1."""

    orders = (2.0, 4.0, 0.01)
    #: Pair by pair: which order, and times 1, load or speed.
    pairs = ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0))

    def __init__(self) -> None:
        self.x = counted(np.zeros(15))
        self.p = [counted(4.0 * np.eye(15)[i]) for i in range(15)]
        self.scale, self.load = Counted(0.12), Counted(0.0)
        self.speed, self.smoothed = Counted(0.0), Counted(0.0)
        self.waves: list[tuple[Counted, Counted]] = []
        self.angle, self.started = 0.0, False

    def step(self, torque: float, angle: float) -> float:
        rotation = Counted(angle - self.angle) if self.started else Counted(0.0)
        self.angle = angle
        now = rotation * 1e3
        self.speed = self.speed + (now - self.speed) * (1 / 11)
        self.smoothed = self.smoothed + (now - self.smoothed) * (1 / 51)
        moving = abs(self.smoothed.value) >= 2.0
        waves = [cos_sin(Counted(angle) * order) for order in self.orders[::2]]
        c, s = waves[0]
        waves.insert(1, (c * c - s * s, (c * s) * 2.0))
        share = self.load * (1 / 40)
        factors = [
            None,
            share / (Counted(abs(share.value)) + 1.0),
            Counted(abs(self.speed.value)) * (1 / 150),
        ]
        h = [Counted(1.0)]
        for order, kind in self.pairs:
            h += [w if factors[kind] is None else w * factors[kind] for w in waves[order]]
        ripple = h[1] * self.x[1]
        for i in range(2, 15):
            ripple = ripple + h[i] * self.x[i]
        rest = Counted(torque) - ripple
        if self.started:
            self._learn(h, waves, rotation, rest, moving)
            self.load = self.load + (rest - self.load) * (1e-3 / (1e-3 + 1 / (30 * math.pi)))
        else:
            self._start(h, rest)
        self.waves = waves
        return ripple.value

    def _start(self, h: list[Counted], rest: Counted) -> None:
        self.started, self.x[0], self.load = True, rest, rest
        for i in range(1, 15):
            self.p[i][0] = h[i] * -4.0
        self.p[0][0] = Counted(0.0016 + 4 * sum(each.value**2 for each in h[1:]))

    def _learn(self, h, waves, rotation: Counted, rest: Counted, moving: bool) -> None:
        self.p[0][0] = self.p[0][0] + 1.69e-3
        if moving:
            self._add_noise(waves, rotation, h)
        seen = []
        for i in range(15):
            total = self.p[i][0]
            for j in range(1, 15):
                total = total + self.p[max(i, j)][min(i, j)] * h[j]
            seen.append(total)
        variance = seen[0] + 0.0016
        of_ripple = (seen[1] - self.p[1][0]) * h[1]
        for i in range(1, 15):
            variance = variance + seen[i] * h[i]
            if i > 1:
                of_ripple = of_ripple + (seen[i] - self.p[i][0]) * h[i]
        innovation = rest - self.x[0]
        square = innovation * innovation
        limit = max(self.scale * self.scale, of_ripple, key=lambda each: each.value) * 9.0
        if not moving:
            gain = seen[0] / variance
            self.x[0] = self.x[0] + gain * innovation
            self.p[0][0] = self.p[0][0] - gain * seen[0] * 2.0 + gain * gain * variance
            for i in range(1, 15):
                self.p[i][0] = self.p[i][0] - gain * seen[i]
            return
        if square.value > limit.value:
            jump = (square / limit - 1.0) * variance
            self.p[0][0], seen[0], variance = self.p[0][0] + jump, seen[0] + jump, variance + jump
        inverse = variance.inverse()
        for i in range(15):
            gain = seen[i] * inverse
            self.x[i] = self.x[i] + gain * innovation
            for j in range(i + 1):
                self.p[i][j] = self.p[i][j] - gain * seen[j]
        beyond = float(abs(innovation.value) > self.scale.value)
        change = Counted(abs(rotation.value)) * (0.06 * (beyond - 0.3))
        self.scale = self.scale * ((change * 0.5 + 1.0) * change + 1.0)
        self.scale = max(self.scale, Counted(0.02), key=lambda each: each.value)

    def _add_noise(self, waves, rotation: Counted, h: list[Counted]) -> None:
        noise: list[Counted] = [Counted(0.0)] * 7
        share = rotation * rotation * (2 / (600 * math.pi) ** 2)
        # An order's wave has length 1: its regressors' squares are those of its factors.
        rate = h[3] * h[3] + h[4] * h[4] + h[5] * h[5] + h[6] * h[6] + 1.0
        for order, weight in enumerate((rate, rate, Counted(1.0))):
            cosine = waves[order][0] - self.waves[order][0]
            sine = waves[order][1] - self.waves[order][1]
            chord = cosine * cosine + sine * sine
            if chord.value == 0.0:
                continue
            gained = share * (Counted(1.69e-3) / chord + 0.0016) / weight
            for pair, (of, _) in enumerate(self.pairs):
                if of == order:
                    noise[pair] = gained
        for i in range(1, 15):
            if self.p[i][i].value > 4.0:
                shrink = math.sqrt(4.0 / self.p[i][i].value)
                for j in range(15):
                    self.p[max(i, j)][min(i, j)] = self.p[max(i, j)][min(i, j)] * shrink
                self.p[i][i] = self.p[i][i] * shrink
            self.p[i][i] = self.p[i][i] + noise[(i - 1) // 2]
