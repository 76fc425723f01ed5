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
from strainwave.calibrate.fluctuation_run import wave_columns
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: Phases that are tried before Newton's steps.
START_PHASES: Final = 64
NEWTON_STEPS: Final = 6
#: Rows at a time, so that memory stays small.
CHUNK_ROWS: Final = 20_000
#: Samples that the curve is fitted to; more do not make it better than their noise.
MOST_FITTED: Final = 3_000
MOST_ROUNDS: Final = 30
#: Harmonics of the curve that are tried where their number is not told.
MOST_HARMONICS: Final = 4
#: Smaller over larger extent of the curve below which it is a line and shows no angle.
FLATTEST: Final = 0.02

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
        curve = _Curve(np.zeros(basis.shape[1]), _parts(self.phasors) @ basis)
        points = (signal - self.offsets) @ basis
        angle = np.concatenate(
            [
                _nearest(curve, points[start : start + CHUNK_ROWS])
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


@dataclass(frozen=True)
class _Curve:
    """A closed curve: centre and coefficients of sin(2 i phi), cos(2 i phi)."""

    centre: NDArray[np.float64]
    parts: NDArray[np.float64]

    @property
    def harmonics(self) -> int:
        return len(self.parts) // 2

    def at(self, angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(self.centre + wave_columns(angle_rad, self.harmonics) @ self.parts)

    def derivative(self) -> _Curve:
        order = 2.0 * np.arange(1, self.harmonics + 1)[:, np.newaxis]
        parts = np.empty_like(self.parts)
        parts[0::2], parts[1::2] = -order * self.parts[1::2], order * self.parts[0::2]
        return _Curve(np.zeros_like(self.centre), parts)


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
    curve, start = _ellipse(chosen)
    _require_whole(start)
    curve = _oriented(_best(curve, chosen, start, tried), basis, position)
    nearest = np.concatenate(
        [
            _nearest(curve, points[first : first + CHUNK_ROWS])
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


def _nearest(curve: _Curve, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angle of the nearest place on the curve: the best of many phases, then Gauss-Newton."""
    phases = np.arange(START_PHASES) * np.pi / START_PHASES
    places = curve.at(phases)
    away = np.sum(places**2, axis=1) - 2 * points @ places.T
    return _refined(curve, points, phases[np.argmin(away, axis=1)])


def _refined(
    curve: _Curve,
    points: NDArray[np.float64],
    start: NDArray[np.float64],
    steps: int = NEWTON_STEPS,
) -> NDArray[np.float64]:
    angle = start
    slope_of = curve.derivative()
    for _ in range(steps):
        slope = slope_of.at(angle)
        along = np.sum(slope * (points - curve.at(angle)), axis=1)
        square = np.maximum(np.sum(slope**2, axis=1), np.finfo(float).tiny)
        # Never further than to the next phases that were tried.
        angle = angle + np.clip(along / square, -np.pi / START_PHASES, np.pi / START_PHASES)
    return angle


def _ellipse(points: NDArray[np.float64]) -> tuple[_Curve, NDArray[np.float64]]:
    """Conic through the two largest directions of the points, and the angle along it."""
    middle = points.mean(axis=0)
    spread = np.linalg.svd(points - middle, full_matrices=False)
    scale = spread[1] / np.sqrt(len(points))
    if not scale[1] > FLATTEST * scale[0]:
        raise InputError(
            "the gauges draw a line and no closed curve: expected at least half a turn of the wave "
            "seen at different phases; turn the wave generator further, or record its angle"
        )
    plane = spread[2][:2].T
    x, y = ((points - middle) @ plane / scale[:2]).T
    conic = np.linalg.lstsq(
        np.column_stack([x * x, x * y, y * y, x, y]), np.ones(len(x)), rcond=None
    )[0]
    shape = np.array([[conic[0], conic[1] / 2], [conic[1] / 2, conic[2]]])
    values, vectors = np.linalg.eigh(shape)
    if values[0] <= 0:
        raise InputError(
            "the gauges draw no closed curve: expected at least half a turn of the wave at about "
            "constant conditions; turn the wave generator further, or record its angle"
        )
    centre = -np.linalg.solve(shape, conic[3:]) / 2
    radius = np.sqrt((1 + centre @ shape @ centre) / values)
    turned = (np.column_stack([x, y]) - centre) @ vectors / radius
    angle = np.arctan2(turned[:, 0], turned[:, 1]) / 2
    parts = (vectors * radius * scale[:2, np.newaxis]).T @ plane.T
    return _Curve(middle + (centre * scale[:2]) @ plane.T, parts), np.mod(angle, np.pi)


def _require_whole(angle_rad: NDArray[np.float64]) -> None:
    """Refuse a run that leaves a part of the curve out: nobody knows what happens there."""
    passed = np.sort(np.mod(angle_rad, np.pi))
    gap = np.max(np.diff(np.concatenate([passed, passed[:1] + np.pi])))
    if gap > np.pi / 4:
        raise InputError(
            f"the gauges leave {np.rad2deg(gap):.0f} of 180 degrees of the wave out: expected a run "
            "over at least half a turn, in many samples; turn the wave generator further, or "
            "record its angle"
        )


def _best(
    ellipse: _Curve, points: NDArray[np.float64], start: NDArray[np.float64], tried: range
) -> _Curve:
    """Fitted curve with the number of harmonics that the points speak for."""
    best, least = ellipse, np.inf
    for count in tried:
        parts = np.zeros((2 * count, points.shape[1]))
        parts[:2] = ellipse.parts
        curve = _fitted(_Curve(ellipse.centre, parts), points, start)
        away = points - curve.at(_refined(curve, points, start))
        rows, directions = points.shape
        # Each point is free along the curve; a shift of all angles takes one parameter away.
        spread = float(np.sum(away**2)) / (rows * (directions - 1)) + np.finfo(float).tiny
        parameters = (2 * count + 1) * directions - 1
        price = rows * (directions - 1) * np.log(spread) + parameters * np.log(rows)
        if price >= least:
            break
        best, least = curve, price
    return best


def _fitted(curve: _Curve, points: NDArray[np.float64], start: NDArray[np.float64]) -> _Curve:
    """Curve of least distance: Gauss-Newton steps with every sample's angle eliminated."""
    angle = start
    directions = points.shape[1]
    size = (2 * curve.harmonics + 1) * directions
    for _ in range(MOST_ROUNDS):
        angle = _refined(curve, points, angle, steps=2)
        columns = np.column_stack([np.ones(len(points)), wave_columns(angle, curve.harmonics)])
        slope = curve.derivative().at(angle)
        slope = slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-300)
        across = np.eye(directions) - slope[:, :, np.newaxis] * slope[:, np.newaxis, :]
        away = np.einsum("nde,ne->nd", across, points - curve.at(angle))
        paired = columns[:, :, np.newaxis] * columns[:, np.newaxis, :]
        normal = np.einsum("nab,nde->adbe", paired, across, optimize=True).reshape(size, size)
        right = (columns.T @ away).ravel()
        # Shifting all angles changes nothing: that direction has no step.
        step = np.linalg.lstsq(normal, right, rcond=1e-9)[0].reshape(-1, directions)
        curve = _Curve(curve.centre + step[0], curve.parts + step[1:])
        if np.max(np.abs(step)) <= 1e-9 * np.max(np.abs(curve.parts)):
            break
    return curve


def _oriented(
    curve: _Curve, basis: NDArray[np.float64], positions_rad: NDArray[np.float64]
) -> _Curve:
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
    return _Curve(curve.centre, _parts(phasors * np.exp(-1j * order * lead)) @ basis)
