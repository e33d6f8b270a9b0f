"""Solve the equations of the free points of a system: a dense matrix, by elimination with partial pivoting.

    A = P L R,   P a permutation, L lower triangular with ones, R upper triangular

The matrix is flat, row by row, with m rows; it costs m^3/3 multiplications, m being three times the number of free points.
Source: Golub and Van Loan, Matrix Computations, 4th ed., algorithm 3.4.1.
"""

from math import inf

from ..compilation import kernel


@kernel
def largest_below(m, k, matrix):
    """Row from k on that has the largest number in column k."""
    best = k
    for i in range(k + 1, m):
        if abs(matrix[m * i + k]) > abs(matrix[m * best + k]):
            best = i
    return best


@kernel
def swap_rows(m, i, j, matrix):
    """Swap two rows of a matrix (modified)."""
    for k in range(m):
        matrix[m * i + k], matrix[m * j + k] = matrix[m * j + k], matrix[m * i + k]


@kernel
def factorize_dense(m, matrix, pivots):
    """Factor a matrix of m rows in place, and the rows that were swapped into `pivots` (both modified); False if singular."""
    for k in range(m):
        best = largest_below(m, k, matrix)
        pivots[k] = best
        pivot = matrix[m * best + k]
        if not 0.0 < abs(pivot) < inf:
            return False
        if best != k:
            swap_rows(m, k, best, matrix)
        for i in range(k + 1, m):
            factor = matrix[m * i + k] / pivot
            matrix[m * i + k] = factor
            if factor != 0.0:
                for j in range(k + 1, m):
                    matrix[m * i + j] -= factor * matrix[m * k + j]
    return True


@kernel
def solve_dense(m, matrix, pivots, b):
    """Solve with the factors of `factorize_dense`; the right-hand side `b` (modified) becomes the solution."""
    for k in range(m):
        best = int(pivots[k])
        b[k], b[best] = b[best], b[k]
    for i in range(m):
        for j in range(i):
            b[i] -= matrix[m * i + j] * b[j]
    for i in range(m - 1, -1, -1):
        for j in range(i + 1, m):
            b[i] -= matrix[m * i + j] * b[j]
        b[i] /= matrix[m * i + i]
