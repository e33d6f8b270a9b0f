"""A block tridiagonal system condensed to its first and last rows, which other systems share.

    D_0 y_0 + U_0 y_1 = b_0,   L_i y_(i-1) + D_i y_i + U_i y_(i+1) = b_i,   L_n y_(n-1) + D_n y_n = b_n

The inner rows 1 .. n - 1 are factorized as in `block_tridiagonal.py`. With A of these, and their columns that meet the ends,

    y = A^-1 b - C_0 y_0 - C_n y_n,   C_0 = A^-1 (L_1, 0, ..., 0),   C_n = A^-1 (0, ..., 0, U_(n-1))

the first and the last row become

    (D_0 - U_0 C_0,1) y_0 - U_0 C_n,1 y_n = b_0 - U_0 (A^-1 b)_1
    (D_n - L_n C_n,n-1) y_n - L_n C_0,n-1 y_0 = b_n - L_n (A^-1 b)_(n-1)

An end that is prescribed, with y = 0, has no columns. `columns` has six arrays of n + 1 vectors: three of C_0, three of C_n.
"""

from ..compilation import kernel, part
from .block_tridiagonal import factorize, solve
from .matrices import apply, get_matrix
from .vectors import ZERO_VECTOR, get, put, scale, sub

COLUMNS = 6  # of both ends


@kernel
def columns_size(n):
    """Length of the array `columns`."""
    return COLUMNS * 3 * (n + 1)


@kernel
def column_of(array, place, c):
    """Column c of the 3x3 block at a place of a flat array."""
    k = 9 * place + c
    return array[k], array[k + 3], array[k + 6]


@kernel
def condense(n, start_is_free, end_is_free, matrix, columns):
    """Factor the inner rows of a `Matrix` and find the columns of its free ends (both modified); False if it is singular."""
    if n == 1:
        return True
    if not factorize(1, n - 1, matrix):
        return False
    size = 3 * (n + 1)
    for c in range(3):
        if start_is_free:
            find_column(n, 1, column_of(matrix.lower, 1, c), matrix, part(columns, size * c, size))
        if end_is_free:
            find_column(n, n - 1, column_of(matrix.upper, n - 1, c), matrix, part(columns, size * (3 + c), size))
    return True


@kernel
def find_column(n, row, coupling, matrix, column):
    """A^-1 of a vector that is `coupling` in one row and 0 in all others, into a column (modified)."""
    for i in range(1, n):
        put(column, i, ZERO_VECTOR)
    put(column, row, coupling)
    solve(1, n - 1, matrix, column)


@kernel
def column_between(n, matrix, columns, of_end, at_end, c):
    """Column c of the condensed block in the row of one end (at_end: 0 the first row, 1 the last) that belongs to another."""
    own, beside = n * at_end, 1 + (n - 2) * at_end
    coupling = matrix.lower if at_end == 1 else matrix.upper
    if n == 1:
        return column_of(matrix.diagonal if at_end == of_end else coupling, own, c)
    size = 3 * (n + 1)
    inner = get(part(columns, size * (3 * of_end + c), size), beside)
    loss = apply(get_matrix(coupling, 9 * own), inner)
    return sub(column_of(matrix.diagonal, own, c), loss) if at_end == of_end else scale(-1.0, loss)


@kernel
def reduce(n, matrix, b):
    """Solve the inner rows of a right-hand side, and take their part out of its first and last row (modified)."""
    if n == 1:
        return
    solve(1, n - 1, matrix, b)
    put(b, 0, sub(get(b, 0), apply(get_matrix(matrix.upper, 0), get(b, 1))))
    put(b, n, sub(get(b, n), apply(get_matrix(matrix.lower, 9 * n), get(b, n - 1))))


@kernel
def expand(n, start_is_free, end_is_free, columns, y):
    """Solution in the inner rows (modified) from that of the ends, after `reduce`."""
    size = 3 * (n + 1)
    for c in range(COLUMNS):
        of_end = c >= 3
        if end_is_free if of_end else start_is_free:
            factor = y[3 * n + c - 3] if of_end else y[c]
            column = part(columns, size * c, size)
            for k in range(3, 3 * n):
                y[k] -= factor * column[k]
