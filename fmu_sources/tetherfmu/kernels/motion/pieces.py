"""The drums within a communication step of the adaptive solver: how they turn, and where a piece of the step ends.

A piece ends with the first event of any drum; `moving_drum.py` says what is one.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from ..equations.boundary import chain_with
from ..equations.drum import HELD, INWARDS, OUTWARDS, is_at_stop, stop_ahead
from ..equations.lines import conditions_of, lines_of, motion_of, note_line, state_of
from ..equations.properties import sees_reeling
from ..equations.rope_at_drum import feels_rope
from ..line.drum_events import next_motion, part_of_piece
from ..line.moving_drum import NOTHING, Instant, first_event, project, room_left, tension_at_rest
from ..line.rodas4p import GAMMA
from ..line.step_control import DrumError, allowed_errors
from ..line.taut_slack import wrong_impulse
from ..points import drum_tension
from ..points import sheave_room as at_sheave
from ..points import system_room as at_line
from ..points.sheave_room import change_of_portion, is_running, numbers_at
from ..points.system_room import drum_at, has_drum, integrator_of, length_of, numbers_of
from .stopped_drums import put_reeling_speed

MOST_IDLE = 100  # pieces one after the other, in which no drum turns, that are so short that rounding keeps its tension
AT_ONCE = 1e-6  # part of the communication step in which a drum without mass makes good a jump of its force


@view
def before_step(system, k, time):
    """`Instant` of line k, which has a drum, at the start of a step, a time [s] of the communication step."""
    return Instant(time, *length_of(system, k), *motion_of(system, k))


@view
def after_step(system, k, time):
    """`Instant` of the result of a step that ends at a time [s]."""
    numbers, w = numbers_of(system, k), integrator_of(system, k)
    return Instant(time, numbers[at_line.LENGTH], numbers[at_line.SPEED], w.x, w.v)


@kernel
def tension_if_held(system, k, now, is_after):
    """Tension [N] at the drum of line k at an `Instant`, were it at rest; is_after : of the result of a step."""
    conditions = conditions_of(system, k)
    if feels_rope(conditions.parameters):
        still = Instant(now.time, now.length, 0.0, now.x, now.v)
        return drum_tension.tension_at_rest(system, k, still, is_after)
    return tension_at_rest(conditions, now)


@kernel
def begin_drums(system):
    """Let the drums (modified) begin a communication step."""
    for k in range(lines_of(system)):
        numbers_of(system, k)[at_line.TURNED_BACK] = 0.0


@kernel
def turn_drum(system, k, time, duration):
    """Let the drum of line k (modified) turn, or be held, from a time [s] on; False if one without mass cannot."""
    conditions, drum, numbers = conditions_of(system, k), drum_at(system, k), numbers_of(system, k)
    now, is_held, found = before_step(system, k, time), numbers[at_line.TURNED_BACK] != 0.0, True
    length, tension = now.length, tension_if_held(system, k, now, False)
    direction, speed = next_motion(drum, is_held, time, length, now.speed, tension)
    if direction != HELD and drum.mass == 0.0:
        length, speed, found = project(conditions, drum, direction, AT_ONCE * duration, now)
        if is_at_stop(drum, length, direction):
            direction, length, speed, found = HELD, stop_ahead(drum, direction), 0.0, True
    numbers[at_line.DIRECTION] = direction
    if direction == HELD:
        state_of(system, k)[at.ACCELERATION] = 0.0
    put_reeling_speed(system, k, length, speed, now.speed)
    return found


@kernel
def turn_drums(system, time, duration):
    """`turn_drum` of all drums (modified); False if one cannot.  duration : of the communication step [s].

    The plan (modified) then says which line it is.
    """
    for k in range(lines_of(system)):
        if has_drum(system, k) and not turn_drum(system, k, time, duration):
            note_line(system.plan, k)
            return False
    return True


@view
def drum_error(system, k):
    """`DrumError` of line k."""
    if is_running(system, k):
        length = change_of_portion(system, k, at_sheave.SOLUTION)
        speed = change_of_portion(system, k, at_sheave.INCREMENT)
        return DrumError(length, speed / numbers_at(system, k)[at_sheave.LENGTH], inf)
    if not has_drum(system, k):
        return DrumError(0.0, 0.0, inf)
    numbers, mass = numbers_of(system, k), drum_at(system, k).mass
    seen = sees_reeling(conditions_of(system, k).parameters)
    growth = numbers[at_line.INCREMENT] / numbers[at_line.LENGTH] if seen else 0.0
    return DrumError(numbers[at_line.SOLUTION], growth, inf if numbers[at_line.DIRECTION] == HELD else mass)


@kernel
def error_of_drum(system, k, h):
    """Error of the drum of line k in a step of h [s] over what is allowed [-], as of a node that moves with it.

    inf if it has no length any more.
    """
    conditions, drum, numbers = conditions_of(system, k), drum_at(system, k), numbers_of(system, k)
    _, v = motion_of(system, k)
    if not numbers[at_line.LENGTH] > 0.0:
        return inf
    position_scale, velocity_scale = allowed_errors(conditions, v)
    error = abs(GAMMA * h * numbers[at_line.SOLUTION]) / position_scale
    if numbers[at_line.DIRECTION] == HELD or drum.mass == 0.0:
        return error
    _, speed = length_of(system, k)
    fastest = max(abs(speed), abs(numbers[at_line.SPEED]))
    velocity_scale = max(velocity_scale, conditions.parameters[at.RELATIVE_TOLERANCE] * fastest)
    error = max(error, abs(numbers[at_line.INCREMENT]) / velocity_scale)
    chain = chain_with(conditions, numbers[at_line.LENGTH], numbers[at_line.SPEED])
    transition = wrong_impulse(0, chain, h, integrator_of(system, k)) / drum.mass / velocity_scale
    return max(error, transition * transition) if transition > 1.0 else error


@kernel
def project_drums(system, time, h):
    """`moving_drum.project` in the result of a step of h [s] to a time [s], of all drums without mass; whether all can."""
    for k in range(lines_of(system)):
        drum, numbers = drum_at(system, k), numbers_of(system, k)
        direction = numbers[at_line.DIRECTION]
        if has_drum(system, k) and direction != HELD and drum.mass == 0.0:
            conditions, now = conditions_of(system, k), after_step(system, k, time)
            length, speed, found = project(conditions, drum, direction, GAMMA * h, now)
            numbers[at_line.LENGTH], numbers[at_line.SPEED] = length, speed
            if not found:
                return False
    return True


@kernel
def part_to_event(system, time, h, weight):
    """Part of the step of h [s] from a time [s] after which the first event is expected; inf if none has happened in it.

    weight : of the way to it, below 1 where the last piece was too long.
    """
    least = inf
    for k in range(lines_of(system)):
        if has_drum(system, k):
            drum, direction = drum_at(system, k), numbers_of(system, k)[at_line.DIRECTION]
            after = after_step(system, k, time + h)
            tension = tension_if_held(system, k, after, True) if direction == HELD else 0.0
            event, over = first_event(drum, direction, after, tension)
            if event != NOTHING:
                now = before_step(system, k, time)
                tension = tension_if_held(system, k, now, False) if direction == HELD else 0.0
                before, _ = room_left(drum, direction, event, now, tension)
                least = min(least, part_of_piece(weight * before, over))
    return least


@kernel
def accept_drum(system, k):
    """Let the drum of line k (modified) have the results of the step.

    At a stop it rests, and so does one that friction brings to rest; one without mass is then held.
    """
    drum, numbers = drum_at(system, k), numbers_of(system, k)
    length, speed, direction = numbers[at_line.LENGTH], numbers[at_line.SPEED], numbers[at_line.DIRECTION]
    way = OUTWARDS if speed > 0.0 else INWARDS
    is_stopped = direction != HELD and is_at_stop(drum, length, way)
    is_turned = not is_stopped and drum.friction > 0.0 and speed * direction < 0.0
    numbers[at_line.TURNED_BACK] = 1.0 if is_turned and drum.mass == 0.0 else 0.0
    length = stop_ahead(drum, way) if is_stopped else length
    put_reeling_speed(system, k, length, 0.0 if is_stopped or is_turned else speed, speed)
