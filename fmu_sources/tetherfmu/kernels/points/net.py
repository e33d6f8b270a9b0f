"""Equations of the global unknowns (free points and rope coordinates); condensed lines are their substructures.

    point        M v' = load + sum of the forces of its lines' ends
    coordinate   m u' + c u + F sign(u) + W = sum over its line ends of weight E (T - mu u^2)

E is the sheave loss on the side where friction adds tension (`loss_at`), and 1 elsewhere; where E is 1 on both sides,
mu u^2 is equal on both and cancels. T at an end depends on accelerations through T(R), see `line/strand.py`. This file
assembles the contributions of the lines: blocks between their points, and a weighted column and row for each end with
coordinates. The matrix is stored by profile (`linear_algebra.profile`); the row of a held coordinate is a unit row.
"""

from math import atan2, exp, inf

from tetherfmu.runtime import layout as at

from ..arrays import clear, copy
from ..compilation import kernel, view
from ..equations import rope, segment
from ..equations.end_motion import velocity_at
from ..equations.free_points import free_points, is_at_point, load_at, point_at, points_of, rows_of
from ..equations.lines import conditions_of, lines_of, parameters_of, segments_of
from ..equations.properties import property_of
from ..equations.ropes import comes_from, has_sheaves
from ..line import drum_events, strand
from ..line.rodas4p import GAMMA_I
from ..line.strand_room import (
    BY_GAIN,
    CORNER,
    FACTOR,
    HELD_GAIN,
    LEFT,
    OF_TIME,
    PULL,
    SLOPE,
    TENSION,
    rope_in,
)
from ..linear_algebra import condensed, profile
from ..linear_algebra.both_ends import get_interleaved, get_node, get_two, put_interleaved
from ..linear_algebra.pairs import first, load_pair, number_at, pair, second
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_at, add_scaled, cross, dot, get, norm, put, scale, sub
from . import room
from .room import (
    coordinate_at,
    count_of,
    globals_of,
    has_rope,
    holder,
    holders_of,
    is_drum,
    is_free,
    is_held,
    line_of,
    numbers_of,
    strand_of,
    take_rates,
    unknowns_of,
    weight_of,
)

MOST_CORRECTIONS, BALANCED = 8, 1e-13  # Newton's method for u': iterations; relative residual at convergence
SLOWEST, STALLED = 0.5, 1e-9  # residual over the last one, and its size, above which the matrix is assembled again
TINY = 1e-200  # avoids 0/0

# --- terms of a coordinate itself


@kernel
def density_on(system, j):
    """Line density [kg/m] of the rope on sheave j, which moves: the last segment before it exists."""
    k = line_of(system, j)
    return property_of(conditions_of(system, k), segments_of(system, k) - 1, at.LINE_DENSITY)


@kernel
def moving_at(system, j):
    """mu u^2 [N] of the rope on sheave j at a stage."""
    return density_on(system, j) * coordinate_at(system, j)[room.SPEED_NOW] ** 2


@kernel
def losses_beside(system, j):
    """Effective E of the portions behind and ahead of sheave j."""
    k = line_of(system, j)
    return numbers_of(system, k)[FACTOR + 1], numbers_of(system, k + 1)[FACTOR]


@kernel
def own_force(system, j, time):
    """Force [N] on coordinate j at a stage at a time [s], without lines and inertia."""
    own = coordinate_at(system, j)
    if is_drum(system, j):
        counter = own[room.LOAD] + time * own[room.LOAD_RATE] + own[room.DAMPING] * own[room.SPEED_NOW]
        return -counter - own[room.FRICTION] * own[room.SIGN]
    if own[room.SIGN] == 0.0:
        return 0.0
    behind, ahead = losses_beside(system, j)
    return (behind - ahead) * moving_at(system, j)


@kernel
def take_damping(system, j):
    """BY_SPEED of coordinate j at the start of the step (modified)."""
    own = coordinate_at(system, j)
    own[room.BY_SPEED] = own[room.DAMPING]
    if not is_drum(system, j) and own[room.SIGN] != 0.0:
        behind, ahead = losses_beside(system, j)
        own[room.BY_SPEED] += 2.0 * (ahead - behind) * density_on(system, j) * own[room.SPEED_NOW]


