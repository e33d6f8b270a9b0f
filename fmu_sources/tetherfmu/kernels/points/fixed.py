"""Rope coordinates in an iteration of a fixed step: their speeds are solved together with the displacements of all nodes.

    sum over their ends of E (T - mu u^2) - c u - F sign(u) - W = m (u - u0)/h,   q = q0 + h u,   all at the end of the step

Lines and points contribute the matrix and gradient of the incremental potential; `line/strand.py` provides columns and rows
at the iterate, with v = (x - x0)/h, v' = (v - v0)/h and u' = (u - u0)/h. One solve yields all displacements and speed
changes. A coordinate is in one of five states: moving forwards or backwards (different only with friction), held, or at a
speed limit, where a line reaches its shortest or longest length. Solve with the assumed states, update them from the
solution, repeat until nothing changes. After `MOST_TRIES` the last speeds are used, and the step has not converged.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel
from ..equations import assembly, flow
from ..equations.boundary import load_during
from ..equations.end_motion import acceleration_at
from ..equations.free_points import free_points, is_at_point, load_at, point_at, points_of, rows_of
from ..equations.ground import has_ground
from ..equations.lines import conditions_of, lines_of, motion_of, parameters_of, segments_of
from ..equations.node_loads import free_acceleration
from ..equations.rope import feels_rope
from ..line import backward_euler, contact, incremental_potential, strand
from ..line.strand_room import (
    BY_GAIN,
    BY_LENGTH,
    BY_RATE,
    CORNER,
    FACTOR,
    GOAL,
    LEFT,
    LENGTH,
    MOVED,
    SLOPE,
    TENSION,
    rope_in,
)
from ..linear_algebra import condensed, profile
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.vectors import add_scaled, dot, get, put, scale, sub
from . import net, room
from .coordinates import longest_of
from .room import (
    attempt_of,
    chain_at_stage,
    coordinate_at,
    count_of,
    globals_of,
    growth_of,
    has_longest,
    has_rope,
    is_drum,
    is_held,
    line_of,
    moves,
    numbers_of,
    scratch_of,
    section_now,
    strand_of,
    take_rates,
    unknowns_of,
)

AT_LOWEST, BACKWARDS, HELD, FORWARDS, AT_HIGHEST, GIVEN = -2.0, -1.0, 0.0, 1.0, 2.0, 3.0  # states; GIVEN: prescribed speed
CLOSE = 1e-6  # relative tension change at convergence; the remaining error is its square
WITHIN = 1e-6  # tolerance of the length limits, relative
MOST_TRIES, ALL_AT_ONCE = 16, 4  # solves per iteration; solves after which states change one at a time
LEAST_PIVOT = 1e-3  # smallest pivot, relative to the coordinate's slope with rigid ropes
MOST_RUN = 0.1  # largest change of a line in an iteration, relative to its section at the winch

# --- lengths


@kernel
def put_speed(own, h, speed):
    """Set the speed [m/s] of a coordinate (its numbers are modified) at the end of a step of h [s]."""
    own[room.SPEED_NOW], own[room.PASSED_NOW] = speed, own[room.REACHED] + h * speed
    own[room.GAIN_NOW] = (speed - own[room.REACHED_SPEED]) / h


@kernel
def place_lines(system, end):
    """Lengths and rates of all lines with ropes (modified) at the end of the step, a time [s]."""
    for k in range(lines_of(system)):
        if has_rope(system, k):
            take_rates(system, k, end)
            numbers = numbers_of(system, k)
            numbers[LENGTH] = max(numbers[LENGTH], room.least_length(system, k))
            room.place_parts(system, k, numbers[LENGTH], room.PASSED_NOW)


@kernel
def is_out_of_limits(system, k, end, sign):
    """Whether line k, a part of it or its rope exceeds its longest (sign 1) or is below its shortest (-1) length."""
    length = room.length_of_part(system, k, end)
    if sign > 0.0:
        return has_longest(system, k, end) and length > (1.0 + WITHIN) * longest_of(system, k)
    return length < (1.0 - WITHIN) * room.shortest_of_part(system, k, end)


@kernel
def stop_what_exceeds(system, h):
    """Stop coordinates (modified) that move lines beyond their length limits in a step of h [s]; returns how many."""
    count = 0
    for k in range(lines_of(system)):
        for end in range(room.limits_of(system, k)):
            for sign in (-1.0, 1.0):
                if has_rope(system, k) and is_out_of_limits(system, k, end, sign):
                    for j in range(count_of(system)):
                        own = coordinate_at(system, j)
                        if sign * room.growth_of_part(system, j, k, end) * own[room.SPEED_NOW] > 0.0:
                            put_speed(own, h, 0.0)
                            count += 1
    return count


@kernel
def keep_lengths(system, step):
    """Limit unconverged speeds (modified) to the earlier ones, and all lines to their length limits."""
    end = step.time + step.h
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if not abs(own[room.SPEED_NOW]) <= abs(own[room.REACHED_SPEED]):
            put_speed(own, step.h, own[room.REACHED_SPEED])
    place_lines(system, end)
    for _ in range(count_of(system)):
        if stop_what_exceeds(system, step.h) > 0:
            place_lines(system, end)


@kernel
def room_left(longer, shorter):
    """Distance of a length [m] from its limit [m]; 0 within rounding."""
    left = longer - shorter
    return left if left > at.ROUNDED_STOP * shorter else 0.0


@kernel
def limits_by(system, k, end, growth, speed, h):
    """Lowest and highest speed [m/s] of a coordinate that lengthens line k, a part of it or its rope by `growth` per metre.

    speed : present one.
    """
    length = room.length_of_part(system, k, end) - growth * (h * speed)
    inwards = room_left(length, room.shortest_of_part(system, k, end)) / (abs(growth) * h)
    outwards = room_left(longest_of(system, k), length) / (abs(growth) * h) if has_longest(system, k, end) else inf
    return (-inwards, outwards) if growth > 0.0 else (-outwards, inwards)


@kernel
def take_limits(system, j, h):
    """Speed limits of a coordinate in an iteration of a step of h [s] (modified)."""
    own = coordinate_at(system, j)
    speed, lowest, highest, least = own[room.SPEED_NOW], -inf, inf, inf
    for k in range(lines_of(system)):
        for end in range(room.limits_of(system, k)):
            growth = room.growth_of_part(system, j, k, end)
            if growth != 0.0:
                down, up = limits_by(system, k, end, growth, speed, h)
                lowest, highest = max(lowest, down), min(highest, up)
                least = min(least, section_now(system, k) / abs(growth))
    if own[room.IS_BRAKED] != 0.0:
        lowest = highest = 0.0
    elif own[room.KEEPS] > 0.0:
        lowest = min(max(lowest, 0.0), highest)
    elif own[room.KEEPS] < 0.0:
        highest = max(min(highest, 0.0), lowest)
    farthest = MOST_RUN * least / h
    own[room.HIGHEST] = min(highest, max(speed, 0.0) + farthest)
    own[room.LOWEST] = max(lowest, min(speed, 0.0) - farthest)


# --- loads on free ends


@kernel
def load_on_end(system, k, end, time):
    """Load [N] at a time [s] on a free end of line k, and its mass [kg]; a point's mass includes all its lines."""
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


