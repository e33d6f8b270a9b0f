"""Sheaves from stage to stage of a Rosenbrock step: rope that passes, accelerations (`sheaves.py`), right-hand sides.

And from iteration to iteration of a fixed step: lengths of portions, and the limits of speeds that keep these.
"""

from math import inf

from tetherfmu.runtime import layout as at

from ..arrays import copy
from ..compilation import kernel
from ..equations import winch
from ..equations.lines import (
    comes_from,
    goes_on,
    is_at_point,
    is_rope,
    is_turned,
    lines_of,
    segments_of,
    sheaves_of,
    stiffness_of,
)
from ..equations.rope_at_sheave import IN, OUT
from ..line.rodas4p import ALPHA, GAMMA, GAMMA_I, INERTIA, R_BY_GAMMA, STAGES, A, P
from ..linear_algebra.both_ends import get_node
from ..linear_algebra.vectors import add, dot, get, put, scale
from . import running_drums
from . import sheave_room as at_sheave
from .coordinates import (
    coordinate_at,
    count_of,
    first_portion,
    growth_of,
    is_braked,
    last_portion,
    own_numbers,
    runs,
    stages_of,
    weight_of,
)
from .sheave_pulls import acceleration_at_sheave, density_of, end_acceleration, mass_of, push, take_pulls
from .sheave_room import (
    ACCELERATIONS,
    BORDER,
    PULLED,
    from_drums,
    has_run,
    is_coordinate,
    is_running,
    longest_of,
    numbers_at,
    parts_of,
    runs_over,
    shortest_of,
    single_at,
    through,
    winch_of,
)
from .sheaves import pass_gains, solve_gains
from .system_room import integrator_of

LEAST_LENGTH = 0.25  # of the shortest length of a portion, below which an iteration does not take it
CLOSE = 1e-6  # of a length, by which a portion may be beyond its limits
MOST_RUN = 0.1  # part of a portion by which rope that runs changes it in an iteration


@kernel
def added_up(start, factors, stage, speeds):
    """start + sum_j factors[stage, j] U_j."""
    for j in range(stage):
        start += factors[stage, j] * speeds[j]
    return start


@kernel
def go_to_stage(system, stage, time, h):
    """Rope that has passed, speeds, lengths of all coordinates and portions (modified) at a stage; False: no length."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        numbers, speeds = own_numbers(system, c), stages_of(system, c)
        speed = numbers[at_sheave.SPEED]
        if not runs(system, c):
            numbers[at_sheave.PASSED] = numbers[at_sheave.STAGE_SPEED] = numbers[at_sheave.GAIN] = 0.0
            numbers[at_sheave.REST] = numbers[at_sheave.ADDED_UP] = 0.0
            continue
        numbers[at_sheave.REST] = added_up(GAMMA_I[stage] / GAMMA * speed, R_BY_GAMMA, stage, speeds)
        numbers[at_sheave.ADDED_UP] = added_up(GAMMA_I[stage] / GAMMA * speed / GAMMA, INERTIA, stage, speeds)
        if stage < STAGES - 1:
            numbers[at_sheave.PASSED] = h * added_up(ALPHA[stage] * speed, P, stage, speeds)
            numbers[at_sheave.STAGE_SPEED] = added_up(speed, A, stage, speeds)
    return take_lengths(system, time, time + ALPHA[stage] * h)


@kernel
def take_lengths(system, start, time):
    """Lengths and a of the portions (modified) at a time [s], from a step that began at `start` [s]; False: no length."""
    lost = 0
    for k in range(lines_of(system)):
        if is_rope(system, k):
            numbers = numbers_at(system, k)
            length = numbers[at_sheave.LENGTH_NOW]
            if is_turned(system, k):
                length += from_drums(system, k, at_sheave.PASSED)
                numbers[at_sheave.INTO] = from_drums(system, k, at_sheave.STAGE_SPEED)
            elif comes_from(system, k):
                before = numbers_at(system, k - 1)
                length += before[at_sheave.PASSED]
                numbers[at_sheave.INTO] = before[at_sheave.STAGE_SPEED]
            else:
                paid = winch_of(system, k)
                length += winch.length_at(paid, time) - winch.length_at(paid, start)
                numbers[at_sheave.INTO] = winch.rate_at(paid, time)
                numbers[at_sheave.INTO_GAIN] = winch.gain_at(paid, time)
            if goes_on(system, k):
                length -= numbers[at_sheave.PASSED]
            numbers[at_sheave.LENGTH] = length
            lost += not length > 0.0
    return lost == 0


@kernel
def accelerate(system, stage, time):
    """u' of all coordinates at a stage at a time [s], and the right-hand sides with it (modified)."""
    for k in range(lines_of(system)):
        if is_running(system, k):
            own = take_pulls(system, k, time)
            if stage == 0:
                numbers = numbers_at(system, k)
                numbers[at_sheave.INERTIA], numbers[at_sheave.INERTIA + 1], numbers[at_sheave.INERTIA + 2] = own
                copy(single_at(system, k, PULLED), single_at(system, k, BORDER))
    solve_gains(system, time)
    if stage == 0:
        take_slopes(system)
        for k in range(lines_of(system)):
            if is_running(system, k):
                find_end_accelerations(system, k, time)
    for k in range(lines_of(system)):
        if is_running(system, k):
            push_nodes(system, k)
            if stage == 0:
                find_accelerations(system, k)
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k):
            take_right(system, k)
    for j in range(sheaves_of(system), count_of(system)):
        if runs(system, coordinate_at(system, j)):
            running_drums.take_right(system, coordinate_at(system, j))


