"""A block tridiagonal system condensed to its first and last rows, which other systems share.

    D_0 y_0 + U_0 y_1 = b_0,   L_i y_(i-1) + D_i y_i + U_i y_(i+1) = b_i,   L_n y_(n-1) + D_n y_n = b_n

The inner rows 1 .. n - 1 are factorized as in `block_tridiagonal.py`. With A of these, and their columns that meet the ends,

    y = A^-1 b - C_0 y_0 - C_n y_n,   C_0 = A^-1 (L_1, 0, ..., 0),   C_n = A^-1 (0, ..., 0, U_(n-1))

the first and the last row become

    (D_0 - U_0 C_0,1) y_0 - U_0 C_n,1 y_n = b_0 - U_0 (A^-1 b)_1
    (D_n - L_n C_n,n-1) y_n - L_n C_0,n-1 y_0 = b_n - L_n (A^-1 b)_(n-1)

An end that is prescribed, with y = 0, has no columns. `columns` has the 3x3 blocks of C_0, then those of C_n; the blocks of
mirror rows are packed (`both_ends.pack_blocks`). Ends are numbered: 0 the first row, 1 the last.
"""

from ..compilation import kernel, part, view
from .block_tridiagonal import factorize, solve
from .both_ends import get_packed_blocks, get_two, pack_blocks, put_two
from .matrices import ZERO_MATRIX, apply, get_matrix, multiply, put_matrix, scale_matrix, subtract
from .pairs import broadcast, first, pair, second
from .vectors import get, put, sub


@kernel
def columns_size(n):
    """Length of the array `columns`."""
    return 2 * 9 * (n + 1)


@view
def columns_of(n, end, columns):
    """Columns of one end."""
    return part(columns, 9 * (n + 1) * end, 9 * (n + 1))


@kernel
def condense(n, start_is_free, end_is_free, matrix, columns):
    """Factor the inner rows of a `Matrix` and find the columns of its free ends (both modified); False if it is singular."""
    if n == 1:
        return True
    if not factorize(1, n - 1, matrix):
        return False
    find_all_columns(n, start_is_free, end_is_free, matrix, columns)
    return True


@kernel
def find_all_columns(n, start_is_free, end_is_free, matrix, columns):
    """Columns of the free ends (modified) of a `Matrix` of two or more rows whose inner rows are factorized."""
    if start_is_free:
        find_columns(n, 0, get_matrix(matrix.lower, 9), matrix, columns_of(n, 0, columns))
    if end_is_free:
        find_columns(n, 1, get_matrix(matrix.upper, 9 * (n - 1)), matrix, columns_of(n, 1, columns))


@kernel
def find_columns(n, end, coupling, matrix, blocks):
    """Columns of an end into `blocks` (modified): A^-1 of the block `coupling` in the row beside it.

    As `block_tridiagonal.solve` does it, with a right-hand side of three columns at once.
    """
    diagonal, lower, upper = matrix
    middle, below = n // 2, n - n // 2
    right = scale_matrix(pair(1.0 - end, 1.0 * end), broadcast(coupling, pair(0.0, 0.0)))
    at_middle, at_below = first(right), second(right)
    if middle > 1:
        pack_blocks(blocks, 1, blocks, n - 1, right)
        for i in range(2, middle):
            right = scale_matrix(-1.0, multiply(get_packed_blocks(lower, i, upper, n - i), right))
            pack_blocks(blocks, i, blocks, n - i, right)
        loss = multiply(get_packed_blocks(lower, middle, upper, below), right)
        at_middle, at_below = subtract(ZERO_MATRIX, first(loss)), subtract(ZERO_MATRIX, second(loss))
    if middle == below:
        at_middle = multiply(get_matrix(diagonal, 9 * middle), subtract(at_middle, scale_matrix(-1.0, at_below)))
        at_below = at_middle
        put_matrix(blocks, 9 * middle, at_middle)
    else:
        at_middle = subtract(at_middle, multiply(get_matrix(upper, 9 * middle), at_below))
        at_middle = multiply(get_matrix(diagonal, 9 * middle), at_middle)
        at_below = subtract(at_below, multiply(get_matrix(lower, 9 * below), at_middle))
        at_below = multiply(get_matrix(diagonal, 9 * below), at_below)
        pack_blocks(blocks, middle, blocks, below, pair(at_middle, at_below))
    two = pair(at_middle, at_below)
    for i in range(middle - 1, 0, -1):
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
def condensed_block(n, row_end, column_end, matrix, columns):
    """Block of the condensed system in the row of one end and the column of the same end or of the other one."""
    outer = 9 * n * row_end
    coupling = get_matrix(matrix.lower if row_end == 1 else matrix.upper, outer)
    own = get_matrix(matrix.diagonal, outer)
    if n == 1:
        return own if row_end == column_end else coupling
    loss = multiply(coupling, block_beside(n, row_end, columns_of(n, column_end, columns)))
    return subtract(own if row_end == column_end else ZERO_MATRIX, loss)


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
    if start_is_free:
        subtract_columns(n, columns_of(n, 0, columns), get(y, 0), y)
    if end_is_free:
        subtract_columns(n, columns_of(n, 1, columns), get(y, n), y)


@kernel
def subtract_columns(n, blocks, at_end, y):
    """Subtract from the inner rows (modified) what columns make of the solution at their end."""
    both = broadcast(at_end, pair(0.0, 0.0))
    for i in range(1, (n + 1) // 2):
        put_two(y, i, n - i, sub(get_two(y, i, n - i), apply(get_packed_blocks(blocks, i, blocks, n - i), both)))
    if n % 2 == 0:
        put(y, n // 2, sub(get(y, n // 2), apply(get_matrix(blocks, 9 * (n // 2)), at_end)))
