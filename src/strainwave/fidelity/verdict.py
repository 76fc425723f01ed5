"""Whether a method passes true torque: the limits, and the reasons in words.

docs/reference/fidelity-command.md says why the limits are where they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.fidelity.tones import NOTCH_ORDERS, distance_Hz, notch_half_width_Hz

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.fidelity.contacts import ContactResponse
    from strainwave.fidelity.subject import Subject
    from strainwave.fidelity.tones import SpeedResponse

PASSES: Final = "passes true torque"
SWALLOWS: Final = "swallows true torque"

#: Largest error of the gain from 1 to 20 Hz, relative.
GAIN_ERROR_LIMIT: Final = 0.05
#: Largest delay from 1 to 20 Hz, s, before what the notches at the removed lines bring along.
DELAY_LIMIT_S: Final = 1e-3
#: Such a notch may forget within so many motor turns: half of the least that the ripple filter
#: chooses for itself, because its terms in load and speed delay too.
NOTCH_MEMORY_TURNS: Final = 1.5
#: Its half width, in half widths of what is left out beside the line.
_NOTCH_SHARE: Final = 1 / (2 * np.pi * NOTCH_MEMORY_TURNS) / NOTCH_ORDERS
#: Largest error 20 ms after a contact, of its height.
STEP_ERROR_LIMIT: Final = 0.10


@dataclass(frozen=True)
class Worst:
    """The worst of a curve.

    Attributes
    ----------
    value : float
        A magnitude.
    frequency_Hz : float
        Where it is.
    motor_speed_rad_s : float
        At which speed.
    """

    value: float
    frequency_Hz: float
    motor_speed_rad_s: float


def delay_limit_s(subject: Subject, response: SpeedResponse) -> NDArray[np.float64]:
    """Largest delay that is put up with at each frequency.

    A notch of half width a delays torque at distance d from its line by a / (a^2 + d^2), both in
    rad/s; no causal filter with that gain delays less (Bode).

    Parameters
    ----------
    subject : Subject
        The method under test.
    response : SpeedResponse
        Its response at a speed.

    Returns
    -------
    numpy.ndarray
        Shape (frequencies,), s.
    """
    away_rad_s = 2 * np.pi * distance_Hz(subject, response.motor_speed_rad_s, response.frequency_Hz)
    half_rad_s = 2 * np.pi * notch_half_width_Hz(subject, response.motor_speed_rad_s)
    a = _NOTCH_SHARE * half_rad_s[:, np.newaxis]
    return np.asarray(DELAY_LIMIT_S + (a / (a**2 + away_rad_s**2)).sum(axis=0))


def worst_gain_error(response: SpeedResponse, chosen: NDArray[np.bool_]) -> Worst | None:
    """Find the largest error of the gain.

    Parameters
    ----------
    response : SpeedResponse
        Response at a speed.
    chosen : numpy.ndarray
        Which frequencies count.

    Returns
    -------
    Worst or None
        Relative error; None where no frequency counts.
    """
    return _worst(np.abs(response.gain - 1.0), response, chosen)


def worst_delay(response: SpeedResponse, chosen: NDArray[np.bool_]) -> Worst | None:
    """Find the largest delay, or lead.

    Parameters
    ----------
    response : SpeedResponse
        Response at a speed.
    chosen : numpy.ndarray
        Which frequencies count.

    Returns
    -------
    Worst or None
        Its magnitude, s; None where no frequency counts or nothing passes.
    """
    return _worst(np.abs(response.delay_s), response, chosen & np.isfinite(response.delay_s))


def reasons_against(
    subject: Subject, responses: Sequence[SpeedResponse], contacts: Sequence[ContactResponse]
) -> tuple[str, ...]:
    """Say which limits a method does not keep.

    Parameters
    ----------
    subject : Subject
        The method under test.
    responses : sequence of SpeedResponse
        At the speeds.
    contacts : sequence of ContactResponse
        In motion and at rest.

    Returns
    -------
    tuple of str
        At most one reason for gain, delay and contact each, by their worst; none where the method
        passes true torque.
    """
    found = (_gain_reason(responses), _delay_reason(subject, responses), _contact_reason(contacts))
    return tuple(reason for reason in found if reason is not None)


def _gain_reason(responses: Sequence[SpeedResponse]) -> str | None:
    worst = worst_of([worst_gain_error(each, each.is_judged) for each in responses])
    if worst is None or worst.value <= GAIN_ERROR_LIMIT:
        return None
    response = next(r for r in responses if r.motor_speed_rad_s == worst.motor_speed_rad_s)
    gain = float(response.gain[response.frequency_Hz == worst.frequency_Hz][0])
    return (
        f"at {worst.motor_speed_rad_s:g} rad/s it hands out {gain:.1%} of a torque of "
        f"{worst.frequency_Hz:.3g} Hz (limit: {GAIN_ERROR_LIMIT:.0%} of error)"
    )


def _delay_reason(subject: Subject, responses: Sequence[SpeedResponse]) -> str | None:
    worst, reason = 1.0, None
    for response in responses:
        limit_s = delay_limit_s(subject, response)
        over = np.where(response.is_judged, np.abs(response.delay_s) / limit_s, np.nan)
        if np.all(np.isnan(over)):
            continue
        n = int(np.nanargmax(over))
        if over[n] > worst:
            worst = float(over[n])
            late = "late" if response.delay_s[n] > 0 else "early"
            reason = (
                f"at {response.motor_speed_rad_s:g} rad/s a torque of "
                f"{response.frequency_Hz[n]:.3g} Hz comes {1e3 * abs(response.delay_s[n]):.3g} ms "
                f"{late} (limit there: {1e3 * limit_s[n]:.3g} ms)"
            )
    return reason


def _contact_reason(contacts: Sequence[ContactResponse]) -> str | None:
    worst = max(contacts, key=lambda each: each.error_at_20_ms)
    if worst.error_at_20_ms <= STEP_ERROR_LIMIT:
        return None
    speed = worst.motor_speed_rad_s
    return (
        f"{'at standstill' if speed == 0 else f'at {speed:g} rad/s'} a contact is wrong by "
        f"{worst.error_at_20_ms:.1%} of its height 20 ms after it began (limit: "
        f"{STEP_ERROR_LIMIT:.0%})"
    )


def worst_of(several: Sequence[Worst | None]) -> Worst | None:
    """Find the worst of the worst.

    Parameters
    ----------
    several : sequence of Worst or None
        Of each speed.

    Returns
    -------
    Worst or None
        None where there is none at any speed.
    """
    return max((each for each in several if each), key=lambda each: each.value, default=None)


def _worst(
    values: NDArray[np.float64], response: SpeedResponse, chosen: NDArray[np.bool_]
) -> Worst | None:
    if not np.any(chosen):
        return None
    n = int(np.argmax(np.where(chosen, values, -np.inf)))
    return Worst(float(values[n]), float(response.frequency_Hz[n]), response.motor_speed_rad_s)
