"""Monte Carlo of gauge layouts: what is left of the wave, how noisy, and how many meet a limit.

Every layout has its own errors. Untuned it is used with equal gains; tuned, with gains solved from
what a calibration run measured of its own wave (Godler et al. 2000, eq. 9), as a circuit can have
them. Torque is calibrated afterwards, so that residuals are in % of the layout's own full scale.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.calibrate.fluctuation import minimum_gauges
from strainwave.calibrate.gains import MOST_NOISE
from strainwave.design.checks import count_within, number_within
from strainwave.design.many_gains import gains_of_layouts, noise_factors
from strainwave.design.placement import Tolerances, Wave, draw_errors, gauge_signals
from strainwave.errors import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from strainwave.design.quantisation import Quantisation

    FloatArray = NDArray[np.float64]
    ComplexArray = NDArray[np.complex128]

MOST_GAUGES: Final = 9
MOST_COMPENSATED: Final = 4
MOST_TRIALS: Final = 10_000_000
#: Layouts that are in memory at once; the same whatever the machine, so that a seed means the same.
_BATCH: Final = 10_000
PERCENTILES: Final = (5, 50, 95)
#: Parts of the residual; see `LayoutStudy`.
PARTS: Final = ("above_N", "up_to_N_solved", "up_to_N")


@dataclass(frozen=True)
class LayoutCase:
    """A layout to study.

    Parameters
    ----------
    gauges : int
        M, 2 to 9; equally spaced but for their errors.
    harmonics : int
        N, 1 to 4: harmonics that the gains are solved against.
    tolerances : Tolerances
        How carefully the gauges are made and bonded.
    wave : Wave
        What there is to cancel.
    radius_mm : float
        Nominal distance of the gauges from the axis.
    measurement_error_FS : float
        Standard deviation of what the calibration run measures of every gauge's harmonics, of sine
        and cosine each, in % of the gauge's signal at rated torque.
    quantisation : Quantisation, optional
        Gains that the circuit can have; any without.
    most_noise : float
        Noise factor above which the solver refuses a layout, as `compensating_gains` does.
    lost_gauge : bool
        Whether every layout is also studied with each of its gauges lost.

    Raises
    ------
    InputError
        If a value cannot be used.
    """

    gauges: int
    harmonics: int
    tolerances: Tolerances = field(default_factory=Tolerances)
    wave: Wave = field(default_factory=Wave)
    radius_mm: float = 22.0
    measurement_error_FS: float = 0.01
    quantisation: Quantisation | None = None
    most_noise: float = MOST_NOISE
    lost_gauge: bool = False

    def __post_init__(self) -> None:
        count_within("gauges", self.gauges, 2, MOST_GAUGES)
        count_within("harmonics", self.harmonics, 1, MOST_COMPENSATED)
        number_within("radius_mm", self.radius_mm, "mm", 1.0, 1000.0)
        number_within("measurement_error_FS", self.measurement_error_FS, "%FS", 0.0, 100.0)
        if not self.most_noise >= 1:
            raise ConfigurationError(
                "most_noise", self.most_noise, "", "at least 1, the noise factor of equal gains"
            )
        if len(self.wave.amplitudes_FS) < self.harmonics:
            raise ConfigurationError(
                "wave_FS",
                self.wave.amplitudes_FS,
                "%FS",
                f"an amplitude for each of the {self.harmonics} harmonics to cancel",
                "give more, 0 where there is none, or fewer harmonics",
            )


@dataclass(frozen=True)
class Distribution:
    """How a sensor of many layouts does.

    Attributes
    ----------
    residual_FS, noise_factor : dict of int to float
        Percentiles; the residual is the sum of the amplitudes left in all harmonics, zero to peak:
        the largest it can be, whatever the phases between harmonics.
    negative_gain_share : float
        Share of layouts with a negative gain.
    refused_share : float
        Share of layouts whose gains raise the noise above the limit, or cancel torque.
    met_limit : float
        Yield: share of layouts that are not refused and whose residual is within the limit.
    met_limit_error : float
        Its standard error, of the number of trials.
    """

    residual_FS: dict[int, float]
    noise_factor: dict[int, float]
    negative_gain_share: float
    refused_share: float
    met_limit: float
    met_limit_error: float


@dataclass(frozen=True)
class LayoutStudy:
    """What the layouts of one case are worth.

    Attributes
    ----------
    case : LayoutCase
        What was studied.
    trials, seed : int
        How many layouts, and of which chance.
    limit_FS : float
        Limit of the residual.
    tuned, untuned : Distribution
        With gains solved for each layout, and with equal gains.
    lost_tuned, lost_untuned : Distribution or None
        The same after losing the gauge whose loss is worst, with the gains solved again.
    parts_FS : dict
        Percentiles of what the tuned residual consists of: "above_N", harmonics that no gains were
        solved against; "up_to_N_solved", what solved gains leave of the others (too few gauges,
        measurement error); "up_to_N", the same with the gains that the circuit has.
    """

    case: LayoutCase
    trials: int
    seed: int
    limit_FS: float
    tuned: Distribution
    untuned: Distribution
    lost_tuned: Distribution | None
    lost_untuned: Distribution | None
    parts_FS: dict[str, dict[int, float]]


def study_layout(
    case: LayoutCase, limit_FS: float, trials: int = 100_000, seed: int = 1
) -> LayoutStudy:
    """Draw layouts and say what they are worth.

    Parameters
    ----------
    case : LayoutCase
        What to study.
    limit_FS : float
        Limit of the residual, %FS zero to peak, above 0.
    trials : int
        Layouts, up to 10 million; 32 bytes of memory each, 52 with a lost gauge.
    seed : int
        Seed of everything random.

    Returns
    -------
    LayoutStudy
        Percentiles and shares.

    Raises
    ------
    InputError
        If a value cannot be used.
    """
    trials = count_within("trials", trials, 1, MOST_TRIALS)
    seed = count_within("seed", seed, 0, 2**63 - 1)
    limit_FS = number_within("limit_FS", limit_FS, "%FS", 1e-9, 1e6)
    names = ("tuned", "untuned", *(("lost_tuned", "lost_untuned") if case.lost_gauge else ()))
    kept = {name: _Kept.of(trials) for name in names}
    parts = {name: np.empty(trials, np.float32) for name in PARTS}
    generator = np.random.default_rng(seed)
    for rows in _batches(trials):
        batch = _Batch.drawn(case, generator, rows.stop - rows.start)
        kept["untuned"].put(rows, batch.equal())
        found, of_parts = batch.tuned_with_parts()
        kept["tuned"].put(rows, found)
        for name, values in of_parts.items():
            parts[name][rows] = values
        if case.lost_gauge:
            kept["lost_tuned"].put(rows, _worst([each.tuned() for each in batch.losses()]))
            kept["lost_untuned"].put(rows, _worst([each.equal() for each in batch.losses()]))
    results = {name: each.distribution(limit_FS) for name, each in kept.items()}
    return LayoutStudy(
        case,
        trials,
        seed,
        limit_FS,
        results["tuned"],
        results["untuned"],
        results.get("lost_tuned"),
        results.get("lost_untuned"),
        {name: percentiles(values) for name, values in parts.items()},
    )


def percentiles(values: NDArray[np.float32]) -> dict[int, float]:
    """Percentiles 5, 50 and 95.

    Parameters
    ----------
    values : numpy.ndarray
        One a layout.

    Returns
    -------
    dict of int to float
        By percentile.
    """
    found = np.percentile(values, PERCENTILES, method="inverted_cdf")
    return dict(zip(PERCENTILES, map(float, found), strict=True))


def _batches(trials: int) -> Iterator[slice]:
    for start in range(0, trials, _BATCH):
        yield slice(start, min(start + _BATCH, trials))


@dataclass(frozen=True)
class _Outcome:
    """Layouts with their gains; every array has the shape (layouts,)."""

    residual_FS: FloatArray
    noise_factor: FloatArray
    negative: NDArray[np.bool_]
    refused: NDArray[np.bool_]


@dataclass(frozen=True)
class _Kept:
    """What is kept of every layout, single precision."""

    residual_FS: NDArray[np.float32]
    noise_factor: NDArray[np.float32]
    negative: NDArray[np.bool_]
    refused: NDArray[np.bool_]

    @classmethod
    def of(cls, trials: int) -> _Kept:
        return cls(
            np.empty(trials, np.float32),
            np.empty(trials, np.float32),
            np.empty(trials, np.bool_),
            np.empty(trials, np.bool_),
        )

    def put(self, rows: slice, outcome: _Outcome) -> None:
        # A layout that cancels torque altogether has no finite residual; the largest float stands
        # for it, so that every percentile is a number.
        largest = np.finfo(np.float32).max
        for name in ("residual_FS", "noise_factor"):
            values = getattr(outcome, name)
            getattr(self, name)[rows] = np.fmin(np.where(np.isnan(values), np.inf, values), largest)
        self.negative[rows] = outcome.negative
        self.refused[rows] = outcome.refused

    def distribution(self, limit_FS: float) -> Distribution:
        met = float(np.mean((self.residual_FS <= limit_FS) & ~self.refused))
        return Distribution(
            percentiles(self.residual_FS),
            percentiles(self.noise_factor),
            float(np.mean(self.negative)),
            float(np.mean(self.refused)),
            met,
            float(np.sqrt(met * (1 - met) / len(self.refused))),
        )


def _worst(outcomes: list[_Outcome]) -> _Outcome:
    return _Outcome(
        np.maximum.reduce([each.residual_FS for each in outcomes]),
        np.maximum.reduce([each.noise_factor for each in outcomes]),
        np.logical_or.reduce([each.negative for each in outcomes]),
        np.logical_or.reduce([each.refused for each in outcomes]),
    )


@dataclass(frozen=True)
class _Batch:
    """Layouts: what their gauges see, and what a calibration run measured of it."""

    case: LayoutCase
    torque: FloatArray
    phasors: ComplexArray
    measured: ComplexArray

    @classmethod
    def drawn(cls, case: LayoutCase, generator: np.random.Generator, layouts: int) -> _Batch:
        shape = (layouts, len(case.wave.amplitudes_FS), case.gauges)
        errors = draw_errors(generator, case.tolerances, case.radius_mm, shape)
        torque, phasors = gauge_signals(case.wave, errors)
        # A harmonic that does not exist asks nothing of the gains.
        solved = [i for i in range(case.harmonics) if case.wave.amplitudes_FS[i] > 0]
        measured = phasors[:, solved]
        if case.measurement_error_FS:
            noise = generator.normal(0.0, case.measurement_error_FS, (2, *measured.shape))
            measured = measured + noise[0] + 1j * noise[1]
        return cls(case, torque, phasors, measured)

    def losses(self) -> Iterator[_Batch]:
        for lost in range(self.torque.shape[1]):
            kept = [j for j in range(self.torque.shape[1]) if j != lost]
            yield _Batch(
                self.case, self.torque[:, kept], self.phasors[:, :, kept], self.measured[:, :, kept]
            )

    def equal(self) -> _Outcome:
        return self._outcome(np.ones_like(self.torque), self._left(np.ones_like(self.torque)))

    def tuned(self) -> _Outcome:
        gains = self._in_circuit(gains_of_layouts(self.measured))
        return self._outcome(gains, self._left(gains))

    def tuned_with_parts(self) -> tuple[_Outcome, dict[str, FloatArray]]:
        solved = gains_of_layouts(self.measured)
        gains = self._in_circuit(solved)
        left = self._left(gains)
        solved_left = left if gains is solved else self._left(solved)
        harmonics = self.case.harmonics
        return self._outcome(gains, left), {
            "above_N": left[:, harmonics:].sum(axis=1),
            "up_to_N_solved": solved_left[:, :harmonics].sum(axis=1),
            "up_to_N": left[:, :harmonics].sum(axis=1),
        }

    def _in_circuit(self, gains: FloatArray) -> FloatArray:
        quantisation = self.case.quantisation
        return gains if quantisation is None else quantisation.apply(gains)

    def _left(self, gains: FloatArray) -> FloatArray:
        """Amplitude left in each harmonic, % of the calibrated full scale."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            signal = np.sum(gains * self.torque, axis=1, keepdims=True)
            wave = np.matmul(self.phasors, gains[:, :, np.newaxis].astype(np.complex128))
            left: FloatArray = np.abs(wave[:, :, 0]) / np.abs(signal)
        return left

    def _outcome(self, gains: FloatArray, left: FloatArray) -> _Outcome:
        noise = noise_factors(gains)
        return _Outcome(
            left.sum(axis=1),
            noise,
            np.any(gains < 0, axis=1),
            # Written so that what is not a number is refused.
            ~(noise <= self.case.most_noise),
        )


