"""Forces on the sought points, with all lines at rest between them, and their slopes by the point positions.

R and S of `resting_points.py`, in the scratch space of its search.
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import OK

from ..arrays import behind, clear, copy, split
from ..compilation import kernel, view
from ..equations.free_points import free_points, point_at, points_size, size_of_blocks
from ..equations.lines import lines_of, state_of
from ..flat_arrays import part
from ..linear_algebra.point_blocks import add_to_block, matrix_size
from ..linear_algebra.vectors import add_at, get, norm, put
from .resting_line import add_slopes, add_support, force_at, is_any_sought, is_sought, rest_line, rounding_at
from .rigid_body import GIVE

ACCURATE, BALANCED = 1e-12, 1e-10  # residual at a point over its line forces: goal, acceptable if it stalls
ROUNDED = 4.0  # residual over the tension rounding errors, acceptable if it stalls

Search = namedtuple("Search", "slopes x trial residual held move outer size rounding grip spent slides kept")
Search.__doc__ = """Scratch arrays of F free points, m = 3 F.

slopes : S, see `linear_algebra.point_blocks`.  x, trial : positions [m], m.
residual : R [N], m, without friction if the points slide.  held : R with friction [N], m.  move : dX [m], m.
outer : load and weight of the points [N], m.
size, rounding : of the forces at and of the lines of each point, and of their rounding errors [N], F.
grip : friction of the ground at the points [N], F.  spent : Newton iterations for the shapes of all lines, one number.
slides : 1 in a search without friction, else 0.  kept : an equilibrium to continue from [m], m.
"""


@kernel
def search_size(points, band):
    """Length in `work` for this number of free points with this band, including the search."""
    return points_size(points, band) + matrix_size(points, band) + 24 * points + 2


@view
def search_of(system):
    """`Search` of a system, behind its `Points`."""
    count, band = size_of_blocks(system)
    room = behind(int(system.plan[places.POINTS_WORK]) + points_size(count, band), system.work)
    m, size = 3 * count, matrix_size(count, band)
    slopes, room = part(room, 0, size), behind(size, room)
    x, trial, residual, room = split(m, room)
    held, move, outer, room = split(m, room)
    sizes = part(room, 0, count), part(room, count, count), part(room, 2 * count, count)
    numbers, kept = (part(room, 3 * count, 1), part(room, 3 * count + 1, 1)), part(room, 3 * count + 2, m)
    return Search(slopes, x, trial, residual, held, move, outer, *sizes, *numbers, kept)


@kernel
def find_residual(system, x, search):
    """R and its sizes with the sought points at x [m] into `search` (modified); False if a line has no equilibrium."""
    copy(search.outer, search.residual)
    clear(search.rounding)
    clear(search.grip)
    for point in range(free_points(system)):
        search.size[point] = norm(get(search.outer, point))
    for k in range(lines_of(system)):
        if is_any_sought(system, k):
            status = rest_line(system, k, x)
            search.spent[0] += state_of(system, k)[at.ITERATIONS]
            if status != OK:
                return False
            both = norm(force_at(system, k, 0)) + norm(force_at(system, k, 1))
            for end in range(2):
                if is_sought(system, k, end):
                    point = point_at(system, k, end)
                    add_at(search.residual, point, force_at(system, k, end))
                    search.size[point] += both
                    search.rounding[point] += rounding_at(system, k, end)
                    add_support(system, k, end, search)
    for point in range(free_points(system)):
        hold(point, search)
    if search.slides[0] == 0.0:
        copy(search.held, search.residual)
    return True


@kernel
def hold(point, search):
    """R of a point minus the part that friction holds, into `search` (modified)."""
    x, y, z = get(search.residual, point)
    sideways = norm((x, y, 0.0))
    left = 1.0 - search.grip[point] / sideways if sideways > search.grip[point] else 0.0
    put(search.held, point, (left * x, left * y, z) if search.grip[point] > 0.0 else (x, y, z))


@kernel
def find_slopes(system, search):
    """S [N/m] into `search` (modified), at the positions of `find_residual`; False if a line is singular."""
    clear(search.slopes)
    for k in range(lines_of(system)):
        if is_any_sought(system, k) and not add_slopes(system, k, search):
            return False
    for point in range(free_points(system)):
        x, y, _ = get(search.residual, point)
        if search.grip[point] > 0.0 and x == 0.0 and y == 0.0:
            held = search.grip[point] / GIVE
            block = held, 0.0, 0.0, 0.0, held, 0.0, 0.0, 0.0, 0.0
            add_to_block(*size_of_blocks(system), point, point, block, search.slopes)
    return True


@kernel
def least_balanced(stalled, search):
    """Number of the point with the largest residual, relative to its tolerance, and this ratio.

    stalled : whether the residual stagnates.
    """
    worst, most = 0, 0.0
    for point in range(len(search.size)):
        allowed = ACCURATE * search.size[point]
        if stalled:
            allowed = BALANCED * search.size[point] + ROUNDED * search.rounding[point]
        residual = norm(get(search.held, point))
        over = residual / allowed if residual > 0.0 else 0.0
        if not over <= most:
            worst, most = point, over
    return worst, most
