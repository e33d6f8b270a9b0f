"""The drums of winches in an iteration of a fixed step: their speeds are found with the moves of the nodes.

    m (u - u0)/h + c u + W + F sign(u) = T,   L = L0 + h u,   F sign(0): any force from -F to F

T is the tension of the first segment at the end of the step. The matrix A of the inner nodes of a line is solved for two
right-hand sides, minus the gradient g of Phi and its change with u; with the moves q of its free ends (`at_points.py`)

    A p = -g,   A y = -dg/du,   r = m (u - u0)/h + c u + W - T,   P = dr/du - T_x y
    u' - u = -(r + s F - T_x p + r_0 q_0 + r_n q_n)/P;   move = p + (u' - u) y

That is so of a drum that turns in a direction s; one at a limit of its speed, and one that friction holds, have a given u'.
Which of these it is shows only in the solution. In the order of u' they are

    AT_LOWEST, INWARDS, HELD, OUTWARDS, AT_HIGHEST;    without friction AT_LOWEST, OUTWARDS, AT_HIGHEST

Each drum is sought as it turns now, and then one place nearer to where it was found, until all of them are found where they
were sought. If they are not after `MOST_TRIES`, the speeds that were found last are taken: no convergence. A line without
free points finds its u' at once: the speed nearest to u - (r - T_x p)/P, by F/P nearer to 0 and within the limits.

The move is the direction of Newton's method for the potential with the new speeds, and is shortened until that falls. So
each iteration descends as one of `backward_euler.py` does, and one factorization does for chain and drum. See
docs/models/numerics.md, "A drum in the same system".
"""

from ..arrays import clear
from ..compilation import kernel
from ..equations import flow
from ..equations.assembly import node_masses
from ..equations.boundary import hold_ends, load_during
from ..equations.drum import HELD, INWARDS, OUTWARDS, force_at
from ..equations.free_points import is_at_point, load_at, point_at, points_of, rows_of
from ..equations.lines import conditions_of, lines_of, motion_of, parameters_of, segments_of
from ..equations.node_loads import free_acceleration
from ..equations.properties import point_mass, sees_reeling
from ..equations.rope_at_drum import feels_rope
from ..line import backward_euler, incremental_potential
from ..linear_algebra import condensed
from ..linear_algebra.vectors import add, add_at, add_scaled, dot, get, put, put_at, scale, sub
from . import rope_fixed_drums
from . import system_room as at_line
from .at_points import place_column, row_of
from .rope_drums import keep_row
from .system_room import attempt_of, drum_at, is_turning, length_of, numbers_of, room_in_step, scratch_of

MOST_REELED = 0.1  # part of the length by which it changes in an iteration
LEAST_PIVOT = 1e-3  # of what P is where the chain does not yield
MOST_TRIES = 8  # at ways in which the drums are found in an iteration
AT_LOWEST, AT_HIGHEST, GIVEN = -2.0, 2.0, 3.0  # beside the directions of `equations/drum.py`; GIVEN: at any other speed

# --- loads on free ends


@kernel
def load_on_end(system, k, end, time):
    """Load [N] at a time [s] on an end of line k that may be free, and the mass there [kg], a point's with all its lines."""
    if is_at_point(system, k, end):
        point = point_at(system, k, end)
        return load_at(system, point, time), points_of(system).mass[point]
    conditions, mass = conditions_of(system, k), scratch_of(system, k).mass
    return scale(float(end), load_during(conditions, time)), mass[conditions.n * end]


@kernel
def take_masses(system, step):
    """Masses of the free points [kg] from the end masses of their lines, and the free flight of all free ends (modified)."""
    points, h = points_of(system), step.h
    clear(points.mass)
    for k in range(lines_of(system)):
        for end in range(2):
            if is_at_point(system, k, end):
                points.mass[point_at(system, k, end)] += scratch_of(system, k).mass[segments_of(system, k) * end]
    for k in range(lines_of(system)):
        conditions, free, (x, v) = conditions_of(system, k), scratch_of(system, k).free, motion_of(system, k)
        for end in range(2):
            node = conditions.n * end
            if conditions.first <= node <= conditions.last:
                load, mass = load_on_end(system, k, end, step.time + h)
                falling = free_acceleration(attempt_of(system, k, step).chain)
                flight = backward_euler.flight(get(x, node), get(v, node), h, falling)
                put(free, node, add_scaled(flight, h * h / mass, load))


# --- the equations of a line


@kernel
def pull_by_speed(attempt, length, k, c, rate):
    """What the pull of a segment gains with u [N s/m]: along its direction, along `incremental_potential.slant_of`.

    Length [m], k [N/m], c [N s/m] and the rate that the damper sees [m/s].
    """
    chain = attempt.chain
    if sees_reeling(chain.parameters):
        shrinkage = incremental_potential.shrinkage(attempt)
        return -attempt.h / chain.length * (k * length + c * rate), -c * length * shrinkage / chain.length
    return -attempt.h / chain.length * k * length, -attempt.h / chain.length * c * rate


