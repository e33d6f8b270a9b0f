"""Drums that feel the rope that flows (`equations/rope_at_drum.py`), in a Rosenbrock step and in outputs.

    m_i v_i' - col_i u' = F_i,   T + T^2/(2 EA) + I u' - sum col_i . v_i' = R_0,   T = W + m u'

All v_i' depend on u' alone, and so accelerations are explicit. With M the derivatives of the left-hand sides by (v', u'), a
stage has M_0 (v', u') of its argument, with M_0 of the start of the step, as right-hand side, and the derivatives of F, f at
constant v', u'. So the border of the matrix (`system_drums.py`) is the column c = F_u + d F_L + col/d and the row over all
nodes R_v + d R_x + col/d.
"""

from math import sqrt

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel
from ..equations import rope_at_drum as rope
from ..equations import segment
from ..equations.boundary import chain_moving, chain_with
from ..equations.drum import force_at
from ..equations.end_motion import acceleration_at, jerk_at, velocity_at
from ..equations.free_points import is_at_point, load_at, point_at, points_of, rows_of
from ..equations.lines import conditions_of, lines_of, motion_of, parameters_of, segments_of
from ..equations.properties import property_of
from ..equations.ropes import stiffness_of
from ..line.rodas4p import GAMMA_I
from ..linear_algebra import condensed
from ..linear_algebra.both_ends import add_to_node, get_node
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, put, put_at, scale, sub
from . import system_room as at_line
from .system_room import drum_at, integrator_of, length_of, numbers_of, room_in_step, shares_of, turns_with_rope

SWEEPS = 8  # over drums at free points, whose accelerations depend on each other


@kernel
def mass_of(system, k):
    """m of the drum of line k [kg]."""
    return parameters_of(system, k)[at.WINCH_MASS]


@kernel
def counter_force(system, k, direction, speed, time):
    """W [N] of the drum of line k that turns in a direction with a speed [m/s], at a time [s]: motor, damping, friction."""
    drum = drum_at(system, k)
    return force_at(drum, time) + drum.damping * speed + drum.friction * direction


@kernel
def acceleration_with(system, k, counter, pull, inertia):
    """u' [m/s2] of the drum of line k: T + T^2/(2 EA) = R - I u', T = W + m u'; W, R [N], I [kg]."""
    mass, stiffness = mass_of(system, k), stiffness_of(system, k)
    pressed = (pull - counter) / (mass + inertia)
    if counter + mass * pressed <= 0.0:
        return pressed
    total, free = (1.0 + counter / stiffness) * mass + inertia, pull - counter * (1.0 + 0.5 * counter / stiffness)
    return 2.0 * free / (total + sqrt(max(total * total + 2.0 * mass * mass / stiffness * free, 0.0)))


@kernel
def is_free(conditions, i):
    """Whether node i moves freely."""
    return conditions.first <= i <= conditions.last


@kernel
def acceleration_of_start(conditions, time):
    """Acceleration [m/s2] of the first node of a line if it is driven, else 0."""
    return acceleration_at(conditions.ground, time) if conditions.first == 1 else ZERO_VECTOR


# --- a stage


