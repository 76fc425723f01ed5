"""The wave's angle from the gauges alone: M phase-shifted fluctuations are a resolver of order 2.

What torque does to the gauges is known by its direction, so it is projected out; three gauges or
more then draw a closed curve that is passed once in half a turn of the wave. Where the curve is
known, a sample at rest tells the angle. Where it is not, a run in motion shows it: an ellipse is
fitted first, then the curve of all harmonics whose distance to the samples is least.

What no gauge can tell: whole half turns (the angle is modulo pi), and where the motor's zero is
(phase 0 is where the first harmonic of gauge 1 passes zero rising, apart from its position). The
direction follows from the positions of the gauges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.arrays import contiguous
from strainwave.calibrate.checks import require_finite, whole_number
from strainwave.calibrate.closed_curve import (
    FLATTEST,
    ClosedCurve,
    best_curve,
    ellipse_of,
    nearest_angle_rad,
    require_whole,
)
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Rows at a time, so that memory stays small.
CHUNK_ROWS: Final = 20_000
#: Samples that the curve is fitted to; more do not make it better than their noise.
MOST_FITTED: Final = 3_000
#: Harmonics of the curve that are tried where their number is not told.
MOST_HARMONICS: Final = 4

AMBIGUITY: Final = (
    "the angle is that of the wave against the gauges, modulo pi; its zero is where the first "
    "harmonic of gauge 1 has the phase error 0, and its direction follows from the positions of "
    "the gauges"
)


@dataclass(frozen=True)
class ResolvedAngle:
    """The wave's angle, sample by sample.

    Attributes
    ----------
    wave_angle_rad : numpy.ndarray
        m beta, from 0 to pi, shape (samples,), rad.
    distance : numpy.ndarray
        What the curve does not explain, root mean square over the directions left, in the unit of
        the signals, shape (samples,); a parity check with four gauges or more, and with three
        where it is more than noise.
    """

    wave_angle_rad: NDArray[np.float64]
    distance: NDArray[np.float64]


@dataclass(frozen=True)
class GaugeResolver:
    """Tells the wave's angle from a sample of all gauges, at rest as in motion.

    Attributes
    ----------
    phasors : numpy.ndarray
        a exp(j phi) of every harmonic and gauge, shape (harmonics, gauges): those of a
        `strainwave.calibrate.fluctuation_run.FluctuationRun`.
    offsets : numpy.ndarray
        Signal of each gauge without its harmonics, shape (gauges,); what of it is along the torque
        does not matter.
    torque_sensitivities : numpy.ndarray
        t_j, shape (gauges,).
    """

    phasors: NDArray[np.complex128]
    offsets: NDArray[np.float64]
    torque_sensitivities: NDArray[np.float64]

    def __post_init__(self) -> None:
        gauges = self.phasors.shape[1]
        if gauges < 3:
            raise InputError(
                f"{gauges} gauge(s) do not tell torque from the wave's angle: expected at least 3; "
                "record the angle, or add a gauge"
            )
        for name in ("offsets", "torque_sensitivities"):
            if getattr(self, name).shape != (gauges,):
                raise InputError(
                    f"{name} has the shape {getattr(self, name).shape}: expected ({gauges},), one "
                    "a gauge; check it against the phasors"
                )
        basis = _without_torque(self.torque_sensitivities)
        first = basis.T @ np.stack([self.phasors[0].real, self.phasors[0].imag], axis=1)
        extent = np.linalg.svd(first, compute_uv=False)
        if not extent[1] > FLATTEST * extent[0]:
            raise InputError(
                "the gauges' first harmonics lie on one line once torque is taken out: expected "
                "gauges that see the wave at different phases; move one of them"
            )

    def angle(self, signals: ArrayLike) -> ResolvedAngle:
        """Find the wave's angle in each sample by itself.

        Parameters
        ----------
        signals : array_like
            Gauge signals, shape (samples, gauges), or (gauges,) for one sample.

        Returns
        -------
        ResolvedAngle
            Angle modulo pi, and how far the sample is from what the curve allows.

        Raises
        ------
        InputError
            If the shape does not fit or a value is not finite.
        """
        signal = contiguous("signals", np.atleast_2d(signals), np.float64, dimensions=2)
        if signal.shape[1] != self.phasors.shape[1]:
            raise InputError(
                f"signals has the shape {signal.shape}: expected {self.phasors.shape[1]} columns, "
                "one a gauge; check the channels"
            )
        require_finite("signals", signal, "row", "column")
        basis = _without_torque(self.torque_sensitivities)
        curve = ClosedCurve(np.zeros(basis.shape[1]), _parts(self.phasors) @ basis)
        points = (signal - self.offsets) @ basis
        angle = np.concatenate(
            [
                nearest_angle_rad(curve, points[start : start + CHUNK_ROWS])
                for start in range(0, max(1, len(points)), CHUNK_ROWS)
            ]
        )
        away = points - curve.at(angle)
        # One of the directions left is along the curve and says nothing.
        freedom = max(1, basis.shape[1] - 1)
        return ResolvedAngle(np.mod(angle, np.pi), np.sqrt(np.sum(away**2, axis=1) / freedom))


@dataclass(frozen=True)
class SelfCalibration:
    """A curve found without an angle, and the angle of the run it came from.

    Attributes
    ----------
    resolver : GaugeResolver
        For other samples; its phasors lack what is along the torque, which only
        `strainwave.calibrate.fluctuation_run.fit_run` against the angle can tell.
    wave_angle_rad : numpy.ndarray
        Angle of the run, unwrapped, shape (samples,), rad.
    distance_rms : float
        Distance of the samples from the curve, in the unit of the signals.
    """

    resolver: GaugeResolver
    wave_angle_rad: NDArray[np.float64]
    distance_rms: float


def calibrate_without_angle(
    signals: ArrayLike,
    *,
    positions_rad: ArrayLike,
    harmonics: int | None = None,
    torque_sensitivities: ArrayLike | None = None,
) -> SelfCalibration:
    """Find the curve of the gauges in a run without an angle, and the wave's angle along it.

    Parameters
    ----------
    signals : array_like
        Gauge signals, shape (samples, gauges), three gauges or more; the wave passes half a turn
        at least, by less than a quarter of one from sample to sample.
    positions_rad : array_like
        Positions of the gauges, shape (gauges,), rad: they tell the direction.
    harmonics : int, optional
        Harmonics of the curve; chosen by Schwarz's criterion without. One that the wave does not
        have is no help: curves of more harmonics than needed can be passed at other angles.
    torque_sensitivities : array_like, optional
        t_j, shape (gauges,); equal without. Their ratios have to be right to tell a change of
        torque from the wave.

    Returns
    -------
    SelfCalibration
        Curve and angle.

    Raises
    ------
    InputError
        If there are fewer than three gauges, too few samples, or no closed curve.
    """
    tried = range(1, MOST_HARMONICS + 1)
    if harmonics is not None:
        tried = range(whole_number("harmonics", harmonics), harmonics + 1)
    signal = contiguous("signals", signals, np.float64, dimensions=2)
    position = contiguous("positions_rad", positions_rad, np.float64)
    gauges = signal.shape[1]
    if gauges < 3 or position.shape != (gauges,):
        raise InputError(
            f"signals has {gauges} column(s) and positions_rad {len(position)} element(s): expected "
            "as many of each, and at least 3 gauges to find an angle; record the angle, or add a "
            "gauge"
        )
    require_finite("signals", signal, "row", "column")
    fewest = 8 * (2 * tried[-1] + 1)
    if len(signal) < fewest:
        raise InputError(
            f"signals has {len(signal)} rows: expected at least {fewest} to find an angle and "
            f"{tried[-1]} harmonic(s); record more"
        )
    torque = np.ones(gauges) if torque_sensitivities is None else np.asarray(torque_sensitivities)
    basis = _without_torque(torque.astype(np.float64))
    points = signal @ basis
    chosen = points[np.linspace(0, len(points) - 1, min(len(points), MOST_FITTED)).astype(int)]
    curve, start = ellipse_of(chosen)
    require_whole(start)
    curve = _oriented(best_curve(curve, chosen, start, tried), basis, position)
    nearest = np.concatenate(
        [
            nearest_angle_rad(curve, points[first : first + CHUNK_ROWS])
            for first in range(0, len(points), CHUNK_ROWS)
        ]
    )
    away = points - curve.at(nearest)
    phasors = _complex(curve.parts @ basis.T)
    offsets = curve.centre @ basis.T
    return SelfCalibration(
        resolver=GaugeResolver(phasors, offsets, torque.astype(np.float64)),
        wave_angle_rad=np.unwrap(nearest, period=np.pi),
        distance_rms=float(np.sqrt(np.mean(np.sum(away**2, axis=1)))),
    )


def _without_torque(torque: NDArray[np.float64]) -> NDArray[np.float64]:
    """Orthonormal directions of the gauges in which torque does not show."""
    return np.asarray(np.linalg.svd(torque[np.newaxis])[2][1:].T)


def _parts(phasors: NDArray[np.complex128]) -> NDArray[np.float64]:
    return np.stack([phasors.real, phasors.imag], axis=1).reshape(-1, phasors.shape[1])


def _complex(parts: NDArray[np.float64]) -> NDArray[np.complex128]:
    return np.asarray(parts[0::2] + 1j * parts[1::2])


def _oriented(
    curve: ClosedCurve, basis: NDArray[np.float64], positions_rad: NDArray[np.float64]
) -> ClosedCurve:
    """Turn the curve in the gauges' direction, with its zero at gauge 1."""
    phasors = _complex(curve.parts @ basis.T)
    expected = np.exp(-2j * positions_rad)
    forwards = abs(np.sum(phasors[0] * expected))
    # sin(2 i phi) changes its sign with phi.
    mirrored = -np.conj(phasors)
    if abs(np.sum(mirrored[0] * expected)) > forwards:
        phasors = mirrored
    lead = float(np.angle(phasors[0, 0] * expected[0]))
    order = np.arange(1, len(phasors) + 1)[:, np.newaxis]
    return ClosedCurve(curve.centre, _parts(phasors * np.exp(-1j * order * lead)) @ basis)
