"""The plan of a system: an array, or that of a tether alone, of which all but the number of segments is known when compiled.

So the kernels that move systems move a single tether, too, and what of them is about other lines and points is not there.
"""

from collections import namedtuple

from tetherfmu.runtime import plan_layout as places

from ..compilation import by_kind, kernel

OneLine = namedtuple("OneLine", "segments")
OneLine.__doc__ = """The plan of a system of one line without points.

What of its ends moves freely is a row of the line like the others, see `BoundaryConditions`.
"""


@kernel
def number_in_array(plan, place):
    """The number at a place of a plan, see `plan_layout.py`."""
    return int(plan[place])


@kernel
def number_in_one_line(plan, place):
    """The same of an `OneLine`."""
    if place == places.LINES:
        return 1
    if place == places.PLAN_HEADER + places.SEGMENTS:
        return plan.segments
    if place == places.PLAN_HEADER + places.START_POINT or place == places.PLAN_HEADER + places.END_POINT:
        return places.DRIVEN
    return 0


@kernel
def note_in_array(plan, k):
    """Write into a plan (modified) that a status is about line k."""
    plan[places.STATUS_LINE] = k


@kernel
def note_in_one_line(plan, k):
    """A status is always about the one line."""


number_in, note_line = by_kind(number_in_one_line, number_in_array), by_kind(note_in_one_line, note_in_array)
