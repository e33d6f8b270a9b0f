"""Ropes over sheaves and off drums within a communication step of the adaptive solver: which run, and what ends a piece.

A sheave without losses runs always. One with friction is held while the tensions on both sides are within the cone
1/E <= T_1/T_2 <= E, and begins to run where they leave it; it comes to rest where its speed gets 0. A portion that is as
short as its segments may be stops the sheaves at its ends (two-blocking): nodes take the momentum as at a drum that stops
(`stopped_drums.py`), and a sheave begins to run again where the rope pulls it the other way. Each of these ends a piece of
the step, see `pieces.py`.
"""

from ..arrays import clear
from ..compilation import kernel
from ..equations import winch
from ..equations.free_points import free_points, is_at_point, point_at, points_of
from ..equations.lines import hold_length, lines_of, motion_of, put_reeling, segments_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import is_rope, is_turned
from ..linear_algebra import small_matrix
from ..linear_algebra.vectors import add_at, get, scale
from ..points import sheave_room as at_sheave
from ..points.coordinates import (
    coordinate_at,
    count_of,
    growth_of,
    is_any_running,
    is_braked,
    is_drum,
    own_numbers,
    portions_of,
    runs,
    weight_of,
)
from ..points.running_drums import has_friction, urges
from ..points.sheave_pulls import column_of, loss_at_stage
from ..points.sheave_room import (
    PULLED,
    is_running,
    longest_of,
    numbers_at,
    part_of,
    parts_of,
    shared_of,
    shortest_of,
    single_at,
    winch_of,
)
from ..points.sheaves import hold_row, take_tensions
from ..points.system_room import integrator_of
from .rope_states import evaluate, hold

AT_STOP = 1e-9  # of the shortest length: a portion that is longer by less is as short as it may be
MOST_STARTS = 2  # of a sheave while it is sought over which of them rope runs


@kernel
def is_short(system, k):
    """Whether portion k is as short as it may be at the start of a piece."""
    return numbers_at(system, k)[at_sheave.LENGTH_NOW] <= (1.0 + AT_STOP) * shortest_of(system, k)


@kernel
def is_long(system, k):
    """Whether line k is as long as its drum may pay it out."""
    return is_turned(system, k) and numbers_at(system, k)[at_sheave.LENGTH_NOW] >= (1.0 - AT_STOP) * longest_of(system, k)


@kernel
def may_run(system, c, sign):
    """Whether a coordinate may run forwards (sign 1) or backwards (-1): no portion that changes is at a stop, no brake."""
    stops = 1 if is_braked(system, c) else 0
    for k in range(*portions_of(system, c)):
        growth = sign * growth_of(system, c, k)
        stops += (growth < 0.0 and is_short(system, k)) or (growth > 0.0 and is_long(system, k))
    return stops == 0


@kernel
def has_to_stop(system, c):
    """Whether a coordinate runs that may not."""
    speed = own_numbers(system, c)[at_sheave.SPEED]
    return speed != 0.0 and not may_run(system, c, 1.0 if speed > 0.0 else -1.0)


@kernel
def urges_now(system, c):
    """`running_drums.urges` with the tensions that are known."""
    numbers, loss = own_numbers(system, c), 1.0 if is_drum(system, c) else loss_at_stage(system, c)
    return urges(system, c, numbers[at_sheave.TENSION_BEHIND], numbers[at_sheave.TENSION_AHEAD], loss)


@kernel
def set_running(system, c, sign):
    """Let a coordinate (modified) run in a direction, 0 for any."""
    numbers = own_numbers(system, c)
    numbers[at_sheave.RUNS], numbers[at_sheave.SIGN] = 1.0, sign


@kernel
def begin_directions(system):
    """Which coordinates run as far as their speeds say (modified); how many more may begin to."""
    undecided = 0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        speed = own_numbers(system, c)[at_sheave.SPEED]
        is_open = may_run(system, c, 1.0) and may_run(system, c, -1.0)
        if not has_friction(system, c) and (is_open or speed != 0.0):
            set_running(system, c, 0.0)
        elif speed != 0.0:
            set_running(system, c, 1.0 if speed > 0.0 else -1.0)
        else:
            hold(system, c)
            undecided += 1
    return undecided


@kernel
def hold_what_turns_round(system):
    """Hold the coordinate that would turn round at once, the fastest one of them (modified); whether there is one."""
    found, most = -1, 0.0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if runs(system, c):
            numbers = own_numbers(system, c)
            back = -numbers[at_sheave.SIGN] * numbers[at_sheave.GAIN]
            if numbers[at_sheave.SPEED] == 0.0 and back > most:
                found, most = c, back
    if found >= 0:
        hold(system, found)
    return found >= 0