@kernel
def mass_by_speed(attempt, i, w):
    """What the mass of node i gains with u [kg s/m]."""
    chain = attempt.chain
    return attempt.h / chain.length * (w.mass[i] - point_mass(chain, i))


@kernel
def put_reeling_column(system, k, step, column):
    """-dg/du for the rate u of L of line k (modified): of the masses, of their loads, of springs and dampers."""
    attempt, w = attempt_of(system, k, step), scratch_of(system, k)
    n, h, b = attempt.chain.n, step.h, incremental_potential.shrinkage(attempt)
    for i in range(n + 1):
        put(column, i, scale(mass_by_speed(attempt, i, w) / (h * h), sub(get(w.free, i), get(w.x, i))))
    for end in range(2):
        load, mass = load_on_end(system, k, end, step.time + h)
        put(column, n * end, add_scaled(get(column, n * end), -mass_by_speed(attempt, n * end, w) / mass, load))
    for s in range(n):
        length, e, _, stiffness, c, rate, r0 = incremental_potential.segment_at(attempt, s, w.x, w)
        along, aslant = pull_by_speed(attempt, length, stiffness, c, rate)
        pull = add(scale(along, e), scale(aslant, incremental_potential.slant_of(b, length, e, r0)))
        put(column, s, add(get(column, s), pull))
        put(column, s + 1, sub(get(column, s + 1), pull))


@kernel
def form_column(system, k, step):
    """-dg/du of the drum of line k into its column (modified)."""
    column = room_in_step(system, k).column
    put_reeling_column(system, k, step, column)
    if feels_rope(parameters_of(system, k)):
        rope_fixed_drums.form_column(system, k, step)
    hold_ends(conditions_of(system, k), column)


@kernel
def take_equation(system, k, step):
    """P, T + T_x p and T_x of the drum of line k, whose move and column are condensed, into its numbers (modified)."""
    attempt, w, rows, drum = attempt_of(system, k, step), scratch_of(system, k), rows_of(system, k), drum_at(system, k)
    h, chain, column, numbers = step.h, attempt.chain, room_in_step(system, k).column, numbers_of(system, k)
    if feels_rope(chain.parameters):
        row = w.row_of_drum
        pull, by_rope = rope_fixed_drums.take_row(system, k, step, row)
        inertia = rope_fixed_drums.inertia(system, k, step)
        lowest = LEAST_PIVOT * (inertia + drum.mass / h)
        numbers[at_line.PIVOT] = max(inertia + by_rope - condensed.inner_product(rows, row, column), lowest)
        numbers[at_line.TENSION] = pull + condensed.inner_product(rows, row, w.move)
        keep_row(system, k, row)
        return
    length, e, rest, stiffness, c, rate, r0 = incremental_potential.segment_at(attempt, 0, w.x, w)
    b = incremental_potential.shrinkage(attempt)
    by_position = add(scale(stiffness, e), scale(c * b / h, incremental_potential.slant_of(b, length, e, r0)))
    along, aslant = pull_by_speed(attempt, length, stiffness, c, rate)
    inertia = drum.mass / h + drum.damping
    lowest = LEAST_PIVOT * (inertia + (h * stiffness + c) * length / chain.length)
    yielded = dot(by_position, condensed.first_difference(rows, column))
    numbers[at_line.PIVOT] = max(inertia - along - aslant - yielded, lowest)
    tension = stiffness * (length - rest) + c * rate
    numbers[at_line.TENSION] = tension + dot(by_position, condensed.first_difference(rows, w.move))
    put_at(numbers, at_line.ROW, by_position)


@kernel
def residual_of(system, k, step, tension):
    """r [N] of the drum of line k with a tension [N]."""
    (_, before), speed, drum = length_of(system, k), numbers_of(system, k)[at_line.TRIAL], drum_at(system, k)
    if feels_rope(parameters_of(system, k)):
        counter, _ = rope_fixed_drums.counter_force(system, k, step, 0.0)
        return counter - tension
    residual = drum.mass * (speed - before) / step.h + drum.damping * speed
    return residual + (force_at(drum, step.time + step.h) - tension)


@kernel
def friction_of(system, k, step, direction):
    """Friction of the drum of line k [N] in a direction."""
    if feels_rope(parameters_of(system, k)):
        return rope_fixed_drums.friction(system, k, step, direction)
    return drum_at(system, k).friction