@kernel
def begin_acceleration(system, k, stage, time):
    """f [N] and the inertia [kg] of the drum of line k at a stage, once its forces are known, into its numbers (modified).

    But for what a first node adds that is a free point; so for the parts of BALANCE, see `take_balance`. col goes into
    `Shares.pulled`, and that of stage 0 into `Shares.border` (modified).
    """
    conditions, numbers = conditions_of(system, k), numbers_of(system, k)
    w, b = integrator_of(system, k), shares_of(system, k)
    chain, n, part = chain_with(conditions, numbers[at_line.LENGTH], numbers[at_line.SPEED]), conditions.n, 1.0
    force, inertia, from_below = rope.of_speed(chain), 0.0, ZERO_VECTOR
    x_p, v_p = get_node(n, 0, w.stage_x), get_node(n, 0, w.stage_v)
    lowest = x_p[2]
    for s in range(n):
        x_q, v_q = get_node(n, s + 1, w.stage_x), get_node(n, s + 1, w.stage_v)
        r, height = sub(x_q, x_p), segment.mean_height(x_p, x_q) - lowest
        force += rope.pull(chain, s, part, w.modes[s], r, sub(v_q, v_p), height)
        inertia += rope.inertia(chain, s, part, r)
        of_p, of_q = rope.columns(chain, s, part, r)
        put(b.pulled, s, add(from_below, of_p))
        from_below, part = of_q, rope.next_part(chain, s, part)
        x_p, v_p = x_q, v_q
    put(b.pulled, n, from_below)
    if stage == 0:
        copy(b.pulled, b.border)
    first = max(conditions.first, 1 if is_at_point(system, k, 0) else 0)  # that is no free point
    balance, crossed = 0.0, 0.0
    for i in range(first, conditions.last + 1):
        part, col, col_0, of_node = 1.0 / w.stage_mass[i], get(b.pulled, i), get(b.border, i), get_node(n, i, w.force)
        force += part * dot(col, of_node)
        inertia -= part * dot(col, col)
        balance -= part * dot(col_0, of_node)
        crossed += part * dot(col_0, col)
    numbers[at_line.UNBALANCED] = force + dot(get(b.pulled, 0), acceleration_of_start(conditions, time))
    numbers[at_line.YIELDING], numbers[at_line.BALANCE], numbers[at_line.CROSSED] = inertia, balance, crossed
    counter = counter_force(system, k, numbers[at_line.DIRECTION], numbers[at_line.SPEED], time)
    numbers[at_line.STAGE_ACCELERATION] = acceleration_with(system, k, counter, numbers[at_line.UNBALANCED], inertia)


@kernel
def force_at_stage(system, point, time):
    """Force on a free point [N] at a stage, of all lines with their drums, and of the load."""
    total = load_at(system, point, time)
    for k in range(lines_of(system)):
        n, w = segments_of(system, k), integrator_of(system, k)
        for end in range(2):
            if is_at_point(system, k, end) and point_at(system, k, end) == point:
                total = add(total, get_node(n, n * end, w.force))
        if turns_with_rope(system, k) and is_at_point(system, k, 0) and point_at(system, k, 0) == point:
            total = add_scaled(total, numbers_of(system, k)[at_line.STAGE_ACCELERATION], get(shares_of(system, k).pulled, 0))
    return total


@kernel
def couple(system, k, time):
    """u' of the drum of line k at a stage (modified), whose first node is a free point."""
    numbers, pulled, point = numbers_of(system, k), get(shares_of(system, k).pulled, 0), point_at(system, k, 0)
    mass = points_of(system).stage_mass[point]
    others = add_scaled(force_at_stage(system, point, time), -numbers[at_line.STAGE_ACCELERATION], pulled)
    pull = numbers[at_line.UNBALANCED] + dot(pulled, others) / mass
    counter = counter_force(system, k, numbers[at_line.DIRECTION], numbers[at_line.SPEED], time)
    inertia = numbers[at_line.YIELDING] - dot(pulled, pulled) / mass
    numbers[at_line.STAGE_ACCELERATION] = acceleration_with(system, k, counter, pull, inertia)


@kernel
def take_balance(system, k, stage, time):
    """Right-hand side of a stage of the drum of line k, from u' of all drums: BALANCE among its numbers (modified)."""
    numbers, gained = numbers_of(system, k), numbers_of(system, k)[at_line.STAGE_ACCELERATION]
    if stage == 0:
        numbers[at_line.INERTIA] = rope_inertia(system, k) + slope_at_start(system, k, time) * mass_of(system, k)
    numbers[at_line.BALANCE] += (numbers[at_line.INERTIA] - numbers[at_line.CROSSED]) * gained
    if is_at_point(system, k, 0):
        point, col_0 = point_at(system, k, 0), get(shares_of(system, k).border, 0)
        numbers[at_line.BALANCE] -= dot(col_0, force_at_stage(system, point, time)) / points_of(system).stage_mass[point]


@kernel
def push_nodes(system, k):
    """Let the forces of line k (modified) have what u' of its drum does: col u', and - col_0 u' of M_0, by masses."""
    conditions, w, b, points = conditions_of(system, k), integrator_of(system, k), shares_of(system, k), points_of(system)
    gained = numbers_of(system, k)[at_line.STAGE_ACCELERATION]
    for i in range(conditions.n + 1):
        if is_free(conditions, i):
            ratio = w.stage_mass[i] / w.mass[i]
            if i == 0 and is_at_point(system, k, 0):
                point = point_at(system, k, 0)
                ratio = points.stage_mass[point] / points.mass[point]
            push = add_scaled(scale(gained, get(b.pulled, i)), -gained * ratio, get(b.border, i))
            add_to_node(conditions.n, i, push, w.force)


