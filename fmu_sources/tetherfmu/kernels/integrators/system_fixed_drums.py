"""The drums of a system in an iteration of a fixed step: `drum_in_backward_euler.py` for several drums at once.

The speed u of a drum is an unknown of its line. With the inner nodes condensed (`linear_algebra.condensed`), p and y theirs
with the ends held, and q the moves of the ends,

    u' - u = -(r + s F - T_x p - sum_e r_e q_e)/P,   P = dr/du - T_x y
    r_0 = -(1 + C_0,1) T_x,   r_n = -C_n,1 T_x,   with one segment r_0 = -T_x, r_n = T_x

so that what is left of the line on its free ends loses c r/P, with c the column of the drum left there. That is so of a drum
that turns in a direction s. One that friction or a stop holds, or that comes as far as it may in an iteration, has a given
u'. Which of these it is shows only in the solution: each drum is sought as it turns now, then as it was found, until all of
them are found as they were sought, or else with the speeds that were found last.
"""

from ..compilation import kernel, view
from ..equations.assembly import node_masses
from ..equations.boundary import hold_ends
from ..equations.drum import HELD, INWARDS, OUTWARDS
from ..equations.lines import (
    add_at,
    band_of,
    clear,
    lines_of,
    load_at,
    motion_of,
    point_at,
    points_of,
    segments_of,
)
from ..equations.node_loads import free_acceleration
from ..linear_algebra import condensed
from ..linear_algebra.matrices import outer, transposed_apply
from ..linear_algebra.points import add_block
from ..linear_algebra.vectors import ZERO_VECTOR, add_scaled, dot, get, put, scale
from . import drum_in_backward_euler as of_one
from .system_fixed_room import (
    CHANGE,
    ONWARD,
    SPEED,
    WAY,
    attempt_of,
    is_turning,
    room_in_fixed_steps,
    scratch_of,
    trial_of_line,
)
from .system_room import is_free, moves

MOST_TRIES = 4  # at ways in which the drums are found in an iteration

# --- the equations of a line


@kernel
def form_column(system, k, step):
    """-dg/du of the drum of line k into its column (modified)."""
    attempt, room, points = attempt_of(system, k, step), room_in_fixed_steps(system, k), points_of(system)
    w, column = room.stages.chain, room.column
    of_one.begin_column(attempt, w, column)
    for end in range(2):
        if is_free(system, k, end):
            point, node = point_at(system, k, end), segments_of(system, k) * end
            load = load_at(system, point, step.time + step.h)
            of_one.add_load(attempt, node, points.mass[point], load, w, column)
    of_one.add_pulls(attempt, w, column)
    hold_ends(attempt.conditions, column)


@kernel
def beside_start(n, a):
    """Vector of node 1 in an array of node vectors, if that is an inner node, else 0."""
    return get(a, 1) if n > 1 else ZERO_VECTOR


@kernel
def row_of(system, k, end, turning):
    """r_e of the drum of line k at one of its ends [N/m]; turning : T_x [N/m]."""
    n, columns = segments_of(system, k), room_in_fixed_steps(system, k).columns
    if n == 1:
        return turning if end == 1 else scale(-1.0, turning)
    beside = transposed_apply(turning, condensed.block_beside(n, 0, condensed.columns_of(n, end, columns)))
    return scale(-1.0, beside if end == 1 else add_scaled(beside, 1.0, turning))


@view
def equation_of(system, k, step):
    """`Border` of the drum of line k, P [N s/m], and T + T_x p [N]: its inner nodes are condensed."""
    attempt, room, n = attempt_of(system, k, step), room_in_fixed_steps(system, k), segments_of(system, k)
    w = room.stages.chain
    border = of_one.border_of(attempt, trial_of_line(system, k, step).drum, w)
    pivot = of_one.pivot_of(border, dot(border.turning, beside_start(n, room.column)))
    return border, pivot, border.tension + dot(border.turning, beside_start(n, w.move))


@kernel
def place_drum(system, k, step, points):
    """Part of the drum of line k of the matrix and the right-hand side of the points (modified), as it is sought."""
    n, room, trial = segments_of(system, k), room_in_fixed_steps(system, k), trial_of_line(system, k, step)
    numbers, column = room.numbers, room.column
    speed, way = numbers[SPEED], numbers[WAY]
    border, pivot, tension = equation_of(system, k, step)
    change = numbers[ONWARD] - speed
    if way != HELD:
        change = -(of_one.residual_of(trial, speed, tension) + way * trial.drum.friction) / pivot
    for row_end in range(2):
        row = point_at(system, k, row_end)
        if is_free(system, k, row_end):
            left = get(column, n * row_end)
            add_at(points.right, row, scale(change, left))
            for column_end in range(2):
                if way != HELD and is_free(system, k, column_end):
                    block = outer(scale(-1.0 / pivot, left), row_of(system, k, column_end, border.turning))
                    add_block(band_of(system), row, point_at(system, k, column_end), block, points.matrix)