# --- rows and columns at the iterate


@kernel
def take_rope(system, k, step):
    """R, columns and rows of line k in the iteration (modified)."""
    own, w, conditions, h = strand_of(system, k), scratch_of(system, k), conditions_of(system, k), step.h
    end, (_, before), n, numbers = step.time + step.h, motion_of(system, k), segments_of(system, k), numbers_of(system, k)
    for i in range(n + 1):
        velocity = scale(1.0 / h, sub(get(w.x, i), get(w.old, i)))
        gained = scale(1.0 / h, sub(velocity, get(before, i)))
        if not conditions.first <= i <= conditions.last:
            gained = acceleration_at(conditions.kite if i > 0 else conditions.ground, end)
        put(own.w.v, i, velocity)
        put(own.w.q, i, gained)
    interleave(n, w.x, own.w.start_x)
    interleave(n, own.w.v, own.w.start_v)
    interleave(n, own.w.q, own.stage_z)
    copy(own.w.start_x, own.w.stage_x)
    copy(own.w.start_v, own.w.stage_v)
    chain = chain_at_stage(system, k)
    copy(w.mass, own.w.stage_mass)
    if has_ground(chain.parameters):
        copy(w.mass, own.w.mass)
        contact.find(conditions, chain, w.x, own.w.v, own.w)
    assembly.find_slopes(chain, own.w.start_x, own.w.start_v, own.w.modes, own.w.segments, own.w.records)
    strand.take_pulls(own, chain)
    if has_ground(chain.parameters) and feels_rope(chain.parameters):
        strand.add_friction(own, chain)
    strand.take_gain_columns(own, chain)
    for side in range(2):
        numbers[LEFT + side] = 0.0
        if is_held(system, k, side):
            strand.linearize_end(own, chain, side, end, h)
            condensed.solve_inner(rows_of(system, k), w.matrix, rope_in(n, own.ropes, side).solved)
    for i in range(4):
        numbers[CORNER + i] = h * numbers[BY_LENGTH + i] + numbers[BY_RATE + i] + numbers[BY_GAIN + i] / h


