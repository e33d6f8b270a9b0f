"""Sheaves in the matrix of a Rosenbrock step: a border of the system of all lines and free points.

With the accelerations of `sheaves.py`, M their derivatives by (v', u'), and M_0 those of the start of the step, a stage is

    A q - sum_s c_s p_s = ...,   c = F_u + d F_L' + col_0/d
    sum_s' D_ss' p_s' - g_s q = M_0 (v', u') + M_0 sum_j c_ij (V_j, U_j)/h - f_v r - f_u r_s + gamma_i h df/dt

with p = U_q/d of the rope that has passed and U_u of its speed, as q and V of a node. F_L' = -F_L in the portion before the
sheave, F_L behind it. A line and the free points are solved as without sheaves; with Z_s = A^-1 c_s,

    (D - g Z) p = ... + g y,   q = y + Z p

so that each sheave costs one solution more for each matrix, and a vector for each stage.
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import assembly, segment, winch
from ..equations import rope_at_sheave as rope
from ..equations.boundary import chain_with
from ..equations.end_motion import acceleration_at, velocity_at
from ..equations.ground import has_ground
from ..equations.lines import (
    add_at,
    clear,
    comes_from,
    conditions_of,
    goes_on,
    is_at_point,
    lines_of,
    motion_of,
    parameters_of,
    point_at,
    points_of,
    rows_of,
    segments_of,
    sheaves_of,
    size_of_blocks,
)
from ..equations.properties import point_mass, property_of
from ..equations.rope_at_sheave import IN, OUT
from ..line import contact
from ..line.rodas4p import GAMMA, GAMMA_I, STAGES
from ..linear_algebra import condensed, small_matrix
from ..linear_algebra.both_ends import get_node, interleave
from ..linear_algebra.point_blocks import solve_blocks
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, norm, put, scale, sub
from . import sheave_room as at_sheave
from .at_points import take_ends
from .sheave_room import (
    BORDER,
    BY_SPEED,
    BY_VELOCITY,
    FORCE_BY_LENGTH,
    ROW,
    SOLUTIONS,
    array_at,
    is_coordinate,
    numbers_at,
    portion_at_start,
    portion_gaining,
    runs_over,
    shared_of,
    single_at,
    winch_of,
)
from .sheaves import acceleration_of_point, density_of, gained_force, inertia_times, loss_with, mass_of, number_of
from .system_room import integrator_of, moves, room_in_step, shares_of

# --- slopes of forces


@kernel
def form_slopes(system, k, time):
    """F_L and F_u of portion k (modified) at the start of the step, with the masses of its nodes, which grow with L."""
    n, conditions, w = segments_of(system, k), conditions_of(system, k), integrator_of(system, k)
    (x, v), length, part = motion_of(system, k), numbers_at(system, k)[at_sheave.LENGTH_NOW], 1.0
    by_length, into = single_at(system, k, FORCE_BY_LENGTH), array_at(system, k, BY_SPEED, IN)
    out, chain, growing = (
        array_at(system, k, BY_SPEED, OUT),
        portion_at_start(system, k, time),
        chain_with(conditions, length, 1.0),
    )
    assembly.rate_from_reeling(growing, w.start_x, w.start_v, w.records, by_length)
    if has_ground(conditions.parameters):
        contact.add_rate(growing, x, v, w, by_length)
    clear(into)
    assembly.add_rate_from_acceleration(growing, 1.0, x, w.records, into)
    for i in range(len(into)):
        out[i] = -into[i]
    for s in range(n):
        r, u = sub(get(x, s + 1), get(x, s)), sub(get(v, s + 1), get(v, s))
        c = rope.flowing(chain, s, part)
        along = rope.force_by_length(chain, s, c, r)
        add_at(by_length, s, along)
        put(by_length, s + 1, sub(get(by_length, s + 1), along))
        of_p, of_q = rope.force_by_rate(chain, s, rope.passing(chain, s, part, IN), c, r, u)
        add_at(into, s, of_p)
        add_at(into, s + 1, of_q)
        of_p, of_q = rope.force_by_rate(chain, s, rope.passing(chain, s, part, OUT), c, r, u)
        add_at(out, s, of_p)
        add_at(out, s + 1, of_q)
        part -= property_of(chain, s, at.SHARE)
    for i in range(n + 1):
        mass, end = w.mass[i], 0 if i == 0 else 1
        share = (mass - point_mass(growing, i)) / length
        if (i == 0 or i == n) and is_at_point(system, k, end):
            gained = acceleration_of_point(system, point_at(system, k, end), time)
        else:
            gained = scale(1.0 / mass, gained_force(system, k, i, BORDER))
        put(by_length, i, add_scaled(get(by_length, i), -share, gained))


@kernel
def add_winch_rates(system, k, time, w):
    """Add what a winch that pays out into portion k does to the forces per second to w.q and w.force_rate (modified)."""
    paid, by_length, into = winch_of(system, k), single_at(system, k, FORCE_BY_LENGTH), array_at(system, k, BY_SPEED, IN)
    border = array_at(system, k, BORDER, IN)
    speed, gain, jerk = winch.rate_at(paid, time), winch.gain_at(paid, time), winch.jerk_of(paid)
    for i in range(len(into)):
        w.q[i] += speed * by_length[i] + gain * into[i] + jerk * border[i]
    interleave(segments_of(system, k), w.q, w.force_rate)


# --- the equation of a sheave


@kernel
def node_acceleration(system, k, i, time):
    """Acceleration of node i of portion k at the start of the step [m/s2]."""
    conditions, end = conditions_of(system, k), 0 if i == 0 else 1
    if (i == 0 or i == conditions.n) and is_at_point(system, k, end):
        return acceleration_of_point(system, point_at(system, k, end), time)
    if i < conditions.first:
        return acceleration_at(conditions.ground, time)
    if i > conditions.last:
        return acceleration_at(conditions.kite, time)
    return scale(1.0 / integrator_of(system, k).mass[i], gained_force(system, k, i, BORDER))


@kernel
def take_row(system, k, side, weight, time):
    """Slopes of R_a or R_b of portion k by positions into ROW, by velocities into BY_VELOCITY, times a weight (modified).

    And by L and the rates into its numbers, without the weight.
    """
    n, w, numbers, (x, v), part = (
        segments_of(system, k),
        integrator_of(system, k),
        numbers_at(system, k),
        motion_of(system, k),
        1.0,
    )
    by_position, by_velocity = array_at(system, k, ROW, side), array_at(system, k, BY_VELOCITY, side)
    clear(by_position)
    clear(by_velocity)
    chain, holder = portion_gaining(system, k, 1.0), 0 if side == IN else n
    by_length, by_a, by_b, a_p = 0.0, 0.0, 0.0, node_acceleration(system, k, 0, time)
    for s in range(n):
        a_q = node_acceleration(system, k, s + 1, time)
        r, u = sub(get(x, s + 1), get(x, s)), sub(get(v, s + 1), get(v, s))
        a, b, c = rope.passing(chain, s, part, IN), rope.passing(chain, s, part, OUT), rope.flowing(chain, s, part)
        y, gained = rope.passing(chain, s, part, side), rope.gaining(chain, s, part)
        by_r, by_u, of_length = rope.by_motion(chain, s, y, c, gained, w.modes[s], r, u, a_p, a_q)
        below = -y.sign * property_of(chain, s, at.SHARE) * rope.half_density(chain, s) * chain.gravity
        add_at(by_position, s, scale(weight, sub((0.0, 0.0, below), by_r)))
        add_at(by_position, s + 1, scale(weight, add((0.0, 0.0, below), by_r)))
        add_at(by_position, holder, (0.0, 0.0, -2.0 * weight * below))
        add_at(by_velocity, s, scale(-weight, by_u))
        add_at(by_velocity, s + 1, scale(weight, by_u))
        by_length += of_length
        by_a += rope.by_rate(chain, s, y, a, c, w.modes[s], r, u)
        by_b += rope.by_rate(chain, s, y, b, c, w.modes[s], r, u)
        part -= property_of(chain, s, at.SHARE)
        a_p = a_q
    if side == IN:
        by_a += 2.0 * rope.half_density(chain, 0) * numbers[at_sheave.INTO]
    else:
        by_b -= 2.0 * rope.half_density(chain, n - 1) * chain.leaving
    numbers[at_sheave.BY_LENGTH + side] = by_length
    numbers[at_sheave.BY_RATE + 2 * side], numbers[at_sheave.BY_RATE + 2 * side + 1] = by_a, by_b


@kernel
def turn_of(towards, other):
    """Slope of the angle of wrap by the vector away from a sheave along one portion [1/m]; other : along the other one."""
    length, d = segment.geometry(towards)
    _, e = segment.geometry(other)
    across = add_scaled(e, -dot(d, e), d)
    size = norm(across)
    return scale(1.0 / (length * size), across) if size > 1e-9 else ZERO_VECTOR


@kernel
def add_wrap(system, k):
    """Add what the angle of wrap at the end of line k does to its friction to ROW (modified)."""
    numbers, grip, sign = numbers_at(system, k), parameters_of(system, k)[at.SHEAVE_FRICTION], 0.0
    sign = numbers[at_sheave.SIGN]
    if grip == 0.0 or sign == 0.0:
        return
    n, (x_1, _), (x_2, _) = segments_of(system, k), motion_of(system, k), motion_of(system, k + 1)
    to_1, to_2 = sub(get(x_1, n - 1), get(x_1, n)), sub(get(x_2, 1), get(x_2, 0))
    moving = density_of(system, k) * numbers[at_sheave.SPEED] ** 2
    tension = numbers[at_sheave.TENSION_BEHIND] if sign > 0.0 else -numbers[at_sheave.TENSION_AHEAD]
    factor = -grip * loss_with(system, k, to_1, to_2) * (tension - sign * moving)
    if sign * tension <= moving:
        return
    by_1, by_2 = scale(factor, turn_of(to_1, to_2)), scale(factor, turn_of(to_2, to_1))
    add_at(array_at(system, k, ROW, OUT), n - 1, by_1)
    add_at(array_at(system, k, ROW, OUT), n, scale(-1.0, add(by_1, by_2)))
    add_at(array_at(system, k + 1, ROW, IN), 1, by_2)


@kernel
def finish_row(system, k, side, weight, time, d):
    """Row of R_a or R_b of portion k from ROW and BY_VELOCITY (modified); its explicit time derivative [N/s]."""
    conditions, numbers, border = conditions_of(system, k), numbers_at(system, k), array_at(system, k, BORDER, side)
    by_position, by_velocity, n, rate = (
        array_at(system, k, ROW, side),
        array_at(system, k, BY_VELOCITY, side),
        conditions.n,
        0.0,
    )
    for end in range(2):
        curve, node = conditions.kite if end == 1 else conditions.ground, n * end
        if not conditions.first <= node <= conditions.last:
            rate += dot(get(by_position, node), velocity_at(curve, time))
            rate += dot(get(by_velocity, node), acceleration_at(curve, time))
            rate += weight * dot(get(border, node), scale(6.0, curve[3]))
    if not comes_from(system, k):
        paid, inertia = winch_of(system, k), numbers[at_sheave.INERTIA + side]
        of_winch = numbers[at_sheave.BY_LENGTH + side] * winch.rate_at(paid, time) - inertia * winch.jerk_of(paid)
        rate += weight * (of_winch + numbers[at_sheave.BY_RATE + 2 * side] * winch.gain_at(paid, time))
    for i in range(n + 1):
        along = add_scaled(add_scaled(get(by_velocity, i), d, get(by_position, i)), weight / d, get(border, i))
        put(by_position, i, along if conditions.first <= i <= conditions.last else ZERO_VECTOR)
    return rate


@kernel
def pivot_of(numbers, side, other, d):
    """Part of a portion in D for its coordinate `side` and the unknown of its coordinate `other`."""
    inertia, by_rate = numbers[at_sheave.INERTIA + side + other], numbers[at_sheave.BY_RATE + 2 * side + other]
    sign = 1.0 if other == IN else -1.0
    return inertia / d - by_rate - d * sign * numbers[at_sheave.BY_LENGTH + side]


@kernel
def take_equation(system, k, time, d, matrix):
    """Row, df/dt and D of the sheave at the end of line k, over which rope runs (modified)."""
    numbers, behind, count, j = numbers_at(system, k), numbers_at(system, k + 1), sheaves_of(system), number_of(system, k)
    of_1, of_2 = numbers[at_sheave.OF_BEHIND], numbers[at_sheave.OF_AHEAD]
    take_row(system, k, OUT, of_1, time)
    take_row(system, k + 1, IN, of_2, time)
    add_wrap(system, k)
    numbers[at_sheave.RATE] = finish_row(system, k, OUT, of_1, time, d) + finish_row(system, k + 1, IN, of_2, time, d)
    pivot = of_1 * pivot_of(numbers, OUT, OUT, d) + of_2 * pivot_of(behind, IN, IN, d) + mass_of(system, k) / d
    losses = numbers[at_sheave.AHEAD] - numbers[at_sheave.BEHIND]
    numbers[at_sheave.BY_OWN] = -2.0 * losses * density_of(system, k) * numbers[at_sheave.SPEED]
    matrix[count * j + j] = pivot - numbers[at_sheave.BY_OWN]
    if is_coordinate(system, k, IN):
        matrix[count * j + j - 1] = of_1 * pivot_of(numbers, OUT, IN, d)
    if is_coordinate(system, k + 1, OUT):
        matrix[count * j + j + 1] = of_2 * pivot_of(behind, IN, OUT, d)


# --- the border


@kernel
def put_column(system, k, side, d, column):
    """Column of a sheave in the portion beside it, k, into an array (modified)."""
    by_length, by_speed, border = (
        single_at(system, k, FORCE_BY_LENGTH),
        array_at(system, k, BY_SPEED, side),
        array_at(system, k, BORDER, side),
    )
    sign = d if side == IN else -d
    for i in range(len(column)):
        column[i] = by_speed[i] + sign * by_length[i] + border[i] / d


@kernel
def solve_column(system, j):
    """Solve all lines and points for the column of sheave number j, which stands in the arrays of the lines (modified)."""
    points = points_of(system)
    clear(points.right)
    for k in range(lines_of(system)):
        if moves(system, k):
            column, w = single_at(system, k, SOLUTIONS + j), integrator_of(system, k)
            condensed.solve_inner(rows_of(system, k), w.matrix, column)
            for end in range(2):
                if is_at_point(system, k, end):
                    left = condensed.what_is_left(segments_of(system, k), end, w.matrix, column)
                    add_at(points.right, point_at(system, k, end), left)
    solve_blocks(*size_of_blocks(system), points.matrix, points.right, points.solution)
    for k in range(lines_of(system)):
        if moves(system, k):
            column = single_at(system, k, SOLUTIONS + j)
            take_ends(system, k, column)
            condensed.expand(rows_of(system, k), room_in_step(system, k).columns, column)


@kernel
def row_times(system, k, side, a):
    """Row of R_a or R_b of portion k times an array of node vectors."""
    conditions, row, total = conditions_of(system, k), array_at(system, k, ROW, side), 0.0
    for i in range(conditions.first, conditions.last + 1):
        total += dot(get(row, i), get(a, i))
    return total


@kernel
def form_border(system, time, h):
    """Columns, their solutions and the inverse of D - g Z of all running sheaves (modified); False if there is none.

    The matrix of the points is factorized, and the forces of stage 0 are known.
    """
    count, d, (matrix, inverse, _, _, _) = sheaves_of(system), GAMMA * h, shared_of(system)
    small_matrix.set_to_zero(count, matrix)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            j = number_of(system, k)
            if runs_over(system, k):
                take_equation(system, k, time, d, matrix)
                for other in range(lines_of(system)):
                    clear(single_at(system, other, SOLUTIONS + j))
                put_column(system, k, OUT, d, single_at(system, k, SOLUTIONS + j))
                put_column(system, k + 1, IN, d, single_at(system, k + 1, SOLUTIONS + j))
                solve_column(system, j)
            else:
                matrix[count * j + j] = 1.0
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k):
            for other in range(lines_of(system)):
                if goes_on(system, other) and runs_over(system, other):
                    j = number_of(system, other)
                    product = row_times(system, k, OUT, single_at(system, k, SOLUTIONS + j))
                    product += row_times(system, k + 1, IN, single_at(system, k + 1, SOLUTIONS + j))
                    matrix[count * number_of(system, k) + j] -= product
    return small_matrix.invert(count, matrix, inverse)


# --- a stage


@kernel
def subtract_known(system, k, h):
    """Subtract F_u r and col_0 of what the stages add up to from the right-hand side of portion k (modified)."""
    q = integrator_of(system, k).q
    for side in (IN, OUT):
        if is_coordinate(system, k, side):
            numbers = numbers_at(system, k - 1 if side == IN else k)
            by_speed, border = array_at(system, k, BY_SPEED, side), array_at(system, k, BORDER, side)
            rest, added = numbers[at_sheave.REST], numbers[at_sheave.ADDED_UP] / h
            for i in range(len(q)):
                q[i] -= by_speed[i] * rest + border[i] * added


@kernel
def known_of_portion(system, k, side, weight, h):
    """What portion k adds to the right-hand side of the sheave at one of its ends, with its solution without sheaves [N]."""
    conditions, w, total = (
        conditions_of(system, k),
        integrator_of(system, k),
        row_times(system, k, side, integrator_of(system, k).q),
    )
    border, by_velocity = array_at(system, k, BORDER, side), array_at(system, k, BY_VELOCITY, side)
    for i in range(conditions.first, conditions.last + 1):
        total -= weight / h * dot(get(border, i), get_node(conditions.n, i, w.inertia_velocity))
        total -= dot(get(by_velocity, i), get_node(conditions.n, i, w.r))
    numbers = numbers_at(system, k)
    for other in (IN, OUT):
        if is_coordinate(system, k, other):
            rest = numbers_at(system, k - 1 if other == IN else k)[at_sheave.REST]
            total -= weight * numbers[at_sheave.BY_RATE + 2 * side + other] * rest
    return total


@kernel
def solve_border(system, stage, h):
    """p of all running sheaves at a stage, and what they do to the solutions of all lines (modified)."""
    count, d, (_, inverse, right, solution, _) = sheaves_of(system), GAMMA * h, shared_of(system)
    for k in range(lines_of(system)):
        if goes_on(system, k):
            j, numbers = number_of(system, k), numbers_at(system, k)
            right[j] = 0.0
            if runs_over(system, k):
                of_1, of_2 = numbers[at_sheave.OF_BEHIND], numbers[at_sheave.OF_AHEAD]
                total = numbers[at_sheave.RIGHT] + inertia_times(system, k, at_sheave.ADDED_UP) / h
                total += GAMMA_I[stage] * h * numbers[at_sheave.RATE]
                total += known_of_portion(system, k, OUT, of_1, h) + known_of_portion(system, k + 1, IN, of_2, h)
                right[j] = total - numbers[at_sheave.BY_OWN] * numbers[at_sheave.REST]
    for i in range(count):
        solution[i] = 0.0
        for j in range(count):
            solution[i] += inverse[count * i + j] * right[j]
    for k in range(lines_of(system)):
        if moves(system, k):
            q = integrator_of(system, k).q
            for j in range(count):
                if solution[j] != 0.0:
                    column = single_at(system, k, SOLUTIONS + j)
                    for i in range(len(q)):
                        q[i] += solution[j] * column[i]
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k):
            numbers, p = numbers_at(system, k), solution[number_of(system, k)]
            increment = p - numbers[at_sheave.REST]
            shares_of(system, k).speeds[stage] = increment
            numbers[at_sheave.SOLUTION], numbers[at_sheave.INCREMENT] = p, increment
            if stage >= STAGES - 2:
                numbers[at_sheave.PASSED] += d * p
                numbers[at_sheave.STAGE_SPEED] += increment
