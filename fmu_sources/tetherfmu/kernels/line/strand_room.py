"""What a line over whose ends coordinates let rope in knows of that rope: its numbers, weights, columns and rows."""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..arrays import behind, places_of
from ..compilation import kernel, view
from ..flat_arrays import part
from ..linear_algebra.both_ends import interleaved_size

# --- numbers of a line; those with two places are of both its ends, those with four of each by each: 00, 01, 10, 11

(
    HOLDERS,  # how many coordinates let rope in over each end, their numbers and their weights [-]
    HOLDER,
    WEIGHT,
    SHEAVE,  # number of the coordinate of the sheave at its end, of the drum that it carries; -1 without
    DRUM,
    RUNS,  # 1 if any of its holders may move in this piece of time; else it is a chain without ropes
    FIRST_LENGTH,  # at the start of the communication step [m]
    LENGTH,  # L [m] at a stage
    RATE,  # rates of rope that comes in [m/s] and their rates, with the jump of a winch [m/s2]
    GAIN,
    HELD_GAIN,  # that of the coordinates alone
    REST,  # sums of `REST` and `INERT` of the coordinates
    INERTIA,
    PULL,  # R [N]
    TENSION,  # T [N], and dT/dR [-]
    SLOPE,
    FACTOR,  # of T in the equation of the coordinate: the loss of a sheave [-]
    BY_LENGTH,  # slopes of R by lengths that come in [N/m], by rates [N s/m], by their rates [kg]
    BY_RATE,
    BY_GAIN,
    CORNER,
    OF_TIME,  # rate of R [N/s] by all that is a function of time
    LEFT,  # what is known of R in a stage over dR [N]
    LARGEST,  # tension of a segment after a step [N]
    # fixed steps
    GOAL,  # the largest move of a node with which the line has converged [m]
    UNCONVERGED,  # in how many steps the iteration ended before
    MOVED,  # change of T with the moves of the iteration [N]
    KEPT_REELING,  # how the line reeled before it broke, see `motion/breaks.py`
    _,
    NUMBERS,
) = places_of(2, 2 * at.MOST_HOLDERS, 2 * at.MOST_HOLDERS, 1, 1, 1, 1, 1, *[2] * 9, *[4] * 4, 2, 2, 1, 1, 1, 2, 7, 1)

Weights = namedtuple("Weights", "first last growth_first growth_last")
Weights.__doc__ = """W_i0 and W_i1 of the nodes, n + 1; g_0 and g_1 of the segments, n; see `equations/rope.py`."""
Rope = namedtuple("Rope", "by_rate by_gain solved row by_velocity gain_row velocity_row")
Rope.__doc__ = """Of an end over which coordinates let rope in: slopes of the forces on the nodes, and rows of R.

by_rate, by_gain : slopes by a [N s/m] and by a' [kg].  solved : the column of the matrix, then its solution.
row, by_velocity : of the matrix [N s/m], and dR/dv [N s/m].  Flat arrays of 3 (n + 1) numbers.
gain_row, velocity_row : by_gain and by_velocity, interleaved, with the node in the middle once.
"""
Strand = namedtuple("Strand", "n conditions numbers weights ropes z stage_z w")
Strand.__doc__ = """A line in a step.

n, conditions : number of segments, `BoundaryConditions`.  numbers : see above.  weights : `Weights`.  ropes : see `rope_in`.
z, stage_z : accelerations of the nodes at the start of the step and at a stage [m/s2], interleaved.
w : `rosenbrock.Workspace`.
"""


@kernel
def ropes_size(n):
    """Length of the arrays of both ends of a line."""
    return 2 * (5 * 3 * (n + 1) + 2 * interleaved_size(n))


@view
def weights_in(n, array):
    """`Weights` in an array of 4 (n + 1) numbers."""
    nodes = part(array, 0, n + 1), part(array, n + 1, n + 1)
    return Weights(*nodes, part(array, 2 * n + 2, n), part(array, 3 * n + 2, n))


@view
def rope_in(n, array, end):
    """`Rope` of an end in an array of `ropes_size`."""
    flat, two = 3 * (n + 1), interleaved_size(n)
    room = behind((5 * flat + 2 * two) * end, array)
    rows = part(room, 0, two), part(room, two, two)
    room = behind(2 * two, room)
    slopes = part(room, 0, flat), part(room, flat, flat), part(room, 2 * flat, flat)
    return Rope(*slopes, part(room, 3 * flat, flat), part(room, 4 * flat, flat), *rows)
