"""Sheaves and drums in the matrix of a Rosenbrock step: a border of the system of all lines and free points.

With the accelerations of `sheaves.py` and `running_drums.py`, M their derivatives by (v', u'), and M_0 those of the start of
the step, a stage is

    A q - sum_s c_s p_s = ...,   c = F_u + d F_L' + col_0/d
    sum_s' D_ss' p_s' - g_s q = M_0 (v', u') + M_0 sum_j c_ij (V_j, U_j)/h - f_v r - f_u r_s + gamma_i h df/dt

with p = U_q/d of the rope that has passed and U_u of its speed, as q and V of a node. F_L' = -F_L in the portion before the
sheave, F_L behind it; a drum has r F_L in each of its lines. A line and the free points are solved as without; with
Z_s = A^-1 c_s,

    (D - g Z) p = ... + g y,   q = y + Z p

so that each of them costs one solution more for each matrix, and a vector for each stage.
"""

from ..arrays import clear
from ..compilation import kernel, view
from ..equations.free_points import is_at_point, point_at, points_of, rows_of, size_of_blocks
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of
from ..equations.rope_at_sheave import IN, OUT
from ..equations.ropes import is_turned, sheaves_of
from ..line.rodas4p import GAMMA, GAMMA_I, STAGES
from ..linear_algebra import condensed, small_matrix
from ..linear_algebra.both_ends import get_node
from ..linear_algebra.point_blocks import solve_blocks
from ..linear_algebra.vectors import add_at, add_scaled, dot, get, put, scale
from . import running_drums
from . import sheave_room as at_sheave
from .at_points import take_ends
from .coordinates import coordinate_at, count_of, is_drum, number_of, own_numbers, portions_of, runs, stages_of, weight_of
from .sheave_pulls import density_of, mass_of
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
    part_of,
    parts_of,
    shared_of,
    single_at,
    through,
)
from .sheave_slopes import add_wrap, finish_row, take_row
from .sheave_stages import inertia_times
from .system_room import integrator_of, moves, room_in_step, scratch_of


@kernel
def pivot_of(numbers, side, other, d):
    """Part of a portion in D for its coordinate `side` and the unknown of its coordinate `other`."""
    inertia, by_rate = numbers[at_sheave.INERTIA + side + other], numbers[at_sheave.BY_RATE + 2 * side + other]
    sign = 1.0 if other == IN else -1.0
    return inertia / d - by_rate - d * sign * numbers[at_sheave.BY_LENGTH + side]


@view
def nodes_at_start(system, k):
    """What `take_row` takes of the nodes of portion k at the start of the step."""
    x, v = motion_of(system, k)
    return x, v, integrator_of(system, k).modes


@kernel
def cross(system, j, k, side, other, slope, d, matrix):
    """Add what a slope by R_a or R_b (side) of portion k makes of the rate at its end `other` to row j of D (modified)."""
    count, value = count_of(system), slope * pivot_of(numbers_at(system, k), side, other, d)
    for i in range(count):
        c = coordinate_at(system, i)
        if runs(system, c):
            matrix[count * j + i] += weight_of(system, c, k, other) * value


@kernel
def take_equation(system, k, time, d, matrix):
    """Row, df/dt and D of the sheave at the end of line k, over which rope runs (modified)."""
    numbers, behind, count, j = numbers_at(system, k), numbers_at(system, k + 1), count_of(system), number_of(system, k)
    of_1, of_2 = numbers[at_sheave.OF_BEHIND], numbers[at_sheave.OF_AHEAD]
    take_row(system, k, OUT, of_1, nodes_at_start(system, k))
    take_row(system, k + 1, IN, of_2, nodes_at_start(system, k + 1))
    add_wrap(system, k)
    numbers[at_sheave.RATE] = finish_row(system, k, OUT, of_1, time, d) + finish_row(system, k + 1, IN, of_2, time, d)
    pivot = of_1 * pivot_of(numbers, OUT, OUT, d) + of_2 * pivot_of(behind, IN, IN, d) + mass_of(system, k) / d
    losses = numbers[at_sheave.AHEAD] - numbers[at_sheave.BEHIND]
    numbers[at_sheave.BY_OWN] = -2.0 * losses * density_of(system, k) * numbers[at_sheave.SPEED]
    matrix[count * j + j] = pivot - numbers[at_sheave.BY_OWN]
    if is_coordinate(system, k, IN):
        cross(system, j, k, OUT, IN, of_1, d, matrix)
    if is_coordinate(system, k + 1, OUT):
        cross(system, j, k + 1, IN, OUT, of_2, d, matrix)


