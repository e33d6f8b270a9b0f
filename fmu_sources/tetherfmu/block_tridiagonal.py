"""Solve a block tridiagonal system with 3x3 blocks, without allocation (Thomas algorithm on blocks).

    L_i y_(i-1) + D_i y_i + U_i y_(i+1) = b_i,   i = first .. last

Factors D'_i = D_i - L_i D'_(i-1)^-1 U_(i-1); the diagonal keeps the inverses of D'. Source: Golub and Van Loan, Matrix
Computations, 4th ed., section 4.5.
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
def factorize(first, last, diagonal, lower, upper):
    """Factor the matrix in place (`diagonal` and `lower` modified); False if a pivot block is singular.

    Afterwards `diagonal` holds the inverses of D' and `lower` the products L_i D'_(i-1)^-1.
    """
    regular = True
    pivot = get_matrix(diagonal, 9 * first)
    for i in range(first, last + 1):
        if i > first:
            factor = multiply(get_matrix(lower, 9 * i), pivot)
            put_matrix(lower, 9 * i, factor)
            pivot = subtract(get_matrix(diagonal, 9 * i), multiply(factor, get_matrix(upper, 9 * i - 9)))
        pivot, determinant = inverse(pivot)
        put_matrix(diagonal, 9 * i, pivot)
        regular = regular and 0.0 < abs(determinant) < inf
    return regular


@kernel
def solve(first, last, diagonal, lower, upper, b):
    """Solve with the factors of `factorize`; the right-hand side `b` (modified) becomes the solution."""
    y = get(b, first)
    for i in range(first + 1, last + 1):
        y = sub(get(b, i), apply(get_matrix(lower, 9 * i), y))
        put(b, i, y)
    y = apply(get_matrix(diagonal, 9 * last), y)
    put(b, last, y)
    for i in range(last - 1, first - 1, -1):
        y = apply(get_matrix(diagonal, 9 * i), sub(get(b, i), apply(get_matrix(upper, 9 * i), y)))
        put(b, i, y)
