"""Few careless gauges or many careful ones: the same study over the number of gauges."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from strainwave.design.case import FEWEST_GAUGES, MOST_GAUGES
from strainwave.design.checks import count_within, number_within, numbers_of_text
from strainwave.design.layout import study_layout
from strainwave.errors import ConfigurationError

if TYPE_CHECKING:
    from strainwave.design.case import LayoutCase
    from strainwave.design.layout import Distribution, LayoutStudy
    from strainwave.design.placement import Tolerances

#: Residuals closer than this are called the same; the wave is not known better.
_ALIKE: Final = 1.1
#: Layouts of each of the sixteen cases at most: 95th percentiles to about 1 %.
MOST_TRIALS_EACH: Final = 20_000


@dataclass(frozen=True)
class Care:
    """How carefully gauges are bonded.

    Parameters
    ----------
    position_deg : float
        Standard deviation of the position, mechanical.
    amplitude : float
        Standard deviation of the amplitudes, relative.
    """

    position_deg: float
    amplitude: float

    @classmethod
    def of_text(cls, name: str, text: str) -> Care:
        """Read "position,amplitude".

        Parameters
        ----------
        name : str
            "careless" or "careful", for the message.
        text : str
            What was given, as "5,0.15".

        Returns
        -------
        Care
            What it says.

        Raises
        ------
        InputError
            If it is not two numbers in their ranges.
        """
        allowed = "a position tolerance in degrees and an amplitude tolerance, as 5,0.15"
        numbers = numbers_of_text(name, text, allowed)
        if len(numbers) != 2:
            raise ConfigurationError(name, text, "", allowed, "write it like that")
        position_deg = number_within(f"{name}: position tolerance", numbers[0], "deg", 0.0, 90.0)
        amplitude = number_within(f"{name}: amplitude tolerance", numbers[1], "", 0.0, 1.0)
        return cls(position_deg, amplitude)

    def of(self, tolerances: Tolerances) -> Tolerances:
        """Put this care into tolerances whose others stay.

        Parameters
        ----------
        tolerances : Tolerances
            The others.

        Returns
        -------
        Tolerances
            With this position and amplitude.
        """
        return replace(tolerances, position_deg=self.position_deg, amplitude=self.amplitude)

    def __str__(self) -> str:
        return f"{self.position_deg:g} deg, {100 * self.amplitude:g} %"


#: Marked by hand: 5 degrees are 1.9 mm at a radius of 22 mm.
CARELESS: Final = Care(5.0, 0.15)
#: With a printed film under a microscope, as Taghirad & Belanger 1999 propose: 0.2 mm there.
CAREFUL: Final = Care(0.5, 0.02)


@dataclass(frozen=True)
class Comparison:
    """Studies over the number of gauges, of both kinds of care.

    Attributes
    ----------
    careless, careful : Care
        The two kinds.
    careless_studies, careful_studies : tuple of LayoutStudy
        One a number of gauges, 2 to 9; each cancels as many harmonics as it can, up to N.
    few, many : int
        Numbers of gauges of the question.
    """

    careless: Care
    careful: Care
    careless_studies: tuple[LayoutStudy, ...]
    careful_studies: tuple[LayoutStudy, ...]
    few: int
    many: int

    @property
    def question(self) -> str:
        """The question.

        Returns
        -------
        str
            With both numbers of gauges.
        """
        return f"{self.few} careless gauges or {self.many} careful ones?"

    @property
    def verdict(self) -> str:
        """The answer in a few words: who leaves less at the 95th percentile.

        Returns
        -------
        str
            With equal gains and tuned, if they differ.
        """
        few = _of(self.careless_studies, self.few)
        many = _of(self.careful_studies, self.many)
        untuned = self._winner(few.untuned, many.untuned)
        tuned = self._winner(few.tuned, many.tuned)
        if untuned == tuned:
            return f"{tuned}, tuned or not"
        return f"{tuned} if tuned, else {untuned}"

    @property
    def answers(self) -> tuple[str, str, str, str]:
        """The answer, with its numbers: residuals at the 95th percentile.

        Returns
        -------
        tuple of str
            With equal gains; tuned; the careless ones tuned and the careful ones not; and how many
            careless tuned gauges replace the careful ones with equal gains.
        """
        few = _of(self.careless_studies, self.few)
        many = _of(self.careful_studies, self.many)
        return (
            f"Equal gains: {self._against(few.untuned, many.untuned)}",
            f"Gains tuned: {self._against(few.tuned, many.tuned)}",
            f"Careless tuned, careful with equal gains: {self._against(few.tuned, many.untuned)}",
            self._replacement(many.untuned.residual_FS[95]),
        )

    def _winner(self, few: Distribution, many: Distribution) -> str:
        left_FS = (few.residual_FS[95], many.residual_FS[95])
        if max(left_FS) < _ALIKE * min(left_FS):
            return "either"
        return f"{self.few} careless" if left_FS[0] < left_FS[1] else f"{self.many} careful"

    def _against(self, few: Distribution, many: Distribution) -> str:
        left_FS = (few.residual_FS[95], many.residual_FS[95])
        ratio = max(left_FS) / max(min(left_FS), 1e-30)
        winner = self._winner(few, many)
        verdict = (
            "about the same" if winner == "either" else f"{winner} leave {ratio:.2g} times less"
        )
        return f"{left_FS[0]:.2g} against {left_FS[1]:.2g} %FS, {verdict}"

    def _replacement(self, left_FS: float) -> str:
        for study in self.careless_studies:
            reached_FS = study.tuned.residual_FS[95]
            if reached_FS <= left_FS:
                return (
                    f"{study.case.gauges} careless ones, tuned, do what {self.many} careful ones "
                    f"do with equal gains ({reached_FS:.2g} against {left_FS:.2g} %FS)"
                )
        return (
            f"No number of careless ones, tuned, does what {self.many} careful ones do with equal "
            f"gains ({left_FS:.2g} %FS)"
        )


def compare_gauge_counts(
    case: LayoutCase,
    limit_FS: float,
    *,
    careless: Care = CARELESS,
    careful: Care = CAREFUL,
    many: int = 8,
    trials: int = MOST_TRIALS_EACH,
    seed: int = 1,
) -> Comparison:
    """Study 2 to 9 gauges, bonded carelessly and carefully.

    Parameters
    ----------
    case : LayoutCase
        Everything but the number of gauges and how carefully they are placed; its number of gauges
        is that of the careless ones in the question.
    limit_FS : float
        Limit of the residual.
    careless, careful : Care
        Tolerances of both.
    many : int
        Careful gauges in the question, 2 to 9.
    trials : int
        Layouts of each case; at most `MOST_TRIALS_EACH` are drawn.
    seed : int
        Seed of everything random.

    Returns
    -------
    Comparison
        All studies.

    Raises
    ------
    InputError
        If a value cannot be used.
    """
    many = count_within("careful_gauges", many, FEWEST_GAUGES, MOST_GAUGES)
    studies = []
    for care in (careless, careful):
        tolerances = care.of(case.tolerances)
        studies.append(
            tuple(
                study_layout(
                    replace(
                        case,
                        gauges=gauges,
                        harmonics=_harmonics(gauges, case.harmonics),
                        tolerances=tolerances,
                        lost_gauge=False,
                    ),
                    limit_FS,
                    min(trials, MOST_TRIALS_EACH),
                    seed,
                )
                for gauges in range(FEWEST_GAUGES, MOST_GAUGES + 1)
            )
        )
    return Comparison(careless, careful, studies[0], studies[1], case.gauges, many)


def _harmonics(gauges: int, most: int) -> int:
    return max(1, min(most, (gauges - 1) // 2))


def _of(studies: tuple[LayoutStudy, ...], gauges: int) -> LayoutStudy:
    return next(study for study in studies if study.case.gauges == gauges)
