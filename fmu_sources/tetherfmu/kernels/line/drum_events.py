"""Events of the drum of a force-controlled winch (it starts or comes to rest), and the piece of time that ends there.

Used for chains (`motion/events.py`) and for tethers in equilibrium (`drum_in_equilibrium.py`). An event is located by its
margin; a piece in which the margin falls below 0 is repeated, shorter.
"""

from ..compilation import kernel
from ..equations.drum import HELD, direction_of, force_at, freedom

SMALLEST_PIECE = 1e-9  # of the communication step: shorter pieces are not refined
SLOW = 1e-9  # of the length per second: below this speed a drum is at rest
OVERLOAD = 1e-8  # fraction of the forces by which the load must exceed friction to start a drum
SHORTEST_PART, LONGEST_PART = 1e-6, 0.999  # of a piece in which an event happened, to try next


@kernel
def may_change(drum, direction):
    """Whether a drum, turning in a direction or held, may come to rest or start without a stop."""
    return direction == HELD or (drum.friction > 0.0 and drum.mass > 0.0)


@kernel
def room_to_change(drum, direction, time, length, speed, tension):
    """Force [N] missing to turn a held drum, or speed [m/s] of a turning drum until rest; and the tolerance of 0.

    At a length [m] with a speed [m/s]; tension : of the first segment [N] at this time [s] of the communication step.
    """
    if direction == HELD:
        return freedom(drum, length, tension, time), OVERLOAD * (abs(tension) + abs(force_at(drum, time)) + drum.friction)
    return speed * direction, SLOW * length


@kernel
def part_of_piece(room, over):
    """Fraction of a piece to try next [-], in which the margin fell from `room` to `over`, below 0."""
    room = max(room, 0.0)
    return max(SHORTEST_PART, min(LONGEST_PART, room / (room - over)))


@kernel
def next_motion(drum, is_held, time, length, speed, tension):
    """Next direction of a drum, and its speed [m/s]; is_held : whether friction holds it.

    Other arguments as for `room_to_change`.
    """
    direction = HELD if is_held else direction_of(drum, length, speed, tension, time)
    rests = direction == HELD or (drum.mass > 0.0 and speed * direction < 0.0)
    return direction, 0.0 if rests else speed
