"""Where each number lives in the flat arrays of a system of lines between points.

Each line has arrays of its own, those of a single tether (`layout.py`), one behind the other:

=============  ======================================================================
`plan`         whole numbers: how many lines and free points there are, and of each line what the constants below say
`parameters`   those of all lines
`inputs`       those of all lines, then the load on each free point [N]
`state`        those of all lines; the memory of the solver stands in that of the first line
`work`         scratch space of all lines, then that of the free points
=============  ======================================================================

A line goes from its start (the ground end of a single tether) to its end (the kite end). A free point is the free end of
several lines: each has a copy of its motion, and the first of them carries its mass.
"""

from .layout import INPUTS

# plan: scalars
LINES = 0
FREE_POINTS = 1
POINTS_WORK = 2  # place of the free points in `work`
STATUS_LINE = 3  # number of the line that a status is about, or ALL_LINES; written by the kernels
BAND = 4  # of the matrix of the free points
PLAN_HEADER = 5
# then of each line, and once more: the places behind the last line
SEGMENTS = 0
START_POINT = 1  # number of the free point at its start, or DRIVEN
END_POINT = 2
PARAMETERS_AT = 3  # its first place in `parameters`, `state` and `work`
STATE_AT = 4
WORK_AT = 5
LINE_NUMBERS = 6

DRIVEN = -1  # a point
ALL_LINES = -1


def plan_size(lines):
    """Length of the `plan` array [-] of so many lines."""
    return PLAN_HEADER + LINE_NUMBERS * (lines + 1)


def inputs_size(lines, points):
    """Length of the `inputs` array [-] of so many lines and free points."""
    return INPUTS * lines + 3 * points
