"""Solve a block tridiagonal system with 3x3 blocks, without allocation (Thomas algorithm on blocks).

    L_i y_(i-1) + D_i y_i + U_i y_(i+1) = b_i,   i = first .. last

Factors D'_i = D_i - L_i D'_(i-1)^-1 U_(i-1); the diagonal keeps the inverses of D'. Source: Golub and Van Loan, Matrix
Computations, 4th ed., section 4.5.
"""

from .compilation import kernel
from .vectors import apply, get, put, sub


@kernel
def invert(a, k):
    """Replace the 3x3 matrix at place k of the flat array `a` (modified) by its inverse; False if it is singular."""
    m00, m01, m02 = a[k], a[k + 1], a[k + 2]
    m10, m11, m12 = a[k + 3], a[k + 4], a[k + 5]
    m20, m21, m22 = a[k + 6], a[k + 7], a[k + 8]
    c0 = m11 * m22 - m12 * m21
    c1 = m12 * m20 - m10 * m22
    c2 = m10 * m21 - m11 * m20
    determinant = m00 * c0 + m01 * c1 + m02 * c2
    r = 1.0 / determinant
    a[k] = c0 * r
    a[k + 1] = (m02 * m21 - m01 * m22) * r
    a[k + 2] = (m01 * m12 - m02 * m11) * r
    a[k + 3] = c1 * r
    a[k + 4] = (m00 * m22 - m02 * m20) * r
    a[k + 5] = (m02 * m10 - m00 * m12) * r
    a[k + 6] = c2 * r
    a[k + 7] = (m01 * m20 - m00 * m21) * r
    a[k + 8] = (m00 * m11 - m01 * m10) * r
    return abs(determinant) > 0.0 and abs(r) > 0.0


@kernel
def factorize(first, last, diagonal, lower, upper):
    """Factor the matrix in place (`diagonal` and `lower` modified); False if a pivot block is singular.

    Afterwards `diagonal` holds the inverses of D' and `lower` the products L_i D'_(i-1)^-1.
    """
    regular = True
    for i in range(first, last + 1):
        d = 9 * i
        if i > first:
            above = d - 9
            for row in range(3):
                r = d + 3 * row
                l0, l1, l2 = lower[r], lower[r + 1], lower[r + 2]
                for column in range(3):
                    c = above + column
                    lower[r + column] = l0 * diagonal[c] + l1 * diagonal[c + 3] + l2 * diagonal[c + 6]
                l0, l1, l2 = lower[r], lower[r + 1], lower[r + 2]
                for column in range(3):
                    c = above + column
                    diagonal[r + column] -= l0 * upper[c] + l1 * upper[c + 3] + l2 * upper[c + 6]
        regular = invert(diagonal, d) and regular
    return regular


@kernel
def solve(first, last, diagonal, lower, upper, b):
    """Solve with the factors of `factorize`; the right-hand side `b` (modified) becomes the solution."""
    for i in range(first + 1, last + 1):
        put(b, i, sub(get(b, i), apply(lower, 9 * i, get(b, i - 1))))
    put(b, last, apply(diagonal, 9 * last, get(b, last)))
    for i in range(last - 1, first - 1, -1):
        put(b, i, apply(diagonal, 9 * i, sub(get(b, i), apply(upper, 9 * i, get(b, i + 1)))))
