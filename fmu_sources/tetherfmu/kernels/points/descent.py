"""The descent in a fixed step: all lines and free points at once, bounded as `backward_euler.py` says.

The incremental potential is the sum of those of the lines. A free point moves by one free flight,
with the load and the mass of the whole point; each line has that of its own half segment there, so that

    sum_k m_k |x - y|^2/(2 h^2) = M |x - y|^2/(2 h^2),   y = x0 + h v0 + h^2 (gravity + load/M),   M = sum_k m_k

An iteration is one of Newton's method for all nodes, with the inner nodes of each line condensed as in `system_step.py`. A
shorter one is taken of all lines together, and all of them converge before it ends. The matrices are positive definite,
and so is what is left of them at the points.
"""

from math import inf, sqrt

from ..arrays import clear, copy
from ..compilation import kernel
from ..equations import flow, segment
from ..equations.assembly import longest_part
from ..equations.free_points import is_at_point, point_at, points_of, rows_of, size_of_blocks
from ..equations.ground import has_ground
from ..equations.lines import lines_of, parameters_of, segments_of
from ..equations.properties import rest_length
from ..equations.ropes import has_coordinates
from ..line import incremental_potential
from ..line.backward_euler import MOST_HALVINGS
from ..linear_algebra import condensed
from ..linear_algebra.point_blocks import factorize_blocks, solve_blocks
from ..linear_algebra.vectors import add_at, dot, get, sub
from . import fixed_sheaves, system_fixed_drums
from . import system_room as at_line
from .at_points import add_column, place_matrix, take_ends
from .system_room import attempt_of, is_turning, moves, numbers_of, room_in_step, scratch_of

# phases of an iteration: from LATE on drums only change their speeds where the lines converge with them, from HELD on the
# friction on the ground is that of the iteration before
EARLY, LATE, HELD = 0, 1, 2
STUCK = -1.0  # instead of the part of a move that was taken: no part of it goes down

# --- the potential and its minimum


@kernel
def does_any_flow(system, step):
    """Whether the rope of any line flows past its nodes: its forces are anew in each iteration."""
    count = 0
    for k in range(lines_of(system)):
        count += moves(system, k) and flow.flows(attempt_of(system, k, step).chain)
    return count > 0


@kernel
def potential(system, step, is_trial):
    """Phi [J] of all lines at the positions of the iteration, or at those to try, and its error of rounding [J]."""
    total, rounding = 0.0, 0.0
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            own, error = incremental_potential.potential(attempt_of(system, k, step), w.trial if is_trial else w.x, w)
            total += own
            rounding += error
    return total, rounding


@kernel
def condense_line(system, k, step, phase):
    """Matrix and forces of the iteration of line k, and of its drum, condensed to its points; False if it is singular.

    phase : EARLY, LATE or HELD.
    """
    w, room, rows = scratch_of(system, k), room_in_step(system, k), rows_of(system, k)
    incremental_potential.linearize(attempt_of(system, k, step), w.x, phase == HELD, w)
    if not condensed.condense(rows, w.matrix, room.columns):
        return False
    condensed.reduce(rows, w.matrix, w.move)
    if is_turning(system, k, step):
        system_fixed_drums.form_column(system, k, step)
        condensed.reduce(rows, w.matrix, room.column)
        system_fixed_drums.take_equation(system, k, step)
    return True


@kernel
def place_line(system, k, points):
    """Add what is left of line k at its free ends to the equations of the points (modified)."""
    w = scratch_of(system, k)
    place_matrix(system, k, w.matrix)
    for end in range(2):
        if is_at_point(system, k, end):
            add_at(points.right, point_at(system, k, end), get(w.move, segments_of(system, k) * end))


@kernel
def solve_points(system, points):
    """Solve the equations of the free points (modified); False if they are singular."""
    size = size_of_blocks(system)
    if not factorize_blocks(*size, points.matrix):
        return False
    solve_blocks(*size, points.matrix, points.right, points.solution)
    return True


@kernel
def move_points(system, step):
    """Moves of the free points [m] (modified), with drums as they are sought; False if the equations are singular."""
    points = points_of(system)
    clear(points.matrix)
    clear(points.right)
    for k in range(lines_of(system)):
        if moves(system, k):
            place_line(system, k, points)
            if is_turning(system, k, step):
                system_fixed_drums.place_drum(system, k, step, points)
    return solve_points(system, points)


@kernel
def move_with_drums(system, step):
    """`move_points` with the speeds of the drums (modified) that go with it."""
    system_fixed_drums.seek(system, step, False)
    for _ in range(system_fixed_drums.MOST_TRIES):
        if not move_points(system, step):
            return False
        if system_fixed_drums.find_drums(system, step) == 0:
            return True
    system_fixed_drums.give(system, step)
    return move_points(system, step)


@kernel
def move_line(system, k, step):
    """Move of the nodes of line k [m] from that of the points into its scratch space; the part of it to try."""
    move = scratch_of(system, k).move
    take_ends(system, k, move)
    if is_turning(system, k, step):
        add_column(system, k, numbers_of(system, k)[at_line.CHANGE], move)
    condensed.expand(rows_of(system, k), room_in_step(system, k).columns, move)
    return longest_part(attempt_of(system, k, step).chain, move)


