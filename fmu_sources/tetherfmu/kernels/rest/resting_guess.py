"""Start of the search for free points at rest (`resting_points.py`): the input positions, or an equilibrium of springs."""

from math import cos, inf, sin

import numpy as np

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel
from ..equations import node_loads
from ..equations.free_points import free_points, load_on, point_at, points_of, size_of_blocks
from ..equations.ground import carries, under
from ..equations.lines import lines_of, parameters_of, segments_of, state_of
from ..equations.properties import chain_of, point_mass, property_of, rest_length
from ..linear_algebra.matrices import IDENTITY, scale_matrix
from ..linear_algebra.point_blocks import add_to_block, factorize_blocks, solve_blocks
from ..linear_algebra.vectors import add_at, get, norm, put, scale
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
def largest(vectors):
    """Size of the largest of the vectors in a flat array."""
    most = 0.0
    for k in range(len(vectors) // 3):
        most = max(most, norm(get(vectors, k)))
    return most


@kernel
def shortest_line(system):
    """Length [m] of the shortest line at a sought point."""
    shortest = inf
    for k in range(lines_of(system)):
        if is_any_sought(system, k):
            shortest = min(shortest, state_of(system, k)[at.LENGTH])
    return shortest


@kernel
def guess(system, pull, search):
    """Place the sought points, search.x [m] (modified), with lines as springs without length; False if that is impossible.

    At their length the springs pull with `pull` times the largest outer force.
    """
    points, size, x = points_of(system), size_of_blocks(system), search.x
    copy(search.outer, points.right)
    for k in range(lines_of(system)):
        for end in range(2):
            if is_sought(system, k, end):
                add_at(points.right, point_at(system, k, end), half_weight(system, k))
    force = largest(points.right)
    clear(points.matrix)
    for point in range(free_points(system)):
        if not is_point_sought(system, point):  # it is fixed
            add_to_block(*size, point, point, IDENTITY, points.matrix)
    for k in range(lines_of(system)):
        density = pull * (force if force > 0.0 else 1.0) / state_of(system, k)[at.LENGTH]
        for end in range(2):
            if is_sought(system, k, end):
                point, other = point_at(system, k, end), point_at(system, k, 1 - end)
                add_to_block(*size, point, point, scale_matrix(density, IDENTITY), points.matrix)
                if is_sought(system, k, 1 - end):
                    add_to_block(*size, point, other, scale_matrix(-density, IDENTITY), points.matrix)
                else:
                    add_at(points.right, point, scale(density, given_position(system, k, 1 - end)))
    if not factorize_blocks(*size, points.matrix):
        return False
    solve_blocks(*size, points.matrix, points.right, x)
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

    AS_GIVEN : at the line inputs.  DROPPED : below or above these, where the ground carries their weight.
    GUESSED and above : at a `guess`.
    """
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
