"""The Rosenbrock step with the drum of a winch in the same system, and the steps within a communication step.

Length L and speed u of the drum (`equations/drum.py`) are unknowns beside x and v, with the same coefficients: p = U_L/d and
U_u stand for L and u as q and V for x and v. Each segment has its share of L, so the matrix of a stage has a border:

    (M/d - B - d K) q - (F_u + d F_L) p = ...
    -(T_v + d T_x) q + (m/d - f_u - d f_L) p = f + m (sum_j c_ij U_uj/h + r/d) - T_v r_v - f_u r + gamma_i h df/dt

with f = T - W - c u - F sign(u). The border costs one solution more for each matrix and one vector for each stage.

A piece of the step ends where the drum begins to turn, comes to rest or comes to a stop: it is tried again with another
length until it ends there (`Crossing`). Without mass f = 0 is an algebraic equation, and what an error of the step leaves of
it is taken away by `project`. See docs/models/numerics.md, "A drum in the same system".
"""

from collections import namedtuple
from math import ceil, inf

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL

from ..arrays import behind, copy
from ..compilation import kernel, part, view
from ..equations import assembly, segment
from ..equations.boundary import BoundaryConditions, hold_ends, place_ends
from ..equations.drum import (
    HELD,
    INWARDS,
    OUTWARDS,
    balance,
    direction_of,
    drum_of,
    force_at,
    freedom,
    is_at_stop,
    stop_ahead,
)
from ..equations.end_motion import acceleration_at, velocity_at
from ..equations.ground import has_ground
from ..equations.properties import chain_at, point_mass, property_of, rest_length, sees_reeling
from ..equations.winch import NEUTRAL
from ..linear_algebra.block_tridiagonal import factorize, solve
from ..linear_algebra.both_ends import get_node, interleave
from ..linear_algebra.pairs import first
from ..linear_algebra.vectors import add, add_scaled, dot, get, put, scale, sub
from . import contact, rosenbrock, step_control
from .rodas4p import A_ROWS, ALPHA, GAMMA, GAMMA_I, INERTIA, R_BY_GAMMA, STAGES, P


def _by_stage(rows, first_row):
    """Rows of factors of different lengths as one array (STAGES, STAGES), 0 elsewhere."""
    found = np.zeros((STAGES, STAGES))
    for i, row in enumerate(rows, start=first_row):
        found[i, : len(row)] = row
    return found


IN_LENGTH, IN_SPEED = _by_stage(P, 1), _by_stage(A_ROWS, 1)  # of the stages 1 to 4
IN_R, IN_INERTIA = _by_stage(R_BY_GAMMA, 1), _by_stage(INERTIA, 1)  # of the stages 1 to 5

Workspace = namedtuple("Workspace", "chain column by_length by_speed speeds")
Workspace.__doc__ = """Scratch arrays of a step.

chain : `rosenbrock.Workspace`.  column : the solution y of (M/d - B - d K) y = F_u + d F_L.  by_length, by_speed : F_L [N/m]
and F_u [N s/m].  These three are flat arrays of 3 (n + 1) numbers.  speeds : U_u of all stages [m/s].
"""
Border = namedtuple("Border", "by_speed by_length turning damper direction rate")
Border.__doc__ = """Derivatives of f = T - W - c u - F sign(u) at the start of a step.

by_speed, by_length : f_u [N s/m], f_L [N/m].  turning : dT/dr of the first segment [N/m].  damper : dT/d(dl/dt) [N s/m].
direction : of the first segment.  rate : explicit time derivative [N/s].
"""
Motion = namedtuple("Motion", "length speed length_error speed_error")
Motion.__doc__ = "Length [m] and speed [m/s] of the drum after a step, and their error estimates."

