"""Fixed steps of a system: three stages of all lines, or backward Euler, as `second_order.py` has them for a single tether.

What makes a step of one line one of backward Euler (the ground, a stiffness, a stage that does not come to rest, energy that
nobody put in) makes that of all lines one; the energy is that of all lines and points together.
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import FINEST, LAST_ITERATIONS, MOST_ITERATIONS, PARTS, STAGES, STIFF
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, OK, STATE_NOT_FINITE

from ..arrays import copy
from ..compilation import kernel
from ..equations.boundary import chain_during, place_ends
from ..equations.lines import (
    conditions_of,
    lines_of,
    load_at,
    motion_of,
    parameters_of,
    point_at,
    points_of,
    segments_of,
    state_of,
)
from ..equations.properties import stiffest
from ..linear_algebra.vectors import get, norm
from . import backward_euler, second_order
from .backward_euler import EXPECTED, STAGE, WHOLE
from .second_order import GAMMA, MIDDLE, ROUNDING, TO_NEXT
from .system_control import work_of
from .system_descent import (
    STUCK,
    Step,
    attempt_of,
    descend,
    holds,
    is_restless,
    restless_lines,
    room_in_fixed_steps,
    scratch_of,
)
from .system_guess import begin_as_expected, guess, start
from .system_room import has_free_nodes, is_free

# --- backward Euler


@kernel
def take_all(system, step):
    """Let all lines (modified) have the result of the iteration."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            x, v = motion_of(system, k)
            backward_euler.take(attempt_of(system, k, step), step.time, step.kind, x, v, scratch_of(system, k))


@kernel
def take_step(system, step, in_any_case):
    """`backward_euler.step` of all lines (modified): whether it was taken, and the number of iterations."""
    start(system, step)
    iterations, taken, restless, phi = 0, inf, 1, 0.0
    if step.kind == EXPECTED:
        phi, taken = begin_as_expected(system, step)
        iterations, restless = 1, restless_lines(system, taken) if taken < inf else 1
    else:
        phi = guess(system, step)
    most = LAST_ITERATIONS if in_any_case else MOST_ITERATIONS
    while iterations < most and (restless > 0 or not holds(system, step)):
        phi, taken = descend(system, step, phi)
        iterations += 1
        if taken == inf:
            return False, -1
        restless = restless_lines(system, taken)
    if not (in_any_case or (restless == 0 and taken != STUCK)):
        return False, iterations
    for k in range(lines_of(system)):
        if has_free_nodes(system, k) and is_restless(system, k, taken):
            scratch_of(system, k).restless[0] += 1.0
    take_all(system, step)
    return True, iterations


@kernel
def careful_step(system, time, h):
    """One step of h [s] of all lines (modified) at a time [s], see `backward_euler.careful_step`; the iterations."""
    iterations, done, size = 0, 0, FINEST
    while done < FINEST:
        own = Step(time + h * done / FINEST, h * size / FINEST, WHOLE)
        taken, more = take_step(system, own, size == 1)
        if more < 0:
            return more
        iterations += more
        if not taken:
            size //= PARTS
            continue
        done += size
        while size < FINEST and done % (size * PARTS) == 0:
            size *= PARTS
    return iterations


@kernel
def wants_backward_euler(system):
    """Whether all steps are to be of one stage."""
    return parameters_of(system, 0)[at.FIXED_STEP_METHOD] == at.BACKWARD_EULER


# --- whether a step is one of backward Euler


@kernel
def is_any_on_ground(system):
    """Whether a node that moves freely is on the ground or below it."""
    for k in range(lines_of(system)):
        x, _ = motion_of(system, k)
        if second_order.is_on_ground(conditions_of(system, k), x):
            return True
    return False


@kernel
def is_any_stiff(system, time):
    """Whether a segment is as stiff as `limits.STIFF` at a time [s] of the communication step."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k) and stiffest(chain_during(conditions_of(system, k), time)) >= STIFF:
            return True
    return False


@kernel
def crosses(system, start, end):
    """Whether a segment went slack or taut since the step was started; start, end : times [s]."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            x, _ = motion_of(system, k)
            if second_order.crosses(conditions_of(system, k), start, room_in_fixed_steps(system, k).stages.x, end, x):
                return True
    return False


# --- energy


@kernel
def power_of_load(system, k, end, time, v):
    """Largest power [W] of the load on the free point at an end of line k at a time [s], by its part of the mass.

    v : velocities of the nodes [m/s].
    """
    point, node = point_at(system, k, end), segments_of(system, k) * end
    own = room_in_fixed_steps(system, k).stages.chain.mass[node] / points_of(system).mass[point]
    return own * norm(load_at(system, point, time)) * norm(get(v, node))


@kernel
def energy_and_power(system, time, is_new):
    """Energy [J] and largest power [W] as in `second_order.energy_and_power`, of all lines and points.

    is_new : whether of the state, else of that at the start of the step.
    """
    energy, power = 0.0, 0.0
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            w = room_in_fixed_steps(system, k).stages
            x, v = motion_of(system, k)
            here, speed = (x, v) if is_new else (w.x, w.v)
            own, given = second_order.energy_and_power(conditions_of(system, k), time, here, speed, w.chain.mass)
            energy += own
            power += given
            for end in range(2):
                if is_free(system, k, end):
                    power += power_of_load(system, k, end, time, speed)
    return energy, power


