"""Broken or released lines at the beginning and end of an entry point; the law is in `equations/torn.py`.

A line is released at the beginning of the first step in which its input `release` is true. Rope whose end reaches a sheave
within a step runs off it at the beginning of that step.
"""

from math import sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.status import OK, RELEASED_WITHOUT_MASS

from ..compilation import kernel, view
from ..equations import flow, node_loads, parts, segment, torn
from ..equations.free_points import is_at_point, point_at, push_with
from ..equations.lines import inputs_of, lines_of, motion_of, parameters_of, segments_of, state_of, with_states
from ..equations.properties import (
    chain_of,
    half_density,
    point_mass,
    point_mass_in,
    property_in,
    property_of,
    rest_length,
    section_of,
)
from ..equations.ropes import first_of, freed_of, goes_on, has_sheaves, is_freed, is_portion, runs_off
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_at, add_scaled, dot, get, put, scale, sub
from ..notes import note

STRAIGHT = 0.999  # chord over unstretched length of rope that is divided anew
EARLY = 1.5  # of the way in a step: rope that may reach its sheave runs off before


@kernel
def mark_freed(system, k, freed):
    """Write into the plan (modified) whether line k was released."""
    system.plan[places.PLAN_HEADER + places.LINE_NUMBERS * k + places.FREED] = freed


@kernel
def tear(system, k):
    """Part line k in its parameters (modified) as its state says."""
    n, freed, state, parameters = segments_of(system, k), freed_of(system, k), state_of(system, k), parameters_of(system, k)
    broken = state[at.TORN_SEGMENT]
    if not is_portion(system, k):
        if 1.0 <= broken <= n:
            torn.tear(n, int(broken) - 1, parameters)
    elif (broken == 0.0 and state[at.RUN_OFF] != 0.0) or 1.0 < broken < n - freed:  # in each state that is not forged
        parts.divide(n, freed, state, parameters)


@kernel
def mend(system, k):
    """Undo `tear` (parameters modified)."""
    if is_portion(system, k):
        parts.unite(segments_of(system, k), freed_of(system, k), parameters_of(system, k))
    else:
        torn.mend(segments_of(system, k), parameters_of(system, k))


@kernel
def fit(system):
    """Adapt parameters and plan (modified) of all lines to their states."""
    for k in range(lines_of(system)):
        if torn.has_let_go(state_of(system, k)):
            torn.add_segment(segments_of(system, k), parameters_of(system, k))
            mark_freed(system, k, 1)
        tear(system, k)
        if is_portion(system, k) and parameters_of(system, k)[at.TORN_NOW] > 0.0:
            parts.brake(parameters_of(system, first_of(system, k)))


@kernel
def unfit(system):
    """Restore parameters and plan (modified) of the whole lines."""
    for k in range(lines_of(system)):
        mend(system, k)
        if is_portion(system, k):
            parts.release_brake(parameters_of(system, k))
        if is_freed(system, k):
            torn.remove_segment(segments_of(system, k) - 1, parameters_of(system, k))
            mark_freed(system, k, 0)


@kernel
def has_rope(system, k, end):
    """Whether line k reaches its start (end 0) or its end (1): not after its release."""
    return end == 0 or not is_freed(system, k)


@kernel
def can_let_go(system, k):
    """Whether the support of the last end of line k can exist without it: it is driven, has mass, or holds another line."""
    n, parameters = segments_of(system, k), parameters_of(system, k)
    if not is_at_point(system, k, 1):
        return parameters[at.KITE_IS_FREE] == 0.0 or point_mass_in(parameters, n, n) > torn.NO_MASS
    count = 0
    for j in range(lines_of(system)):
        own, n = parameters_of(system, j), segments_of(system, j)
        for end in range(2):
            if point_at(system, j, end) == point_at(system, k, 1):
                count += point_mass_in(own, n, n * end) > torn.NO_MASS or (
                    has_rope(system, j, end) and not (j == k and end == 1)
                )
    return count > 0