NOTHING, TURNS, PAID_OUT, REELED_IN, RESTS_OUTWARDS, RESTS_INWARDS = range(6)  # events that end a piece
SMALLEST_PIECE = 1e-9  # of the communication step: the end of a shorter piece is not sought for
LOCATED = 1e-11  # of the length: how far a piece may end beyond a stop
SLOW = 1e-9  # of the length per second: the speed at which a drum comes to rest
OVERLOAD = 1e-8  # of its forces: with how much more than its friction a drum begins to turn
SHORTEST_PART, LONGEST_PART = 1e-6, 0.999  # of a piece in which an event happened, to try next
AT_ONCE = 1e-6  # part of the communication step in which a drum without mass makes good a jump of its force
MOST_CORRECTIONS = 30
EXACT, ROUGH, ROUNDING = 1e-13, 1e-10, 2.5e-16  # of T = W, relative; what is good enough where it gets no better; of T
MOST_CHANGE = 0.5  # of the length by one correction


@kernel
def workspace_size(n):
    """Length of the work array that `workspace` needs."""
    return rosenbrock.workspace_size(n) + 9 * (n + 1) + STAGES


@view
def workspace(n, work):
    """Cut the work array into the arrays of `Workspace`."""
    room, flat = behind(rosenbrock.workspace_size(n), work), 3 * (n + 1)
    vectors = part(room, 0, flat), part(room, flat, flat), part(room, 2 * flat, flat)
    return Workspace(rosenbrock.workspace(n, work), *vectors, part(room, 3 * flat, STAGES))


@view
def with_length(conditions, length):
    """`BoundaryConditions` of a tether whose unstretched length [m] stays."""
    n, parameters, ground, kite, low, high, _, force, force_rate, wind, load, load_rate = conditions
    reeling = (length, 0.0, 0.0, NEUTRAL)
    return BoundaryConditions(n, parameters, ground, kite, low, high, reeling, force, force_rate, wind, load, load_rate)


@view
def chain_with(conditions, length, speed):
    """The `Chain` with this unstretched length [m] and its rate [m/s]."""
    return chain_at(conditions.n, conditions.parameters, length, speed, conditions.wind)


@kernel
def first_tension(chain, x, v):
    """Tension of the first segment [N] with the nodes at x [m] and velocities v [m/s]."""
    length, e = segment.geometry(sub(get(x, 1), get(x, 0)))
    return segment.tension_of(chain, 0, segment.BY_LENGTH, length, dot(e, sub(get(v, 1), get(v, 0))))


# --- one step


@kernel
def put_column(conditions, chain, d, x, v, b):
    """F_L and F_u of all nodes into b.by_length, b.by_speed, and F_u + d F_L into b.column (all modified).

    w.force holds F at the start of the step: the mass grows with the length, and F/m falls.
    """
    n, w = conditions.n, b.chain
    growing = chain_with(conditions, chain.length, 1.0)
    assembly.rate_from_reeling(growing, w.records, b.by_length)
    if has_ground(chain.parameters):
        contact.add_rate(growing, x, v, w, b.by_length)
    for k in range(3 * (n + 1)):
        b.by_speed[k] = 0.0
    assembly.add_rate_from_acceleration(chain, 1.0, x, w.records, b.by_speed)
    for i in range(n + 1):
        share = (w.mass[i] - point_mass(chain, i)) / (w.mass[i] * chain.length)
        inertia = scale(-share, get_node(n, i, w.force))
        put(b.by_length, i, add(get(b.by_length, i), inertia))
        put(b.column, i, add_scaled(get(b.by_speed, i), d, get(b.by_length, i)))


