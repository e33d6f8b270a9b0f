"""Ropes over sheaves within a communication step of the adaptive solver: over which rope runs, and what ends a piece.

A sheave without losses runs always. One with friction is held while the tensions on both sides are within the cone
1/E <= T_1/T_2 <= E, and begins to run where they leave it; it comes to rest where its speed gets 0. A portion that is as
short as its segments may be stops the sheaves at its ends (two-blocking): nodes take the momentum as at a drum that stops
(`stopped_drums.py`), and a sheave begins to run again where the rope pulls it the other way. Each of these ends a piece of
the step, see `pieces.py`.
"""

from ..compilation import kernel
from ..equations import winch
from ..equations.lines import (
    add_at,
    comes_from,
    goes_on,
    is_at_point,
    is_portion,
    lines_of,
    motion_of,
    point_at,
    points_of,
    put_reeling,
    segments_of,
    sheaves_of,
)
from ..equations.rope_at_sheave import IN, OUT
from ..line.drum_events import OVERLOAD
from ..linear_algebra import small_matrix
from ..linear_algebra.vectors import NEUTRAL, get, scale
from ..points import sheave_room as at_sheave
from ..points.sheave_pulls import column_at_point, has_friction, loss_at_stage, number_of
from ..points.sheave_room import (
    PULLED,
    array_at,
    is_running,
    numbers_at,
    runs_over,
    shared_of,
    shortest_of,
    winch_of,
)
from ..points.sheaves import hold_row, take_tensions
from ..points.system_room import integrator_of
from .rope_states import evaluate, hold

AT_STOP = 1e-9  # of the shortest length: a portion that is longer by less is as short as it may be
ROUNDS = 4  # in which it is sought over which sheaves rope runs, and two for each of them


@kernel
def is_short(system, k):
    """Whether portion k is as short as it may be at the start of a piece."""
    return numbers_at(system, k)[at_sheave.LENGTH_NOW] <= (1.0 + AT_STOP) * shortest_of(system, k)


@kernel
def may_run(system, k, sign):
    """Whether rope may run forwards (sign 1) or backwards (-1) over the sheave at the end of line k."""
    return not is_short(system, k if sign > 0.0 else k + 1)


@kernel
def has_to_stop(system, k):
    """Whether rope runs over the sheave at the end of line k from a portion that is as short as it may be."""
    speed = numbers_at(system, k)[at_sheave.SPEED]
    return speed != 0.0 and not may_run(system, k, 1.0 if speed > 0.0 else -1.0)


@kernel
def urge(system, k, sign):
    """Force [N] with which the sheave at the end of line k, which is held, is pulled forwards (1) or backwards (-1)."""
    numbers, loss = numbers_at(system, k), loss_at_stage(system, k)
    behind, ahead = numbers[at_sheave.TENSION_BEHIND], numbers[at_sheave.TENSION_AHEAD]
    if sign > 0.0:
        return ahead - behind - (loss - 1.0) * max(behind, 0.0)
    return behind - ahead - (loss - 1.0) * max(ahead, 0.0)


@kernel
def overload(system, k):
    """Force [N] beyond its friction with which the sheave at the end of line k begins to run."""
    numbers = numbers_at(system, k)
    return OVERLOAD * (abs(numbers[at_sheave.TENSION_BEHIND]) + abs(numbers[at_sheave.TENSION_AHEAD]))


@kernel
def set_running(system, k, sign):
    """Let rope run over the sheave at the end of line k (modified) in a direction, 0 for any."""
    numbers = numbers_at(system, k)
    numbers[at_sheave.RUNS], numbers[at_sheave.SIGN] = 1.0, sign


@kernel
def begin_directions(system):
    """Over which sheaves rope runs as far as their speeds say (modified); how many more it may begin to run over."""
    undecided = 0
    for k in range(lines_of(system)):
        if goes_on(system, k):
            speed = numbers_at(system, k)[at_sheave.SPEED]
            is_open = may_run(system, k, 1.0) and may_run(system, k, -1.0)
            if not has_friction(system, k) and (is_open or speed != 0.0):
                set_running(system, k, 0.0)
            elif speed != 0.0:
                set_running(system, k, 1.0 if speed > 0.0 else -1.0)
            else:
                hold(system, k)
                undecided += 1
    return undecided


