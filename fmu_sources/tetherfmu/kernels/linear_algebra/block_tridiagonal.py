"""Solve a block tridiagonal system with 3x3 blocks, without allocation, from both ends towards the middle.

    L_i y_(i-1) + D_i y_i + U_i y_(i+1) = b_i,   i = first .. last

Pivots D'_i = D_i - L_i D'_(i-1)^-1 U_(i-1) for i < middle, D'_i = D_i - U_i D'_(i+1)^-1 L_(i+1) for i > middle; the row in
the middle loses both products.
Source: Golub and Van Loan, Matrix Computations, 4th ed., section 4.5 (block tridiagonal systems).
"""

from collections import namedtuple
from math import inf

from ..compilation import kernel
from .both_ends import get_blocks, get_packed_blocks, get_two, pack_blocks, put_two
from .matrices import apply, get_matrix, multiply, put_matrix, subtract
from .pairs import first, second
from .vectors import get, put, sub

Matrix = namedtuple("Matrix", "diagonal lower upper")
Matrix.__doc__ = """Blocks D, L, U as flat arrays: 9 numbers for each row of blocks, block by block, each row by row."""


@kernel
def inverse(m):
    """Inverse of a 3x3 matrix by its cofactors, and its determinant."""
    c0 = m[4] * m[8] - m[5] * m[7]
    c1 = m[5] * m[6] - m[3] * m[8]
    c2 = m[3] * m[7] - m[4] * m[6]
    determinant = m[0] * c0 + m[1] * c1 + m[2] * c2
    r = 1.0 / determinant
    return (
        c0 * r,
        (m[2] * m[7] - m[1] * m[8]) * r,
        (m[1] * m[5] - m[2] * m[4]) * r,
        c1 * r,
        (m[0] * m[8] - m[2] * m[6]) * r,
        (m[2] * m[3] - m[0] * m[5]) * r,
        c2 * r,
        (m[1] * m[6] - m[0] * m[7]) * r,
        (m[0] * m[4] - m[1] * m[3]) * r,
    ), determinant


@kernel
def is_regular(determinant):
    """Whether a matrix with this determinant has an inverse."""
    return 0.0 < abs(determinant) < inf


@kernel
def minus_product(a, m, b):
    """a - m b, summed so that the result depends on b as late as possible."""
    return (
        (a[0] - m[0] * b[0]) - (m[1] * b[1] + m[2] * b[2]),
        (a[1] - m[3] * b[0]) - (m[4] * b[1] + m[5] * b[2]),
        (a[2] - m[6] * b[0]) - (m[7] * b[1] + m[8] * b[2]),
    )


@kernel
def factorize_halves(rows, up, down, matrix):
    """Factorize `rows` rows from row `up` upwards and from row `down` downwards, both at once (matrix modified).

    Returns the subtrahend for the next two rows of blocks, as a matrix of pairs, and False if a pivot block is singular.
    """
    diagonal, lower, upper = matrix
    block = get_blocks(diagonal, up, diagonal, down)
    loss = block
    regular = True
    for _ in range(rows):
        pivot, determinant = inverse(block)
        regular = regular and is_regular(first(determinant)) and is_regular(second(determinant))
        inward = get_blocks(upper, up, lower, down)
        pack_blocks(diagonal, up, diagonal, down, pivot)
        pack_blocks(upper, up, lower, down, inward)
        up += 1
        down -= 1
        factor = multiply(get_blocks(lower, up, upper, down), pivot)
        pack_blocks(lower, up, upper, down, factor)
        loss = multiply(factor, inward)
        block = subtract(get_blocks(diagonal, up, diagonal, down), loss)
    return loss, regular


@kernel
def factorize(first_row, last_row, matrix):
    """Factor a `Matrix` in place (modified); False if a pivot block is singular.

    Afterwards `diagonal` holds the inverses of D', `lower` the products L_i D'_(i-1)^-1 up to the middle row, `upper` the
    products U_i D'_(i+1)^-1 from the middle row on; the blocks of mirror rows are packed (`pack_blocks`).
    """
    diagonal, lower, upper = matrix
    middle = (first_row + last_row) // 2
    rows = middle - first_row
    below = last_row - rows  # the middle row itself, or the next one
    block = get_matrix(diagonal, 9 * middle)
    block_below = get_matrix(diagonal, 9 * below)
    regular = True
    if rows > 0:
        loss, regular = factorize_halves(rows, first_row, last_row, matrix)
        block = subtract(block, first(loss))
        if below == middle:
            block = subtract(block, second(loss))
        else:
            block_below = subtract(block_below, second(loss))
    if below > middle:
        pivot, determinant = inverse(block_below)
        regular = regular and is_regular(determinant)
        factor = multiply(get_matrix(upper, 9 * middle), pivot)
        put_matrix(diagonal, 9 * below, pivot)
        put_matrix(upper, 9 * middle, factor)
        block = subtract(block, multiply(factor, get_matrix(lower, 9 * below)))
    pivot, determinant = inverse(block)
    put_matrix(diagonal, 9 * middle, pivot)
    return regular and is_regular(determinant)


@kernel
def solve(first_row, last_row, matrix, b):
    """Solve with the factors of `factorize`; the right-hand side `b` (modified) becomes the solution."""
    diagonal, lower, upper = matrix
    middle = (first_row + last_row) // 2
    rows = middle - first_row
    below = last_row - rows
    if rows > 0:
        two = get_two(b, first_row, last_row)
        for k in range(1, rows):
            i = first_row + k
            j = last_row - k
            two = minus_product(get_two(b, i, j), get_packed_blocks(lower, i, upper, j), two)
            put_two(b, i, j, two)
        loss = apply(get_packed_blocks(lower, middle, upper, below), two)
        put(b, middle, sub(get(b, middle), first(loss)))
        put(b, below, sub(get(b, below), second(loss)))
    if below > middle:
        put(b, middle, sub(get(b, middle), apply(get_matrix(upper, 9 * middle), get(b, below))))
    put(b, middle, apply(get_matrix(diagonal, 9 * middle), get(b, middle)))
    if below > middle:
        rest = sub(get(b, below), apply(get_matrix(lower, 9 * below), get(b, middle)))
        put(b, below, apply(get_matrix(diagonal, 9 * below), rest))
    two = get_two(b, middle, below)
    for k in range(1, rows + 1):
        i = middle - k
        j = below + k
        rest = minus_product(get_two(b, i, j), get_packed_blocks(upper, i, lower, j), two)
        two = apply(get_packed_blocks(diagonal, i, diagonal, j), rest)
        put_two(b, i, j, two)
