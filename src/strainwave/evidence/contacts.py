"""Contacts added to this very recording: how much of them comes through.

The method is run twice from its start, once with a known torque added to the recording and once
without. What the output shows more of it the second time is what came through; no reference torque
is needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from strainwave import _core
from strainwave.evidence.moments import Moment, moments_at_rest, moments_in_motion
from strainwave.fidelity.contacts import JUDGED_S
from strainwave.fidelity.scene import with_torque
from strainwave.fidelity.tones import NOTCH_ORDERS
from strainwave.fidelity.verdict import STEP_ERROR_LIMIT
from strainwave.samples import Samples

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from strainwave.evidence.motion import Motion
    from strainwave.methods.interface import Cleaned

#: Height of a contact, of the rated torque.
CONTACT_SHARE: Final = 0.1
#: How long a contact is held, where the motion lasts, and at least, s.
HELD_S: Final = 1.0
SHORTEST_HELD_S: Final = 0.1
#: What is looked at before and after it, s.
BEFORE_S: Final = 0.020
AFTER_S: Final = 0.200
#: Where steps begin, as shares of the time in motion.
STEPS_AT: Final = (0.2, 0.5, 0.8)
REST_AT: Final = 0.5
#: A push that comes and goes: length where the motion lasts, and frequencies, of which the first
#: away from every removed order is taken.
SINE_S: Final = 2.0
SINE_AT: Final = 0.65
SINES_Hz: Final = (2.0, 1.0, 3.0, 1.5)


@dataclass(frozen=True)
class Contact:
    """One torque that was added, and what came through.

    Attributes
    ----------
    name : str
        "step in motion", "step at rest" or "sine in motion".
    motor_speed_rad_s : float
        Motor speed when it begins, rad/s.
    height_Nm : float
        Its largest torque, Nm.
    frequency_Hz : float or None
        Of a sine; None for a step.
    is_near_order : bool
        A sine that comes within 0.3 order of a removed one at the motor's speeds: a filter that
        removes the order cannot but take of it.
    begins_s, ends_s : float
        Time as the recording counts it, s.
    time_s : numpy.ndarray
        Time since it begins, shape (rows,), s.
    added_Nm, through_Nm : numpy.ndarray
        What was added, and what the output shows of it, shape (rows,), Nm; NaN where the method did
        not use the row.
    """

    name: str
    motor_speed_rad_s: float
    height_Nm: float
    frequency_Hz: float | None
    is_near_order: bool
    begins_s: float
    ends_s: float
    time_s: NDArray[np.float64]
    added_Nm: NDArray[np.float64]
    through_Nm: NDArray[np.float64]

    @property
    def largest_error(self) -> float:
        """Largest difference of what came through and what was added, over the height."""
        return float(np.nanmax(np.abs(self.through_Nm - self.added_Nm))) / self.height_Nm

    @property
    def error_at_20_ms(self) -> float | None:
        """The difference at the first used row from 20 ms after a step on; None for a sine."""
        if self.frequency_Hz is not None:
            return None
        known = np.isfinite(self.through_Nm) & (self.time_s >= JUDGED_S * (1.0 - 1e-6))
        first = int(np.argmax(known))
        return abs(float(self.through_Nm[first] - self.added_Nm[first])) / self.height_Nm

    @property
    def is_swallowed(self) -> bool:
        """Whether a step shows less than `strainwave fidelity` asks for after 20 ms."""
        error = self.error_at_20_ms
        return error is not None and error > STEP_ERROR_LIMIT

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name.

        Returns
        -------
        dict
            What was added and the errors, relative to its height.
        """
        return {
            "name": self.name,
            "motor_speed_rad_s": self.motor_speed_rad_s,
            "height_Nm": self.height_Nm,
            "frequency_Hz": self.frequency_Hz,
            "is_near_order": self.is_near_order,
            "begins_s": self.begins_s,
            "ends_s": self.ends_s,
            "largest_error": self.largest_error,
            "error_at_20_ms": self.error_at_20_ms,
        }


@dataclass(frozen=True)
class Scene:
    """What contacts are added to.

    Attributes
    ----------
    samples : Samples
        The rows.
    log_time_s : numpy.ndarray
        Their time as the recording counts it, shape (rows,), s.
    motion : Motion
        Those in motion.
    run : callable
        Runs the method from its start over samples.
    rated_torque_Nm : float
        Full scale, Nm.
    removed : tuple of float
        Orders that the method removes, cycles per motor turn.
    """

    samples: Samples
    log_time_s: NDArray[np.float64]
    motion: Motion
    run: Callable[[Samples], Cleaned]
    rated_torque_Nm: float
    removed: tuple[float, ...]


