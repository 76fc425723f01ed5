"""Columns of converter codes as voltages, by the converter of a joint file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strainwave.configuration import converter_of

if TYPE_CHECKING:
    from strainwave.joint import Joint
    from strainwave.records.table import CodesToVolts


def codes_to_volts(joint: Joint) -> CodesToVolts | None:
    """Build what turns converter codes into volts.

    Parameters
    ----------
    joint : Joint
        The joint.

    Returns
    -------
    callable or None
        For `strainwave.records.table.read_table`; None where the joint has no converter.
    """
    if joint.gauges is None or joint.gauges.converter_bits is None:
        return None
    converter = converter_of(joint)
    lowest = converter.lowest_code
    lowest_V = float(np.asarray(converter.to_volts([lowest]))[0])
    # Not to_volts: readings may be means of codes.
    return lambda codes: lowest_V + (codes - lowest) * converter.step_V
