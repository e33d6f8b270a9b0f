"""The drums within a communication step of the adaptive solver: how they turn, and where a piece of the step ends.

A piece ends with the first event of any drum; `moving_drum.py` says what is one.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations.drum import HELD
from ..equations.lines import conditions_of, lines_of, motion_of, state_of
from ..equations.plan import note_line
from ..line.drum_events import part_of_piece
from ..line.drum_step import Motion
from ..line.moving_drum import (
    NOTHING,
    drum_error,
    first_event,
    project,
    room_left,
    speed_after,
    turn,
)
from ..points.system_drums import drum_at, length_of
from ..points.system_room import (
    DIRECTION,
    LENGTH_ERROR,
    NEW_LENGTH,
    NEW_SPEED,
    SPEED_ERROR,
    TURNED_BACK,
    has_drum,
    integrator_of,
)


@kernel
def begin_drums(system):
    """Let the drums begin a communication step; whether there are any."""
    count = 0
    for k in range(lines_of(system)):
        if has_drum(system, k):
            integrator_of(system, k).numbers[TURNED_BACK] = 0.0
            count += 1
    return count > 0


@kernel
def turn_drums(system, time, duration):
    """Let all drums turn, or be held, from a time [s] of the communication step; False if one without mass cannot.

    The plan (modified) then says which line it is.  duration : of the communication step [s].
    """
    for k in range(lines_of(system)):
        if has_drum(system, k):
            conditions, numbers, state = conditions_of(system, k), integrator_of(system, k).numbers, state_of(system, k)
            x, v = motion_of(system, k)
            turned_back, drum = numbers[TURNED_BACK] != 0.0, drum_at(conditions)
            direction, length, speed, found = turn(
                conditions, drum, turned_back, time, duration, *length_of(system, k), x, v
            )
            numbers[DIRECTION], state[at.LENGTH], state[at.REELING] = direction, length, speed
            if not found:
                note_line(system.plan, k)
                return False
    return True


@kernel
def error_of_drum(system, k, h):
    """Error of the drum of line k in the step of h [s], see `moving_drum.drum_error`; inf if it has no length any more."""
    conditions, room = conditions_of(system, k), integrator_of(system, k)
    numbers = room.numbers
    if not numbers[NEW_LENGTH] > 0.0:
        return inf
    _, v = motion_of(system, k)
    motion = Motion(numbers[NEW_LENGTH], numbers[NEW_SPEED], numbers[LENGTH_ERROR], numbers[SPEED_ERROR])
    _, speed = length_of(system, k)
    return drum_error(conditions, drum_at(conditions), numbers[DIRECTION], motion, speed, h, v, room.w)


@kernel
def project_drums(system, time, d):
    """`moving_drum.project` in the result of a step that ends at a time [s], of all drums without mass; whether all can."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            conditions, room = conditions_of(system, k), integrator_of(system, k)
            numbers, drum = room.numbers, drum_at(conditions)
            direction = numbers[DIRECTION]
            if direction != HELD and drum.mass == 0.0:
                length, speed, found = project(
                    conditions, drum, direction, time, d, numbers[NEW_LENGTH], numbers[NEW_SPEED], room.w.x, room.w.v
                )
                numbers[NEW_LENGTH], numbers[NEW_SPEED] = length, speed
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
            conditions, room = conditions_of(system, k), integrator_of(system, k)
            numbers, w, drum = room.numbers, room.w, drum_at(conditions)
            x, v = motion_of(system, k)
            after = time + h, numbers[NEW_LENGTH], numbers[NEW_SPEED], w.x, w.v
            event = first_event(conditions, drum, numbers[DIRECTION], *after)
            if event != NOTHING:
                before, _ = room_left(conditions, drum, event, time, *length_of(system, k), x, v)
                over, _ = room_left(conditions, drum, event, *after)
                least = min(least, part_of_piece(weight * before, over))
    return least


@kernel
def accept_drums(system):
    """Let the drums (modified) have the results of the step."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, state = integrator_of(system, k).numbers, state_of(system, k)
            drum, direction = drum_at(conditions_of(system, k)), numbers[DIRECTION]
            length, speed, turned_back = speed_after(drum, direction, numbers[NEW_LENGTH], numbers[NEW_SPEED])
            state[at.LENGTH], state[at.REELING], numbers[TURNED_BACK] = length, speed, 1.0 if turned_back else 0.0
