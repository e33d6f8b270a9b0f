"""Three-vectors as tuples of three numbers: they live in registers, so nothing is allocated."""

from math import sqrt

from .compilation import kernel


@kernel
def get(array, index):
    """Three-vector number `index` of a flat array."""
    k = 3 * index
    return array[k], array[k + 1], array[k + 2]


@kernel
def put(array, index, a):
    """Write three-vector number `index` of a flat array (modified)."""
    k = 3 * index
    array[k] = a[0]
    array[k + 1] = a[1]
    array[k + 2] = a[2]


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
def apply(matrix, first, a):
    """Product of the 3x3 matrix stored row by row from place `first` of a flat array with a."""
    m = matrix[first : first + 9]
    return (
        m[0] * a[0] + m[1] * a[1] + m[2] * a[2],
        m[3] * a[0] + m[4] * a[1] + m[5] * a[2],
        m[6] * a[0] + m[7] * a[1] + m[8] * a[2],
    )
