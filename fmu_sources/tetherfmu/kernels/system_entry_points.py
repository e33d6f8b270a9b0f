"""The entry points of the library for systems: numbers and pointers to flat arrays, as those of `entry_points.py`.

Seven: segments and pack, for each line; complete, which makes the plan (`runtime/system_layout.py`); initialize, advance,
outputs, fly. They return statuses (`status.py`), segments and fly a number. What a status is about stands in the plan at
STATUS_LINE; INPUT_NOT_FINITE about ALL_LINES carries the number of a free point, whose load it is about, and
NO_EQUILIBRIUM_OF_POINT that of the point.
"""

from numba import types

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import system_layout as places
from tetherfmu.runtime.kernel_library import SystemKernels
from tetherfmu.runtime.status import OK

from . import packing
from .arrays import copy, parameters_size
from .compilation import kernel, view
from .equations.lines import System
from .equations.properties import put_point_mass
from .flat_arrays import flat, part
from .variants import system as variant

plan_size = kernel(places.plan_size)

_DOUBLES, _WHOLE = types.CPointer(types.float64), types.CPointer(types.int64)
_COUNT, _STATUS, _NUMBER = types.int64, types.int32, types.float64
SIGNATURES = SystemKernels(
    segments=_COUNT(_COUNT, _DOUBLES),
    pack=_STATUS(_COUNT, _DOUBLES, _NUMBER, _COUNT, _COUNT, _NUMBER, _NUMBER, _DOUBLES),
    complete=_STATUS(_WHOLE),
    initialize=_STATUS(_WHOLE, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
    advance=_STATUS(_WHOLE, _DOUBLES, _DOUBLES, _NUMBER, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
    outputs=_STATUS(_WHOLE, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
    fly=_COUNT(_WHOLE, _DOUBLES, _DOUBLES, _COUNT, _NUMBER, _COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES),
)


@view
def plan_at(plan):
    """The plan as an array."""
    lines = flat(plan, places.PLAN_HEADER)[places.LINES]
    return flat(plan, plan_size(lines))


@view
def states_at(plan, state):
    """States of all lines as an array."""
    return flat(state, plan[places.STATE_SIZE])


@view
def outputs_at(plan, outputs):
    """Outputs of all lines as an array."""
    return flat(outputs, plan[places.OUTPUTS_SIZE])


@view
def system_at(plan, parameters, inputs, state, work):
    """`System` of these arrays; inputs : an array already."""
    return System(
        plan,
        flat(parameters, plan[places.PARAMETERS_SIZE]),
        inputs,
        states_at(plan, state),
        flat(work, plan[places.WORK_SIZE]),
    )


def segments(tethers, quantities):
    """Number of segments of a line of tethers in series with these quantities, see `packing`; 0 if it is unknown."""
    return packing.count_segments(tethers, flat(quantities, packing.count_of_quantities(tethers, 0)), True)


def pack(tethers, quantities, tolerance, start_is_free, end_is_free, start_mass, end_mass, parameters):
    """Parameters (modified) of a line with as many segments as `segments` says; a status, and nothing is done but on OK.

    start_is_free, end_is_free : 1 if its start, or its end, is a free point, else 0.  start_mass, end_mass : of these
    points [kg], as far as this line carries it: all of it in the first line at a point, 0 in the others.
    """
    given = flat(quantities, packing.count_of_quantities(tethers, 0))
    n = packing.count_segments(tethers, given, True)
    p = flat(parameters, parameters_size(n))
    status = packing.pack(tethers, 0, given, tolerance, True, True, p)
    if status == OK:
        p[at.GROUND_IS_FREE], p[at.KITE_IS_FREE] = float(start_is_free), float(end_is_free)
        put_point_mass(n, 0, start_mass, p)
        put_point_mass(n, n, end_mass, p)
    return status


def complete(plan):
    """Write into a plan (modified) what follows from the numbers that are given; returns OK."""
    variant.complete_plan(plan_at(plan))
    return OK


def initialize(plan, parameters, inputs, state, before, outputs, work):
    """First states and outputs of all lines (both modified), left as they were on any status but OK.

    Free points start where the inputs of their lines say, as driven ones; where the plan says that a point is sought, its
    position is found and written there (inputs modified).  before (modified) : room for all states.
    """
    p = plan_at(plan)
    system = system_at(p, parameters, flat(inputs, p[places.INPUTS_SIZE]), state, work)
    return variant.initialize(system, states_at(p, before), outputs_at(p, outputs))


def advance(plan, parameters, inputs, step, state, before, outputs, work):
    """One communication step of `step` [s]: states and outputs (both modified), left as they were on any status but OK.

    before (modified) : room for all states; after a step that was done, those of before it.
    """
    p = plan_at(plan)
    system = system_at(p, parameters, flat(inputs, p[places.INPUTS_SIZE]), state, work)
    old = states_at(p, before)
    return variant.with_outputs(system, variant.advance(system, step, old), old, outputs_at(p, outputs))


def outputs(plan, parameters, state, outputs, work):
    """Outputs of all lines (modified) that belong to their states, left as they were on any status but OK."""
    p = plan_at(plan)
    none = flat(state, 0)
    return variant.take_outputs(system_at(p, parameters, none, state, work), outputs_at(p, outputs))


def fly(plan, parameters, inputs, steps, step, every, state, before, rows, work):
    """Do `steps` communication steps, until one is refused; returns how many were done. The states are modified.

    inputs : one row of inputs per step.  every : a row is kept after every so many steps; 0 for none.  before : room for all
    states.  rows (modified) : the states after each kept step.
    """
    p = plan_at(plan)
    size, width = p[places.INPUTS_SIZE], p[places.STATE_SIZE]
    flight, old = flat(inputs, steps * size), states_at(p, before)
    kept = flat(rows, width * (steps // every if every > 0 else 0))
    for k in range(steps):
        system = system_at(p, parameters, part(flight, k * size, size), state, work)
        if variant.advance(system, step, old) != OK:
            return k
        if every > 0 and (k + 1) % every == 0:
            copy(system.state, part(kept, width * ((k + 1) // every - 1), width))
    return steps


ENTRY_POINTS = SystemKernels(segments, pack, complete, initialize, advance, outputs, fly)
