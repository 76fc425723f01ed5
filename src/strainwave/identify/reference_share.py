"""Torque's share of each order from a reference sensor: decided where the sensor can know it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.identify.moving_rows import MovingRows, moving_rows
from strainwave.identify.order_pair import OrderPair, pair_up, torque_share, with_amounts
from strainwave.identify.order_phasors import phasors_of, window_speeds_rad_s
from strainwave.identify.orders import order_windows
from strainwave.identify.reference_agreement import Agreement, Signal, find_agreement
from strainwave.identify.torque_or_artefact import (
    EVEN_SHARE,
    LEAST_WINDOWS,
    UNDECIDABLE,
    OrderVerdict,
    TorqueOrArtefact,
    decided,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.samples import Samples

#: Gains between which two sensors of one torque agree.
LEAST_GAIN: Final = 0.8
LARGEST_GAIN: Final = 1.25
#: Above this value of 2 pi frequency times time constant nothing is concluded from torque that the
#: reference does not show; below, it loses no more than the square root of 1 + its square.
LARGEST_LAG_RAD: Final = 2.0
#: Changes of a held reference in a cycle of an order, at least.
LEAST_UPDATES: Final = 4.0
#: Share of an order's windows in which the reference has to be fast enough.
LEAST_FAST_SHARE: Final = 0.5
#: A reference that stays the same in more than this share of the rows in motion is held.
LARGEST_HELD_SHARE: Final = 0.5


@dataclass(frozen=True)
class _Material:
    """Both torques in the same windows."""

    rows: MovingRows
    angle_rad: NDArray[np.float64]
    windows: list[slice]
    reference: Signal
    measured: Signal

    @property
    def reference_Nm(self) -> NDArray[np.float64]:
        """Reference in the rows in motion."""
        return np.interp(self.rows.time_s, self.reference.time_s, self.reference.torque_Nm)


def decide_by_reference(
    excerpt: Samples,
    reference_Nm: NDArray[np.float64],
    orders: Sequence[float],
    candidates: Sequence[float],
    factor: float,
    delay_s: float,
) -> TorqueOrArtefact:
    """Decide for each order whether it is torque, by a reference sensor.

    Parameters
    ----------
    excerpt : Samples
        Rows of the recording, with the motor's angle.
    reference_Nm : numpy.ndarray
        Torque of the reference in the same rows, shape (rows,), Nm; NaN where it is not known.
    orders : sequence of float
        Orders that are there, cycles per turn of the wave.
    candidates : sequence of float
        All orders that are kept apart.
    factor : float
        Turns of the wave per motor turn, m.
    delay_s : float
        Time by which the measured torque lags the angle.

    Returns
    -------
    TorqueOrArtefact
        A verdict on each order.
    """
    material = _material(excerpt, reference_Nm, delay_s)
    agreement = None
    if len(material.windows) >= LEAST_WINDOWS:
        agreement = find_agreement(
            material.rows,
            material.angle_rad,
            material.windows,
            candidates,
            factor,
            material.measured,
            material.reference,
        )
    refusal = _refusal(agreement)
    if refusal or agreement is None:
        verdicts = tuple(OrderVerdict(order, UNDECIDABLE, reason=refusal) for order in orders)
        says = (
            f"torque or artefact: {UNDECIDABLE}: {refusal}; every order is removed as an artefact"
        )
        return TorqueOrArtefact(verdicts, agreement, (says,))
    angle_rad = material.angle_rad - agreement.delay_s * material.rows.speed_rad_s
    of_reference = phasors_of(
        angle_rad, material.reference_Nm, material.windows, candidates, factor
    )
    of_torque = phasors_of(
        material.angle_rad, material.rows.torque_Nm, material.windows, candidates, factor
    )
    speeds = window_speeds_rad_s(material.rows, material.windows)
    updates_Hz = _updates_Hz(material)
    verdicts = tuple(
        _verdict(
            order,
            pair_up(
                of_torque[order],
                of_reference[order],
                agreement.gain,
                order * factor * speeds / (2 * np.pi),
            ),
            agreement,
            updates_Hz,
        )
        for order in orders
    )
    return TorqueOrArtefact(verdicts, agreement, _sentences(verdicts, agreement))


def _material(excerpt: Samples, reference_Nm: NDArray[np.float64], delay_s: float) -> _Material:
    known = np.isfinite(excerpt.time_s) & np.isfinite(reference_Nm)
    known &= np.isfinite(excerpt.torque_Nm)
    stamps = np.where(known, excerpt.time_s, -np.inf)
    known &= stamps > np.maximum.accumulate(np.append(-np.inf, stamps))[:-1]
    time_s = excerpt.time_s[known]
    torque_Nm = np.where(known, excerpt.torque_Nm, np.nan)
    rows = moving_rows(excerpt.time_s, excerpt.motor_angle_rad, torque_Nm)
    angle_rad = rows.angle_rad - delay_s * rows.speed_rad_s
    return _Material(
        rows,
        angle_rad,
        order_windows(angle_rad) if len(rows) else [],
        Signal(time_s, reference_Nm[known]),
        Signal(time_s, excerpt.torque_Nm[known]),
    )


def _refusal(agreement: Agreement | None) -> str:
    if agreement is None:
        return (
            "the slow torque of reference and recording has too little in common, or hardly "
            "changes, so that nothing shows that both read the same torque; check --reference, or "
            "record a motion during which the load changes"
        )
    if not LEAST_GAIN <= agreement.gain <= LARGEST_GAIN:
        return (
            f"the reference reads {agreement.gain:.3g} of the measured torque where both are slow; "
            "check its unit and sign (--reference COLUMN:UNIT, a minus before the column turns it "
            "round)"
        )
    return ""


def _updates_Hz(material: _Material) -> float:
    """How often a held reference changes; infinite for one that is not held."""
    steps = np.diff(material.reference_Nm)
    changes = int(np.count_nonzero(steps))
    if changes >= (1 - LARGEST_HELD_SHARE) * len(steps):
        return float("inf")
    intervals = np.diff(material.rows.time_s)
    # Rows at rest are left out: their gaps are no time in motion.
    moving_s = float(np.sum(np.minimum(intervals, 2 * np.median(intervals))))
    return changes / moving_s


def _verdict(
    order: float, pair: OrderPair, agreement: Agreement, updates_Hz: float
) -> OrderVerdict:
    if len(pair) < LEAST_WINDOWS:
        reason = (
            f"only {len(pair)} windows of travel show it in both torques; record a longer motion"
        )
        return OrderVerdict(order, UNDECIDABLE, reason=reason)
    share = torque_share(pair, agreement)
    if share is not None and share.interval[0] > EVEN_SHARE:
        # A slow reference hides torque and makes none: what it shows is there.
        return with_amounts(decided(order, share, "reference"), pair, agreement)
    lags_rad = np.array([agreement.phase_of_lag_rad(float(each))[1] for each in pair.frequency_Hz])
    fast = (lags_rad <= LARGEST_LAG_RAD) & (LEAST_UPDATES * pair.frequency_Hz <= updates_Hz)
    if np.count_nonzero(fast) < max(LEAST_WINDOWS, LEAST_FAST_SHARE * len(pair)):
        reason = _why_not_fast(agreement, float(np.median(pair.frequency_Hz)), updates_Hz)
        return OrderVerdict(order, UNDECIDABLE, reason=reason)
    pair = pair.of(fast)
    share = torque_share(pair, agreement)
    if share is None:
        reason = "it does not stand out of the noise where the reference is there; record more"
        return OrderVerdict(order, UNDECIDABLE, reason=reason)
    loss = float(np.sqrt(1.0 + np.max(lags_rad[fast]) ** 2))
    return with_amounts(decided(order, share, "reference", loss), pair, agreement)


def _why_not_fast(agreement: Agreement, frequency_Hz: float, updates_Hz: float) -> str:
    if LEAST_UPDATES * frequency_Hz > updates_Hz:
        return (
            f"the reference is held and changes only {updates_Hz:.3g} times a second, and the order "
            f"is at {frequency_Hz:.3g} Hz: it is too slow; record it faster, or move more slowly"
        )
    least, _ = agreement.phase_of_lag_rad(frequency_Hz)
    if least > LARGEST_LAG_RAD:
        corner_Hz = 1 / (2 * np.pi * np.sqrt(abs(agreement.lag_square_s2)))
        slower = "reference" if agreement.lag_square_s2 > 0 else "measured torque"
        return (
            f"the {slower} follows slow torque like a low-pass at {corner_Hz:.3g} Hz, and the order "
            f"is at {frequency_Hz:.3g} Hz: it is too slow; switch its filter off, or move more "
            "slowly"
        )
    return (
        f"the reference comes {1e3 * agreement.delay_s:.3g} ms after the measured torque, and the "
        f"torque in this recording does not tell whether it still follows at {frequency_Hz:.3g} Hz; "
        "record contacts or pushes as well, or move more slowly"
    )


def _sentences(verdicts: Sequence[OrderVerdict], agreement: Agreement) -> tuple[str, ...]:
    says = []
    away = abs(agreement.gain - 1.0)
    if away > max(0.02, 2 * agreement.gain_standard_uncertainty):
        says.append(
            f"the reference reads {agreement.gain:.3g} of the measured torque where both are slow; "
            "torque's shares are put right by that, and the torque's calibration is worth a check"
        )
    says += [
        f"torque or artefact, order {each.order:g}: {UNDECIDABLE}: {each.reason}; removed as an "
        "artefact"
        for each in verdicts
        if each.reason
    ]
    return tuple(says)
