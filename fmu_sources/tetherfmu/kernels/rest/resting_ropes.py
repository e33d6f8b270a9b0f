"""Rope coordinates at rest: unknowns of the search beside the free points (`resting_points.py`).

    R_j = sum over line ends of w_j T  [- W - c u - F sign(u)] = 0,      L_k = L_k0 + sum over coordinates of g_jk q_j

Sheave: w = -1 at the end of the line before it, 1 at the start of the one behind. Drum with a sought start: w = ratio at the
starts of its lines, over its largest ratio; the force in brackets is its own. g is the sum of w over both ends. With F_e
the force of a line on its end e, T and F are slopes of one potential; the slopes by L are finite differences:

    -dR_i/dq_j = - sum of w_i g_j dT/dL,   -dF_e/dq_j = -g_j dF_e/dL = -dR_j/dx_e
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..arrays import positions_and_velocities
from ..compilation import PARTS, kernel
from ..equations.drum import HELD, INWARDS, OUTWARDS, SAME_PLACE, balance, drum_of
from ..equations.free_points import free_points, point_at
from ..equations.lines import inputs_of, lines_of, parameters_of, segments_of, state_of
from ..equations.properties import chain_without_flow, half_density, rest_length
from ..equations.rope import tension_at_winch, tensions_of_rope
from ..equations.ropes import first_of, goes_on, is_portion
from ..linear_algebra.profile import add_entry
from ..linear_algebra.vectors import norm, sub, vector_at
from ..points.coordinates import (
    GIVEN_AT_REST,
    LENGTH_AT_REST,
    TENSION_AT_REST,
    has_sought_drum,
    is_alone,
    is_shared_out,
    is_sought_by_drums,
    largest_ratio,
    numbers_at_rest,
    ratio_of,
    shortest_of,
)
from ..points.room import globals_of
from .resting_line import force_at, is_any_sought, is_sought, rest_line, shape_line

DIFFERENCE = 1e-7  # of the length of a line, for slopes
LONGEST_STEP = 0.25  # of a line
RUN_OFF = 1e-6  # of a line: room left for its change below which its rope runs off
LONGEST = 1e5  # [m] of a line, as `initial_length` may be
RIGID = 1e30  # [N/m]: a stop that holds a drum


@kernel
def is_balanced(system, k):
    """Whether line k continues over a sheave that needs equal tensions: not if all portions are given."""
    j, count = first_of(system, k), 0
    count += is_sought_by_drums(system, j)
    while goes_on(system, j):
        count += parameters_of(system, j)[at.GIVEN_PORTION] == 0.0
        j += 1
    count += parameters_of(system, j)[at.GIVEN_PORTION] == 0.0
    return PARTS and goes_on(system, k) and count > 0


@kernel
def take_coordinates(system, search):
    """Sheaves that need equal tensions and sought drums into `search.carrier` (modified); returns their number.

    Sheave: the number of the line before it. Drum: -1 - the number of the line that carries it.
    """
    count = 0
    for k in range(lines_of(system)):
        if is_balanced(system, k):
            search.carrier[count] = k
            count += 1
    for k in range(lines_of(system)):
        if is_shared_out(system, k):
            numbers_at_rest(system, k)[GIVEN_AT_REST] = numbers_at_rest(system, k)[LENGTH_AT_REST]
        if has_sought_drum(system, k):
            search.carrier[count] = -1.0 - k
            count += 1
    return count


@kernel
def part_of_drum(system, k, carrier):
    """Rope of line k per metre on the line with the largest ratio of a drum [-]."""
    return ratio_of(system, k, carrier) / largest_ratio(system, carrier)


@kernel
def weight_at_rest(system, carrier, k, end):
    """Rope that the coordinate with this `search.carrier` moves into line k over an end, per metre [-]."""
    line = int(carrier if carrier >= 0.0 else -1.0 - carrier)
    if carrier < 0.0:
        return part_of_drum(system, k, line) if end == 0 else 0.0
    return (1.0 if k == line + 1 else 0.0) if end == 0 else (-1.0 if k == line else 0.0)


@kernel
def growth_at_rest(system, carrier, k):
    """Change of the length of line k per metre of a coordinate [-]."""
    return weight_at_rest(system, carrier, k, 0) + weight_at_rest(system, carrier, k, 1)


@kernel
def change_of(system, k, q, search):
    """Change [m] of the length of line k by coordinates q [m], the numbers behind those of the free points."""
    change = 0.0
    for j in range(int(search.count[0])):
        change += growth_at_rest(system, search.carrier[j], k) * q[3 * free_points(system) + j]
    return change


@kernel
def put_lengths(system, x, search):
    """Lengths of all lines with coordinates x (modified)."""
    for k in range(lines_of(system)):
        if is_shared_out(system, k):
            numbers = numbers_at_rest(system, k)
            numbers[LENGTH_AT_REST] = numbers[GIVEN_AT_REST] + change_of(system, k, x, search)


@kernel
def room_to_stop(system, k, way):
    """Rope [m] that the drum on line k can pay out (way > 0) or reel in (< 0) until its stop.

    inf without one: drums stop at the lengths of whole ropes over sheaves.
    """
    if not (PARTS and goes_on(system, k) and is_alone(system, k)):
        return inf
    length, parameters, j = numbers_at_rest(system, k)[LENGTH_AT_REST], parameters_of(system, k), k
    while goes_on(system, j):
        j += 1
        length += numbers_at_rest(system, j)[LENGTH_AT_REST]
    room = parameters[at.LONGEST_LENGTH] - length if way > 0.0 else length - parameters[at.SHORTEST_LENGTH]
    return room if room > SAME_PLACE * length else 0.0


@kernel
def hold_stopped(system, search):
    """Make the matrix (modified) hold drums whose R is 0, as a stop holds them; after `find_imbalances`."""
    points = 3 * free_points(system)
    for j in range(int(search.count[0])):
        if PARTS and search.carrier[j] < 0.0 and search.residual[points + j] == 0.0:
            add_entry(globals_of(system).matrix, points + j, points + j, RIGID)


@kernel
def part_within(system, search):
    """Fraction of a step at which no line changes too much, or becomes too short, and no drum passes its stop.

    0 if a line has no room left. A drum at its stop does not move beyond it (search.move modified).
    """
    part = 1.0
    for j in range(int(search.count[0])):
        if search.carrier[j] < 0.0:
            move = search.move[3 * free_points(system) + j]
            room = room_to_stop(system, int(-1.0 - search.carrier[j]), move)
            if room == 0.0:
                search.move[3 * free_points(system) + j] = 0.0
            elif abs(move) * part > room:
                part = room / abs(move)
    for k in range(lines_of(system)):
        if is_shared_out(system, k):
            change, length = change_of(system, k, search.move, search), numbers_at_rest(system, k)[LENGTH_AT_REST]
            room = min(LONGEST_STEP * length, 0.5 * (length - shortest_of(system, k)))
            if change < 0.0 and -change * part > room:
                part = room / -change if room > RUN_OFF * length else 0.0
            elif change * part > min(LONGEST_STEP * length, LONGEST - length):
                part = min(LONGEST_STEP * length, LONGEST - length) / change
    return part


# --- tensions


@kernel
def end_tensions_at_rest(n, parameters, state):
    """Tension at both ends of a portion in equilibrium in its state [N]."""
    chain, held = chain_without_flow(n, parameters, state), vector_at(state, at.GROUND_TENSION_VECTOR)
    if norm(held) > 0.0:
        half = half_density(chain, 0) * rest_length(chain, 0) * chain.gravity
        last = half_density(chain, n - 1) * rest_length(chain, n - 1) * chain.gravity
        at_end = vector_at(state, at.KITE_TENSION_VECTOR)
        return norm(held) - half * held[2] / norm(held), norm(at_end) + last * at_end[2] / norm(at_end)
    x, v = positions_and_velocities(n, state)
    return tensions_of_rope(chain, x, v, 0.0)


@kernel
def take_tensions_at_rest(system, k):
    """Store the end tensions of portion k at rest in its state (modified)."""
    state = state_of(system, k)
    found = end_tensions_at_rest(segments_of(system, k), parameters_of(system, k), state)
    state[at.TENSION_FROM], state[at.TENSION_TO] = found


@kernel
def settle(system, k, x):
    """Bring line k to rest with the free points at x [m]; the tensions of rope coordinates into its numbers; a status.

    A line that runs over no sheave pulls on its drums in its `initial_shape`.
    """
    n, parameters, state, status = segments_of(system, k), parameters_of(system, k), state_of(system, k), OK
    tension = 0.0, 0.0
    if is_shared_out(system, k) and not is_portion(system, k):
        status = shape_line(system, k, parameters[at.INITIAL_SHAPE], x)
        tension = tension_at_winch(n, parameters, state), 0.0
    if status == OK and (is_any_sought(system, k) or is_portion(system, k)):
        status = rest_line(system, k, x)
        if is_portion(system, k):
            tension = end_tensions_at_rest(n, parameters, state)
    if is_shared_out(system, k):
        numbers_at_rest(system, k)[TENSION_AT_REST], numbers_at_rest(system, k)[TENSION_AT_REST + 1] = tension
    return status


@kernel
def own_force(system, k):
    """Force [N] of the drum that line k carries, at rest or with its initial speed, over its largest ratio."""
    inputs = inputs_of(system, k)
    speed, drum = inputs[at.REEL_OUT_SPEED], drum_of(parameters_of(system, k), inputs[at.WINCH_FORCE], 0.0)
    direction = HELD if speed == 0.0 else (OUTWARDS if speed > 0.0 else INWARDS)
    return balance(drum, direction, 0.0, speed, 0.0) / largest_ratio(system, k)


@kernel
def find_imbalances(system, search):
    """R of all coordinates, and the largest tension [N], into `search` (modified), with all lines at rest."""
    search.tension[0] = 0.0
    for k in range(lines_of(system)):
        for end in range(2):
            if is_shared_out(system, k):
                search.tension[0] = max(search.tension[0], abs(numbers_at_rest(system, k)[TENSION_AT_REST + end]))
    for j in range(int(search.count[0])):
        carrier = search.carrier[j]
        total = 0.0 if carrier >= 0.0 else own_force(system, int(-1.0 - carrier))
        for k in range(lines_of(system)):
            for end in range(2):
                weight = weight_at_rest(system, carrier, k, end)
                if weight != 0.0:
                    total += weight * numbers_at_rest(system, k)[TENSION_AT_REST + end]
        if carrier < 0.0 and room_to_stop(system, int(-1.0 - carrier), total) == 0.0:
            total = 0.0  # a stop holds the drum
        search.residual[3 * free_points(system) + j] = total


@kernel
def add_slopes_of_rope(system, k, x, search):
    """Add the slopes of the forces and tensions of line k by its length to the matrix (modified); False if it has none.

    After `settle`.
    """
    numbers, matrix, points = numbers_at_rest(system, k), globals_of(system).matrix, 3 * free_points(system)
    h, forces = DIFFERENCE * numbers[LENGTH_AT_REST], (force_at(system, k, 0), force_at(system, k, 1))
    tensions = numbers[TENSION_AT_REST], numbers[TENSION_AT_REST + 1]
    numbers[LENGTH_AT_REST] += h
    status = settle(system, k, x)
    numbers[LENGTH_AT_REST] -= h
    changed = force_at(system, k, 0), force_at(system, k, 1)
    for j in range(int(search.count[0])):
        growth = growth_at_rest(system, search.carrier[j], k) / h
        for end in range(2):
            if growth != 0.0 and is_sought(system, k, end):
                change = sub(changed[end], forces[end])
                for axis in range(3):
                    add_entry(matrix, 3 * point_at(system, k, end) + axis, points + j, -growth * change[axis])
                    add_entry(matrix, points + j, 3 * point_at(system, k, end) + axis, -growth * change[axis])
            for i in range(int(search.count[0])):
                change = numbers[TENSION_AT_REST + end] - tensions[end]
                slope = weight_at_rest(system, search.carrier[i], k, end) * growth * change
                if slope != 0.0:
                    add_entry(matrix, points + i, points + j, -slope)
    numbers[TENSION_AT_REST], numbers[TENSION_AT_REST + 1] = tensions
    return status == OK
