"""Do a reference sensor and the joint's own read the same torque: gain, delay and lag.

Only torque that is no ripple can say it. In each window of travel both signals are taken apart into
orders and a slow polynomial, by the same least squares; the slow parts of all windows are fitted:

    reference(t + delay) = gain x lag(measured)(t) + offset

A lag is a first-order low-pass, put forward by its own delay, so that delay and lag say different
things: the delay is that of slow torque, and the lag what is lost on top of it where torque is fast.
A lag below zero is one of the measured torque.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.optimize import minimize
from scipy.signal import lfilter

from strainwave.identify.order_phasors import block_sums
from strainwave.identify.orders import SLOW_DEGREE, window_basis

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.identify.moving_rows import MovingRows

#: Delays of the reference behind the measured torque that are looked at, s.
DELAYS_S: Final = np.arange(-0.05, 0.2501, 0.002)
#: Delays and lags beyond this are none of a torque sensor, s.
LONGEST_S: Final = 0.3
#: Lags from which the search for the best one starts, s.
LAGS_S: Final = (0.0, 2e-3, -2e-3, 8e-3, -8e-3, 3e-2, 1e-1)
#: Slow torque has to vary by this multiple of its own noise, as variances.
LEAST_VARIATION: Final = 100.0
LEAST_WINDOWS: Final = 6
#: Stretches of the recording whose disagreement makes the uncertainty.
BLOCKS: Final = 20
#: Standard deviation of the smoothing before signals are shifted, rows.
SMOOTHING_ROWS: Final = 2.0
#: A gain that is known no better than this is not known, relatively.
LARGEST_GAIN_UNCERTAINTY: Final = 0.05


@dataclass(frozen=True)
class Signal:
    """A torque over time.

    Attributes
    ----------
    time_s, torque_Nm : numpy.ndarray
        Rows in order of time, without gaps in the numbers, shape (rows,), s and Nm.
    """

    time_s: NDArray[np.float64]
    torque_Nm: NDArray[np.float64]


@dataclass(frozen=True)
class Agreement:
    """How a reference follows the measured torque.

    Attributes
    ----------
    gain, gain_standard_uncertainty : float
        Reference over measured torque.
    delay_s, delay_standard_uncertainty_s : float
        Time by which the reference's slow torque comes after the measured one, s.
    lag_square_s2, lag_square_standard_uncertainty_s2 : float
        Square of the time constant by which the reference is slower, with the sign of that time
        constant, s^2; what is lost grows with the square.
    """

    gain: float
    gain_standard_uncertainty: float
    delay_s: float
    delay_standard_uncertainty_s: float
    lag_square_s2: float
    lag_square_standard_uncertainty_s2: float

    def phase_of_lag_rad(self, frequency_Hz: float) -> tuple[float, float]:
        """Bound what frequency times time constant is.

        Parameters
        ----------
        frequency_Hz : float
            A frequency, Hz.

        Returns
        -------
        tuple of float
            Least and largest magnitude of 2 pi frequency times time constant, rad, at two
            standard uncertainties.
        """
        spread = 2 * self.lag_square_standard_uncertainty_s2
        least = np.sqrt(max(0.0, abs(self.lag_square_s2) - spread))
        # No lag is longer than the delay that it makes.
        of_delay = abs(self.delay_s) + 2 * self.delay_standard_uncertainty_s
        largest = min(np.sqrt(abs(self.lag_square_s2) + spread), of_delay)
        turn = 2 * np.pi * frequency_Hz
        return float(turn * min(least, largest)), float(turn * largest)


def find_agreement(
    rows: MovingRows,
    angle_rad: NDArray[np.float64],
    windows: Sequence[slice],
    candidates: Sequence[float],
    factor: float,
    measured: Signal,
    reference: Signal,
) -> Agreement | None:
    """Fit gain, delay and lag to the slow torque.

    Parameters
    ----------
    rows : MovingRows
        The recording in motion.
    angle_rad : numpy.ndarray
        Motor angles of these rows, put back by the measured torque's delay, shape (rows,), rad.
    windows : sequence of slice
        Windows of travel.
    candidates : sequence of float
        Orders that are kept apart, cycles per turn of the wave.
    factor : float
        Turns of the wave per motor turn, m.
    measured, reference : Signal
        Both torques, rest included.

    Returns
    -------
    Agreement or None
        None where the slow torque hardly changes, or the two have nothing in common.
    """
    fit = _SlowFit(rows, angle_rad, windows, candidates, factor, measured, reference)
    if not fit.varies:
        return None
    at_once = [fit.cost(delay_s, 0.0) for delay_s in DELAYS_S]
    start_s = float(DELAYS_S[int(np.argmin(at_once))])
    starts = [(fit.cost(start_s, lag_s), lag_s) for lag_s in LAGS_S]
    lag_s = min(starts)[1]
    step_s = fit.period_s
    simplex = np.array([[0.0, 0.0], [2 * step_s, 0.0], [0.0, step_s + 0.5 * abs(lag_s)]])
    found = minimize(
        lambda each: fit.cost(each[0], each[1]),
        (start_s, lag_s),
        method="Nelder-Mead",
        bounds=[(-LONGEST_S, LONGEST_S)] * 2,
        options={
            "initial_simplex": simplex + np.array([start_s, lag_s]),
            "xatol": 1e-3 * step_s,
            "fatol": np.inf,
            "maxfev": 200,
        },
    )
    agreement = fit.agreement(float(found.x[0]), float(found.x[1]))
    uncertainty = agreement.gain_standard_uncertainty
    if not uncertainty <= LARGEST_GAIN_UNCERTAINTY * abs(agreement.gain):
        return None
    return agreement


class _SlowFit:
    """Slow torque of both signals, for any delay and lag."""

    def __init__(
        self,
        rows: MovingRows,
        angle_rad: NDArray[np.float64],
        windows: Sequence[slice],
        candidates: Sequence[float],
        factor: float,
        measured: Signal,
        reference: Signal,
    ) -> None:
        # Both alike, so that nothing between them changes: between two rows a straight line has less
        # noise than on them, and delays of half a row would be preferred.
        self._measured, self._reference = _smoothed(measured), _smoothed(reference)
        self.period_s = float(np.median(np.diff(measured.time_s)))
        points = np.polynomial.chebyshev.chebpts1(SLOW_DEGREE + 1)
        values = np.polynomial.chebyshev.chebvander(points, SLOW_DEGREE)
        self._times: list[NDArray[np.float64]] = []
        self._slow: list[NDArray[np.float64]] = []
        noise = []
        for window in windows:
            built = window_basis(angle_rad[window], candidates, factor)
            if built is None:
                continue
            inverse = np.linalg.pinv(built[1])
            left = rows.torque_Nm[window] - built[1] @ (inverse @ rows.torque_Nm[window])
            spread = float(left @ left) / max(1, len(left) - len(inverse))
            slow = values @ inverse[-len(points) :]
            noise.append(spread * float(np.mean(np.sum(slow**2, axis=1))))
            self._times.append(rows.time_s[window])
            self._slow.append(slow)
        self._edges = np.cumsum([0, *map(len, self._times)])
        self._time_s = np.concatenate([np.empty(0), *self._times])
        self.varies = len(self._slow) >= LEAST_WINDOWS and bool(
            np.var(self._of(self._measured, 0.0, 0.0)) > LEAST_VARIATION * np.median(noise)
        )

    def _of(self, signal: Signal, after_s: float, lag_s: float) -> NDArray[np.float64]:
        """Slow values of a signal that is slowed by a lag and put forward, one row a window."""
        torque_Nm = signal.torque_Nm
        time_s = signal.time_s
        if lag_s > 0.0:
            # Of even steps; the filter's delay is exactly the lag.
            time_s = np.arange(time_s[0], time_s[-1], self.period_s)
            torque_Nm = np.interp(time_s, signal.time_s, torque_Nm)
            keep = lag_s / (lag_s + self.period_s)
            torque_Nm, _ = lfilter([1 - keep], [1.0, -keep], torque_Nm, zi=[keep * torque_Nm[0]])
        shifted = np.interp(self._time_s + after_s + max(lag_s, 0.0), time_s, torque_Nm)
        edges = zip(self._edges[:-1], self._edges[1:], self._slow, strict=True)
        return np.array([slow @ shifted[first:past] for first, past, slow in edges])

    def _pair(self, delay_s: float, lag_s: float) -> tuple[NDArray[np.float64], ...]:
        measured = self._of(self._measured, 0.0, lag_s)
        return self._of(self._reference, delay_s, -lag_s), measured

    def _line(self, delay_s: float, lag_s: float) -> tuple[float, float, NDArray[np.float64]]:
        reference, measured = self._pair(delay_s, lag_s)
        away = measured - measured.mean()
        gain = float(np.sum(away * reference) / np.sum(away**2))
        offset = float(reference.mean() - gain * measured.mean())
        return gain, offset, reference - gain * measured - offset

    def cost(self, delay_s: float, lag_s: float) -> float:
        """Sum of the squares of what gain and offset leave."""
        return float(np.sum(self._line(delay_s, lag_s)[2] ** 2))

    def agreement(self, delay_s: float, lag_s: float) -> Agreement:
        """Give the fit's parameters with their uncertainties, from how far stretches disagree."""
        gain, offset, left = self._line(delay_s, lag_s)
        square = lag_s * abs(lag_s)

        def rest(delay_s: float, square: float) -> NDArray[np.float64]:
            lag_s = float(np.sign(square) * np.sqrt(abs(square)))
            reference, measured = self._pair(delay_s, lag_s)
            return reference - gain * measured - offset

        step_s = 0.5 * self.period_s
        step_s2 = max(self.period_s**2, 0.1 * abs(square))
        by_delay = (rest(delay_s + step_s, square) - rest(delay_s - step_s, square)) / 2 / step_s
        by_lag = rest(delay_s, square + step_s2) - rest(delay_s, square - step_s2)
        slopes = np.stack(
            [
                -self._pair(delay_s, lag_s)[1],
                np.full_like(left, -1.0),
                by_delay,
                by_lag / 2 / step_s2,
            ],
            axis=-1,
        )
        scale = np.sqrt(np.mean(slopes**2, axis=(0, 1)))
        scale = np.where(scale > 0.0, scale, 1.0)
        slopes = slopes / scale
        normal = block_sums(np.einsum("wpi,wpj->wij", slopes, slopes), BLOCKS)
        scores = block_sums(np.einsum("wpi,wp->wi", slopes, left), BLOCKS)
        # The jackknife: a few stretches, the contacts, may know all about delay and lag.
        without = np.array(
            [
                np.linalg.pinv(normal.sum(axis=0) - each) @ score
                for each, score in zip(normal, scores, strict=True)
            ]
        )
        share = (len(scores) - 1) / len(scores)
        deviation = np.sqrt(share * np.sum(without**2, axis=0)) / scale
        return Agreement(
            gain,
            float(deviation[0]),
            delay_s,
            float(deviation[2]),
            square,
            float(deviation[3]),
        )


def _smoothed(signal: Signal) -> Signal:
    return Signal(signal.time_s, gaussian_filter1d(signal.torque_Nm, SMOOTHING_ROWS))
