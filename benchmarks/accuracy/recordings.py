"""Reads the real recordings; nothing else about them is decided here."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: Names the folder; without it, `../shared/recordings` beside the repository.
ENVIRONMENT_VARIABLE: Final = "STRAINWAVE_RECORDINGS"
_BESIDE: Final = Path(__file__).resolve().parents[3] / "shared" / "recordings"

KUKA_CONSTANT_SPEED: Final = "kuka-lbr-med7/constant-speed-400hz.csv"
KUKA_EXCITING: Final = "kuka-lbr-med7/exciting-100hz.csv"
LARA_VALIDATE: Final = "neura-lara8/validate-250hz.csv"
LARA_JOGGING: Final = "neura-lara8/jogging-250hz.csv"


@dataclass(frozen=True)
class JointRecording:
    """One joint of a recording.

    Attributes
    ----------
    time_s : numpy.ndarray
        Time stamps, shape (rows,), s.
    motor_angle_rad : numpy.ndarray
        Joint angle times the ratio, shape (rows,), rad.
    torque_Nm : numpy.ndarray
        Torque, shape (rows,), Nm.
    ratio : float
        Motor turns per output turn.
    """

    time_s: NDArray[np.float64]
    motor_angle_rad: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]
    ratio: float


def recordings_folder() -> Path:
    """Find the folder of the recordings.

    Returns
    -------
    pathlib.Path
        The folder, which may be absent.
    """
    named = os.environ.get(ENVIRONMENT_VARIABLE)
    return Path(named) if named else _BESIDE


def read_joint(
    file: Path, *, time: str | float, angle: str, torque: str, ratio: float
) -> JointRecording:
    """Read one joint of a file.

    Parameters
    ----------
    file : pathlib.Path
        A CSV file with one line of names.
    time : str or float
        Column of the time stamps; or the sampling rate, Hz, where the file has none.
    angle, torque : str
        Columns of the joint's angle, rad, and torque, Nm.
    ratio : float
        Motor turns per output turn.

    Returns
    -------
    JointRecording
        All rows of the file.
    """
    with file.open(encoding="utf-8") as lines:
        names = lines.readline().strip().split(",")
    wanted = [angle, torque] if isinstance(time, float) else [angle, torque, time]
    columns = _columns(file, names, wanted)
    rows = columns.shape[1]
    time_s = np.arange(rows) / time if isinstance(time, float) else columns[2] - columns[2][0]
    return JointRecording(time_s, ratio * columns[0], columns[1], ratio)


def counted_once(recording: JointRecording) -> JointRecording:
    """Leave out rows that only repeat the angle and torque of the row before.

    Parameters
    ----------
    recording : JointRecording
        All rows.

    Returns
    -------
    JointRecording
        The rows that hold a new sample.
    """
    changes = (np.diff(recording.motor_angle_rad) != 0) | (np.diff(recording.torque_Nm) != 0)
    new = np.concatenate([[True], changes])
    return JointRecording(
        recording.time_s[new],
        recording.motor_angle_rad[new],
        recording.torque_Nm[new],
        recording.ratio,
    )


def _columns(file: Path, names: Sequence[str], wanted: Sequence[str]) -> NDArray[np.float64]:
    positions = [names.index(name) for name in wanted]
    table = np.loadtxt(file, delimiter=",", skiprows=1, usecols=positions, unpack=True, ndmin=2)
    return np.asarray(table, dtype=np.float64)
