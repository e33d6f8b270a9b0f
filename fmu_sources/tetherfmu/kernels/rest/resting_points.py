"""Free points and rope coordinates in equilibrium with all lines at rest: Newton's method on positions and payouts.

    R_p = sum over the lines at p of their force on it + m_p g + load_p = 0,   R_j : `resting_ropes.py`

Each line is in equilibrium between its two points (`dynamic_chain.initialize`), and never a compressed chain. The slopes of
its forces by the end positions (`resting_line.py`) are summed in S = -dR/dX. Apart from drag, R is minus the gradient
of a potential. A step dX solves (a I + S) dX = R with a damping a that makes the matrix positive definite, so the
potential falls along dX; the step ends before it rises much. Start of the search: `resting_guess.py`.

Ground friction holds a point: a sideways force counts only beyond mu times the pressure.

If this fails, pseudo-transient continuation moves the points as in overdamped motion: steps of the same equation, each
shorter than a part of the shortest line, regardless of the potential.
On the ground, lines that push, because they are too short to fold, lock by friction far from the equilibrium. The last
method follows the forces without friction, which have a potential again, in short steps; it ends where
friction holds the points.

In wind, a piled-up line has no equilibrium at some positions that the search must cross. If nothing is found on
the ground, the search starts in no air or thin air, and the density is raised from one equilibrium to the next;
then it runs without friction, and finally with it.
Source: Nocedal and Wright, Numerical Optimization, 2nd ed., section 3.4 (Newton's method with a modified Hessian).
"""

from math import inf

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.status import NO_EQUILIBRIUM_OF_POINT, NO_POINT_IS_GIVEN, NO_SHARES, OK

from ..arrays import copy
from ..compilation import kernel
from ..equations.free_points import point_at
from ..equations.ground import has_ground
from ..equations.lines import inputs_of, lines_of, parameters_of
from ..linear_algebra import profile
from ..linear_algebra.vectors import get, put_at
from ..points.coordinates import is_shared_out
from ..points.room import globals_of
from .resting_forces import begin, find_residual, find_slopes, least_balanced, search_of, unknowns_at_rest
from .resting_guess import AS_GIVEN, GUESSED, PULLS, find_outer, largest, set_off, shortest_line
from .resting_line import any_sought, is_any_sought, is_sought, start_state
from .resting_ropes import part_within

ITERATIONS = 300  # of a search
PATIENCE = 60  # iterations of a search with coordinates in which the residual must be halved
BUDGET = 150000.0  # Newton iterations for line shapes in the whole search, mean of all lines
STALLED = 0.5  # residual over the previous residual above which it stalls
HARDER, SOFTER = 2.0, 0.2  # factor on the damping after a shortened step; after a whole one
LARGEST_DAMPING = 60  # doublings of the damping
OVERSHOT = 0.5  # rise of the potential at the end of a step over its fall at the start
SHORTEST_PART, LONGEST_PART, TRIALS = 0.1, 0.9, 12  # fraction of a step for the next trial; number of trials
FIRST_PART = 0.3  # first step of the most loaded point, over the shortest line
ALONG, SLOWLY, SLIDING, WAYS = 0, 1, 2, 3  # search methods
LONGEST = np.array((inf, 0.2, 0.5))  # longest step of each method, over the shortest line
AIR = np.array((0.0, 0.25, 0.5, 0.75, 1.0))  # relative density, from one equilibrium to the next
DENSEST = 0.25  # largest of these for the first equilibrium


@kernel
def find_move(system, damping, search):
    """dX into search.move [m] (modified), along which the potential falls: its damping [N/m], and whether it was found."""
    m, matrix = unknowns_at_rest(system, search), globals_of(system).matrix
    for _ in range(LARGEST_DAMPING):
        copy(search.lower, matrix.lower)
        copy(search.upper, matrix.upper)
        for i in range(m):
            profile.add_entry(matrix, i, i, damping)
        if profile.factorize_definite(matrix, m):
            profile.solve_definite(matrix, m, search.residual, search.move)
            return damping, True
        damping *= HARDER
    return damping, False


