"""The data acquisition: when samples are taken, which arrive, and what encoders and tacho say."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.simulate.checks import require_integer, require_number
from strainwave.simulate.trajectories import FloatArray


@dataclass(frozen=True)
class Encoder:
    """An incremental encoder; its count is that of edges passed, rounded down.

    Parameters
    ----------
    counts_per_turn : int
        Counts per turn, at least 1.
    zero_rad : float
        Angle of the shaft at count 0.
    """

    counts_per_turn: int = 4096
    zero_rad: float = 0.0

    def __post_init__(self) -> None:
        require_integer("counts_per_turn", self.counts_per_turn, "", minimum=1, maximum=2**28)
        require_number("zero_rad", self.zero_rad, "rad")

    def counts(self, angle_rad: FloatArray) -> NDArray[np.int64]:
        """Return the counts at angles.

        Parameters
        ----------
        angle_rad : ndarray, shape (n,)
            Angle of the shaft, rad.

        Returns
        -------
        ndarray of int64, shape (n,)
            Counts.
        """
        turns = (angle_rad - self.zero_rad) / (2 * math.pi)
        return np.floor(turns * self.counts_per_turn).astype(np.int64)

    def angle_rad(self, counts: NDArray[np.int64]) -> FloatArray:
        """Return the angles that counts mean.

        Parameters
        ----------
        counts : ndarray of int64, shape (n,)
            Counts.

        Returns
        -------
        ndarray, shape (n,)
            Angle, rad: the beginning of the count's interval.
        """
        return np.asarray(self.zero_rad + counts * (2 * math.pi / self.counts_per_turn))


@dataclass(frozen=True)
class Tachometer:
    """A direct-current tachometer on the motor shaft.

    Parameters
    ----------
    gain_error : float
        Relative error of its constant, within +-1.
    offset_rad_s : float
        Reading at standstill.
    ripple_share : float
        Commutator ripple relative to the speed, 0 to 1.
    ripple_order : float
        Cycles of that ripple per motor turn, above 0.
    noise_rad_s : float
        Standard deviation of its noise, at least 0.
    """

    gain_error: float = 0.0
    offset_rad_s: float = 0.0
    ripple_share: float = 0.0
    ripple_order: float = 14.0
    noise_rad_s: float = 0.0

    def __post_init__(self) -> None:
        require_number("gain_error", self.gain_error, "", minimum=-1.0, maximum=1.0)
        require_number("offset_rad_s", self.offset_rad_s, "rad/s")
        require_number("ripple_share", self.ripple_share, "", minimum=0.0, maximum=1.0)
        require_number("ripple_order", self.ripple_order, "cycles per motor turn", above=0.0)
        require_number("noise_rad_s", self.noise_rad_s, "rad/s", minimum=0.0)

    def speed_rad_s(
        self, speed_rad_s: FloatArray, angle_rad: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Return the speed that the tachometer shows.

        Parameters
        ----------
        speed_rad_s, angle_rad : ndarray, shape (n,)
            Motor speed, rad/s, and angle, rad.
        generator : numpy.random.Generator
            Source of the noise.

        Returns
        -------
        ndarray, shape (n,)
            Speed shown, rad/s.
        """
        ripple = self.ripple_share * np.sin(self.ripple_order * angle_rad)
        noise = self.noise_rad_s * generator.standard_normal(len(speed_rad_s))
        shown = speed_rad_s * (1 + self.gain_error) * (1 + ripple) + self.offset_rad_s + noise
        return np.asarray(shown)


@dataclass(frozen=True)
class Acquisition:
    """Sampling and what goes wrong in it.

    Parameters
    ----------
    rate_Hz : float
        Nominal sampling rate, above 0.
    jitter_s : float
        Standard deviation of the sampling instant about its nominal time, 0 to a quarter period;
        errors beyond 0.45 periods do not occur, so samples keep their order.
    stamp_jitter_s : float
        Standard deviation of the time stamp about the sampling instant; same limits.
    repeated_share : float
        Share of rows that hold the row before once more, 0 to 0.9.
    missing_share : float
        Share of samples that never arrive, 0 to 0.9.
    angle_to_torque_delay_s : float
        By how much the torque in a row is older than the angle in it; negative: newer.
    noise_V : float
        Standard deviation of the noise at each amplifier's output, at least 0.
    current_noise_A : float
        Standard deviation of the noise of the measured current, at least 0.
    """

    rate_Hz: float = 1000.0
    jitter_s: float = 0.0
    stamp_jitter_s: float = 0.0
    repeated_share: float = 0.0
    missing_share: float = 0.0
    angle_to_torque_delay_s: float = 0.0
    noise_V: float = 0.0
    current_noise_A: float = 0.0

    def __post_init__(self) -> None:
        require_number("rate_Hz", self.rate_Hz, "Hz", above=0.0, maximum=1e6)
        quarter = 0.25 / self.rate_Hz
        require_number("jitter_s", self.jitter_s, "s", minimum=0.0, maximum=quarter)
        require_number("stamp_jitter_s", self.stamp_jitter_s, "s", minimum=0.0, maximum=quarter)
        require_number("repeated_share", self.repeated_share, "", minimum=0.0, maximum=0.9)
        require_number("missing_share", self.missing_share, "", minimum=0.0, maximum=0.9)
        require_number(
            "angle_to_torque_delay_s", self.angle_to_torque_delay_s, "s", minimum=-1.0, maximum=1.0
        )
        require_number("noise_V", self.noise_V, "V", minimum=0.0)
        require_number("current_noise_A", self.current_noise_A, "A", minimum=0.0)


@dataclass(frozen=True)
class Rows:
    """Which sample each row of the recording holds and when; every array has the shape (n,).

    Parameters
    ----------
    stamp_s : ndarray
        Time stamps, s.
    instant_s : ndarray
        When the row's sample would have been taken afresh, s.
    sequence : ndarray of uint32
        Number of the sample in the row; a repeat keeps it, a lost sample leaves a gap.
    source : ndarray of int64
        Row whose sample this row holds: its own, or an earlier one where it is a repeat.
    """

    stamp_s: FloatArray
    instant_s: FloatArray
    sequence: NDArray[np.uint32]
    source: NDArray[np.int64]


def take_rows(acquisition: Acquisition, duration_s: float, generator: np.random.Generator) -> Rows:
    """Return when the rows of a recording are taken and which of them are fresh.

    Parameters
    ----------
    acquisition : Acquisition
        The acquisition.
    duration_s : float
        Length of the recording, s.
    generator : numpy.random.Generator
        Source of jitter, losses and repeats.

    Returns
    -------
    Rows
        The rows.
    """
    period = 1.0 / acquisition.rate_Hz
    count = math.floor(duration_s / period + 1e-9)
    number = np.arange(count)
    reach = 0.45 * period

    def scatter(deviation_s: float) -> FloatArray:
        return np.clip(deviation_s * generator.standard_normal(count), -reach, reach)

    instant = np.maximum(number * period + scatter(acquisition.jitter_s), 0.0)
    stamp = instant + scatter(acquisition.stamp_jitter_s)
    stamp = np.maximum.accumulate(stamp)
    arrived = generator.random(count) >= acquisition.missing_share
    repeated = generator.random(count) < acquisition.repeated_share
    arrived[:1] = True
    number, repeated = number[arrived], repeated[arrived]
    repeated[:1] = False
    source = np.maximum.accumulate(np.where(repeated, 0, np.arange(len(number))))
    return Rows(stamp[arrived], instant[arrived], number[source].astype(np.uint32), source)
