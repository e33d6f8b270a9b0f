"""When the drum of a force-controlled winch begins to turn or comes to rest, and the piece of time to try that ends there.

Of chains (`motion/events.py`) and of tethers in equilibrium (`drum_in_equilibrium.py`) alike. Events are sought by the room
that is left until they happen; a piece in which it falls below 0 is tried again, shorter.
"""

from ..compilation import kernel
from ..equations.drum import HELD, direction_of, force_at, freedom

SMALLEST_PIECE = 1e-9  # of the communication step: the end of a shorter piece is not sought for
SLOW = 1e-9  # of the length per second: the speed at which a drum comes to rest
OVERLOAD = 1e-8  # of its forces: with how much more than its friction a drum begins to turn
SHORTEST_PART, LONGEST_PART = 1e-6, 0.999  # of a piece in which an event happened, to try next


@kernel
def may_change(drum, direction):
    """Whether a drum that turns in a direction, or is held, may come to rest, or turn, without a stop."""
    return direction == HELD or (drum.friction > 0.0 and drum.mass > 0.0)


@kernel
def room_to_change(drum, direction, time, length, speed, tension):
    """Force [N] that a held drum lacks to turn, or speed [m/s] of another until it rests; how far below 0 is as good as 0.

    At a length [m] with a speed [m/s]; tension : of the first segment [N] at this time [s] of the communication step.
    """
    if direction == HELD:
        return freedom(drum, length, tension, time), OVERLOAD * (abs(tension) + abs(force_at(drum, time)) + drum.friction)
    return speed * direction, SLOW * length


@kernel
def part_of_piece(room, over):
    """Part of a piece of time to try next [-], in which the room to an event fell from `room` to `over`, below 0."""
    room = max(room, 0.0)
    return max(SHORTEST_PART, min(LONGEST_PART, room / (room - over)))


@kernel
def next_motion(drum, is_held, time, length, speed, tension):
    """Direction in which a drum turns next, and the speed [m/s] with which it does; is_held : whether friction holds it.

    Other arguments as of `room_to_change`.
    """
    direction = HELD if is_held else direction_of(drum, length, speed, tension, time)
    rests = direction == HELD or (drum.mass > 0.0 and speed * direction < 0.0)
    return direction, 0.0 if rests else speed
