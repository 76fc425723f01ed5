"""Gains that a circuit can have: potentiometer steps, or resistors of the E24 and E96 series.

Gains rounded one by one leave more than they need to: what counts is their weighted sum, and a
factor common to all gains is taken up by the torque calibration. So roundings to neighbouring
values, and common factors, are tried together.
"""

from __future__ import annotations

import contextlib
import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

Kind = Literal["potentiometer", "E24", "E96"]

#: IEC 60063; E96 follows 10^(i/96) to three digits, E24 does not follow its formula everywhere.
E24: Final = (
    *(1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0),
    *(3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8, 7.5, 8.2, 9.1),
)
E96: Final = tuple(round(10 ** (i / 96), 2) for i in range(96))
#: The feedback resistor of the summing amplifier; a gauge at gain 1 has an input resistor like it.
FEEDBACK_KILOHM: Final = 10.0
#: By how much all gains together may be scaled.
COMMON_SCALES: Final = np.linspace(0.9, 1.1, 101)
#: Combinations of neighbouring values that are tried for each common factor.
MOST_COMBINATIONS: Final = 4096
EXAMPLE: Final = "potentiometer:256, potentiometer:256:0.5:1.5, E24 or E96"


@dataclass(frozen=True)
class Circuit:
    """What gains can be set to.

    Attributes
    ----------
    kind : {"potentiometer", "E24", "E96"}
        Evenly spaced steps of gain, or input resistors of a summing amplifier.
    values : numpy.ndarray
        Magnitudes of the gains that there are, rising, shape (values,).
    """

    kind: Kind
    values: NDArray[np.float64]

    def setting(self, gain: float) -> str:
        """Say how one of the circuit's gains is set.

        Parameters
        ----------
        gain : float
            One of the values, or its negative.

        Returns
        -------
        str
            Such as "step 134" or "9.53 kOhm".
        """
        if self.kind == "potentiometer":
            return f"step {int(np.argmin(np.abs(self.values - gain)))}"
        inverted = ", inverted input" if gain < 0 else ""
        return f"{FEEDBACK_KILOHM / abs(gain):.4g} kOhm{inverted}"


@dataclass(frozen=True)
class QuantisedGains:
    """Gains that a circuit can have.

    Attributes
    ----------
    gains : numpy.ndarray
        Shape (gauges,).
    settings : tuple of str
        How each is set.
    rounded : numpy.ndarray
        The gains rounded one by one, for comparison, shape (gauges,).
    """

    gains: NDArray[np.float64]
    settings: tuple[str, ...]
    rounded: NDArray[np.float64]


def parse_circuit(text: str, option: str = "--quantise") -> Circuit:
    """Read what gains can be set to.

    Parameters
    ----------
    text : str
        ``potentiometer:STEPS``, over gains from 0 to 2, ``potentiometer:STEPS:LOW:HIGH``, ``E24``
        or ``E96``.
    option : str
        Name of the option, for messages.

    Returns
    -------
    Circuit
        The circuit.

    Raises
    ------
    InputError
        If it is none of these.
    """
    for kind, series in (("E24", E24), ("E96", E96)):
        if text == kind:
            resistors = np.concatenate([np.array(series) * 10.0**decade for decade in range(-1, 4)])
            return Circuit(kind, np.sort(FEEDBACK_KILOHM / resistors))  # type: ignore[arg-type]
    words = text.split(":")
    steps, low, high = 0, 0.0, 2.0
    with contextlib.suppress(ValueError):
        if words[0] == "potentiometer" and len(words) in {2, 4}:
            low, high = map(float, words[2:]) if len(words) == 4 else (low, high)
            steps = int(words[1])
    if not (2 <= steps <= 1_000_000 and -100 <= low < high <= 100):
        raise InputError(
            f"{option} {text}: expected {EXAMPLE}, with 2 to 1000000 steps and gains within "
            "+-100, the lower first; correct this value"
        )
    return Circuit("potentiometer", np.linspace(low, high, steps))


