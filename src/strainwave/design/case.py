"""A layout to study: how many gauges, how carefully bonded, against which wave."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from strainwave.calibrate.fluctuation import minimum_gauges
from strainwave.calibrate.gains import MOST_NOISE
from strainwave.design.checks import count_within, number_within
from strainwave.design.placement import Tolerances, Wave
from strainwave.errors import ConfigurationError

if TYPE_CHECKING:
    from strainwave.calibrate.circuit import Circuit

FEWEST_GAUGES: Final = 2
MOST_GAUGES: Final = 9
MOST_COMPENSATED: Final = 4


@dataclass(frozen=True)
class LayoutCase:
    """A layout to study.

    Parameters
    ----------
    gauges : int
        M, 2 to 9; equally spaced but for their errors.
    harmonics : int
        N, 1 to 4: harmonics that the gains are solved against.
    tolerances : Tolerances
        How carefully the gauges are made and bonded.
    wave : Wave
        What there is to cancel.
    radius_mm : float
        Nominal distance of the gauges from the axis.
    measurement_error_FS : float
        Standard deviation of what the calibration run measures of every gauge's harmonics, of sine
        and cosine each, in % of the gauge's signal at rated torque.
    circuit : Circuit, optional
        Gains that the circuit can have; any without.
    most_noise : float
        Noise factor above which the solver refuses a layout, as `compensating_gains` does.
    lost_gauge : bool
        Whether every layout is also studied with each of its gauges lost.

    Raises
    ------
    InputError
        If a value cannot be used.
    """

    gauges: int
    harmonics: int
    tolerances: Tolerances = field(default_factory=Tolerances)
    wave: Wave = field(default_factory=Wave)
    radius_mm: float = 22.0
    measurement_error_FS: float = 0.01
    circuit: Circuit | None = None
    most_noise: float = MOST_NOISE
    lost_gauge: bool = False

    def __post_init__(self) -> None:
        count_within("gauges", self.gauges, FEWEST_GAUGES, MOST_GAUGES)
        count_within("harmonics", self.harmonics, 1, MOST_COMPENSATED)
        number_within("radius_mm", self.radius_mm, "mm", 1.0, 1000.0)
        number_within("measurement_error_FS", self.measurement_error_FS, "%FS", 0.0, 100.0)
        if not self.most_noise >= 1:
            raise ConfigurationError(
                "most_noise", self.most_noise, "", "at least 1, the noise factor of equal gains"
            )
        if len(self.wave.amplitudes_FS) < self.harmonics:
            raise ConfigurationError(
                "wave_FS",
                self.wave.amplitudes_FS,
                "%FS",
                f"an amplitude for each of the {self.harmonics} harmonics to cancel",
                "give more, 0 where there is none, or fewer harmonics",
            )


def remarks(case: LayoutCase) -> tuple[str, ...]:
    """Say what to know before the numbers of a case are used.

    Parameters
    ----------
    case : LayoutCase
        The case.

    Returns
    -------
    tuple of str
        A sentence each; empty where nothing is.
    """
    found = []
    needed = minimum_gauges(case.harmonics)
    if case.gauges < needed:
        found.append(
            f"{case.gauges} gauges are fewer than the {needed} that cancel every wave of "
            f"{case.harmonics} harmonic(s): the gains leave the least residual."
        )
    if case.lost_gauge and case.gauges == needed:
        found.append(
            f"One gauge lost of {case.gauges}, {case.gauges - 1} are fewer than the {needed} that "
            f"cancel every wave of {case.harmonics} harmonic(s)."
        )
    for number, amplitude in enumerate(case.wave.amplitudes_FS[: case.harmonics], start=1):
        if 0 < amplitude < 3 * case.measurement_error_FS:
            found.append(
                f"Harmonic {number}, {amplitude:.2g} %FS of a gauge, is hardly more than the "
                f"measurement error of {case.measurement_error_FS:.2g} %FS: gains against it "
                "follow the noise of the calibration run; cancel fewer harmonics."
            )
    if not any(case.tolerances.as_dict().values()):
        found.append("All tolerances are 0: these are ideal gauges; give a tolerance.")
    return tuple(found)


def assumptions(case: LayoutCase) -> tuple[str, ...]:
    """Say what was assumed of the wave and of its measurement.

    Parameters
    ----------
    case : LayoutCase
        The case.

    Returns
    -------
    tuple of str
        A sentence each.
    """
    shown = ", ".join(f"{amplitude:.3g}" for amplitude in case.wave.amplitudes_FS)
    in_sum = case.wave.amplitudes_FS[0] / case.gauges
    said = [
        f"Wave: {shown} %FS of one gauge's own signal in harmonics 1 to "
        f"{len(case.wave.amplitudes_FS)}; in the sum of {case.gauges} gauges the first counts as "
        f"{in_sum:.3g} %FS."
    ]
    if case.wave.amplitudes_FS == Wave().amplitudes_FS:
        said.append(
            "These follow from Godler et al. 2000 (18.9 %FS in the sum of three, the second a "
            "twentieth of that); harmonics above the second are not published and are taken to be "
            "a twentieth of the one before."
        )
    said.append(
        f"Gains are solved from phasors measured to {case.measurement_error_FS:g} %FS in sine and "
        "cosine (standard deviation); torque is calibrated afterwards."
    )
    return tuple(said)