@kernel
def border_of(conditions, drum, chain, time, x, w):
    """`Border` at a time [s] of the communication step; the records of the segments are those of the start of the step."""
    record = assembly.record_of(0, chain.n, w.records)
    e = segment.direction_in(record)
    damper = record[segment.DAMPER]
    turning = (
        e[0] * record[segment.K] + e[1] * record[segment.K + 3] + e[2] * record[segment.K + 6],
        e[0] * record[segment.K + 1] + e[1] * record[segment.K + 4] + e[2] * record[segment.K + 7],
        e[0] * record[segment.K + 2] + e[1] * record[segment.K + 5] + e[2] * record[segment.K + 8],
    )
    by_speed = -drum.damping
    if sees_reeling(chain.parameters):
        length, _ = segment.geometry(sub(get(x, 1), get(x, 0)))
        by_speed -= damper * length / chain.length
    by_length = record[segment.SLOPE] * property_of(chain, 0, at.SHARE)
    rate = -drum.force_rate
    if conditions.first == 1:
        moving, gaining = velocity_at(conditions.ground, time), acceleration_at(conditions.ground, time)
        rate -= dot(turning, moving) + damper * dot(e, gaining)
    if chain.n == 1 and conditions.last == 0:
        moving, gaining = velocity_at(conditions.kite, time), acceleration_at(conditions.kite, time)
        rate += dot(turning, moving) + damper * dot(e, gaining)
    return Border(by_speed, by_length, turning, damper, e, rate)


@kernel
def prepare(conditions, chain, time, h, x, v, w):
    """`rosenbrock.prepare` of a chain whose length is an unknown."""
    interleave(conditions.n, x, w.start_x)
    interleave(conditions.n, v, w.start_v)
    assembly.node_masses(chain, w.mass)
    assembly.linearize(chain, w.start_x, w.start_v, w.modes, w.segments, w.records, w.q)
    for k in range(3 * (conditions.n + 1)):
        w.q[k] = 0.0
    rosenbrock.add_explicit_rates(conditions, time, w)
    interleave(conditions.n, w.q, w.force_rate)
    rosenbrock.assemble(conditions, chain, GAMMA * h, x, v, w)
    return conditions.first > conditions.last or factorize(conditions.first, conditions.last, w.matrix)


@kernel
def solve_chain(conditions, w, right):
    """Solve the system of the chain for `right` (modified), a flat array; driven ends get 0."""
    if conditions.first <= conditions.last:
        solve(conditions.first, conditions.last, w.matrix, right)
    hold_ends(conditions, right)


@kernel
def added_up(start, factors, stage, b):
    """start + sum_j factors[stage, j] U_uj."""
    for j in range(stage):
        start += factors[stage, j] * b.speeds[j]
    return start


@kernel
def stage_tension(n, chain, x, v, w):
    """Tension of the first segment [N] at a stage, x [m] and v [m/s] interleaved, with its stiffness of the start."""
    x_p, x_q = assembly.lower_and_upper(n, 0, x)
    v_p, v_q = assembly.lower_and_upper(n, 0, v)
    length, e = segment.geometry(sub(first(x_q), first(x_p)))
    return segment.tension_of(chain, 0, w.modes[0], length, dot(e, sub(first(v_q), first(v_p))))


