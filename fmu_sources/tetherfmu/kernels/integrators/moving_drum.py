"""The steps of a chain with the drum of a winch (`drum_step.py`) within a communication step.

A piece of the step ends where the drum begins to turn, comes to rest or comes to a stop: it is tried again with another
length until it ends there (`room_left`). Without mass f = 0 is an algebraic equation, and what an error of the step leaves
of it is taken away by `project`. See docs/models/numerics.md, "A drum in the same system".
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_LENGTH, OK, STEP_BUDGET_SPENT, STEP_TOO_SMALL

from ..arrays import copy
from ..compilation import kernel
from ..equations import segment
from ..equations.boundary import place_ends
from ..equations.drum import (
    HELD,
    INWARDS,
    OUTWARDS,
    balance,
    direction_of,
    drum_of,
    force_at,
    is_at_stop,
    stop_ahead,
)
from ..equations.properties import property_of, rest_length, sees_reeling
from ..linear_algebra.vectors import dot, get, sub
from . import rosenbrock, step_control
from .drum_events import SLOW, SMALLEST_PIECE, part_of_piece, room_to_turn
from .drum_step import Motion, chain_with, first_tension, step, with_length
from .rodas4p import GAMMA
from .taut_slack import drum_transition_error, keep_energy_of_drum

NOTHING, TURNS, PAID_OUT, REELED_IN, RESTS_OUTWARDS, RESTS_INWARDS = range(6)  # events that end a piece
LOCATED = 1e-11  # of the length: how far a piece may end beyond a stop
MOST_IDLE = 100  # pieces one after the other, in which a drum is held, that are so short that rounding keeps its tension
AT_ONCE = 1e-6  # part of the communication step in which a drum without mass makes good a jump of its force
MOST_CORRECTIONS = 30
EXACT, ROUGH, ROUNDING = 1e-13, 1e-10, 2.5e-16  # of T = W, relative; what is good enough where it gets no better; of T
MOST_CHANGE = 0.5  # of the length by one correction


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
def drum_error(conditions, drum, direction, motion, speed, h, v, w):
    """Error of `Motion` in a step of h [s] over what is allowed [-]: as of a node that moves with it.

    direction, speed [m/s] : of the drum at the start.  v : velocities of the nodes there [m/s].
    """
    position_scale, velocity_scale = step_control.allowed_errors(conditions, v)
    error = abs(motion.length_error) / position_scale
    if direction == HELD or drum.mass == 0.0:
        return error
    fastest = max(abs(speed), abs(motion.speed))
    velocity_scale = max(velocity_scale, conditions.parameters[at.RELATIVE_TOLERANCE] * fastest)
    error = max(error, abs(motion.speed_error) / velocity_scale)
    transition = drum_transition_error(drum, chain_with(conditions, motion.length, motion.speed), h, w) / velocity_scale
    return max(error, transition * transition) if transition > 1.0 else error


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
        return room_to_turn(drum, length, first_tension(chain_with(conditions, length, 0.0), x, v), time)
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
def speed_after(drum, direction, length, speed):
    """Length [m] and speed [m/s] with which the drum goes on after a step in a direction; and whether it has turned round.

    At a stop it rests, and so does one that friction brings to rest; one without mass is then held.
    """
    if direction == HELD:
        return length, speed, False
    way = OUTWARDS if speed > 0.0 else INWARDS
    if is_at_stop(drum, length, way):
        return stop_ahead(drum, way), 0.0, False
    if drum.friction > 0.0 and speed * direction < 0.0:
        return length, 0.0, drum.mass == 0.0
    return length, speed, False


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
    idle = 0
    while time < duration:
        if step_control.is_given_up(state, tried, budget, time, duration):
            return STEP_BUDGET_SPENT
        if h < step_control.SMALLEST_STEP * duration:
            return STEP_TOO_SMALL
        tried += 1
        if is_new:
            direction, length, speed, found = turn(conditions, drum, turned_back, time, duration, length, speed, x, v)
            if not found:
                return NO_LENGTH
            is_new, piece, weight = False, beyond - time if beyond > time else inf, 1.0
        h_now, is_last = step_control.even_step(duration - time, h)
        is_last = is_last and not piece < h_now
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
            error = drum_error(conditions, drum, direction, motion, speed, h_now, v, w)
            chain = chain_with(conditions, new_length, new_speed)
            if conditions.first > conditions.last:
                new_speed = keep_energy_of_drum(drum, chain, w) if direction != HELD else new_speed
            else:
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
        if event != NOTHING and h_now > SMALLEST_PIECE * duration and idle < MOST_IDLE:
            room, _ = room_left(conditions, drum, event, time, length, speed, x, v)
            over, _ = room_left(conditions, drum, event, end, new_length, new_speed, w.x, w.v)
            piece = h_now * part_of_piece(weight * room, over)
            weight *= 0.5  # if the next piece is too long again, the one after it will not be
            beyond = end
            state[at.REJECTIONS] += 1.0
            continue
        time = duration if is_last else end
        copy(w.x, x)
        copy(w.v, v)
        length, speed, turned_back = speed_after(drum, direction, new_length, new_speed)
        if event != NOTHING:
            beyond = 0.0
        idle = idle + 1 if direction == HELD and h_now < SMALLEST_PIECE * duration else 0
        is_new = True
        proposal = step_control.next_step(h, h_now, error, last_error, rejected_before)
        h = step_control.step_after_event(h, h_now, proposal, duration)
        last_error = error
        rejected_before = False
        state[at.STEPS] += 1.0
    state[at.LENGTH], state[at.REELING] = length, speed
    state[at.SOLVER_STEP], state[at.SOLVER_ERROR] = h, last_error
    return OK