@kernel
def take_slopes(system):
    """Slopes of the equations of all coordinates by R_a and - R_b at the start of the step, and e there (modified)."""
    for j in range(sheaves_of(system), count_of(system)):
        running_drums.take_slopes(system, coordinate_at(system, j))
    for k in range(lines_of(system)):
        if goes_on(system, k) and runs_over(system, k):
            numbers = numbers_at(system, k)
            moving = density_of(system, k) * numbers[at_sheave.SPEED] ** 2
            if numbers[at_sheave.TENSION_BEHIND] <= moving:
                numbers[at_sheave.BEHIND] = 1.0
            if numbers[at_sheave.TENSION_AHEAD] <= moving:
                numbers[at_sheave.AHEAD] = 1.0
            of_1 = max(numbers[at_sheave.TENSION_BEHIND], 0.0) / stiffness_of(system, k)
            of_2 = max(numbers[at_sheave.TENSION_AHEAD], 0.0) / stiffness_of(system, k + 1)
            numbers[at_sheave.OF_BEHIND] = numbers[at_sheave.BEHIND] / (1.0 + of_1)
            numbers[at_sheave.OF_AHEAD] = numbers[at_sheave.AHEAD] / (1.0 + of_2)


@kernel
def find_accelerations(system, k):
    """ACCELERATIONS of the inner nodes of portion k at the start of the step (modified)."""
    w, n, found = integrator_of(system, k), segments_of(system, k), single_at(system, k, ACCELERATIONS)
    for i in range(1, n):
        put(found, i, scale(1.0 / w.stage_mass[i], get_node(n, i, w.force)))


@kernel
def find_end_accelerations(system, k, time):
    """Those of its ends, before `push_nodes` (modified)."""
    found = single_at(system, k, ACCELERATIONS)
    put(found, 0, end_acceleration(system, k, 0, time))
    put(found, segments_of(system, k), end_acceleration(system, k, 1, time))


@kernel
def inertia_times(system, k, which):
    """Sum over the running coordinates of the inertia at the sheave at the end of line k at the start of the step.

    which : what of a coordinate it is multiplied by, GAIN [N] or ADDED_UP [kg m/s].
    """
    numbers, behind = numbers_at(system, k), numbers_at(system, k + 1)
    of_1, of_2 = numbers[at_sheave.OF_BEHIND], numbers[at_sheave.OF_AHEAD]
    own = of_2 * behind[at_sheave.INERTIA] + of_1 * numbers[at_sheave.INERTIA + 2] + mass_of(system, k)
    total = own * numbers[which]
    if is_coordinate(system, k, IN):
        total += of_1 * numbers[at_sheave.INERTIA + 1] * through(system, k, IN, which)
    if is_coordinate(system, k + 1, OUT):
        total += of_2 * behind[at_sheave.INERTIA + 1] * behind[which]
    return total


@kernel
def take_right(system, k):
    """Right-hand side of a stage of the sheave at the end of line k from u' and the acceleration of its point (modified)."""
    numbers, total = numbers_at(system, k), inertia_times(system, k, at_sheave.GAIN)
    if is_at_point(system, k, 1):
        behind, ahead = get(single_at(system, k, BORDER), segments_of(system, k)), get(single_at(system, k + 1, BORDER), 0)
        col = add(scale(numbers[at_sheave.OF_BEHIND], behind), scale(numbers[at_sheave.OF_AHEAD], ahead))
        total -= dot(col, acceleration_at_sheave(system, k))
    numbers[at_sheave.RIGHT] = total


@kernel
def push_nodes(system, k):
    """Let the forces of portion k (modified) have what u' at its ends does: col u'.

    `sheave_border.subtract_known` has what it does by M_0.
    """
    into, out = through(system, k, IN, at_sheave.GAIN), through(system, k, OUT, at_sheave.GAIN)
    push(
        segments_of(system, k), into, out, parts_of(system, k), single_at(system, k, PULLED), integrator_of(system, k).force
    )


# --- lengths in fixed steps


