"""Contact steps: a quarter of the rated torque from one sample to the next, in motion and at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.fidelity.scene import (
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

#: Height of a contact, of the rated torque.
CONTACT_SHARE: Final = 0.25
#: When the answer is judged.
JUDGED_S: Final = 0.020
#: What is shown around a contact.
BEFORE_S: Final = 0.020
AFTER_S: Final = 0.200
#: What a method that looks ahead sees after that.
BEYOND_S: Final = 1.0
#: In motion contacts are tried at so many angles, this far apart: quarter periods of order 2.
ANGLES: Final = 4
ANGLE_STEP_RAD: Final = np.pi / 4
#: Before a contact at rest: speed of the motion, time to stop, time at rest.
SPEED_BEFORE_REST_RAD_S: Final = 50.0
STOPPING_S: Final = 0.2
REST_S: Final = 1.0


@dataclass(frozen=True)
class ContactResponse:
    """Answer to a contact; in motion that of the worst of several angles.

    Attributes
    ----------
    motor_speed_rad_s : float
        Motor speed, rad/s; 0 at standstill.
    time_s : numpy.ndarray
        Time since the contact, shape (rows,), s; negative before it.
    response : numpy.ndarray
        Change of the output over the height of the contact; the true torque is 0, then 1.
    """

    motor_speed_rad_s: float
    time_s: NDArray[np.float64]
    response: NDArray[np.float64]

    @property
    def error(self) -> NDArray[np.float64]:
        """Output less true torque, over the height of the contact."""
        return np.asarray(self.response - (self.time_s >= 0.0))

    @property
    def error_at_20_ms(self) -> float:
        """Magnitude of the error at the first sample at least 20 ms after the contact."""
        # Half a per cent of a sample: a time that is rounded is not late.
        period_s = self.time_s[1] - self.time_s[0]
        first = int(np.argmax(self.time_s >= JUDGED_S - 5e-3 * period_s))
        return float(np.abs(self.error[first]))

    @property
    def largest_error(self) -> float:
        """Largest magnitude of the error, from 20 ms before to 200 ms after the contact."""
        return float(np.max(np.abs(self.error)))


def contact_in_motion(
    subject: Subject, motor_speed_rad_s: float, *, angles: int = ANGLES
) -> ContactResponse:
    """Measure a contact at constant speed.

    Parameters
    ----------
    subject : Subject
        The method under test.
    motor_speed_rad_s : float
        Motor speed, above 0, rad/s.
    angles : int
        Motor angles that are tried.

    Returns
    -------
    ContactResponse
        Of the angle with the largest error at 20 ms.
    """
    start_s = settling_s(subject, motor_speed_rad_s)
    step_s = ANGLE_STEP_RAD / motor_speed_rad_s
    starts = [rows_of(subject, start_s + n * step_s) for n in range(angles)]
    rows = starts[-1] + rows_of(subject, AFTER_S + BEYOND_S) + 1
    turns = start_s * motor_speed_rad_s / (2 * np.pi)
    recording = ripple_recording(
        subject,
        np.full(rows, motor_speed_rad_s),
        lines_apart(subject.ripple_orders, turns),
    )
    plain_Nm = subject.run(recording)
    answers = [_contact(subject, recording, plain_Nm, start, motor_speed_rad_s) for start in starts]
    return max(answers, key=lambda answer: answer.error_at_20_ms)


def contact_at_rest(subject: Subject) -> ContactResponse:
    """Measure a contact while the motor stands, after it has moved.

    Parameters
    ----------
    subject : Subject
        The method under test.

    Returns
    -------
    ContactResponse
        The answer.
    """
    moving = rows_of(subject, settling_s(subject, SPEED_BEFORE_REST_RAD_S))
    stopping = rows_of(subject, STOPPING_S)
    start = moving + stopping + rows_of(subject, REST_S)
    rest = start - moving - stopping + rows_of(subject, AFTER_S + BEYOND_S) + 1
    speed = SPEED_BEFORE_REST_RAD_S * np.concatenate(
        [np.ones(moving), np.linspace(1.0, 0.0, stopping), np.zeros(rest)]
    )
    turns = moving * subject.sample_period_s * SPEED_BEFORE_REST_RAD_S / (2 * np.pi)
    recording = ripple_recording(subject, speed, lines_apart(subject.ripple_orders, turns))
    return _contact(subject, recording, subject.run(recording), start, 0.0)


def _contact(
    subject: Subject,
    recording: Samples,
    plain_Nm: NDArray[np.float64],
    start: int,
    motor_speed_rad_s: float,
) -> ContactResponse:
    height_Nm = CONTACT_SHARE * subject.rated_torque_Nm
    added_Nm = np.zeros(len(recording))
    added_Nm[start:] = height_Nm
    change_Nm = subject.run(with_torque(recording, added_Nm)) - plain_Nm
    first = max(0, start - rows_of(subject, BEFORE_S))
    last = start + rows_of(subject, AFTER_S) + 1
    samples = np.arange(first - start, last - start, dtype=np.float64)
    time_s = subject.sample_period_s * samples
    return ContactResponse(motor_speed_rad_s, time_s, change_Nm[first:last] / height_Nm)
