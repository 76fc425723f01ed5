"""How a test station is driven: profiles of speed, current or torque over time.

A profile is a continuous function of time with its exact slope and integral, so that angle, speed
and acceleration of one run belong together to rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from strainwave.errors import ConfigurationError
from strainwave.simulate.checks import require_increasing, require_length, require_number

FloatArray = NDArray[np.float64]

LARGEST = 1e6
"""Largest speed, current or torque of a profile: far beyond any drive, and no square overflows."""


@runtime_checkable
class Profile(Protocol):
    """A quantity over time: speed in rad/s, current in A or torque in Nm."""

    def value(self, time_s: FloatArray) -> FloatArray:
        """Return the quantity at the given times."""
        ...

    def slope(self, time_s: FloatArray) -> FloatArray:
        """Return the quantity's rate of change at the given times, per second."""
        ...

    def integral(self, time_s: FloatArray) -> FloatArray:
        """Return the quantity integrated from time 0 to the given times, times seconds."""
        ...


def require_profile(parameter: str, given: object) -> None:
    """Refuse what is no profile over time.

    Parameters
    ----------
    parameter : str
        Name of the parameter, for the message.
    given : object
        What was given.
    """
    if isinstance(given, type) or not isinstance(given, Profile):
        raise ConfigurationError(
            parameter,
            given,
            "",
            "a profile over time",
            "give a constant as PiecewiseLinear((0.0,), (value,))",
        )


@dataclass(frozen=True)
class PiecewiseLinear:
    """Straight lines between points, constant before the first and after the last.

    Parameters
    ----------
    times_s : tuple of float
        Times of the points, increasing, the first at 0 or later.
    values : tuple of float
        Values at these times: rad/s, A or Nm.
    """

    times_s: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        for time in self.times_s:
            require_number("times_s", time, "s", minimum=0.0)
        require_increasing("times_s", self.times_s, "s")
        require_length("values", self.values, max(len(self.times_s), 1), "one a point")
        for value in self.values:
            require_number("values", value, "", minimum=-LARGEST, maximum=LARGEST)

    def value(self, time_s: FloatArray) -> FloatArray:
        """Return the quantity at the given times."""
        return np.asarray(np.interp(time_s, self.times_s, self.values), dtype=np.float64)

    def slope(self, time_s: FloatArray) -> FloatArray:
        """Return the slope; at a corner that of the piece that begins there."""
        times = np.array(self.times_s)
        pieces = np.diff(np.array(self.values)) / np.diff(times)
        slopes = np.concatenate(([0.0], pieces, [0.0]))
        return np.asarray(slopes[np.searchsorted(times, time_s, side="right")])

    def integral(self, time_s: FloatArray) -> FloatArray:
        """Return the integral from time 0, exact for straight pieces."""
        times = np.array(self.times_s)
        values = np.array(self.values)
        if times[0] > 0:
            times, values = np.insert(times, 0, 0.0), np.insert(values, 0, values[0])
        area = np.concatenate(([0.0], np.cumsum(np.diff(times) * (values[1:] + values[:-1]) / 2)))
        piece = np.clip(np.searchsorted(times, time_s, side="right") - 1, 0, len(times) - 1)
        since = time_s - times[piece]
        now = np.interp(time_s, times, values)
        return np.asarray(area[piece] + since * (values[piece] + now) / 2)


@dataclass(frozen=True)
class Sine:
    """A sine: amplitude sin(2 pi frequency time + phase) + offset, from the start on.

    Parameters
    ----------
    amplitude : float
        Amplitude, rad/s, A or Nm.
    frequency_Hz : float
        Frequency, above 0.
    phase_rad : float
        Phase at time 0.
    offset : float
        Mean value, in the unit of the amplitude.
    """

    amplitude: float
    frequency_Hz: float
    phase_rad: float = 0.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        require_number("amplitude", self.amplitude, "", minimum=-LARGEST, maximum=LARGEST)
        require_number("frequency_Hz", self.frequency_Hz, "Hz", above=0.0)
        require_number("phase_rad", self.phase_rad, "rad")
        require_number("offset", self.offset, "", minimum=-LARGEST, maximum=LARGEST)

    def _angle(self, time_s: FloatArray) -> FloatArray:
        return 2 * math.pi * self.frequency_Hz * time_s + self.phase_rad

    def value(self, time_s: FloatArray) -> FloatArray:
        """Return the quantity at the given times."""
        return np.asarray(self.amplitude * np.sin(self._angle(time_s)) + self.offset)

    def slope(self, time_s: FloatArray) -> FloatArray:
        """Return the slope at the given times."""
        rate = 2 * math.pi * self.frequency_Hz
        return np.asarray(self.amplitude * rate * np.cos(self._angle(time_s)))

    def integral(self, time_s: FloatArray) -> FloatArray:
        """Return the integral from time 0."""
        rate = 2 * math.pi * self.frequency_Hz
        swing = math.cos(self.phase_rad) - np.cos(self._angle(time_s))
        return np.asarray(self.amplitude / rate * swing + self.offset * time_s)


