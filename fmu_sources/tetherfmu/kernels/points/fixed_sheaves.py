"""Coordinates in an iteration of a fixed step: the speeds of ropes and drums are found with the moves of the nodes.

    e_2 (T_2 - mu u^2) - e_1 (T_1 - mu u^2) = m (u - u0)/h,   psi = psi0 + h u,   all at the end of the step

with e_1 and e_2 as in `sheaves.py`. A drum (`running_drums.py`) has

    T_2 - T_1 - F sign(u) = m (u - u0)/h,   T_2 = sum of r T,   T_1 = W + c u,   held while |T_2 - T_1| <= F

`fixed_sheave_rows.py` has T_1, T_2 and the angle of wrap, linear in the changes of all
speeds. A sheave runs forwards or backwards, is held while

    T_2 <= E T_1,   T_1 <= E T_2,

or runs at a limit of its speed: where a portion gets as short as it may be. Which of these it is shows only in the solution
of the small system of those that run: it is sought as it runs now, then as it was found, until all of them are found as they
were sought. If they are not after `MOST_TRIES`, the speeds that were found last are taken: no convergence.
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations.lines import lines_of, parameters_of, segments_of, stiffness_of
from ..equations.rope_at_sheave import IN
from ..line.drum_events import OVERLOAD
from ..linear_algebra import small_matrix
from . import sheave_room as at_sheave
from .coordinates import (
    coordinate_at,
    count_of,
    first_portion,
    growth_of,
    is_drum,
    last_portion,
    line_of,
    number_of,
    own_numbers,
    weight_of,
)
from .fixed_sheave_rows import add_all_columns, change_in, take_all_slopes, take_sheaves
from .running_drums import friction_of_drum, has_friction
from .sheave_pulls import density_of
from .sheave_room import has_run, numbers_at, shared_of, slopes_of
from .sheave_stages import is_out_of_limits, place_portions, put_speed, take_limits
from .sheaves import inertia_of, mass_at
from .system_fixed_drums import follow, take_masses
from .system_room import GOAL, numbers_of

AT_LOWEST, BACKWARDS, HELD, FORWARDS, AT_HIGHEST = -2.0, -1.0, 0.0, 1.0, 2.0  # ways
CLOSE = 1e-6  # of a tension, whose change an iteration may leave as its square
MOST_TRIES, ALL_AT_ONCE = 16, 4  # at ways in an iteration; after so many only one sheave is sought in another way at a time
LEAST_PIVOT = 1e-3  # of what the slope of the equation of a sheave is where the ropes do not yield

# --- the equation of a coordinate


@kernel
def density_at(system, c):
    """mu [kg/m] of the rope over a sheave, 0 of a drum, whose lines have it in their pulls."""
    return 0.0 if is_drum(system, c) else density_of(system, c)


@kernel
def least_slope(system, c, h):
    """What the slope of the equation of a coordinate is at least [N s/m], see LEAST_PIVOT."""
    return LEAST_PIVOT * inertia_of(system, c) / h


@kernel
def losses(system, c, way):
    """e_1 and e_2 of a coordinate on a way, and the slope of its equation by the angle of wrap [N]."""
    if is_drum(system, c):
        return 1.0, 1.0, 0.0
    k = line_of(system, c)
    numbers, grip = numbers_at(system, k), parameters_of(system, k)[at.SHEAVE_FRICTION]
    loss, moving = numbers[at_sheave.LOSS], density_of(system, k) * numbers[at_sheave.STAGE_SPEED] ** 2
    behind, ahead = numbers[at_sheave.TENSION_BEHIND] - moving, numbers[at_sheave.TENSION_AHEAD] - moving
    if way > HELD and behind > 0.0:
        return loss, 1.0, -grip * loss * behind
    if way < HELD and ahead > 0.0:
        return 1.0, loss, grip * loss * ahead
    return 1.0, 1.0, 0.0


@kernel
def changed(system, c, which, slopes, changes):
    """One of MOVED_BEHIND, ... of a coordinate with the changes of all speeds [m/s]."""
    count, total = count_of(system), own_numbers(system, c)[which]
    row = count * number_of(system, c)
    for j in range(count):
        total += slopes[row + j] * changes[j]
    return total


@kernel
def changes_at(system, c, changes):
    """Changes of T_1 and T_2 [N] and of the angle of wrap [rad] with the changes of all speeds [m/s]."""
    by_1, by_2, by_wrap = slopes_of(system)
    return (
        changed(system, c, at_sheave.MOVED_BEHIND, by_1, changes),
        changed(system, c, at_sheave.MOVED_AHEAD, by_2, changes),
        changed(system, c, at_sheave.MOVED_WRAP, by_wrap, changes),
    )


@kernel
def unbalanced(system, c, h, way, change, of_tensions):
    """Force [N] that the equation of a coordinate leaves on a way, see `changes_at`.

    change : of its speed [m/s].
    """
    numbers, (of_1, of_2, of_wrap) = own_numbers(system, c), of_tensions
    e_1, e_2, by_wrap = losses(system, c, way)
    speed, density = numbers[at_sheave.STAGE_SPEED], density_at(system, c)
    moving = density * speed * (speed + 2.0 * change)
    force = e_2 * (numbers[at_sheave.TENSION_AHEAD] + of_2 - moving)
    force -= e_1 * (numbers[at_sheave.TENSION_BEHIND] + of_1 - moving)
    if is_drum(system, c):
        force -= way * friction_of_drum(system, c)
    return force + by_wrap * of_wrap - mass_at(system, c) * (speed + change - numbers[at_sheave.SPEED]) / h


@kernel
def put_equation(system, c, h, matrix, right):
    """The equation of a coordinate, as it is sought (modified)."""
    numbers, count, j = own_numbers(system, c), count_of(system), number_of(system, c)
    way, row = numbers[at_sheave.WAY], count * j
    if abs(way) != FORWARDS:
        matrix[row + j] = 1.0
        right[j] = numbers[at_sheave.SOUGHT] - numbers[at_sheave.STAGE_SPEED]
        return
    (by_1, by_2, by_wrap), (e_1, e_2, of_wrap) = slopes_of(system), losses(system, c, way)
    for i in range(row, row + count):
        matrix[i] = e_1 * by_1[i] - e_2 * by_2[i] - of_wrap * by_wrap[i]
    own = matrix[row + j] + 2.0 * (e_2 - e_1) * density_at(system, c) * numbers[at_sheave.STAGE_SPEED]
    matrix[row + j] = max(own + mass_at(system, c) / h, least_slope(system, c, h))
    of_moves = numbers[at_sheave.MOVED_BEHIND], numbers[at_sheave.MOVED_AHEAD], numbers[at_sheave.MOVED_WRAP]
    right[j] = unbalanced(system, c, h, way, 0.0, of_moves)


# --- how they are found


@kernel
def seek(system, h):
    """Let all sheaves (modified) be sought as they run now, in a step of h [s]."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        take_limits(system, c, h)
        numbers = own_numbers(system, c)
        speed, is_open = numbers[at_sheave.STAGE_SPEED], numbers[at_sheave.LOWEST] < numbers[at_sheave.HIGHEST]
        if not is_open or (speed == 0.0 and has_friction(system, c)):
            numbers[at_sheave.WAY], numbers[at_sheave.SOUGHT] = HELD, 0.0
        else:
            numbers[at_sheave.WAY] = BACKWARDS if has_friction(system, c) and speed < 0.0 else FORWARDS