@kernel
def try_part(system, taken, search):
    """R after a fraction of a step, into `search` (modified): R dX there [N m], -inf if a line has no equilibrium."""
    for k in range(len(search.x)):
        search.trial[k] = search.x[k] + taken * search.move[k]
    if not find_residual(system, search.trial, search):
        return -inf
    return work_along(system, search)


@kernel
def work_along(system, search):
    """R dX [N m]."""
    total = 0.0
    for i in range(unknowns_at_rest(system, search)):
        total += search.residual[i] * search.move[i]
    return total


@kernel
def longest_part(system, limit, search):
    """Fraction of a step that is no longer than a limit [m] at any point or coordinate, and changes no rope too much."""
    longest = largest(system, search.move, search)
    return min(1.0 if longest <= limit else limit / longest, part_within(system, search))


@kernel
def go_along(system, most, overshot, search):
    """Move search.x [m] by a fraction of a step, at most `most`: this fraction [-], and whether all lines are at rest.

    overshot : permitted rise of the potential at the end over its fall at the start; secant steps reduce a larger one.
    """
    start, taken = work_along(system, search), most
    for trial in range(TRIALS):
        left = try_part(system, taken, search)
        if left > -overshot * start or trial == TRIALS - 1:
            copy(search.trial, search.x)
            return taken, left > -inf
        taken *= min(max(start / (start - left), SHORTEST_PART), LONGEST_PART)
    return taken, False


@kernel
def search_from(system, way, search):
    """Search for the equilibrium from search.x [m] (modified): the least balanced point, and whether it was found.

    way : ALONG the potential, SLOWLY by pseudo-transient continuation, or SLIDING without friction.
    """
    limit = shortest_line(system)
    search.slides[0] = 1.0 if way == SLIDING else 0.0
    damping, last, worst, stalls = 0.0, inf, max(any_sought(system), 0), 0
    halved, waited = inf, 0
    found = find_residual(system, search.x, search)
    for _ in range(ITERATIONS):
        if not found or search.spent[0] > BUDGET * lines_of(system):
            return worst, False
        residual = largest(system, search.residual, search)
        halved, waited = (residual, 0) if residual < 0.5 * halved else (halved, waited + 1)
        if waited > PATIENCE and search.count[0] > 0.0:
            return worst, False
        stalls = stalls + 1 if residual > STALLED * last else 0
        worst, over = least_balanced(stalls > (1 if search.count[0] > 0.0 else 0), search)
        last = residual
        if over <= 1.0:
            return worst, True
        if not over < inf or not find_slopes(system, search):
            return worst, False
        if damping == 0.0:
            damping = residual / (FIRST_PART * limit)
        damping, found = find_move(system, damping, search)
        if not found:
            return worst, False
        most, overshot = longest_part(system, LONGEST[way] * limit, search), inf if way == SLOWLY else OVERSHOT
        if most == 0.0:  # a rope runs off
            return worst, False
        taken, found = go_along(system, most, overshot, search)
        damping *= SOFTER if taken == (1.0 if way == SLOWLY else most) else HARDER
    worst, over = least_balanced(True, search)
    return worst, over <= 1.0


@kernel
def search_everywhere(system, begins_as_given, search):
    """Search from all starts, one method after the other: the least balanced point, and whether it was found."""
    worst, found, has_points = 0, False, any_sought(system) != places.DRIVEN
    first = AS_GIVEN if begins_as_given or not has_points else GUESSED
    for way in range(WAYS if has_ground(parameters_of(system, 0)) else SLIDING):
        for start in range(first, GUESSED + len(PULLS) if has_points else AS_GIVEN + 1):
            if not found and set_off(system, start, search):
                worst, found = search_from(system, way, search)
    return worst, found


@kernel
def search_on(system, search):
    """Search with all methods from an equilibrium in other conditions: returns the results of `search_from`.

    It is in search.x [m], which is modified if another one is found.
    """
    copy(search.x, search.kept)
    worst, found = 0, False
    for way in range(WAYS):
        if not found:
            copy(search.kept, search.x)
            worst, found = search_from(system, way, search)
    if not found:
        copy(search.kept, search.x)
    return worst, found


