"""Equations of a step at the free points of a system: 3x3 blocks in a band, solved by elimination without pivoting.

    A = L R,   L has unit blocks on its diagonal and F_qp = A_qp D_p^-1 below it, D_p is the reduced block A_pp

as within a line (`block_tridiagonal.py`), whose inner nodes these could be. Points in a row, with only the next ones as
neighbours, are solved there. The diagonals of blocks are stored one after the other, from the lowest of 2 w + 1 to the
highest; the points p - w .. p + w may be neighbours of p (`wiring/ordering.py`). If the symmetric part of a matrix is
positive definite, so is that of each D_p, and no pivoting is needed; a symmetric matrix is definite if all D_p are.
Source: Golub and Van Loan, Matrix Computations, 4th ed., sections 3.2.10 (block elimination), 4.2 (positive definite
matrices) and 4.3 (bands).
"""

from ..arrays import copy
from ..compilation import kernel, view
from ..flat_arrays import part
from . import block_tridiagonal
from .block_tridiagonal import inverse, is_regular, minus_product
from .matrices import add_matrices, apply, get_matrix, multiply, put_matrix, subtract
from .vectors import get, put


@kernel
def matrix_size(count, w):
    """Length of a matrix of `count` rows of blocks."""
    return 9 * count * (2 * w + 1)


@kernel
def place_of(count, w, p, q):
    """Place of the block in row p and column q of `count`."""
    return 9 * (count * (q - p + w) + p)


@kernel
def add_to_block(count, w, p, q, block, matrix):
    """Add to the block in row p and column q of a matrix (modified)."""
    place = place_of(count, w, p, q)
    put_matrix(matrix, place, add_matrices(get_matrix(matrix, place), block))


@view
def in_a_row(count, matrix):
    """`block_tridiagonal.Matrix` of points in a row, w = 1."""
    size = 9 * count
    return block_tridiagonal.Matrix(part(matrix, size, size), part(matrix, 0, size), part(matrix, 2 * size, size))


@kernel
def eliminate(count, w, p, last, matrix):
    """Eliminate row p of blocks, with inverted D_p, from the rows below it up to `last` (matrix modified)."""
    inverted = get_matrix(matrix, place_of(count, w, p, p))
    for q in range(p + 1, last + 1):
        factor = multiply(get_matrix(matrix, place_of(count, w, q, p)), inverted)
        put_matrix(matrix, place_of(count, w, q, p), factor)
        for r in range(p + 1, last + 1):
            place = place_of(count, w, q, r)
            product = multiply(factor, get_matrix(matrix, place_of(count, w, p, r)))
            put_matrix(matrix, place, subtract(get_matrix(matrix, place), product))


@kernel
def factorize_blocks(count, w, matrix):
    """Factor a matrix of `count` rows of blocks (modified), inverses of D_p in its diagonal; False if one is singular."""
    if w == 1:
        return block_tridiagonal.factorize(0, count - 1, in_a_row(count, matrix))
    for p in range(count):
        inverted, determinant = inverse(get_matrix(matrix, place_of(count, w, p, p)))
        if not is_regular(determinant):
            return False
        put_matrix(matrix, place_of(count, w, p, p), inverted)
        eliminate(count, w, p, min(p + w, count - 1), matrix)
    return True


@kernel
def solve_blocks(count, w, matrix, right, solution):
    """Solve with the factors of `factorize_blocks` for a right-hand side; `solution` is modified."""
    copy(right, solution)
    if w == 1:
        block_tridiagonal.solve(0, count - 1, in_a_row(count, matrix), solution)
        return
    for p in range(count):
        known = get(solution, p)
        for q in range(p + 1, min(p + w, count - 1) + 1):
            put(solution, q, minus_product(get(solution, q), get_matrix(matrix, place_of(count, w, q, p)), known))
    for p in range(count - 1, -1, -1):
        rest = get(solution, p)
        for q in range(min(p + w, count - 1), p, -1):
            rest = minus_product(rest, get_matrix(matrix, place_of(count, w, p, q)), get(solution, q))
        put(solution, p, apply(get_matrix(matrix, place_of(count, w, p, p)), rest))


@kernel
def place_of_number(count, w, i, j):
    """Place of the number in row i and column j of a matrix of `count` rows of blocks."""
    return place_of(count, w, i // 3, j // 3) + 3 * (i % 3) + j % 3


@kernel
def factorize_definite(count, w, matrix):
    """Factorize a matrix entry by entry (modified), for pivots of any size; False if one is not positive.

    Inverting blocks by cofactors loses more accuracy if a line is far stiffer axially than laterally.
    """
    for k in range(3 * count):
        pivot, end = matrix[place_of_number(count, w, k, k)], min(3 * (k // 3 + w + 1), 3 * count)
        if not pivot > 0.0:
            return False
        for i in range(k + 1, end):
            factor = matrix[place_of_number(count, w, i, k)] / pivot
            matrix[place_of_number(count, w, i, k)] = factor
            for j in range(k + 1, end):
                matrix[place_of_number(count, w, i, j)] -= factor * matrix[place_of_number(count, w, k, j)]
    return True


@kernel
def solve_definite(count, w, matrix, right):
    """Solve with the factors of `factorize_definite`; the right-hand side (modified) becomes the solution."""
    for i in range(3 * count):
        for k in range(max(0, 3 * (i // 3 - w)), i):
            right[i] -= matrix[place_of_number(count, w, i, k)] * right[k]
    for i in range(3 * count - 1, -1, -1):
        for k in range(i + 1, min(3 * (i // 3 + w + 1), 3 * count)):
            right[i] -= matrix[place_of_number(count, w, i, k)] * right[k]
        right[i] /= matrix[place_of_number(count, w, i, i)]