@kernel
def energy_of_driven_node(system, k):
    """Kinetic energy [J] of the half segment at a driven last end of line k, which stays with the line; free ends: 0."""
    n, parameters, (_, v) = segments_of(system, k), parameters_of(system, k), motion_of(system, k)
    if is_at_point(system, k, 1) or parameters[at.KITE_IS_FREE] != 0.0:
        return 0.0
    chain = chain_of(n, parameters, state_of(system, k))
    return 0.25 * property_of(chain, n - 1, at.LINE_DENSITY) * rest_length(chain, n - 1) * dot(get(v, n), get(v, n))


@kernel
def is_released(system, k):
    """Whether a finite input releases line k; a rope has the input at its first portion, and is released at its last."""
    return not goes_on(system, k) and 0.0 < abs(inputs_of(system, first_of(system, k))[at.RELEASE]) <= at.LARGEST_INPUT


@kernel
def let_go(system, before):
    """Release the lines (modified) whose input requests it for the first time; a status.

    The states `before` (modified) get their additional nodes, too.
    """
    for k in range(lines_of(system)):
        state = state_of(system, k)
        if is_released(system, k) and not torn.has_let_go(state):
            if not can_let_go(system, k):
                system.plan[places.STATUS_LINE] = k
                return RELEASED_WITHOUT_MASS
            n = segments_of(system, k)
            state[at.TORN_ENERGY] -= energy_of_driven_node(system, k)
            torn.add_node(n, state)
            torn.add_node(n, state_of(with_states(system, before), k))
            mend(system, k)
            torn.add_segment(n, parameters_of(system, k))
            mark_freed(system, k, 1)
            tear(system, k)
            state[at.LET_GO], state[at.LET_GO_AT] = 1.0, state[at.CLOCK]
    return OK


@kernel
def begin(system, step, before):
    """`fit`, `let_go` and `run_off` at the beginning of a step [s], with a copy of the states `before` (all modified).

    Returns a status.
    """
    fit(system)
    status = let_go(system, before)
    if status == OK and has_sheaves(system):
        run_off(system, step)
    return status


# --- rope that runs off its sheave


@kernel
def loose_rope(system, k, end):
    """Length [m] and lump [m] of the rope that portion k has at an end if it ends within the portion, else 0; and its part.

    Its part: 1 or the number of its segments, which are as short as MIN_SEGMENT_LENGTH at least.
    """
    state, parameters, n = state_of(system, k), parameters_of(system, k), segments_of(system, k)
    if not parts.is_parted(parameters):
        return (state[at.LENGTH], 0.0, n - 1) if runs_off(system, k) and end == 0 else (0.0, 0.0, 0)
    first = section_of(parameters, state[at.LENGTH])
    if end == 0 and parameters[at.FIRST_ENDS] > 0.0:
        lump = state[at.FIRST_LUMP] if state[at.TORN_SEGMENT] != 0.0 else state[at.END_LUMP]
        return first, lump, int(parameters[at.FIRST_ENDS])
    if end == 1 and parameters[at.SECOND_BEGINS] < n:
        lump = state[at.SECOND_LUMP] if state[at.TORN_SEGMENT] != 0.0 else state[at.START_LUMP]
        return state[at.SECOND_PART], lump, n - int(parameters[at.SECOND_BEGINS])
    return 0.0, 0.0, 0


@kernel
def reaches(system, k, end):
    """Whether the rope of portion k reaches the sheave at an end."""
    parameters = parameters_of(system, k)
    if not parts.is_parted(parameters):
        return True
    return parameters[at.FIRST_ENDS] > 0.0 if end == 0 else parameters[at.SECOND_BEGINS] < segments_of(system, k)