@kernel
def seek(system, h, is_given):
    """Set the assumed state of all coordinates (modified) from their motion in a step of h [s], or prescribe speeds."""
    for j in range(count_of(system)):
        take_limits(system, j, h)
        own = coordinate_at(system, j)
        speed, is_open = own[room.SPEED_NOW], own[room.LOWEST] < own[room.HIGHEST]
        own[room.SOUGHT] = 0.0
        if is_given:
            own[room.WAY], own[room.SOUGHT] = GIVEN, speed
        elif not is_open or (speed == 0.0 and own[room.FRICTION] != 0.0):
            own[room.WAY] = HELD
        else:
            own[room.WAY] = BACKWARDS if own[room.FRICTION] != 0.0 and speed < 0.0 else FORWARDS


@kernel
def is_moving(own):
    """Whether the equation of a coordinate is solved (it is neither held nor prescribed)."""
    return abs(own[room.WAY]) == FORWARDS


@kernel
def take_signs(system):
    """Signs of friction in the assumed states, and the resulting effective tensions (modified)."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.SIGN] = own[room.WAY] if is_moving(own) and own[room.FRICTION] != 0.0 else 0.0
    net.count_tensions(system)
    for k in range(lines_of(system)):
        for end in range(2):
            if is_held(system, k, end):
                net.take_slope(system, k, end)
    for j in range(count_of(system)):
        net.take_damping(system, j)


@kernel
def place_equations(system, step):
    """Matrix and right-hand side of all global unknowns for the assumed states (modified); False if it is singular."""
    h, points, whole, m = step.h, 3 * free_points(system), globals_of(system), unknowns_of(system)
    if m == 0:
        return True
    net.clear_matrix(system)
    clear(whole.right)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        profile.add_entry(whole.matrix, points + j, points + j, own[room.MASS] / h + own[room.BY_SPEED])
        of_inertia = own[room.MASS] * (own[room.SPEED_NOW] - own[room.REACHED_SPEED]) / h
        whole.right[points + j] = net.own_force(system, j, step.time + h) - of_inertia
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            net.place_blocks(system, k, w.matrix)
            net.place_ropes(system, k, w.matrix, 1.0 / h)
            net.place_right(system, k, w.matrix, w.move, 1.0 / h)
    for j in range(count_of(system)):
        own, i = coordinate_at(system, j), points + j
        if is_moving(own):
            short = LEAST_PIVOT * net.inertia_of(system, j) / h - whole.matrix.lower[int(whole.matrix.start[i]) + i]
            profile.add_entry(whole.matrix, i, i, max(short, 0.0))
        else:
            profile.hold_row(whole.matrix, m, i)
            whole.right[i] = own[room.SOUGHT] - own[room.SPEED_NOW]
    if not profile.factorize(whole.matrix, m):
        return False
    profile.solve(whole.matrix, m, whole.right, whole.solution)
    return True


@kernel
def take_moves(system, h):
    """Displacements of all nodes [m] into the positions to try, and the tension changes MOVED (modified)."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            copy(w.move, w.trial)
            net.take_solution(system, k, w.trial)
            for end in range(2):
                if is_held(system, k, end):
                    take_change(system, k, end, h)


@kernel
def take_change(system, k, end, h):
    """MOVED of an end of line k (modified), from the displacements of its nodes."""
    own, w, numbers, n = strand_of(system, k), scratch_of(system, k), numbers_of(system, k), segments_of(system, k)
    row = rope_in(n, own.ropes, end).row
    total = net.inner_of_line(rows_of(system, k), row, w.trial)
    for other in range(2):
        if is_at_point(system, k, other):
            total += dot(get(row, n * other), get(w.trial, n * other))
    total /= h
    for other in range(2):
        total += numbers[CORNER + 2 * end + other] * net.solution_of_end(system, k, other)
    numbers[MOVED + end] = total * numbers[SLOPE + end] / numbers[FACTOR + end]


# --- states of the coordinates


