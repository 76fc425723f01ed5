"""The column of a reference torque sensor: how it is named, and its rows beside the recording's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from strainwave.errors import InputError
from strainwave.records.conversion import LARGEST_USABLE
from strainwave.records.mapping import LOG_KEYS, MapKeys, gauge_by_gauge, parse_columns
from strainwave.records.table import read_columns

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from strainwave.records.layout import Layout
    from strainwave.records.mapping import MappedColumn
    from strainwave.records.raw import Recording

REFERENCE: Final = "reference-torque"
"""The key of a reference sensor's column."""

_KEYS: Final = MapKeys({**LOG_KEYS.quantities, REFERENCE: "torque"}, lists=LOG_KEYS.lists)
_EXAMPLE: Final = "--reference tau_ref:Nm"


def parse_with_reference(
    texts: Sequence[str], reference: str | None
) -> tuple[dict[str, MappedColumn], MappedColumn | None]:
    """Read ``--map``, which may map ``reference-torque`` as well, and ``--reference``.

    Parameters
    ----------
    texts : sequence of str
        What followed ``--map``.
    reference : str or None
        What followed ``--reference``: ``column[:unit]``, with a minus before a column that counts
        against the torque.

    Returns
    -------
    tuple
        Columns by key, without the reference, and the reference's or None.

    Raises
    ------
    InputError
        If something cannot be read, or the reference is given twice.
    """
    mapping = gauge_by_gauge(parse_columns(texts, _KEYS))
    mapped = mapping.pop(REFERENCE, None)
    if reference is None:
        return mapping, mapped
    if mapped is not None:
        raise InputError(
            f"--reference {reference}: {REFERENCE} is mapped by --map as well; expected one column "
            "of the reference sensor, so remove one of the two"
        )
    text = f"{REFERENCE}={reference}"
    try:
        found = parse_columns([text], _KEYS)
    except InputError as error:
        reason = str(error).removeprefix(f"--map {text}: ")
        raise InputError(f"--reference {reference}: {reason}") from error
    if len(found) > 1:
        raise InputError(
            f"--reference {reference}: it names more than one column; expected one, such as "
            f"{_EXAMPLE}, so name the others with --map"
        )
    return mapping, found[REFERENCE][0]


def read_reference_Nm(
    recording: Recording, layout: Layout, column: MappedColumn, rows: int
) -> NDArray[np.float64]:
    """Read the reference's torque in the first rows.

    Parameters
    ----------
    recording : Recording
        The recording.
    layout : Layout
        How it is read.
    column : MappedColumn
        The reference's column.
    rows : int
        How many rows are wanted.

    Returns
    -------
    numpy.ndarray
        Torque, shape (rows,), Nm; NaN where there is none.

    Raises
    ------
    InputError
        If there is no such column, it holds no numbers, or it is that of another signal.
    """
    # Read along with the torque, so that nobody compares a column with itself.
    columns: dict[str, tuple[MappedColumn, ...]] = {}
    if "torque" in layout.columns:
        columns["torque"] = (layout.columns["torque"],)
    columns[REFERENCE] = (column,)
    table = read_columns(recording, columns, _KEYS)
    torque_Nm = table.values[REFERENCE][:rows]
    usable = np.abs(torque_Nm) <= LARGEST_USABLE
    if not usable.any():
        raise InputError(
            f"{recording.source}: {table.labels[REFERENCE][0]} for {REFERENCE} holds no number in "
            f"the first {rows} rows; expected the torque of a reference sensor, so name another "
            "column"
        )
    return np.where(usable, torque_Nm, np.nan)
