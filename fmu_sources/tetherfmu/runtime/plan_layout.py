"""Place of each number in the flat arrays of lines between points: of a single tether, or of a system.

Each line has arrays of its own (`layout.py`), stored one after the other:

=============  ======================================================================
`plan`         integers: number of lines and of free points, and for each line the constants below
`parameters`   of all lines
`inputs`       of all lines, each with its wind points, then the load on each free point [N]
`state`        of all lines; the first line stores the solver memory
`outputs`      of all lines
`work`         scratch space of all lines, then of the free points, then room for outputs
=============  ======================================================================

A line runs from its start (the ground end of a tether) to its end (the kite end). A free point of a system is the free end
of several lines: each has a copy of its motion, and the first carries its mass. A single tether has no points: its
parameters specify its free ends.

The author of a plan writes the numbers marked as given, and the entry point `complete` computes the others.
The sizes of the arrays are known only then.
"""

# plan: scalars
LINES = 0  # given
FREE_POINTS = 1  # given
BAND = 2  # given: of the matrix of the free points, see `wiring/ordering.py`
STATUS_LINE = 3  # number of the line that a status is about, or ALL_LINES; written by the kernels
POINTS_WORK = 4  # place of the free points in `work`
OUTPUTS_WORK = 5  # place of outputs in `work`
PARAMETERS_SIZE = 6  # length of the array
INPUTS_SIZE = 7
STATE_SIZE = 8
OUTPUTS_SIZE = 9
WORK_SIZE = 10
SHEAVES = 11  # number of sheaves
SHEAVES_WORK = 12  # place of them and of drums in `work`
COORDINATES = 13  # sheaves, and drums that may turn beside them
PLAN_HEADER = 14
# then of each line
SEGMENTS = 0  # given
START_POINT = 1  # given: number of the free point at its start, or DRIVEN
END_POINT = 2  # given
SHAPE_POINTS = 3  # given: points of its output `shape`
PARAMETERS_AT = 4  # its first place in `parameters`, `state`, `outputs` and `work`
STATE_AT = 5
OUTPUTS_AT = 6
WORK_AT = 7
START_IS_SOUGHT = 8  # given: 1 if `initialize` solves the equilibrium position of the free point at its start, else 0
END_IS_SOUGHT = 9  # given; equal in all lines at a point
WIND_POINTS = 10  # given: number of points with a wind input, 0 for none; equal to its parameter
INPUTS_AT = 11  # its first place in `inputs`
FREED = 12  # written by the kernels: 1 while they run if the line was released: it has one more segment, without load
THROUGH = 13  # given: 1 if it is a portion that continues over a sheave at its end as the next line, else 0
PORTION_WORK = 14  # place in `work` of a line's scratch space in a system with coordinates
DRUM = 15  # given: 1 if it may carry a drum that is shared or used with sheaves, else 0
LINE_NUMBERS = 16

DRIVEN = -1  # a point
ALL_LINES = -1


def plan_size(lines):
    """Length of the `plan` array [-] for this number of lines."""
    return PLAN_HEADER + LINE_NUMBERS * lines
