"""Equilibrium of a free kite: its tether is a system of one line with a sought free point (`resting_points.py`)."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import NO_EQUILIBRIUM_OF_KITE, OK

from ..arrays import behind, clear, copy, outputs_size, positions_and_velocities
from ..compilation import kernel
from ..equations.lines import System
from ..flat_arrays import part
from ..linear_algebra.vectors import ZERO_VECTOR, get, put, put_at, vector_at
from ..points.room import globals_size
from . import resting_points
from .resting_forces import search_size
from .resting_line import line_work_size

PLAN = places.plan_size(1)
INPUTS = at.INPUTS + 3
BAND = 0  # band of the matrix of one point, see `wiring/ordering.py`
ROOM_AT = PLAN + INPUTS + (PLAN + INPUTS) % 2  # offset of the scratch space of the system, after its plan and inputs


@kernel
def work_size(n):
    """Length of the work array: the plan and the inputs of the system, then scratch space of its line and its point."""
    return ROOM_AT + line_work_size(n) + globals_size(1, BAND, 1) + search_size(1, BAND, 0) + outputs_size(0)


@kernel
def write_plan(n, plan):
    """Plan (modified) of a system of one line of n segments from a driven point to a sought one."""
    clear(plan)
    plan[places.LINES], plan[places.FREE_POINTS], plan[places.BAND] = 1.0, 1.0, BAND
    plan[places.SHEAVES_WORK] = line_work_size(n)
    plan[places.POINTS_WORK] = line_work_size(n) + globals_size(1, BAND, 1)
    plan[places.OUTPUTS_WORK] = line_work_size(n) + globals_size(1, BAND, 1) + search_size(1, BAND, 0)
    plan[places.OUTPUTS_SIZE] = outputs_size(0)
    row = part(plan, places.PLAN_HEADER, places.LINE_NUMBERS)
    row[places.SEGMENTS] = n
    row[places.START_POINT] = places.DRIVEN
    row[places.END_IS_SOUGHT] = 1.0


@kernel
def find(n, parameters, inputs, state, work):
    """Move the kite end of a new state (modified) to its equilibrium at rest; OK or NO_EQUILIBRIUM_OF_KITE.

    The search begins at the input position.  Winds of wind points are already set at the nodes.
    """
    plan, given = part(work, 0, PLAN), part(work, PLAN, INPUTS)
    write_plan(n, plan)
    copy(part(inputs, 0, at.INPUTS), given)
    put_at(given, at.INPUTS, vector_at(inputs, at.KITE_LOAD))
    x, v = positions_and_velocities(n, state)
    ground_velocity, reeling, points = get(v, 0), state[at.REELING], parameters[at.WIND_POINTS]
    parameters[at.WIND_POINTS] = 0.0
    status = resting_points.find(System(plan, parameters, given, state, behind(ROOM_AT, work)), True)
    parameters[at.WIND_POINTS] = points
    put(x, n, vector_at(given, at.KITE_POSITION))
    put(v, 0, ground_velocity)
    put(v, n, ZERO_VECTOR)
    state[at.REELING] = reeling
    return OK if status == OK else NO_EQUILIBRIUM_OF_KITE
