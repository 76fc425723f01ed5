"""The default ripple filter as first designed, written down once more, plainly.

Dense matrices, one sample at a time, no tricks: it is the independent implementation that the core
is tested against, and imports nothing of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class ReferenceSettings:
    """What the filter is told.

    Attributes
    ----------
    terms : sequence of (float, str)
        Orders per turn of the given angle, each with what scales it: ``"constant"``, ``"load"`` or
        ``"speed"``.
    memory_turns : float
        Memory n, motor turns.
    torque_noise_Nm : float
        Standard deviation of the measured torque, sqrt(R).
    torque_walk_Nm_per_sqrt_s : float
        Random walk of the torque state: its variance grows by the square of this a second.
    initial_amplitude_Nm : float
        Standard deviation of the coefficients at the start, five percent of full scale.
    rated_torque_Nm : float
        Full scale.
    reference_speed_rad_s : float
        Speed at which the speed terms' regressor is 1.
    minimum_speed_rad_s : float
        Smoothed speed below which the coefficients rest.
    contact_rule : str
        What is done with an innovation beyond three scales. ``"weighted"``: the coefficients' gain
        times limit / |e|, as first designed. ``"jump"``: it is taken for a jump of true torque,
        whose variance is raised until the innovation is at the limit, as in the core; and what the
        coefficients may still be wrong by widens the limit. ``"none"``: nothing.
    scale_rate_per_rad : float
        Rate of the innovations' tracked scale; 0.03 as first designed.
    load_flattens : bool
        Whether the load terms' regressor is L / (1 + |L|), as in the core, and not L.
    variance_limited : bool
        Whether a term gains the less process noise the less it is known, and none where its
        variance is the initial one, as in the core.
    noise_shared : bool
        Whether an order's process noise is divided by the sum of its regressors' squares, so that
        its further terms do not shorten its memory, as in the core.
    noise_after : bool
        Whether process noise comes after the sample and not before it, as in the core.
    gaps_bridged : bool
        Whether an interval of over two typical ones brings the process noise of the typical ones in
        it, as in the core.
    rest_is_exact : bool
        Whether no rotation at all brings no process noise, as in the core; else it brings the limit
        of that of ever smaller rotations.
    """

    terms: Sequence[tuple[float, str]]
    memory_turns: float = 30.0
    torque_noise_Nm: float = 0.04
    torque_walk_Nm_per_sqrt_s: float = 1.3
    initial_amplitude_Nm: float = 2.0
    rated_torque_Nm: float = 40.0
    reference_speed_rad_s: float = 150.0
    minimum_speed_rad_s: float = 2.0
    contact_rule: str = "weighted"
    scale_rate_per_rad: float = 0.03
    load_flattens: bool = False
    variance_limited: bool = False
    noise_shared: bool = False
    noise_after: bool = False
    gaps_bridged: bool = False
    rest_is_exact: bool = False


#: Time constants of the low-passes: of the speed that says whether the motor moves, of that in the
#: speed terms, of the load (15 Hz).
MOVING_SMOOTHING_S: Final = 0.05
SPEED_TERM_SMOOTHING_S: Final = 0.01
LOAD_SMOOTHING_S: Final = 1 / (2 * np.pi * 15.0)
#: The innovations' scale: share that may exceed it, least over the noise.
SHARE_BEYOND_SCALE: Final = 0.3
LEAST_SCALE: Final = 0.5
#: An innovation beyond this many scales is no ripple.
ROBUST_LIMIT: Final = 3.0
#: An interval of over so many typical ones is a gap; those are smoothed over so many.
LEAST_GAP: Final = 2.0
TYPICAL_OVER: Final = 64


@dataclass(frozen=True)
class ReferenceResult:
    """What the filter makes of a recording.

    Attributes
    ----------
    torque_Nm, ripple_Nm, torque_state_Nm : numpy.ndarray
        Measured minus ripple, ripple predicted from the samples before, and T, shape (samples,).
    coefficients_Nm : numpy.ndarray
        Coefficients at the end, cosine and sine of each term in turn.
    """

    torque_Nm: NDArray[np.float64]
    ripple_Nm: NDArray[np.float64]
    torque_state_Nm: NDArray[np.float64]
    coefficients_Nm: NDArray[np.float64]


def reference_filter(
    settings: ReferenceSettings,
    time_s: NDArray[np.float64],
    motor_angle_rad: NDArray[np.float64],
    torque_Nm: NDArray[np.float64],
    expected_torque_Nm: NDArray[np.float64] | None = None,
) -> ReferenceResult:
    """Run the filter over a recording.

    Parameters
    ----------
    settings : ReferenceSettings
        What it is told.
    time_s, motor_angle_rad, torque_Nm : numpy.ndarray
        The recording, shape (samples,).
    expected_torque_Nm : numpy.ndarray, optional
        T_exp; 0 without.

    Returns
    -------
    ReferenceResult
        Torque and ripple.
    """
    orders = np.array([order for order, _ in settings.terms], dtype=np.float64)
    scaled_by = [{"constant": 0, "load": 1, "speed": 2}[kind] for _, kind in settings.terms]
    expected = np.zeros(len(time_s)) if expected_torque_Nm is None else expected_torque_Nm
    size = 1 + 2 * len(orders)
    R = settings.torque_noise_Nm**2
    walk = settings.torque_walk_Nm_per_sqrt_s**2
    state = np.zeros(size)
    P = settings.initial_amplitude_Nm**2 * np.eye(size)
    scale_Nm = ROBUST_LIMIT * settings.torque_noise_Nm
    moving_speed = speed = 0.0
    load_Nm = 0.0
    noise = _ProcessNoise(settings, orders)
    h = np.ones(size)
    ripple = np.zeros(len(time_s))
    torque_state = np.zeros(len(time_s))
    for n in range(len(time_s)):
        dt = time_s[n] - time_s[n - 1] if n else 0.0
        turned = motor_angle_rad[n] - motor_angle_rad[n - 1] if n else 0.0
        if n:
            moving_speed += dt / (dt + MOVING_SMOOTHING_S) * (turned / dt - moving_speed)
            speed += dt / (dt + SPEED_TERM_SMOOTHING_S) * (turned / dt - speed)
        moves = abs(moving_speed) >= settings.minimum_speed_rad_s
        load = load_Nm / settings.rated_torque_Nm
        factors = [
            1.0,
            load / (1.0 + abs(load)) if settings.load_flattens else load,
            abs(speed) / settings.reference_speed_rad_s,
        ]
        scales = np.array(factors)[scaled_by]
        h[1::2] = scales * np.cos(orders * motor_angle_rad[n])
        h[2::2] = scales * np.sin(orders * motor_angle_rad[n])
        ripple[n] = h[1:] @ state[1:]
        rest_Nm = torque_Nm[n] - expected[n] - ripple[n]
        if n == 0:
            # T is what the coefficients leave: the limit of an infinite variance.
            state[0] = rest_Nm
            P[0, 1:] = P[1:, 0] = -P[1:, 1:] @ h[1:]
            P[0, 0] = R + h[1:] @ P[1:, 1:] @ h[1:]
            load_Nm = torque_Nm[n] - ripple[n]
            torque_state[n] = state[0] + expected[n]
            continue
        P[0, 0] += walk * dt
        if moves and not settings.noise_after:
            noise.add(P, h, turned, dt)
        innovation = rest_Nm - state[0]
        _update(settings, state, P, h, innovation, scale_Nm, moves=moves)
        if moves:
            scale_Nm = _next_scale(settings, scale_Nm, innovation, turned)
        if moves and settings.noise_after:
            noise.add(P, h, turned, dt)
        noise.take_interval(dt)
        torque_state[n] = state[0] + expected[n]
        load_Nm += dt / (dt + LOAD_SMOOTHING_S) * (torque_Nm[n] - ripple[n] - load_Nm)
    return ReferenceResult(torque_Nm - ripple, ripple, torque_state, state[1:].copy())


def _next_scale(
    settings: ReferenceSettings, scale_Nm: float, innovation_Nm: float, turned_rad: float
) -> float:
    beyond = float(abs(innovation_Nm) > scale_Nm)
    rate = settings.scale_rate_per_rad * min(abs(turned_rad), 3.0)
    next_Nm = scale_Nm * float(np.exp(rate * (beyond - SHARE_BEYOND_SCALE)))
    return max(next_Nm, LEAST_SCALE * settings.torque_noise_Nm)


class _ProcessNoise:
    # What the terms' variances gain with the angle.

    def __init__(self, settings: ReferenceSettings, orders: NDArray[np.float64]) -> None:
        self._settings = settings
        self._orders = orders
        self._typical_s = 0.0

    def add(
        self, P: NDArray[np.float64], h: NDArray[np.float64], turned_rad: float, dt_s: float
    ) -> None:
        settings = self._settings
        R = settings.torque_noise_Nm**2
        walk = settings.torque_walk_Nm_per_sqrt_s**2
        if settings.rest_is_exact and turned_rad == 0.0:
            walk = 0.0
        pieces = 1.0
        if settings.gaps_bridged and 0.0 < LEAST_GAP * self._typical_s < dt_s:
            pieces = dt_s / self._typical_s
        gained = pieces * process_variance(
            self._orders, turned_rad / pieces, dt_s / pieces, R, walk
        )
        gained /= (2 * np.pi * settings.memory_turns) ** 2
        squares = h[1::2] ** 2 + h[2::2] ** 2
        seen = np.array([squares[self._orders == order].sum() for order in self._orders])
        if settings.noise_shared:
            gained /= seen
        if settings.variance_limited:
            gained *= self._shares(P, h, squares, seen)
        P[np.diag_indices_from(P)] += np.concatenate([[0.0], np.repeat(gained, 2)])

    def _shares(
        self,
        P: NDArray[np.float64],
        h: NDArray[np.float64],
        squares: NDArray[np.float64],
        seen: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        # Of an order's first term the variance is that of the ripple that all of them make.
        most = 2 * self._settings.initial_amplitude_Nm**2
        variances = np.diag(P)[1::2] + np.diag(P)[2::2]
        shares = 1 - variances / most
        for order in dict.fromkeys(self._orders):
            terms = np.flatnonzero(self._orders == order)
            factors = np.sign(
                h[1 + 2 * terms] * h[1 + 2 * terms[0]] + h[2 + 2 * terms] * h[2 + 2 * terms[0]]
            ) * np.sqrt(squares[terms])
            ripple = sum(
                factors @ P[np.ix_(side + 2 * terms, side + 2 * terms)] @ factors for side in (1, 2)
            )
            shares[terms[0]] = 1 - ripple / (seen[terms[0]] * most)
        clipped: NDArray[np.float64] = np.maximum(shares, 0.0)
        return clipped

    def take_interval(self, dt_s: float) -> None:
        if self._typical_s > 0.0:
            counted_s = min(dt_s, LEAST_GAP * self._typical_s)
            self._typical_s += (counted_s - self._typical_s) / TYPICAL_OVER
        else:
            self._typical_s = dt_s


def _update(
    settings: ReferenceSettings,
    state: NDArray[np.float64],
    P: NDArray[np.float64],
    h: NDArray[np.float64],
    innovation_Nm: float,
    scale_Nm: float,
    *,
    moves: bool,
) -> None:
    # Kalman's gain, changed for contacts and at rest; P as it follows from the gain that is used.
    R = settings.torque_noise_Nm**2
    limit_Nm = ROBUST_LIMIT * scale_Nm
    if settings.contact_rule == "jump":
        limit_Nm = max(limit_Nm, ROBUST_LIMIT * float(np.sqrt(h[1:] @ P[1:, 1:] @ h[1:])))
    excess = abs(innovation_Nm) / limit_Nm
    weight = 1.0
    if moves and excess > 1.0:
        if settings.contact_rule == "jump":
            P[0, 0] += (h @ P @ h + R) * (excess**2 - 1.0)
        elif settings.contact_rule == "weighted":
            weight = 1.0 / excess
    Ph = P @ h
    s = h @ Ph + R
    gain = Ph / s
    gain[1:] *= weight if moves else 0.0
    state += gain * innovation_Nm
    P += s * np.outer(gain, gain) - np.outer(gain, Ph) - np.outer(Ph, gain)


def process_variance(
    orders: NDArray[np.float64], turned_rad: float, dt_s: float, R: float, walk: float
) -> NDArray[np.float64]:
    """Growth of a coefficient's variance over a sample, times the memory squared.

    Q_k = 2 R_eff,k (dtheta / memory)^2 with R_eff,k = R + q_T / (2 - 2 cos(k dtheta)): beside a
    torque that walks, a line is seen the worse the slower it passes.

    Parameters
    ----------
    orders : numpy.ndarray
        Orders per turn of the angle.
    turned_rad : float
        Rotation since the sample before.
    dt_s : float
        Time since then.
    R, walk : float
        Variance of the measured torque, Nm^2, and growth of the torque's, Nm^2/s.

    Returns
    -------
    numpy.ndarray
        One for each order, Nm^2 rad^2.
    """
    passed = orders * abs(turned_rad)
    chord = np.where(passed > np.pi, 4.0, 2.0 - 2.0 * np.cos(passed))
    # For no rotation the quotient's limit, 1/k^2.
    quotient = np.divide(turned_rad**2, chord, out=1.0 / orders**2, where=passed > 1e-6)
    return 2.0 * R * turned_rad**2 + 2.0 * walk * dt_s * quotient
