"""The drums in an iteration of a fixed step: the equation of `drum_in_backward_euler.py` for several drums at once.

The speed u of a drum is an unknown of its line. With the inner nodes condensed (`linear_algebra.condensed`), p and y theirs
with the ends held, and q the moves of the ends,

    u' - u = -(r + s F - T_x p - sum_e r_e q_e)/P,   P = dr/du - T_x y
    r_0 = -(1 + C_0,1) T_x,   r_n = -C_n,1 T_x,   with one segment r_0 = -T_x, r_n = T_x

so that what is left of the line on its free ends loses c r/P, with c the column of the drum left there. That is so of a drum
that turns in a direction s; one at a limit of its speed, and one that friction holds, have a given u'. Which of these it is
shows only in the solution. In the order of u' they are

    AT_LOWEST, INWARDS, HELD, OUTWARDS, AT_HIGHEST;    without friction AT_LOWEST, OUTWARDS, AT_HIGHEST

Each drum is sought as it turns now, and then one place nearer to where it was found, until all of them are found where they
were sought. If they are not after `MOST_TRIES`, the speeds that were found last are taken: no convergence.
"""

from ..compilation import kernel, view
from ..equations.assembly import node_masses
from ..equations.boundary import hold_ends, load_during
from ..equations.drum import HELD, INWARDS, OUTWARDS
from ..equations.lines import (
    add_at,
    clear,
    is_at_point,
    lines_of,
    load_at,
    motion_of,
    point_at,
    points_of,
    rows_of,
    segments_of,
    size_of_blocks,
)
from ..equations.node_loads import free_acceleration
from ..line import backward_euler
from ..line import drum_in_backward_euler as of_one
from ..linear_algebra import condensed
from ..linear_algebra.matrices import outer, transposed_apply
from ..linear_algebra.point_blocks import add_to_block
from ..linear_algebra.vectors import add_scaled, dot, get, put, scale
from .system_fixed_room import (
    CHANGE,
    IS_FOUND,
    ONWARD,
    SOUGHT,
    SPEED,
    WAY,
    attempt_of,
    is_turning,
    room_in_fixed_steps,
    scratch_of,
    trial_of_line,
)
from .system_room import moves

MOST_TRIES = 8  # at ways in which the drums are found in an iteration
AT_LOWEST, AT_HIGHEST, GIVEN = -2.0, 2.0, 3.0  # beside the directions of `equations/drum.py`; GIVEN: at any other speed

# --- the equations of a line


@kernel
def form_column(system, k, step):
    """-dg/du of the drum of line k into its column (modified)."""
    attempt, room, points = attempt_of(system, k, step), room_in_fixed_steps(system, k), points_of(system)
    w, column, n, end_of_step = room.stages.chain, room.column, segments_of(system, k), step.time + step.h
    of_one.begin_column(attempt, w, column)
    for end in range(2):
        if is_at_point(system, k, end):
            point = point_at(system, k, end)
            of_one.add_load(attempt, n * end, points.mass[point], load_at(system, point, end_of_step), w, column)
        elif end == 1 and attempt.conditions.last == n:
            of_one.add_load(attempt, n, w.mass[n], load_during(attempt.conditions, end_of_step), w, column)
    of_one.add_pulls(attempt, w, column)
    hold_ends(attempt.conditions, column)


@kernel
def row_of(system, k, end, by_position):
    """r_e of the drum of line k at one of its ends [N/m]; by_position : T_x [N/m]."""
    n, columns = segments_of(system, k), room_in_fixed_steps(system, k).columns
    if n == 1:
        return by_position if end == 1 else scale(-1.0, by_position)
    beside = transposed_apply(by_position, condensed.block_beside(n, 0, condensed.columns_of(n, end, columns)))
    return scale(-1.0, beside if end == 1 else add_scaled(beside, 1.0, by_position))


@view
def equation_of(system, k, step):
    """`Border` of the drum of line k, P [N s/m], and T + T_x p [N]: its inner nodes are condensed."""
    attempt, room, rows = attempt_of(system, k, step), room_in_fixed_steps(system, k), rows_of(system, k)
    w = room.stages.chain
    border = of_one.border_of(attempt, trial_of_line(system, k, step).drum, w)
    pivot = of_one.pivot_of(border, dot(border.by_position, condensed.first_difference(rows, room.column)))
    return border, pivot, border.tension + dot(border.by_position, condensed.first_difference(rows, w.move))


@kernel
def place_drum(system, k, step, points):
    """Part of the drum of line k of the matrix and the right-hand side of the points (modified), as it is sought."""
    n, room, trial = segments_of(system, k), room_in_fixed_steps(system, k), trial_of_line(system, k, step)
    numbers, column = room.numbers, room.column
    speed, way = numbers[SPEED], numbers[WAY]
    turns = abs(way) == OUTWARDS
    border, pivot, tension = equation_of(system, k, step)
    change = numbers[SOUGHT] - speed
    if turns:
        change = -(of_one.residual_of(trial, speed, tension) + way * trial.drum.friction) / pivot
    for row_end in range(2):
        if is_at_point(system, k, row_end):
            row, left = point_at(system, k, row_end), get(column, n * row_end)
            add_at(points.right, row, scale(change, left))
            for column_end in range(2):
                if turns and is_at_point(system, k, column_end):
                    block = outer(scale(-1.0 / pivot, left), row_of(system, k, column_end, border.by_position))
                    add_to_block(*size_of_blocks(system), row, point_at(system, k, column_end), block, points.matrix)


# --- how a drum is found


