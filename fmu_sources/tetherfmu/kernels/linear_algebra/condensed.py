"""A block tridiagonal system condensed to its first and last rows, which other systems share.

    D_0 y_0 + U_0 y_1 = b_0,   L_i y_(i-1) + D_i y_i + U_i y_(i+1) = b_i,   L_n y_(n-1) + D_n y_n = b_n

The inner rows 1 .. n - 1 are factorized as in `block_tridiagonal.py`. With their matrix A and their columns at the ends,

    y = A^-1 b - C_0 y_0 - C_n y_n,   C_0 = A^-1 (L_1, 0, ..., 0),   C_n = A^-1 (0, ..., 0, U_(n-1))

the first and the last row become

    (D_0 - U_0 C_0,1) y_0 - U_0 C_n,1 y_n = b_0 - U_0 (A^-1 b)_1
    (D_n - L_n C_n,n-1) y_n - L_n C_0,n-1 y_0 = b_n - L_n (A^-1 b)_(n-1)

A prescribed end, with y = 0, has no columns. `columns` stores the 3x3 blocks of C_0, then those of C_n, with the blocks of
mirror rows packed (`both_ends.pack_blocks`). End 0 is the first row, end 1 the last. An unshared end may be an inner row,
and a line without shared ends condenses to nothing (`Rows`).
"""

from collections import namedtuple

from ..compilation import kernel, view
from ..flat_arrays import part
from .block_tridiagonal import factorize, solve
from .both_ends import get_packed_blocks, get_two, pack_blocks, put_two
from .matrices import ZERO_MATRIX, apply, get_matrix, multiply, put_matrix, scale_matrix, subtract, transposed_apply
from .pairs import broadcast, first, pair, second
from .vectors import add, get, put, scale, sub

Rows = namedtuple("Rows", "n first last start_is_shared end_is_shared")
Rows.__doc__ = """The rows 0 .. n: inner rows, which are solved for, are `first` .. `last`; none if first > last.

start_is_shared, end_is_shared : whether row 0, and row n, is shared with other systems; inner rows are then 1 .. n - 1."""


@kernel
def columns_size(n):
    """Length of the array `columns`."""
    return 2 * 9 * (n + 1)


@view
def columns_of(n, end, columns):
    """Columns of one end."""
    return part(columns, 9 * (n + 1) * end, 9 * (n + 1))


@kernel
def condense(rows, matrix, columns):
    """Factorize the inner rows of a `Matrix` and compute columns of its shared ends (both modified); False if singular."""
    if rows.first > rows.last:
        return True
    if not factorize(rows.first, rows.last, matrix):
        return False
    find_all_columns(rows, matrix, columns)
    return True


@kernel
def find_all_columns(rows, matrix, columns):
    """Columns of the shared ends (modified) of a `Matrix` whose inner rows are factorized."""
    n = rows.n
    if rows.start_is_shared:
        find_columns(n, pair(get_matrix(matrix.lower, 9), ZERO_MATRIX), matrix, columns_of(n, 0, columns))
    if rows.end_is_shared:
        find_columns(n, pair(ZERO_MATRIX, get_matrix(matrix.upper, 9 * (n - 1))), matrix, columns_of(n, 1, columns))


@kernel
def pass_inwards(n, right, matrix, blocks):
    """Right-hand side of the two middle rows, or the middle row twice, from the rows beside the ends; see `find_columns`."""
    _, lower, upper = matrix
    middle = n // 2
    if middle == 1:
        return right
    pack_blocks(blocks, 1, blocks, n - 1, right)
    for i in range(2, middle):
        right = scale_matrix(-1.0, multiply(get_packed_blocks(lower, i, upper, n - i), right))
        pack_blocks(blocks, i, blocks, n - i, right)
    loss = multiply(get_packed_blocks(lower, middle, upper, n - middle), right)
    return subtract(broadcast(ZERO_MATRIX, loss[0]), loss)


@kernel
def solve_middle(n, right, matrix):
    """Columns in the two middle rows, or in one twice, from their right-hand side, as a matrix of pairs."""
    diagonal, lower, upper = matrix
    middle, below = n // 2, n - n // 2
    if middle == below:
        both = subtract(first(right), scale_matrix(-1.0, second(right)))
        at_middle = multiply(get_matrix(diagonal, 9 * middle), both)
        return pair(at_middle, at_middle)
    at_middle = subtract(first(right), multiply(get_matrix(upper, 9 * middle), second(right)))
    at_middle = multiply(get_matrix(diagonal, 9 * middle), at_middle)
    at_below = subtract(second(right), multiply(get_matrix(lower, 9 * below), at_middle))
    return pair(at_middle, multiply(get_matrix(diagonal, 9 * below), at_below))


