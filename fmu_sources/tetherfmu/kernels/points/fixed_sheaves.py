"""Sheaves in an iteration of a fixed step: the speeds of their ropes are found with the moves of the nodes.

    e_2 (T_2 - mu u^2) - e_1 (T_1 - mu u^2) = m (u - u0)/h,   psi = psi0 + h u,   all at the end of the step

with e_1 and e_2 as in `sheaves.py`. `fixed_sheave_rows.py` has T_1, T_2 and the angle of wrap, linear in the changes of all
speeds. Each sheave runs forwards or backwards, is held while

    T_2 <= E T_1,   T_1 <= E T_2,

or runs at a limit of its speed: where a portion gets as short as it may be. Which of these it is shows only in the solution
of the small system of those that run: it is sought as it runs now, then as it was found, until all of them are found as they
were sought. If they are not after `MOST_TRIES`, the speeds that were found last are taken: no convergence.
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations.lines import (
    goes_on,
    lines_of,
    parameters_of,
    segments_of,
    sheaves_of,
    stiffness_of,
)
from ..line.drum_events import OVERLOAD
from ..linear_algebra import small_matrix
from . import sheave_room as at_sheave
from .coordinates import number_of
from .fixed_sheave_rows import CLOSE, add_all_columns, place_portions, put_speed, take_all_slopes, take_sheaves
from .sheave_pulls import density_of, has_losses, mass_of
from .sheave_room import has_run, numbers_at, shared_of, shortest_of, slopes_of
from .system_fixed_drums import follow, take_masses
from .system_room import GOAL, numbers_of

AT_LOWEST, BACKWARDS, HELD, FORWARDS, AT_HIGHEST = -2.0, -1.0, 0.0, 1.0, 2.0  # ways
MOST_TRIES, ALL_AT_ONCE = 16, 4  # at ways in an iteration; after so many only one sheave is sought in another way at a time
MOST_RUN = 0.1  # part of a portion by which rope that runs changes it in an iteration
LEAST_PIVOT = 1e-3  # of what the slope of the equation of a sheave is where the ropes do not yield

# --- limits


@kernel
def room_left(length, shortest):
    """How much shorter a portion of a length [m] may get [m]; 0 if rounding alone keeps it longer than its shortest one."""
    room = length - shortest
    return room if room > at.ROUNDED_STOP * shortest else 0.0


@kernel
def take_limits(system, k, h):
    """Limits of the speed of the sheave at the end of line k in an iteration of a step of h [s] (modified)."""
    numbers = numbers_at(system, k)
    speed, behind, ahead = (
        numbers[at_sheave.STAGE_SPEED],
        numbers[at_sheave.LENGTH],
        numbers_at(system, k + 1)[at_sheave.LENGTH],
    )
    highest = room_left(behind + h * speed, shortest_of(system, k)) / h
    lowest = -room_left(ahead - h * speed, shortest_of(system, k + 1)) / h
    if numbers[at_sheave.KEEPS] > 0.0:
        lowest = 0.0
    elif numbers[at_sheave.KEEPS] < 0.0:
        highest = 0.0
    farthest = MOST_RUN * min(behind, ahead) / h
    numbers[at_sheave.HIGHEST] = min(highest, max(speed, 0.0) + farthest)
    numbers[at_sheave.LOWEST] = max(lowest, min(speed, 0.0) - farthest)


# --- the equation of a sheave


@kernel
def losses(system, k, way):
    """e_1 and e_2 of the sheave at the end of line k on a way, and the slope of its equation by the angle of wrap [N]."""
    numbers, grip = numbers_at(system, k), parameters_of(system, k)[at.SHEAVE_FRICTION]
    loss, moving = numbers[at_sheave.LOSS], density_of(system, k) * numbers[at_sheave.STAGE_SPEED] ** 2
    behind, ahead = numbers[at_sheave.TENSION_BEHIND] - moving, numbers[at_sheave.TENSION_AHEAD] - moving
    if way > HELD and behind > 0.0:
        return loss, 1.0, -grip * loss * behind
    if way < HELD and ahead > 0.0:
        return 1.0, loss, grip * loss * ahead
    return 1.0, 1.0, 0.0


@kernel
def changed(system, k, which, slopes, changes):
    """One of MOVED_BEHIND, ... of the sheave at the end of line k with the changes of all speeds [m/s]."""
    count, total = sheaves_of(system), numbers_at(system, k)[which]
    row = count * number_of(system, k)
    for j in range(count):
        total += slopes[row + j] * changes[j]
    return total


@kernel
def changes_at(system, k, changes):
    """Changes of T_1 and T_2 [N] and of the angle of wrap [rad] with the changes of all speeds [m/s]."""
    by_1, by_2, by_wrap = slopes_of(system)
    return (
        changed(system, k, at_sheave.MOVED_BEHIND, by_1, changes),
        changed(system, k, at_sheave.MOVED_AHEAD, by_2, changes),
        changed(system, k, at_sheave.MOVED_WRAP, by_wrap, changes),
    )


@kernel
def unbalanced(system, k, h, way, change, of_tensions):
    """Force [N] that the equation of the sheave at the end of line k leaves on a way, see `changes_at`.

    change : of its speed [m/s].
    """
    numbers, (of_1, of_2, of_wrap) = numbers_at(system, k), of_tensions
    e_1, e_2, by_wrap = losses(system, k, way)
    speed, density = numbers[at_sheave.STAGE_SPEED], density_of(system, k)
    moving = density * speed * (speed + 2.0 * change)
    force = e_2 * (numbers[at_sheave.TENSION_AHEAD] + of_2 - moving)
    force -= e_1 * (numbers[at_sheave.TENSION_BEHIND] + of_1 - moving)
    return force + by_wrap * of_wrap - mass_of(system, k) * (speed + change - numbers[at_sheave.SPEED]) / h


@kernel
def put_equation(system, k, h, matrix, right):
    """The equation of the sheave at the end of line k, as it is sought (modified)."""
    numbers, count, j = numbers_at(system, k), sheaves_of(system), number_of(system, k)
    way, row = numbers[at_sheave.WAY], count * j
    if abs(way) != FORWARDS:
        matrix[row + j] = 1.0
        right[j] = numbers[at_sheave.SOUGHT] - numbers[at_sheave.STAGE_SPEED]
        return
    (by_1, by_2, by_wrap), (e_1, e_2, of_wrap) = slopes_of(system), losses(system, k, way)
    for i in range(row, row + count):
        matrix[i] = e_1 * by_1[i] - e_2 * by_2[i] - of_wrap * by_wrap[i]
    behind, ahead = numbers[at_sheave.INERTIA + 2], numbers_at(system, k + 1)[at_sheave.INERTIA]
    lowest = LEAST_PIVOT * (behind + ahead + mass_of(system, k)) / h
    own = matrix[row + j] + 2.0 * (e_2 - e_1) * density_of(system, k) * numbers[at_sheave.STAGE_SPEED]
    matrix[row + j] = max(own + mass_of(system, k) / h, lowest)
    of_moves = numbers[at_sheave.MOVED_BEHIND], numbers[at_sheave.MOVED_AHEAD], numbers[at_sheave.MOVED_WRAP]
    right[j] = unbalanced(system, k, h, way, 0.0, of_moves)


# --- how they are found


@kernel
def seek(system, h):
    """Let all sheaves (modified) be sought as they run now, in a step of h [s]."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            take_limits(system, k, h)
            numbers = numbers_at(system, k)
            speed, is_open = numbers[at_sheave.STAGE_SPEED], numbers[at_sheave.LOWEST] < numbers[at_sheave.HIGHEST]
            if not is_open or (speed == 0.0 and has_losses(system, k)):
                numbers[at_sheave.WAY], numbers[at_sheave.SOUGHT] = HELD, 0.0
            else:
                numbers[at_sheave.WAY] = BACKWARDS if has_losses(system, k) and speed < 0.0 else FORWARDS


