"""Lines condensed to their free points: what each leaves of its matrix there, and of the column of its drum.

A drum makes one unknown p more of its line, with the column c of the forces and a row g over the nodes of the first segment,

    A q - c p = b,   g (q_0 - q_1) + P' p = f

With the inner rows condensed (`linear_algebra.condensed`), q_1 = (A^-1 b)_1 - C_0,1 q_0 - C_n,1 q_n + p (A^-1 c)_1, and

    p = (f + g (A^-1 b)_1 - r_0 q_0 - r_n q_n)/P,   P = P' - g (A^-1 c)_1
    r_0 = g (1 + C_0,1),   r_n = g C_n,1,   with one segment r_0 = g, r_n = -g

so that what is left of the line on its free ends gets c r/P more, and the system of the points keeps its size.
"""

from ..compilation import kernel
from ..equations.boundary import hold_ends
from ..equations.free_points import is_at_point, point_at, points_of, rows_of, size_of_blocks
from ..equations.lines import conditions_of, parameters_of, segments_of
from ..equations.rope_at_drum import feels_rope
from ..linear_algebra import condensed
from ..linear_algebra.matrices import outer
from ..linear_algebra.point_blocks import add_to_block
from ..linear_algebra.vectors import get, put, scale, vector_at
from . import system_room as at_line
from .system_room import numbers_of, room_in_step


@kernel
def add_block(system, k, row_end, column_end, block):
    """Add a block that couples two ends of line k, which are free points, to the matrix of the points (modified)."""
    row, column = point_at(system, k, row_end), point_at(system, k, column_end)
    add_to_block(*size_of_blocks(system), row, column, block, points_of(system).matrix)


@kernel
def place_matrix(system, k, matrix):
    """Add what is left of the `Matrix` of line k, which is condensed, to the matrix of the points (modified)."""
    n, columns = segments_of(system, k), room_in_step(system, k).columns
    for row_end in range(2):
        for column_end in range(2):
            if is_at_point(system, k, row_end) and is_at_point(system, k, column_end):
                block = condensed.condensed_block(n, row_end, column_end, matrix, columns)
                add_block(system, k, row_end, column_end, block)


@kernel
def row_of(system, k, end):
    """Row r of the drum of line k at one of its ends."""
    if feels_rope(parameters_of(system, k)):
        return vector_at(numbers_of(system, k), at_line.ROW_AT_END if end == 1 else at_line.ROW_AT_START)
    g = vector_at(numbers_of(system, k), at_line.ROW)
    return condensed.row_at_end(segments_of(system, k), end, g, room_in_step(system, k).columns)


@kernel
def place_column(system, k):
    """Add what is left of the column of the drum of line k to the matrix of the points (modified)."""
    n, column, pivot = segments_of(system, k), room_in_step(system, k).column, numbers_of(system, k)[at_line.PIVOT]
    for row_end in range(2):
        left = scale(1.0 / pivot, get(column, n * row_end))
        for column_end in range(2):
            if is_at_point(system, k, row_end) and is_at_point(system, k, column_end):
                add_block(system, k, row_end, column_end, outer(left, row_of(system, k, column_end)))


@kernel
def add_column(system, k, factor, a):
    """Add a multiple of the column of the drum of line k to the inner rows of an array (modified)."""
    rows, column = rows_of(system, k), room_in_step(system, k).column
    for i in range(3 * rows.first, 3 * rows.last + 3):
        a[i] += factor * column[i]


@kernel
def take_ends(system, k, a):
    """Solution at the free points into the ends of line k in an array (modified); 0 where an end is driven."""
    hold_ends(conditions_of(system, k), a)
    for end in range(2):
        if is_at_point(system, k, end):
            put(a, segments_of(system, k) * end, get(points_of(system).solution, point_at(system, k, end)))
