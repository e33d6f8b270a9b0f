"""A line that broke, or has let go at its end: a segment that holds nothing stands where it is parted.

    broken     segment s has no stiffness, no damper and no drag any more. Its mass stays in halves on the two nodes that it
               joined, which are the new ends; no node gets another mass or velocity, so the momentum is kept. The energy of
               its spring is lost.
    let go     the line has one segment more, which has no mass either. It joins the last node, now free with its half of the
               last segment, to what held it: a driven end, a free kite or a free point. Both begin with the same motion.

Parameters and plan of the shells are those of the whole line. `fit` makes them those of the parted line when an entry point
begins, and `unfit` those of the whole line when it ends; what is to be kept stands in the state. The winch of a broken line
is braked: the unstretched length stays.
Theory: docs/models/theory.md, "Breaking and letting go".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from .properties import property_in, put_property

NO_MASS = 3.7e-13  # of a node without any [kg], as forces are divided by masses


@kernel
def tear(n, s, parameters):
    """Let segment s of n hold nothing, and the winch be braked, in the parameters (modified)."""
    parameters[at.TORN_NOW] = s + 1.0
    parameters[at.WHOLE_STIFFNESS] = property_in(parameters, n, s, at.STIFFNESS)
    parameters[at.WHOLE_DAMPING] = property_in(parameters, n, s, at.DAMPING)
    parameters[at.WHOLE_DRAG_WIDTH] = property_in(parameters, n, s, at.DRAG_WIDTH)
    parameters[at.WHOLE_CONTROL] = parameters[at.WINCH_CONTROL]
    for which in (at.STIFFNESS, at.DAMPING, at.DRAG_WIDTH):
        put_property(n, which, s, 0.0, parameters)
    parameters[at.WINCH_CONTROL] = float(at.WINCH_BY_SPEED)


@kernel
def mend(n, parameters):
    """Undo `tear`, if it was done."""
    s = int(parameters[at.TORN_NOW]) - 1
    if s >= 0:
        put_property(n, at.STIFFNESS, s, parameters[at.WHOLE_STIFFNESS], parameters)
        put_property(n, at.DAMPING, s, parameters[at.WHOLE_DAMPING], parameters)
        put_property(n, at.DRAG_WIDTH, s, parameters[at.WHOLE_DRAG_WIDTH], parameters)
        parameters[at.WINCH_CONTROL] = parameters[at.WHOLE_CONTROL]
        for place in range(at.TORN_NOW, at.WHOLE_CONTROL + 1):
            parameters[place] = 0.0


@kernel
def has_let_go(state):
    """Whether a line in this state has let go: 1, else 0."""
    return 1 if state[at.LET_GO] >= 1.0 else 0


@kernel
def is_torn(parameters):
    """Whether a segment is broken."""
    return parameters[at.TORN_NOW] > 0.0


@kernel
def move_up(count, first, room, numbers):
    """Move so many numbers of an array (modified) from a place `room` places up; what stood there has no meaning afterwards.

    They change places with it: a loop of copies would become a call of the C library.
    """
    for i in range(first + count - 1, first - 1, -1):
        numbers[i], numbers[i + room] = numbers[i + room], numbers[i]


@kernel
def move_down(count, first, room, numbers):
    """The same of numbers that stand `room` places above `first`, down to it."""
    for i in range(first, first + count):
        numbers[i], numbers[i + room] = numbers[i + room], numbers[i]


@kernel
def put_last(count, first, room, value, numbers):
    """Give an array of so many numbers, which begins at a place, one number more, and move it by `room` (modified).

    It becomes longer at its end; what lies behind must have been moved.
    """
    move_up(count, first, room, numbers)
    numbers[first + room + count] = value


@kernel
def add_segment(n, parameters):
    """Let the parameters (modified) of a line of n segments be those of one with one more, which holds nothing.

    The point mass of the last node is that of the new one.
    """
    masses = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n
    winds = masses + n + 1
    for axis in range(2, -1, -1):
        first = winds + (n + 1) * axis
        put_last(n + 1, first, at.SEGMENT_PROPERTIES + 1 + axis, parameters[first + n], parameters)
    mass = parameters[masses + n]
    mass = mass if mass != 0.0 else NO_MASS
    parameters[masses + n] = 0.0
    put_last(n + 1, masses, at.SEGMENT_PROPERTIES, mass, parameters)
    for which in range(at.SEGMENT_PROPERTIES - 1, -1, -1):
        first = at.PARAMETER_SCALARS + n * which
        put_last(n, first, which, parameters[first + n - 1] if which == at.SHARE else 0.0, parameters)


@kernel
def remove_segment(n, parameters):
    """Undo `add_segment`: n is the number of segments without it."""
    for which in range(1, at.SEGMENT_PROPERTIES):
        move_down(n, at.PARAMETER_SCALARS + n * which, which, parameters)
    masses = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n
    mass = parameters[masses + at.SEGMENT_PROPERTIES + n + 1]
    move_down(n, masses, at.SEGMENT_PROPERTIES, parameters)
    parameters[masses + n] = mass if mass != NO_MASS else 0.0
    for axis in range(3):
        move_down(n + 1, masses + (n + 1) * (axis + 1), at.SEGMENT_PROPERTIES + 1 + axis, parameters)
    for i in range(at.SEGMENT_PROPERTIES + 4):
        parameters[masses + 4 * (n + 1) + i] = 0.0


@kernel
def add_node(n, state):
    """Let the state (modified) of a line of n segments have one node more, which moves as the last one does."""
    x, v = at.STATE_HEADER, at.STATE_HEADER + 3 * (n + 1)
    move_up(3 * (n + 1), v, 3, state)
    for i in range(3):
        state[x + 3 * (n + 1) + i] = state[x + 3 * n + i]
        state[v + 3 + 3 * (n + 1) + i] = state[v + 3 + 3 * n + i]


@kernel
def remove_node(n, state):
    """Undo `add_node`: n is the number of segments without it."""
    v = at.STATE_HEADER + 3 * (n + 1)
    move_down(3 * (n + 1), v, 3, state)
    for i in range(6):
        state[v + 3 * (n + 1) + i] = 0.0
