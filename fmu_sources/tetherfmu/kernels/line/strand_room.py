"""Data of a line with rope coordinates at its ends: numbers, weights, columns and rows."""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..arrays import behind, places_of
from ..compilation import kernel, view
from ..flat_arrays import part
from ..linear_algebra.both_ends import interleaved_size

# --- numbers of a line; two places: one per end, four places: each end by each: 00, 01, 10, 11

(
    HOLDERS,  # per end: number of its coordinates, their numbers and weights [-]
    HOLDER,
    WEIGHT,
    SHEAVE,  # number of the coordinate: sheave at its end, drum that it carries; -1 without
    DRUM,
    RUNS,  # 1 if any of its coordinates may move in this piece of time, else it is a plain chain
    FIRST_LENGTH,  # L at the start of the communication step [m]
    LENGTH,  # L [m] at a stage
    RATE,  # rates of entering rope [m/s], their rates including the jump of a winch [m/s2]
    GAIN,
    HELD_GAIN,  # the part of GAIN from coordinates
    REST,  # weighted sums of `REST` and `INERT` over the coordinates
    INERTIA,
    PULL,  # R [N]
    TENSION,  # T [N], and dT/dR [-]
    SLOPE,
    FACTOR,  # factor of T in the equation of the coordinate: the sheave loss [-]
    BY_LENGTH,  # slopes of R by entering lengths [N/m], by rates [N s/m], by their rates [kg]
    BY_RATE,
    BY_GAIN,
    CORNER,
    OF_TIME,  # rate of R [N/s] from all functions of time
    LEFT,  # known part of R in a stage, over dR/dT [N]
    LARGEST,  # largest segment tension after a step [N]
    # fixed steps
    GOAL,  # largest node displacement of a converged line [m]
    UNCONVERGED,  # number of steps in which the iteration ended unconverged
    MOVED,  # change of T in the iteration [N]
    SECOND_PART,  # unstretched length of the second part of a portion that broke, at the start of the piece [m]
    LATE,  # rate at which the winch of a broken rope paid out until the end of the communication step [m/s]
    KEPT_REELING,  # reeling before the line broke, see `motion/breaks.py`
    _,
    NUMBERS,
) = places_of(2, 2 * at.MOST_HOLDERS, 2 * at.MOST_HOLDERS, 1, 1, 1, 1, 1, *[2] * 9, *[4] * 4, 2, 2, 1, 1, 1, 2, 1, 1, 7, 1)

Weights = namedtuple("Weights", "first last growth_first growth_last")
Weights.__doc__ = """W_i0 and W_i1 of the nodes, n + 1; g_0 and g_1 of the segments, n; see `equations/rope.py`."""
Rope = namedtuple("Rope", "by_rate by_gain solved row by_velocity gain_row velocity_row")
Rope.__doc__ = """A line end with coordinates: slopes of the node forces, and rows of R.

by_rate, by_gain : slopes by a [N s/m] and by a' [kg].  solved : the column of the matrix, then its solution.
row, by_velocity : of the matrix [N s/m], and dR/dv [N s/m].  Flat arrays of 3 (n + 1) numbers.
gain_row, velocity_row : by_gain and by_velocity, interleaved, counting the middle node once."""
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
