"""Initial guess of the descent in a fixed step: free flight or carried lines, whichever has the lower Phi.

Free flight over many segment lengths per step tears the chain apart; in a swinging chain, so does keeping its shape. Carried
lines follow their ends; free points follow the mean of their neighbours, with lines weighted by 1/length.
"""

from math import inf

from ..arrays import clear, copy
from ..compilation import kernel
from ..equations.boundary import chain_during
from ..equations.free_points import free_points, is_at_point, point_at
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of
from ..line import backward_euler
from ..line.strand_room import GOAL
from ..linear_algebra import profile
from ..linear_algebra.vectors import ZERO_VECTOR, get, scale, sub
from . import net
from .descent import EARLY, direction, go_along, potential, take_trial, try_part, unconverged_lines
from .fixed import take_masses
from .room import (
    REACHED,
    attempt_of,
    chain_reached,
    globals_of,
    has_rope,
    moves,
    numbers_of,
    scratch_of,
    unknowns_of,
)


@kernel
def start(system, step):
    """Fill all lines as `backward_euler.start`; the free flight of free ends includes their loads."""
    for k in range(lines_of(system)):
        if moves(system, k):
            attempt, (x, _) = attempt_of(system, k, step), motion_of(system, k)
            before = chain_during(conditions_of(system, k), step.time)
            if has_rope(system, k):
                before = chain_reached(system, k, step.time, REACHED)
            backward_euler.start(attempt, before, step.time, step.kind, x, scratch_of(system, k))
            numbers_of(system, k)[GOAL] = backward_euler.goal_of(attempt, step.kind)
    take_masses(system, step)


@kernel
def is_driven(system, k, end):
    """Whether the start (end 0) or the end (1) of line k is driven."""
    conditions = conditions_of(system, k)
    return conditions.last == conditions.n - 1 if end == 1 else conditions.first == 1


@kernel
def move_of_driven(system, k, end):
    """Displacement of the driven end of line k in the step [m]."""
    w, node = scratch_of(system, k), segments_of(system, k) * end
    x, _ = motion_of(system, k)
    return sub(get(w.free, node), get(x, node))


@kernel
def add_weight(system, k, whole):
    """Add line k to the equations of mean point displacements (modified); returns whether one of its points is driven."""
    weight = 1.0 / conditions_of(system, k).reeling[0]
    for end in range(2):
        if is_at_point(system, k, end):
            here = 3 * point_at(system, k, end)
            there = 3 * point_at(system, k, 1 - end) if is_at_point(system, k, 1 - end) else -1
            way = ZERO_VECTOR if there >= 0 else scale(weight, move_of_driven(system, k, 1 - end))
            for axis in range(3):
                profile.add_entry(whole.matrix, here + axis, here + axis, weight)
                if there >= 0:
                    profile.add_entry(whole.matrix, here + axis, there + axis, -weight)
                whole.right[here + axis] += way[axis]
    return not (is_at_point(system, k, 0) and is_at_point(system, k, 1))


@kernel
def carry_points(system, whole):
    """Displacements of the free points [m] (modified) when all lines are carried along; 0 if none is driven."""
    m, points = unknowns_of(system), 3 * free_points(system)
    if points == 0:
        return
    net.clear_matrix(system)
    clear(whole.right)
    held = 0
    for k in range(lines_of(system)):
        if moves(system, k):
            held += add_weight(system, k, whole)
    for i in range(points, m):
        profile.hold_row(whole.matrix, m, i)
    if held == 0 or not profile.factorize(whole.matrix, m):
        clear(whole.solution)
    else:
        profile.solve(whole.matrix, m, whole.right, whole.solution)


@kernel
def move_of_end(system, k, end, moved):
    """Displacement of an end of line k [m], carried along: with its point, by its own curve, or like the other end."""
    if is_at_point(system, k, end):
        return get(moved, point_at(system, k, end))
    if is_driven(system, k, end):
        return move_of_driven(system, k, end)
    return move_of_driven(system, k, 1 - end) if is_driven(system, k, 1 - end) else ZERO_VECTOR


@kernel
def carry(system, step):
    """Trial positions (modified) with all lines carried along; returns Phi [J] there."""
    whole = globals_of(system)
    carry_points(system, whole)
    for k in range(lines_of(system)):
        if moves(system, k):
            x, _ = motion_of(system, k)
            ways = move_of_end(system, k, 0, whole.solution), move_of_end(system, k, 1, whole.solution)
            backward_euler.carry_by(attempt_of(system, k, step), *ways, x, scratch_of(system, k))
    return potential(system, step, True)[0]


@kernel
def add_drag(system, step):
    """`backward_euler.add_drag` of all lines (modified) at the iterate."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            backward_euler.add_drag(attempt_of(system, k, step), w.x, w)


@kernel
def guess(system, step):
    """Initial positions of all lines (modified), in free flight or carried along; returns Phi [J] with the drag there."""
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
    """First iteration of all lines (modified) with the expected accelerations; see `descent.descend`.

    If no node moves beyond the convergence limit, Phi is not evaluated (inf). Otherwise, if Phi is lower with carried lines,
    the result is a new `guess`, and inf.
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