@kernel
def is_explained(system, time, h):
    """Whether the energy after a step of h [s] at a time [s] is at most that before it and what was put in."""
    before, power = energy_and_power(system, time, False)
    after, later = energy_and_power(system, time + h, True)
    return after - before <= h * (power + later) + ROUNDING * (abs(before) + abs(after))


# --- the stages


@kernel
def remember(system):
    """Keep the motion at the start of a step in the scratch space of all lines (modified)."""
    for k in range(lines_of(system)):
        w = room_in_fixed_steps(system, k).stages
        x, v = motion_of(system, k)
        copy(x, w.x)
        copy(v, w.v)


@kernel
def go_back(system):
    """Put all lines (modified) back to the start of the step."""
    for k in range(lines_of(system)):
        w = room_in_fixed_steps(system, k).stages
        x, v = motion_of(system, k)
        copy(w.x, x)
        copy(w.v, v)


@kernel
def expect(system, onward, known):
    """`second_order.expect` of all lines (modified)."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            second_order.expect(onward, known, room_in_fixed_steps(system, k).stages)


@kernel
def go_on(system, is_second):
    """Put all lines (modified), the results of a stage, where the second or the third one starts."""
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            w = room_in_fixed_steps(system, k).stages
            x, v = motion_of(system, k)
            if is_second:
                second_order.go_to_second(x, v, w)
            else:
                second_order.go_to_third(x, v, w)


@kernel
def place_all_ends(system, time):
    """Put all driven ends (modified) on their curves at a time [s] of the communication step."""
    for k in range(lines_of(system)):
        x, v = motion_of(system, k)
        place_ends(conditions_of(system, k), time, x, v)


@kernel
def stage(system, time, known, reach):
    """`second_order.stage` of all lines (modified): whether it came to rest, and the iterations."""
    taken, iterations = take_step(system, Step(time, reach, EXPECTED if known > 0 else STAGE), False)
    return taken, max(iterations, 0)


@kernel
def stages(system, time, h, known):
    """One step of h [s] of all lines (modified) at a time [s]; whether it is to be taken, and the number of iterations.

    known : as for `second_order.stage`.
    """
    reach = GAMMA * h
    remember(system)
    if known > 0:
        expect(system, TO_NEXT[0], known)
    taken, iterations = stage(system, time, known, reach)
    if not taken:
        return False, iterations
    does_cross = crosses(system, time, time + reach)
    go_on(system, True)
    expect(system, TO_NEXT[1], known)
    taken, more = stage(system, time + (MIDDLE - GAMMA) * h, 1, reach)
    iterations += more
    if not taken:
        return False, iterations
    does_cross = does_cross or crosses(system, time, time + MIDDLE * h)
    go_on(system, False)
    expect(system, TO_NEXT[2], 2)
    taken, more = stage(system, time + (1.0 - GAMMA) * h, 2, reach)
    iterations += more
    if not taken or is_any_on_ground(system):
        return False, iterations
    place_all_ends(system, time + h)
    does_cross = does_cross or crosses(system, time, time + h)
    is_smooth = not does_cross and iterations <= 2 * STAGES
    return is_smooth or is_explained(system, time, h), iterations


@kernel
def step(system, time, h, known):
    """One step of h [s] of all lines (modified) at a time [s]; iterations and the way, see `second_order.step`."""
    if wants_backward_euler(system) or is_any_on_ground(system) or is_any_stiff(system, time):
        return careful_step(system, time, h), 1
    taken, iterations = stages(system, time, h, known)
    if taken:
        return iterations, 0
    go_back(system)
    more = careful_step(system, time, h)
    return more if more < 0 else iterations + more, 2


@kernel
def hurried_step(system, time, h):
    """One step of backward Euler of all lines (modified), taken as it is: its iterations. All lines count as restless."""
    _, iterations = take_step(system, Step(time, h, WHOLE), True)
    for k in range(lines_of(system)):
        if has_free_nodes(system, k):
            room_in_fixed_steps(system, k).stages.chain.restless[0] += 1.0
    return iterations


@kernel
def integrate(system, duration):
    """Advance all lines (modified) over a communication step of `duration` [s], see `second_order.integrate`.

    Counters stand in the state of the first line, how often iterations were ended in the scratch space of each.
    """
    budget = at.ITERATION_BUDGET // work_of(system)
    count = backward_euler.count_of_steps(conditions_of(system, 0), duration, budget)
    if count == 0:
        return FIXED_STEPS_TOO_MANY
    h = duration / count
    for k in range(lines_of(system)):
        room_in_fixed_steps(system, k).stages.chain.restless[0] = 0.0
    spent, left, known = 0, 0, 0
    for i in range(count):
        if spent > STAGES * budget:
            iterations, way = hurried_step(system, i * h, h), 1
        else:
            iterations, way = step(system, i * h, h, known)
        if iterations < 0:
            return STATE_NOT_FINITE
        known = 3 if way == 0 else 0
        spent += iterations
        left += 1 if way == 2 else 0
    memory = state_of(system, 0)
    memory[at.STEPS] += count
    memory[at.REJECTIONS] += left
    memory[at.ITERATIONS] += spent
    return OK
