"""Three-vectors and 3x3 matrices as tuples of numbers: they live in registers, so nothing is allocated."""

from math import sqrt

import numpy as np

from tetherfmu.kernels.compilation import kernel

from .pairs import first, load_pair, pair, second, store_pair, unzip

ONE, TWO, THREE = np.uint64(1), np.uint64(2), np.uint64(3)


@kernel
def get(array, index):
    """Three-vector number `index` of a flat array."""
    k = np.uint64(3 * index)  # unsigned: numba then leaves out the look at negative places
    return array[k], array[k + ONE], array[k + TWO]


@kernel
def put(array, index, a):
    """Write three-vector number `index` of a flat array (modified)."""
    k = np.uint64(3 * index)
    array[k] = a[0]
    array[k + ONE] = a[1]
    array[k + TWO] = a[2]


@kernel
def vector_at(array, first):
    """Three-vector from place `first` of a flat array."""
    return array[first], array[first + 1], array[first + 2]


@kernel
def put_at(array, first, a):
    """Write a three-vector to place `first` of a flat array (modified)."""
    array[first] = a[0]
    array[first + 1] = a[1]
    array[first + 2] = a[2]


@kernel
def get_two(array, i, j):
    """Three-vectors number i and j of a flat array, as pairs."""
    p = np.uint64(3 * i)
    q = np.uint64(3 * j)
    x, y = unzip(load_pair(array, p), load_pair(array, q))
    return x, y, pair(array[p + TWO], array[q + TWO])


@kernel
def put_two(array, i, j, a):
    """Write a vector of pairs to the three-vectors number i and j of a flat array (modified)."""
    p = np.uint64(3 * i)
    q = np.uint64(3 * j)
    at_i, at_j = unzip(a[0], a[1])
    store_pair(array, p, at_i)
    store_pair(array, q, at_j)
    array[p + TWO] = first(a[2])
    array[q + TWO] = second(a[2])


@kernel
def get_vector_of_pairs(array, first):
    """Three-vector of pairs from place `first` of a flat array."""
    k = np.uint64(first)
    return load_pair(array, k), load_pair(array, k + TWO), load_pair(array, k + np.uint64(4))


@kernel
def get_matrix_of_pairs(array, first):
    """3x3 matrix of pairs, row by row, from place `first` of a flat array."""
    k = np.uint64(first)
    x = get_vector_of_pairs(array, k)
    y = get_vector_of_pairs(array, k + np.uint64(6))
    z = get_vector_of_pairs(array, k + np.uint64(12))
    return x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]


@kernel
def put_pairs(array, first, pairs):
    """Write a tuple of pairs from place `first` of a flat array on (modified)."""
    k = np.uint64(first)
    for i in range(len(pairs)):
        store_pair(array, k + np.uint64(2 * i), pairs[i])


@kernel
def put_side_by_side(a, p, b, q, numbers):
    """Write a tuple of pairs: the first numbers to an array from place p on, the second ones to another (both modified)."""
    p = np.uint64(p)
    q = np.uint64(q)
    for k in range(0, len(numbers) - 1, 2):
        at_p, at_q = unzip(numbers[k], numbers[k + 1])
        store_pair(a, p + np.uint64(k), at_p)
        store_pair(b, q + np.uint64(k), at_q)
    if len(numbers) % 2 == 1:
        last = np.uint64(len(numbers) - 1)
        a[p + last] = first(numbers[-1])
        b[q + last] = second(numbers[-1])


@kernel
def add(a, b):
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def sub(a, b):
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def scale(factor, a):
    """factor a."""
    return factor * a[0], factor * a[1], factor * a[2]


@kernel
def along(a, factor, b):
    """a + factor b."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@kernel
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def norm(a):
    """|a|."""
    return sqrt(dot(a, a))


@kernel
def get_matrix(array, first):
    """3x3 matrix, row by row, from place `first` of a flat array."""
    k = np.uint64(first)
    m = k + THREE
    q = m + THREE
    return (
        array[k],
        array[k + ONE],
        array[k + TWO],
        array[m],
        array[m + ONE],
        array[m + TWO],
        array[q],
        array[q + ONE],
        array[q + TWO],
    )


@kernel
def put_matrix(array, first, m):
    """Write a 3x3 matrix, row by row, to place `first` of a flat array (modified)."""
    k = np.uint64(first)
    for i in range(9):
        array[k + np.uint64(i)] = m[i]


@kernel
def apply(m, a):
    """Matrix m times vector a."""
    return (
        m[0] * a[0] + m[1] * a[1] + m[2] * a[2],
        m[3] * a[0] + m[4] * a[1] + m[5] * a[2],
        m[6] * a[0] + m[7] * a[1] + m[8] * a[2],
    )


@kernel
def multiply(m, k):
    """Matrix m times matrix k."""
    return (
        m[0] * k[0] + m[1] * k[3] + m[2] * k[6],
        m[0] * k[1] + m[1] * k[4] + m[2] * k[7],
        m[0] * k[2] + m[1] * k[5] + m[2] * k[8],
        m[3] * k[0] + m[4] * k[3] + m[5] * k[6],
        m[3] * k[1] + m[4] * k[4] + m[5] * k[7],
        m[3] * k[2] + m[4] * k[5] + m[5] * k[8],
        m[6] * k[0] + m[7] * k[3] + m[8] * k[6],
        m[6] * k[1] + m[7] * k[4] + m[8] * k[7],
        m[6] * k[2] + m[7] * k[5] + m[8] * k[8],
    )


@kernel
def add_matrices(m, k):
    """Matrix m plus matrix k."""
    return (
        m[0] + k[0],
        m[1] + k[1],
        m[2] + k[2],
        m[3] + k[3],
        m[4] + k[4],
        m[5] + k[5],
        m[6] + k[6],
        m[7] + k[7],
        m[8] + k[8],
    )


@kernel
def subtract(m, k):
    """Matrix m minus matrix k."""
    return (
        m[0] - k[0],
        m[1] - k[1],
        m[2] - k[2],
        m[3] - k[3],
        m[4] - k[4],
        m[5] - k[5],
        m[6] - k[6],
        m[7] - k[7],
        m[8] - k[8],
    )


@kernel
def scale_matrix(factor, m):
    """factor m."""
    return (
        factor * m[0],
        factor * m[1],
        factor * m[2],
        factor * m[3],
        factor * m[4],
        factor * m[5],
        factor * m[6],
        factor * m[7],
        factor * m[8],
    )


@kernel
def outer(a, b):
    """Matrix a b of two vectors."""
    x = scale(a[0], b)
    y = scale(a[1], b)
    z = scale(a[2], b)
    return x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]


@kernel
def symmetric(factor, a):
    """Matrix factor a a."""
    b = scale(factor, a)
    xy = a[0] * b[1]
    xz = a[0] * b[2]
    yz = a[1] * b[2]
    return a[0] * b[0], xy, xz, xy, a[1] * b[1], yz, xz, yz, a[2] * b[2]


@kernel
def skew(a):
    """Matrix whose product with a vector b is a x b."""
    zero = 0.0 * a[0]
    return zero, -a[2], a[1], a[2], zero, -a[0], -a[1], a[0], zero


@kernel
def add_to_diagonal(m, a):
    """Matrix m + a 1."""
    return m[0] + a, m[1], m[2], m[3], m[4] + a, m[5], m[6], m[7], m[8] + a
