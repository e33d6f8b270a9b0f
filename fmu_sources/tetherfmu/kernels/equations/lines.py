"""A system of lines between points: its arrays, and the arrays of each line.

Layout: `runtime/plan_layout.py`. The plan is an array; for a single tether it is a tuple of compile-time constants except
for the number of segments. The system kernels therefore also integrate a single tether, and the compiler drops the code for
other lines and points.
"""

from collections import namedtuple

from tetherfmu.runtime import plan_layout as places

from ..arrays import behind, inputs_size, parameters_size, places_of, positions_and_velocities, state_size
from ..compilation import by_kind, kernel, view
from ..flat_arrays import part
from ..linear_algebra.vectors import put_at, vector_at
from .boundary import BoundaryConditions
from .winch import steadily

System = namedtuple("System", "plan parameters inputs state work")
System.__doc__ = """The flat arrays of a system, see `plan_layout.py`.

plan : integers, floats in `rest/resting_kite.py`; `OneLine` for a single tether."""

OneLine = namedtuple("OneLine", "segments")
OneLine.__doc__ = """The plan of a system of one line without points.

Free ends are ordinary rows of the line, see `BoundaryConditions`."""

ONE_LINE_ROOM = 128  # length of `work` before the line, for its only possible coordinate, see `points/room.py`

# numbers that `store_conditions` writes, and their room: even, as in `room.line_work_size`
_CURVE, _REELING, _VECTOR = 18, 7, 3
GROUND, KITE, REELING, WIND, LOAD, LOAD_RATE, FIRST, LAST, FORCE, FORCE_RATE, CONDITIONS = places_of(
    _CURVE, _CURVE, _REELING, _VECTOR, _VECTOR, _VECTOR, 1, 1, 1, 1
)


@kernel
def number_in_array(plan, place):
    """Number at a place of a plan, see `plan_layout.py`."""
    return int(plan[place])


@kernel
def number_in_one_line(plan, place):
    """`number_in_array` for an `OneLine`."""
    if place == places.LINES:
        return 1
    if place == places.PLAN_HEADER + places.SEGMENTS:
        return plan.segments
    if place == places.PLAN_HEADER + places.START_POINT or place == places.PLAN_HEADER + places.END_POINT:
        return places.DRIVEN
    return ONE_LINE_ROOM if place == places.PLAN_HEADER + places.WORK_AT else 0


@kernel
def note_in_array(plan, k):
    """Record in a plan (modified) that a status refers to line k."""
    plan[places.STATUS_LINE] = k


@kernel
def note_in_one_line(plan, k):
    """No-op: a status always refers to the only line."""


number_in, note_line = by_kind(number_in_one_line, number_in_array), by_kind(note_in_one_line, note_in_array)


@kernel
def number_of_line(system, k, which):
    """Plan entry of line k: `plan_layout.SEGMENTS`, ..."""
    return number_in(system.plan, places.PLAN_HEADER + places.LINE_NUMBERS * k + which)


@kernel
def segments_of(system, k):
    """Number of segments of line k, including the one added when it was released, see `torn.py`."""
    return number_of_line(system, k, places.SEGMENTS) + number_of_line(system, k, places.FREED)


@kernel
def lines_of(system):
    """Number of lines."""
    return number_in(system.plan, places.LINES)


@view
def with_states(system, state):
    """The system with other states of all lines."""
    return System(system.plan, system.parameters, system.inputs, state, system.work)


@view
def parameters_of(system, k):
    """`parameters` of line k."""
    return part(system.parameters, number_of_line(system, k, places.PARAMETERS_AT), parameters_size(segments_of(system, k)))


@view
def state_of(system, k):
    """`state` of line k."""
    segments = segments_of(system, k) - number_of_line(system, k, places.FREED)
    size = state_size(segments, number_of_line(system, k, places.WIND_POINTS))
    return part(system.state, number_of_line(system, k, places.STATE_AT), size)


@kernel
def place_of_inputs(system, k):
    """First place and number of the inputs of line k."""
    return number_of_line(system, k, places.INPUTS_AT), inputs_size(number_of_line(system, k, places.WIND_POINTS))


@view
def inputs_of(system, k):
    """`inputs` of line k."""
    return part(system.inputs, *place_of_inputs(system, k))


@view
def motion_of(system, k):
    """Positions [m] and velocities [m/s] of the nodes of line k."""
    return positions_and_velocities(segments_of(system, k), state_of(system, k))


@view
def room_of(system, k):
    """Scratch space of line k: its conditions, then its integrator's arrays."""
    return behind(number_of_line(system, k, places.WORK_AT), system.work)


@kernel
def put_numbers(room, first, numbers):
    """Write the numbers of a tuple to scratch space (modified), from a place on."""
    for i in range(len(numbers)):
        room[first + i] = numbers[i]


@kernel
def store_conditions(conditions, room):
    """Write `BoundaryConditions` to the start of the scratch space of a line (modified)."""
    for place, end in ((GROUND, conditions.ground), (KITE, conditions.kite)):
        for i in range(len(end)):
            put_at(room, place + _VECTOR * i, end[i])
    put_numbers(room, REELING, conditions.reeling)
    put_at(room, WIND, conditions.wind)
    put_at(room, LOAD, conditions.load)
    put_at(room, LOAD_RATE, conditions.load_rate)
    room[FIRST], room[LAST] = conditions.first, conditions.last
    room[FORCE], room[FORCE_RATE] = conditions.force, conditions.force_rate


@kernel
def put_reeling(system, k, reeling):
    """Overwrite the coefficients of the unstretched length of line k, see `winch.py`, stored by `store_conditions`."""
    put_numbers(room_of(system, k), REELING, reeling)


@kernel
def hold_length(system, k, length):
    """Make the unstretched length [m] of line k constant."""
    put_reeling(system, k, steadily(length, 0.0, 0.0))


@kernel
def curve_at(room, first):
    """Curve of an end, stored at a place in the scratch space of a line."""
    coefficients = vector_at(room, first), vector_at(room, first + 3), vector_at(room, first + 6), vector_at(room, first + 9)
    return *coefficients, vector_at(room, first + 12), vector_at(room, first + 15)


@kernel
def reeling_at(room, first):
    """Coefficients of the unstretched length, see `winch.py`, stored at a place in scratch space."""
    polynomial = room[first], room[first + 1], room[first + 2], room[first + 3]
    return *polynomial, room[first + 4], room[first + 5], room[first + 6]


@view
def conditions_of(system, k):
    """`BoundaryConditions` of line k as `store_conditions` wrote them."""
    n, r = segments_of(system, k), room_of(system, k)
    ends = curve_at(r, GROUND), curve_at(r, KITE), int(r[FIRST]), int(r[LAST])
    loads = vector_at(r, WIND), vector_at(r, LOAD), vector_at(r, LOAD_RATE)
    return BoundaryConditions(n, parameters_of(system, k), *ends, reeling_at(r, REELING), r[FORCE], r[FORCE_RATE], *loads)
