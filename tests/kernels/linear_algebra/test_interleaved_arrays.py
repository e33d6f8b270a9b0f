"""Interleaved arrays, parts of arrays, and what goes through an array by pairs, for even and odd numbers."""

import ctypes

import numpy as np
import pytest
from numba import njit, types

from kernels.interleaved import interleaved
from tetherfmu.kernels.arrays import copy, nodes_end
from tetherfmu.kernels.compilation import entry_point
from tetherfmu.kernels.flat_arrays import every_second, flat, part
from tetherfmu.kernels.linear_algebra.both_ends import deinterleave, next_interleaved
from tetherfmu.kernels.linear_algebra.pairs import first, pair, second
from tetherfmu.kernels.step.transaction import check_state
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK, STATE_NOT_FINITE

every_length = pytest.mark.parametrize("n", range(1, 8))


@njit
def vectors_of_next(n, k, array):
    vectors = next_interleaved(n, k, array)
    return first(vectors), second(vectors)


@njit
def max_of_pairs(a, b):
    found = max(pair(a[0], a[1]), pair(b[0], b[1]))
    return first(found), second(found)


@njit
def max_of_numbers(a, b):
    return max(a[0], b[0]), max(a[1], b[1])


@njit
def fill(array, start, size):
    part(array, start, size)[:] = 1.0
    return len(part(array, start, size))


def numbered(n):
    """Vectors of n + 1 nodes, all numbers different."""
    return np.arange(3.0 * (n + 1)) + 1.0


@every_length
def test_vectors_of_mirror_images_stand_beside_each_other(n):
    array, nodes = interleaved(numbered(n)).reshape(-1, 3, 2), numbered(n).reshape(-1, 3)
    np.testing.assert_array_equal(array[..., 0], nodes[: n // 2 + 1])
    np.testing.assert_array_equal(array[..., 1], nodes[::-1][: n // 2 + 1])


@every_length
def test_deinterleaved_is_what_was_interleaved(n):
    found = np.zeros(3 * (n + 1))
    deinterleave(n, interleaved(numbered(n)), found)
    np.testing.assert_array_equal(found, numbered(n))


@every_length
def test_the_next_vectors_towards_the_middle_and_one_beyond(n):
    nodes = numbered(n).reshape(-1, 3)
    for k in range((n + 1) // 2):
        np.testing.assert_array_equal(vectors_of_next(n, k, interleaved(numbered(n))), (nodes[k + 1], nodes[n - k - 1]))


@pytest.mark.parametrize("function", [max_of_pairs, max_of_numbers])
def test_max_takes_the_first_number_beside_a_nan(function):
    """As `max` of Python, in pairs and of numbers."""
    for a, b in (((1.0, -2.0), (0.5, 3.0)), ((np.nan, np.inf), (0.5, 3.0)), ((0.5, 3.0), (np.nan, np.inf))):
        np.testing.assert_array_equal(function(a, b), tuple(map(max, a, b)))


def test_a_part_is_a_view():
    array = np.zeros(9)
    assert fill(array, 2, 3) == 3
    np.testing.assert_array_equal(array, [0, 0, 1, 1, 1, 0, 0, 0, 0])


@pytest.mark.parametrize("size", [0, 1, 2, 3, 88, 89])
def test_all_of_an_array_is_copied(size):
    source, destination = np.arange(size) + 1.0, np.zeros(size)
    copy(source, destination)
    np.testing.assert_array_equal(destination, source)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@every_length
def test_a_state_is_finite_or_not_at_any_place(bad, n):
    state = np.resize([1e308, -1e308, 5e-324], at.state_size(n))
    assert check_state(n, state) == OK
    for place in range(nodes_end(n)):
        wrong = state.copy()
        wrong[place] = bad
        assert check_state(n, wrong) == STATE_NOT_FINITE


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
