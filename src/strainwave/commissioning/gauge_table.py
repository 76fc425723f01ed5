"""Gauge channels of a table, and what the joint file and the options say of them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from strainwave.calibrate.fluctuation import equally_spaced_positions_rad
from strainwave.configuration.sensor import converter_of
from strainwave.errors import InputError
from strainwave.records.table import read_table

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.joint import Joint
    from strainwave.records.mapping import MapKeys
    from strainwave.records.table import CodesToVolts, Table

GearConfiguration = Literal["flexspline-fixed", "circular-spline-fixed"]

#: Share of rows at an end of the converter's range that is worth a warning.
SATURATED_SHARE: Final = 1e-3


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


def read_gauges(
    path: Path,
    texts: Sequence[str],
    keys: MapKeys,
    joint: Joint | None,
    *,
    required: Collection[str] = ("gauges",),
) -> Table:
    """Read mapped columns, converter codes by the joint's converter, every field filled.

    Parameters
    ----------
    path : Path
        The recording.
    texts : sequence of str
        What followed ``--map``.
    keys : MapKeys
        What may be mapped.
    joint : Joint or None
        Its ``[gauges]`` describe the converter.
    required : collection of str
        Keys that have to be mapped.

    Returns
    -------
    Table
        The columns.

    Raises
    ------
    InputError
        If something is missing, empty or no number.
    """
    has_converter = (
        joint is not None and joint.gauges is not None and joint.gauges.converter_bits is not None
    )
    table = read_table(
        path,
        texts,
        keys,
        required=required,
        codes_to_volts=_volts_by(joint) if joint is not None and has_converter else None,
    )
    table.require_complete(keys.quantities)
    if table.rows == 0:
        raise InputError(f"{path}: it has no rows; expected a recording, so check the file")
    return table


def _volts_by(joint: Joint) -> CodesToVolts:
    converter = converter_of(joint)

    def to_volts(codes: NDArray[np.float64]) -> NDArray[np.float64]:
        finite = np.isfinite(codes)
        whole = np.where(finite, codes, converter.lowest_code)
        if np.any(whole != np.round(whole)) or np.any(np.abs(whole) >= 2**31):
            raise InputError(
                "--map: a column in counts holds numbers that are no converter codes; expected "
                "whole numbers, so correct its unit"
            )
        volts = converter.to_volts(np.ascontiguousarray(whole.astype(np.int32)))
        return np.where(finite, volts, np.nan)

    return to_volts


def gauge_positions_rad(
    joint: Joint | None, gauges: int
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Positions of the gauges, from the joint file or equally spaced.

    Parameters
    ----------
    joint : Joint or None
        Its ``[gauges]`` tell the positions.
    gauges : int
        Columns that are mapped.

    Returns
    -------
    tuple
        Positions, shape (gauges,), rad; and what to say about them.

    Raises
    ------
    InputError
        If the joint file has another number of channels.
    """
    if joint is None or joint.gauges is None:
        said = (
            f"the positions of the gauges are not told and taken as equally spaced, 180/{gauges} "
            "degrees apart: phases count from there, gains do not depend on it; describe the "
            "gauges in [gauges] of --joint"
        )
        return equally_spaced_positions_rad(gauges), (said,)
    section = joint.gauges
    if section.channel_count != gauges:
        raise InputError(
            f'joint "{joint.identity.name}": [gauges] has {section.channel_count} channel(s) wired '
            f'as "{section.wiring}", and --map has {gauges} gauge column(s); expected as many, so '
            "correct one of them (gauges of one full bridge have no gains of their own)"
        )
    return np.array([rosette.position_rad for rosette in section.rosettes]), ()


def require_signals(table: Table, volts: NDArray[np.float64], key: str = "gauges") -> None:
    """Refuse gauges that say nothing at all.

    Parameters
    ----------
    table : Table
        The table, for messages.
    volts : numpy.ndarray
        Signals, shape (rows, columns).
    key : str
        What they were mapped as.

    Raises
    ------
    InputError
        If a column never changes.
    """
    for j in np.flatnonzero(np.ptp(volts, axis=0) == 0):
        raise InputError(
            f"{table.source}: {table.labels[key][j]}, number {j + 1} of {key}, has the value "
            f"{volts[0, j]:g} in every row; expected a signal that changes with the wave, so check "
            "the wiring or leave this gauge out"
        )


def saturation_warnings(volts: NDArray[np.float64], joint: Joint | None) -> tuple[str, ...]:
    """Say which gauges reach the ends of the converter's range.

    Parameters
    ----------
    volts : numpy.ndarray
        Gauge signals, shape (rows, gauges).
    joint : Joint or None
        Its ``[gauges]`` describe the converter.

    Returns
    -------
    tuple of str
        A sentence for each such gauge.
    """
    gauges = None if joint is None else joint.gauges
    if gauges is None or gauges.converter_bits is None:
        return ()
    assert gauges.converter_minimum_V is not None
    assert gauges.converter_maximum_V is not None
    step = (gauges.converter_maximum_V - gauges.converter_minimum_V) / 2.0**gauges.converter_bits
    ends = (volts <= gauges.converter_minimum_V + step / 2) | (
        volts >= gauges.converter_maximum_V - 1.5 * step
    )
    shares = ends.mean(axis=0)
    return tuple(
        f"gauge {j + 1} is at an end of the converter's range in {100 * shares[j]:.1f} % of the "
        "rows: what is cut off there looks like higher harmonics; lower the amplifier's gain and "
        "record again"
        for j in np.flatnonzero(shares > SATURATED_SHARE)
    )


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