@kernel
def runs_out(length, count, speed, gain, step, short):
    """Whether rope of this length [m] in `count` segments, which runs out at a speed [m/s] and gains more [m/s2], ends soon.

    Within a step [s], or EARLY times its way; or it is shorter than `short` [m]. Waves accelerate it for less than a step.
    """
    way = max(speed, 0.0) * step
    way += min(way, 0.5 * max(gain, 0.0) * step * step)
    least = count * at.MIN_SEGMENT_LENGTH
    return speed >= 0.0 and length - least <= max(EARLY * way, short) + parts.STOPPED * least


@kernel
def too_short(system, k, end, other, speed):
    """Length [m] below which rope at an end of portion k that leaves at a speed [m/s] runs off, into the portion `other`.

    A segment of `other`, if the rope runs faster than its transverse waves: they then grow without limit; else 0.
    """
    n, state = segments_of(system, k), state_of(system, k)
    tension = state[at.TENSION_TO] if end == 1 else state[at.TENSION_FROM]
    if property_in(parameters_of(system, k), n, (n - 1) * end, at.LINE_DENSITY) * speed * speed <= abs(tension):
        return 0.0
    n = segments_of(system, other)
    return rest_length(chain_of(n, parameters_of(system, other), state_of(system, other)), 0 if end == 1 else n - 1)


@kernel
def run_off(system, step):
    """Take the ends of rope that reach a sheave within a step [s] off it (states and parameters modified)."""
    for k in range(lines_of(system)):
        if goes_on(system, k) and reaches(system, k, 1) and reaches(system, k + 1, 0):
            state = state_of(system, k)
            speed, gain = state[at.SHEAVE_SPEED], state[at.SHEAVE_ACCELERATION]
            ahead, _, count = loose_rope(system, k + 1, 0)
            behind, _, before = loose_rope(system, k, 1)
            ends = count > 0 and segments_of(system, k) > 1
            if ends and runs_out(ahead, count, -speed, -gain, step, too_short(system, k + 1, 0, k, speed)):
                run_over(system, k + 1, 0, k)
                continue
            ends = before > 0 and segments_of(system, k + 1) > 1
            if ends and runs_out(behind, before, speed, gain, step, too_short(system, k, 1, k + 1, speed)):
                run_over(system, k, 1, k + 1)


@kernel
def run_off_again(system, step, before):
    """`run_off` once more (states and parameters modified), with the nodes of the states `before` a step [s]."""
    count = 0
    for k in range(lines_of(system)):
        state, first = state_of(system, k), state_of(with_states(system, before), k)
        if state[at.RUN_OFF] != first[at.RUN_OFF]:
            mend(system, k)
            for place in (at.LENGTH, at.REELING, at.ACCELERATION, at.SHEAVE_SPEED, at.SHEAVE_ACCELERATION, at.TORN_ENERGY):
                state[place] = first[place]
            for place in range(at.RUN_OFF, at.END_LUMP + 1):
                state[place] = first[place]
            tear(system, k)
            count += 1
    if count > 0:
        run_off(system, step)


@view
def chain_at_start(system, k, time):
    """`Chain` of line k in its state, at the start of a step."""
    return chain_of(segments_of(system, k), parameters_of(system, k), state_of(system, k))


push_point = push_with(chain_at_start)


@kernel
def run_over(system, k, end, other):
    """Take the rope at an end of portion k off the sheave there, into the portion `other` (states and parameters modified).

    Momentum is kept: a free point at the sheave gets, with the lump beside it, what the rope loses around it. The energy
    lost, also that of the sheave, is noted.
    """
    sheave, at_sheave = (state_of(system, other), 1) if end == 0 else (state_of(system, k), 0)
    energy, momentum = energy_of_all(system), add(momentum_of(system, k), momentum_of(system, other))
    length, lump, _ = loose_rope(system, k, end)
    take_in(system, other, at_sheave, length, lump)
    let_out(system, k, end, length + lump)
    stop_rate(system, other, at_sheave, sheave[at.SHEAVE_SPEED], sheave[at.SHEAVE_ACCELERATION])
    stop_rate(system, k, end, sheave[at.SHEAVE_SPEED], sheave[at.SHEAVE_ACCELERATION])
    sheave[at.SHEAVE_SPEED] = sheave[at.SHEAVE_ACCELERATION] = 0.0
    tear(system, other)
    tear(system, k)
    chain, (x, v) = chain_at_start(system, other, 0.0), motion_of(system, other)
    parts.add_momentum(chain, x, v, -1.0)
    if is_at_point(system, k, end):
        lost = sub(momentum, add(momentum_of(system, k), momentum_of(system, other)))
        i = chain.n - 1 if at_sheave == 1 else 1
        add_at(v, i, push_point(system, point_at(system, k, end), lost, parts.node_mass(chain, i), 0.0))
    state_of(system, other)[at.TORN_ENERGY] += energy - energy_of_all(system)