@kernel
def way_at(speed, lowest, highest, friction):
    """Which way a drum with a speed [m/s] and friction [N] goes whose speed is from the lowest to the highest one [m/s]."""
    if speed <= lowest:
        return AT_LOWEST
    if speed >= highest:
        return AT_HIGHEST
    if friction == 0.0:
        return OUTWARDS
    if speed == 0.0:
        return HELD
    return OUTWARDS if speed > 0.0 else INWARDS


@kernel
def nearer(way, found, lowest, highest, friction):
    """The next way on from one way to that which was found; ways without a speed from the lowest to the highest are none."""
    if found == way:
        return way
    if friction == 0.0 or lowest >= 0.0:
        return found if way == OUTWARDS else OUTWARDS
    if highest <= 0.0:
        return found if way == INWARDS else INWARDS
    return way + 1.0 if found > way else way - 1.0


@kernel
def speed_on(way, lowest, highest):
    """Speed [m/s] of a drum that goes a way on which it is given."""
    if way == AT_LOWEST:
        return lowest
    return highest if way == AT_HIGHEST else 0.0


@kernel
def seek(system, step, is_given):
    """Let all drums (modified) be sought as they turn now, or at the speeds that they have."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers, trial = room_in_fixed_steps(system, k).numbers, trial_of_line(system, k, step)
            limits = trial.lowest, trial.highest
            way = GIVEN if is_given else way_at(numbers[SPEED], *limits, trial.drum.friction)
            numbers[WAY], numbers[SOUGHT] = way, numbers[SPEED] if is_given else speed_on(way, *limits)
            numbers[ONWARD], numbers[IS_FOUND] = numbers[SPEED], 1.0


@kernel
def find_drum(system, k, step, points):
    """u' of the drum of line k (modified) from the moves of the points; whether it is found as it was not sought.

    Where the line meets no free point u' does not depend on how it was sought.
    """
    room, trial = room_in_fixed_steps(system, k), trial_of_line(system, k, step)
    numbers, chain = room.numbers, attempt_of(system, k, step).chain
    border, pivot, tension = equation_of(system, k, step)
    for end in range(2):
        if is_at_point(system, k, end):
            tension += dot(row_of(system, k, end, border.by_position), get(points.right, point_at(system, k, end)))
    speed, way, friction = numbers[SPEED], numbers[WAY], trial.drum.friction
    wanted = speed - of_one.residual_of(trial, speed, tension) / pivot
    onward, farthest = of_one.speed_after(chain, trial, speed, wanted, pivot), of_one.farthest_change(chain, step.h)
    limits = max(trial.lowest, speed - farthest), min(trial.highest, speed + farthest)
    found = way_at(onward, *limits, friction)
    is_other = found != way and (is_at_point(system, k, 0) or is_at_point(system, k, 1))
    numbers[ONWARD], numbers[WAY] = onward, nearer(way, found, *limits, friction)
    numbers[SOUGHT], numbers[IS_FOUND] = speed_on(numbers[WAY], *limits), 0.0 if is_other else 1.0
    return is_other


@kernel
def find_drums(system, step):
    """`find_drum` of all drums (modified); how many are found as they were not sought."""
    points, others = points_of(system), 0
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            others += find_drum(system, k, step, points)
    return others


@kernel
def give(system, step):
    """Let all drums (modified) be sought at the speeds that were found last."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers = room_in_fixed_steps(system, k).numbers
            numbers[WAY], numbers[SOUGHT] = GIVEN, numbers[ONWARD]


# --- after it


@kernel
def sum_masses(system):
    """Masses of the free points [kg] (modified) from the end masses of their lines."""
    points = points_of(system)
    clear(points.mass)
    for k in range(lines_of(system)):
        if moves(system, k):
            for end in range(2):
                if is_at_point(system, k, end):
                    points.mass[point_at(system, k, end)] += scratch_of(system, k).mass[segments_of(system, k) * end]


@kernel
def fly_points(system, step):
    """Free flight of the free points, with their loads, into the scratch space of their lines (modified)."""
    points, h = points_of(system), step.h
    for k in range(lines_of(system)):
        for end in range(2):
            if is_at_point(system, k, end):
                point, node = point_at(system, k, end), segments_of(system, k) * end
                attempt, free = attempt_of(system, k, step), scratch_of(system, k).free
                x, v = motion_of(system, k)
                flight = backward_euler.flight(get(x, node), get(v, node), h, free_acceleration(attempt.chain))
                put(free, node, add_scaled(flight, h * h / points.mass[point], load_at(system, point, step.time + h)))


@kernel
def turn(system, step):
    """Let all drums (modified) have the speeds that were found, and the masses follow."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers = room_in_fixed_steps(system, k).numbers
            numbers[CHANGE] = numbers[ONWARD] - numbers[SPEED]
            numbers[SPEED] = numbers[ONWARD]
            attempt, w, (x, _) = attempt_of(system, k, step), scratch_of(system, k), motion_of(system, k)
            node_masses(attempt.chain, w.mass)
            backward_euler.fly_kite(attempt, step.time, x, w)
    sum_masses(system)
    fly_points(system, step)


@kernel
def move_along(system, k):
    """Add what the change of the speed of the drum of line k moves its inner nodes by to their move (modified)."""
    room, rows = room_in_fixed_steps(system, k), rows_of(system, k)
    move, change = room.stages.chain.move, room.numbers[CHANGE]
    for i in range(3 * rows.first, 3 * rows.last + 3):
        move[i] += change * room.column[i]


@kernel
def unconverged_drums(system, step):
    """Number of drums that are not found, or pay out more in the last iteration than each node of their lines may move."""
    count = 0
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            room = room_in_fixed_steps(system, k)
            moved = step.h * abs(room.numbers[CHANGE])
            count += not (moved <= segments_of(system, k) * room.goal[0] and room.numbers[IS_FOUND] == 1.0)
    return count
