"""The steps of a chain with the drum of a winch (`drum_step.py`) within a communication step.

A piece of the step ends where the drum begins to turn, comes to rest or comes to a stop: it is tried again with another
length until it ends there (`room_left`). Without mass f = 0 is an algebraic equation, and what an error of the step leaves
of it is taken away by `project`. See docs/models/numerics.md, "A drum in the same system".
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import segment
from ..equations.drum import (
    HELD,
    INWARDS,
    OUTWARDS,
    balance,
    direction_of,
    force_at,
    is_at_stop,
    stop_ahead,
)
from ..equations.properties import property_of, rest_length, sees_reeling
from ..linear_algebra.vectors import dot, get, sub
from . import step_control
from .drum_events import SLOW, room_to_turn
from .drum_step import chain_with, first_tension
from .taut_slack import drum_transition_error

NOTHING, TURNS, PAID_OUT, REELED_IN, RESTS_OUTWARDS, RESTS_INWARDS = range(6)  # events that end a piece
LOCATED = 1e-11  # of the length: how far a piece may end beyond a stop
MOST_IDLE = 100  # pieces one after the other, in which no drum turns, that are so short that rounding keeps its tension
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