@kernel
def step(conditions, drum, direction, time, h, length, speed, x, v, b):
    """One step of h [s] from (x, v, length, speed) at a time [s] of the communication step: whether it was done, `Motion`.

    direction : in which the drum turns. The result stands as that of `rosenbrock.step`.
    """
    n, w, d = conditions.n, b.chain, GAMMA * h
    nothing = Motion(length, speed, inf, inf)
    chain = chain_with(conditions, length, speed)
    if not prepare(conditions, chain, time, h, x, v, w):
        return False, nothing
    border = border_of(conditions, drum, chain, time, x, w)
    ends, driven = rosenbrock.curves_of(conditions)
    pivot = 0.0
    here, pace = length, speed  # L_i and u_i
    p = gained = 0.0
    for stage in range(STAGES):
        rosenbrock.combine(stage, h, w)
        r = inertia = 0.0
        if stage < STAGES - 1:
            here = length + h * added_up(ALPHA[stage] * speed, IN_LENGTH, stage, b)
            pace = added_up(speed, IN_SPEED, stage, b)
        else:
            here, pace = here + d * p, pace + gained
        gamma = GAMMA_I[stage] / GAMMA
        r = added_up(gamma * speed, IN_R, stage, b)
        inertia = added_up(gamma * speed / GAMMA, IN_INERTIA, stage, b)
        if not 0.0 < here < inf:
            return False, nothing
        now = time + ALPHA[stage] * h
        rosenbrock.prescribe_ends(ends, driven, now, w)
        chain = chain_with(conditions, here, pace)
        if stage == 0:
            copy(w.mass, w.stage_mass)
        else:
            assembly.node_masses(chain, w.stage_mass)
        rosenbrock.stage_force(conditions, chain, now, w)
        if stage == 0:
            put_column(conditions, chain, d, x, v, b)
            solve_chain(conditions, w, b.column)
            response = sub(get(b.column, 1), get(b.column, 0))
            pull = border.damper * dot(border.direction, response) + d * dot(border.turning, response)
            pivot = drum.mass / d - border.by_speed - d * border.by_length - pull
            if not 0.0 < pivot < inf:
                return False, nothing
        rosenbrock.right_hand_side(conditions, stage, h, w)
        for k in range(3 * (n + 1)):
            w.q[k] -= r * b.by_speed[k]
        solve_chain(conditions, w, w.q)
        moved = sub(get(w.q, 1), get(w.q, 0))
        r_p, r_q = assembly.lower_and_upper(n, 0, w.r)
        still = dot(border.direction, sub(first(r_q), first(r_p)))
        right = balance(drum, direction, stage_tension(n, chain, w.stage_x, w.stage_v, w), pace, now)
        right += drum.mass * inertia / h - border.damper * still - border.by_speed * r + GAMMA_I[stage] * h * border.rate
        right += border.damper * dot(border.direction, moved) + d * dot(border.turning, moved)
        p = right / pivot
        gained = p - r
        b.speeds[stage] = gained
        for k in range(3 * (n + 1)):
            w.q[k] += p * b.column[k]
        rosenbrock.take_velocities(n, stage, w)
        if stage >= STAGES - 2:
            rosenbrock.add_stage(n, stage, h, w)
    rosenbrock.take_result(conditions, time + h, w)
    return True, Motion(here + d * p, pace + gained, d * p, gained)


# --- a drum without mass


@kernel
def project(conditions, drum, direction, time, d, length, speed, x, v):
    """Length [m] and speed [m/s] at which a drum without mass has T = W + c u + F sign(u); and whether they are found.

    With the nodes at x [m] and velocities v [m/s], at a time [s] of the communication step. The length changes by d times
    what the speed changes by, as in an implicit step; where no damper feels the speed, it changes alone.
    """
    felt = drum.damping > 0.0 or (sees_reeling(conditions.parameters) and property_of(conditions, 0, at.DAMPING) > 0.0)
    size = abs(force_at(drum, time)) + drum.friction
    moved, e = segment.geometry(sub(get(x, 1), get(x, 0)))
    rate = dot(e, sub(get(v, 1), get(v, 0)))
    last = inf
    for _ in range(MOST_CORRECTIONS):
        chain = chain_with(conditions, length, speed)
        rest = rest_length(chain, 0)
        k, c = segment.stiffness(chain, 0, moved - rest, rest)
        tension = segment.tension(chain, moved, rate, rest, k, c)
        wrong = balance(drum, direction, tension, speed, time)
        rounding = ROUNDING * (k * moved + c * abs(rate))
        if abs(wrong) <= EXACT * size + rounding or (abs(wrong) >= 0.5 * last and abs(wrong) <= ROUGH * size + rounding):
            return length, speed, True
        last = abs(wrong)
        slope = -(k * moved + c * (rate - 2.0 * chain.seen_growth * moved)) / length  # dT/dL
        by_speed = -drum.damping - (c * moved / length if sees_reeling(chain.parameters) else 0.0)
        if felt:
            change = -wrong / (by_speed + d * slope)
            change = max(-MOST_CHANGE * length, min(MOST_CHANGE * length, d * change))
            length += change
            speed += change / d
        else:
            change = -wrong / slope
            length += max(-MOST_CHANGE * length, min(MOST_CHANGE * length, change))
        if not (0.0 < length < inf and abs(speed) < inf):
            return length, speed, False
    return length, speed, False


