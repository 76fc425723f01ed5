"""The Med7's recording: how much ripple goes, and how much of an injected contact goes with it.

Joints 1 to 4, rows that only repeat a sample counted once, every
method run from the start of the file and judged at constant speed near its end. A known contact
torque is added to the log; what the output does not show of it is the error. No reference torque is
needed for either figure.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from benchmarks.accuracy.methods.interface import Log, Method, Setting
from benchmarks.accuracy.metrics import attenuation_dB, line_powers, power_change_outside_dB
from benchmarks.accuracy.recordings import (
    KUKA_CONSTANT_SPEED,
    JointRecording,
    counted_once,
    read_joint,
)

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

JOINTS: Final = (1, 2, 3, 4)
RATIO: Final = 160.0
ORDERS: Final = (2, 4)
#: Of the joints 1 and 2 and of 3 and 4; it sets no more than the filter's first guess.
RATED_TORQUE_NM: Final = (176.0, 176.0, 110.0, 110.0)
EVALUATED_S: Final = (22.5, 29.5)
WINDOWS: Final = 5
SLOW_DEGREE: Final = 3
#: The robot stands, and is left alone, until here: what its torque does from sample to sample is
#: noise. From 6.7 s on the arm is touched or settles; joint 4 shows it most.
AT_REST_UNTIL_S: Final = 6.0
STEP_NM: Final = 3.0
STEP_S: Final = (24.0, 26.0)
SINE_NM: Final = 2.0
SINE_HZ: Final = 3.0
SINE_S: Final = (27.0, 29.0)


@dataclass(frozen=True)
class KukaScore:
    """One method, one tuning, one joint.

    Attributes
    ----------
    method : str
        Name of the method.
    tuning : str
        Its tuning in words.
    joint : int
        Number of the joint.
    attenuation_dB : tuple of float
        Of orders 2 and 4; power averaged over five windows.
    injection_error_percent : float
        Largest difference between injected torque and what the output shows of it, percent of the
        step's 3 Nm.
    outside_dB : float
        Change of power more than 0.3 order beside the lines.
    """

    method: str
    tuning: str
    joint: int
    attenuation_dB: tuple[float, ...]
    injection_error_percent: float
    outside_dB: float

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name.

        Returns
        -------
        dict
            The score.
        """
        return asdict(self)


def read_kuka_joint(folder: Path, joint: int) -> JointRecording:
    """Read a joint, repeated rows left out.

    Parameters
    ----------
    folder : pathlib.Path
        Folder of the recordings.
    joint : int
        Its number, from 1.

    Returns
    -------
    JointRecording
        A signal of about 100 Hz.
    """
    return counted_once(
        read_joint(
            folder / KUKA_CONSTANT_SPEED,
            time="t_s",
            angle=f"q{joint}_rad",
            torque=f"tau{joint}_Nm",
            ratio=RATIO,
        )
    )


def injected_torque_Nm(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the contact torque: a step and a sine.

    Parameters
    ----------
    time_s : numpy.ndarray
        Time in the file, s.

    Returns
    -------
    numpy.ndarray
        Torque, Nm.
    """
    step = STEP_NM * ((time_s >= STEP_S[0]) & (time_s < STEP_S[1]))
    within = (time_s >= SINE_S[0]) & (time_s < SINE_S[1])
    return step + SINE_NM * np.sin(2 * np.pi * SINE_HZ * (time_s - SINE_S[0])) * within


def setting_of(recording: JointRecording, rated_torque_Nm: float) -> Setting:
    """State what is known of a joint before its log is filtered.

    Parameters
    ----------
    recording : JointRecording
        The recording; period and noise at rest are taken from it.
    rated_torque_Nm : float
        Full scale.

    Returns
    -------
    Setting
        Orders 2 and 4, constant terms.
    """
    at_rest = recording.torque_Nm[recording.time_s < AT_REST_UNTIL_S]
    return Setting(
        sample_period_s=float(np.median(np.diff(recording.time_s))),
        ratio=recording.ratio,
        rated_torque_Nm=rated_torque_Nm,
        torque_noise_Nm=float(np.std(np.diff(at_rest)) / np.sqrt(2)),
        orders=ORDERS,
    )


def score_on_kuka(
    method: Method, tuning: Mapping[str, Any], recording: JointRecording, joint: int
) -> KukaScore:
    """Measure a method on a joint.

    Parameters
    ----------
    method : Method
        The method.
    tuning : mapping
        Its tuning.
    recording : JointRecording
        From `read_kuka_joint`.
    joint : int
        Number of the joint.

    Returns
    -------
    KukaScore
        Attenuation and fidelity.
    """
    setting = setting_of(recording, RATED_TORQUE_NM[joint - 1])
    injected = injected_torque_Nm(recording.time_s)
    outputs = [
        method.remove(
            Log(
                recording.time_s,
                # The Med7's ripple has a whole number of cycles per motor turn: m = 1.
                recording.motor_angle_rad,
                recording.torque_Nm + added,
                np.zeros(len(injected)),
            ),
            setting,
            **tuning,
        ).torque_Nm
        for added in (np.zeros(len(injected)), injected)
    ]
    first, last = np.searchsorted(recording.time_s, EVALUATED_S)
    edges = np.linspace(first, last, WINDOWS + 1).astype(int)
    windows = [slice(a, b) for a, b in pairwise(edges)]
    before, after = (
        line_powers(values, recording.motor_angle_rad, ORDERS, windows, SLOW_DEGREE)
        for values in (recording.torque_Nm, outputs[0])
    )
    turns = abs(recording.motor_angle_rad[last] - recording.motor_angle_rad[first]) / (2 * np.pi)
    outside_dB, _ = power_change_outside_dB(
        recording.torque_Nm[first:last],
        outputs[0][first:last],
        sample_rate_Hz=(last - first) / (recording.time_s[last] - recording.time_s[first]),
        turn_Hz=turns / (recording.time_s[last] - recording.time_s[first]),
        orders=ORDERS,
    )
    error = np.max(np.abs(outputs[1] - outputs[0] - injected))
    return KukaScore(
        method.name,
        ", ".join(f"{name} {value:g}" for name, value in tuning.items()),
        joint,
        tuple(attenuation_dB(before, after).tolist()),
        float(100 * error / STEP_NM),
        outside_dB,
    )