@dataclass(frozen=True)
class Chirp:
    """A sine whose frequency rises linearly between two times; zero outside them.

    Parameters
    ----------
    amplitude : float
        Amplitude, rad/s, A or Nm.
    start_Hz, end_Hz : float
        Frequency at the start and at the end, at least 0.
    start_s, end_s : float
        When it starts and ends.
    """

    amplitude: float
    start_Hz: float
    end_Hz: float
    start_s: float
    end_s: float

    def __post_init__(self) -> None:
        require_number("amplitude", self.amplitude, "", minimum=-LARGEST, maximum=LARGEST)
        require_number("start_Hz", self.start_Hz, "Hz", minimum=0.0)
        require_number("end_Hz", self.end_Hz, "Hz", minimum=0.0)
        require_number("start_s", self.start_s, "s", minimum=0.0)
        require_number("end_s", self.end_s, "s", above=self.start_s)

    def _parts(self, time_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        since = time_s - self.start_s
        sweep = (self.end_Hz - self.start_Hz) / (self.end_s - self.start_s)
        inside = ((since >= 0) & (time_s < self.end_s)).astype(np.float64)
        angle = 2 * np.pi * (self.start_Hz * since + sweep * since**2 / 2)
        return inside, angle, 2 * np.pi * (self.start_Hz + sweep * since)

    def value(self, time_s: FloatArray) -> FloatArray:
        """Return the quantity at the given times."""
        inside, angle, _ = self._parts(time_s)
        return np.asarray(self.amplitude * inside * np.sin(angle))

    def slope(self, time_s: FloatArray) -> FloatArray:
        """Return the slope at the given times."""
        inside, angle, rate = self._parts(time_s)
        return np.asarray(self.amplitude * inside * rate * np.cos(angle))

    def integral(self, time_s: FloatArray) -> FloatArray:
        """Return the integral from time 0, by trapezoids of at most a hundredth of a cycle."""
        fastest = max(self.start_Hz, self.end_Hz, 1.0 / (self.end_s - self.start_s))
        count = math.ceil((self.end_s - self.start_s) * fastest * 100) + 1
        fine = np.linspace(self.start_s, self.end_s, count)
        values = self.amplitude * np.sin(self._parts(fine)[1])
        area = np.concatenate(([0.0], np.cumsum((values[1:] + values[:-1]) / 2 * np.diff(fine))))
        return np.asarray(np.interp(time_s, fine, area))


@dataclass(frozen=True)
class Sum:
    """Several profiles at once: a step and a chirp, a ramp and a sine.

    Parameters
    ----------
    parts : tuple of Profile
        What is added up; none is zero at all times.
    """

    parts: tuple[Profile, ...]

    def value(self, time_s: FloatArray) -> FloatArray:
        """Return the quantity at the given times."""
        return np.asarray(sum((part.value(time_s) for part in self.parts), np.zeros(time_s.shape)))

    def slope(self, time_s: FloatArray) -> FloatArray:
        """Return the slope at the given times."""
        return np.asarray(sum((part.slope(time_s) for part in self.parts), np.zeros(time_s.shape)))

    def integral(self, time_s: FloatArray) -> FloatArray:
        """Return the integral from time 0."""
        zero = np.zeros(time_s.shape)
        return np.asarray(sum((part.integral(time_s) for part in self.parts), zero))


NOTHING = Sum(())
"""Zero at all times: standstill, no contact."""
