"""Root of an increasing function: secant method, within a sign-change interval once that is known.

Before that, the steps grow where the function hardly changes. Within the interval, the Illinois method replaces a point
outside of it and every fourth point, bisection every eighth point.
Source: M. Dowell and P. Jarratt, A modified regula falsi method for computing the root of an equation, BIT 11 (1971) 168.
"""

from collections import namedtuple
from math import copysign

from ..compilation import kernel

NUDGE = 1e-15  # relative, where rounding cancels a step

Search = namedtuple("Search", "lowest highest low high below above last residual slope change count")
Search.__doc__ = """A search between two limits.

low, high : interval of the root.  below, above : function values there, 0 if unknown.  last, residual : last point
and its function value.  slope : of the function.  change : last step.  count : number of points so far."""


@kernel
def begin(lowest, highest, guess, slope):
    """`Search` between two limits with an initial slope, and the first point."""
    place = min(highest, max(lowest, guess))
    return Search(lowest, highest, lowest, highest, 0.0, 0.0, place, 0.0, slope, 0.0, 0), place


@kernel
def has_interval(search):
    """Whether a sign-change interval is known."""
    return search.below < 0.0 < search.above


@kernel
def go_on(search, place, residual, farthest):
    """`Search` updated with a function value, and the next point, at most `farthest` away; unchanged if there is none."""
    lowest, highest, low, high, below, above, last, last_residual, slope, change, count = search
    if place != last and (residual - last_residual) / (place - last) > 0.0:
        slope = (residual - last_residual) / (place - last)
    if residual < 0.0:
        above *= 0.5 if last_residual < 0.0 else 1.0  # the same end twice: halve the other value
        low, below = place, residual
    else:
        below *= 0.5 if last_residual > 0.0 else 1.0
        high, above = place, residual
    way = -residual / slope
    if (way > 0.0) == (change > 0.0) and abs(residual) > 0.5 * abs(last_residual):
        way = copysign(max(abs(way), 2.0 * abs(change)), way)
    change = max(-farthest, min(farthest, way))
    onward = min(highest, max(lowest, place + change))
    if below < 0.0 < above:
        change = 0.0
        if not low < onward < high or count % 4 == 3:
            onward = high - above * (high - low) / (above - below)
        if not low < onward < high or count % 8 == 7:
            onward = 0.5 * (low + high)
        if not low < onward < high:
            onward = place  # neighbouring numbers
    elif onward == place:
        onward = min(highest, max(lowest, place - copysign(NUDGE * (count + 1) * place, residual)))
    return Search(lowest, highest, low, high, below, above, place, residual, slope, change, count + 1), onward