def add_contacts(scene: Scene, plain: Cleaned) -> tuple[Contact, ...]:
    """Add steps and a sine to a recording, each by itself, and see what comes through.

    Parameters
    ----------
    scene : Scene
        The recording and the method.
    plain : Cleaned
        What the method makes of the recording as it is.

    Returns
    -------
    tuple of Contact
        Steps in motion, a sine in motion, a step at rest; fewer where the recording has no such
        moments.
    """
    moving = moments_in_motion(scene.samples, scene.motion)
    rest = moments_at_rest(scene.samples, scene.motion)
    held = (HELD_S, SHORTEST_HELD_S, BEFORE_S + AFTER_S)
    pushed = (SINE_S, min(1.0 / each for each in SINES_Hz), BEFORE_S + AFTER_S)
    contacts = [
        *(_step(scene, plain, "step in motion", each) for each in moving.at(STEPS_AT, *held)),
        *(_sine(scene, plain, each) for each in moving.at((SINE_AT,), *pushed)),
        *(_step(scene, plain, "step at rest", each) for each in rest.at((REST_AT,), *held)),
    ]
    return tuple(each for each in contacts if np.isfinite(each.through_Nm).any())


def _step(scene: Scene, plain: Cleaned, name: str, moment: Moment) -> Contact:
    time_s = scene.samples.time_s - moment.begins_s
    height_Nm = CONTACT_SHARE * scene.rated_torque_Nm
    added_Nm = np.where((time_s >= 0.0) & (time_s < moment.length_s), height_Nm, 0.0)
    return _contact(scene, plain, moment, added_Nm, (name, height_Nm, None))


def _sine(scene: Scene, plain: Cleaned, moment: Moment) -> Contact:
    slow_Hz, fast_Hz = (
        each / (2 * math.pi) for each in (moment.slowest_rad_s, moment.fastest_rad_s)
    )

    def is_near(frequency_Hz: float) -> bool:
        # At some speed that the motor has meanwhile.
        return any(
            (order - NOTCH_ORDERS) * slow_Hz < frequency_Hz < (order + NOTCH_ORDERS) * fast_Hz
            for order in scene.removed
        )

    fitting = [each for each in SINES_Hz if each * moment.length_s >= 1.0]
    frequency_Hz = next((each for each in fitting if not is_near(each)), fitting[0])
    periods = math.floor(frequency_Hz * moment.length_s + 1e-9)
    moment = replace(moment, length_s=periods / frequency_Hz)
    time_s = scene.samples.time_s - moment.begins_s
    height_Nm = CONTACT_SHARE * scene.rated_torque_Nm
    within = (time_s >= 0.0) & (time_s < moment.length_s)
    phase_rad = 2 * math.pi * frequency_Hz * np.where(within, time_s, 0.0)
    added_Nm = np.asarray(height_Nm * np.sin(phase_rad))
    what = ("sine in motion", height_Nm, frequency_Hz)
    return _contact(scene, plain, moment, added_Nm, what, is_near_order=is_near(frequency_Hz))


def _contact(
    scene: Scene,
    plain: Cleaned,
    moment: Moment,
    added_Nm: NDArray[np.float64],
    what: tuple[str, float, float | None],
    *,
    is_near_order: bool = False,
) -> Contact:
    added_Nm = held_with_the_rows(scene.samples, np.where(np.isfinite(added_Nm), added_Nm, 0.0))
    touched = scene.run(with_torque(scene.samples, added_Nm))
    used = ((plain.status | touched.status) & np.uint32(_core.FAULT_MASK)) == 0
    through_Nm = np.where(used, touched.torque_Nm - plain.torque_Nm, np.nan)
    time_s = scene.samples.time_s - moment.begins_s
    shown = np.flatnonzero((time_s >= -BEFORE_S) & (time_s <= moment.length_s + AFTER_S))
    name, height_Nm, frequency_Hz = what
    first_s = scene.log_time_s[shown[0]] - time_s[shown[0]]
    return Contact(
        name,
        moment.motor_speed_rad_s,
        height_Nm,
        frequency_Hz,
        is_near_order,
        float(first_s),
        float(first_s + moment.length_s),
        time_s[shown],
        added_Nm[shown],
        through_Nm[shown],
    )


def held_with_the_rows(samples: Samples, added_Nm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Hold an added torque where the recording holds its own: as a real contact would be recorded.

    Parameters
    ----------
    samples : Samples
        The recording.
    added_Nm : numpy.ndarray
        Torque to be added, shape (rows,), Nm.

    Returns
    -------
    numpy.ndarray
        The same; rows that repeat the row before have its torque.
    """
    repeats = (np.diff(samples.motor_angle_rad) == 0.0) & (np.diff(samples.torque_Nm) == 0.0)
    new = np.append(True, ~repeats)
    return np.asarray(added_Nm[np.maximum.accumulate(np.where(new, np.arange(len(new)), 0))])
