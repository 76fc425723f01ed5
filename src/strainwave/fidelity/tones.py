"""Gain and delay of true torque at constant speed, from small tones beside ripple and noise.

The method is run twice over recordings that differ in nothing but the tones' sign, so that ripple,
noise and what grows with the square of the tones drop out of the difference. Tones have whole
periods in what is measured.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.errors import InputError
from strainwave.fidelity.scene import (
    LOAD_HZ,
    lines_apart,
    ripple_recording,
    rows_of,
    settling_s,
    with_torque,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.fidelity.subject import Subject
    from strainwave.samples import Samples

#: What is measured after the method has settled.
MEASURED_S: Final = 16.0
#: The frequencies that are judged, Hz.
LOWEST_HZ: Final = 1.0
HIGHEST_HZ: Final = 20.0
STEP_HZ: Final = 0.5
#: Beyond those, so many on to this share of the sampling rate.
WIDE_COUNT: Final = 24
WIDE_SHARE: Final = 0.4
#: Bins of 1 / MEASURED_S from a frequency to the two tones of which gain and delay are made.
SPREAD_BINS: Final = 2
#: Size of the tones together, of the noise of one sample: those that are judged stand well above
#: what the noise does to the difference of two runs; the fast ones do not, because a filter that
#: looks for contacts would take them for such.
JUDGED_TONES: Final = 10.0
#: They are no more than this, of the rated torque.
MOST_TONES: Final = 0.01
WIDE_TONES: Final = 1.0
#: Half width of a notch that is left out of the verdict, orders; and the same of a low order, as a
#: share of it.
NOTCH_ORDERS: Final = 0.3
NOTCH_SHARE: Final = 0.15
#: Below this gain there is nothing left that could be late.
SMALLEST_GAIN_WITH_DELAY: Final = 0.01


@dataclass(frozen=True)
class SpeedResponse:
    """What a method does at one speed.

    Attributes
    ----------
    motor_speed_rad_s : float
        Motor speed, rad/s.
    frequency_Hz : numpy.ndarray
        Frequencies, shape (frequencies,), Hz.
    gain : numpy.ndarray
        Amplitude out over amplitude in.
    delay_s : numpy.ndarray
        Group delay, s; NaN where nearly nothing passes.
    is_within_notch : numpy.ndarray
        Whether a frequency lies beside a removed line.
    attenuation_dB : dict
        Of the ripple, by order; None where the line cannot be told apart at this speed.
    """

    motor_speed_rad_s: float
    frequency_Hz: NDArray[np.float64]
    gain: NDArray[np.float64]
    delay_s: NDArray[np.float64]
    is_within_notch: NDArray[np.bool_]
    attenuation_dB: dict[float, float | None]

    @property
    def is_judged(self) -> NDArray[np.bool_]:
        """Frequencies from 1 to 20 Hz that are outside the notches."""
        in_range = (self.frequency_Hz > LOWEST_HZ - 0.1) & (self.frequency_Hz < HIGHEST_HZ + 0.1)
        return np.asarray(in_range & ~self.is_within_notch)


def speed_response(
    subject: Subject, motor_speed_rad_s: float, *, is_wide: bool = True
) -> SpeedResponse:
    """Measure gain, delay and attenuation at one speed.

    Parameters
    ----------
    subject : Subject
        The method under test.
    motor_speed_rad_s : float
        Motor speed, above 0, rad/s.
    is_wide : bool
        False measures no frequencies but those that are judged.

    Returns
    -------
    SpeedResponse
        What was measured.

    Raises
    ------
    InputError
        If the sampling rate is too low for a single frequency, or too high for the memory.
    """
    settling = rows_of(subject, settling_s(subject, motor_speed_rad_s))
    measured = rows_of(subject, MEASURED_S)
    measured_s = measured * subject.sample_period_s
    turns = measured_s * motor_speed_rad_s / (2 * np.pi)
    orders = lines_apart(subject.ripple_orders, turns)
    speed = np.full(settling + measured, motor_speed_rad_s)
    recording = ripple_recording(subject, speed, orders)
    plain_Nm = subject.run(recording)
    most = MOST_TONES * subject.rated_torque_Nm / subject.noise_Nm
    size = min(JUDGED_TONES, max(most, WIDE_TONES))
    judged, wide = _centre_bins(measured_s, subject.sample_period_s)
    below, above = _answers(subject, recording, measured, judged, size)
    centres = judged
    if is_wide and len(wide):
        wider = _answers(subject, recording, measured, wide, WIDE_TONES)
        below, above = np.append(below, wider[0]), np.append(above, wider[1])
        centres = np.append(judged, wide)
    passes = np.minimum(np.abs(below), np.abs(above)) > SMALLEST_GAIN_WITH_DELAY
    turned_rad = np.angle(above * np.conj(below))
    delay_s = np.where(passes, -turned_rad * measured_s / (4 * np.pi * SPREAD_BINS), np.nan)
    frequency_Hz = centres / measured_s
    around = distance_Hz(subject, motor_speed_rad_s, frequency_Hz)
    half_Hz = notch_half_width_Hz(subject, motor_speed_rad_s)
    within = np.any(around < half_Hz[:, np.newaxis] + SPREAD_BINS / measured_s, axis=0)
    found = _attenuation_dB(
        recording.time_s[settling:],
        recording.motor_angle_rad[settling:],
        recording.torque_Nm[settling:],
        plain_Nm[settling:],
        orders,
    )
    return SpeedResponse(
        motor_speed_rad_s,
        frequency_Hz,
        0.5 * (np.abs(below) + np.abs(above)),
        delay_s,
        np.asarray(within, dtype=np.bool_),
        {order: found.get(order) for order in subject.ripple_orders},
    )


def distance_Hz(
    subject: Subject, motor_speed_rad_s: float, frequency_Hz: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distance of frequencies from the lines that the method removes, as sampling shows these.

    Parameters
    ----------
    subject : Subject
        The method under test.
    motor_speed_rad_s : float
        Motor speed, rad/s.
    frequency_Hz : numpy.ndarray
        Frequencies, shape (frequencies,), Hz.

    Returns
    -------
    numpy.ndarray
        Hz, shape (removed orders, frequencies).
    """
    line_Hz = np.array(subject.removed_orders) * motor_speed_rad_s / (2 * np.pi)
    rate_Hz = 1 / subject.sample_period_s
    line_Hz = np.abs(line_Hz - rate_Hz * np.round(line_Hz / rate_Hz))
    return np.abs(np.subtract.outer(line_Hz, frequency_Hz))


