"""The free points of a system, where lines end: their numbers, loads and scratch space."""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places

from ..arrays import behind
from ..compilation import kernel, view
from ..flat_arrays import part
from ..linear_algebra.condensed import Rows
from ..linear_algebra.vectors import ZERO_VECTOR, add_at, add_scaled, get, put, put_at, scale, vector_at
from .continuation import given_derivatives, is_continued
from .end_motion import estimated_rates
from .lines import (
    conditions_of,
    lines_of,
    motion_of,
    number_in,
    number_of_line,
    parameters_of,
    place_of_inputs,
    segments_of,
    state_of,
    with_states,
)
from .properties import half_density, point_mass, rest_length

Points = namedtuple("Points", "mass change load_rate")
Points.__doc__ = """Scratch arrays of F free points, m = 3 F.

mass : of the point with its half segments [kg], F.  change : velocity changes after a step [m/s], m.
load_rate : rates of the loads in the communication step [N/s], m."""


@kernel
def point_at(system, k, end):
    """Number of the free point at the start (end 0) or at the end (1) of line k; DRIVEN if there is none."""
    return number_of_line(system, k, places.START_POINT + end)


@kernel
def is_at_point(system, k, end):
    """Whether the start (end 0) or the end (1) of line k is a free point."""
    return point_at(system, k, end) != places.DRIVEN


@kernel
def free_points(system):
    """Number of free points."""
    return number_in(system.plan, places.FREE_POINTS)


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
    """Places in a line's state where the load on a point at its start (end 0) or its end (1) is stored.

    The places of the last load [N] and of its recent rate [N/s], and the input place of a given rate: the places that a
    driven end uses for its velocity and acceleration.
    """
    if end == 1:
        return at.LAST_RATED, at.RECENT_RATES, at.KITE_VELOCITY
    return at.LAST_RATED + 3, at.RECENT_RATES + 3, at.GROUND_VELOCITY


@kernel
def take_loads(system, k, step, before):
    """Extrapolate the loads on the free points of line k in a step [s] from the states `before`, and store the next ones.

    Their rates [N/s], as for a load on a kite end (`boundary.inputs_of_step`), go into `Points.load_rate`, loads and
    recent rates into the state of the line (both modified).
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


@kernel
def points_size(points):
    """Length of `Points` in `work` for this number of free points."""
    return 7 * points


@view
def points_of(system):
    """`Points` of a system."""
    count, room = free_points(system), behind(number_in(system.plan, places.POINTS_WORK), system.work)
    return Points(part(room, 0, count), part(room, count, 3 * count), part(room, 4 * count, 3 * count))


@kernel
def rows_of(system, k):
    """`condensed.Rows` of the equations of line k: free nodes are inner rows, free points are shared."""
    n, conditions = segments_of(system, k), conditions_of(system, k)
    at_start, at_end = is_at_point(system, k, 0), is_at_point(system, k, 1)
    return Rows(n, 1 if at_start else conditions.first, n - 1 if at_end else conditions.last, at_start, at_end)


def push_with(chain_of_line):
    """Return a kernel that pushes a free point; chain_of_line : view of a system, a line and a time [s]: its `Chain`."""

    @kernel
    def push_point(system, point, impulse, mass, time):
        """Apply an impulse [N s] to a free point (modified, at the ends of all its lines) at a time [s].

        mass : that moves with the point [kg], besides its own.  Returns the change of velocity [m/s].
        """
        for k in range(lines_of(system)):
            chain = chain_of_line(system, k, time)
            for end in range(2):
                if point_at(system, k, end) == point:
                    s = (chain.n - 1) * end
                    mass += half_density(chain, s) * rest_length(chain, s) + point_mass(chain, chain.n * end)
        change = scale(1.0 / mass, impulse)
        for k in range(lines_of(system)):
            _, v = motion_of(system, k)
            for end in range(2):
                if point_at(system, k, end) == point:
                    add_at(v, segments_of(system, k) * end, change)
        return change

    return push_point