@kernel
def place_drum(system, k, step, points):
    """Part of the drum of line k of the matrix and the right-hand side of the points (modified), as it is sought."""
    numbers, column = numbers_of(system, k), room_in_step(system, k).column
    way, change = numbers[at_line.WAY], numbers[at_line.SOUGHT] - numbers[at_line.TRIAL]
    if abs(way) == OUTWARDS:
        residual = residual_of(system, k, step, numbers[at_line.TENSION])
        change = -(residual + way * friction_of(system, k, step, way)) / numbers[at_line.PIVOT]
        place_column(system, k)
    for end in range(2):
        if is_at_point(system, k, end):
            add_at(points.right, point_at(system, k, end), scale(change, get(column, segments_of(system, k) * end)))


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
            numbers = numbers_of(system, k)
            speed, limits = numbers[at_line.TRIAL], (numbers[at_line.LOWEST], numbers[at_line.HIGHEST])
            way = GIVEN if is_given else way_at(speed, *limits, drum_at(system, k).friction)
            numbers[at_line.WAY], numbers[at_line.SOUGHT] = way, speed if is_given else speed_on(way, *limits)
            numbers[at_line.ONWARD], numbers[at_line.IS_FOUND] = speed, 1.0


@kernel
def find_drum(system, k, step, points):
    """u' of the drum of line k (modified) from the moves of the points; whether it is found as it was not sought.

    Where the line meets no free point u' does not depend on how it was sought.
    """
    numbers, friction, tension = numbers_of(system, k), drum_at(system, k).friction, numbers_of(system, k)[at_line.TENSION]
    lowest, highest = numbers[at_line.LOWEST], numbers[at_line.HIGHEST]
    speed, way = numbers[at_line.TRIAL], numbers[at_line.WAY]
    for end in range(2):
        if is_at_point(system, k, end):
            tension -= dot(row_of(system, k, end), get(points.solution, point_at(system, k, end)))
    wanted = speed - residual_of(system, k, step, tension) / numbers[at_line.PIVOT]
    drag = friction_of(system, k, step, OUTWARDS if wanted > 0.0 else INWARDS)
    drawn = max(abs(wanted) - drag / numbers[at_line.PIVOT], 0.0)
    nearest = min(highest, max(lowest, drawn if wanted > 0.0 else -drawn))
    farthest = MOST_REELED * attempt_of(system, k, step).chain.length / step.h
    onward = speed + max(-farthest, min(farthest, nearest - speed))
    limits = max(lowest, speed - farthest), min(highest, speed + farthest)
    found = way_at(onward, *limits, friction)
    is_other = found != way and (is_at_point(system, k, 0) or is_at_point(system, k, 1))
    numbers[at_line.ONWARD], numbers[at_line.WAY] = onward, nearer(way, found, *limits, friction)
    numbers[at_line.SOUGHT], numbers[at_line.IS_FOUND] = speed_on(numbers[at_line.WAY], *limits), 0.0 if is_other else 1.0
    return is_other


@kernel
def find_drums(system, step):
    """`find_drum` of all drums (modified); how many are found as they were not sought."""
    others = 0
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            others += find_drum(system, k, step, points_of(system))
    return others


@kernel
def give(system, step):
    """Let all drums (modified) be sought at the speeds that were found last."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers = numbers_of(system, k)
            numbers[at_line.WAY], numbers[at_line.SOUGHT] = GIVEN, numbers[at_line.ONWARD]


# --- after it


@kernel
def follow(system, k, step):
    """Let masses and the forces of rope that flows follow the length of line k and its rates (modified)."""
    attempt, w = attempt_of(system, k, step), scratch_of(system, k)
    node_masses(attempt.chain, w.mass)
    if flow.flows(attempt.chain):
        incremental_potential.find_flow(attempt, w.x, w)


@kernel
def turn(system, step):
    """Let all drums (modified) have the speeds that were found; masses and the forces of rope that flows follow."""
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers = numbers_of(system, k)
            numbers[at_line.CHANGE] = numbers[at_line.ONWARD] - numbers[at_line.TRIAL]
            numbers[at_line.TRIAL] = numbers[at_line.ONWARD]
            follow(system, k, step)
    take_masses(system, step)


@kernel
def unconverged_drums(system, step):
    """Number of drums that are not found, or pay out more in the last iteration than each node of their lines may move."""
    count = 0
    for k in range(lines_of(system)):
        if is_turning(system, k, step):
            numbers = numbers_of(system, k)
            moved = step.h * abs(numbers[at_line.CHANGE])
            is_close = moved <= segments_of(system, k) * numbers[at_line.GOAL]
            if feels_rope(parameters_of(system, k)):
                is_close = is_close and rope_fixed_drums.is_close(system, k, step)
            count += not (is_close and numbers[at_line.IS_FOUND] == 1.0)
    return count
