"""3x3 matrices as tuples of nine numbers, or pairs, row by row."""

from ..compilation import kernel
from .vectors import add, dot, scale, sub, vector_at

ZERO_MATRIX = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@kernel
def get_matrix(array, first):
    """3x3 matrix, row by row, from place `first` of a flat array."""
    return vector_at(array, first) + vector_at(array, first + 3) + vector_at(array, first + 6)


@kernel
def put_matrix(array, first, m):
    """Write a 3x3 matrix, row by row, to place `first` of a flat array (modified)."""
    for i in range(9):
        array[first + i] = m[i]


@kernel
def apply(m, a):
    """Matrix m times vector a."""
    return dot(m[:3], a), dot(m[3:6], a), dot(m[6:], a)


@kernel
def transposed_apply(a, m):
    """Vector a times matrix m."""
    return dot(a, (m[0], m[3], m[6])), dot(a, (m[1], m[4], m[7])), dot(a, (m[2], m[5], m[8]))


@kernel
def multiply(m, k):
    """Matrix m times matrix k."""
    return transposed_apply(m[:3], k) + transposed_apply(m[3:6], k) + transposed_apply(m[6:], k)


@kernel
def add_matrices(m, k):
    """Matrix m plus matrix k."""
    return add(m[:3], k[:3]) + add(m[3:6], k[3:6]) + add(m[6:], k[6:])


@kernel
def subtract(m, k):
    """Matrix m minus matrix k."""
    return sub(m[:3], k[:3]) + sub(m[3:6], k[3:6]) + sub(m[6:], k[6:])


@kernel
def scale_matrix(factor, m):
    """factor m."""
    return scale(factor, m[:3]) + scale(factor, m[3:6]) + scale(factor, m[6:])


@kernel
def outer(a, b):
    """Matrix a b of two vectors."""
    return scale(a[0], b) + scale(a[1], b) + scale(a[2], b)


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