@kernel
def tensions_at(system, j):
    """Opposing and pulling force at coordinate j after the displacement: T_1 and T_2 of a sheave [N]."""
    own, k = coordinate_at(system, j), line_of(system, j)
    if not is_drum(system, j):
        behind, ahead = numbers_of(system, k), numbers_of(system, k + 1)
        return behind[TENSION + 1] + behind[MOVED + 1], ahead[TENSION] + ahead[MOVED]
    pull, own[room.MAGNITUDE] = 0.0, own[room.FRICTION] + abs(own[room.LOAD])
    for i in range(lines_of(system)):
        for end in range(2):
            weight = room.weight_of(system, j, i, end)
            if weight != 0.0:
                tension = numbers_of(system, i)[TENSION + end] + numbers_of(system, i)[MOVED + end]
                pull += weight * tension
                own[room.MAGNITUDE] += abs(weight * tension)
    return 0.0, pull


@kernel
def left_over(system, j, time, h, way, change):
    """Residual [N] of coordinate j in a state (`way`), after a change of its speed [m/s], at a time [s]."""
    own, (behind, ahead) = coordinate_at(system, j), tensions_at(system, j)
    speed = own[room.SPEED_NOW] + change
    inertia = own[room.MASS] * (speed - own[room.REACHED_SPEED]) / h
    if is_drum(system, j):
        counter = own[room.LOAD] + time * own[room.LOAD_RATE] + own[room.DAMPING] * speed
        return ahead - behind - counter - way * own[room.FRICTION] - inertia
    moving = net.density_on(system, j) * speed * speed
    loss_1 = own[room.LOSS] if way > HELD and behind > moving else 1.0
    loss_2 = own[room.LOSS] if way < HELD and ahead > moving else 1.0
    return loss_2 * (ahead - moving) - loss_1 * (behind - moving) - inertia


@kernel
def way_of_held(system, j, time, h):
    """Next state of the held coordinate j, given the tension changes at a time [s]; h [s]."""
    own, (behind, ahead) = coordinate_at(system, j), tensions_at(system, j)
    if is_drum(system, j):
        behind += own[room.LOAD] + time * own[room.LOAD_RATE]
    forwards, backwards, margin = net.urges(system, j, behind, ahead, own[room.LOSS])
    going_on = own[room.MASS] * own[room.REACHED_SPEED] / h  # momentum lost by holding it, over h
    if own[room.HIGHEST] > 0.0 and forwards + going_on > margin:
        return FORWARDS
    if own[room.LOWEST] < 0.0 and backwards - going_on > margin:
        return BACKWARDS if own[room.FRICTION] != 0.0 else FORWARDS
    return HELD


@kernel
def way_of_moving(own, speed):
    """Next state of a moving coordinate with the solved speed [m/s]; sets SOUGHT (modified) for a prescribed speed."""
    way, lowest, highest = own[room.WAY], own[room.LOWEST], own[room.HIGHEST]
    if own[room.FRICTION] != 0.0:
        lowest, highest = (max(lowest, 0.0), highest) if way == FORWARDS else (lowest, min(highest, 0.0))
    if lowest < speed < highest:
        return way
    own[room.SOUGHT] = lowest if speed <= lowest else highest
    if own[room.SOUGHT] == 0.0:
        return HELD
    return AT_LOWEST if speed <= lowest else AT_HIGHEST


@kernel
def next_way(system, j, time, h, change):
    """Next state of coordinate j after a change of its speed [m/s]; SOUGHT (modified)."""
    own = coordinate_at(system, j)
    way = own[room.WAY]
    if is_moving(own):
        return way_of_moving(own, own[room.SPEED_NOW] + change)
    if way == HELD:
        return way_of_held(system, j, time, h)
    sign = -1.0 if own[room.FRICTION] != 0.0 and own[room.SOUGHT] < 0.0 else 1.0
    left = left_over(system, j, time, h, sign, change)
    return way if (left >= 0.0 if way == AT_HIGHEST else left <= 0.0) else sign


@kernel
def seek_next(system, step, one_at_a_time):
    """Update the coordinates (modified) that contradict their assumed state, or only one of them; returns how many."""
    others, solution, points = 0, globals_of(system).solution, 3 * free_points(system)
    for j in range(count_of(system)):
        if not (one_at_a_time and others > 0):
            own = coordinate_at(system, j)
            way = next_way(system, j, step.time + step.h, step.h, solution[points + j])
            others += way != own[room.WAY]
            own[room.WAY] = way
            if way == HELD:
                own[room.SOUGHT] = 0.0
    return others


