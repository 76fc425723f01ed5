"""Notches that follow the motor: one second-order section for each order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from benchmarks.accuracy.methods.interface import Method, Removal
from strainwave import _core

if TYPE_CHECKING:
    from benchmarks.accuracy.methods.interface import Log, Setting


def remove(log: Log, setting: Setting, *, width_Hz: float) -> Removal:
    """Pass the torque through a notch for each order.

    The package's `--method notch` has one width and the orders of a joint file; here both are
    open, so that it can be tuned like the others.

    Parameters
    ----------
    log : Log
        The recording.
    setting : Setting
        Sample period and orders.
    width_Hz : float
        -3 dB width of each notch.

    Returns
    -------
    Removal
        Torque, and what was filtered out.
    """
    notch = _core.TrackingNotch(
        orders=setting.orders, bandwidth_Hz=width_Hz, sample_period_s=setting.sample_period_s
    )
    torque, ripple, _ = notch.process(log.torque_Nm, log.wave_angle_rad)
    return Removal(torque, ripple)


TRACKING_NOTCH = Method(
    "tracking notch",
    remove,
    tuple({"width_Hz": width} for width in (0.3, 1.0, 3.0, 10.0)),
    "lets everything pass while an order is slower than the notch is wide",
)
