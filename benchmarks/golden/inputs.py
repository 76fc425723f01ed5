"""The samples of the golden vectors: whole numbers alone, so that every side has the same bits.

A joint that starts, cruises, reverses, rests, crawls and starts again under changing load, and what
goes wrong with sensors meanwhile. The same arithmetic is written in C++ in
``tests/golden/golden_inputs.hpp``; a checksum holds both together.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Integers = NDArray[np.int64]

#: Codes that stand for what is no number.
NAN_CODE: Final = -(2**31)
INFINITY_CODE: Final = -(2**31) + 1
#: The clock counts 2^-20 s; 1024 of them a sample, so that intervals are exact in float as well.
TICKS_A_SAMPLE: Final = 1024
TICK_S: Final = 2.0**-20
TORQUE_STEP_NM: Final = 2.0**-12
SPEED_STEP_RAD_S: Final = 2.0**-6
TEMPERATURE_STEP_DEGC: Final = 2.0**-8
GAUGES: Final = 4
CONVERTER_BITS: Final = 16


@dataclass(frozen=True)
class Samples:
    """Whole numbers of all samples, as converters, encoder and clock deliver them.

    Attributes
    ----------
    ticks : numpy.ndarray
        Clock, 2^-20 s, shape (samples,).
    sequence, encoder : numpy.ndarray
        Sample number and encoder count, both modulo 2^32, shape (samples,).
    torque, expected, speed, temperature : numpy.ndarray
        In steps of 2^-12 Nm, 2^-6 rad/s and 2^-8 degrees Celsius; `NAN_CODE` and `INFINITY_CODE`
        stand for what is no number, shape (samples,).
    gauges : numpy.ndarray
        Converter codes, shape (samples, gauges).
    angle_known : numpy.ndarray
        0 where the encoder says nothing, shape (samples,).
    """

    ticks: Integers
    sequence: Integers
    encoder: Integers
    torque: Integers
    expected: Integers
    speed: Integers
    temperature: Integers
    gauges: Integers
    angle_known: Integers

    def checksum(self) -> int:
        """Return the CRC-32 of all samples, field by field as the C++ side has them.

        Returns
        -------
        int
            Over little-endian records of each sample.
        """
        names = ("sequence", "encoder", "torque", "expected", "speed", "temperature", "angle_known")
        record = np.zeros(
            self.ticks.size,
            dtype=[("ticks", "<i8")]
            + [(name, "<u4") for name in names]
            + [("gauges", "<i4", (GAUGES,))],
        )
        record["ticks"] = self.ticks
        for name in names:
            record[name] = getattr(self, name) & 0xFFFFFFFF
        record["gauges"] = self.gauges
        return zlib.crc32(record.tobytes())


def sine(angle: Integers) -> Integers:
    """Return a sine of whole numbers: two parabolas and their correction, good to 0.1 %.

    Parameters
    ----------
    angle : numpy.ndarray
        2^-16 turn; whole turns drop out.

    Returns
    -------
    numpy.ndarray
        2^-15.
    """
    t = ((angle & 0xFFFF) ^ 0x8000) - 0x8000
    y = (t * (32768 - np.abs(t))) >> 13
    return np.asarray(y + ((7373 * (((y * np.abs(y)) >> 15) - y)) >> 15))


def noise(count: int, channel: int) -> Integers:
    """Return noise of about a normal distribution: four bytes of a hash of number and channel.

    Parameters
    ----------
    count : int
        Samples.
    channel : int
        Which noise.

    Returns
    -------
    numpy.ndarray
        From -510 to 510, standard deviation 148, shape (count,).
    """
    x = (np.arange(count, dtype=np.uint64) * 0x9E3779B1 + channel * 0x85EBCA6B) & 0xFFFFFFFF
    x ^= x >> np.uint64(16)
    x = (x * 0x7FEB352D) & 0xFFFFFFFF
    x ^= x >> np.uint64(15)
    x = (x * 0x846CA68B) & 0xFFFFFFFF
    x ^= x >> np.uint64(16)
    parts = [(x >> np.uint64(shift)) & np.uint64(0xFF) for shift in (0, 8, 16, 24)]
    return np.asarray(np.sum(parts, axis=0).astype(np.int64) - 510)


def motion(definition: dict[str, Any], count: int) -> tuple[Integers, Integers]:
    """Return speed and encoder position, segment by segment, over and over.

    Parameters
    ----------
    definition : dict
        With ``segments`` (samples, speed) and ``speed_step_a_sample``.
    count : int
        Samples.

    Returns
    -------
    tuple of numpy.ndarray
        Speed in 1/256 counts a sample, and position in counts from the start.
    """
    targets = np.concatenate([np.full(n, v, np.int64) for n, v in definition["segments"]])
    step = definition["speed_step_a_sample"]
    speed = np.empty(count, np.int64)
    now = 0
    for k in range(count):
        now += min(max(int(targets[k % targets.size]) - now, -step), step)
        speed[k] = now
    return speed, np.cumsum(speed) >> 8


def samples_of(definition: dict[str, Any], count: int) -> Samples:
    """Make the samples.

    Parameters
    ----------
    definition : dict
        As `benchmarks.golden.definition.DEFINITION`.
    count : int
        Samples.

    Returns
    -------
    Samples
        What was made, faults included.
    """
    k = np.arange(count, dtype=np.int64)
    speed, travelled = motion(definition, count)
    encoder = definition["encoder_start"] + travelled
    load = np.array(definition["loads_Nm"], np.int64)[(k >> 11) % len(definition["loads_Nm"])]
    load = load * 4096 + ((4096 * sine(k * 13)) >> 15)
    ripple = np.zeros(count, np.int64)
    for order, amplitude, phase in definition["ripple"]:
        ripple += (amplitude * sine(order * encoder + phase)) >> 15
    ripple += (ripple * np.abs(load)) >> 18
    gauges = np.stack(
        [
            each["zero"]
            + ((load * definition["codes_a_torque_step_2e16"]) >> 16)
            + sum(
                ((amplitude * sine(order * encoder + phase)) >> 15)
                for order, amplitude, phase in each["wave"]
            )
            + (noise(count, 2 + j) >> 6)
            for j, each in enumerate(definition["gauges"])
        ],
        axis=1,
    )
    made = Samples(
        ticks=k * TICKS_A_SAMPLE,
        sequence=k + definition["sequence_start"],
        encoder=encoder,
        torque=load + ripple + noise(count, 0),
        expected=np.where((k >> 13) & 1 == 1, load >> 1, 0),
        speed=((speed * 1571) >> 16) + (noise(count, 1) >> 6),
        temperature=5120 + ((3840 * sine(k * 3)) >> 15),
        gauges=gauges,
        angle_known=np.ones(count, np.int64),
    )
    for kind, first, length, value in definition["events"]:
        if first < count:
            _spoil(made, kind, slice(first, min(first + length, count)), value)
    made.sequence[:] &= 0xFFFFFFFF
    made.encoder[:] &= 0xFFFFFFFF
    return made


def _spoil(samples: Samples, kind: str, rows: slice, value: int) -> None:
    """Let one thing go wrong."""
    codes = {
        "torque": samples.torque,
        "expected": samples.expected,
        "speed": samples.speed,
        "temperature": samples.temperature,
    }
    if kind in codes:
        codes[kind][rows] = value
    elif kind == "no_angle":
        samples.angle_known[rows] = 0
    elif kind == "all_gauges":
        samples.gauges[rows] = value
    elif kind.startswith("gauge_"):
        samples.gauges[rows, int(kind.removeprefix("gauge_")) - 1] = value
    elif kind == "gap":
        samples.sequence[rows.start :] += value
        samples.ticks[rows.start :] += value * TICKS_A_SAMPLE
    elif kind == "repeated":
        samples.sequence[rows] = samples.sequence[rows.start - 1]
        samples.ticks[rows] = samples.ticks[rows.start - 1]
    elif kind == "time_back":
        samples.ticks[rows] -= value
    elif kind == "sequence_back":
        samples.sequence[rows] -= value
    else:
        raise ValueError(kind)