@kernel
def start_what_is_pulled(system):
    """Let the coordinate run that is pulled most beyond its friction (modified); whether there is one.

    Each is started no more than twice, in whatever direction.
    """
    found, most, way = -1, 0.0, 0.0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if not runs(system, c) and own_numbers(system, c)[at_sheave.STARTED] < MOST_STARTS:
            forwards, backwards, margin = urges_now(system, c)
            for sign, pulled in ((1.0, forwards), (-1.0, backwards)):
                if may_run(system, c, sign) and pulled > most * margin:
                    found, most, way = c, pulled / margin, sign
    if found >= 0:
        set_running(system, found, way)
        own_numbers(system, found)[at_sheave.STARTED] += 1.0
    return found >= 0


@kernel
def stop_ropes(system, time):
    """Stop all coordinates that have to (modified), with the jumps of velocities of nodes and points (modified)."""
    stops = 0
    for j in range(count_of(system)):
        stops += has_to_stop(system, coordinate_at(system, j))
    if stops == 0:
        return
    evaluate(system, time, time, False)
    count, (matrix, _, right, _, _) = count_of(system), shared_of(system)
    clear(matrix)
    for j in range(count):
        c = coordinate_at(system, j)
        take_tensions(system, c, time, matrix, right)
        right[j] = 0.0
        if not runs(system, c) or has_to_stop(system, c):
            hold_row(system, c, matrix, right)
            right[j] = -own_numbers(system, c)[at_sheave.SPEED]
    if not small_matrix.solve(count, matrix, right):
        return
    for k in range(lines_of(system)):
        if is_rope(system, k):
            jump_inner(system, k, right)
    for j in range(count):
        c, change = coordinate_at(system, j), right[j]
        numbers = own_numbers(system, c)
        jump_points(system, c, change)
        if has_to_stop(system, c):
            hold(system, c)
            numbers[at_sheave.SPEED] = 0.0
        else:
            numbers[at_sheave.SPEED] += change


@kernel
def change_at(system, k, side, changes):
    """What changes of the speeds of the coordinates are at an end of portion k [m/s]."""
    total = 0.0
    for j in range(count_of(system)):
        total += weight_of(system, coordinate_at(system, j), k, side) * changes[j]
    return total


@kernel
def jump_inner(system, k, changes):
    """Let the inner nodes of portion k (modified) take the changes of the speeds of its coordinates [m/s]."""
    w, (_, v) = integrator_of(system, k), motion_of(system, k)
    for side in (IN, OUT):
        change, col, parts = change_at(system, k, side, changes), single_at(system, k, PULLED), parts_of(system, k)
        for i in range(1, segments_of(system, k)):
            add_at(v, i, scale(change * part_of(parts, side, i) / w.stage_mass[i], get(col, i)))


@kernel
def jump_points(system, c, change):
    """Let the free points at a coordinate (modified, in all their lines) take a change of its speed [m/s]."""
    for point in range(free_points(system)):
        if is_drum(system, c) or point_at(system, c, 1) == point:
            jump = scale(change / points_of(system).stage_mass[point], column_of(system, c, point))
            for other in range(lines_of(system)):
                for end in range(2):
                    if is_at_point(system, other, end) and point_at(system, other, end) == point:
                        _, v = motion_of(system, other)
                        add_at(v, segments_of(system, other) * end, jump)


@kernel
def take_reeling(system, k, time):
    """Let the length of portion k (modified) change by itself as far as no coordinate runs there, from a time [s] on."""
    numbers, length = numbers_at(system, k), numbers_at(system, k)[at_sheave.LENGTH_NOW]
    if is_running(system, k):
        numbers[at_sheave.HAS_RUN] = 1.0
        hold_length(system, k, length)
    elif numbers[at_sheave.HAS_RUN] != 0.0:
        paid = winch_of(system, k)
        start = length - (winch.length_at(paid, time) - paid[0])
        put_reeling(system, k, winch.from_length(start, paid))


@kernel
def turn_ropes(system, time):
    """Find which coordinates (modified) run from a time [s] on."""
    begin_directions(system)
    stop_ropes(system, time)
    if begin_directions(system) > 0:
        for j in range(count_of(system)):
            own_numbers(system, coordinate_at(system, j))[at_sheave.STARTED] = 0.0
        if numbers_at(system, 0)[at_sheave.KNOWN] == 0.0 or is_any_running(system):
            evaluate(system, time, time, False)
        while hold_what_turns_round(system) or start_what_is_pulled(system):
            evaluate(system, time, time, False)
    for k in range(lines_of(system)):
        if is_rope(system, k):
            take_reeling(system, k, time)
