"""Solve the equations of the free points of a system: a band matrix, by elimination with partial pivoting.

    A = P L R,   P swaps rows, L is lower triangular with ones, R upper triangular with twice the band of A

Row i of the m rows holds the columns i - b .. i + 2 b, one after the other, where A has none beyond i - b .. i + b. It costs
about 2 m b^2 multiplications to factor and 3 m b to solve: for chains and trees of lines, whose points have neighbours with
near numbers (`systems/ordering.py`), in proportion to the number of lines.
Source: Golub and Van Loan, Matrix Computations, 4th ed., algorithm 4.3.1 with the pivots of section 4.3.3.
"""

from math import inf, sqrt

from ..compilation import kernel


@kernel
def row_size(b):
    """Numbers of a row of a matrix with the band b."""
    return 3 * b + 1


@kernel
def place_in(b, i, j):
    """Place of the number in row i and column j of a matrix with the band b."""
    return row_size(b) * i + (j - i + b)


@kernel
def add_block(b, row, column, block, matrix):
    """Add a 3x3 block that couples two points to a matrix of the band b (modified)."""
    place = place_in(b, 3 * row, 3 * column)
    for i in range(3):
        for j in range(3):
            matrix[place + (row_size(b) - 1) * i + j] += block[3 * i + j]


@kernel
def largest_below(b, k, last, matrix):
    """Row from k to `last` that has the largest number in column k."""
    best = k
    for i in range(k + 1, last + 1):
        if abs(matrix[place_in(b, i, k)]) > abs(matrix[place_in(b, best, k)]):
            best = i
    return best


@kernel
def swap_rows(b, k, best, end, matrix):
    """Swap the numbers of the rows k and `best` in the columns from k up to `end` (matrix modified)."""
    for j in range(k, end):
        p, q = place_in(b, k, j), place_in(b, best, j)
        matrix[p], matrix[q] = matrix[q], matrix[p]


@kernel
def subtract_row(b, i, k, end, factor, matrix):
    """Subtract a multiple of row k from row i (modified) in the columns from k + 1 up to `end`."""
    p, q = place_in(b, i, k + 1), place_in(b, k, k + 1)
    for j in range(end - k - 1):
        matrix[p + j] -= factor * matrix[q + j]


@kernel
def factorize_band(m, b, matrix, pivots):
    """Factor a matrix of m rows (modified), with the rows that were swapped in `pivots` (modified); False if singular."""
    for k in range(m):
        last, end = min(k + b, m - 1), min(k + 2 * b + 1, m)
        best = largest_below(b, k, last, matrix)
        pivots[k] = best
        pivot = matrix[place_in(b, best, k)]
        if not 0.0 < abs(pivot) < inf:
            return False
        if best != k:
            swap_rows(b, k, best, end, matrix)
        for i in range(k + 1, last + 1):
            factor = matrix[place_in(b, i, k)] / pivot
            matrix[place_in(b, i, k)] = factor
            subtract_row(b, i, k, end, factor, matrix)
    return True


@kernel
def solve_band(m, b, matrix, pivots, right):
    """Solve with the factors of `factorize_band`; the right-hand side (modified) becomes the solution."""
    for k in range(m):
        best = int(pivots[k])
        right[k], right[best] = right[best], right[k]
        for i in range(k + 1, min(k + b, m - 1) + 1):
            right[i] -= matrix[place_in(b, i, k)] * right[k]
    for i in range(m - 1, -1, -1):
        total = right[i]
        for j in range(i + 1, min(i + 2 * b + 1, m)):
            total -= matrix[place_in(b, i, j)] * right[j]
        right[i] = total / matrix[place_in(b, i, i)]


@kernel
def is_positive_definite(m, b, matrix, shift, factors):
    """Whether the symmetric part of a matrix, plus a shift of its diagonal, has Cholesky factors: into `factors` (modified).

    Source: Golub and Van Loan, algorithm 4.3.5.
    """
    for i in range(m):
        for j in range(max(0, i - b), i + 1):
            rest = 0.5 * (matrix[place_in(b, i, j)] + matrix[place_in(b, j, i)])
            for k in range(max(0, i - b), j):
                rest -= factors[place_in(b, i, k)] * factors[place_in(b, j, k)]
            if j < i:
                factors[place_in(b, i, j)] = rest / factors[place_in(b, j, j)]
            elif rest + shift > 0.0:
                factors[place_in(b, i, i)] = sqrt(rest + shift)
            else:
                return False
    return True
