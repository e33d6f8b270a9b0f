"""A small dense matrix in a flat array, row by row, for the sheaves of a system."""

from ..arrays import clear
from ..compilation import kernel


@kernel
def swap_rows(count, i, j, matrix):
    """Swap two rows (modified)."""
    for k in range(count):
        matrix[count * i + k], matrix[count * j + k] = matrix[count * j + k], matrix[count * i + k]


@kernel
def pivot_row(count, k, matrix):
    """Row from k on with the largest number in column k."""
    best = k
    for i in range(k + 1, count):
        if abs(matrix[count * i + k]) > abs(matrix[count * best + k]):
            best = i
    return best


@kernel
def solve(count, matrix, right):
    """Solve by elimination with row pivots; the matrix is destroyed, `right` becomes the solution. False if singular."""
    for k in range(count):
        best = pivot_row(count, k, matrix)
        swap_rows(count, k, best, matrix)
        right[k], right[best] = right[best], right[k]
        pivot = matrix[count * k + k]
        if pivot == 0.0:
            return False
        for i in range(k + 1, count):
            factor = matrix[count * i + k] / pivot
            for j in range(k, count):
                matrix[count * i + j] -= factor * matrix[count * k + j]
            right[i] -= factor * right[k]
    for k in range(count - 1, -1, -1):
        for j in range(k + 1, count):
            right[k] -= matrix[count * k + j] * right[j]
        right[k] /= matrix[count * k + k]
    return True


@kernel
def invert(count, matrix, inverse):
    """Inverse of a matrix, which is destroyed, into `inverse` (modified); False if singular."""
    clear(inverse)
    for k in range(count):
        inverse[count * k + k] = 1.0
    for k in range(count):
        best = pivot_row(count, k, matrix)
        swap_rows(count, k, best, matrix)
        swap_rows(count, k, best, inverse)
        pivot = matrix[count * k + k]
        if pivot == 0.0:
            return False
        for j in range(count):
            matrix[count * k + j] /= pivot
            inverse[count * k + j] /= pivot
        for i in range(count):
            factor = matrix[count * i + k]
            if i != k:
                for j in range(count):
                    matrix[count * i + j] -= factor * matrix[count * k + j]
                    inverse[count * i + j] -= factor * inverse[count * k + j]
    return True