@kernel
def is_small(change, tension, stiffness):
    """Whether a tension change [N] leaves an error below a part CLOSE of the tension, or its square of EA [N]."""
    return change * change <= 2.0 * stiffness * CLOSE * (abs(tension) + CLOSE * stiffness)


@kernel
def is_close(system, j):
    """Whether all tension changes at coordinate j are small, after the displacement of all lines."""
    others = 0
    for k in range(lines_of(system)):
        for end in range(2):
            if room.weight_of(system, j, k, end) != 0.0 and feels_rope(parameters_of(system, k)):
                change = numbers_of(system, k)[MOVED + end]
                tension = numbers_of(system, k)[TENSION + end] + change
                others += not is_small(change, tension, net.stiffness_at(system, k, end))
    return others == 0


@kernel
def solve_with(system, step):
    """Displacements and speeds for the assumed states (modified); False if the matrix is singular."""
    take_signs(system)
    if not place_equations(system, step):
        return False
    take_moves(system, step.h)
    return True


@kernel
def begin_moves(system, step):
    """Rope terms of an iteration, after its lines are condensed (modified)."""
    for k in range(lines_of(system)):
        if has_rope(system, k):
            take_rope(system, k, step)
    for j in range(count_of(system)):
        coordinate_at(system, j)[room.CHANGE] = 0.0
        coordinate_at(system, j)[room.IS_FOUND] = 1.0


@kernel
def find_moves(system, step):
    """Displacements of all nodes [m] and speeds of all coordinates (modified); False if a matrix is singular.

    Call `begin_moves` first.
    """
    seek(system, step.h, False)
    are_found = False
    for number in range(MOST_TRIES):
        if not solve_with(system, step):
            return False
        if seek_next(system, step, number >= ALL_AT_ONCE) == 0:
            are_found = True
            break
    take_speeds(system, step, are_found)
    return True


@kernel
def take_speeds(system, step, are_found):
    """Apply the solved speeds to all coordinates (modified), and update lengths, masses and flow forces."""
    solution, points = globals_of(system).solution, 3 * free_points(system)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        speed = own[room.SPEED_NOW]
        onward = speed + solution[points + j]
        if not are_found:
            onward = min(own[room.HIGHEST], max(own[room.LOWEST], onward))
        elif not is_moving(own):
            onward = own[room.SOUGHT]
        own[room.CHANGE] = onward - speed
        close = not is_moving(own) or is_close(system, j)
        own[room.IS_FOUND] = 1.0 if are_found and close else 0.0
        put_speed(own, step.h, onward)
    place_lines(system, step.time + step.h)
    for k in range(lines_of(system)):
        if has_rope(system, k):
            attempt, w = attempt_of(system, k, step), scratch_of(system, k)
            assembly.node_masses(attempt.chain, w.mass)
            if flow.flows(attempt.chain):
                incremental_potential.find_flow(attempt, w.x, w)
    take_masses(system, step)


@kernel
def leave_speeds(system):
    """Keep the speeds of all coordinates in an iteration, marked as not converged (modified)."""
    for j in range(count_of(system)):
        coordinate_at(system, j)[room.CHANGE], coordinate_at(system, j)[room.IS_FOUND] = 0.0, 0.0


@kernel
def has_changed(system):
    """Whether the last iteration changed any speed."""
    count = 0
    for j in range(count_of(system)):
        count += coordinate_at(system, j)[room.CHANGE] != 0.0
    return count > 0


@kernel
def is_unconverged(system, j, h):
    """Whether coordinate j has not converged, or the last iteration moved its rope too far."""
    own, count = coordinate_at(system, j), 0
    moved = h * abs(own[room.CHANGE])
    for k in range(lines_of(system)):
        weight = abs(growth_of(system, j, k))
        count += weight != 0.0 and weight * moved > segments_of(system, k) * numbers_of(system, k)[GOAL]
    return own[room.IS_FOUND] == 0.0 or count > 0


@kernel
def unconverged(system, step):
    """Number of unconverged coordinates and of lines beyond their length limits."""
    count = 0
    if step.turns:
        for j in range(count_of(system)):
            count += is_unconverged(system, j, step.h)
        for k in range(lines_of(system)):
            for end in range(room.limits_of(system, k)):
                if has_rope(system, k):
                    count += is_out_of_limits(system, k, end, -1.0) or is_out_of_limits(system, k, end, 1.0)
    return count