@kernel
def way_of_held(system, k, of_tensions):
    """Which way a sheave that is held goes next with these changes of its tensions."""
    numbers, (of_1, of_2, _) = numbers_at(system, k), of_tensions
    behind, ahead = numbers[at_sheave.TENSION_BEHIND] + of_1, numbers[at_sheave.TENSION_AHEAD] + of_2
    loss, margin = numbers[at_sheave.LOSS] - 1.0, OVERLOAD * (abs(behind) + abs(ahead))
    if numbers[at_sheave.HIGHEST] > 0.0 and ahead - behind - loss * max(behind, 0.0) > margin:
        return FORWARDS
    if numbers[at_sheave.LOWEST] < 0.0 and behind - ahead - loss * max(ahead, 0.0) > margin:
        return BACKWARDS if has_losses(system, k) else FORWARDS
    return HELD


@kernel
def way_of_running(system, k, speed):
    """Which way a sheave that runs goes next with the speed [m/s] that was found; SOUGHT (modified), if that is given."""
    numbers, way = numbers_at(system, k), numbers_at(system, k)[at_sheave.WAY]
    lowest, highest = numbers[at_sheave.LOWEST], numbers[at_sheave.HIGHEST]
    if has_losses(system, k):
        lowest, highest = (max(lowest, 0.0), highest) if way == FORWARDS else (lowest, min(highest, 0.0))
    if lowest < speed < highest:
        return way
    numbers[at_sheave.SOUGHT] = lowest if speed <= lowest else highest
    if numbers[at_sheave.SOUGHT] == 0.0:
        return HELD
    return AT_LOWEST if speed <= lowest else AT_HIGHEST


