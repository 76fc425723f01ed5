"""Columns of converter codes as voltages, by the converter of a joint file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.configuration import converter_of
from strainwave.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from strainwave.joint import Joint
    from strainwave.records.table import CodesToVolts


def codes_to_volts(joint: Joint, source: Path) -> CodesToVolts | None:
    """Build what turns converter codes into volts.

    Parameters
    ----------
    joint : Joint
        The joint.
    source : Path
        The table, for messages.

    Returns
    -------
    callable or None
        For `strainwave.records.table.read_table`; None where the joint has no converter.
    """
    if joint.gauges is None or joint.gauges.converter_bits is None:
        return None
    converter = converter_of(joint)

    def convert(codes: NDArray[np.float64]) -> NDArray[np.float64]:
        known = np.isfinite(codes)
        whole = np.where(known, np.rint(codes), 0.0)
        usable = known & (whole == codes) & (np.abs(codes) < 2**31)
        if not np.all(usable | ~known):
            row = int(np.argmax(~usable & known)) + 1
            raise InputError(
                f"{source}: row {row} has {codes[row - 1]:g} where counts are mapped; expected a whole "
                "number, a code of the converter, so correct it or name the column's unit"
            )
        volts = np.asarray(converter.to_volts(whole.astype(np.int32)))
        return np.where(known, volts, np.nan)

    return convert
