"""Lines whose winches are controlled by force: their drums in a Rosenbrock step of all lines.

Length and speed of a drum are unknowns of its line, as in `drum_step.py`: p for the length, with the column c of the forces
and the row g over the nodes of the first segment,

    A q - c p = b,   g (q_0 - q_1) + (m/d - f_u - d f_L) p = f,   g = T_v + d T_x

With the inner rows condensed (`linear_algebra.condensed`), q_1 = (A^-1 b)_1 - C_0,1 q_0 - C_n,1 q_n + p (A^-1 c)_1, and

    p = (f + g (A^-1 b)_1 - r_0 q_0 - r_n q_n)/pivot,   pivot = m/d - f_u - d f_L - g (A^-1 c)_1
    r_0 = g (1 + C_0,1),   r_n = g C_n,1,   with one segment r_0 = g, r_n = -g

so that what is left of the line on its free ends gets c r/pivot more, and the system of the points keeps its size. The mass
of a point grows with the length of each of its lines, and then takes part of all forces there.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..equations.drum import drum_of
from ..equations.lines import (
    add_at,
    conditions_of,
    is_at_point,
    lines_of,
    motion_of,
    point_at,
    points_of,
    rows_of,
    segments_of,
    size_of_blocks,
    state_of,
)
from ..line import drum_step, rosenbrock
from ..line.drum_step import (
    Border,
    border_of,
    chain_with,
    motion_at_stage,
    pivot_of,
    pull_of,
    put_in_column,
    put_rates,
    stage_rest,
)
from ..line.rodas4p import ALPHA, GAMMA
from ..linear_algebra import condensed
from ..linear_algebra.both_ends import get_node
from ..linear_algebra.matrices import outer, transposed_apply
from ..linear_algebra.point_blocks import add_to_block
from ..linear_algebra.vectors import NEUTRAL, add, add_scaled, dot, get, put_at, scale, vector_at
from .system_room import (
    BORDER,
    DIRECTION,
    INCREMENT,
    LENGTH_ERROR,
    NEW_LENGTH,
    NEW_SPEED,
    PIVOT,
    SOLUTION,
    SPEED_ERROR,
    STAGE_LENGTH,
    STAGE_SPEED,
    has_drum,
    integrator_of,
    moves,
    turns,
)


@view
def drum_at(conditions):
    """`Drum` of a line with these conditions."""
    return drum_of(conditions.parameters, conditions.force, conditions.force_rate)


@kernel
def length_of(system, k):
    """Length [m] and speed [m/s] of the drum of line k at the start of the step."""
    state = state_of(system, k)
    return state[at.LENGTH], state[at.REELING]


@kernel
def reeling_in_step(system, k):
    """Coefficients of the unstretched length of line k as `winch.py` has them; a drum counts as held."""
    if has_drum(system, k):
        return state_of(system, k)[at.LENGTH], 0.0, 0.0, NEUTRAL
    return conditions_of(system, k).reeling


@view
def conditions_in_step(system, k):
    """`BoundaryConditions` of line k in a step; a drum counts as held."""
    return drum_step.with_reeling(conditions_of(system, k), reeling_in_step(system, k))


@kernel
def form_with_drum(system, k, time, h):
    """Matrix of a step of line k, whose drum turns, into its scratch space, see `drum_step.form`."""
    conditions, room = conditions_of(system, k), integrator_of(system, k)
    x, v = motion_of(system, k)
    drum_step.form(conditions, chain_with(conditions, *length_of(system, k)), time, h, x, v, room.w)


@kernel
def start_stage_with_drum(system, k, stage, time, h):
    """Argument and forces of a stage of line k, whose drum turns, into its scratch space; False if it has no length."""
    conditions, room = conditions_of(system, k), integrator_of(system, k)
    length, speed = length_of(system, k)
    numbers, now = room.numbers, time + ALPHA[stage] * h
    rosenbrock.combine(stage, h, room.w)
    last = numbers[STAGE_LENGTH], numbers[STAGE_SPEED], numbers[SOLUTION], numbers[INCREMENT]
    length_i, speed_i = motion_at_stage(stage, h, length, speed, last, room.drum)
    if not 0.0 < length_i < inf:
        return False
    numbers[STAGE_LENGTH], numbers[STAGE_SPEED] = length_i, speed_i
    drum_step.place_stage(conditions, chain_with(conditions, length_i, speed_i), stage, now, room.w)
    return True


@view
def border_in(system, k, time):
    """`Border` and `Drum` of line k in a step that begins at a time [s]."""
    conditions, w = conditions_of(system, k), integrator_of(system, k).w
    drum, chain = drum_at(conditions), chain_with(conditions, *length_of(system, k))
    x, _ = motion_of(system, k)
    return border_of(conditions, drum, chain, time, x, w), drum


@kernel
def put_border(border, numbers):
    """Keep a `Border` for the stages of the step in the numbers of a drum (modified)."""
    numbers[BORDER], numbers[BORDER + 1], numbers[BORDER + 2] = border.by_speed, border.by_length, border.damper
    numbers[BORDER + 3] = border.rate
    put_at(numbers, BORDER + 4, border.by_position)
    put_at(numbers, BORDER + 7, border.direction)


@kernel
def border_at(numbers):
    """`Border` that `put_border` has kept."""
    by_position, direction = vector_at(numbers, BORDER + 4), vector_at(numbers, BORDER + 7)
    by_speed, by_length, damper, rate = numbers[BORDER], numbers[BORDER + 1], numbers[BORDER + 2], numbers[BORDER + 3]
    return Border(by_speed, by_length, by_position, damper, direction, rate)


# --- the matrix


@kernel
def sum_forces(system, points):
    """Add the forces of all lines on the free points at the start of the step [N] to `points.right` (modified)."""
    for k in range(lines_of(system)):
        if moves(system, k):
            n, w = segments_of(system, k), integrator_of(system, k).w
            for end in range(2):
                if is_at_point(system, k, end):
                    add_at(points.right, point_at(system, k, end), get_node(n, n * end, w.force))


@kernel
def form_column(system, k, d, points):
    """Column c of the drum of line k, condensed, into its scratch space; points.right : forces on the points [N]."""
    n, conditions, room = segments_of(system, k), conditions_of(system, k), integrator_of(system, k)
    chain, w = chain_with(conditions, *length_of(system, k)), room.w
    x, v = motion_of(system, k)
    put_rates(conditions, chain, x, v, room.drum)
    for i in range(n + 1):
        mass, force = w.mass[i], get_node(n, i, w.force)
        end = 0 if i == 0 else 1
        if (i == 0 or i == n) and is_at_point(system, k, end):
            point = point_at(system, k, end)
            mass, force = points.mass[point], get(points.right, point)
        put_in_column(chain, i, d, mass, force, room.drum)
    condensed.reduce(rows_of(system, k), w.matrix, room.drum.column)


@kernel
def row_of(system, k, end, border, d):
    """Row r of the drum of line k at one of its ends."""
    n, columns = segments_of(system, k), integrator_of(system, k).columns
    g = add_scaled(scale(border.damper, border.direction), d, border.by_position)
    if n == 1:
        return g if end == 0 else scale(-1.0, g)
    beside = transposed_apply(g, condensed.block_beside(n, 0, condensed.columns_of(n, end, columns)))
    return add(g, beside) if end == 0 else beside


@kernel
def place_border(system, k, time, d, points):
    """Pivot of the drum of line k, and its part of the matrix of the points (modified); False if it has no solution."""
    n, room = segments_of(system, k), integrator_of(system, k)
    border, drum = border_in(system, k, time)
    pivot = pivot_of(drum, border, d, condensed.first_difference(rows_of(system, k), room.drum.column))
    room.numbers[PIVOT] = pivot
    put_border(border, room.numbers)
    if not 0.0 < pivot < inf:
        return False
    for row_end in range(2):
        column_of_drum = scale(1.0 / pivot, get(room.drum.column, n * row_end))
        for column_end in range(2):
            if is_at_point(system, k, row_end) and is_at_point(system, k, column_end):
                row, column = point_at(system, k, row_end), point_at(system, k, column_end)
                block = outer(column_of_drum, row_of(system, k, column_end, border, d))
                add_to_block(*size_of_blocks(system), row, column, block, points.matrix)
    return True


@kernel
def place_drums(system, time, h):
    """Parts of the drums that turn of the matrix of the points (modified), once forces are known; False: no solution.

    points.right (modified) : the loads on the points [N].
    """
    points, d = points_of(system), GAMMA * h
    sum_forces(system, points)
    for k in range(lines_of(system)):
        if turns(system, k):
            form_column(system, k, d, points)
            if not place_border(system, k, time, d, points):
                return False
    return True


# --- a stage


@kernel
def reduce_line_with_drum(system, k, stage, time, h, points):
    """Right-hand side of a stage of line k, whose drum turns, condensed, and what is left in `points.right` (modified)."""
    n, conditions, room = segments_of(system, k), conditions_of(system, k), integrator_of(system, k)
    border, drum = border_at(room.numbers), drum_at(conditions)
    numbers, w, now = room.numbers, room.w, time + ALPHA[stage] * h
    _, speed = length_of(system, k)
    drum_step.reduced_side(conditions, stage, h, stage_rest(stage, speed, room.drum), room.drum)
    rows = rows_of(system, k)
    condensed.reduce(rows, w.matrix, w.q)
    chain = chain_with(conditions, numbers[STAGE_LENGTH], numbers[STAGE_SPEED])
    right = drum_step.drum_side(chain, drum, numbers[DIRECTION], border, stage, now, h, speed, room.drum)
    right += pull_of(border, GAMMA * h, condensed.first_difference(rows, w.q))
    numbers[SOLUTION] = right / numbers[PIVOT]
    for end in range(2):
        if is_at_point(system, k, end):
            left = add_scaled(get(w.q, n * end), numbers[SOLUTION], get(room.drum.column, n * end))
            add_at(points.right, point_at(system, k, end), left)


@kernel
def turn_drum(system, k, stage, h):
    """Solution of a stage for the drum of line k, whose ends have theirs in w.q; that of the inner nodes gets its part."""
    n, room = segments_of(system, k), integrator_of(system, k)
    border = border_at(room.numbers)
    numbers, q, d = room.numbers, room.w.q, GAMMA * h
    p, rows = numbers[SOLUTION], rows_of(system, k)
    for end in range(2):
        if is_at_point(system, k, end):
            p -= dot(row_of(system, k, end, border, d), get(q, n * end)) / numbers[PIVOT]
    for i in range(3 * rows.first, 3 * rows.last + 3):
        q[i] += p * room.drum.column[i]
    _, speed = length_of(system, k)
    increment = p - stage_rest(stage, speed, room.drum)
    room.drum.speeds[stage] = increment
    numbers[SOLUTION], numbers[INCREMENT] = p, increment


@kernel
def take_drum(system, k, h):
    """Result of a step for the drum of line k into its numbers: that of one which turns, or is held."""
    numbers = integrator_of(system, k).numbers
    if not turns(system, k):
        numbers[NEW_LENGTH], numbers[NEW_SPEED] = state_of(system, k)[at.LENGTH], 0.0
        numbers[LENGTH_ERROR] = numbers[SPEED_ERROR] = 0.0
        return
    moved = GAMMA * h * numbers[SOLUTION]
    numbers[NEW_LENGTH], numbers[NEW_SPEED] = numbers[STAGE_LENGTH] + moved, numbers[STAGE_SPEED] + numbers[INCREMENT]
    numbers[LENGTH_ERROR], numbers[SPEED_ERROR] = moved, numbers[INCREMENT]
