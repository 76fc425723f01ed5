"""What a method does to true torque: gain and delay from 1 to 20 Hz, and a contact at rest.

Each figure compares two runs of one joint that differ in nothing but an added torque, so ripple,
noise and the joint's own load drop out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from benchmarks.accuracy.evaluation import SIMULATED, log_of
from benchmarks.accuracy.joint import FULL_SCALE_NM, Joint, make_joint, simulate
from benchmarks.accuracy.load import pulse
from benchmarks.accuracy.methods.catalogue import BY_NAME
from benchmarks.accuracy.motion import (
    SAMPLE_PERIOD_S,
    STANDSTILL,
    STEADY,
    constant_plan,
    full_plan,
    move,
)
from benchmarks.accuracy.ripple import RIGHT

if TYPE_CHECKING:
    from numpy.typing import NDArray

SEED: Final = 1
FREQUENCIES_HZ: Final = (1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 14.0, 20.0)
#: The group delay at each comes from two tones this far to either side.
SPREAD_HZ: Final = 0.25
TONE_NM: Final = 0.1
SETTLING_S: Final = 16.0
#: All tones have whole periods in it.
MEASURED_S: Final = 20.0
CONTACT_NM: Final = 10.0
#: Start and length of the contact, after the joint's own pushes at standstill.
CONTACT_START_S: Final = 3.8
CONTACT_LENGTH_S: Final = 0.9
#: Below this gain there is nothing left that could be late.
SMALLEST_GAIN_WITH_DELAY: Final = 0.01


@dataclass(frozen=True)
class Fidelity:
    """What a method does to true torque.

    Attributes
    ----------
    gain : tuple of float
        Gain at each of `FREQUENCIES_HZ`.
    delay_ms : tuple of float
        Group delay there, ms; NaN where nothing passes.
    contact_error_percent : float
        10 Nm at standstill, the mesh loaded by it: largest change of the error from 50 ms after
        the edges on, percent of full scale.
    contact_peak_percent : float
        The same with the edges.
    injected_error_percent : float
        10 Nm added to the log, so that the ripple does not follow: largest difference from 10 Nm.
    bit_exact : bool
        Whether the removed ripple is the same to the last bit with and without the injected 10 Nm.
    """

    gain: tuple[float, ...]
    delay_ms: tuple[float, ...]
    contact_error_percent: float
    contact_peak_percent: float
    injected_error_percent: float
    bit_exact: bool


def fidelity(method_name: str, tuning: Mapping[str, Any]) -> Fidelity:
    """Measure a method.

    Parameters
    ----------
    method_name : str
        The method.
    tuning : mapping
        Its tuning.

    Returns
    -------
    Fidelity
        Gain, delay, contact.
    """
    joint = make_joint(RIGHT, SEED)
    gain, delay_ms = pass_through(method_name, tuning, joint)
    loaded_Nm, at_rest, edges = _contact(method_name, tuning, joint, ripple_sees_added=True)[:3]
    *_, injected_Nm, same = _contact(method_name, tuning, joint, ripple_sees_added=False)
    percent = 100 / FULL_SCALE_NM
    return Fidelity(
        gain,
        delay_ms,
        percent * float(np.max(np.abs(loaded_Nm[at_rest & ~edges]))),
        percent * float(np.max(np.abs(loaded_Nm[at_rest]))),
        percent * injected_Nm,
        same,
    )


def pass_through(
    method_name: str, tuning: Mapping[str, Any], joint: Joint
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Gain and group delay of true torque at constant speed, ripple present.

    Parameters
    ----------
    method_name : str
        The method.
    tuning : mapping
        Its tuning.
    joint : Joint
        The joint.

    Returns
    -------
    gain : tuple of float
        At each of `FREQUENCIES_HZ`.
    delay_ms : tuple of float
        Likewise, ms.
    """
    plan = constant_plan(SETTLING_S + MEASURED_S)
    motion = move(plan)
    start = int(np.argmax(motion.phase == STEADY)) + round(SETTLING_S / SAMPLE_PERIOD_S)
    tones_Hz = np.array([f + d for f in FREQUENCIES_HZ for d in (-SPREAD_HZ, SPREAD_HZ)])
    # Schroeder's phases, so that the sum of tones is no pulse.
    crest_rad = np.pi * np.arange(len(tones_Hz)) ** 2 / len(tones_Hz)
    turned = 2 * np.pi * np.multiply.outer(motion.time_s, tones_Hz) + crest_rad
    added = TONE_NM * np.sin(turned).sum(axis=1) * (motion.phase == STEADY)
    runs = [simulate(joint, plan, torque) for torque in (None, added)]
    remove = BY_NAME[method_name].remove
    outputs = [remove(log_of(run), SIMULATED, **tuning).torque_Nm for run in runs]
    difference_in = runs[1].measured_torque_Nm - runs[0].measured_torque_Nm
    response = complex_response(
        difference_in[start:],
        (outputs[1] - outputs[0])[start:],
        tones_Hz,
        1 / SAMPLE_PERIOD_S,
    )
    below, above = response[0::2], response[1::2]
    passes = np.minimum(np.abs(below), np.abs(above)) > SMALLEST_GAIN_WITH_DELAY
    turned_rad = np.angle(above * np.conj(below))
    delay_ms = np.where(passes, -1e3 * turned_rad / (2 * np.pi * 2 * SPREAD_HZ), np.nan)
    gain = 0.5 * (np.abs(below) + np.abs(above))
    return tuple(gain.tolist()), tuple(delay_ms.tolist())


