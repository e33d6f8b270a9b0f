"""Where the descent in a fixed step begins: with free flight, or with all lines carried along, whichever has the lower Phi.

A flight of many segment lengths in a step tears the chain; so does, where it swings, a chain that keeps its shape. Lines are
carried along by their ends, free points by the mean of their neighbours, where lines count by one over their lengths.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel
from ..equations.free_points import is_at_point, point_at, points_of
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of, state_of
from ..line import backward_euler
from ..linear_algebra.matrices import ZERO_MATRIX, add_to_diagonal
from ..linear_algebra.vectors import ZERO_VECTOR, add_at, get, scale, sub
from . import system_room as at_line
from .at_points import add_block
from .system_descent import EARLY, direction, go_along, potential, solve_points, take_trial, try_part, unconverged_lines
from .system_fixed_drums import take_masses
from .system_room import attempt_of, has_drum, moves, numbers_of, scratch_of


@kernel
def start(system, step):
    """Fill what `backward_euler.start` does of all lines; free ends have their loads in their free flight."""
    for k in range(lines_of(system)):
        if moves(system, k):
            attempt, (x, _) = attempt_of(system, k, step), motion_of(system, k)
            backward_euler.start(attempt, step.time, step.kind, x, scratch_of(system, k))
            numbers_of(system, k)[at_line.GOAL] = backward_euler.goal_of(attempt, step.kind)
    take_masses(system, step)


@kernel
def is_driven(system, k, end):
    """Whether the start (end 0) or the end (1) of line k is driven."""
    conditions = conditions_of(system, k)
    return conditions.last == conditions.n - 1 if end == 1 else conditions.first == 1


@kernel
def move_of_driven(system, k, end):
    """How far the driven end of line k moves in the step [m]."""
    w, node = scratch_of(system, k), segments_of(system, k) * end
    x, _ = motion_of(system, k)
    return sub(get(w.free, node), get(x, node))


@kernel
def add_weight(system, k, points):
    """Add line k to the equations of the mean moves of the free points (modified); whether one of its points is driven."""
    weight = 1.0 / (state_of(system, k)[at.LENGTH] if has_drum(system, k) else conditions_of(system, k).reeling[0])
    for end in range(2):
        if is_at_point(system, k, end):
            add_block(system, k, end, end, add_to_diagonal(ZERO_MATRIX, weight))
            if is_at_point(system, k, 1 - end):
                add_block(system, k, end, 1 - end, add_to_diagonal(ZERO_MATRIX, -weight))
            else:
                add_at(points.right, point_at(system, k, end), scale(weight, move_of_driven(system, k, 1 - end)))
    return not (is_at_point(system, k, 0) and is_at_point(system, k, 1))


@kernel
def carry_points(system, points):
    """Moves of the free points [m] (modified) when all lines are carried along; 0 if none is driven."""
    clear(points.matrix)
    clear(points.right)
    held = 0
    for k in range(lines_of(system)):
        if moves(system, k):
            held += add_weight(system, k, points)
    if held == 0 or not solve_points(system, points):
        clear(points.solution)


@kernel
def move_of_end(system, k, end, points):
    """Move of an end of line k [m], carried along: as its point, or as itself if it is driven, else as the other end."""
    if is_at_point(system, k, end):
        return get(points.solution, point_at(system, k, end))
    if is_driven(system, k, end):
        return move_of_driven(system, k, end)
    return move_of_driven(system, k, 1 - end) if is_driven(system, k, 1 - end) else ZERO_VECTOR


@kernel
def carry(system, step):
    """Positions to try (modified) to which all lines are carried along; Phi [J] there."""
    points = points_of(system)
    carry_points(system, points)
    for k in range(lines_of(system)):
        if moves(system, k):
            x, _ = motion_of(system, k)
            ways = move_of_end(system, k, 0, points), move_of_end(system, k, 1, points)
            backward_euler.carry_by(attempt_of(system, k, step), *ways, x, scratch_of(system, k))
    return potential(system, step, True)[0]


@kernel
def add_drag(system, step):
    """`backward_euler.add_drag` of all lines (modified) at the positions of the iteration."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            backward_euler.add_drag(attempt_of(system, k, step), w.x, w)


@kernel
def guess(system, step):
    """Positions to start from of all lines (modified): free, or carried along; Phi [J] there, with the drag there."""
    carried = carry(system, step)
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            copy(w.free, w.x)
    if carried < potential(system, step, False)[0]:
        take_trial(system)
    add_drag(system, step)
    return potential(system, step, False)[0]


@kernel
def begin_as_expected(system, step):
    """The first iteration of all lines (modified) with the accelerations that are expected; see `system_descent.descend`.

    Where no node moves by more than one that has converged Phi is not asked, and inf. Elsewhere, if Phi is lower with the
    lines carried along, the results are that of a new `guess` and inf.
    """
    for k in range(lines_of(system)):
        if moves(system, k):
            x, _ = motion_of(system, k)
            backward_euler.fly_as_expected(attempt_of(system, k, step), x, scratch_of(system, k))
    add_drag(system, step)
    taken = direction(system, step, EARLY)
    if taken > 0.0 and unconverged_lines(system, taken) == 0:
        try_part(system, taken)
        take_trial(system)
        return inf, taken
    phi, _ = potential(system, step, False)
    if taken > 0.0 and not carry(system, step) < phi:
        return go_along(system, step, taken, phi)
    return guess(system, step), inf