@kernel
def move_lines(system, step):
    """`move_line` of all lines, with the speeds of their drums (modified) that were found: the part to try."""
    if step.turns:
        system_fixed_drums.turn(system, step)
    taken = 1.0
    for k in range(lines_of(system)):
        if moves(system, k):
            taken = min(taken, move_line(system, k, step))
    return taken


@kernel
def keep_moves(system, is_back):
    """Keep what is solved of the moves of all lines in the place of the positions to try, or take it back from there."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            if is_back:
                copy(w.trial, w.move)
            else:
                copy(w.move, w.trial)


@kernel
def move_with_drums_held(system, step):
    """The next move of all lines (modified) if no drum changes its speed: whether they converge with it, the part to try.

    Where they do, the move is forgotten, and what is solved of it is back in its place.
    """
    keep_moves(system, False)
    system_fixed_drums.seek(system, step, True)
    if move_points(system, step):
        taken = move_lines(system, step)
        if unconverged_lines(system, 1.0) > 0:
            return False, taken
    keep_moves(system, True)
    return True, 1.0


@kernel
def move_over_sheaves(system, step, phase):
    """Move of all nodes [m] and speeds of the ropes over sheaves (modified); the part to try, 0 where a matrix is singular.

    phase : EARLY, LATE or HELD.
    """
    if not move_points(system, step):
        return 0.0
    taken = move_lines(system, step)
    if not step.turns:
        return taken
    if phase >= LATE and unconverged_lines(system, 1.0) > 0:
        fixed_sheaves.hold_speeds(system, 0.0)
        return taken
    fixed_sheaves.find_sheaves(system, step)
    taken = 1.0
    for k in range(lines_of(system)):
        if moves(system, k):
            taken = min(taken, longest_part(attempt_of(system, k, step).chain, scratch_of(system, k).move))
    return taken


@kernel
def direction(system, step, phase):
    """Move of all nodes [m] by Newton's method into the scratch space; the part to try, 0 where a matrix is singular.

    phase : EARLY, LATE or HELD.
    """
    for k in range(lines_of(system)):
        if moves(system, k) and not condense_line(system, k, step, phase):
            return 0.0
    if has_coordinates(system):
        return move_over_sheaves(system, step, phase)
    if step.turns:
        if phase >= LATE:
            converges, taken = move_with_drums_held(system, step)
            if not converges:
                return taken
        return move_lines(system, step) if move_with_drums(system, step) else 0.0
    return move_lines(system, step) if move_points(system, step) else 0.0


@kernel
def descend(system, step, before, phase):
    """One iteration of all lines (modified) from where Phi is `before` [J], inf if it is not known.

    phase : EARLY, LATE or HELD.  Returns Phi [J] and the part of the move that was taken: STUCK, or inf where a matrix is
    singular.
    """
    taken = direction(system, step, phase)
    if taken == 0.0:
        return before, inf
    turned = fixed_sheaves.has_changed(system) if has_coordinates(system) else step.turns
    if turned or before == inf or has_ground(parameters_of(system, 0)) or does_any_flow(system, step):
        before, _ = potential(system, step, False)
    return go_along(system, step, taken, before)


@kernel
def try_part(system, taken):
    """Positions to try [m] (modified) after a part of the move."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            for i in range(len(w.move)):
                w.trial[i] = w.x[i] + taken * w.move[i]


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
        if moves(system, k):
            w = scratch_of(system, k)
            copy(w.trial, w.x)


@kernel
def is_unconverged(system, k, taken):
    """Whether this part of the last move leads a node of line k further than one moves in a line that has converged."""
    move, square = scratch_of(system, k).move, 0.0
    for i in range(segments_of(system, k) + 1):
        square = max(square, dot(get(move, i), get(move, i)))
    return taken * sqrt(square) > numbers_of(system, k)[at_line.GOAL]


@kernel
def unconverged_lines(system, taken):
    """Number of lines that have not converged."""
    count = 0
    for k in range(lines_of(system)):
        if moves(system, k):
            count += is_unconverged(system, k, taken)
    return count


@kernel
def holds(system, step):
    """Whether all springs still have the mode with which the matrix was made."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w, chain = scratch_of(system, k), attempt_of(system, k, step).chain
            for s in range(chain.n):
                r, rest = sub(get(w.x, s + 1), get(w.x, s)), rest_length(chain, s)
                if segment.beyond_rest(r, rest) * w.held[s] < 0.0:
                    return False
    return True


@kernel
def rests_on_ground(system, step):
    """Whether the ground carries and holds all nodes as in the last iteration."""
    for k in range(lines_of(system)):
        if moves(system, k) and has_ground(parameters_of(system, k)):
            w = scratch_of(system, k)
            if not incremental_potential.rests_on_ground(attempt_of(system, k, step), w.x, w):
                return False
    return True