# --- how a drum is found


@kernel
def way_of(trial, speed, wanted, pivot, farthest):
    """Direction in which a drum turns to the speed wanted without friction [m/s]; HELD if it comes to a given one."""
    drawn = abs(wanted) - trial.drum.friction / pivot
    onward = drawn if wanted > 0.0 else -drawn
    is_within = trial.lowest < onward < trial.highest and abs(onward - speed) < farthest
    if drawn < 0.0 or not is_within:
        return HELD
    return OUTWARDS if wanted > 0.0 else INWARDS


@kernel
def way_at(trial, speed):
    """Direction in which a drum with a speed [m/s] turns; HELD if friction or a stop holds it there."""
    if not trial.lowest < speed < trial.highest or (speed == 0.0 and trial.drum.friction > 0.0):
        return HELD
    return OUTWARDS if speed >= 0.0 else INWARDS


@kernel
def seek(system, step, is_held):
    """Let all drums (modified) be sought as they are now, or held at the speeds that they have."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers = room_in_fixed_steps(system, k).numbers
            numbers[WAY] = HELD if is_held else way_at(trial_of_line(system, k, step), numbers[SPEED])
            numbers[ONWARD] = numbers[SPEED]


@kernel
def find_drum(system, k, step, points):
    """u' of the drum of line k (modified) from the moves of the points; whether it is found as it was not sought.

    Where no end of the line is free u' does not depend on how it was sought.
    """
    room, trial = room_in_fixed_steps(system, k), trial_of_line(system, k, step)
    numbers, chain = room.numbers, attempt_of(system, k, step).chain
    border, pivot, tension = equation_of(system, k, step)
    for end in range(2):
        if is_free(system, k, end):
            tension += dot(row_of(system, k, end, border.turning), get(points.right, point_at(system, k, end)))
    speed, way, onward = numbers[SPEED], numbers[WAY], numbers[ONWARD]
    wanted = speed - of_one.residual_of(trial, speed, tension) / pivot
    numbers[WAY] = way_of(trial, speed, wanted, pivot, of_one.farthest_change(chain, step.h))
    numbers[ONWARD] = of_one.speed_after(chain, trial, speed, wanted, pivot)
    is_other = way != numbers[WAY] or (way == HELD and onward != numbers[ONWARD])
    return is_other and (is_free(system, k, 0) or is_free(system, k, 1))


@kernel
def find_drums(system, step):
    """`find_drum` of all drums (modified); how many are found in another way."""
    points, others = points_of(system), 0
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            others += find_drum(system, k, step, points)
    return others


@kernel
def hold(system, step):
    """Let all drums (modified) be sought at the speeds that were found last."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            room_in_fixed_steps(system, k).numbers[WAY] = HELD


# --- after it


@kernel
def sum_masses(system):
    """Masses of the free points [kg] (modified) from the end masses of their lines."""
    points = points_of(system)
    clear(points.mass)
    for k in range(lines_of(system)):
        if moves(system, k):
            for end in range(2):
                if is_free(system, k, end):
                    points.mass[point_at(system, k, end)] += scratch_of(system, k).mass[segments_of(system, k) * end]


@kernel
def fly_points(system, step):
    """Free flight of the free points, with their loads, into the scratch space of their lines (modified)."""
    points, h = points_of(system), step.h
    for k in range(lines_of(system)):
        for end in range(2):
            if is_free(system, k, end):
                point, node = point_at(system, k, end), segments_of(system, k) * end
                attempt, free = attempt_of(system, k, step), scratch_of(system, k).free
                x, v = motion_of(system, k)
                flight = add_scaled(add_scaled(get(x, node), h, get(v, node)), h * h, free_acceleration(attempt.chain))
                by_load = scale(h * h / points.mass[point], load_at(system, point, step.time + h))
                put(free, node, add_scaled(flight, 1.0, by_load))


@kernel
def turn(system, step):
    """Let all drums (modified) have the speeds that were found, and the masses follow."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers = room_in_fixed_steps(system, k).numbers
            numbers[CHANGE] = numbers[ONWARD] - numbers[SPEED]
            numbers[SPEED] = numbers[ONWARD]
            node_masses(attempt_of(system, k, step).chain, scratch_of(system, k).mass)
    sum_masses(system)
    fly_points(system, step)


@kernel
def move_along(system, k):
    """Add what the change of the speed of the drum of line k moves its inner nodes by to their move (modified)."""
    room = room_in_fixed_steps(system, k)
    move, change = room.stages.chain.move, room.numbers[CHANGE]
    for i in range(3, 3 * segments_of(system, k)):
        move[i] += change * room.column[i]


@kernel
def restless_drums(system, step):
    """Number of drums that pay out or reel in more in the last iteration than a node of each segment may move."""
    count = 0
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            room = room_in_fixed_steps(system, k)
            count += not step.h * abs(room.numbers[CHANGE]) <= segments_of(system, k) * room.goal[0]
    return count
