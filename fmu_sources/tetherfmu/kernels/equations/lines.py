"""A system of lines between points: its arrays, and those of one of its lines.

Layout: `runtime/plan_layout.py`. The plan is an array, or that of a tether alone, of which all but the number of segments is
known when compiled. So the kernels that move systems move a single tether, too, and what of them is about other lines and
points is not there.
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

plan : whole numbers, floats in `rest/resting_kite.py`; of a tether alone an `OneLine`.
"""

OneLine = namedtuple("OneLine", "segments")
OneLine.__doc__ = """The plan of a system of one line without points.

What of its ends moves freely is a row of the line like the others, see `BoundaryConditions`.
"""

ONE_LINE_ROOM = 128  # of `work` before the line, for the one coordinate that it may have, see `points/room.py`

# what `store_conditions` writes, and the room for it: an even number as in `room.line_work_size`
_CURVE, _REELING, _VECTOR = 18, 7, 3
GROUND, KITE, REELING, WIND, LOAD, LOAD_RATE, FIRST, LAST, FORCE, FORCE_RATE, CONDITIONS = places_of(
    _CURVE, _CURVE, _REELING, _VECTOR, _VECTOR, _VECTOR, 1, 1, 1, 1
)


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
    return ONE_LINE_ROOM if place == places.PLAN_HEADER + places.WORK_AT else 0


@kernel
def note_in_array(plan, k):
    """Write into a plan (modified) that a status is about line k."""
    plan[places.STATUS_LINE] = k


@kernel
def note_in_one_line(plan, k):
    """A status is always about the one line."""


number_in, note_line = by_kind(number_in_one_line, number_in_array), by_kind(note_in_one_line, note_in_array)


@kernel
def number_of_line(system, k, which):
    """What the plan says about line k: `plan_layout.SEGMENTS`, ..."""
    return number_in(system.plan, places.PLAN_HEADER + places.LINE_NUMBERS * k + which)


@kernel
def segments_of(system, k):
    """Number of segments of line k, with the one that it has more since it has let go, see `torn.py`."""
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
    """Scratch space of line k: its conditions, then that of its integrator."""
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
    """Let the unstretched length of line k have these coefficients, see `winch.py`, in what `store_conditions` wrote."""
    put_numbers(room_of(system, k), REELING, reeling)


@kernel
def hold_length(system, k, length):
    """Let the unstretched length [m] of line k not change by itself."""
    put_reeling(system, k, steadily(length, 0.0, 0.0))


@kernel
def curve_at(room, first):
    """The curve of an end from a place of the scratch space of a line on."""
    coefficients = vector_at(room, first), vector_at(room, first + 3), vector_at(room, first + 6), vector_at(room, first + 9)
    return *coefficients, vector_at(room, first + 12), vector_at(room, first + 15)


@kernel
def reeling_at(room, first):
    """How a length is reeled, see `winch.py`, from a place of scratch space on."""
    polynomial = room[first], room[first + 1], room[first + 2], room[first + 3]
    return *polynomial, room[first + 4], room[first + 5], room[first + 6]


@view
def conditions_of(system, k):
    """`BoundaryConditions` of line k as `store_conditions` wrote them."""
    n, r = segments_of(system, k), room_of(system, k)
    ends = curve_at(r, GROUND), curve_at(r, KITE), int(r[FIRST]), int(r[LAST])
    loads = vector_at(r, WIND), vector_at(r, LOAD), vector_at(r, LOAD_RATE)
    return BoundaryConditions(n, parameters_of(system, k), *ends, reeling_at(r, REELING), r[FORCE], r[FORCE_RATE], *loads)
