"""Rope coordinates in a state of the lines: their tensions, their accelerations, and their storage in the state."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits

from ..arrays import clear
from ..compilation import PARTS, kernel, view
from ..equations import assembly, segment
from ..equations.boundary import chain_during
from ..equations.free_points import is_at_point, point_at
from ..equations.ground import has_ground
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of, state_of
from ..equations.parts import is_parted
from ..equations.rope import feels_rope, tension_of
from ..equations.ropes import goes_on, has_coordinates, is_freed, is_portion
from ..line import contact, rosenbrock, strand
from ..line.strand_room import (
    CORNER,
    DRUM,
    GAIN,
    HELD_GAIN,
    LATE,
    LENGTH,
    PULL,
    RATE,
    SECOND_PART,
    SHEAVE,
    TENSION,
    rope_in,
)
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.vectors import dot, get, put_at, sub
from ..notes import note
from ..points import net, room
from ..points.room import (
    chain_at_stage,
    coordinate_at,
    count_of,
    globals_of,
    has_rope,
    holders_of,
    integrator_of,
    is_on_drum,
    is_rope,
    numbers_of,
    strand_of,
    take_rates,
)


@view
def nodes_of(system, k, is_after):
    """Positions [m] and velocities [m/s] of the nodes of line k: from a trial Rosenbrock step, or from its state."""
    w, (x, v) = integrator_of(system, k), motion_of(system, k)
    return (w.x, w.v) if is_after else (x, v)


@kernel
def go_to_state(system, time):
    """Set coordinates and lines (modified) to their state at a time [s], as a stage."""
    room.settle(system)
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        own[room.PASSED_NOW], own[room.SPEED_NOW], own[room.GAIN_NOW] = own[room.PASSED], own[room.SPEED], 0.0
    for k in range(lines_of(system)):
        if is_rope(system, k):
            take_rates(system, k, time)


@kernel
def evaluate(system, time, is_after):
    """Tensions at all coordinates, and accelerations of the free ones (modified), at a time [s].

    is_after : of a trial step; else of the states, after `go_to_state`.  Scratch space is modified.
    """
    for j in range(count_of(system)):
        coordinate_at(system, j)[room.GAIN_NOW] = 0.0
    room.let_all_run(system)
    for k in range(lines_of(system)):
        x, v = nodes_of(system, k, is_after)
        if has_rope(system, k):
            take_rates(system, k, time)
            strand.evaluate(strand_of(system, k), chain_at_stage(system, k), time, x, v)
        else:
            evaluate_plain(conditions_of(system, k), integrator_of(system, k), time, x, v)
    net.sum_masses(system, True)
    net.find_accelerations(system, time, True)


@kernel
def evaluate_plain(conditions, w, time, x, v):
    """Forces and masses of a line without ropes (modified) at x [m], v [m/s] and a time [s]."""
    chain = chain_during(conditions, time)
    interleave(conditions.n, x, w.stage_x)
    interleave(conditions.n, v, w.stage_v)
    assembly.node_masses(chain, w.stage_mass)
    clear(w.modes)
    if has_ground(conditions.parameters):
        contact.find(conditions, chain, x, v, w)
    rosenbrock.stage_force(conditions, chain, time, w)


@kernel
def hold(own):
    """Hold a coordinate with these numbers (modified)."""
    own[room.IS_HELD], own[room.SIGN], own[room.GAIN_NOW], own[room.ACCELERATION] = 1.0, 0.0, 0.0, 0.0


# --- end of a communication step


@kernel
def end_lengths(system, time):
    """Store the lengths of lines with ropes in their states (modified) at the end of a communication step [s]."""
    go_to_state(system, time)
    for k in range(lines_of(system)):
        if is_rope(system, k):
            numbers, state = numbers_of(system, k), state_of(system, k)
            state[at.LENGTH], state[at.REELING] = numbers[LENGTH], numbers[RATE] + numbers[RATE + 1]
            if PARTS:
                state[at.SECOND_PART] = numbers[SECOND_PART]
                if numbers[LATE] != 0.0:
                    state[at.REELING] += numbers[LATE]


@kernel
def end_coordinates(system, time):
    """Store all coordinates in the states (modified) at the end of a communication step, a time [s]."""
    for j in range(count_of(system)):
        own = coordinate_at(system, j)
        if own[room.SPEED] == 0.0 and own[room.FRICTION] != 0.0:
            hold(own)  # prevents acceleration
    if count_of(system) > 0 and globals_of(system).header[room.IS_KNOWN] == 0.0:
        go_to_state(system, time)
        evaluate(system, time, False)
    for k in range(lines_of(system)):
        write_ends(system, k)
        write_coordinates(system, k)


@kernel
def write_coordinates(system, k):
    """Store the sheave at the end of line k and the drum that it carries in its state (modified)."""
    numbers, state = numbers_of(system, k), state_of(system, k)
    if goes_on(system, k):
        own = coordinate_at(system, int(numbers[SHEAVE]))
        state[at.PAYOUT] += own[room.TOTAL]
        state[at.SHEAVE_SPEED], state[at.SHEAVE_ACCELERATION] = own[room.SPEED], own[room.GAIN_NOW]
    if numbers[DRUM] >= 0.0 and has_coordinates(system):
        own = coordinate_at(system, int(numbers[DRUM]))
        state[at.DRUM_PAYOUT] += own[room.TOTAL]
        state[at.DRUM_SPEED], state[at.DRUM_ACCELERATION] = own[room.SPEED], own[room.GAIN_NOW]
    if is_rope(system, k) and feels_rope(conditions_of(system, k).parameters):
        state[at.ACCELERATION] = numbers[GAIN] + numbers[GAIN + 1]


@kernel
def end_tension(system, k, end):
    """Tension [N] at an end of line k without coordinates, after `evaluate`."""
    own, n = strand_of(system, k), segments_of(system, k)
    total = own.numbers[PULL + end] + own.numbers[CORNER + 1] * own.numbers[HELD_GAIN + 1 - end]
    if is_at_point(system, k, end):
        total += dot(
            get(rope_in(n, own.ropes, end).by_gain, n * end), net.acceleration_of_point(system, point_at(system, k, end))
        )
    return tension_of(net.stiffness_at(system, k, end), total)


@kernel
def tension_of_segment(system, k, end):
    """Tension [N] of the segment at an end of line k in its state, 0 if it carries nothing."""
    conditions, (x, v), s = conditions_of(system, k), motion_of(system, k), (segments_of(system, k) - 1) * end
    length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
    rate, chain = dot(e, sub(get(v, s + 1), get(v, s))), chain_during(conditions, 0.0)
    return segment.tension_of(chain, s, segment.BY_LENGTH, length, rate)


@kernel
def tension_at(system, k, end):
    """Tension [N] at any end of line k."""
    if is_parted(conditions_of(system, k).parameters) and not is_rope(system, k):
        return tension_of_segment(system, k, end)
    return numbers_of(system, k)[TENSION + end] if holders_of(system, k, end) > 0 else end_tension(system, k, end)


@kernel
def write_ends(system, k):
    """Store the end tensions of line k in its state (modified), after `evaluate`; note a slack rope at a sheave."""
    state = state_of(system, k)
    if is_on_drum(system, k) and feels_rope(conditions_of(system, k).parameters):
        state[at.TENSION_AT_DRUM] = numbers_of(system, k)[TENSION]
    if not is_portion(system, k):
        return
    state[at.TENSION_FROM] = tension_at(system, k, 0)
    state[at.TENSION_TO] = 0.0 if is_freed(system, k) else tension_at(system, k, 1)
    if not goes_on(system, k):
        return
    behind = ahead = 0.0
    if holders_of(system, k, 1) > 0:
        behind, ahead = numbers_of(system, k)[TENSION + 1], numbers_of(system, k + 1)[TENSION]
    if min(behind, ahead) < 0.0:
        note(state, limits.SLACK_AT_SHEAVE, min(behind, ahead) ** 2, 0.0)
    if is_at_point(system, k, 1):
        gained = net.acceleration_of_point(system, point_at(system, k, 1))
        put_at(state, at.END_ACCELERATION, gained)
        put_at(state_of(system, k + 1), at.START_ACCELERATION, gained)