@kernel
def take_rows_at_drums(system, time, d):
    """Rows of R_a, and their df/dt, of all lines that drums turn (modified), without the ratios."""
    for k in range(lines_of(system)):
        if is_turned(system, k) and is_coordinate(system, k, IN):
            numbers = numbers_at(system, k)
            take_row(system, k, IN, numbers[at_sheave.OF_IN], nodes_at_start(system, k))
            numbers[at_sheave.RATE_IN] = finish_row(system, k, IN, numbers[at_sheave.OF_IN], time, d)


@kernel
def take_equation_of_drum(system, c, d, matrix):
    """df/dt and D of a drum that turns (modified)."""
    numbers, drum = own_numbers(system, c), running_drums.drum_with_lines(system, c)
    count, j = count_of(system), number_of(system, c)
    numbers[at_sheave.RATE], numbers[at_sheave.BY_OWN] = -drum.force_rate, -drum.damping
    matrix[count * j + j] = drum.mass / d + drum.damping
    for k in range(lines_of(system)):
        weight = weight_of(system, c, k, IN)
        if weight != 0.0:
            of_line = numbers_at(system, k)
            numbers[at_sheave.RATE] += weight * of_line[at_sheave.RATE_IN]
            for other in (IN, OUT):
                if is_coordinate(system, k, other):
                    cross(system, j, k, IN, other, weight * of_line[at_sheave.OF_IN], d, matrix)


@kernel
def put_column(system, k, side, weight, d, column):
    """Column of a coordinate in a portion on which it acts, k, into an array (modified)."""
    by_length, by_speed = single_at(system, k, FORCE_BY_LENGTH), array_at(system, k, BY_SPEED, side)
    border, parts, sign = single_at(system, k, BORDER), parts_of(system, k), d if side == IN else -d
    for i in range(len(parts)):
        along = add_scaled(get(by_speed, i), sign, get(by_length, i))
        put(column, i, scale(weight, add_scaled(along, part_of(parts, side, i) / d, get(border, i))))


@view
def matrix_of(system, k, is_fixed):
    """Matrix of line k in a Rosenbrock step, or in the iteration of a fixed step."""
    return scratch_of(system, k).matrix if is_fixed else integrator_of(system, k).matrix


@kernel
def acts_on(system, j, k):
    """Whether coordinate j acts on an end of line k."""
    c = coordinate_at(system, j)
    return weight_of(system, c, k, IN) != 0.0 or weight_of(system, c, k, OUT) != 0.0


@kernel
def solve_column(system, j, is_fixed):
    """Solve all lines and points for the column of coordinate j, which stands in the arrays of the lines (modified).

    is_fixed : as for `matrix_of`.
    """
    points = points_of(system)
    clear(points.right)
    for k in range(lines_of(system)):
        if moves(system, k):
            column, matrix = single_at(system, k, SOLUTIONS + j), matrix_of(system, k, is_fixed)
            if is_fixed and not acts_on(system, j, k):
                continue
            condensed.solve_inner(rows_of(system, k), matrix, column)
            for end in range(2):
                if is_at_point(system, k, end):
                    left = condensed.what_is_left(segments_of(system, k), end, matrix, column)
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
    """Columns, their solutions and the inverse of D - g Z of all coordinates that run (modified); False if there is none.

    The matrix of the points is factorized, and the forces of stage 0 are known.
    """
    count, d, (matrix, inverse, _, _, _) = count_of(system), GAMMA * h, shared_of(system)
    clear(matrix)
    if count > sheaves_of(system):
        take_rows_at_drums(system, time, d)
    for j in range(count):
        c = coordinate_at(system, j)
        if not runs(system, c):
            matrix[count * j + j] = 1.0
            continue
        if is_drum(system, c):
            take_equation_of_drum(system, c, d, matrix)
        else:
            take_equation(system, c, time, d, matrix)
        for k in range(lines_of(system)):
            clear(single_at(system, k, SOLUTIONS + j))
        for k in range(*portions_of(system, c)):
            for side in (IN, OUT):
                weight = weight_of(system, c, k, side)
                if weight != 0.0:
                    put_column(system, k, side, weight, d, single_at(system, k, SOLUTIONS + j))
        solve_column(system, j, False)
    for j in range(count):
        for i in range(count):
            if runs(system, coordinate_at(system, j)) and runs(system, coordinate_at(system, i)):
                matrix[count * j + i] -= row_of_coordinate(system, coordinate_at(system, j), SOLUTIONS + i)
    return small_matrix.invert(count, matrix, inverse)


