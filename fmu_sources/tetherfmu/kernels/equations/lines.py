"""A system of lines between points: its arrays, and those of one of its lines and of its free points.

Layout: `runtime/plan_layout.py`.
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..arrays import (
    behind,
    inputs_size,
    outputs_size,
    parameters_size,
    places_of,
    positions_and_velocities,
    split,
    state_size,
)
from ..compilation import kernel, view
from ..flat_arrays import part
from ..linear_algebra.condensed import Rows
from ..linear_algebra.point_blocks import matrix_size
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, get, put, put_at, vector_at
from .boundary import BoundaryConditions
from .continuation import given_derivatives, is_continued
from .end_motion import estimated_rates
from .plan import number_in
from .properties import property_of
from .winch import follows_force

System = namedtuple("System", "plan parameters inputs state work")
System.__doc__ = """The flat arrays of a system, see `plan_layout.py`.

plan : whole numbers, floats in `rest/resting_kite.py`; of a tether alone a `plan.OneLine`.
"""

Points = namedtuple("Points", "matrix right solution mass stage_mass mass_rate change load_rate")
Points.__doc__ = """Scratch arrays of F free points, m = 3 F.

matrix : see `linear_algebra.point_blocks`.  right, solution : right-hand side of a stage [N], q [m/s], m.
mass, stage_mass : of the point with its half segments at the start of the step and at a stage [kg], F.
mass_rate : the rate of `mass` [kg/s], F.  change : of the velocities by what follows a step [m/s], m.
load_rate : rates of the loads in the communication step [N/s], m.
"""

# what `store_conditions` writes, and the room for it: an even number as in `system_room.line_work_size`
_CURVE, _REELING, _VECTOR = 12, 5, 3
GROUND, KITE, REELING, WIND, LOAD, LOAD_RATE, FIRST, LAST, FORCE, FORCE_RATE, CONDITIONS = places_of(
    _CURVE, _CURVE, _REELING, _VECTOR, _VECTOR, _VECTOR, 1, 1, 1, 1
)


@kernel
def number_of_line(system, k, which):
    """What the plan says about line k: `plan_layout.SEGMENTS`, ..."""
    return number_in(system.plan, places.PLAN_HEADER + places.LINE_NUMBERS * k + which)


@kernel
def segments_of(system, k):
    """Number of segments of line k, with the one that it has more since it has let go, see `torn.py`."""
    return number_of_line(system, k, places.SEGMENTS) + number_of_line(system, k, places.FREED)


@kernel
def point_at(system, k, end):
    """Number of the free point at the start (end 0) or at the end (1) of line k, or DRIVEN, where there is none."""
    return number_of_line(system, k, places.START_POINT + end)


@kernel
def is_at_point(system, k, end):
    """Whether the start (end 0) or the end (1) of line k is a free point."""
    return point_at(system, k, end) != places.DRIVEN


@kernel
def lines_of(system):
    """Number of lines."""
    return number_in(system.plan, places.LINES)


@kernel
def free_points(system):
    """Number of free points."""
    return number_in(system.plan, places.FREE_POINTS)


@kernel
def size_of_blocks(system):
    """Rows and width of the matrix of the free points, see `linear_algebra.point_blocks`."""
    return free_points(system), number_in(system.plan, places.BAND)


@kernel
def sheaves_of(system):
    """Number of sheaves."""
    return number_in(system.plan, places.SHEAVES)


@kernel
def has_sheaves(system):
    """Whether any line runs over a sheave."""
    return sheaves_of(system) > 0


@kernel
def coordinates_in(system):
    """Number of sheaves, and of drums that may turn beside them; see `points/coordinates.py`."""
    return number_in(system.plan, places.COORDINATES)


@kernel
def has_coordinates(system):
    """Whether there is any."""
    return coordinates_in(system) > 0


@kernel
def goes_on(system, k):
    """Whether line k goes on over a sheave at its end."""
    return number_of_line(system, k, places.THROUGH) != 0


@kernel
def comes_from(system, k):
    """Whether line k comes from a sheave at its start."""
    return has_sheaves(system) and k > 0 and number_of_line(system, k - 1, places.THROUGH) != 0


@kernel
def first_of(system, k):
    """The first portion of the rope of which line k is one."""
    while comes_from(system, k):
        k -= 1
    return k


@kernel
def is_freed(system, k):
    """Whether the arrays of line k are those of a line that has let go at its end."""
    return number_of_line(system, k, places.FREED) != 0


@kernel
def is_portion(system, k):
    """Whether line k is a portion of one that runs over sheaves."""
    return has_sheaves(system) and (goes_on(system, k) or comes_from(system, k))


@kernel
def is_even(system, k):
    """Whether all segments of line k are equal: it is a portion, and none is the gap of a line that has let go."""
    return is_portion(system, k) and not is_freed(system, k)


@kernel
def is_turned(system, k):
    """Whether drums that turn beside sheaves, or hold several lines, pay out line k."""
    if not has_coordinates(system):
        return False
    return parameters_of(system, k)[at.HELD_BY] != 0.0 and follows_force(parameters_of(system, k))


@kernel
def is_rope(system, k):
    """Whether rope may run into line k or out of it, over a sheave or off such a drum."""
    return is_portion(system, k) or is_turned(system, k)


@kernel
def stiffness_of(system, k):
    """EA [N] of the first segment of line k."""
    return property_of(conditions_of(system, k), 0, at.STIFFNESS)


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


@view
def outputs_of_line(system, k, outputs):
    """Part of line k of an array of outputs."""
    size = outputs_size(number_of_line(system, k, places.SHAPE_POINTS), is_portion(system, k))
    return part(outputs, number_of_line(system, k, places.OUTPUTS_AT), size)


@kernel
def place_of_inputs(system, k):
    """First place and number of the inputs of line k."""
    return number_of_line(system, k, places.INPUTS_AT), inputs_size(number_of_line(system, k, places.WIND_POINTS))


@view
def inputs_of(system, k):
    """`inputs` of line k."""
    return part(system.inputs, *place_of_inputs(system, k))


@kernel
def load_on(system, point):
    """Load on a free point [N] at the start of the communication step."""
    first, size = place_of_inputs(system, lines_of(system) - 1)
    return vector_at(system.inputs, first + size + 3 * point)


@kernel
def load_at(system, point, time):
    """Load on a free point [N] at a time [s] of the communication step."""
    return add_scaled(load_on(system, point), time, get(points_of(system).load_rate, point))


@kernel
def places_of_load(end):
    """Where the state of a line has what it remembers of the load on a point at its start (end 0) or its end (1).

    The places of the last load [N] and of its recent rate [N/s], and among the inputs that of a given rate: those that the
    velocity of a driven end and its rate have.
    """
    if end == 1:
        return at.LAST_RATED, at.RECENT_RATES, at.KITE_VELOCITY
    return at.LAST_RATED + 3, at.RECENT_RATES + 3, at.GROUND_VELOCITY


@kernel
def take_loads(system, k, step, before):
    """Loads on the free points at line k in a step [s] from the states `before`: how they go on, and what is kept of them.

    Their rates [N/s], as of a load on a kite end (`boundary.inputs_of_step`), go into `Points.load_rate`, loads and recent
    rates into the state of the line (both modified).
    """
    old, state = state_of(with_states(system, before), k), state_of(system, k)
    for end in range(2):
        if is_at_point(system, k, end):
            (last, recent, place), point = places_of_load(end), point_at(system, k, end)
            load, longest = load_on(system, point), old[at.LONGEST_SO_FAR]
            times = old[at.LAST_STEP], old[at.LAST_STEP], old[at.LAST_STEP]
            change = load, vector_at(old, last), vector_at(old, recent), times, longest
            estimate = estimated_rates(*change, step) if is_continued(parameters_of(system, k)) else ZERO_VECTOR
            put(points_of(system).load_rate, point, given_derivatives(old, place, estimate))
            put_at(state, last, load)
            put_at(state, recent, estimated_rates(*change, longest))


@view
def motion_of(system, k):
    """Positions [m] and velocities [m/s] of the nodes of line k."""
    return positions_and_velocities(segments_of(system, k), state_of(system, k))


@view
def room_of(system, k):
    """Scratch space of line k: its conditions, then that of its integrator."""
    return behind(number_of_line(system, k, places.WORK_AT), system.work)


@kernel
def points_size(points, band):
    """Length of what so many free points need of `work`, with this band of their matrix."""
    return matrix_size(points, band) + 15 * points


@view
def points_of(system):
    """`Points` of a system."""
    count, room = free_points(system), behind(number_in(system.plan, places.POINTS_WORK), system.work)
    m, size = 3 * count, matrix_size(*size_of_blocks(system))
    matrix, room = part(room, 0, size), behind(size, room)
    right, solution, change, room = split(m, room)
    load_rate, room = part(room, 0, m), behind(m, room)
    masses = part(room, 0, count), part(room, count, count), part(room, 2 * count, count)
    return Points(matrix, right, solution, *masses, change, load_rate)


@kernel
def store_conditions(conditions, room):
    """Write `BoundaryConditions` to the start of the scratch space of a line (modified)."""
    for place, end in ((GROUND, conditions.ground), (KITE, conditions.kite)):
        for i in range(len(end)):
            put_at(room, place + _VECTOR * i, end[i])
    room[REELING], room[REELING + 1], room[REELING + 2], room[REELING + 3], room[REELING + 4] = conditions.reeling
    put_at(room, WIND, conditions.wind)
    put_at(room, LOAD, conditions.load)
    put_at(room, LOAD_RATE, conditions.load_rate)
    room[FIRST], room[LAST] = conditions.first, conditions.last
    room[FORCE], room[FORCE_RATE] = conditions.force, conditions.force_rate


@kernel
def put_reeling(system, k, reeling):
    """Let the unstretched length of line k have these coefficients, see `winch.py`, in what `store_conditions` wrote."""
    room = room_of(system, k)
    room[REELING], room[REELING + 1], room[REELING + 2], room[REELING + 3], room[REELING + 4] = reeling


@kernel
def curve_at(room, first):
    """The curve of an end from a place of the scratch space of a line on."""
    return vector_at(room, first), vector_at(room, first + 3), vector_at(room, first + 6), vector_at(room, first + 9)


@view
def conditions_of(system, k):
    """`BoundaryConditions` of line k as `store_conditions` wrote them."""
    n, r = segments_of(system, k), room_of(system, k)
    ends = curve_at(r, GROUND), curve_at(r, KITE), int(r[FIRST]), int(r[LAST])
    reeling = r[REELING], r[REELING + 1], r[REELING + 2], r[REELING + 3], r[REELING + 4]
    loads = vector_at(r, WIND), vector_at(r, LOAD), vector_at(r, LOAD_RATE)
    return BoundaryConditions(n, parameters_of(system, k), *ends, reeling, r[FORCE], r[FORCE_RATE], *loads)


@kernel
def rows_of(system, k):
    """`condensed.Rows` of the equations of line k: its free nodes are inner rows, and its free points are shared."""
    n, conditions = segments_of(system, k), conditions_of(system, k)
    at_start, at_end = is_at_point(system, k, 0), is_at_point(system, k, 1)
    return Rows(n, 1 if at_start else conditions.first, n - 1 if at_end else conditions.last, at_start, at_end)


@kernel
def add_at(array, point, a):
    """Add a vector to number `point` of a flat array (modified)."""
    put(array, point, add(get(array, point), a))


@kernel
def clear(array):
    """Set a flat array to zero (modified)."""
    for k in range(len(array)):
        array[k] = 0.0
