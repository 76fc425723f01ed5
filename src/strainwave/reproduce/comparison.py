"""A published number beside ours: how ours came about, and the band within which it agrees."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

#: How our number came about.
Kind = Literal["found", "matched", "recovered", "computed"]
#: What each kind means, from the strongest evidence to the weakest.
KINDS: Final[Mapping[Kind, str]] = {
    "found": "comes out of the simulation; nothing was chosen for it",
    "matched": "the station was chosen so that it comes out",
    "recovered": "an input of the simulation, read back through the signal path",
    "computed": "not printed in the paper; follows from what it prints",
}


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One number of a paper and the one found here.

    Attributes
    ----------
    source : str
        Where the paper gives it: ``"T Table I"``, ``"G fig. 6"``.
    quantity : str
        What it is.
    published : str
        What the paper has, with its unit: ``"6.60 Nm/V"``, ``"about ±4 %FS"``.
    ours : float
        What was found here.
    unit : str
        Unit of ours and of the band.
    decimals : int
        Decimals of ours that are worth printing.
    lowest, highest : float
        Band within which ours agrees; both ends can be missed.
    band : str
        Why the band is as wide as it is.
    kind : {"found", "matched", "recovered", "computed"}
        How ours came about, see `KINDS`.
    """

    source: str
    quantity: str
    published: str
    ours: float
    unit: str
    decimals: int
    lowest: float
    highest: float
    band: str
    kind: Kind

    @property
    def agrees(self) -> bool:
        """Whether our number lies within the band."""
        return bool(self.lowest <= self.ours <= self.highest)

    @property
    def verdict(self) -> str:
        """The same in words."""
        return "agrees" if self.agrees else "MISSED"

    @property
    def ours_text(self) -> str:
        """Our number with its unit, for a reader."""
        return _with_unit(self._text(self.ours), self.unit)

    @property
    def accepted_text(self) -> str:
        """The band with its unit, for a reader."""
        if self.lowest == self.highest:
            return _with_unit(f"exactly {self._text(self.lowest)}", self.unit)
        return _with_unit(f"{self._text(self.lowest)} to {self._text(self.highest)}", self.unit)

    def as_dict(self) -> dict[str, str | float | bool]:
        """Give the comparison as plain values.

        Returns
        -------
        dict
            Fields by name, and ``agrees``.
        """
        return {
            "source": self.source,
            "quantity": self.quantity,
            "published": self.published,
            "ours": self.ours,
            "unit": self.unit,
            "lowest": self.lowest,
            "highest": self.highest,
            "band": self.band,
            "kind": self.kind,
            "agrees": self.agrees,
        }

    def _text(self, value: float) -> str:
        return f"{value:.{self.decimals}f}".replace("-", "\N{MINUS SIGN}")


def _with_unit(text: str, unit: str) -> str:
    return text + ("" if unit in ("", "°") else " ") + unit


def within(
    source: str,
    quantity: str,
    published: str,
    ours: float,
    *,
    unit: str,
    decimals: int,
    expected: float,
    tolerance: float,
    band: str,
    kind: Kind,
) -> Comparison:
    """Compare with a band of a relative tolerance about a published value.

    Parameters
    ----------
    source, quantity, published : str
        See `Comparison`.
    ours : float
        What was found here.
    unit : str
        Unit of ours and of the band.
    decimals : int
        Decimals worth printing.
    expected : float
        The published value as a number.
    tolerance : float
        Half width of the band, relative to the published value.
    band : str
        Why the band is as wide as it is.
    kind : {"found", "matched", "recovered", "computed"}
        How ours came about.

    Returns
    -------
    Comparison
        The comparison.
    """
    reach = abs(expected) * tolerance
    return Comparison(
        source=source,
        quantity=quantity,
        published=published,
        ours=float(ours),
        unit=unit,
        decimals=decimals,
        lowest=float(expected - reach),
        highest=float(expected + reach),
        band=band,
        kind=kind,
    )


@dataclass(frozen=True)
class Tally:
    """How many comparisons there are of a kind, and how many agree.

    Attributes
    ----------
    kind : {"found", "matched", "recovered", "computed"}
        The kind.
    compared, agree : int
        Number of comparisons, and of those within their band.
    """

    kind: Kind
    compared: int
    agree: int


def tallies(comparisons: Iterable[Comparison]) -> tuple[Tally, ...]:
    """Count comparisons by kind.

    Parameters
    ----------
    comparisons : iterable of Comparison
        The comparisons.

    Returns
    -------
    tuple of Tally
        One a kind, in the order of `KINDS`; kinds that do not occur count 0.
    """
    entries = tuple(comparisons)
    compared = Counter(entry.kind for entry in entries)
    agree = Counter(entry.kind for entry in entries if entry.agrees)
    return tuple(Tally(kind, compared[kind], agree[kind]) for kind in KINDS)


def tally_sentence(comparisons: Iterable[Comparison]) -> str:
    """Say how many comparisons there are of each kind.

    Parameters
    ----------
    comparisons : iterable of Comparison
        The comparisons.

    Returns
    -------
    str
        ``"1 found, 14 matched, ..."``; of a kind with a miss, ``"13 of 14 matched"``.
    """
    return ", ".join(
        f"{tally.compared} {tally.kind}"
        if tally.agree == tally.compared
        else f"{tally.agree} of {tally.compared} {tally.kind}"
        for tally in tallies(comparisons)
    )
