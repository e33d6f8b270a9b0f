"""Imbalance of the sought points and rope coordinates, with all lines at rest between them, and its slopes.

R and S of `resting_points.py`, in the scratch space of its search and of the global unknowns.
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import OK

from ..arrays import behind, clear, copy, split
from ..compilation import kernel, view
from ..equations.free_points import free_points, point_at, points_size
from ..equations.lines import lines_of, number_in, state_of
from ..flat_arrays import part
from ..linear_algebra import profile
from ..linear_algebra.matrices import IDENTITY
from ..linear_algebra.vectors import add_at, get, norm, put
from ..points.coordinates import is_shared_out
from ..points.room import globals_of, profile_size
from .resting_line import add_slopes, add_support, force_at, is_any_sought, is_point_sought, is_sought, rounding_at
from .resting_ropes import add_slopes_of_rope, find_imbalances, hold_stopped, put_lengths, settle, take_coordinates
from .rigid_body import GIVE

ACCURATE, BALANCED = 1e-12, 1e-10  # residual at a point over its line forces: goal, acceptable if it stalls
ROUNDED = 4.0  # residual over the tension rounding errors, acceptable if it stalls
ROPES_BALANCED, ROPES_ROUNDED = 1e-12, 1e-7  # of a coordinate over the largest tension: goal, acceptable if it stalls

Search = namedtuple(
    "Search", "lower upper x trial residual held move outer size rounding grip kept carrier count tension spent slides"
)
Search.__doc__ = """Scratch arrays of F free points and C rope coordinates, m = 3 F + C.

lower, upper : S by `linear_algebra.profile`.  x, trial : positions and payouts [m], m.
residual : R [N], m, without friction if the points slide.  held : R of the points with friction [N], 3 F.  move : dX [m], m.
outer : load and weight of the points [N], 3 F.
size, rounding : of the forces at and of the lines of each point, and of their rounding errors [N], F.
grip : friction of the ground at the points [N], F.  kept : an equilibrium to continue from [m], m.
carrier : see `resting_ropes.take_coordinates`, C.
One number each: count : C, at most the coordinates of the plan.  tension : the largest one of ropes [N].
spent : Newton iterations for the shapes of all lines.  slides : 1 in a search without friction, else 0.
"""


@kernel
def search_size(points, band, coordinates):
    """Length in `work` for this number of free points with this band and of coordinates, including the search."""
    m = 3 * points + coordinates
    return points_size(points) + 2 * profile_size(points, band, coordinates) + 5 * m + 9 * points + coordinates + 4


@view
def search_of(system):
    """`Search` of a system, behind its `Points`."""
    count, most = free_points(system), number_in(system.plan, places.COORDINATES)
    m, size = 3 * count + most, profile_size(count, number_in(system.plan, places.BAND), most)
    room = behind(number_in(system.plan, places.POINTS_WORK) + points_size(count), system.work)
    lower, upper, room = part(room, 0, size), part(room, size, size), behind(2 * size, room)
    x, trial, residual, room = split(m, room)
    move, kept, room = part(room, 0, m), part(room, m, m), behind(2 * m, room)
    held, outer, room = part(room, 0, 3 * count), part(room, 3 * count, 3 * count), behind(6 * count, room)
    sizes = part(room, 0, count), part(room, count, count), part(room, 2 * count, count)
    carrier, room = part(room, 3 * count, most), behind(3 * count + most, room)
    numbers = part(room, 0, 1), part(room, 1, 1), part(room, 2, 1), part(room, 3, 1)
    return Search(lower, upper, x, trial, residual, held, move, outer, *sizes, kept, carrier, *numbers)


@kernel
def unknowns_at_rest(system, search):
    """Number of unknowns: three per free point, then one per coordinate."""
    return 3 * free_points(system) + int(search.count[0])


@kernel
def begin(system, search):
    """Number the coordinates of the search, and give its matrix a profile (both modified)."""
    search.spent[0], search.count[0] = 0.0, take_coordinates(system, search)
    m, points, matrix = unknowns_at_rest(system, search), 3 * free_points(system), globals_of(system).matrix
    for i in range(m):
        matrix.first[i] = i - i % 3 if i < points else 0
    for k in range(lines_of(system)):
        if is_sought(system, k, 0) and is_sought(system, k, 1):
            for axis in range(3):
                profile.join(matrix, 3 * point_at(system, k, 0) + axis, 3 * point_at(system, k, 1))
                profile.join(matrix, 3 * point_at(system, k, 0), 3 * point_at(system, k, 1) + axis)
    profile.begin(matrix, m)


@kernel
def find_residual(system, x, search):
    """R and its sizes with the unknowns at x [m] into `search` (modified); False if a line has no equilibrium."""
    copy(search.outer, search.residual)
    clear(search.rounding)
    clear(search.grip)
    put_lengths(system, x, search)
    for point in range(free_points(system)):
        search.size[point] = norm(get(search.outer, point))
    for k in range(lines_of(system)):
        if is_any_sought(system, k) or is_shared_out(system, k):
            status = settle(system, k, x)
            search.spent[0] += state_of(system, k)[at.ITERATIONS]
            if status != OK:
                return False
        if is_any_sought(system, k):
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
    find_imbalances(system, search)
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
    """S [N/m] into `search` (modified), at the unknowns of `find_residual`, search.x; False if a line is singular."""
    matrix = globals_of(system).matrix
    profile.clear(matrix, unknowns_at_rest(system, search))
    for k in range(lines_of(system)):
        if is_any_sought(system, k) and not add_slopes(system, k, search):
            return False
        if is_shared_out(system, k) and not add_slopes_of_rope(system, k, search.x, search):
            return False
    for point in range(free_points(system)):
        x, y, _ = get(search.residual, point)
        if search.grip[point] > 0.0 and x == 0.0 and y == 0.0:
            held = search.grip[point] / GIVE
            block = held, 0.0, 0.0, 0.0, held, 0.0, 0.0, 0.0, 0.0
            profile.add_block(matrix, 3 * point, 3 * point, block)
        if not is_point_sought(system, point):
            profile.add_block(matrix, 3 * point, 3 * point, IDENTITY)
    hold_stopped(system, search)
    copy(part(matrix.lower, 0, len(search.lower)), search.lower)
    copy(part(matrix.upper, 0, len(search.upper)), search.upper)
    return True


@kernel
def least_balanced(stalled, search):
    """Number of the point, or behind them of the coordinate, with the largest residual over its tolerance; this ratio.

    stalled : whether the residual stagnates.
    """
    points, worst, most = len(search.size), 0, 0.0
    for place in range(points + int(search.count[0])):
        if place < points:
            allowed, residual = ACCURATE * search.size[place], norm(get(search.held, place))
            if stalled:
                allowed = BALANCED * search.size[place] + ROUNDED * search.rounding[place]
        else:
            residual = abs(search.residual[2 * points + place])
            allowed = (ROPES_ROUNDED if stalled else ROPES_BALANCED) * search.tension[0]
        over = residual / allowed if residual > 0.0 else 0.0
        if not over <= most:
            worst, most = place, over
    return worst, most