@kernel
def momentum_of(system, k):
    """Momentum [N s] of line k with its flowing rope, and with the point masses that it carries."""
    chain, (x, v) = chain_at_start(system, k, 0.0), motion_of(system, k)
    part, total = flow.first_passing(chain), ZERO_VECTOR
    for s in range(chain.n):
        share, half, r = property_of(chain, s, at.SHARE), half_density(chain, s), sub(get(x, s + 1), get(x, s))
        (c_p, _), (c_q, _) = flow.passing(chain, share, part), flow.passing(chain, share, part - share)
        total = add_scaled(total, half * (c_p + c_q), r)
        total = add_scaled(total, half * rest_length(chain, s), add(get(v, s), get(v, s + 1)))
        part -= share
    for i in range(chain.n + 1):
        total = add_scaled(total, point_mass(chain, i), get(v, i))
    return total


@kernel
def energy_of_all(system):
    """Sum of `energy_of` over all lines [J]."""
    total = 0.0
    for k in range(lines_of(system)):
        total += energy_of(system, k)
    return total


@kernel
def stop_rate(system, k, end, speed, gain):
    """Subtract the rate at which rope passes the sheave at an end of portion k from the rate of its length (modified)."""
    sign = 1.0 if end == 0 else -1.0
    state_of(system, k)[at.REELING] -= sign * speed
    state_of(system, k)[at.ACCELERATION] -= sign * gain


@kernel
def take_in(system, k, end, length, lump):
    """Loosen an end of portion k, over which rope of a length [m] with a lump [m] comes in, in its state (modified).

    The part there is divided into one segment less. If it is straight, it ends so far before the sheave, h, that the rope
    behind that, in one lump, keeps its height where portions are parallel:

        h (h/2 + length + lump) = length (length/2 + lump)
    """
    chain, state, (x, v) = chain_at_start(system, k, 0.0), state_of(system, k), motion_of(system, k)
    n = chain.n
    s, i, node = (n - 1) * end, n - 1 if end == 1 else 1, n * end
    rest, half, added = rest_length(chain, s), half_density(chain, s), length + lump
    rate = chain.leaving if end == 1 else chain.reeling + chain.leaving
    velocity = add_scaled(get(v, node), rate / rest, sub(get(x, s + 1), get(x, s)))
    parts.add_momentum(chain, x, v, 1.0)
    a, b, c, d = parts.bounds_of_parts(n - freed_of(system, k), state)
    first, last = (a, b) if end == 0 or c == d else (c, d)
    h, (chord, _) = rest, segment.geometry(sub(get(x, last), get(x, first)))
    if last - first > 1 and chord > STRAIGHT * (last - first) * rest:
        h = min(rest, sqrt(added * added + length * (length + 2.0 * lump)) - added)
    added += h
    at_sheave, mass, gained = get(v, node), parts.node_mass(chain, i) - half * rest, 2.0 * half * added
    put(v, node, velocity)
    divide_anew(x, first, last, end, 1.0 - h / rest)
    divide_anew(v, first, last, end, 1.0 - h / rest)
    put(v, i, scale(1.0 / (mass + gained), add_scaled(scale(mass, get(v, i)), gained, velocity)))
    put(v, node, at_sheave)
    is_torn = state[at.TORN_SEGMENT] != 0.0
    if end == 1:
        state[at.END_LUMP] += added
        state[at.SECOND_PART] = state[at.SECOND_PART] - h if is_torn else parts.NO_PART
    else:
        state[at.START_LUMP] += added
        state[at.SECOND_PART] = state[at.SECOND_PART] if is_torn else state[at.LENGTH] - h
    parts.add_flag(state, parts.LOOSE, end)
    state[at.LENGTH] += length + lump
    parts.unite(n, freed_of(system, k), parameters_of(system, k))
    _, _, begins, ends = parts.bounds_of_parts(n - freed_of(system, k), state)
    if begins == ends:
        state[at.SECOND_PART] = parts.NO_PART


