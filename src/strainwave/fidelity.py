"""What a tuning does to true torque: pass-through gain and delay, and the answer to a contact.

A ripple filter is judged by what it leaves untouched. Torque that the expected torque does not
contain is put in front of the filter, and what comes out is compared with it: a sine for gain and
delay at a frequency and speed, a step for the first moments of a contact. Any filter can be
measured, because it is only run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from strainwave.arrays import contiguous
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Gain below which a delay says nothing.
SMALLEST_GAIN_WITH_DELAY: Final = 1e-3


class RemovesRipple(Protocol):
    """A fresh filter: measured torque and motor speed in, torque without ripple out."""

    def __call__(
        self, torque_Nm: NDArray[np.float64], motor_speed_rad_s: NDArray[np.float64], /
    ) -> NDArray[np.float64]:
        """Run a filter from its initial state over a recording.

        Parameters
        ----------
        torque_Nm : numpy.ndarray
            Measured torque, Nm.
        motor_speed_rad_s : numpy.ndarray
            Motor speed, rad/s.

        Returns
        -------
        numpy.ndarray
            Torque without ripple, Nm.
        """
        ...


@dataclass(frozen=True)
class PassThrough:
    """Frequency response from true torque to the filter's output at one speed.

    Attributes
    ----------
    frequency_Hz : numpy.ndarray
        Frequencies, shape (frequencies,).
    gain : numpy.ndarray
        Amplitude out over amplitude in; 1 is untouched.
    delay_s : numpy.ndarray
        Group delay, s; 0 is untouched, negative where the output leads, NaN where less than a
        thousandth passes and there is nothing to be late.
    motor_speed_rad_s : float
        Motor speed of the measurement.
    """

    frequency_Hz: NDArray[np.float64]
    gain: NDArray[np.float64]
    delay_s: NDArray[np.float64]
    motor_speed_rad_s: float

    @property
    def gain_dB(self) -> NDArray[np.float64]:
        """Gain in decibels."""
        return 20 * np.log10(np.maximum(self.gain, 1e-12))


@dataclass(frozen=True)
class StepResponse:
    """Answer of the filter's output to a contact torque.

    Attributes
    ----------
    time_s : numpy.ndarray
        Time since the contact, shape (samples,); negative before it.
    torque_Nm : numpy.ndarray
        Output, Nm.
    contact_torque_Nm : float
        Height of the step, Nm.
    """

    time_s: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    contact_torque_Nm: float

    def at(self, time_s: float) -> float:
        """Output at a time after the contact.

        Parameters
        ----------
        time_s : float
            Time since the contact, s.

        Returns
        -------
        float
            Torque, Nm.
        """
        return float(np.interp(time_s, self.time_s, self.torque_Nm))


def complex_gain(
    removes_ripple: RemovesRipple,
    frequency_Hz: float,
    *,
    motor_speed_rad_s: float,
    sample_period_s: float,
    settling_s: float = 4.0,
) -> complex:
    """Steady answer to one sine of true torque at constant speed.

    Parameters
    ----------
    removes_ripple : RemovesRipple
        The filter.
    frequency_Hz : float
        Frequency of the torque.
    motor_speed_rad_s : float
        Motor speed, rad/s.
    sample_period_s : float
        Sample period, s.
    settling_s : float
        Time given to the filter before the answer is measured.

    Returns
    -------
    complex
        Output over input at that frequency.
    """
    periods = max(4, int(np.ceil(2.0 * frequency_Hz)))
    settling = round(settling_s / sample_period_s)
    samples = settling + round(periods / frequency_Hz / sample_period_s)
    time_s = sample_period_s * np.arange(samples)
    turning = 2 * np.pi * frequency_Hz * time_s
    output = removes_ripple(np.sin(turning), np.full(samples, motor_speed_rad_s))
    basis = np.column_stack(
        [np.sin(turning[settling:]), np.cos(turning[settling:]), np.ones(samples - settling)]
    )
    in_phase, quadrature, _ = np.linalg.lstsq(basis, output[settling:], rcond=None)[0]
    return complex(in_phase, quadrature)


def pass_through(
    removes_ripple: RemovesRipple,
    frequencies_Hz: ArrayLike,
    *,
    motor_speed_rad_s: float,
    sample_period_s: float = 1e-3,
    settling_s: float = 4.0,
) -> PassThrough:
    """Gain and group delay of true torque against frequency at one speed.

    Parameters
    ----------
    removes_ripple : RemovesRipple
        The filter, run anew for every frequency.
    frequencies_Hz : array_like
        Frequencies, shape (frequencies,), Hz, between 0 and half the sampling rate.
    motor_speed_rad_s : float
        Motor speed, rad/s.
    sample_period_s : float
        Sample period, s.
    settling_s : float
        Time given to the filter before the answer is measured.

    Returns
    -------
    PassThrough
        The response. Group delay from two frequencies 1 % apart.

    Raises
    ------
    InputError
        If a frequency or the sample period is out of range.
    """
    frequencies = contiguous("frequencies_Hz", frequencies_Hz, np.float64)
    if not np.isfinite(sample_period_s) or sample_period_s <= 0:
        raise InputError(
            f"sample_period_s = {sample_period_s}: expected a finite number above 0; give it in s"
        )
    highest_Hz = 0.5 / sample_period_s
    if len(frequencies) == 0 or not np.all((frequencies > 0) & (frequencies < highest_Hz)):
        raise InputError(
            f"frequencies_Hz = {frequencies.tolist()}: expected frequencies above 0 and below "
            f"{highest_Hz:g} Hz, half the sampling rate; choose others"
        )
    gains = np.empty(len(frequencies))
    delays = np.empty(len(frequencies))
    for n, frequency_Hz in enumerate(frequencies):
        spread = (frequency_Hz * 0.995, frequency_Hz, frequency_Hz * 1.005)
        below, here, above = (
            complex_gain(
                removes_ripple,
                f,
                motor_speed_rad_s=motor_speed_rad_s,
                sample_period_s=sample_period_s,
                settling_s=settling_s,
            )
            for f in spread
        )
        gains[n] = abs(here)
        passes = min(abs(below), abs(here), abs(above)) > SMALLEST_GAIN_WITH_DELAY
        turned_rad = np.angle(above / below) if passes else np.nan
        delays[n] = -turned_rad / (2 * np.pi * (spread[2] - spread[0]))
    return PassThrough(frequencies, gains, delays, motor_speed_rad_s)


def contact_step(
    removes_ripple: RemovesRipple,
    *,
    contact_torque_Nm: float = 10.0,
    motor_speed_rad_s: float,
    sample_period_s: float = 1e-3,
    before_s: float = 2.0,
    after_s: float = 0.2,
) -> StepResponse:
    """Answer to a contact: a step of true torque at constant speed.

    Parameters
    ----------
    removes_ripple : RemovesRipple
        The filter.
    contact_torque_Nm : float
        Height of the step, Nm.
    motor_speed_rad_s : float
        Motor speed, rad/s.
    sample_period_s : float
        Sample period, s.
    before_s, after_s : float
        Time before and after the contact, s.

    Returns
    -------
    StepResponse
        Output from 0.02 s before the contact.
    """
    before = round(before_s / sample_period_s)
    after = round(after_s / sample_period_s)
    torque = np.zeros(before + after)
    torque[before:] = contact_torque_Nm
    output = removes_ripple(torque, np.full(len(torque), motor_speed_rad_s))
    shown = slice(before - round(0.02 / sample_period_s), None)
    time_s = sample_period_s * (np.arange(len(torque)) - before)
    return StepResponse(np.asarray(time_s[shown], np.float64), output[shown], contact_torque_Nm)
