"""The main job, as the commands do it: identify one recording, filter another, look at the truth."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

import numpy as np
import pyarrow.csv

from strainwave.evidence import filter_as_identified, filter_with_evidence
from strainwave.records import Options, filter_log, parse_mapping
from strainwave.records.identifying import identify_log
from strainwave.walkthrough.recordings import (
    MAP,
    PHASES,
    RATED_TORQUE_NM,
    RATIO,
    STEADY,
    TOUCH_AT_REST,
    TOUCH_IN_MOTION,
    joint,
    ordinary_run,
    run_of_work,
    write_recording,
)

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.evidence import Evidence
    from strainwave.records.filtered_log import FilteredLog
    from strainwave.records.identified_log import IdentifiedLog
    from strainwave.simulate.results import Run
    from strainwave.walkthrough.recordings import Touch

IDENTIFY_COMMAND: Final = (
    f"strainwave identify ordinary.csv --map {MAP} --angle-side motor --ratio {RATIO} "
    f"--rated-torque {RATED_TORQUE_NM:g} --out joint.toml --report identified.html"
)
FILTER_COMMAND: Final = (
    "strainwave filter work.csv --joint joint.toml --out clean.csv --report cleaned.html"
)
#: What is compared: the truth, the torque as recorded, the published filter, and this one.
TRUE: Final = "true torque"
MEASURED: Final = "as recorded"
PUBLISHED: Final = "published filter (Taghirad & Bélanger 1999)"
OURS: Final = "strainwave"
_PUBLISHED_METHOD: Final = "taghirad1999"
#: A touch is read over this time after its edge, and before it, s.
_TOUCH_READ_S: Final = (0.02, 0.03)
_BEFORE_TOUCH_S: Final = 0.1


@dataclass(frozen=True)
class Score:
    """How far one torque is from the truth.

    Attributes
    ----------
    name : str
        Which torque.
    error_rms_Nm : float
        Root mean square of the distance from the true torque over the whole recording, Nm. The
        sensor's own gain, zero and hysteresis are in it.
    by_phase_Nm : dict
        The same by phase.
    order_2_Nm, order_4_Nm : float
        Ripple at 2 m and 4 m cycles per motor turn at constant speed, zero to peak, Nm.
    touch_in_motion_Nm, touch_at_rest_Nm : float
        What is read of a touch after 20 ms, Nm.
    """

    name: str
    error_rms_Nm: float
    by_phase_Nm: dict[str, float]
    order_2_Nm: float
    order_4_Nm: float
    touch_in_motion_Nm: float
    touch_at_rest_Nm: float


@dataclass(frozen=True)
class MainJob:
    """One joint, from its recording to clean torque.

    Attributes
    ----------
    identified : IdentifiedLog
        What was found in the ordinary recording.
    of_identified, of_work : tuple of FilteredLog and Evidence
        What the reports of both commands show.
    time_s, true_Nm : numpy.ndarray
        Time and true torque of the recording of work, shape (rows,), s and Nm.
    torque_Nm : dict
        Torque by name: as recorded, and of each method, shape (rows,), Nm.
    scores : tuple of Score
        One for each of them.
    """

    identified: IdentifiedLog
    of_identified: tuple[FilteredLog, Evidence]
    of_work: tuple[FilteredLog, Evidence]
    time_s: NDArray[np.float64]
    true_Nm: NDArray[np.float64]
    torque_Nm: dict[str, NDArray[np.float64]]
    scores: tuple[Score, ...]

    def score(self, name: str) -> Score:
        """Return the score of one torque.

        Parameters
        ----------
        name : str
            Its name.

        Returns
        -------
        Score
            Its score.
        """
        return next(score for score in self.scores if score.name == name)


def main_job(folder: Path) -> MainJob:
    """Record, identify, filter, compare.

    Parameters
    ----------
    folder : Path
        Where recordings, joint file and clean torque are written; it exists. What an earlier run
        left there is replaced.

    Returns
    -------
    MainJob
        What came of it.
    """
    ordinary, work = folder / "ordinary.csv", folder / "work.csv"
    write_recording(ordinary_run(), ordinary)
    run = run_of_work()
    write_recording(run, work)
    joint_path = folder / "joint.toml"
    joint_path.unlink(missing_ok=True)
    options = Options(
        mapping=parse_mapping([MAP]),
        angle_side="motor",
        ratio=Fraction(RATIO),
        rated_torque_Nm=RATED_TORQUE_NM,
    )
    identified = identify_log(ordinary, joint_path, options, command=IDENTIFY_COMMAND)
    out, published = folder / "clean.csv", folder / f"{_PUBLISHED_METHOD}.csv"
    of_work = filter_with_evidence(work, out, Options(), joint_path=joint_path)
    filter_log(work, published, joint_path=joint_path, method=_PUBLISHED_METHOD)
    true_Nm = run.truth.torque_without_ripple_Nm
    torques = {
        TRUE: true_Nm,
        MEASURED: run.raw_torque_Nm,
        PUBLISHED: _cleaned_Nm(published),
        OURS: _cleaned_Nm(out),
    }
    return MainJob(
        identified,
        filter_as_identified(identified, options),
        of_work,
        run.time_s,
        true_Nm,
        torques,
        tuple(_score(name, run, torque_Nm) for name, torque_Nm in torques.items()),
    )


def _cleaned_Nm(path: Path) -> NDArray[np.float64]:
    return np.asarray(pyarrow.csv.read_csv(path)["torque_Nm"].to_numpy(), dtype=np.float64)


def _score(name: str, run: Run, torque_Nm: NDArray[np.float64]) -> Score:
    time_s, true_Nm = run.time_s, run.truth.torque_without_ripple_Nm
    error_Nm = torque_Nm - true_Nm

    def rms(from_s: float, to_s: float) -> float:
        within = (time_s >= from_s) & (time_s < to_s)
        return float(np.sqrt(np.mean(error_Nm[within] ** 2)))

    from_s, to_s = PHASES[STEADY]
    steady = (time_s >= from_s) & (time_s < to_s)
    wave_angle_rad = float(joint().gear.wave_factor) * run.motor_angle_rad[steady]
    return Score(
        name,
        float(np.sqrt(np.mean(error_Nm**2))),
        {phase: rms(*times_s) for phase, times_s in PHASES.items()},
        _amplitude_Nm(2.0, wave_angle_rad, error_Nm[steady]),
        _amplitude_Nm(4.0, wave_angle_rad, error_Nm[steady]),
        _read_Nm(TOUCH_IN_MOTION, time_s, torque_Nm),
        _read_Nm(TOUCH_AT_REST, time_s, torque_Nm),
    )


def _amplitude_Nm(
    order: float, wave_angle_rad: NDArray[np.float64], error_Nm: NDArray[np.float64]
) -> float:
    waves = order * wave_angle_rad
    basis = np.column_stack([np.cos(waves), np.sin(waves), np.ones_like(waves)])
    cosine, sine, _ = np.linalg.lstsq(basis, error_Nm, rcond=None)[0]
    return float(np.hypot(cosine, sine))


def _read_Nm(touch: Touch, time_s: NDArray[np.float64], torque_Nm: NDArray[np.float64]) -> float:
    since_s = time_s - touch.from_s
    after = (since_s >= _TOUCH_READ_S[0]) & (since_s < _TOUCH_READ_S[1])
    before = (since_s >= -_BEFORE_TOUCH_S) & (since_s < 0.0)
    return float(np.mean(torque_Nm[after]) - np.mean(torque_Nm[before]))
