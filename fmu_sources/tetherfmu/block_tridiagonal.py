"""Solve a block tridiagonal system with 3x3 blocks, without allocation, from both ends towards the middle.

    L_i y_(i-1) + D_i y_i + U_i y_(i+1) = b_i,   i = first .. last

Pivots D'_i = D_i - L_i D'_(i-1)^-1 U_(i-1) above the middle row, D'_i = D_i - U_i D'_(i+1)^-1 L_(i+1) below it, both in it.
Source: Golub and Van Loan, Matrix Computations, 4th ed., section 4.5 (block tridiagonal systems).
"""

from math import inf

from .compilation import kernel
from .vectors import apply, get, get_matrix, multiply, put, put_matrix, sub, subtract


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
def next_pivot(i, step, pivot, diagonal, outward, inward):
    """Eliminate the block before row i in the direction `step` (+1 or -1); returns the pivot block D'_i.

    `pivot` is the inverse of the last one. `outward` holds the blocks that point to the last row: the product with the
    inverse replaces block i (modified). `inward` holds those that point back.
    """
    factor = multiply(get_matrix(outward, 9 * i), pivot)
    put_matrix(outward, 9 * i, factor)
    return subtract(get_matrix(diagonal, 9 * i), multiply(factor, get_matrix(inward, 9 * (i - step))))


@kernel
def factorize(first, last, diagonal, lower, upper):
    """Factor the matrix in place (all three modified); False if a pivot block is singular.

    Afterwards `diagonal` holds the inverses of D', `lower` the products L_i D'_(i-1)^-1 up to the middle row, `upper` the
    products U_i D'_(i+1)^-1 from the middle row on.
    """
    middle = (first + last) // 2
    up, determinant_up = inverse(get_matrix(diagonal, 9 * first))
    down, determinant_down = inverse(get_matrix(diagonal, 9 * last))
    regular = True
    for k in range(1, middle - first + 1):  # both ends at once: their chains of operations do not wait for each other
        regular = regular and 0.0 < abs(determinant_up) < inf and 0.0 < abs(determinant_down) < inf
        i = first + k
        j = last - k
        put_matrix(diagonal, 9 * i - 9, up)
        put_matrix(diagonal, 9 * j + 9, down)
        up = next_pivot(i, 1, up, diagonal, lower, upper)
        if j > middle:
            down, determinant_down = inverse(next_pivot(j, -1, down, diagonal, upper, lower))
        if i < middle:
            up, determinant_up = inverse(up)
    if first == last:
        put_matrix(diagonal, 9 * first, up)
        return 0.0 < abs(determinant_up) < inf
    if middle == first:
        up = get_matrix(diagonal, 9 * first)
    if last - middle > middle - first:
        put_matrix(diagonal, 9 * middle + 9, down)
    factor = multiply(get_matrix(upper, 9 * middle), down)
    put_matrix(upper, 9 * middle, factor)
    up, determinant_up = inverse(subtract(up, multiply(factor, get_matrix(lower, 9 * middle + 9))))
    put_matrix(diagonal, 9 * middle, up)
    return regular and 0.0 < abs(determinant_up) < inf and 0.0 < abs(determinant_down) < inf


@kernel
def solve(first, last, diagonal, lower, upper, b):
    """Solve with the factors of `factorize`; the right-hand side `b` (modified) becomes the solution."""
    middle = (first + last) // 2
    up = get(b, first)
    down = get(b, last)
    for k in range(1, middle - first + 1):
        i = first + k
        j = last - k
        up = sub(get(b, i), apply(get_matrix(lower, 9 * i), up))
        put(b, i, up)
        if j > middle:
            down = sub(get(b, j), apply(get_matrix(upper, 9 * j), down))
            put(b, j, down)
    if last > middle:
        up = sub(up, apply(get_matrix(upper, 9 * middle), down))
    up = apply(get_matrix(diagonal, 9 * middle), up)
    put(b, middle, up)
    down = up
    for k in range(1, last - middle + 1):
        i = middle - k
        j = middle + k
        if i >= first:
            up = apply(get_matrix(diagonal, 9 * i), sub(get(b, i), apply(get_matrix(upper, 9 * i), up)))
            put(b, i, up)
        down = apply(get_matrix(diagonal, 9 * j), sub(get(b, j), apply(get_matrix(lower, 9 * j), down)))
        put(b, j, down)
