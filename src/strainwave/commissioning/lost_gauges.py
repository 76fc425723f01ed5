"""Gains for the loss of each gauge, from the runs that the gains of all are found in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from strainwave.calibrate.fluctuation import enough_gauges
from strainwave.calibrate.lost_gauge import GainsWithoutGauge, gains_without_each
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from strainwave.calibrate.fluctuation_run import FluctuationRun


@dataclass(frozen=True)
class LostGauges:
    """What is there for the loss of a gauge.

    Attributes
    ----------
    sets : tuple of GainsWithoutGauge
        One for each gauge that the others can do without.
    warnings : tuple of str
        Gauges without which no useful gains exist.
    says : tuple of str
        What the sets leave, or why there are none.
    """

    sets: tuple[GainsWithoutGauge, ...]
    warnings: tuple[str, ...]
    says: tuple[str, ...]


def check_harmonics_without(asked: int | None, harmonics: int, gauges: int) -> None:
    """Refuse more harmonics than the gauges that are left cancel.

    Parameters
    ----------
    asked : int or None
        What followed ``--without-gauge-harmonics``.
    harmonics : int
        N, harmonics that all gauges cancel.
    gauges : int
        M.

    Raises
    ------
    InputError
        If it is below 1, above N, or M - 1 gauges are too few for it.
    """
    if asked is None:
        return
    most = min(harmonics, (gauges - 2) // 2)
    if most < 1:
        raise InputError(
            f"--without-gauge-harmonics {asked}: {gauges} gauges are mapped, and {gauges - 1} do not "
            "cancel a harmonic; expected four gauges or more, so leave the option out"
        )
    if not 1 <= asked <= most:
        raise InputError(
            f"--without-gauge-harmonics {asked}: expected a whole number from 1 to {most}, as "
            f"{gauges - 1} of {gauges} gauges cancel no more of {harmonics}; correct this value"
        )


def sets_without(
    runs: Sequence[FluctuationRun],
    present: Sequence[int],
    sensitivities: NDArray[np.float64],
    gains: NDArray[np.float64],
    *,
    harmonics: int | None,
    most_noise: float,
) -> LostGauges:
    """Solve the gains without each gauge.

    Parameters
    ----------
    runs : sequence of FluctuationRun
        The fit of every condition.
    present : sequence of int
        Harmonics that the gains of all gauges cancel.
    sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    gains : numpy.ndarray
        Gains of all gauges, whose torque signal is kept, shape (gauges,).
    harmonics : int or None
        How far up the others have to cancel; as far as all gauges do without.
    most_noise : float
        Largest noise factor that is accepted.

    Returns
    -------
    LostGauges
        The sets.
    """
    gauges = len(gains)
    cancelled = [i for i in present if harmonics is None or i <= harmonics]
    if not cancelled or not enough_gauges(gauges - 1, len(cancelled)):
        return LostGauges((), (), (_why_none(gauges, len(present)),))
    sets, warnings = gains_without_each(
        [run.conditions(cancelled) for run in runs],
        sensitivities,
        torque_signal=float(sensitivities @ gains),
        most_noise=most_noise,
    )
    left = [str(i) for i in present if i not in cancelled]
    says = (
        f"gains without a gauge leave harmonic {', '.join(left)}, as asked: ripple comes back when "
        "one is lost",
    )
    return LostGauges(sets, warnings, says if left and sets else ())


def _why_none(gauges: int, harmonics: int) -> str:
    words = (
        f"{gauges - 1} gauges do not cancel {harmonics} harmonic(s), so that no gains for a lost "
        "gauge are stored and a loss makes the torque invalid"
    )
    fewer = (gauges - 2) // 2
    if fewer < 1:
        return f"{words}: add gauges"
    return (
        f"{words}: --without-gauge-harmonics {fewer} stores gains that let ripple come back, or add "
        "gauges"
    )
