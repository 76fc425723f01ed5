"""The other recordings: that they run through, and what becomes of order 2 in them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from benchmarks.accuracy.kuka import ORDERS
from benchmarks.accuracy.kuka import RATIO as MED7_RATIO
from benchmarks.accuracy.methods.interface import Log, Setting
from benchmarks.accuracy.methods.ours import remove
from benchmarks.accuracy.metrics import attenuation_dB, even_windows, line_powers
from benchmarks.accuracy.recordings import (
    KUKA_EXCITING,
    LARA_JOGGING,
    LARA_VALIDATE,
    JointRecording,
    counted_once,
    read_joint,
)

if TYPE_CHECKING:
    from pathlib import Path

MEMORY_TURNS: Final = 5.0
TORQUE_WALK_OVER_NOISE: Final = 1.0
#: Lines are fitted where a window holds this many motor turns and order 2 is well sampled.
WINDOW_S: Final = 0.5
LEAST_TURNS: Final = 3.0
LEAST_SAMPLES_PER_CYCLE: Final = 3.0
#: Sets no more than the filter's first guess; the data sheets' numbers are not in the recordings.
RATED_TORQUE_NM: Final = 100.0
LARA_RATIOS: Final = {1: 121.0, 2: 121.0, 3: 101.0}
EXCITING_RATE_HZ: Final = 100.0


@dataclass(frozen=True)
class RunThrough:
    """One joint of a recording, through the default filter.

    Attributes
    ----------
    file : str
        Name of the file.
    joint : int
        Number of the joint, from 1.
    rows, repeated : int
        Rows in the file, and those that only repeat the one before.
    finite : bool
        Whether every row's torque came out as a number.
    windows : int
        Windows in which lines could be fitted.
    order_2_before_Nm : float or None
        Amplitude of order 2 before, rms over the windows; None without a window.
    attenuation_dB : float or None
        Of order 2, power averaged over the windows; None likewise.
    """

    file: str
    joint: int
    rows: int
    repeated: int
    finite: bool
    windows: int
    order_2_before_Nm: float | None
    attenuation_dB: float | None

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name.

        Returns
        -------
        dict
            The result.
        """
        return asdict(self)


def run_through(folder: Path) -> list[RunThrough]:
    """Run the default filter over the file without time column and both Lara8 files.

    Parameters
    ----------
    folder : pathlib.Path
        Folder of the recordings.

    Returns
    -------
    list of RunThrough
        One for each joint.
    """
    results = []
    for joint in (1, 2, 3, 4):
        recording = read_joint(
            folder / KUKA_EXCITING,
            time=EXCITING_RATE_HZ,
            angle=f"q_{joint - 1}",
            torque=f"tau_{joint - 1}",
            ratio=MED7_RATIO,
        )
        results.append(_one(KUKA_EXCITING, joint, recording))
    for file in (LARA_VALIDATE, LARA_JOGGING):
        for joint, ratio in LARA_RATIOS.items():
            recording = read_joint(
                folder / file,
                time="Timestamp",
                angle=f"joint_angles_{joint}",
                torque=f"joint_torque_current_{joint}",
                ratio=ratio,
            )
            results.append(_one(file, joint, recording))
    return results


def _one(file: str, joint: int, recording: JointRecording) -> RunThrough:
    once = counted_once(recording)
    period_s = float(np.median(np.diff(once.time_s)))
    setting = Setting(
        sample_period_s=period_s,
        ratio=once.ratio,
        rated_torque_Nm=RATED_TORQUE_NM,
        # None of these stands long enough to show its noise at rest.
        torque_noise_Nm=float(np.median(np.abs(np.diff(once.torque_Nm)))) + 1e-4,
        orders=ORDERS,
    )
    output = remove(
        Log(once.time_s, once.motor_angle_rad, once.torque_Nm, np.zeros(len(once.time_s))),
        setting,
        memory_turns=MEMORY_TURNS,
        torque_walk_over_noise=TORQUE_WALK_OVER_NOISE,
    ).torque_Nm
    windows = _windows(once, period_s)
    before_Nm = attenuation = None
    if windows:
        before, after = (
            line_powers(values, once.motor_angle_rad, ORDERS, windows, polynomial_degree=3)
            for values in (once.torque_Nm, output)
        )
        before_Nm = float(np.sqrt(before[0]))
        attenuation = float(attenuation_dB(before, after)[0])
    return RunThrough(
        file,
        joint,
        len(recording.time_s),
        len(recording.time_s) - len(once.time_s),
        bool(np.all(np.isfinite(output))),
        len(windows),
        before_Nm,
        attenuation,
    )


def _windows(recording: JointRecording, period_s: float) -> list[slice]:
    chosen = []
    for window in even_windows(0, len(recording.time_s), round(WINDOW_S / period_s)):
        steps = np.diff(recording.motor_angle_rad[window])
        turns = abs(np.sum(steps)) / (2 * np.pi)
        fastest = np.max(np.abs(steps)) / (2 * np.pi)
        if turns >= LEAST_TURNS and fastest * ORDERS[0] * LEAST_SAMPLES_PER_CYCLE < 1:
            chosen.append(window)
    return chosen