@kernel
def next_way(system, k, h, changes):
    """Which way the sheave at the end of line k goes next with the changes of all speeds [m/s]; SOUGHT (modified)."""
    numbers, change, of_tensions = numbers_at(system, k), changes[number_of(system, k)], changes_at(system, k, changes)
    way = numbers[at_sheave.WAY]
    if abs(way) == FORWARDS:
        return way_of_running(system, k, numbers[at_sheave.STAGE_SPEED] + change)
    if way == HELD:
        return way_of_held(system, k, of_tensions)
    sign = -1.0 if has_losses(system, k) and numbers[at_sheave.SOUGHT] < 0.0 else 1.0
    left = unbalanced(system, k, h, sign, change, of_tensions)
    return way if (left >= 0.0 if way == AT_HIGHEST else left <= 0.0) else sign


@kernel
def seek_next(system, h, changes, one_at_a_time):
    """Let sheaves (modified) that are found as they were not sought be sought in another way, or one of them; how many."""
    others = 0
    for k in range(lines_of(system)):
        if goes_on(system, k) and not (one_at_a_time and others > 0):
            numbers = numbers_at(system, k)
            way = next_way(system, k, h, changes)
            others += way != numbers[at_sheave.WAY]
            numbers[at_sheave.WAY] = way
            if way == HELD:
                numbers[at_sheave.SOUGHT] = 0.0
    return others


@kernel
def are_held(system):
    """Whether all sheaves rest, and are held with the moves of the lines alone."""
    others = 0
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers = numbers_at(system, k)
            of_moves = numbers[at_sheave.MOVED_BEHIND], numbers[at_sheave.MOVED_AHEAD], numbers[at_sheave.MOVED_WRAP]
            rests = numbers[at_sheave.WAY] == HELD and numbers[at_sheave.STAGE_SPEED] == 0.0
            others += not rests or way_of_held(system, k, of_moves) != HELD
    return others == 0


