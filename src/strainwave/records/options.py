"""What a person asks for beside a recording, and the numbers in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Final, Literal

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from strainwave.records.mapping import MappedColumn

AngleSide = Literal["motor", "output"]
LARGEST_RATIO: Final = 1_000_000


@dataclass(frozen=True)
class Options:
    """What was asked for beside the recording; None and missing keys leave it to the joint file.

    Attributes
    ----------
    mapping : mapping
        Columns by key, see `strainwave.records.mapping.parse_mapping`.
    angle_side : {"motor", "output"} or None
        The side that angle and speed were measured on.
    ratio : Fraction or None
        Motor turns per output turn.
    rated_torque_Nm : float or None
        Full scale, Nm.
    rate_Hz : float or None
        Rate of the rows where there is no column of time, Hz.
    absolute_angle : bool
        The motor's angle counts from where the output is at 0.
    """

    mapping: Mapping[str, MappedColumn] = field(default_factory=dict)
    angle_side: AngleSide | None = None
    ratio: Fraction | None = None
    rated_torque_Nm: float | None = None
    rate_Hz: float | None = None
    absolute_angle: bool = False


def parse_ratio(text: str) -> Fraction:
    """Read the ratio of a gear exactly as it is written.

    Parameters
    ----------
    text : str
        ``"160"``, ``"120.5"`` or ``"241/2"``.

    Returns
    -------
    Fraction
        The ratio.

    Raises
    ------
    InputError
        If it is no number from 1 to 1e6.
    """
    try:
        ratio = Fraction(text.strip())
    except (ValueError, ZeroDivisionError):
        ratio = Fraction(0)
    if not 1 <= ratio <= LARGEST_RATIO:
        raise InputError(
            f"--ratio {text}: expected motor turns per output turn, a number from 1 to 1e6 such as "
            "160 or 120.5 (its sign does not matter); correct this value"
        )
    return ratio


def check_options(options: Options) -> None:
    """Make sure that the numbers are in range.

    Parameters
    ----------
    options : Options
        What was asked for.

    Raises
    ------
    InputError
        If one is not.
    """
    _check_positive("--rated-torque", options.rated_torque_Nm, "a rated torque in Nm", 1e9)
    _check_positive("--rate", options.rate_Hz, "rows a second, in Hz", 1e9)


def _check_positive(option: str, value: float | None, what: str, largest: float) -> None:
    if value is not None and not (math.isfinite(value) and 0.0 < value <= largest):
        raise InputError(
            f"{option} {value:g}: expected {what}, a number above 0 and up to {largest:g}; correct "
            "this value"
        )
