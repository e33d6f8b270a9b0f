"""Flat arrays, as entry points make them of pointers."""

import ctypes

import numpy as np
from numba import types

from tetherfmu.kernels.compilation import entry_point
from tetherfmu.kernels.flat_arrays import every_second, flat, part


def change(pointer, size):
    array = flat(pointer, size)
    inner, odd = part(array, 2, 3), every_second(array, 1, 3)
    inner[0] += 10.0 * len(inner)
    odd[2] = 100.0 * len(odd)
    return inner[1] + odd[1] + len(array)


def test_reads_and_writes_go_to_the_places_of_the_whole():
    numbers = np.arange(8.0)
    code = entry_point(types.float64(types.CPointer(types.float64), types.int64), change)
    called = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_void_p, ctypes.c_int64)(code.address)
    assert called(numbers.ctypes.data, len(numbers)) == 3.0 + 3.0 + 8.0
    np.testing.assert_array_equal(numbers, [0.0, 1.0, 2.0 + 30.0, 3.0, 4.0, 300.0, 6.0, 7.0])
