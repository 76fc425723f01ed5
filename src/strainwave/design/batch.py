"""Some layouts at once: what they are worth with equal gains, tuned, and without one gauge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.design.many_gains import gains_of_layouts, noise_factors
from strainwave.design.placement import draw_errors, gauge_signals

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from strainwave.design.case import LayoutCase

    FloatArray = NDArray[np.float64]
    ComplexArray = NDArray[np.complex128]

#: Parts of the residual: harmonics that no gains were solved against, what solved gains leave of
#: the others, and what the circuit's gains leave of them.
PARTS: Final = ("above_N", "up_to_N_solved", "up_to_N")


@dataclass(frozen=True)
class Outcome:
    """What layouts are worth with their gains; every array has the shape (layouts,).

    Attributes
    ----------
    residual_FS : numpy.ndarray
        Sum of the amplitudes left in all harmonics; not finite where torque is cancelled too.
    noise_factor : numpy.ndarray
        M sum(g^2) / (sum g)^2.
    negative, refused : numpy.ndarray
        Whether a gain is negative, and whether the solver refuses the gains.
    """

    residual_FS: FloatArray
    noise_factor: FloatArray
    negative: NDArray[np.bool_]
    refused: NDArray[np.bool_]


def worst_outcome(outcomes: list[Outcome]) -> Outcome:
    """Take the worst of several outcomes of the same layouts, quantity by quantity.

    Parameters
    ----------
    outcomes : list of Outcome
        At least one.

    Returns
    -------
    Outcome
        Largest residual and noise; negative or refused where any is.
    """
    return Outcome(
        np.maximum.reduce([each.residual_FS for each in outcomes]),
        np.maximum.reduce([each.noise_factor for each in outcomes]),
        np.logical_or.reduce([each.negative for each in outcomes]),
        np.logical_or.reduce([each.refused for each in outcomes]),
    )


@dataclass(frozen=True)
class Batch:
    """Layouts: what their gauges see, and what a calibration run measured of it.

    Attributes
    ----------
    case : LayoutCase
        What is studied.
    torque : numpy.ndarray
        Sensitivities, shape (layouts, gauges).
    phasors : numpy.ndarray
        The wave, %FS of an ideal gauge, shape (layouts, harmonics, gauges).
    measured : numpy.ndarray
        Those that gains are solved from, shape (layouts, harmonics to cancel, gauges).
    """

    case: LayoutCase
    torque: FloatArray
    phasors: ComplexArray
    measured: ComplexArray

    @classmethod
    def drawn(cls, case: LayoutCase, generator: np.random.Generator, layouts: int) -> Batch:
        """Draw layouts.

        Parameters
        ----------
        case : LayoutCase
            What is studied.
        generator : numpy.random.Generator
            Where chance comes from.
        layouts : int
            How many.

        Returns
        -------
        Batch
            The layouts.
        """
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

    def losses(self) -> Iterator[Batch]:
        """Lose one gauge after the other.

        Yields
        ------
        Batch
            The same layouts without that gauge.
        """
        for lost in range(self.torque.shape[1]):
            kept = [j for j in range(self.torque.shape[1]) if j != lost]
            yield Batch(
                self.case, self.torque[:, kept], self.phasors[:, :, kept], self.measured[:, :, kept]
            )

    def equal(self) -> Outcome:
        """Use equal gains.

        Returns
        -------
        Outcome
            What the layouts are worth.
        """
        return self._outcome(np.ones_like(self.torque), self._left(np.ones_like(self.torque)))

    def tuned(self) -> Outcome:
        """Solve the gains of each layout.

        Returns
        -------
        Outcome
            What the layouts are worth.
        """
        gains = self._in_circuit(gains_of_layouts(self.measured))
        return self._outcome(gains, self._left(gains))

    def tuned_with_parts(self) -> tuple[Outcome, dict[str, FloatArray]]:
        """Solve the gains of each layout, and say what the residual consists of.

        Returns
        -------
        outcome : Outcome
            What the layouts are worth.
        parts : dict
            By the names of `PARTS`, each of shape (layouts,).
        """
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
        circuit = self.case.circuit
        return gains if circuit is None else circuit.nearest(gains)

    def _left(self, gains: FloatArray) -> FloatArray:
        """Amplitude left in each harmonic, % of the calibrated full scale."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            signal = np.sum(gains * self.torque, axis=1, keepdims=True)
            wave = np.matmul(self.phasors, gains[:, :, np.newaxis].astype(np.complex128))
            left: FloatArray = np.abs(wave[:, :, 0]) / np.abs(signal)
        return left

    def _outcome(self, gains: FloatArray, left: FloatArray) -> Outcome:
        noise = noise_factors(gains)
        return Outcome(
            left.sum(axis=1),
            noise,
            np.any(gains < 0, axis=1),
            # Written so that what is not a number is refused.
            ~(noise <= self.case.most_noise),
        )
