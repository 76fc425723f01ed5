"""What a person or the joint file tells of a gear and its gauges: factor m, sensitivities."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

import numpy as np

from strainwave.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from strainwave.joint import Joint

GearConfiguration = Literal["flexspline-fixed", "circular-spline-fixed"]


@dataclass(frozen=True)
class ToldFactor:
    """Factor m as it was told.

    Attributes
    ----------
    factor : float
        Wave turns per motor turn.
    is_told : bool
        False where nothing says anything and 1 is taken.
    ratio : float or None
        Motor turns per output turn, where it is known.
    """

    factor: float
    is_told: bool
    ratio: float | None


def told_factor(
    joint: Joint | None, ratio: Fraction | None, configuration: GearConfiguration | None
) -> ToldFactor:
    """Factor m from the options, or from ``[gear]``.

    Parameters
    ----------
    joint : Joint or None
        Its ``[gear]`` stands in for the options.
    ratio : fractions.Fraction or None
        Motor turns per output turn.
    configuration : {"flexspline-fixed", "circular-spline-fixed"} or None
        The part that is fixed.

    Returns
    -------
    ToldFactor
        m = 1 for a fixed flexspline, (R + 1)/R for a fixed circular spline: the wave turns against
        the gauges, which sit on the flexspline.

    Raises
    ------
    InputError
        If one option lacks the other.
    """
    gear = None if joint is None else joint.gear
    known = float(ratio) if ratio is not None else (None if gear is None else gear.ratio)
    if configuration is None:
        if ratio is not None and gear is None:
            raise InputError(
                f"--ratio {float(ratio):g} is given without --configuration; expected which part "
                "is fixed, since a flexspline that turns takes the gauges with it: give "
                "--configuration flexspline-fixed or circular-spline-fixed"
            )
        if gear is None:
            return ToldFactor(1.0, is_told=False, ratio=None)
        if ratio is None:
            return ToldFactor(gear.factor_m, is_told=True, ratio=gear.ratio)
        configuration = (
            "flexspline-fixed"
            if gear.configuration == "fixed_flexspline"
            else "circular-spline-fixed"
        )
    if configuration == "flexspline-fixed":
        return ToldFactor(1.0, is_told=True, ratio=known)
    if known is None:
        raise InputError(
            "--configuration circular-spline-fixed is given without --ratio; expected motor turns "
            "per output turn, because m = (R + 1)/R: give --ratio N"
        )
    exact = Fraction(known) if ratio is None else ratio
    return ToldFactor(float((exact + 1) / exact), is_told=True, ratio=known)


def parse_numbers(option: str, text: str, what: str) -> NDArray[np.float64]:
    """Read a list of numbers by commas.

    Parameters
    ----------
    option : str
        Name of the option.
    text : str
        What followed it.
    what : str
        What is expected, for the message.

    Returns
    -------
    numpy.ndarray
        The numbers.

    Raises
    ------
    InputError
        If it is no list of finite numbers.
    """
    try:
        values = np.array([float(word) for word in text.split(",")])
    except ValueError:
        values = np.array([np.nan])
    if not np.all(np.isfinite(values)):
        raise InputError(
            f"{option} {text}: expected {what}, numbers by commas such as 1,1.02,0.98; correct "
            "this value"
        )
    return values


def parse_sensitivities(
    text: str | None, joint: Joint | None, gauges: int
) -> tuple[NDArray[np.float64], bool]:
    """Torque sensitivities of the gauges: from the option, the joint file, or equal.

    Parameters
    ----------
    text : str or None
        What followed ``--torque-sensitivity``.
    joint : Joint or None
        Its ``[gains]`` may have them.
    gauges : int
        Number of gauges.

    Returns
    -------
    tuple
        t_j, shape (gauges,), and whether they were told.

    Raises
    ------
    InputError
        If their number is wrong, one is no number, or they add up to nothing.
    """
    if text is not None:
        values = parse_numbers("--torque-sensitivity", text, f"{gauges} sensitivities")
        if len(values) != gauges or not abs(values.sum()) > 1e-9 * np.abs(values).sum():
            raise InputError(
                f"--torque-sensitivity {text}: expected {gauges} numbers that do not add up to 0, "
                "one a gauge; measure them with a known load"
            )
        return values, True
    known = None if joint is None or joint.gains is None else joint.gains.torque_sensitivities
    if known is not None and len(known) == gauges:
        return np.array(known), True
    return np.ones(gauges), False
