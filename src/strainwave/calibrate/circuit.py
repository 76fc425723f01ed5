"""Gains that a circuit can have: potentiometer steps, or resistors of the E24 and E96 series."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

Kind = Literal["potentiometer", "step", "E24", "E96"]

#: IEC 60063; E96 follows 10^(i/96) to three digits, E24 does not follow its formula everywhere.
E24: Final = (
    *(1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0),
    *(3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8, 7.5, 8.2, 9.1),
)
E96: Final = tuple(round(10 ** (i / 96), 2) for i in range(96))
#: The feedback resistor of the summing amplifier; a gauge at gain 1 has an input resistor like it.
FEEDBACK_KILOHM: Final = 10.0
#: Gains of a circuit lie within.
_LARGEST_GAIN: Final = 100.0
_LEAST_STEP: Final = 1e-4
EXAMPLE: Final = "potentiometer:256, potentiometer:256:0.5:1.5, E24, E96 or a step such as 0.001"


@dataclass(frozen=True)
class Circuit:
    """What gains can be set to.

    Attributes
    ----------
    name : str
        As given: ``potentiometer:256``, ``0.001``, ``E24``.
    kind : {"potentiometer", "step", "E24", "E96"}
        Evenly spaced gains, of a range or of either sign, or input resistors of a summing amplifier.
    values : numpy.ndarray
        Gains that there are, rising, shape (values,); of resistors their magnitudes, as an input can
        be inverted.
    """

    name: str
    kind: Kind
    values: NDArray[np.float64]

    @property
    def has_both_signs(self) -> bool:
        """Whether each of the values can be had with a minus as well."""
        return self.kind in {"E24", "E96"}

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
        if self.kind == "step":
            return f"gain {gain:.6g}"
        inverted = ", inverted input" if gain < 0 else ""
        return f"{FEEDBACK_KILOHM / abs(gain):.4g} kOhm{inverted}"

    def nearest(self, gains: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take the nearest gains there are.

        Parameters
        ----------
        gains : numpy.ndarray
            Any shape.

        Returns
        -------
        numpy.ndarray
            Same shape; beyond the range its end, and not a number where no number was given.
        """
        sized, sign = self._sized(gains)
        found = self.values[np.searchsorted((self.values[1:] + self.values[:-1]) / 2, sized)]
        return np.asarray(np.where(np.isnan(gains), gains, sign * found))

    def neighbours(self, gains: NDArray[np.float64], width: int) -> NDArray[np.float64]:
        """Take several of the nearest values of each gain.

        Parameters
        ----------
        gains : numpy.ndarray
            Shape (gauges,).
        width : int
            How many.

        Returns
        -------
        numpy.ndarray
            The nearest first, shape (gauges, width), or fewer columns where there are fewer values.
        """
        sized, sign = self._sized(gains)
        width = min(width, len(self.values))
        first = np.searchsorted(self.values, sized)[:, np.newaxis] - width
        # As many on each side; at an end of the range the window is moved, not cut.
        window = np.clip(first, 0, max(len(self.values) - 2 * width, 0))
        places = window + np.arange(min(2 * width, len(self.values)))
        distance = np.abs(self.values[places] - sized[:, np.newaxis])
        order = np.argsort(distance, axis=1, kind="stable")[:, :width]
        return np.asarray(
            np.take_along_axis(self.values[places], order, axis=1) * sign[:, np.newaxis]
        )

    def _sized(self, gains: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Gains as `values` counts them, and the sign that they are set with."""
        if not self.has_both_signs:
            return gains, np.ones(np.shape(gains))
        return np.abs(gains), np.where(gains < 0, -1.0, 1.0)


def parse_circuit(text: str, option: str = "--quantise") -> Circuit:
    """Read what gains can be set to.

    Parameters
    ----------
    text : str
        ``potentiometer:STEPS``, over gains from 0 to 2, ``potentiometer:STEPS:LOW:HIGH``, ``E24``,
        ``E96``, or a step: gains are its whole multiples, of either sign.
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
    if text.upper() == "E24":
        return Circuit("E24", "E24", _resistor_gains(E24))
    if text.upper() == "E96":
        return Circuit("E96", "E96", _resistor_gains(E96))
    with contextlib.suppress(ValueError):
        step = float(text)
        if _LEAST_STEP <= step <= 0.5:
            count = int(_LARGEST_GAIN / step)
            return Circuit(text, "step", step * np.arange(-count, count + 1, dtype=np.float64))
    words = text.split(":")
    steps, low, high = 0, 0.0, 2.0
    with contextlib.suppress(ValueError):
        if words[0] == "potentiometer" and len(words) in {2, 4}:
            low, high = map(float, words[2:]) if len(words) == 4 else (low, high)
            steps = int(words[1])
    if not (2 <= steps <= 1_000_000 and -_LARGEST_GAIN <= low < high <= _LARGEST_GAIN):
        raise InputError(
            f"{option} {text}: expected {EXAMPLE}, with 2 to 1000000 steps and gains within "
            f"+-{_LARGEST_GAIN:g}, the lower first, or a step from {_LEAST_STEP:g} to 0.5; correct "
            "this value"
        )
    return Circuit(text, "potentiometer", np.linspace(low, high, steps))


def _resistor_gains(series: tuple[float, ...]) -> NDArray[np.float64]:
    resistors = np.concatenate([np.array(series) * 10.0**decade for decade in range(-1, 4)])
    return np.sort(FEEDBACK_KILOHM / resistors)