def remarks(case: LayoutCase) -> tuple[str, ...]:
    """Say what to know before the numbers of a case are used.

    Parameters
    ----------
    case : LayoutCase
        The case.

    Returns
    -------
    tuple of str
        A sentence each; empty where nothing is.
    """
    found = []
    needed = minimum_gauges(case.harmonics)
    if case.gauges < needed:
        found.append(
            f"{case.gauges} gauges are fewer than the {needed} that cancel every wave of "
            f"{case.harmonics} harmonic(s): the gains leave the least residual."
        )
    if case.lost_gauge and case.gauges == needed:
        found.append(
            f"One gauge lost of {case.gauges}, {case.gauges - 1} are fewer than the {needed} that "
            f"cancel every wave of {case.harmonics} harmonic(s)."
        )
    for number, amplitude in enumerate(case.wave.amplitudes_FS[: case.harmonics], start=1):
        if 0 < amplitude < 3 * case.measurement_error_FS:
            found.append(
                f"Harmonic {number}, {amplitude:.2g} %FS of a gauge, is hardly more than the "
                f"measurement error of {case.measurement_error_FS:.2g} %FS: gains against it "
                "follow the noise of the calibration run; cancel fewer harmonics."
            )
    if not any(case.tolerances.as_dict().values()):
        found.append("All tolerances are 0: these are ideal gauges; give a tolerance.")
    return tuple(found)


def assumptions(case: LayoutCase) -> tuple[str, ...]:
    """Say what was assumed of the wave and of its measurement.

    Parameters
    ----------
    case : LayoutCase
        The case.

    Returns
    -------
    tuple of str
        A sentence each.
    """
    shown = ", ".join(f"{amplitude:.3g}" for amplitude in case.wave.amplitudes_FS)
    in_sum = case.wave.amplitudes_FS[0] / case.gauges
    said = [
        f"Wave: {shown} %FS of one gauge's own signal in harmonics 1 to "
        f"{len(case.wave.amplitudes_FS)}; in the sum of {case.gauges} gauges the first counts as "
        f"{in_sum:.3g} %FS."
    ]
    if case.wave.amplitudes_FS == Wave().amplitudes_FS:
        said.append(
            "These follow from Godler et al. 2000 (18.9 %FS in the sum of three, the second a "
            "twentieth of that); harmonics above the second are not published and are taken to be "
            "a twentieth of the one before."
        )
    said.append(
        f"Gains are solved from phasors measured to {case.measurement_error_FS:g} %FS in sine and "
        "cosine (standard deviation); torque is calibrated afterwards."
    )
    return tuple(said)
