"""Breaking of a segment within a communication step, as soon as its tension reaches its breaking force.

The adaptive solver ends a step there, as at an event of a coordinate (`events.py`); fixed steps break lines at their ends,
which keeps the work bounded. A line breaks once, at the segment closest to its breaking force. Breaking brakes its winch and
the flowing rope.
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits

from ..compilation import kernel
from ..equations import segment, torn
from ..equations.assembly import node_masses
from ..equations.boundary import place_ends
from ..equations.free_points import is_at_point, point_at
from ..equations.lines import (
    conditions_of,
    hold_length,
    lines_of,
    motion_of,
    parameters_of,
    put_numbers,
    put_reeling,
    reeling_at,
    segments_of,
    state_of,
    with_states,
)
from ..equations.properties import half_density, point_mass, property_of, rest_length
from ..equations.rope import feels_rope
from ..equations.winch import follows_force, reel
from ..line import strand
from ..line.drum_events import OVERLOAD, part_of_piece
from ..line.strand_room import KEPT_REELING, rope_in
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.vectors import add_at, dot, get, scale, sub
from ..notes import note, note_peak
from ..points.room import (
    IS_KNOWN,
    any_line,
    chain_now,
    chain_of_state,
    count_of,
    globals_of,
    integrator_of,
    moves,
    numbers_of,
    strand_of,
    take_brake,
    take_holders,
    take_weights,
)


@kernel
def can_break(system, k):
    """Whether line k may break."""
    return parameters_of(system, k)[at.CAN_BREAK] > 0.0 and not torn.is_torn(parameters_of(system, k))


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


@kernel
def push_point(system, point, impulse, time):
    """Apply an impulse [N s] to a free point (modified, at the ends of all its lines) at a time [s]."""
    mass = 0.0
    for k in range(lines_of(system)):
        chain = chain_of_state(system, k, time)
        for end in range(2):
            if point_at(system, k, end) == point:
                s = (chain.n - 1) * end
                mass += half_density(chain, s) * rest_length(chain, s) + point_mass(chain, chain.n * end)
    for k in range(lines_of(system)):
        _, v = motion_of(system, k)
        for end in range(2):
            if point_at(system, k, end) == point:
                add_at(v, segments_of(system, k) * end, scale(1.0 / mass, impulse))


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
            push_point(system, point_at(system, k, 0), impulse, time)
        elif not (i == own.n and is_at_point(system, k, 1)):
            add_at(v, i, scale(1.0 / own.w.stage_mass[i], impulse))


@kernel
def break_line(system, k, s, tension, time):
    """Break segment s of line k (modified) under a tension [N] at a time [s] of the communication step."""
    state, chain, (x, _) = state_of(system, k), chain_of_state(system, k, time), motion_of(system, k)
    length, _ = segment.geometry(sub(get(x, s + 1), get(x, s)))
    elongation, stiffness = segment.spring(chain, s, length, False)
    state[at.TORN_SEGMENT] = s + 1.0
    state[at.TORN_AT] = state[at.CLOCK] - state[at.LAST_STEP] + time  # the clock is at the end of the communication step
    state[at.TORN_ENERGY] += segment.elastic_energy(stiffness, elongation)
    note(state, limits.BROKE, tension * tension, 0.0)
    note_peak(state, tension)
    stop_winch(system, k, time)
    torn.tear(segments_of(system, k), s, parameters_of(system, k))
    take_holders(system, k)
    globals_of(system).header[IS_KNOWN] = 0.0
    for j in range(count_of(system)):
        take_brake(system, j)


@kernel
def break_lines(system, time):
    """Break lines (modified) that reach their breaking force at a time [s] of the communication step; whether any did."""
    count = 0
    for k in range(lines_of(system)):
        if can_break(system, k):
            x, v = motion_of(system, k)
            s, lacking, strength = weakest(chain_of_state(system, k, time), x, v)
            if lacking <= OVERLOAD * strength:
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
def go_back(system, step, before):
    """Restore the lines (modified) that are whole in the states `before`, in a communication step [s]."""
    for k in range(lines_of(system)):
        state, first = state_of(system, k), state_of(with_states(system, before), k)
        if state[at.TORN_SEGMENT] != 0.0 and first[at.TORN_SEGMENT] == 0.0:
            state[at.TORN_SEGMENT], state[at.TORN_ENERGY], state[at.TORN_AT] = 0.0, first[at.TORN_ENERGY], 0.0
            state[at.WARNED_VALUES + limits.BROKE] = 0.0
            state[at.WARNINGS] -= 1 << limits.BROKE
            torn.mend(segments_of(system, k), parameters_of(system, k))
            mend_winch(system, k, step, first)
