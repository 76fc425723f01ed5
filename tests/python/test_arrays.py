"""Arrays from callers: what is taken as it is, what is converted, what is refused."""

import numpy as np
import pytest

from strainwave.arrays import contiguous, optional_contiguous, precision
from strainwave.errors import InputError


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int32, np.uint32])
def test_fitting_arrays_are_the_callers_own_memory(dtype):
    array = np.arange(10).astype(dtype)
    assert contiguous("a", array, dtype) is array
    part = array[2:7]
    assert np.shares_memory(contiguous("a", part, dtype), array)
    array.flags.writeable = False
    assert contiguous("a", array, dtype) is array


def test_other_layouts_and_types_are_converted():
    every_second = np.arange(10.0)[::2]
    made = contiguous("a", every_second, np.float64)
    assert made.flags.c_contiguous
    np.testing.assert_array_equal(made, every_second)
    swapped = np.arange(3.0).astype(">f8")
    np.testing.assert_array_equal(contiguous("a", swapped, np.float64), [0, 1, 2])
    np.testing.assert_array_equal(contiguous("a", [1, 2], np.float32), [1, 2])
    np.testing.assert_array_equal(contiguous("a", [True, False], np.float64), [1, 0])
    np.testing.assert_array_equal(contiguous("a", [3.0, -4.0], np.int32), [3, -4])
    fortran = np.asfortranarray(np.arange(6).reshape(2, 3))
    made = contiguous("a", fortran, np.int32, dimensions=2)
    assert made.flags.c_contiguous
    np.testing.assert_array_equal(made, fortran)
    assert contiguous("a", [], np.float64).shape == (0,)


@pytest.mark.parametrize(
    ("values", "dtype", "dimensions", "words"),
    [
        ([[1.0, 2.0]], np.float64, 1, "torque_Nm has the shape (1, 2): expected 1 axis"),
        (1.0, np.float64, 1, "torque_Nm has the shape (): expected 1 axis"),
        ([1, 2], np.int32, 2, "torque_Nm has the shape (2,): expected 2 axes"),
        ([[1], [1, 2]], np.float64, 2, "torque_Nm has rows of different lengths"),
        (["a"], np.float64, 1, "torque_Nm holds <U1 values: expected real numbers"),
        ([1j], np.float64, 1, "torque_Nm holds complex128 values"),
        ([None], np.float64, 1, "torque_Nm holds object values"),
        (np.array(["2020"], "M8[Y]"), np.float64, 1, "torque_Nm holds datetime64[Y] values"),
        ([0.5], np.int32, 1, "torque_Nm holds values that are no whole numbers"),
        ([np.nan], np.int32, 1, "torque_Nm holds values that are no whole numbers"),
        ([2**31], np.int32, 1, "torque_Nm reaches from 2147483648 to 2147483648"),
        ([-1], np.uint32, 1, "torque_Nm reaches from -1 to -1"),
    ],
)
def test_refusals_are_one_sentence(values, dtype, dimensions, words):
    with pytest.raises(InputError) as caught:
        contiguous("torque_Nm", values, dtype, dimensions=dimensions)
    assert str(caught.value).startswith(words)
    assert "expected" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_single_precision_cannot_hold_is_infinite_without_a_warning():
    """The sample path flags infinities; a warning of numpy's would name no array of the caller's."""
    made = contiguous("torque_Nm", [1e39, -1e300, 1.0], np.float32)
    np.testing.assert_array_equal(made, [np.inf, -np.inf, 1.0])


def test_masked_entries_are_not_lost():
    masked = np.ma.array([1.0, 2.0], mask=[False, True])
    for values in (masked, [masked, masked], ([1.0, np.ma.masked],)):
        with pytest.raises(InputError, match="torque_Nm has masked entries: expected") as caught:
            contiguous("torque_Nm", values, np.float64)
        assert "\n" not in str(caught.value)
    for mask in (np.ma.nomask, [False, False]):
        unmasked = np.ma.array([1.0, 2.0], mask=mask)
        np.testing.assert_array_equal(contiguous("a", unmasked, np.float64), [1, 2])


def test_optional():
    assert optional_contiguous("a", None, np.float64) is None
    array = np.zeros(3)
    assert optional_contiguous("a", array, np.float64) is array


def test_precision():
    for name in ("float32", np.float32, np.dtype("f4"), "f4"):
        assert precision(name) is np.float32
    for name in ("float64", float, np.float64, "d", None):  # None: numpy's own default
        assert precision(name) is np.float64
    for name in (np.int32, "float16", "nonsense", 3):
        with pytest.raises(InputError, match="expected float64 or float32"):
            precision(name)
