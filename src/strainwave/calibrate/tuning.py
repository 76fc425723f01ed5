"""Guided tuning: which potentiometer to turn, which way and how far, from short runs.

The phasor of the sum is linear in the gains. Where every gauge is recorded, one run shows each
gauge's phasor. Where only the sum is, runs at different settings do: M settings that differ tell M
phasors, and as long as there are fewer, the next one to try is said. What is left in the last run
decides how far to turn, so that settings that were read off badly are corrected by the next run.
Godler et al. 2000, sections III-B and IV.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.degenerate import reasons
from strainwave.calibrate.gains import MOST_NOISE
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Smallest part of settings, over their largest, that counts as different.
LEAST_DIFFERENCE: Final = 1e-3
#: By how much a potentiometer is turned to learn what its gauge does.
TRIAL_TURN: Final = 0.1


@dataclass(frozen=True)
class Turn:
    """One potentiometer and how far to turn it.

    Attributes
    ----------
    gauge : int
        Its gauge, from 1.
    now, then : float
        Gain as it is set, and as it should be.
    """

    gauge: int
    now: float
    then: float

    @property
    def change(self) -> float:
        """By how much the gain changes; positive is up."""
        return self.then - self.now


@dataclass(frozen=True)
class Advice:
    """What to do after the last run.

    Attributes
    ----------
    is_trial : bool
        Whether the turn is only there to learn what a gauge does.
    turns : tuple of Turn
        Potentiometers to turn, that of the largest change first; empty where none has to be.
    phasors : numpy.ndarray or None
        Phasor of every gauge at gain 1, shape (harmonics, gauges); None where runs are missing.
    runs_missing : int
        Runs at further settings without which the gauges cannot be told apart.
    """

    is_trial: bool
    turns: tuple[Turn, ...]
    phasors: NDArray[np.complex128] | None
    runs_missing: int = 0


def gauge_phasors(
    sums: NDArray[np.complex128], settings: NDArray[np.float64]
) -> NDArray[np.complex128] | None:
    """Phasor of every gauge from the sums at different settings.

    Parameters
    ----------
    sums : numpy.ndarray
        Phasors of the sum, shape (runs, harmonics).
    settings : numpy.ndarray
        Gains in each run, shape (runs, gauges).

    Returns
    -------
    numpy.ndarray or None
        Shape (harmonics, gauges); None where the settings do not tell the gauges apart.
    """
    if np.linalg.matrix_rank(settings, tol=LEAST_DIFFERENCE * np.abs(settings).max()) < len(
        settings.T
    ):
        return None
    solved = np.linalg.lstsq(settings.astype(complex), sums, rcond=None)[0]
    return np.asarray(solved.T, dtype=np.complex128)


def trial_turn(settings: NDArray[np.float64]) -> Turn:
    """Choose the potentiometer whose gauge the runs so far say least about.

    Parameters
    ----------
    settings : numpy.ndarray
        Gains in each run, the last one as it is set now, shape (runs, gauges).

    Returns
    -------
    Turn
        A tenth of the largest gain, towards the smaller magnitude.
    """
    _, singular, right = np.linalg.svd(settings)
    known = right[: int(np.sum(singular > LEAST_DIFFERENCE * singular[0]))]
    unknown = 1 - np.sum(known**2, axis=0)
    # Ties, as before the first turn, go to the last gauge: the first one is G's reference.
    gauge = len(unknown) - 1 - int(np.argmax(unknown[::-1] > unknown.max() - 1e-9))
    now = float(settings[-1, gauge])
    step = TRIAL_TURN * float(np.abs(settings[-1]).max())
    return Turn(gauge + 1, now, now - step if now > 0 else now + step)


def advise(
    phasors: NDArray[np.complex128],
    left: NDArray[np.complex128],
    now: NDArray[np.float64],
    torque_sensitivities: NDArray[np.float64],
    *,
    most_noise: float = MOST_NOISE,
) -> Advice:
    """Find turns that cancel what the last run left, at the torque signal as it is.

    Parameters
    ----------
    phasors : numpy.ndarray
        Of every gauge at gain 1, shape (harmonics, gauges).
    left : numpy.ndarray
        Phasor of the sum in the last run, shape (harmonics,).
    now : numpy.ndarray
        Gains of the last run, shape (gauges,).
    torque_sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    most_noise : float
        Largest mean square of gains, relative to equal ones of the same torque signal.

    Returns
    -------
    Advice
        The smallest turns that do; with too few gauges those that leave least.

    Raises
    ------
    InputError
        If the gauges cannot cancel it without the torque.
    """
    conditions = np.stack([phasors.real, phasors.imag], axis=1).reshape(-1, len(now))
    rest = np.stack([left.real, left.imag], axis=1).ravel()
    scale = float(np.abs(conditions).max()) or 1.0
    torque = torque_sensitivities / np.abs(torque_sensitivities).max()
    # Turns that keep the torque signal: a basis of what t does not see.
    keeping = np.linalg.svd(torque[np.newaxis])[2][1:].T
    turned = np.linalg.lstsq(conditions @ keeping / scale, -rest / scale, rcond=1e-6)[0]
    then = now + keeping @ turned
    equal = float(torque @ now) / float(torque.sum())
    if not np.mean(then**2) <= most_noise * equal**2:
        found = reasons(conditions, range(1, len(phasors) + 1))
        raise InputError(
            "no potentiometer settings cancel this line and leave the torque: expected gauges "
            "whose phasors point apart, so move or add a gauge"
            f"{'; here ' if found else ''}{'; '.join(found)}"
        )
    turns = [
        Turn(int(j) + 1, float(now[j]), float(then[j]))
        for j in np.argsort(-np.abs(then - now), kind="stable")
        if abs(then[j] - now[j]) > 1e-9 * float(np.abs(now).max())
    ]
    return Advice(is_trial=False, turns=tuple(turns), phasors=phasors)