def notch_half_width_Hz(subject: Subject, motor_speed_rad_s: float) -> NDArray[np.float64]:
    """How far beside each removed line a frequency is left out of the verdict.

    Parameters
    ----------
    subject : Subject
        The method under test.
    motor_speed_rad_s : float
        Motor speed, rad/s.

    Returns
    -------
    numpy.ndarray
        Hz, shape (removed orders,).
    """
    orders = np.array(subject.removed_orders)
    half_orders = np.minimum(NOTCH_ORDERS, NOTCH_SHARE * orders)
    return np.asarray(half_orders * motor_speed_rad_s / (2 * np.pi))


def _centre_bins(
    measured_s: float, sample_period_s: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Choose frequencies, in bins of 1 / measured_s: those that are judged, and higher ones."""
    highest_Hz = WIDE_SHARE / sample_period_s
    if highest_Hz < 2 * LOWEST_HZ:
        raise InputError(
            f"the sampling rate is {1 / sample_period_s:.4g} Hz, and what a method does to torque "
            f"of {LOWEST_HZ:g} Hz cannot be seen in it: expected at least "
            f"{2 * LOWEST_HZ / WIDE_SHARE:g} Hz; give sampling_rate_Hz of a faster recording"
        )
    judged_Hz = np.arange(LOWEST_HZ, HIGHEST_HZ + 0.5 * STEP_HZ, STEP_HZ)
    judged = np.round(judged_Hz[judged_Hz <= highest_Hz] * measured_s).astype(np.int64)
    if highest_Hz < HIGHEST_HZ + 1.0:
        return judged, np.empty(0, np.int64)
    wide_Hz = np.geomspace(HIGHEST_HZ, highest_Hz, WIDE_COUNT + 1)[1:]
    wide = np.unique(np.round(wide_Hz * measured_s).astype(np.int64))
    # Tones of neighbours must not fall together.
    apart = np.diff(np.append(judged[-1], wide)) > 2 * SPREAD_BINS
    return judged, np.asarray(wide[apart])


def _answers(
    subject: Subject,
    recording: Samples,
    measured: int,
    centres: NDArray[np.int64],
    size: float,
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Output over input a little below and a little above each frequency."""
    rows = len(recording)
    tones = np.sort(np.concatenate([centres - SPREAD_BINS, centres + SPREAD_BINS]))
    period_Nm = _multisine(tones, measured, size * subject.noise_Nm)
    added_Nm = np.tile(period_Nm, math.ceil(rows / measured))[-rows:]
    change_Nm = 0.5 * (
        subject.run(with_torque(recording, added_Nm))
        - subject.run(with_torque(recording, -added_Nm))
    )
    given = np.fft.rfft(added_Nm[-measured:])
    got = np.fft.rfft(change_Nm[-measured:])
    below, above = (
        got[bins] / given[bins] for bins in (centres - SPREAD_BINS, centres + SPREAD_BINS)
    )
    return np.asarray(below), np.asarray(above)


def _multisine(tones: NDArray[np.int64], rows: int, rms_Nm: float) -> NDArray[np.float64]:
    """One period of a sum of equal tones with Schroeder's phases, so that it is no pulse."""
    spectrum = np.zeros(rows // 2 + 1, dtype=np.complex128)
    count = len(tones)
    spectrum[tones] = np.exp(1j * np.pi * np.arange(count) ** 2 / count)
    return np.asarray(np.fft.irfft(spectrum, rows) * rows * rms_Nm / math.sqrt(2 * count))


def _attenuation_dB(
    time_s: NDArray[np.float64],
    angle_rad: NDArray[np.float64],
    before_Nm: NDArray[np.float64],
    after_Nm: NDArray[np.float64],
    orders: tuple[float, ...],
) -> dict[float, float]:
    """Fit the lines in motor angle, before and after, with the slow load and a mean."""
    if not orders:
        return {}
    turned = np.multiply.outer(angle_rad, np.array(orders))
    slow = 2 * np.pi * LOAD_HZ * time_s
    others = np.column_stack([np.cos(slow), np.sin(slow), np.ones(len(slow))])
    basis = np.concatenate([np.cos(turned), np.sin(turned), others], axis=1)
    fit = np.linalg.lstsq(basis, np.column_stack([before_Nm, after_Nm]), rcond=None)[0]
    count = len(orders)
    before, after = np.hypot(fit[:count], fit[count : 2 * count]).T
    ratio_dB = 20 * np.log10(np.maximum(before, 1e-12) / np.maximum(after, 1e-12))
    return dict(zip(orders, ratio_dB.tolist(), strict=True))