def quantise_gains(
    circuit: Circuit,
    gains: NDArray[np.float64],
    conditions: NDArray[np.float64],
    torque_sensitivities: NDArray[np.float64],
    *,
    common_scales: NDArray[np.float64] = COMMON_SCALES,
) -> QuantisedGains:
    """Choose gains of a circuit that leave the least fluctuation for the torque they pass.

    Parameters
    ----------
    circuit : Circuit
        What gains can be set to.
    gains : numpy.ndarray
        Gains as solved, shape (gauges,).
    conditions : numpy.ndarray
        Conditions of the harmonics to cancel, of all runs, shape (rows, gauges).
    torque_sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    common_scales : numpy.ndarray
        Factors that all gains together may be scaled by.

    Returns
    -------
    QuantisedGains
        The choice; never worse than gains rounded one by one.

    Raises
    ------
    InputError
        If a gain lies outside what the circuit can do.
    """
    _require_range(circuit, gains)
    rounded = _neighbours(circuit, gains, 1)[:, 0]
    best, least = rounded, float(_left(rounded, conditions, torque_sensitivities))
    width = next(k for k in (5, 3, 2, 1) if k ** len(gains) <= MOST_COMBINATIONS or k == 1)
    for scale in common_scales:
        if width > 1:
            choices = _neighbours(circuit, scale * gains, width)
            tried = np.array(list(itertools.product(*choices)))
            left = _left(tried, conditions, torque_sensitivities)
            found, amount = tried[np.argmin(left)], float(left.min())
        else:
            found, amount = _descended(circuit, scale * gains, conditions, torque_sensitivities)
        if amount < least:
            best, least = found, amount
    settings = tuple(circuit.setting(float(gain)) for gain in best)
    return QuantisedGains(best, settings, rounded)


def _require_range(circuit: Circuit, gains: NDArray[np.float64]) -> None:
    low, high = circuit.values[0], circuit.values[-1]
    sized = gains if circuit.kind == "potentiometer" else np.abs(gains)
    for j in np.flatnonzero((sized < low) | (sized > high)):
        raise InputError(
            f"--quantise: gauge {j + 1} needs a gain of {gains[j]:.4g}, and the circuit has gains "
            f"from {low:g} to {high:g}; expected a range that holds all gains, so choose another "
            "circuit or move the gauge"
        )


def _neighbours(circuit: Circuit, gains: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Nearest values of each gain, shape (gauges, width)."""
    if circuit.kind == "potentiometer":
        sized, sign = gains, np.ones(len(gains))
    else:
        sized, sign = np.abs(gains), np.where(gains < 0, -1.0, 1.0)
    distance = np.abs(circuit.values - sized[:, np.newaxis])
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :width]
    return np.asarray(circuit.values[nearest] * sign[:, np.newaxis])


def _left(
    gains: NDArray[np.float64], conditions: NDArray[np.float64], torque: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Squared fluctuation over squared torque signal, for one set of gains or many."""
    return np.asarray(np.sum((gains @ conditions.T) ** 2, axis=-1) / (gains @ torque) ** 2)


def _descended(
    circuit: Circuit,
    gains: NDArray[np.float64],
    conditions: NDArray[np.float64],
    torque: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    """For many gauges: pairs of gains are moved together as long as that helps."""
    choices = _neighbours(circuit, gains, 3)
    best = choices[:, 0].copy()
    least = float(_left(best, conditions, torque))
    improved = True
    while improved:
        improved = False
        for first, second in itertools.combinations(range(len(gains)), 2):
            tried = np.tile(best, (9, 1))
            pairs = np.array(list(itertools.product(choices[first], choices[second])))
            tried[:, [first, second]] = pairs
            left = _left(tried, conditions, torque)
            if left.min() < least * (1 - 1e-12):
                best, least, improved = tried[np.argmin(left)], float(left.min()), True
    return best, least
