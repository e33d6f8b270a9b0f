"""Events of a drum (it starts or comes to rest), and the piece of time that ends there.

Used with waves (`motion/events.py`) and in equilibrium (`drum_in_equilibrium.py`). An event is located by its margin,
which has a tolerance of 0; a piece in which it falls below 0 is repeated, shorter.
"""

from ..compilation import kernel

SMALLEST_PIECE = 1e-9  # of the communication step: shorter pieces are not refined
SLOW = 1e-9  # of the length per second: below this speed a drum is at rest
OVERLOAD = 1e-8  # fraction of the forces by which the load must exceed friction to start a drum
SHORTEST_PART, LONGEST_PART = 1e-6, 0.999  # of a piece in which an event happened, to try next


@kernel
def room_to_rest(direction, speed, length):
    """Speed [m/s] in a direction, at 0 of which a drum comes to rest; and the tolerance of 0, at a length [m]."""
    return speed * direction, SLOW * length


@kernel
def urges(pull, friction, size):
    """Forces [N] beyond friction that turn a drum forwards and backwards, and the tolerance of 0.

    pull : T - W [N].  size : of all forces [N].
    """
    return pull - friction, -pull - friction, OVERLOAD * size


@kernel
def turns_round(friction, direction, speed):
    """Whether friction brings a drum to rest, because its speed [m/s] has become opposite to its direction."""
    return friction != 0.0 and direction * speed < 0.0


@kernel
def part_of_piece(room, over):
    """Fraction of a piece to try next [-], in which the margin fell from `room` to `over`, below 0."""
    room = max(room, 0.0)
    return max(SHORTEST_PART, min(LONGEST_PART, room / (room - over)))
