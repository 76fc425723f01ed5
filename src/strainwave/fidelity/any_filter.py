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
from strainwave.fidelity.checks import (
    require_frequencies,
    require_number,
    require_rate,
    samples_of,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: The delay comes from two frequencies that lie this share to either side.
SPREAD: Final = 0.005
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

    Raises
    ------
    InputError
        If a parameter is out of range or the filter's output is not finite.
    """
    require_rate(motor_speed_rad_s, sample_period_s)
    require_number("settling_s", settling_s, "s")
    require_frequencies([frequency_Hz], sample_period_s, spread=0.0)
    periods = max(4, int(np.ceil(2.0 * frequency_Hz)))
    settling = samples_of("settling_s", settling_s, sample_period_s)
    samples = settling + samples_of(
        "one over frequency_Hz", periods / frequency_Hz, sample_period_s
    )
    time_s = sample_period_s * np.arange(samples)
    turning = 2 * np.pi * frequency_Hz * time_s
    output = _run(removes_ripple, np.sin(turning), motor_speed_rad_s)
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
        Frequencies, shape (frequencies,), Hz, above 0 and at least 0.5 % below half the sampling
        rate.
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
        If a parameter is out of range or the filter's output is not finite.
    """
    require_rate(motor_speed_rad_s, sample_period_s)
    require_number("settling_s", settling_s, "s")
    frequencies = require_frequencies(frequencies_Hz, sample_period_s, spread=SPREAD)
    gains = np.empty(len(frequencies))
    delays = np.empty(len(frequencies))
    for n, frequency_Hz in enumerate(frequencies):
        spread = (frequency_Hz * (1 - SPREAD), frequency_Hz, frequency_Hz * (1 + SPREAD))
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
        Output from 0.02 s before the contact, or from the start where that is later.

    Raises
    ------
    InputError
        If a parameter is out of range or the filter's output is not finite.
    """
    require_rate(motor_speed_rad_s, sample_period_s)
    require_number("contact_torque_Nm", contact_torque_Nm, "Nm", lowest=-np.inf)
    require_number("before_s", before_s, "s")
    require_number("after_s", after_s, "s", lowest=sample_period_s)
    before = samples_of("before_s", before_s, sample_period_s)
    after = samples_of("after_s", after_s, sample_period_s)
    torque = np.zeros(before + after)
    torque[before:] = contact_torque_Nm
    output = _run(removes_ripple, torque, motor_speed_rad_s)
    first = max(0, before - round(0.02 / sample_period_s))
    time_s = sample_period_s * (np.arange(len(torque), dtype=np.float64) - before)
    return StepResponse(time_s[first:], output[first:], contact_torque_Nm)


def _run(
    removes_ripple: RemovesRipple, torque_Nm: NDArray[np.float64], motor_speed_rad_s: float
) -> NDArray[np.float64]:
    output = contiguous(
        "the filter's output",
        removes_ripple(torque_Nm, np.full(len(torque_Nm), float(motor_speed_rad_s))),
        np.float64,
    )
    if output.shape != torque_Nm.shape or not np.all(np.isfinite(output)):
        raise InputError(
            f"the filter's output has {len(output)} samples, {np.sum(~np.isfinite(output))} of "
            f"them not finite: expected {len(torque_Nm)} numbers; correct the filter or its tuning"
        )
    return output
