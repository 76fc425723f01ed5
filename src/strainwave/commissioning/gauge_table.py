"""Gauge channels of a table, and what the joint file and the options say of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

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

#: Share of rows at an end of the converter's range that is worth a warning.
SATURATED_SHARE: Final = 1e-3


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
