"""Where each number lives in the flat arrays of lines between points: of one, a tether alone, or of a system of them.

Each line has arrays of its own (`layout.py`), one behind the other:

=============  ======================================================================
`plan`         whole numbers: how many lines and free points there are, and of each line what the constants below say
`parameters`   those of all lines
`inputs`       those of all lines, each with its wind points, then the load on each free point [N]
`state`        those of all lines; the memory of the solver stands in that of the first line
`outputs`      those of all lines
`work`         scratch space of all lines, then that of the free points, then room for outputs
=============  ======================================================================

A line goes from its start (the ground end of a tether) to its end (the kite end). A free point of a system is the free end
of several lines: each has a copy of its motion, and the first carries its mass. A tether alone has no points: what of
its ends moves freely, its parameters say.

Whoever makes a plan writes the numbers that are marked as given, and the entry point `complete` finds all others from them.
Only then the sizes of the arrays are known.
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
SHEAVES = 11  # over which lines run
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
START_IS_SOUGHT = 8  # given: 1 if `initialize` is to find where the free point at its start is in equilibrium, else 0
END_IS_SOUGHT = 9  # given; all lines at a point say the same
WIND_POINTS = 10  # given: at which the wind along it is an input, 0 for none; its parameters say so, too
INPUTS_AT = 11  # its first place in `inputs`
FREED = 12  # written by the kernels: 1 while they run, if the line has let go: it has one segment more, which holds nothing
THROUGH = 13  # given: 1 if it runs over a sheave at its end and goes on as the next line, of which it is a portion; else 0
PORTION_WORK = 14  # place in `work` of what a line needs in a system with coordinates
DRUM = 15  # given: 1 if it may carry a drum that turns beside sheaves, or that holds several lines; else 0
LINE_NUMBERS = 16

DRIVEN = -1  # a point
ALL_LINES = -1


def plan_size(lines):
    """Length of the `plan` array [-] of so many lines."""
    return PLAN_HEADER + LINE_NUMBERS * lines
