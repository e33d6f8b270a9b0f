"""Start of the search for free points at rest (`resting_points.py`): the input positions, or an equilibrium of springs."""

from math import cos, inf, sin

import numpy as np

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel
from ..equations import node_loads
from ..equations.free_points import free_points, load_on, point_at
from ..equations.ground import carries, under
from ..equations.lines import lines_of, parameters_of, segments_of, state_of
from ..equations.properties import chain_of, point_mass, property_of, rest_length
from ..linear_algebra import profile
from ..linear_algebra.matrices import IDENTITY, scale_matrix
from ..linear_algebra.vectors import add_at, get, norm, put, scale
from ..points.coordinates import is_shared_out
from ..points.room import globals_of
from .resting_forces import unknowns_at_rest
from .resting_line import given_position, is_any_sought, is_point_sought, is_sought

PULLS = np.array((1.0, 0.3, 3.0))  # spring force of the guesses: weaker springs stretch the lines more
AS_GIVEN, DROPPED, GUESSED = 0, 1, 2  # starts of a search, see `set_off`; from GUESSED on with the pulls above
SPREAD = 0.01  # distance that separates guesses, over the shortest line
COSINE, SINE = cos(1.0), sin(1.0)  # of the angle [rad] between successive directions


@kernel
def find_outer(system, search):
    """Weight and load of the sought points [N] into `search` (modified); the lines have their first states, see `check`."""
    clear(search.outer)
    for k in range(lines_of(system)):
        n, state = segments_of(system, k), state_of(system, k)
        chain = chain_of(n, parameters_of(system, k), state)
        for end in range(2):
            if is_sought(system, k, end):
                add_at(search.outer, point_at(system, k, end), node_loads.weight(chain, point_mass(chain, n * end)))
    for point in range(free_points(system)):
        if is_point_sought(system, point):
            add_at(search.outer, point, load_on(system, point))


@kernel
def half_weight(system, k):
    """Half of the weight of line k [N]."""
    n = segments_of(system, k)
    chain = chain_of(n, parameters_of(system, k), state_of(system, k))
    mass = 0.0
    for s in range(n):
        mass += 0.5 * property_of(chain, s, at.LINE_DENSITY) * rest_length(chain, s)
    return node_loads.weight(chain, mass)


@kernel
def largest(system, numbers, search):
    """Size of the largest vector at a point, or of the largest number at a coordinate, of an array of all unknowns."""
    points, most = free_points(system), 0.0
    for point in range(points):
        most = max(most, norm(get(numbers, point)))
    for j in range(3 * points, unknowns_at_rest(system, search)):
        most = max(most, abs(numbers[j]))
    return most


@kernel
def shortest_line(system):
    """Length [m] of the shortest line at a sought point or coordinate."""
    shortest = inf
    for k in range(lines_of(system)):
        if is_any_sought(system, k) or is_shared_out(system, k):
            shortest = min(shortest, state_of(system, k)[at.LENGTH])
    return shortest


@kernel
def guess(system, pull, search):
    """Place the sought points, search.x [m] (modified), with lines as springs without length; False if that is impossible.

    At their length the springs pull with `pull` times the largest outer force.
    """
    whole, m, x = globals_of(system), unknowns_at_rest(system, search), search.x
    clear(whole.right)
    copy(search.outer, whole.right)
    for k in range(lines_of(system)):
        for end in range(2):
            if is_sought(system, k, end):
                add_at(whole.right, point_at(system, k, end), half_weight(system, k))
    force = largest(system, whole.right, search)
    profile.clear(whole.matrix, m)
    for point in range(free_points(system)):
        if not is_point_sought(system, point):  # it is fixed
            profile.add_block(whole.matrix, 3 * point, 3 * point, IDENTITY)
    for i in range(3 * free_points(system), m):
        profile.add_entry(whole.matrix, i, i, 1.0)
    for k in range(lines_of(system)):
        density = pull * (force if force > 0.0 else 1.0) / state_of(system, k)[at.LENGTH]
        for end in range(2):
            if is_sought(system, k, end):
                point, other = point_at(system, k, end), point_at(system, k, 1 - end)
                profile.add_block(whole.matrix, 3 * point, 3 * point, scale_matrix(density, IDENTITY))
                if is_sought(system, k, 1 - end):
                    profile.add_block(whole.matrix, 3 * point, 3 * other, scale_matrix(-density, IDENTITY))
                else:
                    add_at(whole.right, point, scale(density, given_position(system, k, 1 - end)))
    if not profile.factorize(whole.matrix, m):
        return False
    profile.solve(whole.matrix, m, whole.right, x)
    ground, apart = under(parameters_of(system, 0)), SPREAD * shortest_line(system)
    along_x, along_y = apart, 0.0
    for point in range(free_points(system)):
        add_at(x, point, (along_x, along_y, 0.0))
        if carries(ground, get(x, point)):
            put(x, point, (x[3 * point], x[3 * point + 1], ground.height))
        along_x, along_y = COSINE * along_x - SINE * along_y, SINE * along_x + COSINE * along_y
    return True


@kernel
def set_off(system, start, search):
    """Place the sought points, search.x [m] (modified), for search number `start`; False if that is impossible.

    Rope coordinates begin at 0.

    AS_GIVEN : at the line inputs.  DROPPED : below or above these, where the ground carries their weight.
    GUESSED and above : at a `guess`.
    """
    clear(search.x)
    if start >= GUESSED:
        return guess(system, PULLS[start - GUESSED], search)
    parameters = parameters_of(system, 0)
    ground = under(parameters)
    if start == DROPPED and ground.hardness == 0.0:
        return False
    for k in range(lines_of(system)):
        for end in range(2):
            if is_sought(system, k, end):
                x, y, z = given_position(system, k, end)
                height = ground.height - parameters[at.GROUND_SINK] if start == DROPPED else z
                put(search.x, point_at(system, k, end), (x, y, height))
    return True