@kernel
def put_middle(n, two, blocks):
    """Write the columns in the middle to `blocks` (modified)."""
    middle, below = n // 2, n - n // 2
    if middle == below:
        put_matrix(blocks, 9 * middle, first(two))
    else:
        pack_blocks(blocks, middle, blocks, below, two)


@kernel
def find_columns(n, right, matrix, blocks):
    """Columns of an end into `blocks` (modified): A^-1 of `right` in the rows beside both ends, a matrix of pairs.

    Like `block_tridiagonal.solve`, with three right-hand sides at once.
    """
    diagonal, lower, upper = matrix
    two = solve_middle(n, pass_inwards(n, right, matrix, blocks), matrix)
    put_middle(n, two, blocks)
    for i in range(n // 2 - 1, 0, -1):
        rest = subtract(
            get_packed_blocks(blocks, i, blocks, n - i), multiply(get_packed_blocks(upper, i, lower, n - i), two)
        )
        two = multiply(get_packed_blocks(diagonal, i, diagonal, n - i), rest)
        pack_blocks(blocks, i, blocks, n - i, two)


@kernel
def block_beside(n, row_end, blocks):
    """Block of the columns `blocks` in the inner row beside an end."""
    if n == 2:
        return get_matrix(blocks, 9)
    both = get_packed_blocks(blocks, 1, blocks, n - 1)
    return second(both) if row_end == 1 else first(both)


@kernel
def whole_row_at_end(rows, end, row, columns):
    """Row of the condensed system at a shared end, from the row - sum row_i . y_i."""
    n, blocks = rows.n, columns_of(rows.n, end, columns)
    left = scale(-1.0, get(row, n * end))
    for i in range(1, (n + 1) // 2):
        both = transposed_apply(get_two(row, i, n - i), get_packed_blocks(blocks, i, blocks, n - i))
        left = add(left, add(first(both), second(both)))
    if n % 2 == 0:
        left = add(left, transposed_apply(get(row, n // 2), get_matrix(blocks, 9 * (n // 2))))
    return left


@kernel
def condensed_block(n, row_end, column_end, matrix, columns):
    """Block of the condensed system in the row of one end and the column of the same or the other end."""
    outer = 9 * n * row_end
    coupling = get_matrix(matrix.lower if row_end == 1 else matrix.upper, outer)
    own = get_matrix(matrix.diagonal, outer)
    if n == 1:
        return own if row_end == column_end else coupling
    loss = multiply(coupling, block_beside(n, row_end, columns_of(n, column_end, columns)))
    return subtract(own if row_end == column_end else ZERO_MATRIX, loss)


@kernel
def solve_inner(rows, matrix, b):
    """Solve the inner rows of a right-hand side (modified); other rows are unchanged."""
    if rows.first <= rows.last:
        solve(rows.first, rows.last, matrix, b)


@kernel
def what_is_left(n, end, matrix, b):
    """Right-hand side of the condensed system in the row of an end, after `solve_inner`."""
    if n == 1:
        return get(b, end)
    if end == 0:
        return sub(get(b, 0), apply(get_matrix(matrix.upper, 0), get(b, 1)))
    return sub(get(b, n), apply(get_matrix(matrix.lower, 9 * n), get(b, n - 1)))


@kernel
def expand(rows, columns, y):
    """Solution in the inner rows (modified) from the solution at the shared ends, after `solve_inner`."""
    n = rows.n
    if rows.start_is_shared:
        subtract_columns(n, columns_of(n, 0, columns), get(y, 0), y)
    if rows.end_is_shared:
        subtract_columns(n, columns_of(n, 1, columns), get(y, n), y)


@kernel
def subtract_columns(n, blocks, at_end, y):
    """Subtract the columns times the solution at their end from the inner rows (modified)."""
    both = broadcast(at_end, pair(0.0, 0.0))
    for i in range(1, (n + 1) // 2):
        put_two(y, i, n - i, sub(get_two(y, i, n - i), apply(get_packed_blocks(blocks, i, blocks, n - i), both)))
    if n % 2 == 0:
        put(y, n // 2, sub(get(y, n // 2), apply(get_matrix(blocks, 9 * (n // 2)), at_end)))