@kernel
def mass_at(system, j, k):
    """Mass [kg] of a coordinate, including the rope of line k that moves past nodes at rest."""
    total = coordinate_at(system, j)[room.MASS]
    for end in range(2):
        weight = weight_of(system, j, k, end)
        if weight != 0.0:  # otherwise the line's slopes may be undefined
            total -= weight * weight * numbers_of(system, k)[BY_GAIN + 3 * end]
    return total


@kernel
def inertia_of(system, j):
    """Mass [kg] of a coordinate, including the moving rope of all lines."""
    mass = coordinate_at(system, j)[room.MASS]
    total = mass
    for k in range(lines_of(system)):
        total += mass_at(system, j, k) - mass
    return total


@kernel
def urges(system, j, behind, ahead, loss):
    """Forces [N] beyond friction that pull a coordinate forwards and backwards, and a tolerance for both.

    behind, ahead : opposing and pulling forces of a drum, or T_1 and T_2 of a sheave [N].  loss : E of the sheave.
    """
    own = coordinate_at(system, j)
    if is_drum(system, j):
        return drum_events.urges(ahead - behind, own[room.FRICTION], own[room.MAGNITUDE])
    margin = drum_events.OVERLOAD * (abs(behind) + abs(ahead))
    return ahead - behind - (loss - 1.0) * max(behind, 0.0), behind - ahead - (loss - 1.0) * max(ahead, 0.0), margin


# --- losses of sheaves


@kernel
def wrap_of(towards_1, towards_2):
    """Wrap angle [rad] from the two vectors that lead away from a sheave along its portions."""
    _, d_1 = segment.geometry(towards_1)
    _, d_2 = segment.geometry(towards_2)
    return atan2(norm(cross(d_1, d_2)), -dot(d_1, d_2))


@kernel
def loss_with(parameters, towards_1, towards_2):
    """E [-] of a sheave with these vectors; parameters : of the line before it."""
    grip = parameters[at.SHEAVE_FRICTION]
    grip = exp(grip * wrap_of(towards_1, towards_2)) if grip > 0.0 else 1.0
    return grip / parameters[at.SHEAVE_EFFICIENCY]


@kernel
def turn_of(towards, other):
    """Slope of the wrap angle by `towards` [1/m]; towards, other : vectors away from the sheave along the two portions."""
    length, d = segment.geometry(towards)
    _, e = segment.geometry(other)
    across = add_scaled(e, -dot(d, e), d)
    size = norm(across)
    return scale(1.0 / (length * size), across) if size > 1e-9 else ZERO_VECTOR


@view
def away_at_stage(system, k):
    """Vectors [m] from the sheave at the end of line k along both portions at a stage."""
    n, x_1, x_2 = segments_of(system, k), strand_of(system, k).w.stage_x, strand_of(system, k + 1).w.stage_x
    here = get_node(n, n, x_1)
    return sub(get_node(n, n - 1, x_1), here), sub(get_node(segments_of(system, k + 1), 1, x_2), here)


