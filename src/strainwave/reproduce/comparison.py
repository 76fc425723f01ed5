"""A published number beside ours, with the band within which it counts as reproduced."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

#: How our number came about: run on a simulated station, or computed from the paper's own data.
Origin = Literal["simulated", "computed"]


@dataclass(frozen=True)
class Comparison:
    """One number of a paper and the one found here.

    Attributes
    ----------
    source : str
        Where the paper gives it: ``"T Table I"``, ``"G fig. 6"``.
    quantity : str
        What it is.
    published : str
        The paper's own words for it: ``"6.60"``, ``"about +-4"``.
    ours : float
        What was found here.
    unit : str
        Unit of both.
    lowest, highest : float
        Band within which ours counts as reproduced; both ends can be missed.
    origin : {"simulated", "computed"}
        How ours came about.
    """

    source: str
    quantity: str
    published: str
    ours: float
    unit: str
    lowest: float
    highest: float
    origin: Origin

    @property
    def reproduced(self) -> bool:
        """Whether our number lies within the band."""
        return self.lowest <= self.ours <= self.highest

    def as_dict(self) -> dict[str, str | float | bool]:
        """Give the comparison as plain values.

        Returns
        -------
        dict
            Fields by name, and ``reproduced``.
        """
        return {
            "source": self.source,
            "quantity": self.quantity,
            "published": self.published,
            "ours": self.ours,
            "unit": self.unit,
            "lowest": self.lowest,
            "highest": self.highest,
            "origin": self.origin,
            "reproduced": self.reproduced,
        }


def within(
    source: str,
    quantity: str,
    published: str,
    ours: float,
    *,
    unit: str,
    expected: float,
    tolerance: float,
    origin: Origin = "simulated",
) -> Comparison:
    """Compare with a band of a relative tolerance about a published value.

    Parameters
    ----------
    source, quantity, published : str
        See `Comparison`.
    ours : float
        What was found here.
    unit : str
        Unit of both.
    expected : float
        The published value as a number.
    tolerance : float
        Half width of the band, relative to the published value.
    origin : {"simulated", "computed"}
        How ours came about.

    Returns
    -------
    Comparison
        The comparison.
    """
    reach = abs(expected) * tolerance
    return Comparison(
        source, quantity, published, float(ours), unit, expected - reach, expected + reach, origin
    )