@kernel
def urges(system, c, behind, ahead):
    """Forces [N] with which these tensions pull a coordinate that is held forwards and backwards; a margin of these."""
    numbers = own_numbers(system, c)
    if is_drum(system, c):
        pull, friction = ahead - behind, friction_of_drum(system, c)
        return pull - friction, -pull - friction, OVERLOAD * numbers[at_sheave.BEHIND]
    loss, margin = numbers[at_sheave.LOSS] - 1.0, OVERLOAD * (abs(behind) + abs(ahead))
    return ahead - behind - loss * max(behind, 0.0), behind - ahead - loss * max(ahead, 0.0), margin


@kernel
def way_of_held(system, c, of_tensions):
    """Which way a coordinate that is held goes next with these changes of its tensions."""
    numbers, (of_1, of_2, _) = own_numbers(system, c), of_tensions
    behind, ahead = numbers[at_sheave.TENSION_BEHIND] + of_1, numbers[at_sheave.TENSION_AHEAD] + of_2
    forwards, backwards, margin = urges(system, c, behind, ahead)
    if numbers[at_sheave.HIGHEST] > 0.0 and forwards > margin:
        return FORWARDS
    if numbers[at_sheave.LOWEST] < 0.0 and backwards > margin:
        return BACKWARDS if has_friction(system, c) else FORWARDS
    return HELD