@kernel
def slope_at_start(system, k, time):
    """1 + T/EA [-] at the drum of line k at the start of the step, a time [s], with its acceleration."""
    _, speed = length_of(system, k)
    numbers = numbers_of(system, k)
    counter = counter_force(system, k, numbers[at_line.DIRECTION], speed, time)
    _, slope = rope.with_strain(stiffness_of(system, k), counter + mass_of(system, k) * numbers[at_line.STAGE_ACCELERATION])
    return slope


@kernel
def rope_inertia(system, k):
    """I of line k at the start of the step [kg]."""
    conditions, (x, _), part, total = conditions_of(system, k), motion_of(system, k), 1.0, 0.0
    chain = chain_with(conditions, *length_of(system, k))
    for s in range(chain.n):
        total += rope.inertia(chain, s, part, sub(get(x, s + 1), get(x, s)))
        part = rope.next_part(chain, s, part)
    return total


@kernel
def accelerate(system, stage, time):
    """u' of all drums that feel their rope at a stage at a time [s], and the right-hand sides with it (modified)."""
    coupled = 0
    for k in range(lines_of(system)):
        if turns_with_rope(system, k):
            begin_acceleration(system, k, stage, time)
            coupled += is_at_point(system, k, 0)
    if coupled > 0:
        for _ in range(SWEEPS if coupled > 1 else 1):
            for k in range(lines_of(system)):
                if turns_with_rope(system, k) and is_at_point(system, k, 0):
                    couple(system, k, time)
    for k in range(lines_of(system)):
        if turns_with_rope(system, k):
            take_balance(system, k, stage, time)
    if stage > 0:
        for k in range(lines_of(system)):
            if turns_with_rope(system, k):
                push_nodes(system, k)


# --- the border


@kernel
def node_acceleration(system, k, i, time):
    """Acceleration of node i of line k at the start of the step [m/s2], whose forces stand in w.force."""
    conditions, w, numbers = conditions_of(system, k), integrator_of(system, k), numbers_of(system, k)
    if not is_free(conditions, i):
        return acceleration_of_start(conditions, time) if i == 0 else ZERO_VECTOR
    points = points_of(system)
    if i == 0 and is_at_point(system, k, 0):
        point = point_at(system, k, 0)
        return scale(1.0 / points.mass[point], force_at_stage(system, point, time))
    if i == conditions.n and is_at_point(system, k, 1):
        return ZERO_VECTOR  # its part in the rope that flows is 0
    gained, col = numbers[at_line.STAGE_ACCELERATION], get(shares_of(system, k).border, i)
    return scale(1.0 / w.mass[i], add_scaled(get_node(conditions.n, i, w.force), gained, col))


