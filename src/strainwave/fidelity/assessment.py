"""The whole measurement of a method, and its verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from strainwave.fidelity.contacts import ContactResponse, contact_at_rest, contact_in_motion
from strainwave.fidelity.tones import SpeedResponse, speed_response
from strainwave.fidelity.verdict import (
    DELAY_LIMIT_S,
    GAIN_ERROR_LIMIT,
    PASSES,
    STEP_ERROR_LIMIT,
    SWALLOWS,
    Worst,
    delay_limit_s,
    reasons_against,
    worst_delay,
    worst_gain_error,
    worst_of,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from strainwave.fidelity.subject import Subject

#: Motor speeds of a measurement, rad/s: slow (order 2 lies at 6.4 Hz, amid the torque that is
#: judged), medium, and full speed of Taghirad & Belanger 1999.
SPEEDS_RAD_S: Final = (20.0, 50.0, 156.0)
#: The one speed of the short measurement while filtering.
SHORT_SPEED_RAD_S: Final = 50.0


@dataclass(frozen=True)
class Assessment:
    """What a method does to true torque and to ripple.

    Attributes
    ----------
    subject : Subject
        The method, and what it was measured with.
    responses : tuple of SpeedResponse
        Gain, delay and attenuation, one for each speed.
    contacts : tuple of ContactResponse
        Contacts in motion, one for each speed, and then one at standstill, unless the measurement
        was the short one.
    reasons : tuple of str
        Which limits are not kept; none where the method passes true torque.
    """

    subject: Subject
    responses: tuple[SpeedResponse, ...]
    contacts: tuple[ContactResponse, ...]
    reasons: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """`"passes true torque"` or `"swallows true torque"`."""
        return SWALLOWS if self.reasons else PASSES

    @property
    def gain_error_worst(self) -> Worst | None:
        """Largest relative error of the gain from 1 to 20 Hz outside the notches."""
        return worst_of([worst_gain_error(each, each.is_judged) for each in self.responses])

    @property
    def delay_worst(self) -> Worst | None:
        """Largest delay or lead from 1 to 20 Hz outside the notches, s."""
        return worst_of([worst_delay(each, each.is_judged) for each in self.responses])

    @property
    def step_error_at_20_ms(self) -> float:
        """Largest error 20 ms after a contact, of its height."""
        return max(each.error_at_20_ms for each in self.contacts)

    @property
    def step_error_largest(self) -> float:
        """Largest error about a contact, of its height."""
        return max(each.largest_error for each in self.contacts)

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, for `--json`.

        Returns
        -------
        dict
            Nothing but texts, finite numbers, lists, dictionaries and None.
        """
        subject = self.subject
        gain, delay = self.gain_error_worst, self.delay_worst
        return {
            "method": subject.name,
            "verdict": self.verdict,
            "reasons": list(self.reasons),
            "gain_error_worst": None if gain is None else gain.value,
            "gain_error_worst_at": _place(gain),
            "delay_s_worst": None if delay is None else delay.value,
            "delay_s_worst_at": _place(delay),
            "step_error_at_20_ms": self.step_error_at_20_ms,
            "step_error_largest": self.step_error_largest,
            "limits": {
                "gain_error": GAIN_ERROR_LIMIT,
                "delay_s": DELAY_LIMIT_S,
                "step_error_at_20_ms": STEP_ERROR_LIMIT,
            },
            "assumptions": list(subject.assumptions),
            "sample_period_s": subject.sample_period_s,
            "rated_torque_Nm": subject.rated_torque_Nm,
            "noise_Nm": subject.noise_Nm,
            "removed_orders": list(subject.removed_orders),
            "speeds": [self._of_speed(each) for each in self.responses],
            "contacts": [
                {
                    "motor_speed_rad_s": each.motor_speed_rad_s,
                    "error_at_20_ms": each.error_at_20_ms,
                    "error_largest": each.largest_error,
                    "time_s": each.time_s.tolist(),
                    "response": each.response.tolist(),
                }
                for each in self.contacts
            ],
        }

    def _of_speed(self, response: SpeedResponse) -> dict[str, Any]:
        judged, beside = response.is_judged, response.is_within_notch
        return {
            "motor_speed_rad_s": response.motor_speed_rad_s,
            "gain_error_worst": _value(worst_gain_error(response, judged)),
            "delay_s_worst": _value(worst_delay(response, judged)),
            "within_notches": {
                "gain_error_worst": _value(worst_gain_error(response, beside)),
                "delay_s_worst": _value(worst_delay(response, beside)),
            },
            "frequency_Hz": response.frequency_Hz.tolist(),
            "gain": response.gain.tolist(),
            "delay_s": _without_nan(response.delay_s),
            "delay_limit_s": delay_limit_s(self.subject, response).tolist(),
            "is_within_notch": response.is_within_notch.tolist(),
            "attenuation": [
                {"order": order, "attenuation_dB": value}
                for order, value in response.attenuation_dB.items()
            ],
        }


def assess(subject: Subject, speeds_rad_s: Sequence[float] = SPEEDS_RAD_S) -> Assessment:
    """Measure a method at several speeds and at standstill.

    Parameters
    ----------
    subject : Subject
        The method under test.
    speeds_rad_s : sequence of float
        Motor speeds, above 0, rad/s.

    Returns
    -------
    Assessment
        Curves, worst figures, verdict.

    Raises
    ------
    InputError
        If the sampling rate is too low or too high for it, or the method gives no torque.
    """
    responses = tuple(speed_response(subject, speed) for speed in speeds_rad_s)
    contacts = (
        *(contact_in_motion(subject, speed) for speed in speeds_rad_s),
        contact_at_rest(subject),
    )
    reasons = reasons_against(subject, responses, contacts)
    return Assessment(subject, responses, contacts, reasons)


def assess_shortly(subject: Subject) -> Assessment:
    """Measure a method at one speed and nothing but what is judged, in a fraction of a second.

    Parameters
    ----------
    subject : Subject
        The method under test.

    Returns
    -------
    Assessment
        Curves, worst figures, verdict.

    Raises
    ------
    InputError
        As `assess`.
    """
    responses = (speed_response(subject, SHORT_SPEED_RAD_S, is_wide=False),)
    contacts = (contact_in_motion(subject, SHORT_SPEED_RAD_S, angles=1),)
    reasons = reasons_against(subject, responses, contacts)
    return Assessment(subject, responses, contacts, reasons)


def _value(worst: Worst | None) -> float | None:
    return None if worst is None else worst.value


def _place(worst: Worst | None) -> dict[str, float] | None:
    if worst is None:
        return None
    return {
        "frequency_Hz": worst.frequency_Hz,
        "motor_speed_rad_s": worst.motor_speed_rad_s,
    }


def _without_nan(values: NDArray[np.float64]) -> list[float | None]:
    return [value if math.isfinite(value) else None for value in values.tolist()]