@kernel
def way_of_running(system, c, speed):
    """Which way a coordinate that runs goes next with the speed [m/s] that was found; SOUGHT (modified), if it is given."""
    numbers, way = own_numbers(system, c), own_numbers(system, c)[at_sheave.WAY]
    lowest, highest = numbers[at_sheave.LOWEST], numbers[at_sheave.HIGHEST]
    if has_friction(system, c):
        lowest, highest = (max(lowest, 0.0), highest) if way == FORWARDS else (lowest, min(highest, 0.0))
    if lowest < speed < highest:
        return way
    numbers[at_sheave.SOUGHT] = lowest if speed <= lowest else highest
    if numbers[at_sheave.SOUGHT] == 0.0:
        return HELD
    return AT_LOWEST if speed <= lowest else AT_HIGHEST


@kernel
def next_way(system, c, h, changes):
    """Which way a coordinate goes next with the changes of all speeds [m/s]; SOUGHT (modified)."""
    numbers, change, of_tensions = own_numbers(system, c), changes[number_of(system, c)], changes_at(system, c, changes)
    way = numbers[at_sheave.WAY]
    if abs(way) == FORWARDS:
        return way_of_running(system, c, numbers[at_sheave.STAGE_SPEED] + change)
    if way == HELD:
        return way_of_held(system, c, of_tensions)
    sign = -1.0 if has_friction(system, c) and numbers[at_sheave.SOUGHT] < 0.0 else 1.0
    left = unbalanced(system, c, h, sign, change, of_tensions)
    return way if (left >= 0.0 if way == AT_HIGHEST else left <= 0.0) else sign


@kernel
def seek_next(system, h, changes, one_at_a_time):
    """Let those (modified) that are found as they were not sought be sought in another way, or one of them; how many."""
    others = 0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if not (one_at_a_time and others > 0):
            numbers = own_numbers(system, c)
            way = next_way(system, c, h, changes)
            others += way != numbers[at_sheave.WAY]
            numbers[at_sheave.WAY] = way
            if way == HELD:
                numbers[at_sheave.SOUGHT] = 0.0
    return others


@kernel
def are_held(system):
    """Whether all sheaves rest, and are held with the moves of the lines alone."""
    others = 0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        numbers = own_numbers(system, c)
        of_moves = numbers[at_sheave.MOVED_BEHIND], numbers[at_sheave.MOVED_AHEAD], numbers[at_sheave.MOVED_WRAP]
        rests = numbers[at_sheave.WAY] == HELD and numbers[at_sheave.STAGE_SPEED] == 0.0
        others += not rests or way_of_held(system, c, of_moves) != HELD
    return others == 0


@kernel
def find_changes(system, h, changes):
    """Changes of the speeds of all sheaves [m/s] (modified) in a step of h [s]; whether all are found as they are sought.

    They are sought as `seek` says, and their slopes are known.
    """
    count, matrix = count_of(system), shared_of(system)[1]
    for number in range(MOST_TRIES):
        small_matrix.set_to_zero(count, matrix)
        for j in range(count):
            put_equation(system, coordinate_at(system, j), h, matrix, changes)
        if not small_matrix.solve(count, matrix, changes):
            for j in range(count):
                changes[j] = 0.0
            return False
        if seek_next(system, h, changes, number >= ALL_AT_ONCE) == 0:
            return True
    return False


@kernel
def is_small(change, tension, stiffness):
    """Whether what a change of a tension [N] leaves is less than a part CLOSE of it, or its square of EA [N]."""
    return change * change <= 2.0 * stiffness * CLOSE * (abs(tension) + CLOSE * stiffness)


