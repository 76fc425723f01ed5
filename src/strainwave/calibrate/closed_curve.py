"""Closed curves that gauges draw: fitted to points, and the angle along them.

Points have no angle of their own. A curve is fitted by its distance to them, with every point's
angle eliminated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.fluctuation_run import wave_columns
from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Phases that are tried before Newton's steps.
START_PHASES: Final = 64
NEWTON_STEPS: Final = 6
MOST_ROUNDS: Final = 30
#: Smaller over larger extent of the curve below which it is a line and shows no angle.
FLATTEST: Final = 0.02


@dataclass(frozen=True)
class ClosedCurve:
    """A closed curve: a centre, and what multiplies sin(2 i phi) and cos(2 i phi).

    Attributes
    ----------
    centre : numpy.ndarray
        Shape (directions,).
    parts : numpy.ndarray
        Sine and cosine, harmonic by harmonic, shape (2 harmonics, directions).
    """

    centre: NDArray[np.float64]
    parts: NDArray[np.float64]

    @property
    def harmonics(self) -> int:
        """Number of harmonics."""
        return len(self.parts) // 2

    def at(self, angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places on the curve.

        Parameters
        ----------
        angle_rad : numpy.ndarray
            phi, shape (places,), rad.

        Returns
        -------
        numpy.ndarray
            Shape (places, directions).
        """
        return np.asarray(self.centre + wave_columns(angle_rad, self.harmonics) @ self.parts)

    def derivative(self) -> ClosedCurve:
        """Differentiate with respect to phi.

        Returns
        -------
        ClosedCurve
            Its places are the slopes.
        """
        order = 2.0 * np.arange(1, self.harmonics + 1)[:, np.newaxis]
        parts = np.empty_like(self.parts)
        parts[0::2], parts[1::2] = -order * self.parts[1::2], order * self.parts[0::2]
        return ClosedCurve(np.zeros_like(self.centre), parts)


def nearest_angle_rad(curve: ClosedCurve, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angle of the nearest place on the curve: the best of many phases, then Gauss-Newton.

    Parameters
    ----------
    curve : ClosedCurve
        The curve.
    points : numpy.ndarray
        Shape (points, directions).

    Returns
    -------
    numpy.ndarray
        Shape (points,), rad.
    """
    phases = np.arange(START_PHASES) * np.pi / START_PHASES
    places = curve.at(phases)
    away = np.sum(places**2, axis=1) - 2 * points @ places.T
    return _refined(curve, points, phases[np.argmin(away, axis=1)])


def _refined(
    curve: ClosedCurve,
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


def ellipse_of(points: NDArray[np.float64]) -> tuple[ClosedCurve, NDArray[np.float64]]:
    """Conic through the two largest directions of the points, and the angle along it.

    Parameters
    ----------
    points : numpy.ndarray
        Shape (points, directions).

    Returns
    -------
    tuple
        The ellipse as a curve of one harmonic, and the angle of each point, rad.

    Raises
    ------
    InputError
        If the points are on a line or on no closed curve.
    """
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
    return ClosedCurve(middle + (centre * scale[:2]) @ plane.T, parts), np.mod(angle, np.pi)


def require_whole(angle_rad: NDArray[np.float64]) -> None:
    """Refuse a run that leaves a part of the curve out: nobody knows what happens there.

    Parameters
    ----------
    angle_rad : numpy.ndarray
        Angles along the curve, shape (points,), rad.

    Raises
    ------
    InputError
        If more than 45 of 180 degrees are missing.
    """
    passed = np.sort(np.mod(angle_rad, np.pi))
    gap = np.max(np.diff(np.concatenate([passed, passed[:1] + np.pi])))
    if gap > np.pi / 4:
        raise InputError(
            f"the gauges leave {np.rad2deg(gap):.0f} of 180 degrees of the wave out: expected a run "
            "over at least half a turn, in many samples; turn the wave generator further, or "
            "record its angle"
        )


def best_curve(
    ellipse: ClosedCurve, points: NDArray[np.float64], start: NDArray[np.float64], tried: range
) -> ClosedCurve:
    """Fitted curve with the number of harmonics that the points speak for.

    Parameters
    ----------
    ellipse : ClosedCurve
        Where to start.
    points : numpy.ndarray
        Shape (points, directions).
    start : numpy.ndarray
        Angles along the ellipse, shape (points,), rad.
    tried : range
        Numbers of harmonics, rising.

    Returns
    -------
    ClosedCurve
        By Schwarz's criterion.
    """
    best, least = ellipse, np.inf
    for count in tried:
        parts = np.zeros((2 * count, points.shape[1]))
        parts[:2] = ellipse.parts
        curve = _fitted(ClosedCurve(ellipse.centre, parts), points, start)
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


def _fitted(
    curve: ClosedCurve, points: NDArray[np.float64], start: NDArray[np.float64]
) -> ClosedCurve:
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
        curve = ClosedCurve(curve.centre + step[0], curve.parts + step[1:])
        if np.max(np.abs(step)) <= 1e-9 * np.max(np.abs(curve.parts)):
            break
    return curve