def complex_response(
    given: NDArray[np.float64],
    got: NDArray[np.float64],
    tones_Hz: NDArray[np.float64],
    sample_rate_Hz: float,
) -> NDArray[np.complex128]:
    """Ratio of two signals' tones, all fitted together with a mean and a slope.

    Parameters
    ----------
    given, got : numpy.ndarray
        Input and output, shape (samples,).
    tones_Hz : numpy.ndarray
        Frequencies.
    sample_rate_Hz : float
        Sampling rate.

    Returns
    -------
    numpy.ndarray
        Response at each tone.
    """
    time_s = np.arange(len(given)) / sample_rate_Hz
    turned = 2 * np.pi * np.multiply.outer(time_s, tones_Hz)
    slow = np.column_stack([np.ones(len(given)), np.linspace(-1, 1, len(given))])
    basis = np.concatenate([np.cos(turned), np.sin(turned), slow], axis=1)
    fit = np.linalg.lstsq(basis, np.column_stack([given, got]), rcond=None)[0]
    tones = len(tones_Hz)
    phasors = fit[:tones] - 1j * fit[tones : 2 * tones]
    return np.asarray(phasors[:, 1] / phasors[:, 0])


def _contact(
    method_name: str, tuning: Mapping[str, Any], joint: Joint, *, ripple_sees_added: bool
) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], float, bool]:
    plan = full_plan(joint.speed_scale)
    motion = move(plan, joint.start_angle_rad)
    at_rest = motion.phase == STANDSTILL
    start_s = motion.time_s[at_rest][0] + CONTACT_START_S
    end_s = start_s + CONTACT_LENGTH_S
    added = CONTACT_NM * pulse(motion.time_s, start_s, end_s)
    runs = [
        simulate(joint, plan, torque, ripple_sees_added=ripple_sees_added)
        for torque in (None, added)
    ]
    remove = BY_NAME[method_name].remove
    without, contact = (remove(log_of(run), SIMULATED, **tuning) for run in runs)
    change = (contact.torque_Nm - runs[1].true_torque_Nm) - (
        without.torque_Nm - runs[0].true_torque_Nm
    )
    since_s = [motion.time_s - start_s, motion.time_s - end_s]
    edges = np.any([(s >= 0) & (s < 0.05) for s in since_s], axis=0)
    injected = np.abs(
        (contact.torque_Nm - without.torque_Nm)
        - (runs[1].measured_torque_Nm - runs[0].measured_torque_Nm)
    )
    same = bool(np.array_equal(contact.ripple_Nm[at_rest], without.ripple_Nm[at_rest]))
    return change, at_rest, edges, float(injected[at_rest].max()), same
