"""The entry points of the library for systems: numbers and pointers to flat arrays, as those of `entry_points.py`.

Four: line_work_size and points_work_size, from which the caller makes the plan (`runtime/system_layout.py`), advance, fly.
"""

from numba import carray, types

from tetherfmu.runtime import system_layout as places
from tetherfmu.runtime.kernel_library import SystemKernels
from tetherfmu.runtime.status import OK

from .arrays import copy
from .compilation import kernel, part, view
from .equations.lines import System, points_size
from .variants import system as variant

plan_size = kernel(places.plan_size)
inputs_size = kernel(places.inputs_size)

_DOUBLES, _WHOLE = types.CPointer(types.float64), types.CPointer(types.int64)
_COUNT, _STATUS, _NUMBER = types.int64, types.int32, types.float64
SIGNATURES = SystemKernels(
    line_work_size=_COUNT(_COUNT),
    points_work_size=_COUNT(_COUNT, _COUNT),
    advance=_STATUS(_WHOLE, _DOUBLES, _DOUBLES, _NUMBER, _DOUBLES, _DOUBLES, _DOUBLES),
    fly=_COUNT(_WHOLE, _DOUBLES, _DOUBLES, _COUNT, _NUMBER, _COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
)


@view
def plan_at(plan):
    """The plan as an array."""
    lines = carray(plan, places.PLAN_HEADER)[places.LINES]
    return carray(plan, plan_size(lines))


@view
def behind_lines(plan, which):
    """Length of what all lines have of `parameters` or `state`."""
    return plan[places.PLAN_HEADER + places.LINE_NUMBERS * plan[places.LINES] + which]


@view
def states_at(plan, state):
    """States of all lines as an array."""
    return carray(state, behind_lines(plan, places.STATE_AT))


@view
def system_at(plan, parameters, inputs, state, work):
    """`System` of these arrays."""
    return System(
        plan,
        carray(parameters, behind_lines(plan, places.PARAMETERS_AT)),
        inputs,
        states_at(plan, state),
        carray(work, plan[places.POINTS_WORK] + points_size(plan[places.FREE_POINTS], plan[places.BAND])),
    )


def line_work_size(n):
    """Length of what a line of n segments needs of `work`."""
    return variant.line_work_size(n)


def points_work_size(points, band):
    """Length of what so many free points need of `work`, with this band of their matrix."""
    return points_size(points, band)


def advance(plan, parameters, inputs, step, state, before, work):
    """One communication step of `step` [s]: the states (modified) are left as they were on any status but OK.

    before (modified) : room for all states.
    """
    p = plan_at(plan)
    given = carray(inputs, inputs_size(p[places.LINES], p[places.FREE_POINTS]))
    return variant.advance(system_at(p, parameters, given, state, work), step, states_at(p, before))


def fly(plan, parameters, inputs, steps, step, every, state, before, rows, work):
    """Do `steps` communication steps, until one is refused; returns how many were done. The states are modified.

    inputs : one row of inputs per step.  every : a row is kept after every so many steps; 0 for none.  before : room for all
    states.  rows (modified) : the states after each kept step.
    """
    p = plan_at(plan)
    size, width = inputs_size(p[places.LINES], p[places.FREE_POINTS]), behind_lines(p, places.STATE_AT)
    flight, old = carray(inputs, steps * size), states_at(p, before)
    kept = carray(rows, width * (steps // every if every > 0 else 0))
    for k in range(steps):
        system = system_at(p, parameters, part(flight, k * size, size), state, work)
        if variant.advance(system, step, old) != OK:
            return k
        if every > 0 and (k + 1) % every == 0:
            copy(system.state, part(kept, width * ((k + 1) // every - 1), width))
    return steps


ENTRY_POINTS = SystemKernels(line_work_size, points_work_size, advance, fly)
