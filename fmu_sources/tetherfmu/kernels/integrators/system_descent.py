"""The descent of a system in a fixed step: all lines and free points at once, bounded as that of a single tether.

The incremental potential is the sum of those of the lines, see `backward_euler.py`. A free point moves by one free flight,
with the load and the mass of the whole point; each line has that of its own half segment there, so that

    sum_k m_k |x - y|^2/(2 h^2) = M |x - y|^2/(2 h^2),   y = x0 + h v0 + h^2 (gravity + load/M),   M = sum_k m_k

An iteration is one of Newton's method for all nodes, with the inner nodes of each line condensed as in `system_step.py`. A
shorter one is taken of all lines together, and all of them come to rest before it ends. The matrices are positive definite,
and so is what is left of them at the points.
"""

from collections import namedtuple
from math import inf

from tetherfmu.runtime import system_layout as places

from ..arrays import behind, copy
from ..compilation import kernel, part, view
from ..equations.assembly import longest_part
from ..equations.boundary import chain_during, hold_ends
from ..equations.lines import (
    CONDITIONS,
    add_at,
    band_of,
    clear,
    conditions_of,
    free_points,
    lines_of,
    motion_of,
    point_at,
    points_of,
    room_of,
    segments_of,
)
from ..linear_algebra import condensed
from ..linear_algebra.points import add_block, factorize_band, solve_band
from ..linear_algebra.vectors import get, put
from . import backward_euler, second_order
from .backward_euler import MOST_HALVINGS
from .system_room import has_free_nodes, is_free

STUCK = -1.0  # instead of the part of a move that was taken: no part of it goes down

FixedRoom = namedtuple("FixedRoom", "stages columns goal")
FixedRoom.__doc__ = """Scratch arrays of a line in fixed steps.

stages : `second_order.Workspace`.  columns : of its ends, see `linear_algebra.condensed`.
goal : 1, the largest move of a node with which it has come to rest [m].
"""

Step = namedtuple("Step", "time h kind")
Step.__doc__ = """A step of all lines: its start [s] in the communication step, h [s], its kind (`backward_euler.start`)."""


@kernel
def line_work_size(n):
    """Length of what a line of n segments needs of `work`: an even number, as in `system_room.py`."""
    size = CONDITIONS + second_order.workspace_size(n) + condensed.columns_size(n) + 1
    return size + size % 2


@view
def room_in_fixed_steps(system, k):
    """`FixedRoom` of line k."""
    n, room = segments_of(system, k), behind(CONDITIONS, room_of(system, k))
    own, columns = second_order.workspace_size(n), condensed.columns_size(n)
    return FixedRoom(second_order.workspace(n, room), part(room, own, columns), part(room, own + columns, 1))


@view
def scratch_of(system, k):
    """`backward_euler.Workspace` of line k."""
    return room_in_fixed_steps(system, k).stages.chain


@view
def attempt_of(system, k, step):
    """`backward_euler.Attempt` of line k."""
    conditions = conditions_of(system, k)
    _, v = motion_of(system, k)
    return backward_euler.Attempt(conditions, chain_during(conditions, step.time + step.h), step.h, v)


# --- the potential and its minimum


@kernel
def potential(system, step, is_trial):
    """Phi [J] of all lines at the positions of the iteration, or at those to try, and its error of rounding [J]."""
    total, rounding = 0.0, 0.0
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            w = scratch_of(system, k)
            own, error = backward_euler.potential(attempt_of(system, k, step), w.trial if is_trial else w.x, w)
            total += own
            rounding += error
    return total, rounding


@kernel
def place_line(system, k, points):
    """Condense the matrix of line k to its free ends, and add it and its forces to those of the points (modified).

    False if it is singular.
    """
    n, w, columns = segments_of(system, k), scratch_of(system, k), room_in_fixed_steps(system, k).columns
    if not condensed.condense(n, is_free(system, k, 0), is_free(system, k, 1), w.matrix, columns):
        return False
    condensed.reduce(n, w.matrix, w.move)
    for row_end in range(2):
        row = point_at(system, k, row_end)
        if row != places.DRIVEN:
            add_at(points.right, row, get(w.move, n * row_end))
            for column_end in range(2):
                column = point_at(system, k, column_end)
                if column != places.DRIVEN:
                    block = condensed.condensed_block(n, row_end, column_end, w.matrix, columns)
                    add_block(band_of(system), row, column, block, points.matrix)
    return True


@kernel
def solve_points(system, points):
    """Solve the equations of the free points (modified); False if they are singular."""
    m, band = 3 * free_points(system), band_of(system)
    if not factorize_band(m, band, points.matrix, points.pivots):
        return False
    solve_band(m, band, points.matrix, points.pivots, points.right)
    return True


@kernel
def move_line(system, k, step, points):
    """Move of the nodes of line k [m] from that of the points into its scratch space; the part of it to try."""
    n, room, attempt = segments_of(system, k), room_in_fixed_steps(system, k), attempt_of(system, k, step)
    move = room.stages.chain.move
    hold_ends(attempt.conditions, move)
    for end in range(2):
        point = point_at(system, k, end)
        if point != places.DRIVEN:
            put(move, n * end, get(points.right, point))
    condensed.expand(n, is_free(system, k, 0), is_free(system, k, 1), room.columns, move)
    return longest_part(attempt.chain, move)


@kernel
def direction(system, step):
    """Move of all nodes [m] by Newton's method into the scratch space; the part to try, 0 where a matrix is singular."""
    points = points_of(system)
    clear(points.matrix)
    clear(points.right)
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            w = scratch_of(system, k)
            backward_euler.linearize(attempt_of(system, k, step), w.x, w)
            if not place_line(system, k, points):
                return 0.0
    if not solve_points(system, points):
        return 0.0
    taken = 1.0
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            taken = min(taken, move_line(system, k, step, points))
    return taken


@kernel
def descend(system, step, before):
    """One iteration of all lines (modified) from where Phi is `before` [J], see `backward_euler.descend`.

    Returns Phi [J] and the part of the move that was taken: STUCK, or inf where a matrix is singular.
    """
    taken = direction(system, step)
    return (before, inf) if taken == 0.0 else go_along(system, step, taken, before)


@kernel
def try_part(system, taken):
    """Positions to try (modified) after a part of the move."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            backward_euler.try_part(taken, scratch_of(system, k))


@kernel
def go_along(system, step, taken, before):
    """Move all lines (modified) by this part of the move, halved until Phi falls; results as those of `descend`."""
    for _ in range(MOST_HALVINGS + 1):
        try_part(system, taken)
        now, rounding = potential(system, step, True)
        if now <= before + rounding:
            take_trial(system)
            return now, taken
        taken *= 0.5
    return before, STUCK


@kernel
def take_trial(system):
    """Let the iteration (modified) have the positions to try."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            w = scratch_of(system, k)
            copy(w.trial, w.x)


@kernel
def is_restless(system, k, taken):
    """Whether this part of the last move leads a node of line k further than where it has come to rest."""
    room = room_in_fixed_steps(system, k)
    return taken * backward_euler.largest_move(segments_of(system, k), room.stages.chain) > room.goal[0]


@kernel
def restless_lines(system, taken):
    """Number of lines that have not come to rest."""
    count = 0
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            count += is_restless(system, k, taken)
    return count


@kernel
def holds(system, step):
    """Whether all springs still have the mode with which the matrix was made."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            w = scratch_of(system, k)
            if not backward_euler.holds(attempt_of(system, k, step).chain, w.x, w):
                return False
    return True