@kernel
def take_equation(system, k, time, d):
    """f_u, df/dt, the row and P of the drum of line k, whose column is condensed, into its numbers (modified).

    False if there is none.
    """
    conditions, numbers = conditions_of(system, k), numbers_of(system, k)
    b, w = shares_of(system, k), integrator_of(system, k)
    n, (x, v), (length, speed) = conditions.n, motion_of(system, k), length_of(system, k)
    chain, part = chain_moving(conditions, length, speed, numbers[at_line.STAGE_ACCELERATION]), 1.0
    slope, drum = slope_at_start(system, k, time), drum_at(system, k)
    by_speed, by_length = 2.0 * rope.half_density(chain, 0) * speed - slope * drum.damping, 0.0
    by_position = b.row  # in the same room at first
    clear(b.by_velocity)
    clear(by_position)
    a_p = node_acceleration(system, k, 0, time)
    for s in range(n):
        a_q = node_acceleration(system, k, s + 1, time)
        r, u = sub(get(x, s + 1), get(x, s)), sub(get(v, s + 1), get(v, s))
        by_r, by_u, of_length, of_speed = rope.by_motion(chain, s, part, w.modes[s], r, u, a_p, a_q)
        weight = (0.0, 0.0, -0.5 * property_of(chain, s, at.SHARE) * 2.0 * rope.half_density(chain, s) * chain.gravity)
        put(by_position, s, add(sub(get(by_position, s), by_r), weight))
        put(by_position, s + 1, add(add(get(by_position, s + 1), by_r), weight))
        put(by_position, 0, add_scaled(get(by_position, 0), -2.0, weight))
        put(b.by_velocity, s, sub(get(b.by_velocity, s), by_u))
        put(b.by_velocity, s + 1, add(get(b.by_velocity, s + 1), by_u))
        by_length += of_length
        by_speed += of_speed
        part, a_p = rope.next_part(chain, s, part), a_q
    rate = -slope * drum.force_rate
    if conditions.first == 1:
        rate += dot(get(by_position, 0), velocity_at(conditions.ground, time))
        rate += dot(get(b.by_velocity, 0), acceleration_at(conditions.ground, time))
        rate += dot(get(b.border, 0), jerk_at(conditions.ground, time))
    if conditions.last == n - 1:
        rate += dot(get(by_position, n), velocity_at(conditions.kite, time))
        rate += dot(get(b.by_velocity, n), acceleration_at(conditions.kite, time))
    for i in range(n + 1):
        along = add_scaled(add_scaled(get(b.by_velocity, i), d, get(by_position, i)), 1.0 / d, get(b.border, i))
        put(b.row, i, along if is_free(conditions, i) else ZERO_VECTOR)
    keep_row(system, k, b.row)
    numbers[at_line.BY_SPEED], numbers[at_line.RATE] = by_speed, rate
    pivot = numbers[at_line.INERTIA] / d - by_speed - d * by_length
    numbers[at_line.PIVOT] = pivot - condensed.inner_product(rows_of(system, k), b.row, room_in_step(system, k).column)
    return numbers[at_line.PIVOT] > 0.0


@kernel
def keep_row(system, k, row):
    """What is left of a row of the drum of line k at its ends into its numbers (modified)."""
    numbers, rows, columns = numbers_of(system, k), rows_of(system, k), room_in_step(system, k).columns
    if is_at_point(system, k, 0):
        put_at(numbers, at_line.ROW_AT_START, condensed.whole_row_at_end(rows, 0, row, columns))
    if is_at_point(system, k, 1):
        put_at(numbers, at_line.ROW_AT_END, condensed.whole_row_at_end(rows, 1, row, columns))


@kernel
def add_to_column(system, k):
    """Add the rope that flows to F_L and F_u of line k (modified), but for what all forces add by masses."""
    conditions, b, (x, v) = conditions_of(system, k), shares_of(system, k), motion_of(system, k)
    chain, part = chain_with(conditions, *length_of(system, k)), 1.0
    for s in range(chain.n):
        r, u = sub(get(x, s + 1), get(x, s)), sub(get(v, s + 1), get(v, s))
        by_length, of_p, of_q = rope.force_slopes(chain, s, part, r, u)
        put(b.by_length, s, add(get(b.by_length, s), by_length))
        put(b.by_length, s + 1, sub(get(b.by_length, s + 1), by_length))
        put(b.by_speed, s, add(get(b.by_speed, s), of_p))
        put(b.by_speed, s + 1, add(get(b.by_speed, s + 1), of_q))
        part = rope.next_part(chain, s, part)


@kernel
def push_back(system, k, inertia, h):
    """Subtract col_0 of what the stages of the drum of line k add up to [m/s] from its right-hand side (modified)."""
    q, border = integrator_of(system, k).q, shares_of(system, k).border
    for i in range(len(border)):
        q[i] -= border[i] * (inertia / h)


@kernel
def right_of_stage(system, k, stage, inertia, h):
    """Right-hand side of a stage of the drum of line k [N]; inertia : what its stages add up to [m/s]."""
    conditions, numbers = conditions_of(system, k), numbers_of(system, k)
    b, w = shares_of(system, k), integrator_of(system, k)
    total = numbers[at_line.BALANCE] + numbers[at_line.INERTIA] * inertia / h + GAMMA_I[stage] * h * numbers[at_line.RATE]
    for i in range(conditions.first, conditions.last + 1):
        total -= dot(get(b.border, i), get_node(conditions.n, i, w.inertia_velocity)) / h
        total -= dot(get(b.by_velocity, i), get_node(conditions.n, i, w.r))
    return total