@kernel
def change_directions(system, is_last):
    """Let sheaves that are pulled beyond their friction run, and hold those that would turn round; how many have changed."""
    changed = 0
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers = numbers_at(system, k)
            if not runs_over(system, k):
                margin = overload(system, k)
                for sign in (1.0, -1.0):
                    if may_run(system, k, sign) and urge(system, k, sign) > margin and not runs_over(system, k):
                        if not is_last:
                            set_running(system, k, sign)
                        changed += 1
            elif numbers[at_sheave.SPEED] == 0.0 and numbers[at_sheave.SIGN] * numbers[at_sheave.GAIN] < 0.0:
                hold(system, k)
                changed += 1
    return changed


@kernel
def stop_ropes(system, time):
    """Stop all sheaves that have to (modified), with the jumps of velocities of nodes and points (modified) that this is."""
    stops = 0
    for k in range(lines_of(system)):
        if goes_on(system, k):
            stops += has_to_stop(system, k)
    if stops == 0:
        return
    evaluate(system, time, time, False)
    count, (matrix, _, right, _, _) = sheaves_of(system), shared_of(system)
    small_matrix.set_to_zero(count, matrix)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            take_tensions(system, k, matrix, right)
            right[number_of(system, k)] = 0.0
            if not runs_over(system, k) or has_to_stop(system, k):
                hold_row(system, k, matrix, right)
                right[number_of(system, k)] = -numbers_at(system, k)[at_sheave.SPEED]
    if not small_matrix.solve(count, matrix, right):
        return
    for k in range(lines_of(system)):
        if is_portion(system, k):
            jump_inner(system, k, right)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers, change = numbers_at(system, k), right[number_of(system, k)]
            if is_at_point(system, k, 1):
                jump_point(system, k, change)
            if has_to_stop(system, k):
                hold(system, k)
                numbers[at_sheave.SPEED] = 0.0
            else:
                numbers[at_sheave.SPEED] += change


@kernel
def jump_inner(system, k, changes):
    """Let the inner nodes of portion k (modified) take the changes of the speeds of its sheaves [m/s]."""
    w, (_, v) = integrator_of(system, k), motion_of(system, k)
    for side in (IN, OUT):
        if comes_from(system, k) if side == IN else goes_on(system, k):
            change, col = changes[number_of(system, k - 1 if side == IN else k)], array_at(system, k, PULLED, side)
            for i in range(1, segments_of(system, k)):
                add_at(v, i, scale(change / w.stage_mass[i], get(col, i)))


@kernel
def jump_point(system, k, change):
    """Let the free point at the end of line k (modified, in all its lines) take a change of the speed of that sheave."""
    point = point_at(system, k, 1)
    jump = scale(change / points_of(system).stage_mass[point], column_at_point(system, k))
    for other in range(lines_of(system)):
        for end in range(2):
            if is_at_point(system, other, end) and point_at(system, other, end) == point:
                _, v = motion_of(system, other)
                add_at(v, segments_of(system, other) * end, jump)


@kernel
def take_reeling(system, k, time):
    """Let the length of portion k (modified) change by itself as far as no sheave beside it runs, from a time [s] on."""
    numbers, length = numbers_at(system, k), numbers_at(system, k)[at_sheave.LENGTH_NOW]
    if is_running(system, k):
        numbers[at_sheave.HAS_RUN] = 1.0
        put_reeling(system, k, (length, 0.0, 0.0, NEUTRAL, NEUTRAL))
    elif numbers[at_sheave.HAS_RUN] != 0.0:
        paid = winch_of(system, k)
        start = length - (winch.length_at(paid, time) - paid[0])
        put_reeling(system, k, (start, paid[1], paid[2], paid[3], paid[4]))


@kernel
def turn_ropes(system, time):
    """Find over which sheaves (modified) rope runs from a time [s] on."""
    begin_directions(system)
    stop_ropes(system, time)
    if begin_directions(system) > 0:
        rounds = ROUNDS + 2 * sheaves_of(system)
        for i in range(rounds):
            evaluate(system, time, time, False)
            if change_directions(system, i == rounds - 1) == 0:
                break
    for k in range(lines_of(system)):
        if is_portion(system, k):
            take_reeling(system, k, time)
