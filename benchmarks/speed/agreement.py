"""Whether an implementation computes what it should; before it is timed, and instead if not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from benchmarks.speed.inputs import Array, Recording
from benchmarks.speed.reference import default_ripple, published_ripple

#: Largest rms difference of predicted ripple to the dense reference in double, Nm, beside a ripple
#: of some 5 Nm. In double the default filter's process noise is a polynomial's; in float its slowest
#: order is hardly told from torque.
TOLERANCE_NM: Final = {
    ("published", "double"): 1e-9,
    ("published", "float"): 2e-5,
    # The peers give process noise before a sample, and hold no variance to its limit.
    ("default_unlimited", "double"): 1e-2,
    ("default_unlimited", "float"): 1e-2,
    ("default", "double"): 1e-5,
    ("default", "float"): 2e-3,
}


@dataclass(frozen=True)
class Agreement:
    """How far an implementation is from the reference.

    Attributes
    ----------
    difference_rms_Nm, tolerance_Nm : float
        Of the predicted ripple.
    """

    difference_rms_Nm: float
    tolerance_Nm: float

    @property
    def ok(self) -> bool:
        """Whether it may be timed."""
        return self.difference_rms_Nm <= self.tolerance_Nm


def references(recording: Recording, samples: int) -> dict[str, Array]:
    """Run both dense references.

    Parameters
    ----------
    recording : Recording
        Signals.
    samples : int
        How many of them.

    Returns
    -------
    dict of numpy.ndarray
        Ripple by filter.
    """
    return {
        "published": published_ripple(recording, samples),
        "default": default_ripple(recording, samples),
        "default_unlimited": default_ripple(recording, samples, limited=False),
    }


def agreement(which: str, precision: str, ripple_Nm: Array, reference_Nm: Array) -> Agreement:
    """Compare.

    Parameters
    ----------
    which : str
        Filter.
    precision : str
        ``float`` or ``double``.
    ripple_Nm, reference_Nm : numpy.ndarray
        Shape (samples,).

    Returns
    -------
    Agreement
        Infinitely far where the number of samples differs or one is not a number.
    """
    far = float("inf")
    if ripple_Nm.shape == reference_Nm.shape:
        difference = float(np.sqrt(np.mean((ripple_Nm - reference_Nm) ** 2)))
        far = difference if np.isfinite(difference) else far
    return Agreement(far, TOLERANCE_NM[which, precision])
