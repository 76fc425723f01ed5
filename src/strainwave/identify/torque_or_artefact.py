"""Is an order of the ripple real torque, or an artefact of sensing: what is said of it, and when.

Ripple that turns with the mesh is partly torque and partly a false signal of the gauges, of the same
frequency (Taghirad and Belanger 1999, section V). The torque's share of an order is

    share = Re sum(torque x conj(measured)) / sum |measured|^2

over windows of travel, of complex amplitudes. Leaving the order in the torque makes an error of
|measured - torque|^2, removing it one of |torque|^2: the first is the smaller one exactly where the
share is above one half. So one half decides, where the 95 % interval is on one side of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from scipy.stats import t as student

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.identify.reference_agreement import Agreement

UNDECIDABLE: Final = "undecidable from this log"
Decision = Literal["keep", "remove", "undecidable from this log"]
Basis = Literal["reference", "load sweep"]

#: Share of torque above which an order is better left in.
EVEN_SHARE: Final = 0.5
CONFIDENCE: Final = 0.95
#: Windows below this number decide nothing.
LEAST_WINDOWS: Final = 6


@dataclass(frozen=True)
class Share:
    """A share of an order's power.

    Attributes
    ----------
    value : float
        The share; below 0 and above 1 where parts of opposite phase cancel.
    standard_uncertainty : float
        Its standard uncertainty.
    freedom : int
        Degrees of freedom of that uncertainty.
    """

    value: float
    standard_uncertainty: float
    freedom: int

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval, by Student's t."""
        half = float(student.ppf(0.5 + CONFIDENCE / 2, self.freedom)) * self.standard_uncertainty
        return self.value - half, self.value + half


@dataclass(frozen=True)
class OrderVerdict:
    """What is said of one order.

    Attributes
    ----------
    order : float
        Cycles per turn of the wave.
    decision : {"keep", "remove", "undecidable from this log"}
        What to do with it; who cannot decide removes it.
    share : Share or None
        Torque's share; None where nothing is known of it.
    torque_Nm, torque_standard_uncertainty_Nm : float or None
        Root mean square over the windows of the torque's amplitude, zero to peak, Nm; None without
        a reference.
    artefact_Nm, artefact_standard_uncertainty_Nm : float or None
        The same of measured less true torque.
    basis : {"reference", "load sweep"} or None
        What the share rests on.
    reason : str
        Why it is undecidable; empty where it is not.
    """

    order: float
    decision: Decision
    share: Share | None = None
    torque_Nm: float | None = None
    torque_standard_uncertainty_Nm: float | None = None
    artefact_Nm: float | None = None
    artefact_standard_uncertainty_Nm: float | None = None
    basis: Basis | None = None
    reason: str = ""


@dataclass(frozen=True)
class TorqueOrArtefact:
    """What is said of all orders.

    Attributes
    ----------
    verdicts : tuple of OrderVerdict
        One for each order that is there.
    agreement : Agreement or None
        How the reference follows the measured torque; None without one, or where it does not show.
    says : tuple of str
        Sentences for a person.
    """

    verdicts: tuple[OrderVerdict, ...] = ()
    agreement: Agreement | None = None
    says: tuple[str, ...] = ()

    def of(self, order: float) -> OrderVerdict:
        """Give the verdict on an order.

        Parameters
        ----------
        order : float
            Cycles per turn of the wave.

        Returns
        -------
        OrderVerdict
            Undecidable where nothing was said.
        """
        for verdict in self.verdicts:
            if verdict.order == order:
                return verdict
        return OrderVerdict(order, UNDECIDABLE)


def decided(order: float, share: Share, basis: Basis, largest_loss: float = 1.0) -> OrderVerdict:
    """Decide by a share.

    Parameters
    ----------
    order : float
        Cycles per turn of the wave.
    share : Share
        Torque's share.
    basis : {"reference", "load sweep"}
        What it rests on.
    largest_loss : float
        Factor by which the share may be larger than it looks, at least 1.

    Returns
    -------
    OrderVerdict
        Keep or remove where the interval is on one side of one half, else undecidable.
    """
    low, high = share.interval
    high = max(high, largest_loss * high)
    if low > EVEN_SHARE:
        return OrderVerdict(order, "keep", share, basis=basis)
    if high < EVEN_SHARE:
        return OrderVerdict(order, "remove", share, basis=basis)
    reason = (
        f"torque's share of it is between {low:.2f} and {high:.2f}, on both sides of "
        f"{EVEN_SHARE:g}; record a longer motion"
    )
    return OrderVerdict(order, UNDECIDABLE, share, basis=basis, reason=reason)


def share_of(
    common_Nm2: NDArray[np.float64], power_Nm2: NDArray[np.float64], weights: NDArray[np.float64]
) -> Share:
    """Compute the share that one part has in an order, with the scatter of the windows.

    Parameters
    ----------
    common_Nm2 : numpy.ndarray
        Real part of the part's complex amplitude times the conjugate of the whole's, less what
        noise makes of it, shape (windows,), Nm^2.
    power_Nm2 : numpy.ndarray
        Square of the whole's amplitude, less its noise, shape (windows,), Nm^2.
    weights : numpy.ndarray
        Weight of each window, shape (windows,).

    Returns
    -------
    Share
        The share; without uncertainty of what is common to all windows.
    """
    whole = float(np.sum(weights * power_Nm2))
    share = float(np.sum(weights * common_Nm2)) / whole
    away = weights * (common_Nm2 - share * power_Nm2)
    count = len(power_Nm2)
    variance = float(away @ away) * count / (count - 1) / whole**2
    return Share(share, float(np.sqrt(variance)), count - 1)


def weights_of(variance_Nm2: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weigh windows: noisy ones count for less, and none for much more than the typical one.

    Parameters
    ----------
    variance_Nm2 : numpy.ndarray
        Variance of a window's amplitude, shape (windows,), Nm^2.

    Returns
    -------
    numpy.ndarray
        Weights, shape (windows,).
    """
    variance = np.maximum(variance_Nm2, 1e-24)
    weights: NDArray[np.float64] = 1.0 / (variance + float(np.median(variance)))
    weights /= weights.sum()
    return weights


def amplitude_of(
    amplitude_Nm: NDArray[np.complex128],
    noise_power_Nm2: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> tuple[float, float]:
    """Compute a root mean square amplitude over windows, less its noise.

    Parameters
    ----------
    amplitude_Nm : numpy.ndarray
        Complex amplitudes, shape (windows,), Nm.
    noise_power_Nm2 : numpy.ndarray
        Power of the noise in them, shape (windows,), Nm^2.
    weights : numpy.ndarray
        Weight of each window, their sum 1.

    Returns
    -------
    tuple of float
        Amplitude, zero to peak, and its standard uncertainty, Nm.
    """
    power = np.abs(amplitude_Nm) ** 2 - noise_power_Nm2
    mean = float(np.sum(weights * power))
    count = len(power)
    spread = float(np.sqrt(np.sum((weights * (power - mean)) ** 2) * count / (count - 1)))
    amplitude = float(np.sqrt(max(mean, 0.0)))
    # Linear where the amplitude stands out, and still finite where it is nothing but noise.
    return amplitude, float(np.sqrt(amplitude**2 + spread)) - amplitude