@kernel
def find_changes(system, h, changes):
    """Changes of the speeds of all sheaves [m/s] (modified) in a step of h [s]; whether all are found as they are sought.

    They are sought as `seek` says, and their slopes are known.
    """
    matrix = shared_of(system)[1]
    for number in range(MOST_TRIES):
        small_matrix.set_to_zero(sheaves_of(system), matrix)
        for k in range(lines_of(system)):
            if goes_on(system, k):
                put_equation(system, k, h, matrix, changes)
        if not small_matrix.solve(sheaves_of(system), matrix, changes):
            for j in range(sheaves_of(system)):
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
def is_close(system, k, of_tensions):
    """Whether the changes of both tensions at the sheave at the end of line k are small."""
    numbers, (of_1, of_2, _) = numbers_at(system, k), of_tensions
    behind = is_small(of_1, numbers[at_sheave.TENSION_BEHIND] + of_1, stiffness_of(system, k))
    return behind and is_small(of_2, numbers[at_sheave.TENSION_AHEAD] + of_2, stiffness_of(system, k + 1))


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
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers, j = numbers_at(system, k), number_of(system, k)
            speed = numbers[at_sheave.STAGE_SPEED]
            if not are_found:
                onward = min(numbers[at_sheave.HIGHEST], max(numbers[at_sheave.LOWEST], speed + changes[j]))
                changes[j] = onward - speed
            numbers[at_sheave.CHANGE] = changes[j]
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers = numbers_at(system, k)
            close = abs(numbers[at_sheave.WAY]) != FORWARDS or is_close(system, k, changes_at(system, k, changes))
            numbers[at_sheave.IS_FOUND] = 1.0 if are_found and close else 0.0
    run(system, step)
    add_all_columns(system)


@kernel
def run(system, step):
    """Let all ropes (modified) run with the speeds that were found; lengths, masses and the forces of rope follow."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers = numbers_at(system, k)
            given, way = numbers[at_sheave.SOUGHT], numbers[at_sheave.WAY]
            speed = numbers[at_sheave.STAGE_SPEED] + numbers[at_sheave.CHANGE]
            is_given = numbers[at_sheave.IS_FOUND] == 1.0 and abs(way) != FORWARDS
            put_speed(system, k, step.h, given if is_given else speed)
    place_portions(system, step.time + step.h)
    for k in range(lines_of(system)):
        if has_run(system, k):
            follow(system, k, step)
    take_masses(system, step)


@kernel
def hold_speeds(system, are_found):
    """Let an iteration leave the speeds of all ropes as they are (modified); are_found : 1 if they are found so, else 0."""
    for k in range(lines_of(system)):
        if goes_on(system, k):
            numbers_at(system, k)[at_sheave.CHANGE], numbers_at(system, k)[at_sheave.IS_FOUND] = 0.0, are_found


@kernel
def has_changed(system):
    """Whether the last iteration has changed the speed of any rope."""
    count = 0
    for k in range(lines_of(system)):
        count += goes_on(system, k) and numbers_at(system, k)[at_sheave.CHANGE] != 0.0
    return count > 0


@kernel
def is_unconverged(system, k, h):
    """Whether the rope over the sheave at the end of line k is not found, or the last iteration moved it too far."""
    numbers = numbers_at(system, k)
    goal_1 = segments_of(system, k) * numbers_of(system, k)[GOAL]
    goal_2 = segments_of(system, k + 1) * numbers_of(system, k + 1)[GOAL]
    return numbers[at_sheave.IS_FOUND] == 0.0 or h * abs(numbers[at_sheave.CHANGE]) > min(goal_1, goal_2)


@kernel
def unconverged_sheaves(system, step):
    """Number of sheaves that are not found, or whose ropes moved too far, and of portions that are too short."""
    count = 0
    if step.turns:
        for k in range(lines_of(system)):
            count += goes_on(system, k) and is_unconverged(system, k, step.h)
            if has_run(system, k):
                count += numbers_at(system, k)[at_sheave.LENGTH] < (1.0 - CLOSE) * shortest_of(system, k)
    return count