@kernel
def take_losses(system):
    """LOSS of all sheaves at a stage (modified)."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if not is_drum(system, j):
            own[room.LOSS] = 1.0
            if own[room.FRICTION] != 0.0:
                k = line_of(system, j)
                own[room.LOSS] = loss_with(parameters_of(system, k), *away_at_stage(system, k))


@kernel
def loss_at(system, k, end, tension):
    """E that multiplies a tension [N] at an end of line k: the sheave loss where taut rope runs on over the sheave."""
    if not has_sheaves(system):
        return 1.0
    j = int(numbers_of(system, k)[room.SHEAVE]) if end == 1 else -1
    sign = 1.0
    if end == 0 and comes_from(system, k):
        j, sign = int(numbers_of(system, k - 1)[room.SHEAVE]), -1.0
    if j < 0 or sign * coordinate_at(system, j)[room.SIGN] <= 0.0 or tension <= moving_at(system, j):
        return 1.0
    return coordinate_at(system, j)[room.LOSS]


@kernel
def stiffness_at(system, k, end):
    """EA [N] of the segment at an end of line k."""
    return property_of(conditions_of(system, k), (segments_of(system, k) - 1) * end, at.STIFFNESS)


@kernel
def take_tension(system, k, end, pull):
    """T [N] of an end of line k from R [N], and the factor E of T (modified)."""
    numbers = numbers_of(system, k)
    numbers[TENSION + end], numbers[FACTOR + end] = pull, 1.0
    if rope.feels_rope(parameters_of(system, k)):
        numbers[TENSION + end] = rope.tension_of(stiffness_at(system, k, end), pull)
        numbers[FACTOR + end] = loss_at(system, k, end, numbers[TENSION + end])


@kernel
def take_slope(system, k, end):
    """Slope of E T by R (modified), constant during a step."""
    numbers = numbers_of(system, k)
    numbers[SLOPE + end] = numbers[FACTOR + end]
    if rope.feels_rope(parameters_of(system, k)):
        numbers[SLOPE + end] *= rope.slope_of(stiffness_at(system, k, end), numbers[TENSION + end])


@kernel
def count_tensions(system):
    """Tensions of all ends with coordinates at a stage (modified), from known pulls."""
    take_losses(system)
    for k in range(lines_of(system)):
        for end in range(2):
            if is_held(system, k, end):
                take_tension(system, k, end, numbers_of(system, k)[PULL + end])


# --- contributions of a line


@kernel
def add_to_unknown(system, point, a, array):
    """Add a vector to the unknowns of a free point in an array (modified)."""
    for axis in range(3):
        array[3 * point + axis] += a[axis]


@kernel
def place_blocks(system, k, matrix):
    """Add the blocks that couple the free points of the condensed line k to the global matrix (modified)."""
    n, columns, whole = segments_of(system, k), room.columns_of(system, k), globals_of(system).matrix
    for end in range(2):
        for other in range(2):
            if is_at_point(system, k, end) and is_at_point(system, k, other):
                block = condensed.condensed_block(n, end, other, matrix, columns)
                profile.add_block(whole, 3 * point_at(system, k, end), 3 * point_at(system, k, other), block)


@kernel
def place_ropes(system, k, matrix, per):
    """Add the columns and rows of line k's ends with coordinates to the global matrix (modified).

    per : velocity per unit of the solved variable, scales rows.  The inner rows of the columns are already solved.
    """
    n, rows, ropes = segments_of(system, k), rows_of(system, k), room.room_in_step(system, k).ropes
    for end in range(2):
        if is_held(system, k, end):
            own = rope_in(n, ropes, end)
            for other in range(2):
                if is_at_point(system, k, other):
                    down = scale(-1.0, condensed.what_is_left(n, other, matrix, own.solved))
                    across = condensed.whole_row_at_end(rows, other, own.row, room.columns_of(system, k))
                    place_border(system, k, end, other, down, scale(per, across))
                if is_held(system, k, other):
                    yielded = per * inner_of_line(rows, own.row, rope_in(n, ropes, other).solved)
                    place_corner(system, k, end, other, numbers_of(system, k)[CORNER + 2 * end + other] + yielded)


@kernel
def place_border(system, k, end, other, down, across):
    """Add the column and row of an end of line k with coordinates, at its free point `other`, to the matrix (modified)."""
    whole, points, slope = globals_of(system).matrix, 3 * free_points(system), numbers_of(system, k)[SLOPE + end]
    point = 3 * point_at(system, k, other)
    for i in range(holders_of(system, k, end)):
        j, weight = holder(system, k, end, i)
        for axis in range(3):
            profile.add_entry(whole, point + axis, points + j, weight * down[axis])
            profile.add_entry(whole, points + j, point + axis, weight * slope * across[axis])


@kernel
def place_corner(system, k, end, other, slope):
    """Add to the matrix (modified) the effect of rope that enters over `other` (either end) on T of an end of line k."""
    whole, points = globals_of(system).matrix, 3 * free_points(system)
    for i in range(holders_of(system, k, end)):
        j, of_row = holder(system, k, end, i)
        for place in range(holders_of(system, k, other)):
            o, of_column = holder(system, k, other, place)
            entry = of_row * numbers_of(system, k)[SLOPE + end] * of_column * slope
            profile.add_entry(whole, points + j, points + o, -entry)


@kernel
def inner_of_line(rows, a, b):
    """Sum of a . b over the inner rows of two flat arrays, four numbers at a time."""
    total, other, begin, end = pair(0.0, 0.0), pair(0.0, 0.0), 3 * rows.first, 3 * rows.last + 3
    whole = begin + (end - begin) // 4 * 4 if end > begin else begin
    for i in range(begin, whole, 4):
        total = total + load_pair(a, i) * load_pair(b, i)
        other = other + load_pair(a, i + 2) * load_pair(b, i + 2)
    total = total + other
    left = first(total) + second(total)
    for i in range(whole, end):
        left += a[i] * b[i]
    return left


@kernel
def clear_matrix(system):
    """Set the matrix of the global unknowns to 0 (modified)."""
    profile.clear(globals_of(system).matrix, unknowns_of(system))


@kernel
def begin_matrix(system, d):
    """Matrix of the global unknowns in a Rosenbrock step, without lines (modified)."""
    clear_matrix(system)
    for j in range(count_of(system)):
        own, i = coordinate_at(system, j), 3 * free_points(system) + j
        profile.add_entry(globals_of(system).matrix, i, i, own[room.MASS] / d + own[room.BY_SPEED])


@kernel
def hold(system):
    """Replace the rows of held coordinates by unit rows (modified)."""
    for j in range(count_of(system)):
        if not is_free(system, j):
            profile.hold_row(globals_of(system).matrix, unknowns_of(system), 3 * free_points(system) + j)


@kernel
def factorize(system):
    """Factorize the matrix of the global unknowns (modified); False if it is singular."""
    return profile.factorize(globals_of(system).matrix, unknowns_of(system))


@kernel
def solve(system):
    """Solution of all global unknowns (modified) from the right-hand side; 0 for held coordinates."""
    whole = globals_of(system)
    for j in range(count_of(system)):
        if not is_free(system, j):
            whole.right[3 * free_points(system) + j] = 0.0
    profile.solve(whole.matrix, unknowns_of(system), whole.right, whole.solution)


# --- accelerations


@kernel
def sum_masses(system, at_stage):
    """Masses of the free points [kg] from their line ends (modified), at a stage or else at the start of the step."""
    points = points_of(system)
    clear(points.mass)
    for k in range(lines_of(system)):
        w = strand_of(system, k).w
        for end in range(2):
            if is_at_point(system, k, end):
                node = segments_of(system, k) * end
                points.mass[point_at(system, k, end)] += w.stage_mass[node] if at_stage else w.mass[node]


@kernel
def find_accelerations(system, time, is_rope):
    """Accelerations of all global unknowns and of the nodes of lines with ropes, and all tensions at a stage (modified).

    Requires forces with only driven ends accelerating, and slopes by gains: `begin` of a step or `evaluate` at a state.
    is_rope : whether any line has ropes.
    """
    for k in range(lines_of(system)):
        if has_rope(system, k):
            take_inner_response(strand_of(system, k), rows_of(system, k))
    if is_rope:
        take_losses(system)
    begin_accelerations(system, time)
    if is_rope:
        correct_accelerations(system, time)
    for k in range(lines_of(system)):
        if has_rope(system, k):
            take_rates(system, k, time)
            finish_accelerations(system, k)


@kernel
def take_inner_response(own, rows):
    """Add the response of the free inner nodes of a line to its PULL and CORNER (modified), from both ends at once."""
    n, w, numbers, ends = own.n, own.w, own.numbers, (rope_in(own.n, own.ropes, 0), rope_in(own.n, own.ropes, 1))
    a, b, nothing = ends[0].by_gain, ends[1].by_gain, pair(0.0, 0.0)
    pull_a, pull_b, of_aa, of_ab, of_bb = nothing, nothing, nothing, nothing, nothing
    for i in range(n // 2 + 1):
        share = 1.0 / number_at(w.stage_mass, 0, (i, n - i))
        if i == 0:
            share = share * pair(1.0 if rows.first == 0 else 0.0, 1.0 if rows.last == n else 0.0)
        elif 2 * i == n:
            share = 0.5 * share
        col_a, col_b, force = get_two(a, i, n - i), get_two(b, i, n - i), get_interleaved(w.force, i)
        pull_a, pull_b = pull_a + share * dot(col_a, force), pull_b + share * dot(col_b, force)
        of_aa, of_ab = of_aa + share * dot(col_a, col_a), of_ab + share * dot(col_a, col_b)
        of_bb = of_bb + share * dot(col_b, col_b)
    numbers[PULL] += first(pull_a) + second(pull_a)
    numbers[PULL + 1] += first(pull_b) + second(pull_b)
    numbers[CORNER] = numbers[BY_GAIN] + first(of_aa) + second(of_aa)
    numbers[CORNER + 1] = numbers[CORNER + 2] = numbers[BY_GAIN + 1] + first(of_ab) + second(of_ab)
    numbers[CORNER + 3] = numbers[BY_GAIN + 3] + first(of_bb) + second(of_bb)


@kernel
def begin_accelerations(system, time):
    """Initial accelerations of all global unknowns (modified): points without coordinates, coordinates unchanged."""
    whole, points = globals_of(system), points_of(system)
    for point in range(free_points(system)):
        load = load_at(system, point, time)
        for axis in range(3):
            whole.right[3 * point + axis] = load[axis]
    add_forces_at_points(system, whole.right)
    for point in range(free_points(system)):
        for axis in range(3 * point, 3 * point + 3):
            whole.accelerations[axis] = whole.right[axis] / points.mass[point]
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.GAIN_NOW] = own[room.ACCELERATION] if is_free(system, j) else 0.0


@kernel
def add_forces_at_points(system, array):
    """Add the line forces on free points at a stage, without accelerating coordinates, to an array (modified)."""
    for k in range(lines_of(system)):
        n = segments_of(system, k)
        for end in range(2):
            if is_at_point(system, k, end):
                add_to_unknown(system, point_at(system, k, end), get_node(n, n * end, strand_of(system, k).w.force), array)


@kernel
def acceleration_of_point(system, point):
    """Computed acceleration of a free point [m/s2]."""
    return get(globals_of(system).accelerations, point)


@kernel
def correct_accelerations(system, time):
    """Newton's method for the accelerations of all global unknowns (modified).

    Its matrix is assembled once, and again if the residual does not fall: dT/dR changes where dampers pull with EA or more.
    """
    whole, points, last = globals_of(system), 3 * free_points(system), inf
    for correction in range(MOST_CORRECTIONS):
        left = take_residuals(system, time)
        if left <= BALANCED:
            break
        if correction == 0 or left > max(SLOWEST * last, STALLED):
            place_masses(system)
            if not factorize(system):
                break
        last = left
        solve(system)
        for i in range(points):
            whole.accelerations[i] += whole.solution[i]
        for j in range(count_of(system)):
            coordinate_at(system, j)[room.GAIN_NOW] += whole.solution[points + j]


@kernel
def take_residuals(system, time):
    """Residuals of all unknowns at the present accelerations as right-hand side, and the tensions (all modified).

    Returns the largest residual relative to the forces at its unknown.
    """
    whole, points, masses = globals_of(system), 3 * free_points(system), points_of(system).mass
    clear(whole.right)
    for point in range(free_points(system)):
        load = load_at(system, point, time)
        for axis in range(3):
            i = 3 * point + axis
            whole.right[i] = load[axis] - masses[point] * whole.accelerations[i]
    if points > 0:
        add_forces_at_points(system, whole.right)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.PULLED] = 0.0
        own[room.MAGNITUDE] = TINY
    for k in range(lines_of(system)):
        if has_rope(system, k):
            pull_with_accelerations(system, k)
    largest, magnitude = 0.0, TINY
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        against = own_force(system, j, time)
        own[room.AGAINST] = -against - (own[room.FRICTION] * own[room.SIGN] if is_drum(system, j) else 0.0)
        if own[room.IS_MASSLESS] == 0.0:
            whole.right[points + j] += own[room.PULLED] + against - own[room.MASS] * own[room.GAIN_NOW]
        if is_drum(system, j):
            motor = abs(own[room.LOAD] + time * own[room.LOAD_RATE])
            own[room.MAGNITUDE] += motor + own[room.FRICTION]
        magnitude = max(magnitude, own[room.MAGNITUDE])
        if is_free(system, j):
            largest = max(largest, abs(whole.right[points + j]) / own[room.MAGNITUDE])
    for i in range(points):
        largest = max(largest, abs(whole.right[i]) / magnitude)
    return largest


@kernel
def pull_with_accelerations(system, k):
    """Add the end tensions of line k at the present accelerations to its coordinates, and their reaction to its points.

    All modified.
    """
    own, n, right = strand_of(system, k), segments_of(system, k), globals_of(system).right
    for end in range(2):
        own.numbers[HELD_GAIN + end] = room.let_in(system, k, end, room.GAIN_NOW)
    for end in range(2):
        if is_held(system, k, end):
            pull, by_gain = own.numbers[PULL + end], rope_in(n, own.ropes, end).by_gain
            pull += own.numbers[CORNER + 2 * end] * own.numbers[HELD_GAIN]
            pull += own.numbers[CORNER + 2 * end + 1] * own.numbers[HELD_GAIN + 1]
            for other in range(2):
                if is_at_point(system, k, other):
                    col, point = get(by_gain, n * other), point_at(system, k, other)
                    pull += dot(col, acceleration_of_point(system, point))
                    add_to_unknown(system, point, scale(own.numbers[HELD_GAIN + end], col), right)
            take_tension(system, k, end, pull)
            take_slope(system, k, end)
            for i in range(holders_of(system, k, end)):
                j, weight = holder(system, k, end, i)
                coordinate_at(system, j)[room.PULLED] += weight * own.numbers[FACTOR + end] * own.numbers[TENSION + end]
                coordinate_at(system, j)[room.MAGNITUDE] += abs(weight * own.numbers[TENSION + end])


@kernel
def place_masses(system):
    """Matrix of all accelerations (modified); held or massless coordinates do not accelerate."""
    clear_matrix(system)
    whole, points = globals_of(system).matrix, 3 * free_points(system)
    for i in range(points):
        profile.add_entry(whole, i, i, points_of(system).mass[i // 3])
    for j in range(count_of(system)):
        profile.add_entry(whole, points + j, points + j, coordinate_at(system, j)[room.MASS])
    for k in range(lines_of(system)):
        n, ropes = segments_of(system, k), room.room_in_step(system, k).ropes
        for end in range(2):
            if is_held(system, k, end):
                for other in range(2):
                    if is_at_point(system, k, other):
                        col = scale(-1.0, get(rope_in(n, ropes, end).by_gain, n * other))
                        place_border(system, k, end, other, col, col)
                    if is_held(system, k, other):
                        place_corner(system, k, end, other, numbers_of(system, k)[CORNER + 2 * end + other])
    for j in range(count_of(system)):
        if not is_free(system, j) or coordinate_at(system, j)[room.IS_MASSLESS] != 0.0:
            profile.hold_row(whole, unknowns_of(system), points + j)


@kernel
def finish_accelerations(system, k):
    """Accelerations of the nodes of line k, and forces including the accelerating coordinates (modified)."""
    own, n = strand_of(system, k), segments_of(system, k)
    a, b = rope_in(n, own.ropes, 0).by_gain, rope_in(n, own.ropes, 1).by_gain
    for i in range(n // 2 + 1):
        force = add_scaled(get_interleaved(own.w.force, i), own.numbers[HELD_GAIN], get_two(a, i, n - i))
        force = add_scaled(force, own.numbers[HELD_GAIN + 1], get_two(b, i, n - i))
        put_interleaved(own.w.force, i, force)
        put_interleaved(own.z, i, scale(1.0 / number_at(own.w.stage_mass, 0, (i, n - i)), force))
    for end in range(2):
        if strand.is_driven(own.conditions, end):
            for axis in range(3):
                own.z[2 * axis + end] = own.stage_z[2 * axis + end]
    put_accelerations_of_points(system, k)
    copy(own.z, own.stage_z)


@kernel
def put_accelerations_of_points(system, k):
    """Copy the accelerations of the free points of line k into its nodes (modified)."""
    z = strand_of(system, k).z
    for end in range(2):
        if is_at_point(system, k, end):
            found = acceleration_of_point(system, point_at(system, k, end))
            for axis in range(3):
                z[2 * axis + end] = found[axis]


# --- a stage


@kernel
def add_wrap(system, j, time, d):
    """Add the dependence of friction on the wrap angle at sheave j to the rows of both portions (modified)."""
    k, sign = line_of(system, j), coordinate_at(system, j)[room.SIGN]
    grip = parameters_of(system, k)[at.SHEAVE_FRICTION]
    end, line = (1, k) if sign > 0.0 else (0, k + 1)  # the portion with the higher tension
    loss, tension = numbers_of(system, line)[FACTOR + end], numbers_of(system, line)[TENSION + end]
    if grip == 0.0 or sign == 0.0 or loss == 1.0:
        return
    (to_1, to_2), n = away_at_stage(system, k), segments_of(system, k)
    factor = -sign * grip * loss * (tension - moving_at(system, j))
    by_1, by_2 = scale(factor, turn_of(to_1, to_2)), scale(factor, turn_of(to_2, to_1))
    behind, ahead = -numbers_of(system, k)[SLOPE + 1], numbers_of(system, k + 1)[SLOPE]
    add_to_row(system, k, 1, n - 1, scale(1.0 / behind, by_1), time, d)
    add_to_row(system, k, 1, n, scale(-1.0 / behind, add(by_1, by_2)), time, d)
    add_to_row(system, k + 1, 0, 1, scale(1.0 / ahead, by_2), time, d)


@kernel
def add_to_row(system, k, end, i, slope, time, d):
    """Add a slope of R at an end of line k by the position of node i [N/m] to its row, or for a driven node to OF_TIME."""
    own, conditions = strand_of(system, k), conditions_of(system, k)
    if conditions.first <= i <= conditions.last:
        add_at(rope_in(own.n, own.ropes, end).row, i, scale(d, slope))
    else:
        curve = conditions.kite if i > 0 else conditions.ground
        own.numbers[OF_TIME + end] += dot(slope, velocity_at(curve, time))


@kernel
def begin_right(system, stage, time, h):
    """Right-hand side of the global unknowns without their lines (modified), at the time [s] of a stage."""
    whole, points, rates = globals_of(system), free_points(system), points_of(system).load_rate
    for point in range(points):
        load = add_scaled(load_at(system, point, time), GAMMA_I[stage] * h, get(rates, point))
        for axis in range(3):
            whole.right[3 * point + axis] = load[axis]
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        total = own_force(system, j, time) - GAMMA_I[stage] * h * own[room.LOAD_RATE]
        total += own[room.MASS] * own[room.ADDED_UP] / h + own[room.BY_SPEED] * own[room.OF_REST]
        whole.right[3 * points + j] = total


@kernel
def place_right(system, k, matrix, q, per):
    """Add the condensed right-hand side of line k (modified); its inner nodes are solved in q; per : see `place_ropes`."""
    n, right, points = segments_of(system, k), globals_of(system).right, 3 * free_points(system)
    numbers, ropes = numbers_of(system, k), room.room_in_step(system, k).ropes
    for end in range(2):
        if is_at_point(system, k, end):
            add_to_unknown(system, point_at(system, k, end), condensed.what_is_left(n, end, matrix, q), right)
        if is_held(system, k, end):
            known = numbers[LEFT + end] + per * inner_of_line(rows_of(system, k), rope_in(n, ropes, end).row, q)
            total = numbers[FACTOR + end] * numbers[TENSION + end] + numbers[SLOPE + end] * known
            for i in range(holders_of(system, k, end)):
                j, weight = holder(system, k, end, i)
                right[points + j] += weight * total


@kernel
def take_solution(system, k, q):
    """Solution in all nodes of line k (modified) from the global solution."""
    n, rows, solution, conditions = (
        segments_of(system, k),
        rows_of(system, k),
        globals_of(system).solution,
        conditions_of(system, k),
    )
    for end in range(2):
        if is_at_point(system, k, end):
            put(q, n * end, get(solution, point_at(system, k, end)))
        elif strand.is_driven(conditions, end):
            put(q, n * end, ZERO_VECTOR)
    condensed.expand(rows, room.columns_of(system, k), q)
    for end in range(2):
        if is_held(system, k, end):
            come_in, solved = solution_of_end(system, k, end), rope_in(n, room.room_in_step(system, k).ropes, end).solved
            for i in range(3 * rows.first, 3 * rows.last + 3):
                q[i] += come_in * solved[i]


@kernel
def solution_of_end(system, k, end):
    """Rope that the solution moves into line k over an end."""
    solution, points, total = globals_of(system).solution, 3 * free_points(system), 0.0
    for i in range(holders_of(system, k, end)):
        j, weight = holder(system, k, end, i)
        total += weight * solution[points + j]
    return total
