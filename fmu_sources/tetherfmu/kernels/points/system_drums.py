"""The drums of winches that turn in a Rosenbrock step: in the same system as their chains.

Length L and speed u of a drum (`equations/drum.py`) are unknowns beside x and v of its line, with the same coefficients:
p = U_L/d and U_u stand for L and u as q and V for x and v. Each segment has its share of L, so the matrix of a stage has a
border, the column c = F_u + d F_L of the forces and the row g = T_v + d T_x over the nodes of the first segment:

    (M/d - B - d K) q - c p = ...
    g (q_0 - q_1) + (m/d - f_u - d f_L) p = f + m (sum_j c_ij U_uj/h + r/d) - T_v r_v - f_u r + gamma_i h df/dt

with f = T - W - c u - F sign(u). The border costs one solution more for each matrix and one vector for each stage; what it
leaves on free points: `at_points.py`. The mass of a point grows with the length of each of its lines, and then takes part of
all forces there. See docs/models/numerics.md, "A drum in the same system".
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..arrays import clear
from ..compilation import kernel, view
from ..equations import assembly, segment
from ..equations.boundary import chain_during, chain_with
from ..equations.drum import balance
from ..equations.end_motion import acceleration_at, velocity_at
from ..equations.free_points import is_at_point, point_at, points_of, rows_of
from ..equations.ground import has_ground
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of
from ..equations.properties import point_mass, property_of, sees_reeling
from ..equations.rope_at_drum import feels_rope
from ..line import contact
from ..line.rodas4p import ALPHA, GAMMA, GAMMA_I, INERTIA, R_BY_GAMMA, STAGES, A, P, added_up
from ..linear_algebra import condensed
from ..linear_algebra.both_ends import get_node, get_two, lower_and_upper, put_two
from ..linear_algebra.matrices import get_matrix, transposed_apply
from ..linear_algebra.pairs import first
from ..linear_algebra.vectors import add, add_at, add_scaled, dot, get, put, put_at, scale, sub, vector_at
from . import rope_drums
from . import system_room as at_line
from .at_points import add_column, place_column, row_of
from .sheave_room import is_running, portion_at_start, portion_in_step
from .system_room import (
    drum_at,
    has_drum,
    integrator_of,
    length_of,
    moves,
    numbers_of,
    room_in_step,
    shares_of,
    turns,
    turns_with_rope,
)


@view
def chain_in_step(system, k, time):
    """The `Chain` of line k at a time [s] of the communication step, with a drum or a sheave at the stage."""
    conditions, numbers = conditions_of(system, k), numbers_of(system, k)
    if is_running(system, k):
        return portion_in_step(system, k)
    if has_drum(system, k):
        return chain_with(conditions, numbers[at_line.LENGTH], numbers[at_line.SPEED])
    return chain_during(conditions, time)


@view
def chain_at_start(system, k, time):
    """The `Chain` of line k at the start of the step, a time [s] of the communication step."""
    conditions = conditions_of(system, k)
    if is_running(system, k):
        return portion_at_start(system, k, time)
    if has_drum(system, k):
        return chain_with(conditions, *length_of(system, k))
    return chain_during(conditions, time)


@kernel
def begin_step(system, k):
    """Let the drum of line k (modified) begin a step with the length and the speed of its state; error estimates are 0."""
    numbers = numbers_of(system, k)
    numbers[at_line.LENGTH], numbers[at_line.SPEED] = length_of(system, k)
    numbers[at_line.SOLUTION] = numbers[at_line.INCREMENT] = 0.0


@kernel
def go_to_stage(system, k, stage, h):
    """L_i, u_i and r_i of the drum of line k (modified) at a stage; False if it has no length.

    The last stage finds L_i and u_i there.
    """
    numbers, speeds, (length, speed) = numbers_of(system, k), shares_of(system, k).speeds, length_of(system, k)
    numbers[at_line.REST] = added_up(GAMMA_I[stage] / GAMMA * speed, R_BY_GAMMA, stage, speeds)
    if stage < STAGES - 1:
        numbers[at_line.LENGTH] = length + h * added_up(ALPHA[stage] * speed, P, stage, speeds)
        numbers[at_line.SPEED] = added_up(speed, A, stage, speeds)
    return 0.0 < numbers[at_line.LENGTH] < inf


# --- the border


@view
def record_of(system, k):
    """Record of derivatives of the first segment of line k at the start of the step."""
    return assembly.record_of(0, segments_of(system, k), integrator_of(system, k).records)


@kernel
def pull_of(system, k, change, factor, move):
    """T_v change + factor T_x move [N] of vectors between the nodes of the first segment of line k."""
    record, by_position = record_of(system, k), vector_at(numbers_of(system, k), at_line.BY_POSITION)
    return record[segment.DAMPER] * dot(segment.direction_in(record), change) + factor * dot(by_position, move)


@kernel
def rate_of(system, k, time):
    """Explicit time derivative of f [N/s] of the drum of line k at a time [s]: of W and of the driven ends."""
    conditions, rate = conditions_of(system, k), -drum_at(system, k).force_rate
    if conditions.first == 1:
        moving, gaining = velocity_at(conditions.ground, time), acceleration_at(conditions.ground, time)
        rate -= pull_of(system, k, gaining, 1.0, moving)
    if conditions.n == 1 and conditions.last == 0:
        moving, gaining = velocity_at(conditions.kite, time), acceleration_at(conditions.kite, time)
        rate += pull_of(system, k, gaining, 1.0, moving)
    return rate


@kernel
def sum_forces(system, points):
    """Add the forces of all lines on the free points at the start of the step [N] to `points.right` (modified)."""
    for k in range(lines_of(system)):
        if moves(system, k):
            n, w = segments_of(system, k), integrator_of(system, k)
            for end in range(2):
                if is_at_point(system, k, end):
                    add_at(points.right, point_at(system, k, end), get_node(n, n * end, w.force))
            if turns_with_rope(system, k) and is_at_point(system, k, 0):
                push = scale(numbers_of(system, k)[at_line.STAGE_ACCELERATION], get(shares_of(system, k).border, 0))
                add_at(points.right, point_at(system, k, 0), push)


@kernel
def form_column(system, k, d, points):
    """Column c of the drum of line k, condensed, into its scratch space; points.right : forces on the points [N].

    F_L with the masses: that of a node grows with the length, and its F/m falls, of a point with all its lines.
    """
    n, conditions, w, b = segments_of(system, k), conditions_of(system, k), integrator_of(system, k), shares_of(system, k)
    (x, v), column, (length, _) = motion_of(system, k), room_in_step(system, k).column, length_of(system, k)
    growing = chain_with(conditions, length, 1.0)
    assembly.rate_from_reeling(growing, w.start_x, w.start_v, w.records, b.by_length)
    if has_ground(conditions.parameters):
        contact.add_rate(growing, x, v, w, b.by_length)
    clear(b.by_speed)
    assembly.add_rate_from_acceleration(growing, 1.0, x, w.records, b.by_speed)
    flows = feels_rope(conditions.parameters)
    if flows:
        rope_drums.add_to_column(system, k)
    for i in range(n + 1):
        mass, force, end = w.mass[i], get_node(n, i, w.force), 0 if i == 0 else 1
        if flows:
            force = add_scaled(force, numbers_of(system, k)[at_line.STAGE_ACCELERATION], get(b.border, i))
        if (i == 0 or i == n) and is_at_point(system, k, end):
            point = point_at(system, k, end)
            mass, force = points.mass[point], get(points.right, point)
        share = (w.mass[i] - point_mass(growing, i)) / (mass * length)
        put(b.by_length, i, add(get(b.by_length, i), scale(-share, force)))
        along = add_scaled(get(b.by_speed, i), d, get(b.by_length, i))
        put(column, i, add_scaled(along, 1.0 / d, get(b.border, i)) if flows else along)
    condensed.reduce(rows_of(system, k), w.matrix, column)


@kernel
def take_equation(system, k, time, d):
    """f_u, df/dt, g and P of the drum of line k, with its condensed column, into its numbers (modified); False: none."""
    conditions, drum, record = conditions_of(system, k), drum_at(system, k), record_of(system, k)
    (x, _), (length, _), numbers = motion_of(system, k), length_of(system, k), numbers_of(system, k)
    by_speed = -drum.damping
    if sees_reeling(conditions.parameters):
        stretched, _ = segment.geometry(sub(get(x, 1), get(x, 0)))
        by_speed -= record[segment.DAMPER] * stretched / length
    by_length = record[segment.SLOPE] * property_of(conditions, 0, at.SHARE)
    response = condensed.first_difference(rows_of(system, k), room_in_step(system, k).column)
    e = segment.direction_in(record)
    by_position = transposed_apply(e, get_matrix(record, segment.K))
    put_at(numbers, at_line.BY_POSITION, by_position)
    put_at(numbers, at_line.ROW, add_scaled(scale(record[segment.DAMPER], e), d, by_position))
    numbers[at_line.BY_SPEED], numbers[at_line.RATE] = by_speed, rate_of(system, k, time)
    numbers[at_line.PIVOT] = drum.mass / d - by_speed - d * by_length - pull_of(system, k, response, d, response)
    return 0.0 < numbers[at_line.PIVOT] < inf


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
            if feels_rope(conditions_of(system, k).parameters):
                if not rope_drums.take_equation(system, k, time, d):
                    return False
            elif not take_equation(system, k, time, d):
                return False
            place_column(system, k)
    return True


# --- a stage


@kernel
def subtract_rest(system, k):
    """Subtract F_u r of the drum of line k [N] from the right-hand side of a stage of the line (modified).

    From both ends at once: numbers are read as `rosenbrock.right_hand_side` has just written them, without a wait.
    """
    n, q, by_speed = segments_of(system, k), integrator_of(system, k).q, shares_of(system, k).by_speed
    rest = -numbers_of(system, k)[at_line.REST]
    for i in range((n + 1) // 2):
        put_two(q, i, n - i, add_scaled(get_two(q, i, n - i), rest, get_two(by_speed, i, n - i)))
    if n % 2 == 0:
        put(q, n // 2, add_scaled(get(q, n // 2), rest, get(by_speed, n // 2)))


@kernel
def solve_drum_with_rope(system, k, stage, h):
    """`solve_drum` of a drum that feels the rope that flows; `rope_drums.push_back` is done."""
    w, numbers = integrator_of(system, k), numbers_of(system, k)
    right = rope_drums.right_of_stage(system, k, stage, inertia_of_stage(system, k, stage), h)
    right -= numbers[at_line.BY_SPEED] * numbers[at_line.REST]
    right += condensed.inner_product(rows_of(system, k), shares_of(system, k).row, w.q)
    numbers[at_line.SOLUTION] = right / numbers[at_line.PIVOT]


@kernel
def inertia_of_stage(system, k, stage):
    """What the stages of the drum of line k before this one add up to for its inertia [m/s]."""
    _, speed = length_of(system, k)
    return added_up(GAMMA_I[stage] / GAMMA * speed / GAMMA, INERTIA, stage, shares_of(system, k).speeds)


@kernel
def solve_drum(system, k, stage, time, h):
    """p of a stage of the drum of line k (modified) but for what q of its ends adds; q of its inner nodes is solved."""
    n, w, numbers, record = segments_of(system, k), integrator_of(system, k), numbers_of(system, k), record_of(system, k)
    drum, chain = drum_at(system, k), chain_in_step(system, k, time)
    x_p, x_q = lower_and_upper(n, 0, w.stage_x)
    v_p, v_q = lower_and_upper(n, 0, w.stage_v)
    r_p, r_q = lower_and_upper(n, 0, w.r)
    length, e = segment.geometry(sub(first(x_q), first(x_p)))
    tension = segment.tension_of(chain, 0, w.modes[0], length, dot(e, sub(first(v_q), first(v_p))))
    inertia = inertia_of_stage(system, k, stage)
    still = record[segment.DAMPER] * dot(segment.direction_in(record), sub(first(r_q), first(r_p)))
    right = balance(drum, numbers[at_line.DIRECTION], tension, chain.reeling, time + ALPHA[stage] * h)
    others = drum.mass * inertia / h - still - numbers[at_line.BY_SPEED] * numbers[at_line.REST]
    right += others + GAMMA_I[stage] * h * numbers[at_line.RATE]
    difference = condensed.first_difference(rows_of(system, k), w.q)
    numbers[at_line.SOLUTION] = (right + pull_of(system, k, difference, GAMMA * h, difference)) / numbers[at_line.PIVOT]


@kernel
def add_left(system, k, end, left):
    """What is left of the right-hand side of a stage of line k at an end, with the part of its drum."""
    p, column = numbers_of(system, k)[at_line.SOLUTION], room_in_step(system, k).column
    return add_scaled(left, p, get(column, segments_of(system, k) * end))


@kernel
def turn_drum(system, k, stage, h):
    """Solution of a stage for the drum of line k, whose ends have theirs in w.q; that of the inner nodes gets its part."""
    numbers, q, d = numbers_of(system, k), integrator_of(system, k).q, GAMMA * h
    p = numbers[at_line.SOLUTION]
    for end in range(2):
        if is_at_point(system, k, end):
            p -= dot(row_of(system, k, end), get(q, segments_of(system, k) * end)) / numbers[at_line.PIVOT]
    add_column(system, k, p, q)
    increment = p - numbers[at_line.REST]
    shares_of(system, k).speeds[stage] = increment
    numbers[at_line.SOLUTION], numbers[at_line.INCREMENT] = p, increment
    if stage >= STAGES - 2:
        numbers[at_line.LENGTH] += d * p
        numbers[at_line.SPEED] += increment
