"""What is refused before a filter is run: speeds, times and frequencies that cannot be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.arrays import contiguous
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Longest run of a filter under test; more would not fit into memory.
MOST_SAMPLES: Final = 50_000_000


def require_rate(motor_speed_rad_s: float, sample_period_s: float) -> None:
    """Refuse a speed or a sample period that is no usable number."""
    require_number("motor_speed_rad_s", motor_speed_rad_s, "rad/s", lowest=-np.inf)
    require_number("sample_period_s", sample_period_s, "s", lowest=np.finfo(np.float64).tiny)


def require_frequencies(
    frequencies_Hz: ArrayLike, sample_period_s: float, *, spread: float
) -> NDArray[np.float64]:
    """Return the frequencies, refusing those that the sampling rate cannot show."""
    frequencies = contiguous("frequencies_Hz", frequencies_Hz, np.float64)
    highest_Hz = 0.5 / sample_period_s
    wrong = ~((frequencies > 0) & ((1 + spread) * frequencies < highest_Hz))
    if len(frequencies) == 0 or np.any(wrong):
        found = f"holds {frequencies[wrong][0]:g} Hz" if np.any(wrong) else "is empty"
        besides = f" with {spread:.1%} to spare for the delay" if spread else ""
        raise InputError(
            f"frequencies_Hz {found}: expected frequencies above 0 and below {highest_Hz:g} Hz, "
            f"half the sampling rate{besides}; choose others"
        )
    return frequencies


def require_number(name: str, value: object, unit: str, *, lowest: float = 0.0) -> None:
    """Refuse what is no finite number, or below the lowest allowed."""
    shown = f"a {type(value).__name__}"
    if isinstance(value, int | float | np.integer | np.floating):
        try:
            real = float(value)
        except OverflowError:
            real = np.inf
        if np.isfinite(real) and real >= lowest:
            return
        shown = f"{real:g}"
    elif isinstance(value, str):
        shown = repr(value)
    if lowest == -np.inf:
        least = ""
    elif lowest > 1e-300:
        least = f" of at least {lowest:g}, one sample"
    else:
        least = " of at least 0" if lowest == 0 else " above 0"
    raise InputError(f"{name} = {shown}: expected a finite number{least}; give it in {unit}")


def samples_of(name: str, time_s: float, sample_period_s: float) -> int:
    """Return a time in samples, refusing more than fit into memory."""
    samples = time_s / sample_period_s
    if samples > MOST_SAMPLES:
        raise InputError(
            f"{name} = {time_s:g} s is {samples:.3g} samples: expected at most {MOST_SAMPLES} "
            f"samples of {sample_period_s:g} s; choose a shorter time or a longer sample_period_s"
        )
    return round(samples)
