"""A line that broke or was released at its end: a segment without load marks the gap.

    broken     segment s loses stiffness, damper and drag. Half of its mass stays on each of its two nodes, which become the
               new ends; no node changes its mass or velocity, so the momentum is conserved. The energy of its spring is
               lost.
    let go     the line has one more segment, without mass. It joins the last node, now free with its half of the last
               segment, to the former support: a driven end, a free kite or a free point. Both start with the same motion.

Parameters and plan of the shells describe the whole line. `fit` changes them to the parted line when an entry point
begins, and `unfit` restores them when it ends; the state stores the rest. The winch of a broken line is braked: the
unstretched length is constant.
Theory: docs/models/theory.md, "Breaking and letting go".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from .properties import place_of, property_in, put_property

NO_MASS = 3.7e-13  # mass of a massless node [kg], as forces are divided by masses


@kernel
def tear(n, s, parameters):
    """Remove the stiffness, damper and drag of segment s of n, and brake the winch, in the parameters (modified)."""
    parameters[at.TORN_NOW] = s + 1.0
    parameters[at.WHOLE_STIFFNESS] = property_in(parameters, n, s, at.STIFFNESS)
    parameters[at.WHOLE_DAMPING] = property_in(parameters, n, s, at.DAMPING)
    parameters[at.WHOLE_DRAG_WIDTH] = property_in(parameters, n, s, at.DRAG_WIDTH)
    parameters[at.WHOLE_CONTROL] = parameters[at.WINCH_CONTROL]
    for which in (at.STIFFNESS, at.DAMPING, at.DRAG_WIDTH):
        put_property(n, which, s, 0.0, parameters)
    parameters[at.WINCH_CONTROL] = float(at.WINCH_BY_SPEED)
    parameters[at.WINCH_IS_BRAKED] = 1.0


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
        parameters[at.WINCH_IS_BRAKED] = 0.0


@kernel
def has_let_go(state):
    """1 if a line in this state was released, else 0."""
    return 1 if state[at.LET_GO] >= 1.0 else 0


@kernel
def move_up(count, first, room, numbers):
    """Move `count` numbers of an array (modified) from a place up by `room`; the vacated places are undefined.

    Numbers are swapped: a loop of copies would become a call of the C library.
    """
    for i in range(first + count - 1, first - 1, -1):
        numbers[i], numbers[i + room] = numbers[i + room], numbers[i]


@kernel
def move_down(count, first, room, numbers):
    """Move `count` numbers from `room` places above `first` down to it."""
    for i in range(first, first + count):
        numbers[i], numbers[i + room] = numbers[i + room], numbers[i]


@kernel
def put_last(count, first, room, value, numbers):
    """Append one number to an array of this length, which begins at a place, and move it by `room` (modified).

    The array grows at its end; move the data behind it first.
    """
    move_up(count, first, room, numbers)
    numbers[first + room + count] = value


@kernel
def add_segment(n, parameters):
    """Extend the parameters (modified) of a line of n segments by a segment without load.

    The point mass of the last node moves to the new node.
    """
    masses = place_of(n, at.SEGMENT_PROPERTIES)
    winds = masses + n + 1
    for axis in range(2, -1, -1):
        first = winds + (n + 1) * axis
        put_last(n + 1, first, at.SEGMENT_PROPERTIES + 1 + axis, parameters[first + n], parameters)
    mass = parameters[masses + n]
    mass = mass if mass != 0.0 else NO_MASS
    parameters[masses + n] = 0.0
    put_last(n + 1, masses, at.SEGMENT_PROPERTIES, mass, parameters)
    for which in range(at.SEGMENT_PROPERTIES - 1, -1, -1):
        first = place_of(n, which)
        has_length = which == at.SHARE or which == at.OFFSET
        put_last(n, first, which, parameters[first + n - 1] if has_length else 0.0, parameters)


@kernel
def remove_segment(n, parameters):
    """Undo `add_segment`; n : number of segments without it."""
    for which in range(1, at.SEGMENT_PROPERTIES):
        move_down(n, place_of(n, which), which, parameters)
    masses = place_of(n, at.SEGMENT_PROPERTIES)
    mass = parameters[masses + at.SEGMENT_PROPERTIES + n + 1]
    move_down(n, masses, at.SEGMENT_PROPERTIES, parameters)
    parameters[masses + n] = mass if mass != NO_MASS else 0.0
    for axis in range(3):
        move_down(n + 1, masses + (n + 1) * (axis + 1), at.SEGMENT_PROPERTIES + 1 + axis, parameters)
    for i in range(at.SEGMENT_PROPERTIES + 4):
        parameters[masses + 4 * (n + 1) + i] = 0.0


@kernel
def add_node(n, state):
    """Extend the state (modified) of a line of n segments by a node with the motion of the last one."""
    x, v = at.STATE_HEADER, at.STATE_HEADER + 3 * (n + 1)
    move_up(3 * (n + 1), v, 3, state)
    for i in range(3):
        state[x + 3 * (n + 1) + i] = state[x + 3 * n + i]
        state[v + 3 + 3 * (n + 1) + i] = state[v + 3 + 3 * n + i]


@kernel
def remove_node(n, state):
    """Undo `add_node`; n : number of segments without it."""
    v = at.STATE_HEADER + 3 * (n + 1)
    move_down(3 * (n + 1), v, 3, state)
    for i in range(6):
        state[v + 3 * (n + 1) + i] = 0.0
