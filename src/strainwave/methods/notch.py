"""The tracking notch, for comparison: second-order notches at the orders, which follow the motor.

The arithmetic and what it rests on are in ``include/strainwave/tracking_notch.hpp``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave import _core
from strainwave.arrays import contiguous
from strainwave.configuration import oscillator_filter_of, ripple_filter_of
from strainwave.errors import InputError
from strainwave.methods.interface import Cleaned, nothing

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from strainwave.methods.setting import Setting
    from strainwave.samples import Samples

#: Orders of the gear's ripple where the joint file names none, cycles per turn of the wave generator.
STANDARD_ORDERS = (2, 4)
#: Between the -3 dB points of each notch.
STANDARD_BANDWIDTH_HZ = 1.0


class Notch:
    """One notch an order, in series, turned by the motor's angle.

    Below a centre of twice the bandwidth a notch fades out, and below once the bandwidth it lets the
    torque through unchanged, because it would take slow true torque for ripple. Rows without usable
    torque are flagged and hold torque and ripple of the last good one. Rows without an angle are
    flagged; the motor is then taken to turn on as before. Rows count as equally spaced in the
    bandwidth; the centre follows the angles, whatever the time between them.

    Parameters
    ----------
    setting : Setting
        Sample period; the orders are those of the joint file's ``[ripple_filter]`` of method
        ``oscillator``, or else 2 and 4 times the gear's factor m.
    bandwidth_Hz : float
        Between the two -3 dB points of each notch, Hz.

    Raises
    ------
    InputError
        If the bandwidth is no millionth or more than an eighth of the sample rate.
    """

    def __init__(self, setting: Setting, bandwidth_Hz: float = STANDARD_BANDWIDTH_HZ) -> None:
        self._notch = _core.TrackingNotch(
            orders=notch_orders(setting),
            bandwidth_Hz=bandwidth_Hz,
            sample_period_s=setting.sample_period_s,
        )

    def process(self, samples: Samples, /) -> Cleaned:
        """Remove the orders from the next rows.

        Parameters
        ----------
        samples : Samples
            The rows that follow those of the last call.

        Returns
        -------
        Cleaned
            One row for each.
        """
        return Cleaned(
            *self._notch.process(
                contiguous("torque_Nm", samples.torque_Nm, np.float64),
                contiguous("motor_angle_rad", samples.motor_angle_rad, np.float64),
            )
        )

    def finish(self) -> Cleaned:
        """Hand out nothing: no rows are held back.

        Returns
        -------
        Cleaned
            No rows.
        """
        return nothing()


def notch_orders(setting: Setting) -> Sequence[Fraction | _core.Rational]:
    """Take the orders that the joint file's filter removes, or else the gear's two strongest."""
    joint = setting.joint
    section = None if joint is None else joint.ripple_filter
    if joint is None or section is None:
        return [order * setting.wave_factor for order in STANDARD_ORDERS]
    if section.method == "ripple":
        removed = [each.order for each in ripple_filter_of(joint).orders if not each.keep]
        if not removed:
            raise InputError(
                "[ripple_filter]: every order is in kept_orders; expected one at least that the "
                "notch removes, so take one out of kept_orders"
            )
        return removed
    return oscillator_filter_of(joint).orders
