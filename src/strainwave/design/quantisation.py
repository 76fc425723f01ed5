"""Gains as a circuit can have them: potentiometer steps, or ratios of resistors of a series."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.errors import ConfigurationError

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: IEC 60063; E24 is not quite a geometric series, E96 is one, rounded to three digits.
_E24: Final = (
    1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0,
    3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8, 7.5, 8.2, 9.1,
)  # fmt: skip
_SERIES: Final = {
    "E24": np.array(_E24),
    "E96": np.round(10 ** (np.arange(96) / 96), 2),
}


@dataclass(frozen=True)
class Quantisation:
    """Which gains there are.

    Attributes
    ----------
    name : str
        As given: a step, or the name of a series.
    step : float or None
        Gains are whole multiples of this.
    series : str or None
        Gains are values of this series times a power of ten, of either sign: a resistor against a
        reference resistor of 1, 10, 100.
    """

    name: str
    step: float | None = None
    series: str | None = None

    @classmethod
    def of_text(cls, text: str) -> Quantisation:
        """Read a step or the name of a series.

        Parameters
        ----------
        text : str
            "0.001", "E24", "E96".

        Returns
        -------
        Quantisation
            What it says.

        Raises
        ------
        InputError
            If it is neither.
        """
        if text.upper() in _SERIES:
            return cls(text.upper(), series=text.upper())
        try:
            step = float(text)
        except ValueError:
            step = 0.0
        if not 1e-9 <= step <= 0.5:
            raise ConfigurationError(
                "quantise", text, "", "E24, E96 or a step of the gain from 1e-09 to 0.5"
            )
        return cls(text, step=step)

    def apply(self, gains: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take the nearest gains there are.

        Parameters
        ----------
        gains : numpy.ndarray
            Any shape.

        Returns
        -------
        numpy.ndarray
            Same shape; of a series the value with the least relative error.
        """
        if self.step is not None:
            return np.asarray(np.round(gains / self.step) * self.step)
        assert self.series is not None
        values = _SERIES[self.series]
        ends = np.log10(np.append(values, 10.0))
        size = np.abs(gains)
        with np.errstate(divide="ignore"):
            logarithm = np.log10(size)
        usable = np.isfinite(logarithm)
        decade = np.floor(np.where(usable, logarithm, 0.0))
        within = np.where(usable, logarithm, 0.0) - decade
        nearest = np.searchsorted((ends[1:] + ends[:-1]) / 2, within)
        found = np.append(values, 10.0)[nearest] * 10.0**decade
        return np.asarray(np.where(usable, np.sign(gains) * found, gains))
