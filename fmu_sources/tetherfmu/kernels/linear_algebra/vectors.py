"""Three-vectors as tuples of numbers or of pairs: they stay in registers, so nothing is allocated."""

from math import sqrt

from ..compilation import kernel

ZERO_VECTOR = (0.0, 0.0, 0.0)
NEUTRAL = -0.0  # to add -0 changes nothing, not even the sign of a zero
NEUTRAL_VECTOR = (NEUTRAL, NEUTRAL, NEUTRAL)


@kernel
def get(array, index):
    """Three-vector number `index` of a flat array."""
    return vector_at(array, 3 * index)


@kernel
def put(array, index, a):
    """Write three-vector number `index` of a flat array (modified)."""
    put_at(array, 3 * index, a)


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
def add_at(array, index, a):
    """Add a vector to number `index` of a flat array (modified)."""
    put(array, index, add(get(array, index), a))


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
def add_scaled(a, factor, b):
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
