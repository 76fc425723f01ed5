"""The torque that a joint truly transmits: gravity, inertia, friction of the output, contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks.accuracy.motion import CONTACT, STANDSTILL, Motion

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: A contact is not instantaneous: skin, rubber, structure. Half a cosine of this length.
RISE_S: Final = 0.008


@dataclass(frozen=True)
class Load:
    """What hangs on the output, and what it meets.

    Attributes
    ----------
    gravity_Nm : float
        Torque of the arm when it is level.
    gravity_phase_rad : float
        Where it is at motor angle 0.
    second_gravity_Nm : float
        Part with two cycles per output turn: an elbow that moves along.
    inertia_kg_m2 : float
        Inertia on the output side.
    coulomb_Nm, viscous_Nm : float
        Friction behind the sensor; the viscous part at full speed.
    contact_Nm : float
        Height of contact steps.
    chirp_Nm : float
        Amplitude of contact chirps.
    """

    gravity_Nm: float
    gravity_phase_rad: float
    second_gravity_Nm: float
    inertia_kg_m2: float
    coulomb_Nm: float
    viscous_Nm: float
    contact_Nm: float
    chirp_Nm: float


def draw_load(random: np.random.Generator) -> Load:
    """Draw a plausible load for a joint of 40 Nm.

    Parameters
    ----------
    random : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    Load
        The load.
    """
    return Load(
        gravity_Nm=random.uniform(6.0, 10.0),
        gravity_phase_rad=random.uniform(0.0, 2 * np.pi),
        second_gravity_Nm=random.uniform(0.5, 1.5),
        inertia_kg_m2=random.uniform(0.8, 1.6),
        coulomb_Nm=random.uniform(0.5, 1.5),
        viscous_Nm=random.uniform(0.3, 1.0),
        contact_Nm=random.uniform(8.0, 12.0),
        chirp_Nm=random.uniform(2.0, 4.0),
    )


def carried_torque_Nm(
    load: Load, motion: Motion, ratio: float, full_speed_rad_s: float
) -> NDArray[np.float64]:
    """Compute the torque without contacts.

    Parameters
    ----------
    load : Load
        What hangs on the output.
    motion : Motion
        How the motor turns.
    ratio : float
        Motor turns per output turn.
    full_speed_rad_s : float
        Motor speed at which the viscous part is given.

    Returns
    -------
    numpy.ndarray
        Torque, shape (samples,), Nm.
    """
    output_rad = motion.angle_rad / ratio + load.gravity_phase_rad
    return (
        load.gravity_Nm * np.sin(output_rad)
        + load.second_gravity_Nm * np.sin(2 * output_rad + 1.0)
        + load.inertia_kg_m2 * motion.acceleration_rad_s2 / ratio
        + load.coulomb_Nm * np.tanh(motion.speed_rad_s / 3.0)
        + load.viscous_Nm * motion.speed_rad_s / full_speed_rad_s
    )


def pulse(time_s: NDArray[np.float64], start_s: float, end_s: float) -> NDArray[np.float64]:
    """Shape of a contact of height 1.

    Parameters
    ----------
    time_s : numpy.ndarray
        Time, shape (samples,), s.
    start_s, end_s : float
        When it begins and when it begins to go.

    Returns
    -------
    numpy.ndarray
        0 before and after, 1 between, half cosines at the edges.
    """
    up = np.clip((time_s - start_s) / RISE_S, 0.0, 1.0)
    down = np.clip((time_s - end_s) / RISE_S, 0.0, 1.0)
    return 0.5 * (np.cos(np.pi * down) - np.cos(np.pi * up))


def chirp(
    time_s: NDArray[np.float64], start_s: float, end_s: float, highest_Hz: float
) -> NDArray[np.float64]:
    """Shape of a contact that goes from 0.5 Hz to a highest frequency, of amplitude 1.

    Parameters
    ----------
    time_s : numpy.ndarray
        Time, shape (samples,), s.
    start_s, end_s : float
        When it begins and ends.
    highest_Hz : float
        Frequency at the end; it rises linearly.

    Returns
    -------
    numpy.ndarray
        The chirp, 0 outside, faded in and out over 0.2 s.
    """
    since_s = np.clip(time_s - start_s, 0.0, end_s - start_s)
    slope_Hz_s = (highest_Hz - 0.5) / (end_s - start_s)
    fade = np.clip(np.minimum(time_s - start_s, end_s - time_s) / 0.2, 0.0, 1.0)
    return fade * np.sin(2 * np.pi * (0.5 * since_s + 0.5 * slope_Hz_s * since_s**2))


def contact_torque_Nm(load: Load, motion: Motion) -> NDArray[np.float64]:
    """Compute the contacts of a full run: in the contact phase, and pushes at standstill.

    Parameters
    ----------
    load : Load
        Their heights.
    motion : Motion
        Says when the phases are; runs without these phases have no contacts.

    Returns
    -------
    numpy.ndarray
        Torque, shape (samples,), Nm.
    """
    time_s = motion.time_s
    torque = np.zeros(len(time_s))
    for phase, contacts in (
        (CONTACT, ((0.5, 2.0, 1.0), (2.5, 4.0, -0.8), (4.3, 4.4, 0.6))),
        (STANDSTILL, ((1.0, 2.0, 1.0), (2.5, 3.5, -0.7))),
    ):
        within = motion.phase == phase
        if not np.any(within):
            continue
        start_s = time_s[within][0]
        for begin_s, end_s, share in contacts:
            torque += share * load.contact_Nm * pulse(time_s, start_s + begin_s, start_s + end_s)
        if phase == CONTACT:
            torque += load.chirp_Nm * chirp(time_s, start_s + 5.0, start_s + 9.0, 20.0)
            torque += 0.6 * load.chirp_Nm * chirp(time_s, start_s + 9.5, start_s + 13.5, 20.0)
    return torque
