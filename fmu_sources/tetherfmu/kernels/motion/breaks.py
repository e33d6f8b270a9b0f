"""Breaking of a segment within a communication step, as soon as its tension reaches its breaking force.

The adaptive solver ends a step there, as at an event of a coordinate (`events.py`); fixed steps break lines at their ends,
which keeps the work bounded. A line, or a rope over sheaves, breaks once, at the segment closest to its breaking force.
Breaking brakes its winch and the flowing rope.
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.status import OK, ROPE_RUNS_OFF

from ..compilation import kernel
from ..equations import flow, parts, segment, torn
from ..equations.assembly import node_masses
from ..equations.boundary import place_ends
from ..equations.free_points import is_at_point, point_at, push_with
from ..equations.lines import (
    conditions_of,
    hold_length,
    lines_of,
    motion_of,
    note_line,
    parameters_of,
    put_numbers,
    put_reeling,
    reeling_at,
    segments_of,
    state_of,
    with_states,
)
from ..equations.properties import property_of, rest_length
from ..equations.rope import feels_rope
from ..equations.ropes import first_of, freed_of, goes_on, has_sheaves, is_portion, runs_off
from ..equations.winch import ALL_ALONG, follows_force, length_at, rate_at, reel
from ..line import strand
from ..line.drum_events import OVERLOAD, part_of_piece
from ..line.strand_room import KEPT_REELING, LATE, SECOND_PART, rope_in
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.vectors import add_at, dot, get, scale, sub
from ..notes import note, note_peak
from ..points import room
from ..points.room import (
    IS_KNOWN,
    SPEED,
    any_line,
    chain_now,
    chain_of_state,
    chain_with_rope,
    count_of,
    globals_of,
    has_rope,
    integrator_of,
    let_in,
    moves,
    numbers_of,
    strand_of,
    take_brake,
    take_holders,
    take_rates,
    take_weights,
)
from .states import go_to_state


@kernel
def is_any_torn(system, k):
    """Whether any portion of the rope with the first portion k, or a whole line, is broken in its state."""
    count = state_of(system, k)[at.TORN_SEGMENT] != 0.0
    while goes_on(system, k):
        k += 1
        count += state_of(system, k)[at.TORN_SEGMENT] != 0.0
    return count > 0


@kernel
def can_break(system, k):
    """Whether line k may break; a rope over sheaves breaks once, too."""
    parameters = parameters_of(system, k)
    return parameters[at.CAN_BREAK] > 0.0 and not (parts.is_parted(parameters) or is_any_torn(system, first_of(system, k)))


can_any_break = any_line(can_break)


@kernel
def weakest(chain, x, v):
    """Segment closest to its breaking force, the force that is missing [N], and the breaking force [N].

    With the nodes at x [m], v [m/s].
    """
    found, least, strength = 0, inf, inf
    for s in range(chain.n):
        own = property_of(chain, s, at.STRENGTH)
        if own > 0.0:
            length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
            rate = dot(e, sub(get(v, s + 1), get(v, s)))
            lacking = own - segment.tension_of(chain, s, segment.BY_LENGTH, length, rate)
            if lacking < least:
                found, least, strength = s, lacking, own
    return found, least, strength


@kernel
def part_to_break(system, time, h, weight):
    """Fraction of the step of h [s] from a time [s] after which the first line is expected to break; inf if none does.

    weight : on the interpolation, below 1 after a piece that was too long.
    """
    least = inf
    for k in range(lines_of(system)):
        if can_break(system, k) and moves(system, k):
            w, (x, v) = integrator_of(system, k), motion_of(system, k)
            _, after, strength = weakest(chain_now(system, k, time + h), w.x, w.v)
            if after < -OVERLOAD * strength:
                _, now, _ = weakest(chain_of_state(system, k, time), x, v)
                least = min(least, part_of_piece(weight * now, after))
    return least


@kernel
def stop_winch(system, k, time):
    """Keep the length of line k (modified) constant from a time [s] of the communication step."""
    chain, state = chain_of_state(system, k, time), state_of(system, k)
    if chain.reeling != 0.0 and feels_rope(chain.parameters):
        jump_alone(system, k, chain, -chain.reeling, time)
    keep_reeling(system, k)
    hold_length(system, k, chain.length)
    state[at.LENGTH], state[at.REELING], state[at.ACCELERATION] = chain.length, 0.0, 0.0


push_point = push_with(chain_of_state)


@kernel
def jump_alone(system, k, chain, change, time):
    """Apply a jump of the rate at its start [m/s] to the nodes of line k (modified), as in `events.stop`."""
    own, (x, v) = strand_of(system, k), motion_of(system, k)
    interleave(own.n, x, own.w.stage_x)
    node_masses(chain, own.w.stage_mass)
    take_weights(system, k)
    strand.take_gain_columns(own, chain)
    by_gain = rope_in(own.n, own.ropes, 0).by_gain
    for i in range(own.conditions.first, own.conditions.last + 1):
        impulse = scale(change, get(by_gain, i))
        if i == 0 and is_at_point(system, k, 0):
            push_point(system, point_at(system, k, 0), impulse, 0.0, time)
        elif not (i == own.n and is_at_point(system, k, 1)):
            add_at(v, i, scale(1.0 / own.w.stage_mass[i], impulse))


@kernel
def brake_rope(system, k, time):
    """Brake the winch of a rope (modified) whose first portion is k, from a time [s] of the communication step on.

    The rope stops within the rest of the step, or else within the next one, which keeps its momentum.
    """
    if parameters_of(system, k)[at.WINCH_IS_BRAKED] != 0.0:
        return
    reeling, left = conditions_of(system, k).reeling, state_of(system, k)[at.LAST_STEP] - time
    paid, length = rate_at(reeling, time) + let_in(system, k, 0, SPEED), length_at(reeling, time)
    keep_reeling(system, k)
    parts.brake(parameters_of(system, k))
    numbers_of(system, k)[LATE] = paid if left <= 0.0 else 0.0
    take_holders(system, k)
    put_reeling(system, k, (length, 0.0, 0.0, 0.0, -paid / left if left > 0.0 else 0.0, ALL_ALONG, 0.0))


@kernel
def energy_of_motion(system, k, chain):
    """Kinetic energy [J] of line k with its flowing rope."""
    own, (x, v), part, energy = strand_of(system, k), motion_of(system, k), flow.first_passing(chain), 0.0
    node_masses(chain, own.w.stage_mass)
    for i in range(chain.n + 1):
        energy += 0.5 * own.w.stage_mass[i] * dot(get(v, i), get(v, i))
    for s in range(chain.n):
        energy += flow.energy(chain, s, part, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1))
        part -= property_of(chain, s, at.SHARE)
    return energy


@kernel
def divide_portion(system, k, s, time):
    """Divide portion k (modified), whose segment s breaks at a time [s]; returns the kinetic energy lost [J].

    The momentum of each inner node with its rope is kept.
    """
    state, n, (x, v) = state_of(system, k), segments_of(system, k), motion_of(system, k)
    freed = freed_of(system, k)
    go_to_state(system, time)
    chain = chain_with_rope(system, k)
    rest, before = rest_length(chain, s), energy_of_motion(system, k, chain)
    parts.add_momentum(chain, x, v, 1.0)
    state[at.LENGTH] = chain.length
    state[at.TORN_SEGMENT] = s + 1.0
    state[at.SECOND_PART] = numbers_of(system, k)[SECOND_PART] = (n - freed - s - 1) * rest
    state[at.FIRST_LUMP] = state[at.SECOND_LUMP] = 0.5 * rest
    parts.divide(n, freed, state, parameters_of(system, k))
    take_weights(system, k)
    take_rates(system, k, time)
    chain = chain_with_rope(system, k)
    parts.add_momentum(chain, x, v, -1.0)
    return before - energy_of_motion(system, k, chain)


@kernel
def break_line(system, k, s, tension, time):
    """Break segment s of line k (modified) under a tension [N] at a time [s] of the communication step."""
    state, chain, (x, _) = state_of(system, k), chain_of_state(system, k, time), motion_of(system, k)
    if is_portion(system, k):
        s = parts.torn_between(segments_of(system, k) - freed_of(system, k), s)
    length, _ = segment.geometry(sub(get(x, s + 1), get(x, s)))
    elongation, stiffness = segment.spring(chain, s, length, False)
    lost = segment.elastic_energy(stiffness, elongation)
    if is_portion(system, k):
        lost += divide_portion(system, k, s, time)
        brake_rope(system, first_of(system, k), time)
    else:
        state[at.TORN_SEGMENT] = s + 1.0
        stop_winch(system, k, time)
        torn.tear(segments_of(system, k), s, parameters_of(system, k))
        take_holders(system, k)
    state[at.TORN_ENERGY] += lost
    state[at.TORN_AT] = state[at.CLOCK] - state[at.LAST_STEP] + time  # the clock is at the end of the communication step
    note(state, limits.BROKE, tension * tension, 0.0)
    note_peak(state, tension)
    globals_of(system).header[IS_KNOWN] = 0.0
    for j in range(count_of(system)):
        take_brake(system, j)


@kernel
def is_first(system, k, lacking, time):
    """Whether no other portion of the rope of line k lacks less than this force [N] to break at a time [s]."""
    count = 0
    for j in range(lines_of(system)):
        if j != k and first_of(system, j) == first_of(system, k) and can_break(system, j):
            x, v = motion_of(system, j)
            _, other, _ = weakest(chain_of_state(system, j, time), x, v)
            count += other < lacking
    return count == 0


@kernel
def break_lines(system, time):
    """Break lines (modified) that reach their breaking force at a time [s] of the communication step; whether any did."""
    count = 0
    for k in range(lines_of(system)):
        if can_break(system, k):
            x, v = motion_of(system, k)
            s, lacking, strength = weakest(chain_of_state(system, k, time), x, v)
            if lacking <= OVERLOAD * strength and is_first(system, k, lacking, time):
                break_line(system, k, s, strength - lacking, time)
                count += 1
    return count > 0


@kernel
def begin_breaks(system):
    """Break overloaded lines (modified) at the beginning of a communication step; whether any may break in it."""
    if not can_any_break(system):
        return False
    return not break_lines(system, 0.0) or can_any_break(system)


@kernel
def check_ends(system):
    """OK, or ROPE_RUNS_OFF about a portion whose rope came to its end at a sheave within the communication step."""
    if has_sheaves(system):
        for k in range(lines_of(system)):
            if parts.is_parted(parameters_of(system, k)) or runs_off(system, k):
                for end in range(room.limited_parts(system, k)):
                    least = (1.0 + parts.STOPPED) * room.shortest_of_part(system, k, end)
                    if has_rope(system, k) and room.length_of_part(system, k, end) <= least:
                        note_line(system.plan, k)
                        return ROPE_RUNS_OFF
    return OK


@kernel
def place_all_ends(system, time):
    """Move all driven ends (modified) along their curves to a time [s] of the communication step."""
    for k in range(lines_of(system)):
        x, v = motion_of(system, k)
        place_ends(conditions_of(system, k), time, x, v)


@kernel
def break_at_ends(system, step):
    """`break_lines` at the start and end of a communication step [s] in which only driven ends move (modified)."""
    if can_any_break(system) and not break_lines(system, 0.0):
        place_all_ends(system, step)
        break_lines(system, step)


@kernel
def keep_reeling(system, k):
    """Save how line k reels in the communication step, for `go_back` (modified)."""
    put_numbers(numbers_of(system, k), KEPT_REELING, conditions_of(system, k).reeling)


@kernel
def mend_winch(system, k, step, first):
    """Restore the reeling that the mended line k (modified) had in a communication step [s]; first : the earlier state."""
    state, reeling = state_of(system, k), reeling_at(numbers_of(system, k), KEPT_REELING)
    put_reeling(system, k, reeling)
    if follows_force(parameters_of(system, k)):
        for place in (at.LENGTH, at.REELING, at.ACCELERATION):
            state[place] = first[place]
    else:
        reel(reeling, step, state)


@kernel
def release_winch(system, k, step, first):
    """`mend_winch` of line k, if its winch is braked."""
    if parameters_of(system, k)[at.WINCH_IS_BRAKED] != 0.0:
        parts.release_brake(parameters_of(system, k))
        mend_winch(system, k, step, first)


@kernel
def unite_again(system, k, step, before):
    """Undo `divide_portion`, and the brake of its rope, if it was whole in the states `before`, as in `go_back`."""
    state, winch = state_of(system, k), first_of(system, k)
    state[at.SECOND_PART], state[at.FIRST_LUMP], state[at.SECOND_LUMP] = 0.0, 0.0, 0.0
    parts.unite(segments_of(system, k), freed_of(system, k), parameters_of(system, k))
    if not is_any_torn(with_states(system, before), winch):
        release_winch(system, winch, step, state_of(with_states(system, before), winch))


@kernel
def go_back(system, step, before):
    """Restore the lines (modified) that are whole in the states `before`, in a communication step [s]."""
    for k in range(lines_of(system)):
        state, first = state_of(system, k), state_of(with_states(system, before), k)
        if state[at.TORN_SEGMENT] != 0.0 and first[at.TORN_SEGMENT] == 0.0:
            state[at.TORN_SEGMENT], state[at.TORN_ENERGY], state[at.TORN_AT] = 0.0, first[at.TORN_ENERGY], 0.0
            state[at.WARNED_VALUES + limits.BROKE] = 0.0
            state[at.WARNINGS] -= 1 << limits.BROKE
            if is_portion(system, k):
                unite_again(system, k, step, before)
            else:
                torn.mend(segments_of(system, k), parameters_of(system, k))
                mend_winch(system, k, step, first)
