"""Solve the equations of a step at the free points of a system: 3x3 blocks in a band, by elimination without pivots.

    A = L R,   L has unit blocks on its diagonal and F_qp = A_qp D_p^-1 below it, D_p is what is left of the block A_pp

as within a line (`block_tridiagonal.py`), whose inner nodes these could be. Points in a row, whose neighbours are the next
ones only, are solved there. The blocks of a diagonal stand one after the other, from the lowest of 2 w + 1 diagonals to the
highest; the points p - w .. p + w may be neighbours of p (`systems/ordering.py`). `points.py` has the method with pivots,
for matrices that may be anything, in three times the number of instructions.
Source: Golub and Van Loan, Matrix Computations, 4th ed., sections 3.2.10 (block elimination) and 4.3 (bands).
"""

from ..arrays import copy
from ..compilation import kernel, view
from ..flat_arrays import part
from . import block_tridiagonal
from .block_tridiagonal import inverse, is_regular, minus_product
from .matrices import add_matrices, apply, get_matrix, multiply, put_matrix, subtract
from .vectors import get, put


@kernel
def width_of(band):
    """w of a matrix whose band of numbers, in the plan of a system, is 3 w + 2."""
    return band // 3


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
    """Take the row p of blocks, whose D_p is inverted, out of those below it up to `last` (matrix modified)."""
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
