"""Arrays from callers, in the form the core takes: one axis, contiguous, one precision."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from strainwave.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from _typeshed import DataclassInstance
    from numpy.typing import ArrayLike, DTypeLike, NDArray

Number = TypeVar("Number", bound=np.generic)


def contiguous(
    name: str, values: ArrayLike, dtype: type[Number], *, dimensions: int = 1
) -> NDArray[Number]:
    """Contiguous array of a precision; the caller's own memory where it has that form already.

    Parameters
    ----------
    name : str
        Name of the parameter, for the error.
    values : array_like
        Numbers.
    dtype : type
        Precision of the result.
    dimensions : int
        How many axes the array must have.

    Returns
    -------
    numpy.ndarray
        The values, not copied unless their type or layout differs.

    Raises
    ------
    InputError
        If the values are no numbers, are masked or have another number of axes.
    """
    axes = f"{dimensions} {'axis' if dimensions == 1 else 'axes'}"
    if _has_masked_entries(values):
        raise InputError(
            f"{name} has masked entries: expected an array of numbers without a mask; fill them "
            "(numpy.ma.filled) or leave them out (numpy.ma.compressed)"
        )
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise InputError(
            f"{name} has rows of different lengths: expected an array of numbers with {axes}; "
            "make the rows equally long"
        ) from error
    if array.dtype.kind not in "fiub":
        raise InputError(
            f"{name} holds {array.dtype} values: expected real numbers; convert them first"
        )
    if array.ndim != dimensions:
        raise InputError(f"{name} has the shape {array.shape}: expected {axes}; reshape the array")
    if np.dtype(dtype).kind in "iu":
        _require_whole(name, array, dtype)
    # What float32 cannot hold becomes infinite, which the sample path rejects and counts.
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array, dtype=dtype)


def optional_contiguous(
    name: str, values: ArrayLike | None, dtype: type[Number]
) -> NDArray[Number] | None:
    """Do what `contiguous` does, and pass None on.

    Parameters
    ----------
    name : str
        Name of the parameter, for the error.
    values : array_like or None
        Numbers.
    dtype : type
        Precision of the result.

    Returns
    -------
    numpy.ndarray or None
        The values.
    """
    return None if values is None else contiguous(name, values, dtype)


def steps(values: NDArray[np.float64], before: float) -> NDArray[np.float64]:
    """Differences from one value to the next, chunk after chunk.

    Parameters
    ----------
    values : numpy.ndarray
        Values, shape (rows,).
    before : float
        The last value of the chunk before; NaN where there is none.

    Returns
    -------
    numpy.ndarray
        Each value less the one before it, shape (rows,).
    """
    found = np.empty_like(values)
    found[:1] = values[:1] - before
    np.subtract(values[1:], values[:-1], out=found[1:])
    return found


def arrays_of(
    out: DataclassInstance | None,
    rows: int,
    dtype: type[np.generic],
    inputs: Iterable[NDArray[Any] | None],
) -> tuple[NDArray[Any], ...] | None:
    """Arrays of an earlier result, to be filled again.

    Parameters
    ----------
    out : dataclass or None
        A result whose fields are arrays; None where new ones are wanted.
    rows : int
        How many elements each must have.
    dtype : type
        Precision of its numbers; what holds whole numbers keeps its own type.
    inputs : iterable of numpy.ndarray or None
        What the results are computed from.

    Returns
    -------
    tuple of numpy.ndarray or None
        Its arrays, in the order of the fields.

    Raises
    ------
    InputError
        If an array cannot take the results as they are, or shares memory with another one.
    """
    if out is None:
        return None
    wanted = {"status": np.dtype(np.uint32), "left_out_gauge": np.dtype(np.uint8)}
    found: list[NDArray[Any]] = []
    others = [array for array in inputs if array is not None]
    for field in fields(out):
        name, array = f"out.{field.name}", getattr(out, field.name)
        kind = wanted.get(field.name, np.dtype(dtype))
        fits = isinstance(array, np.ndarray) and (array.shape, array.dtype) == ((rows,), kind)
        if not (fits and array.flags.c_contiguous and array.flags.writeable):
            raise InputError(
                f"{name} cannot take the results: expected a contiguous, writable array of {kind} "
                f"with the shape ({rows},); give the result of a call with as many samples"
            )
        # By the ends of their memory, which is quick: views that only interleave are refused, too.
        if any(np.may_share_memory(array, other) for other in (*others, *found)):
            raise InputError(
                f"{name} shares memory with another array of the call: expected memory of its own; "
                "give a copy"
            )
        found.append(array)
    return tuple(found)


def precision(dtype: DTypeLike) -> type[np.float64] | type[np.float32]:
    """Precision of the core that a dtype names.

    Parameters
    ----------
    dtype : dtype_like
        float64 or float32.

    Returns
    -------
    type
        numpy.float64 or numpy.float32.

    Raises
    ------
    InputError
        If it is neither.
    """
    try:
        named: np.dtype[Any] | None = np.dtype(dtype)
    except TypeError:
        named = None
    if named == np.float64:
        return np.float64
    if named == np.float32:
        return np.float32
    raise InputError(f"dtype = {dtype!r}: expected float64 or float32; choose one of them")


def _has_masked_entries(values: object) -> bool:
    if isinstance(values, np.ma.MaskedArray):
        return bool(np.ma.is_masked(values))
    # numpy drops the masks of a list's rows, too.
    return isinstance(values, list | tuple) and any(map(_has_masked_entries, values))


def _require_whole(name: str, array: NDArray[Any], dtype: type[np.generic]) -> None:
    if array.dtype.kind == "f" and not np.all(np.isfinite(array) & (array == np.floor(array))):
        raise InputError(
            f"{name} holds values that are no whole numbers: expected whole numbers; round them"
        )
    limits = np.iinfo(np.dtype(dtype))
    if array.size and (array.min() < limits.min or array.max() > limits.max):
        raise InputError(
            f"{name} reaches from {array.min()} to {array.max()}: expected {limits.min} to "
            f"{limits.max}; check where they come from"
        )