# --- the steps within a communication step


@kernel
def drum_error(conditions, drum, motion, speed, v):
    """Error of `Motion` over what is allowed [-]: as of a node that moves with it, from its speed at the start [m/s]."""
    position_scale, velocity_scale = step_control.allowed_errors(conditions, v)
    error = abs(motion.length_error) / position_scale
    if drum.mass == 0.0:
        return error
    fastest = max(abs(speed), abs(motion.speed))
    return max(error, abs(motion.speed_error) / max(velocity_scale, conditions.parameters[at.RELATIVE_TOLERANCE] * fastest))


@kernel
def held_step(conditions, time, h, length, x, v, w):
    """One step of h [s] with a drum that is held at a length [m]; whether it was done."""
    if conditions.first <= conditions.last:
        return rosenbrock.step(with_length(conditions, length), time, h, x, v, w)
    place_ends(conditions, time + h, w.x, w.v)
    return True


@kernel
def room_left(conditions, drum, event, time, length, speed, x, v):
    """How far the drum is from an event; below 0 it has happened. And how much below 0 is as good as 0.

    The force [N] that a drum which is held lacks to turn; the length [m] to a stop; the speed [m/s] until it is at rest. The
    nodes are at x [m] with the velocities v [m/s] at a time [s] of the communication step.
    """
    if event == TURNS:
        tension = first_tension(chain_with(conditions, length, 0.0), x, v)
        return freedom(drum, length, tension, time), OVERLOAD * (abs(tension) + abs(force_at(drum, time)) + drum.friction)
    if event == PAID_OUT:
        return drum.longest - length, LOCATED * length
    if event == REELED_IN:
        return length - drum.shortest, LOCATED * length
    return speed if event == RESTS_OUTWARDS else -speed, SLOW * length


@kernel
def is_over(conditions, drum, event, time, length, speed, x, v):
    """Whether an event has happened."""
    room, margin = room_left(conditions, drum, event, time, length, speed, x, v)
    return room < -margin


@kernel
def first_event(conditions, drum, direction, time, length, speed, x, v):
    """An event that has happened to a drum that turned in a direction or was held, or NOTHING; arguments of `room_left`."""
    state = (time, length, speed, x, v)
    if direction == HELD:
        return TURNS if is_over(conditions, drum, TURNS, *state) else NOTHING
    for stop in (PAID_OUT, REELED_IN):
        if is_over(conditions, drum, stop, *state):
            return stop
    rests = RESTS_OUTWARDS if direction > 0.0 else RESTS_INWARDS
    if drum.friction > 0.0 and drum.mass > 0.0 and is_over(conditions, drum, rests, *state):
        return rests
    return NOTHING


@kernel
def turn(conditions, drum, turned_back, time, duration, length, speed, x, v):
    """How the drum turns next: direction, length [m], speed [m/s]; and whether a drum without mass can do so.

    turned_back : whether a drum without mass has turned round under friction, which holds it. duration : of the
    communication step [s].
    """
    tension = first_tension(chain_with(conditions, length, 0.0), x, v)
    direction = HELD if turned_back else direction_of(drum, length, speed, tension, time)
    if direction == HELD:
        return HELD, length, 0.0, True
    if drum.mass > 0.0:
        return direction, length, speed if speed * direction > 0.0 else 0.0, True
    length, speed, found = project(conditions, drum, direction, time, AT_ONCE * duration, length, speed, x, v)
    if is_at_stop(drum, length, direction):
        return HELD, stop_ahead(drum, direction), 0.0, True
    return direction, length, speed, found