@kernel
def search_with_held_ropes(system, begins_as_given, search):
    """Search from the equilibrium of the points with the given lengths: returns the results of `search_from`."""
    count = search.count[0]
    search.count[0] = 0.0
    worst, found = search_everywhere(system, begins_as_given, search)
    search.count[0] = count
    return search_on(system, search) if found else (worst, False)


@kernel
def put_conditions(system, density, friction):
    """Set the air density [kg/m3] and the friction coefficient of the ground [-] of all lines (modified)."""
    for k in range(lines_of(system)):
        parameters_of(system, k)[at.AIR_DENSITY] = density
        parameters_of(system, k)[at.GROUND_FRICTION] = friction


@kernel
def search_in_rising_air(system, density, friction, begins_as_given, search):
    """Search from the equilibrium in no air or thin air: returns the results of `search_from`.

    density, friction : required values of the air [kg/m3] and of the ground [-].
    """
    worst, found, begun = 0, False, False
    for k in range(len(AIR)):
        put_conditions(system, AIR[k] * density, friction)
        if begun:
            worst, found = search_on(system, search)
        elif AIR[k] <= DENSEST:
            worst, begun = search_everywhere(system, begins_as_given, search)
    return worst, found


@kernel
def search_by_continuation(system, begins_as_given, search):
    """Search from the equilibrium in thinner air, then from one without friction: returns the results of `search_from`.

    It may use as many Newton iterations again as all earlier searches.
    """
    search.spent[0] = 0.0
    parameters = parameters_of(system, 0)
    density, friction = parameters[at.AIR_DENSITY], parameters[at.GROUND_FRICTION]
    worst, found = search_in_rising_air(system, density, friction, begins_as_given, search)
    if not found:
        put_conditions(system, density, 0.0)
        worst, found = search_everywhere(system, begins_as_given, search)
        put_conditions(system, density, friction)
        if found:
            worst, found = search_on(system, search)
    return worst, found


@kernel
def check(system):
    """Start all lines at sought points or coordinates (modified), without inner nodes: OK, or the reason for refusal.

    Without any given point, NO_POINT_IS_GIVEN about ALL_LINES.
    """
    given = 0
    for k in range(lines_of(system)):
        if is_any_sought(system, k) or is_shared_out(system, k):
            system.plan[places.STATUS_LINE] = k
            status = start_state(system, k)
            if status != OK:
                return status
        given += not (is_sought(system, k, 0) and is_sought(system, k, 1))
    system.plan[places.STATUS_LINE] = places.ALL_LINES
    return OK if given > 0 else NO_POINT_IS_GIVEN


@kernel
def find(system, begins_as_given):
    """Write the equilibrium positions of the sought points into the inputs of their lines (modified); a status.

    begins_as_given : whether the search begins at the input positions, before the guesses.
    OK, NO_POINT_IS_GIVEN, NO_SHARES with coordinates, else NO_EQUILIBRIUM_OF_POINT with the number of the least balanced
    point, or the start status of a line; inputs change on OK only. Lengths (`coordinates.numbers_at_rest`) and states of the
    lines are modified.
    """
    search = search_of(system)
    begin(system, search)
    if any_sought(system) == places.DRIVEN and search.count[0] == 0.0:
        return OK
    status = check(system)
    if status != OK:
        return status
    find_outer(system, search)
    worst, found = search_everywhere(system, begins_as_given, search)
    if not found and search.count[0] > 0.0 and any_sought(system) != places.DRIVEN:
        worst, found = search_with_held_ropes(system, begins_as_given, search)
    if not found and has_ground(parameters_of(system, 0)):
        worst, found = search_by_continuation(system, begins_as_given, search)
    if not found:
        return NO_SHARES if search.count[0] > 0.0 else NO_EQUILIBRIUM_OF_POINT | worst << 8
    for k in range(lines_of(system)):
        for end in range(2):
            if is_sought(system, k, end):
                place = at.KITE_POSITION if end == 1 else at.GROUND_POSITION
                put_at(inputs_of(system, k), place, get(search.x, point_at(system, k, end)))
    return OK
