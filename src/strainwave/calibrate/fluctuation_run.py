"""One run of all gauges: phasors of every harmonic beside a slow trend, and how well they are known.

What moves slowly (torque, drift) is a polynomial whose degree the run itself decides. Neighbouring
residuals are alike and so are those of gauges that share a torque, so that the covariance comes
from sums over blocks of rows and covers all gauges and harmonics at once. Godler et al. 2000,
section III, eq. (6)-(8).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.arrays import contiguous
from strainwave.calibrate.checks import require_finite, whole_number
from strainwave.calibrate.fluctuation import checked_run, checked_wave_factor
from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

#: Highest degree of the slow trend.
MOST_DEGREE: Final = 12
#: Blocks of rows whose scatter gives the covariance.
BLOCKS: Final = 32
#: A harmonic is there where one gauge shows it at this many standard errors; noise alone does so
#: with a probability of exp(-8) for each gauge.
LEAST_EVIDENCE: Final = 4.0


@dataclass(frozen=True)
class FluctuationRun:
    """Phasors of the gauges' harmonics in one run.

    Attributes
    ----------
    phasors : numpy.ndarray
        a exp(j phi), shape (harmonics, gauges), in the unit of the signals: gauge j shows
        a sin(2 i m beta + phi), phi = 2 i position + psi.
    covariance : numpy.ndarray
        Of the parts of the phasors, shape (harmonics, 2, gauges, harmonics, 2, gauges); part 0 is
        what multiplies the sine (the real part), part 1 the cosine.
    positions_rad : numpy.ndarray
        Positions of the gauges, shape (gauges,), rad.
    offsets : numpy.ndarray
        Signal of each gauge without its harmonics, mean over the run, shape (gauges,).
    residual_rms : numpy.ndarray
        What fits neither harmonics nor trend, root mean square, shape (gauges,).
    trend_degree : int
        Degree of the slow polynomial.
    wave_turns : float
        Turns of the wave that the run covers.
    rows : int
        Samples.
    """

    phasors: NDArray[np.complex128]
    covariance: NDArray[np.float64]
    positions_rad: NDArray[np.float64]
    offsets: NDArray[np.float64]
    residual_rms: NDArray[np.float64]
    trend_degree: int
    wave_turns: float
    rows: int

    @property
    def amplitudes(self) -> NDArray[np.float64]:
        """a_ij, shape (harmonics, gauges)."""
        return np.abs(self.phasors)

    @property
    def phase_errors_rad(self) -> NDArray[np.float64]:
        """psi_ij of eq. (6), shape (harmonics, gauges), rad, within +-pi."""
        return np.asarray(np.angle(self.phasors * np.exp(-1j * self._leads_rad)))

    @property
    def amplitude_standard_errors(self) -> NDArray[np.float64]:
        """Standard errors of the amplitudes, shape (harmonics, gauges)."""
        return self._error_along(np.angle(self.phasors))

    @property
    def phase_standard_errors_rad(self) -> NDArray[np.float64]:
        """Standard errors of the phases, shape (harmonics, gauges); at most pi, which is no phase."""
        across = self._error_along(np.angle(self.phasors) + np.pi / 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            errors = across / self.amplitudes
        return np.where(errors < np.pi, errors, np.pi)

    @cached_property
    def is_present(self) -> NDArray[np.bool_]:
        """Whether a harmonic stands out of the noise on some gauge, shape (harmonics,)."""
        rounding = 1e-12 * float(np.max(np.abs(self.phasors), initial=0.0))
        parts = np.einsum("ipjipj->ipj", self.covariance)
        errors = np.sqrt(parts.max(axis=1))
        shown = self.amplitudes > np.maximum(LEAST_EVIDENCE * errors, rounding)
        return np.asarray(shown.any(axis=1))

    @property
    def _leads_rad(self) -> NDArray[np.float64]:
        harmonic = np.arange(1, len(self.phasors) + 1)[:, np.newaxis]
        return np.asarray(2 * harmonic * self.positions_rad)

    def _error_along(self, direction_rad: NDArray[np.float64]) -> NDArray[np.float64]:
        sine_sine = np.einsum("ijij->ij", self.covariance[:, 0, :, :, 0])
        sine_cosine = np.einsum("ijij->ij", self.covariance[:, 0, :, :, 1])
        cosine_cosine = np.einsum("ijij->ij", self.covariance[:, 1, :, :, 1])
        along, beside = np.cos(direction_rad), np.sin(direction_rad)
        variance = (
            along**2 * sine_sine + 2 * along * beside * sine_cosine + beside**2 * cosine_cosine
        )
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    def conditions(self, harmonics: ArrayLike) -> NDArray[np.float64]:
        """Matrix of A g = 0 for some of the harmonics. Godler 2000, eq. (9).

        Parameters
        ----------
        harmonics : array_like
            Numbers of harmonics, from 1.

        Returns
        -------
        numpy.ndarray
            Shape (2 harmonics, gauges): sine and cosine parts, harmonic by harmonic.
        """
        chosen = self.phasors[np.asarray(harmonics, dtype=int) - 1]
        parts = np.stack([chosen.real, chosen.imag], axis=1)
        return parts.reshape(-1, chosen.shape[1])

    def weighted_sum(self, gains: ArrayLike) -> NDArray[np.complex128]:
        """Phasor of the weighted sum in every harmonic.

        Parameters
        ----------
        gains : array_like
            g_j, shape (gauges,).

        Returns
        -------
        numpy.ndarray
            Complex, shape (harmonics,).
        """
        return np.asarray(self.phasors @ np.asarray(gains, dtype=np.float64))

    def sum_standard_uncertainty(self, gains: ArrayLike) -> NDArray[np.float64]:
        """How well the phasor of the weighted sum is known, for gains that are exact.

        Parameters
        ----------
        gains : array_like
            g_j, shape (gauges,).

        Returns
        -------
        numpy.ndarray
            Root mean square of the standard uncertainties of its two parts, shape (harmonics,).
        """
        weight = np.asarray(gains, dtype=np.float64)
        variance = np.einsum("ipjipk,j,k->ip", self.covariance, weight, weight)
        return np.asarray(np.sqrt(np.maximum(variance.mean(axis=1), 0.0)))


def fit_run(
    signals: ArrayLike,
    motor_angle_rad: ArrayLike,
    *,
    positions_rad: ArrayLike,
    harmonics: int,
    wave_factor: float = 1.0,
    time_s: ArrayLike | None = None,
    stretches: ArrayLike | None = None,
) -> FluctuationRun:
    """Fit every harmonic of every gauge, beside a slow trend of the degree that the run shows.

    Parameters
    ----------
    signals : array_like
        Gauge signals in any unit, shape (samples, gauges).
    motor_angle_rad : array_like
        Wave-generator angle, shape (samples,), rad; any speed profile that covers half a turn.
    positions_rad : array_like
        Positions of the gauges, shape (gauges,), rad.
    harmonics : int
        Harmonics to fit, those included that nobody wants to cancel.
    wave_factor : float
        Factor m of the gear configuration.
    time_s : array_like, optional
        Time that the trend runs along, shape (samples,), s; row by row without.
    stretches : array_like, optional
        Whole numbers, shape (samples,): rows with different ones are apart in time and have
        trends of their own.

    Returns
    -------
    FluctuationRun
        Phasors and their covariance.

    Raises
    ------
    InputError
        If the shapes do not fit, values are not finite, the angle covers less than half a turn or
        does not tell the harmonics apart.
    """
    count = whole_number("harmonics", harmonics)
    factor = checked_wave_factor(wave_factor)
    signal, angle, position = checked_run(signals, motor_angle_rad, positions_rad, count)
    rows = len(angle)
    along = _optional("time_s", time_s, rows, np.arange(rows, dtype=np.float64))
    stretch = _optional("stretches", stretches, rows, np.zeros(rows))
    wave = wave_columns(factor * angle, count)
    cycles = factor * float(np.ptp(angle)) / np.pi
    powers = _trend_columns(along, stretch, int(np.clip(cycles, 1, MOST_DEGREE)))
    trend = np.column_stack(powers[: _degree(wave, powers, signal) + 1])
    observation = np.column_stack([trend, wave])
    orthogonal, triangle = np.linalg.qr(observation)
    diagonal = np.abs(np.diag(triangle))
    if rows <= observation.shape[1] or diagonal.min() <= 1e-10 * diagonal.max():
        raise InputError(
            f"motor_angle_rad does not tell {count} harmonic(s) and the trend of the signals "
            "apart: expected many different angles over half a turn or more; record at other "
            "angles, or fit fewer harmonics"
        )
    inverse = np.linalg.solve(triangle, orthogonal.T)
    parameters = inverse @ signal
    residuals = signal - observation @ parameters
    first = trend.shape[1]
    parts = parameters[first:].reshape(count, 2, -1)
    freedom = rows - observation.shape[1]
    return FluctuationRun(
        phasors=parts[:, 0] + 1j * parts[:, 1],
        covariance=_covariance(inverse[first:], residuals, freedom),
        positions_rad=position,
        offsets=(trend @ parameters[:first]).mean(axis=0),
        residual_rms=np.sqrt(np.sum(residuals**2, axis=0) / freedom),
        trend_degree=trend.shape[1] // len(np.unique(stretch)) - 1,
        wave_turns=factor * float(np.ptp(angle)) / (2 * np.pi),
        rows=rows,
    )


def rms_left(runs: Sequence[FluctuationRun], gains: NDArray[np.float64]) -> float:
    """Root mean square of the fluctuation left, in all harmonics fitted, in the worst run.

    What gains leave in the run they were solved from is nothing; in another one it is what the
    phasors are uncertain by. Both count.

    Parameters
    ----------
    runs : sequence of FluctuationRun
        The runs.
    gains : numpy.ndarray
        g_j, shape (gauges,).

    Returns
    -------
    float
        In the unit of the signals.
    """
    return max(
        float(
            np.sqrt(
                np.sum(
                    np.abs(run.weighted_sum(gains)) ** 2 / 2
                    + run.sum_standard_uncertainty(gains) ** 2
                )
            )
        )
        for run in runs
    )


def wave_columns(wave_angle_rad: NDArray[np.float64], harmonics: int) -> NDArray[np.float64]:
    """Columns sin(2 i phi) and cos(2 i phi), harmonic by harmonic.

    Parameters
    ----------
    wave_angle_rad : numpy.ndarray
        Angle phi of the wave against the gauges, shape (samples,), rad.
    harmonics : int
        How many.

    Returns
    -------
    numpy.ndarray
        Shape (samples, 2 harmonics).
    """
    turning = np.multiply.outer(wave_angle_rad, 2.0 * np.arange(1, harmonics + 1))
    return np.stack([np.sin(turning), np.cos(turning)], axis=2).reshape(len(wave_angle_rad), -1)


def _optional(
    name: str, values: ArrayLike | None, rows: int, default: NDArray[np.float64]
) -> NDArray[np.float64]:
    if values is None:
        return default
    array = contiguous(name, values, np.float64)
    if array.shape != (rows,):
        raise InputError(
            f"{name} has {len(array)} elements: expected {rows}, one a row of the signals; check "
            "both"
        )
    require_finite(name, array, "row")
    return array


def _trend_columns(
    along: NDArray[np.float64], stretch: NDArray[np.float64], degree: int
) -> list[NDArray[np.float64]]:
    """Chebyshev polynomials by degree, each with a column for every stretch."""
    labels = np.unique(stretch)
    columns = [np.zeros((len(along), len(labels))) for _ in range(degree + 1)]
    for place, label in enumerate(labels):
        rows = stretch == label
        middle, half = along[rows].mean(), np.ptp(along[rows]) / 2
        shifted = (along[rows] - middle) / half if half > 0 else np.zeros(int(rows.sum()))
        for power, values in enumerate(np.polynomial.chebyshev.chebvander(shifted, degree).T):
            columns[power][rows, place] = values
    return columns


def _degree(
    wave: NDArray[np.float64], powers: list[NDArray[np.float64]], signal: NDArray[np.float64]
) -> int:
    """Degree of the trend by Schwarz's criterion, over all gauges at once."""
    most = max(1, min(len(powers), (len(signal) - wave.shape[1]) // (4 * powers[0].shape[1])))
    columns = np.column_stack([wave, *powers[:most]])
    explained = np.linalg.qr(columns)[0].T @ signal
    left = np.sum(signal**2, axis=0) - np.cumsum(explained**2, axis=0)
    # A channel that says nothing has no noise to compare with.
    floor = 1e-20 * np.sum(signal**2, axis=0) + np.finfo(float).tiny
    stretches = powers[0].shape[1]
    after = np.maximum(left[wave.shape[1] + stretches - 1 :: stretches], floor)
    price = np.log(len(signal)) * stretches * signal.shape[1] * np.arange(len(after))
    return int(np.argmin(len(signal) * np.sum(np.log(after), axis=1) + price))


def _covariance(
    influence: NDArray[np.float64], residuals: NDArray[np.float64], freedom: int
) -> NDArray[np.float64]:
    """Covariance of the harmonics from sums over blocks of rows, at least that of white noise."""
    parameters, rows = influence.shape
    gauges = residuals.shape[1]
    blocks = max(4, min(BLOCKS, rows // 8))
    edges = np.linspace(0, rows, blocks + 1).astype(int)
    sums = np.array(
        [
            (influence[:, start:end] @ residuals[start:end]).ravel()
            for start, end in itertools.pairwise(edges)
        ]
    )
    # The sums over all blocks are 0, which takes one of them away; fitted parameters take more.
    scattered = sums.T @ sums * (blocks / (blocks - 1)) * (rows / freedom)
    shared = residuals.T @ residuals / freedom
    white = np.einsum("aa,jj->aj", influence @ influence.T, shared).ravel()
    diagonal = np.diag(scattered)
    tiny = np.finfo(float).tiny
    factor = np.sqrt(np.maximum(1.0, white / np.maximum(diagonal, tiny)))
    covariance = scattered * np.outer(factor, factor)
    return np.asarray(covariance.reshape(parameters // 2, 2, gauges, parameters // 2, 2, gauges))