@kernel
def integrate(conditions, duration, state, x, v, b):
    """Advance (x, v) (modified) over a communication step of `duration` [s] as `step_control.integrate` does, with a drum.

    Length and speed of the drum, solver memory and counters in `state` are modified. Returns a status: OK,
    STEP_BUDGET_SPENT, STEP_TOO_SMALL or NO_LENGTH.
    """
    w = b.chain
    drum = drum_of(conditions.parameters, conditions.force, conditions.force_rate)
    length, speed = state[at.LENGTH], state[at.REELING]
    h, last_error = step_control.first_step(duration, state)
    budget = at.WORK_BUDGET // conditions.n
    time = 0.0
    tried = 0
    rejected_before = turned_back = False
    is_new = True  # whether a piece begins
    direction, piece, weight = HELD, inf, 1.0
    beyond = 0.0  # time at which the next event is known to be over, 0 without
    while time < duration:
        if tried >= budget:
            return STEP_BUDGET_SPENT
        if h < step_control.SMALLEST_STEP * duration:
            return STEP_TOO_SMALL
        tried += 1
        if is_new:
            direction, length, speed, found = turn(conditions, drum, turned_back, time, duration, length, speed, x, v)
            if not found:
                return NO_LENGTH
            is_new, piece, weight = False, beyond - time if beyond > time else inf, 1.0
        rest = duration - time
        left = ceil(rest / h - 1e-6)
        h_now = rest / left if left > 1.0 else rest
        whole = not (left > 1.0 or piece < h_now)
        h_now = min(h_now, piece)
        error = inf
        motion = Motion(length, 0.0, 0.0, 0.0)
        done = False
        if direction == HELD:
            done = held_step(conditions, time, h_now, length, x, v, w)
        else:
            done, motion = step(conditions, drum, direction, time, h_now, length, speed, x, v, b)
        end = time + h_now
        new_length, new_speed = motion.length, motion.speed
        if done and new_length > 0.0:
            error = drum_error(conditions, drum, motion, speed, v)
            if conditions.first <= conditions.last:
                chain = chain_with(conditions, new_length, new_speed)
                of_chain = step_control.error_of_step(conditions, chain, h_now, v, w)
                error = error if of_chain <= error else of_chain  # also where it is no number
        if error <= 1.0 and direction != HELD and drum.mass == 0.0:
            d = GAMMA * h_now
            new_length, new_speed, found = project(conditions, drum, direction, end, d, new_length, new_speed, w.x, w.v)
            if not found:
                error = inf
        if not error <= 1.0:
            rejected_before = True
            h = step_control.cut(h_now, error)
            state[at.REJECTIONS] += 1.0
            continue
        event = first_event(conditions, drum, direction, end, new_length, new_speed, w.x, w.v)
        if event != NOTHING and h_now > SMALLEST_PIECE * duration:
            room, _ = room_left(conditions, drum, event, time, length, speed, x, v)
            over, _ = room_left(conditions, drum, event, end, new_length, new_speed, w.x, w.v)
            room = max(weight * room, 0.0)
            piece = h_now * max(SHORTEST_PART, min(LONGEST_PART, room / (room - over)))
            weight *= 0.5  # if the next piece is too long again, the one after it will not be
            beyond = end
            state[at.REJECTIONS] += 1.0
            continue
        time = duration if whole else end
        copy(w.x, x)
        copy(w.v, v)
        length, speed = new_length, new_speed
        turned_back = False
        if event != NOTHING:
            beyond = 0.0
        if direction != HELD:
            way = OUTWARDS if speed > 0.0 else INWARDS
            if is_at_stop(drum, length, way):
                length, speed = stop_ahead(drum, way), 0.0
            elif drum.friction > 0.0 and speed * direction < 0.0:
                speed, turned_back = 0.0, drum.mass == 0.0
        is_new = True
        h = step_control.next_step(h, h_now, error, last_error, rejected_before)
        last_error = error
        rejected_before = False
        state[at.STEPS] += 1.0
    state[at.LENGTH], state[at.REELING] = length, speed
    state[at.SOLVER_STEP], state[at.SOLVER_ERROR] = h, last_error
    return OK
