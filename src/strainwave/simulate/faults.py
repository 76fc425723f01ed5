"""Failures of gauges and channels, and what they look like behind the amplifier."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from strainwave.errors import ConfigurationError
from strainwave.simulate.checks import require_integer, require_number
from strainwave.simulate.trajectories import FloatArray


class FaultKind(Enum):
    """What has failed."""

    OPEN = "open"
    """A gauge is torn: the half bridge hangs on its other arm, the amplifier is at its upper rail."""
    SHORT = "short"
    """The signal leads touch: the bridge gives 0 V, the amplifier its offset."""
    STUCK = "stuck"
    """The converter repeats its last code."""
    SATURATED = "saturated"
    """The amplifier is at its lower rail whatever the bridge says."""
    DETACHED = "detached"
    """The bond gives way: the gauge sees part of the strain only."""


@dataclass(frozen=True)
class Fault:
    """One failure.

    Parameters
    ----------
    kind : FaultKind or str
        What fails: open, short, stuck, saturated, detached.
    gauge : int
        Which gauge, counted from 0.  Where all gauges share one full bridge, its one channel fails.
    start_s : float
        When, at least 0.
    end_s : float
        Until when; default: for good.
    remaining : float
        For a detached gauge the share of the strain that it still sees, 0 to 1.
    """

    kind: FaultKind | str
    gauge: int
    start_s: float = 0.0
    end_s: float = math.inf
    remaining: float = 0.5

    def __post_init__(self) -> None:
        try:
            object.__setattr__(self, "kind", FaultKind(self.kind))
        except ValueError:
            words = ", ".join(kind.value for kind in FaultKind)
            raise ConfigurationError("kind", self.kind, "", f"one of {words}") from None
        require_integer("gauge", self.gauge, "", minimum=0)
        require_number("start_s", self.start_s, "s", minimum=0.0)
        if math.isnan(self.end_s) or not self.end_s > self.start_s:
            raise ConfigurationError(
                "end_s", self.end_s, "s", f"a number above start_s, {self.start_s:g}"
            )
        require_number("remaining", self.remaining, "", minimum=0.0, maximum=1.0)

    def active(self, time_s: FloatArray) -> NDArray[np.bool_]:
        """Return when the fault is present.

        Parameters
        ----------
        time_s : ndarray, shape (n,)
            Time, s.

        Returns
        -------
        ndarray of bool, shape (n,)
            True while it is.
        """
        return np.asarray((time_s >= self.start_s) & (time_s < self.end_s))


def remaining_strain(faults: tuple[Fault, ...], gauge: int, time_s: FloatArray) -> FloatArray:
    """Return the share of its strain that a gauge sees.

    Parameters
    ----------
    faults : tuple of Fault
        All faults of the station.
    gauge : int
        Index of the gauge from 0.
    time_s : ndarray, shape (n,)
        Time, s.

    Returns
    -------
    ndarray, shape (n,)
        1 for a sound bond.
    """
    share = np.ones(len(time_s))
    for fault in faults:
        if fault.kind is FaultKind.DETACHED and fault.gauge == gauge:
            share[fault.active(time_s)] *= fault.remaining
    return share


def faulty_bridge_V(
    faults: tuple[Fault, ...], bridge_V: FloatArray, time_s: FloatArray, supply_V: float
) -> FloatArray:
    """Return the bridge's output with torn gauges and shorted leads.

    Parameters
    ----------
    faults : tuple of Fault
        Faults of this channel.
    bridge_V : ndarray, shape (n,)
        Output of the sound bridge, V.
    time_s : ndarray, shape (n,)
        Time, s.
    supply_V : float
        Supply of the bridge, V: half of it appears where an arm is torn, far beyond the rails.

    Returns
    -------
    ndarray, shape (n,)
        Output of the bridge, V.
    """
    failed = bridge_V.copy()
    for fault in faults:
        active = fault.active(time_s)
        if fault.kind is FaultKind.OPEN:
            failed[active] = supply_V / 2
        elif fault.kind is FaultKind.SHORT:
            failed[active] = 0.0
        elif fault.kind is FaultKind.SATURATED:
            failed[active] = -supply_V / 2
    return failed


def faulty_codes(
    faults: tuple[Fault, ...], codes: NDArray[np.int32], time_s: FloatArray
) -> NDArray[np.int32]:
    """Return the converter's codes with those that are stuck.

    Parameters
    ----------
    faults : tuple of Fault
        Faults of this channel.
    codes : ndarray of int32, shape (n,)
        Codes of the working converter.
    time_s : ndarray, shape (n,)
        Time, s.

    Returns
    -------
    ndarray of int32, shape (n,)
        Codes.
    """
    failed = codes.copy()
    for fault in faults:
        if fault.kind is not FaultKind.STUCK:
            continue
        stuck = np.flatnonzero(fault.active(time_s))
        if len(stuck):
            failed[stuck] = failed[max(stuck[0] - 1, 0)]
    return failed
