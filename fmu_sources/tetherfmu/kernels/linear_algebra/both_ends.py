"""Loads and stores of pairs: numbers, vectors and blocks of both halves of a chain at once.

An interleaved array stores the vectors of n + 1 nodes as pairs, node k and its mirror image side by side:

    x_k x_(n-k) y_k y_(n-k) z_k z_(n-k),   k = 0 .. n // 2

It stores the middle node of an even n twice. A flat array stores one vector after the other.
"""

from ..compilation import kernel
from .pairs import first, load_pair, pair, second, store_pair, swapped, unzip


@kernel
def get_two(array, i, j):
    """Three-vectors number i and j of a flat array, as pairs."""
    p, q = 3 * i, 3 * j
    x, y = unzip(load_pair(array, p), load_pair(array, q))
    return x, y, pair(array[p + 2], array[q + 2])


@kernel
def put_two(array, i, j, a):
    """Write a vector of pairs to the three-vectors number i and j of a flat array (modified)."""
    p, q = 3 * i, 3 * j
    at_i, at_j = unzip(a[0], a[1])
    store_pair(array, p, at_i)
    store_pair(array, q, at_j)
    array[p + 2] = first(a[2])
    array[q + 2] = second(a[2])


@kernel
def get_vector_of_pairs(array, place):
    """Three-vector of pairs at a place of a flat array."""
    return load_pair(array, place), load_pair(array, place + 2), load_pair(array, place + 4)


@kernel
def get_matrix_of_pairs(array, place):
    """3x3 matrix of pairs, row by row, at a place of a flat array."""
    rows = get_vector_of_pairs(array, place) + get_vector_of_pairs(array, place + 6)
    return rows + get_vector_of_pairs(array, place + 12)


@kernel
def put_pairs(array, place, pairs):
    """Write a tuple of pairs to a place of a flat array (modified)."""
    for i in range(len(pairs)):
        store_pair(array, place + 2 * i, pairs[i])


@kernel
def interleaved_size(n):
    """Length of an interleaved array of n + 1 vectors."""
    return 6 * (n // 2 + 1)


@kernel
def get_interleaved(array, k):
    """Vectors number k and n - k of an interleaved array, as pairs."""
    return get_vector_of_pairs(array, 6 * k)


@kernel
def put_interleaved(array, k, a):
    """Write a vector of pairs to the vectors number k and n - k of an interleaved array (modified)."""
    put_pairs(array, 6 * k, a)


@kernel
def next_interleaved(n, k, array):
    """Vectors number k + 1 and n - k - 1 of an interleaved array, as pairs, up to the middle and one beyond."""
    if 2 * (k + 1) <= n:
        return get_interleaved(array, k + 1)
    return swapped(get_interleaved(array, k))


@kernel
def lower_and_upper(n, s, a):
    """Vectors of an interleaved array at the lower ends of segment s and its mirror image, as pairs; at their upper ends."""
    outer, inner = get_interleaved(a, s), next_interleaved(n, s, a)
    return pair(first(outer), second(inner)), pair(first(inner), second(outer))


@kernel
def get_node(n, i, array):
    """Vector number i of n + 1 in an interleaved array."""
    k = 6 * min(i, n - i) + (1 if 2 * i > n else 0)
    return array[k], array[k + 2], array[k + 4]


@kernel
def add_to_node(n, i, a, array):
    """Add a vector to number i of n + 1 in an interleaved array (modified), to both copies of a middle node."""
    k = 6 * min(i, n - i) + (1 if 2 * i > n else 0)
    for j in range(3):
        array[k + 2 * j] += a[j]
        if 2 * i == n:
            array[k + 2 * j + 1] += a[j]


@kernel
def interleave(n, flat, interleaved):
    """Copy the vectors of a flat array into an interleaved one (modified)."""
    for k in range(n // 2 + 1):
        put_interleaved(interleaved, k, get_two(flat, k, n - k))


@kernel
def deinterleave(n, interleaved, flat):
    """Copy the vectors of an interleaved array into a flat one (modified)."""
    for k in range(n // 2 + 1):
        put_two(flat, k, n - k, get_interleaved(interleaved, k))


@kernel
def put_side_by_side(a, p, b, q, numbers):
    """Write a tuple of pairs: the first numbers to an array from place p on, the second ones to another (both modified)."""
    for k in range(0, len(numbers) - 1, 2):
        at_p, at_q = unzip(numbers[k], numbers[k + 1])
        store_pair(a, p + k, at_p)
        store_pair(b, q + k, at_q)
    if len(numbers) % 2 == 1:
        last = len(numbers) - 1
        a[p + last] = first(numbers[-1])
        b[q + last] = second(numbers[-1])


@kernel
def four_pairs(array, k):
    """Four pairs at place k of a flat array."""
    return load_pair(array, k), load_pair(array, k + 2), load_pair(array, k + 4), load_pair(array, k + 6)


@kernel
def get_blocks(a, i, b, j):
    """Block i of an array and block j of another one, as pairs."""
    p, q = 9 * i, 9 * j
    x = four_pairs(a, p)
    y = four_pairs(b, q)
    both = unzip(x[0], y[0]) + unzip(x[1], y[1]) + unzip(x[2], y[2]) + unzip(x[3], y[3])
    return (*both, pair(a[p + 8], b[q + 8]))


@kernel
def pack_blocks(a, i, b, j, m):
    """Write a matrix of pairs into block i of an array and block j of another one (modified), four pairs into each.

    The two numbers of the ninth pair are at the ends of the blocks.
    """
    p, q = 9 * i, 9 * j
    for k in range(4):
        store_pair(a, p + 2 * k, m[k])
        store_pair(b, q + 2 * k, m[k + 4])
    a[p + 8] = first(m[8])
    b[q + 8] = second(m[8])


@kernel
def get_packed_blocks(a, i, b, j):
    """Matrix of pairs that `pack_blocks` wrote."""
    p, q = 9 * i, 9 * j
    return (*four_pairs(a, p), *four_pairs(b, q), pair(a[p + 8], b[q + 8]))