@kernel
def row_of_coordinate(system, c, which):
    """Row of a coordinate times one of the arrays of each portion on which it acts."""
    total = 0.0
    for k in range(*portions_of(system, c)):
        for side in (OUT, IN):
            weight = weight_of(system, c, k, side)
            if weight != 0.0:
                total += weight * row_times(system, k, side, single_at(system, k, which))
    return total


@kernel
def subtract_known(system, k, h):
    """Subtract F_u r, and col_0 of u' and of what the stages add up to, from the right-hand side of portion k (modified)."""
    q, border, parts = integrator_of(system, k).q, single_at(system, k, BORDER), parts_of(system, k)
    for side in (IN, OUT):
        if is_coordinate(system, k, side):
            by_speed, rest = array_at(system, k, BY_SPEED, side), through(system, k, side, at_sheave.REST)
            for i in range(len(q)):
                q[i] -= by_speed[i] * rest
    of_a = through(system, k, IN, at_sheave.GAIN) + through(system, k, IN, at_sheave.ADDED_UP) / h
    of_b = through(system, k, OUT, at_sheave.GAIN) + through(system, k, OUT, at_sheave.ADDED_UP) / h
    for i in range(len(parts)):
        put(q, i, add_scaled(get(q, i), -of_b - (of_a - of_b) * parts[i], get(border, i)))


@kernel
def known_of_portion(system, k, side, weight, h):
    """What portion k adds to the right-hand side of a coordinate at one of its ends, with its solution without any [N]."""
    conditions, w, total = conditions_of(system, k), integrator_of(system, k), 0.0
    row, border, n = array_at(system, k, ROW, side), single_at(system, k, BORDER), conditions.n
    by_velocity, parts = array_at(system, k, BY_VELOCITY, side), parts_of(system, k)
    for i in range(conditions.first, conditions.last + 1):
        total += dot(get(row, i), get(w.q, i)) - dot(get(by_velocity, i), get_node(n, i, w.r))
        gained = scale(1.0 / h, get_node(n, i, w.inertia_velocity))
        if 0 < i < n:  # `take_right` has free points
            gained = add_scaled(gained, 1.0 / w.stage_mass[i], get_node(n, i, w.force))
        total -= weight * part_of(parts, side, i) * dot(get(border, i), gained)
    numbers = numbers_at(system, k)
    for other in (IN, OUT):
        if is_coordinate(system, k, other):
            rest = through(system, k, other, at_sheave.REST)
            total -= weight * numbers[at_sheave.BY_RATE + 2 * side + other] * rest
    return total


@kernel
def right_of(system, c, stage, h):
    """Right-hand side of a stage of a coordinate [N], with the solutions without coordinates."""
    numbers, which = own_numbers(system, c), at_sheave.ADDED_UP
    inertia = running_drums.inertia_times(system, c, which) if is_drum(system, c) else inertia_times(system, c, which)
    total = numbers[at_sheave.RIGHT] + inertia / h + GAMMA_I[stage] * h * numbers[at_sheave.RATE]
    if is_drum(system, c):
        for k in range(lines_of(system)):
            weight = weight_of(system, c, k, IN)
            if weight != 0.0:
                total += weight * known_of_portion(system, k, IN, numbers_at(system, k)[at_sheave.OF_IN], h)
    else:
        of_1, of_2 = numbers[at_sheave.OF_BEHIND], numbers[at_sheave.OF_AHEAD]
        total += known_of_portion(system, c, OUT, of_1, h) + known_of_portion(system, c + 1, IN, of_2, h)
    return total - numbers[at_sheave.BY_OWN] * numbers[at_sheave.REST]


@kernel
def solve_border(system, stage, h):
    """p of all coordinates that run at a stage, and what they do to the solutions of all lines (modified)."""
    count, d, (_, inverse, right, solution, _) = count_of(system), GAMMA * h, shared_of(system)
    for j in range(count):
        c = coordinate_at(system, j)
        right[j] = 0.0
        if runs(system, c):
            right[j] = right_of(system, c, stage, h)
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
    for j in range(count):
        c = coordinate_at(system, j)
        if runs(system, c):
            numbers, p = own_numbers(system, c), solution[j]
            increment = p - numbers[at_sheave.REST]
            stages_of(system, c)[stage] = increment
            numbers[at_sheave.SOLUTION], numbers[at_sheave.INCREMENT] = p, increment
            if stage >= STAGES - 2:
                numbers[at_sheave.PASSED] += d * p
                numbers[at_sheave.STAGE_SPEED] += increment
