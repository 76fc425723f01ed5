"""Between Arrow's arrays and numpy's, without copies.

Arrow's own ways there and back import pandas wherever it is installed, which takes longer than
reading a million rows. Its functions are named as methods of arrays, which load them when first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

if TYPE_CHECKING:
    from numpy.typing import NDArray


def from_arrow(array: pa.Array, missing: float) -> NDArray[Any]:
    """Take numbers out of Arrow.

    Parameters
    ----------
    array : pyarrow.Array
        Numbers.
    missing : float
        What stands for those that are not there.

    Returns
    -------
    numpy.ndarray
        The same memory, read-only, where all are there.
    """
    filled = array if array.null_count == 0 else array.fill_null(missing)
    found: NDArray[Any] = np.from_dlpack(filled)
    return found


def missing_in(array: pa.Array) -> NDArray[np.bool_]:
    """Say which values are not there.

    Parameters
    ----------
    array : pyarrow.Array
        Values of any kind.

    Returns
    -------
    numpy.ndarray
        True where there is none, shape (values,).
    """
    if array.null_count == 0:
        return np.zeros(len(array), np.bool_)
    # Arrow keeps truths as bits, numpy as bytes.
    return from_arrow(array.is_null().cast(pa.uint8()), 0).view(np.bool_)


def to_arrow(kind: pa.DataType, values: NDArray[Any], *, gaps: bool = False) -> pa.Array:
    """Lend an array's memory to Arrow.

    Parameters
    ----------
    kind : pyarrow.DataType
        The array's own type.
    values : numpy.ndarray
        Numbers, shape (values,).
    gaps : bool
        What is not a number is not there.

    Returns
    -------
    pyarrow.Array
        The same memory where it is contiguous.
    """
    validity = None
    if gaps and values.dtype.kind == "f":
        validity = pa.py_buffer(np.packbits(~np.isnan(values), bitorder="little"))
    memory = pa.py_buffer(np.ascontiguousarray(values))
    return pa.Array.from_buffers(kind, len(values), [validity, memory])