@kernel
def is_close(system, c, of_tensions, h):
    """Whether the changes of all tensions at a coordinate are small, once all lines have their moves."""
    numbers, (of_1, of_2, _) = own_numbers(system, c), of_tensions
    if is_drum(system, c):
        others = 0
        for k in range(lines_of(system)):
            if weight_of(system, c, k, IN) != 0.0:
                change = change_in(system, k, h)
                tension = numbers_at(system, k)[at_sheave.TENSION_IN] + change
                others += not is_small(change, tension, stiffness_of(system, k))
        return others == 0
    behind = is_small(of_1, numbers[at_sheave.TENSION_BEHIND] + of_1, stiffness_of(system, c))
    return behind and is_small(of_2, numbers[at_sheave.TENSION_AHEAD] + of_2, stiffness_of(system, c + 1))


@kernel
def find_sheaves(system, step):
    """Let all ropes run with the speeds that are found in the iteration, and the lines move with them (all modified).

    The moves of all lines without changes of the speeds are known.
    """
    changes = shared_of(system)[2]
    take_sheaves(system, step)
    seek(system, step.h)
    if are_held(system):
        hold_speeds(system, 1.0)
        return
    take_all_slopes(system, step)
    are_found = find_changes(system, step.h, changes)
    for j in range(count_of(system)):
        numbers = own_numbers(system, coordinate_at(system, j))
        speed = numbers[at_sheave.STAGE_SPEED]
        if not are_found:
            onward = min(numbers[at_sheave.HIGHEST], max(numbers[at_sheave.LOWEST], speed + changes[j]))
            changes[j] = onward - speed
        numbers[at_sheave.CHANGE] = changes[j]
    add_all_columns(system)
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        numbers = own_numbers(system, c)
        close = abs(numbers[at_sheave.WAY]) != FORWARDS or is_close(system, c, changes_at(system, c, changes), step.h)
        numbers[at_sheave.IS_FOUND] = 1.0 if are_found and close else 0.0
    run(system, step)


@kernel
def run(system, step):
    """Let all ropes (modified) run with the speeds that were found; lengths, masses and the forces of rope follow."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        numbers = own_numbers(system, c)
        given, way = numbers[at_sheave.SOUGHT], numbers[at_sheave.WAY]
        speed = numbers[at_sheave.STAGE_SPEED] + numbers[at_sheave.CHANGE]
        is_given = numbers[at_sheave.IS_FOUND] == 1.0 and abs(way) != FORWARDS
        put_speed(system, c, step.h, given if is_given else speed)
    place_portions(system, step.time + step.h)
    for k in range(lines_of(system)):
        if has_run(system, k):
            follow(system, k, step)
    take_masses(system, step)


@kernel
def hold_speeds(system, are_found):
    """Let an iteration leave the speeds of all ropes as they are (modified); are_found : 1 if they are found so, else 0."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        own_numbers(system, c)[at_sheave.CHANGE], own_numbers(system, c)[at_sheave.IS_FOUND] = 0.0, are_found


@kernel
def has_changed(system):
    """Whether the last iteration has changed the speed of any rope."""
    count = 0
    for j in range(count_of(system)):
        count += own_numbers(system, coordinate_at(system, j))[at_sheave.CHANGE] != 0.0
    return count > 0


@kernel
def is_unconverged(system, c, h):
    """Whether a coordinate is not found, or the last iteration moved the rope at it too far."""
    numbers, count = own_numbers(system, c), 0
    moved = h * abs(numbers[at_sheave.CHANGE])
    for k in range(first_portion(system, c), last_portion(system, c) + 1):
        weight = abs(growth_of(system, c, k))
        count += weight != 0.0 and weight * moved > segments_of(system, k) * numbers_of(system, k)[GOAL]
    return numbers[at_sheave.IS_FOUND] == 0.0 or count > 0


@kernel
def unconverged_sheaves(system, step):
    """Number of coordinates that are not found, or whose ropes moved too far, and of portions beyond their lengths."""
    count = 0
    if step.turns:
        for j in range(count_of(system)):
            count += is_unconverged(system, coordinate_at(system, j), step.h)
        for k in range(lines_of(system)):
            if has_run(system, k):
                count += is_out_of_limits(system, k, -1.0) or is_out_of_limits(system, k, 1.0)
    return count