@kernel
def divide_anew(nodes, first, last, end, share):
    """Divide a line through flat `nodes` first to last (modified) into one segment less, away from its end 0 or 1.

    share : of the segment at this end that is kept.
    """
    for i in range(1, last - first):
        j = first + i if end == 1 else last - i
        towards = sub(get(nodes, j + 2 * end - 1), get(nodes, j))
        put(nodes, j, add_scaled(get(nodes, j), i * share / (last - first - 1), towards))


@kernel
def let_out(system, k, end, length):
    """Let rope of a length [m] leave portion k over the sheave at an end, in its state (modified)."""
    state = state_of(system, k)
    parts.unite(segments_of(system, k), freed_of(system, k), parameters_of(system, k))
    if state[at.TORN_SEGMENT] != 0.0:
        state[at.FIRST_LUMP if end == 0 else at.SECOND_LUMP] = 0.0
    elif end == 0:
        state[at.END_LUMP] = 0.0
    else:
        state[at.START_LUMP] = 0.0
    if end == 1 or state[at.TORN_SEGMENT] == 0.0:
        state[at.SECOND_PART] = parts.NO_PART
    state[at.LENGTH] = max(state[at.LENGTH] - length, parts.EMPTY)
    parts.add_flag(state, parts.GONE, end)


@kernel
def energy_of(system, k):
    """Energy [J] of line k in its state with the sheave at its end, as in `power_balance`."""
    chain, parameters, (x, v) = chain_at_start(system, k, 0.0), parameters_of(system, k), motion_of(system, k)
    n, total = chain.n, 0.5 * parameters[at.SHEAVE_MASS] * state_of(system, k)[at.SHEAVE_SPEED] ** 2
    start, end = parameters[at.GROUND_IS_FREE], parameters[at.KITE_IS_FREE]
    for i in range(n + 1):
        free = start if i == 0 else (end if i == n else 1.0)
        mass, lump = 0.0, point_mass(chain, i)
        for s in range(max(i - 1, 0), min(i + 1, n)):
            mass += half_density(chain, s) * rest_length(chain, s)
        total += 0.5 * free * (mass + lump) * dot(get(v, i), get(v, i))
        total += (mass + free * lump) * node_loads.specific_potential(chain, get(x, i), free > 0.0)
    for s in range(n):
        length, _ = segment.geometry(sub(get(x, s + 1), get(x, s)))
        elongation, stiffness = segment.spring(chain, s, length, False)
        total += segment.elastic_energy(stiffness, elongation)
    counted = start if parameters[at.IS_PORTION] == at.BEHIND_SHEAVE else 0.0, end
    return total + flow.energy_of_flow(chain, x, v, counted)


@kernel
def end(system):
    """`unfit` at the end of a step (modified). If a release was rolled back, its additional node is removed."""
    for k in range(lines_of(system)):
        if is_freed(system, k) and not torn.has_let_go(state_of(system, k)):
            torn.remove_node(segments_of(system, k) - 1, state_of(system, k))
    unfit(system)


@kernel
def refuse(system):
    """Note in the state (modified) of a tether without release that its input `release` has no effect; returns OK."""
    release = system.inputs[at.RELEASE]
    note(system.state, limits.IDLE_RELEASE, release * release, 0.0)
    return OK
