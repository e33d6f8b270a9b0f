"""When the drum of a force-controlled winch begins to turn or comes to rest, and the piece of time to try that ends there.

Of chains (`moving_drum.py`) and of tethers in equilibrium (`drum_in_equilibrium.py`) alike. Events are sought by the room
that is left until they happen; a piece in which it falls below 0 is tried again, shorter.
"""

from ..compilation import kernel
from ..equations.drum import force_at, freedom

SMALLEST_PIECE = 1e-9  # of the communication step: the end of a shorter piece is not sought for
SLOW = 1e-9  # of the length per second: the speed at which a drum comes to rest
OVERLOAD = 1e-8  # of its forces: with how much more than its friction a drum begins to turn
SHORTEST_PART, LONGEST_PART = 1e-6, 0.999  # of a piece in which an event happened, to try next


@kernel
def room_to_turn(drum, length, tension, time):
    """Force [N] that a drum which is held at a length [m] lacks to turn; and how much below 0 is as good as 0.

    tension : of the first segment [N] at this time [s] of the communication step.
    """
    return freedom(drum, length, tension, time), OVERLOAD * (abs(tension) + abs(force_at(drum, time)) + drum.friction)


@kernel
def part_of_piece(room, over):
    """Part of a piece of time to try next [-], in which the room to an event fell from `room` to `over`, below 0."""
    room = max(room, 0.0)
    return max(SHORTEST_PART, min(LONGEST_PART, room / (room - over)))
