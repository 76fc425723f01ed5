"""One order as the joint's own sensor and a reference see it: torque's share, and both amounts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from strainwave.identify.order_phasors import noise_power_Nm2
from strainwave.identify.torque_or_artefact import Share, amplitude_of, share_of, weights_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.identify.order_phasors import OrderPhasors
    from strainwave.identify.reference_agreement import Agreement
    from strainwave.identify.torque_or_artefact import OrderVerdict


@dataclass(frozen=True)
class OrderPair:
    """One order in the windows that show it in both torques, at the measured torque's scale.

    Attributes
    ----------
    frequency_Hz : numpy.ndarray
        Frequency of the order, shape (windows,), Hz.
    measured_Nm, torque_Nm : numpy.ndarray
        Complex amplitudes by the joint's own sensor and by the reference, shape (windows,), Nm.
    variance_Nm2 : numpy.ndarray
        Variance of both together, for weights, shape (windows,), Nm^2.
    measured_beside_Nm, torque_beside_Nm : numpy.ndarray
        The same half an order below and above, shape (windows, 2), Nm: noise, of which contacts
        bring the same into both.
    """

    frequency_Hz: NDArray[np.float64]
    measured_Nm: NDArray[np.complex128]
    torque_Nm: NDArray[np.complex128]
    variance_Nm2: NDArray[np.float64]
    measured_beside_Nm: NDArray[np.complex128]
    torque_beside_Nm: NDArray[np.complex128]

    def __len__(self) -> int:
        return len(self.frequency_Hz)

    def of(self, chosen: NDArray[np.bool_]) -> OrderPair:
        """Give the chosen windows alone.

        Parameters
        ----------
        chosen : numpy.ndarray
            Which, shape (windows,).

        Returns
        -------
        OrderPair
            These windows.
        """
        return OrderPair(
            self.frequency_Hz[chosen],
            self.measured_Nm[chosen],
            self.torque_Nm[chosen],
            self.variance_Nm2[chosen],
            self.measured_beside_Nm[chosen],
            self.torque_beside_Nm[chosen],
        )


def pair_up(
    measured: OrderPhasors, reference: OrderPhasors, gain: float, frequency_Hz: NDArray[np.float64]
) -> OrderPair:
    """Bring an order's amplitudes in both torques together.

    Parameters
    ----------
    measured, reference : OrderPhasors
        The order by the joint's own sensor and by the reference.
    gain : float
        Reference over measured torque, by which the reference is divided.
    frequency_Hz : numpy.ndarray
        Frequency of the order in every window, Hz.

    Returns
    -------
    OrderPair
        The windows that show it in both.
    """
    both = np.intersect1d(measured.window, reference.window)
    own = np.searchsorted(measured.window, both)
    other = np.searchsorted(reference.window, both)
    return OrderPair(
        frequency_Hz[both],
        measured.amplitude_Nm[own],
        reference.amplitude_Nm[other] / gain,
        measured.variance_Nm2[own] + reference.variance_Nm2[other] / gain**2,
        measured.beside_Nm[own],
        reference.beside_Nm[other] / gain,
    )


def torque_share(pair: OrderPair, agreement: Agreement) -> Share | None:
    """Compute torque's share of an order, with everything that makes it uncertain.

    Parameters
    ----------
    pair : OrderPair
        The order in both torques.
    agreement : Agreement
        How the reference follows the measured torque.

    Returns
    -------
    Share or None
        None where the order does not stand out of the noise.
    """
    weights = weights_of(pair.variance_Nm2)
    own, other = pair.measured_beside_Nm, pair.torque_beside_Nm
    powers = np.abs(pair.measured_Nm) ** 2 - noise_power_Nm2(own, own, pair.variance_Nm2)
    power = float(np.sum(weights * powers))
    if power <= 0.0:
        return None
    product = pair.torque_Nm * np.conj(pair.measured_Nm)
    common = np.real(product) - noise_power_Nm2(other, own, np.zeros(len(pair)))
    share = share_of(common, powers, weights)
    # Gain and delay are common to all windows: their scatter does not show them.
    of_gain = share.value * agreement.gain_standard_uncertainty / agreement.gain
    turned = np.imag(product) * 2 * np.pi * pair.frequency_Hz
    of_delay = float(np.sum(weights * turned)) / power * agreement.delay_standard_uncertainty_s
    together = np.linalg.norm([share.standard_uncertainty, of_gain, of_delay])
    return replace(share, standard_uncertainty=float(together))


def with_amounts(verdict: OrderVerdict, pair: OrderPair, agreement: Agreement) -> OrderVerdict:
    """Add to a verdict how much is torque and how much is artefact.

    Parameters
    ----------
    verdict : OrderVerdict
        The verdict.
    pair : OrderPair
        The order in both torques.
    agreement : Agreement
        How the reference follows the measured torque.

    Returns
    -------
    OrderVerdict
        The same with amounts in Nm.
    """
    weights = weights_of(pair.variance_Nm2)
    own, other = pair.measured_beside_Nm, pair.torque_beside_Nm
    noise = noise_power_Nm2(other, other, pair.variance_Nm2)
    torque_Nm, scatter_Nm = amplitude_of(pair.torque_Nm, noise, weights)
    noise = noise_power_Nm2(own - other, own - other, pair.variance_Nm2)
    artefact_Nm, of_artefact_Nm = amplitude_of(pair.measured_Nm - pair.torque_Nm, noise, weights)
    of_gain = agreement.gain_standard_uncertainty / agreement.gain
    turn_rad_s = 2 * np.pi * float(np.sqrt(np.sum(weights * pair.frequency_Hz**2)))
    turned = turn_rad_s * agreement.delay_standard_uncertainty_s
    return replace(
        verdict,
        torque_Nm=torque_Nm,
        torque_standard_uncertainty_Nm=float(np.hypot(scatter_Nm, of_gain * torque_Nm)),
        artefact_Nm=artefact_Nm,
        artefact_standard_uncertainty_Nm=float(
            np.linalg.norm([of_artefact_Nm, of_gain * torque_Nm, turned * torque_Nm])
        ),
    )