@kernel
def began_at(system):
    """Time of the communication step [s] at which the fixed step began."""
    return numbers_at(system, 0)[at_sheave.BEGAN]


@kernel
def put_speed(system, c, h, speed):
    """Let a coordinate (modified) run with a speed [m/s] at the end of a step of h [s]."""
    numbers = own_numbers(system, c)
    numbers[at_sheave.STAGE_SPEED], numbers[at_sheave.PASSED] = speed, numbers[at_sheave.REACHED] + h * speed
    numbers[at_sheave.GAIN] = (speed - numbers[at_sheave.SPEED]) / h
    if speed != 0.0 or numbers[at_sheave.SPEED] != 0.0:
        for k in range(first_portion(system, c), last_portion(system, c) + 1):
            if weight_of(system, c, k, IN) != 0.0 or weight_of(system, c, k, OUT) != 0.0:
                numbers_at(system, k)[at_sheave.HAS_RUN] = 1.0


@kernel
def place_portions(system, end):
    """Lengths and rates of all portions (modified) at a time [s], the end of the step; whether none is too short."""
    take_lengths(system, began_at(system), end)
    pass_gains(system)
    lost = 0
    for k in range(lines_of(system)):
        if is_rope(system, k):
            numbers, shortest = numbers_at(system, k), shortest_of(system, k)
            lost += numbers[at_sheave.LENGTH] < LEAST_LENGTH * shortest
            numbers[at_sheave.LENGTH] = max(numbers[at_sheave.LENGTH], LEAST_LENGTH * shortest)
    return lost == 0


@kernel
def is_out_of_limits(system, k, sign):
    """Whether portion k is longer (sign 1) or shorter (sign -1) than it may be in the iteration."""
    length = numbers_at(system, k)[at_sheave.LENGTH]
    if sign > 0.0:
        return is_turned(system, k) and length > (1.0 + CLOSE) * longest_of(system, k)
    return length < (1.0 - CLOSE) * shortest_of(system, k)


@kernel
def stop_what_exceeds(system, h):
    """Let no coordinate (modified) take portions beyond the lengths that they may have in a step of h [s]; how many."""
    count = 0
    for k in range(lines_of(system)):
        for sign in (-1.0, 1.0):
            if has_run(system, k) and is_out_of_limits(system, k, sign):
                for j in range(count_of(system)):
                    c = coordinate_at(system, j)
                    if sign * growth_of(system, c, k) * own_numbers(system, c)[at_sheave.STAGE_SPEED] > 0.0:
                        put_speed(system, c, h, 0.0)
                        count += 1
    return count


@kernel
def keep_lengths(system, step):
    """Let speeds (modified) that an iteration has left keep all portions within their lengths."""
    end = step.time + step.h
    place_portions(system, end)
    for _ in range(count_of(system)):
        if stop_what_exceeds(system, step.h) > 0:
            place_portions(system, end)


@kernel
def room_left(longer, shorter):
    """How far a length [m] is from the one [m] at which it stops; 0 if rounding alone keeps it from there."""
    room = longer - shorter
    return room if room > at.ROUNDED_STOP * shorter else 0.0


@kernel
def limits_by(system, k, growth, speed, h):
    """Lowest and highest speed [m/s] of a coordinate that lets portion k get longer by `growth`, with its speed now."""
    length = numbers_at(system, k)[at_sheave.LENGTH] - growth * (h * speed)
    inwards = room_left(length, shortest_of(system, k)) / (abs(growth) * h)
    outwards = room_left(longest_of(system, k), length) / (abs(growth) * h) if is_turned(system, k) else inf
    return (-inwards, outwards) if growth > 0.0 else (-outwards, inwards)


@kernel
def take_limits(system, c, h):
    """Limits of the speed of a coordinate in an iteration of a step of h [s] (modified)."""
    numbers = own_numbers(system, c)
    speed, lowest, highest, least = numbers[at_sheave.STAGE_SPEED], -inf, inf, inf
    for k in range(first_portion(system, c), last_portion(system, c) + 1):
        growth = growth_of(system, c, k)
        if growth != 0.0:
            down, up = limits_by(system, k, growth, speed, h)
            lowest, highest = max(lowest, down), min(highest, up)
            least = min(least, numbers_at(system, k)[at_sheave.LENGTH] / abs(growth))
    if is_braked(system, c):
        lowest = highest = 0.0
    elif numbers[at_sheave.KEEPS] > 0.0:
        lowest = 0.0
    elif numbers[at_sheave.KEEPS] < 0.0:
        highest = 0.0
    farthest = MOST_RUN * least / h
    numbers[at_sheave.HIGHEST] = min(highest, max(speed, 0.0) + farthest)
    numbers[at_sheave.LOWEST] = max(lowest, min(speed, 0.0) - farthest)
