"""Ropes over sheaves at a state of the lines: their tensions and accelerations, and what the state keeps of them."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits

from ..compilation import kernel, view
from ..equations import assembly
from ..equations.boundary import chain_during
from ..equations.ground import has_ground
from ..equations.lines import (
    comes_from,
    conditions_of,
    goes_on,
    is_at_point,
    is_freed,
    is_portion,
    is_rope,
    is_turned,
    lines_of,
    motion_of,
    segments_of,
    state_of,
    stiffness_of,
)
from ..equations.notes import note
from ..equations.rope_at_drum import tension_of
from ..equations.rope_at_sheave import IN, OUT
from ..line import contact, rosenbrock
from ..linear_algebra.both_ends import interleave
from ..linear_algebra.vectors import dot, get, put_at
from ..points import sheave_room as at_sheave
from ..points.coordinates import carries_drum, coordinate_at, count_of, is_any_running, own_numbers
from ..points.running_drums import has_friction
from ..points.sheave_pulls import acceleration_at_sheave, end_acceleration, take_pulls
from ..points.sheave_room import (
    PULLED,
    drum_numbers_at,
    has_run,
    numbers_at,
    portion_in_step,
    single_at,
    speed_in,
    speed_out,
)
from ..points.sheave_stages import take_lengths
from ..points.sheaves import solve_gains
from ..points.system_room import integrator_of
from ..points.system_step import stage_masses


@view
def nodes_of(system, k, is_after):
    """Positions [m] and velocities [m/s] of the nodes of line k: of a step that is tried, or of its state."""
    w, (x, v) = integrator_of(system, k), motion_of(system, k)
    return (w.x, w.v) if is_after else (x, v)


@view
def chain_now(system, k, time):
    """The `Chain` of line k in `evaluate`."""
    if is_rope(system, k):
        return portion_in_step(system, k)
    return chain_during(conditions_of(system, k), time)


@kernel
def evaluate(system, start, time, is_after):
    """Tensions at all coordinates, and u' of those that run (modified), at a time [s]; scratch space is modified.

    is_after : of a step that is tried and began at `start` [s]; else of the states, and start is that time.
    """
    if not is_after or not is_any_running(system):
        for j in range(count_of(system)):
            numbers = own_numbers(system, coordinate_at(system, j))
            numbers[at_sheave.PASSED], numbers[at_sheave.STAGE_SPEED] = 0.0, numbers[at_sheave.SPEED]
        take_lengths(system, start, time)
    for k in range(lines_of(system)):
        n, conditions, w, (x, v) = (
            segments_of(system, k),
            conditions_of(system, k),
            integrator_of(system, k),
            nodes_of(system, k, is_after),
        )
        chain = chain_now(system, k, time)
        interleave(n, x, w.stage_x)
        interleave(n, v, w.stage_v)
        assembly.node_masses(chain, w.stage_mass)
        for s in range(n):
            w.modes[s] = 0.0
        if has_ground(conditions.parameters):
            contact.find(conditions, chain, x, v, w)
        rosenbrock.stage_force(conditions, chain, time, w)
    stage_masses(system)
    for k in range(lines_of(system)):
        if is_rope(system, k):
            take_pulls(system, k, time)
    solve_gains(system, time)


@kernel
def end_tension(system, k, end, time):
    """Tension [N] at an end of portion k where no sheave is, after `evaluate`."""
    numbers, n = numbers_at(system, k), segments_of(system, k)
    total, col = numbers[at_sheave.PULL + end], get(single_at(system, k, PULLED), n * end)
    if end == IN and goes_on(system, k):
        total += numbers[at_sheave.YIELD + 1] * numbers[at_sheave.GAIN]
    if end == OUT and (comes_from(system, k) or is_turned(system, k)):
        total += numbers[at_sheave.YIELD + 1] * numbers[at_sheave.INTO_GAIN]
    if is_at_point(system, k, end):
        total += dot(col, end_acceleration(system, k, end, time))
    return tension_of(stiffness_of(system, k), total if end == IN else -total)


@kernel
def write_tensions(system, time):
    """Tensions at both ends of all portions into their states (modified), after `evaluate`; none at a sheave is noted.

    And where lines leave drums.
    """
    for k in range(lines_of(system)):
        if is_turned(system, k):
            state_of(system, k)[at.TENSION_AT_DRUM] = numbers_at(system, k)[at_sheave.TENSION_IN]
        if is_portion(system, k):
            state = state_of(system, k)
            if is_turned(system, k):
                state[at.TENSION_FROM] = numbers_at(system, k)[at_sheave.TENSION_IN]
            elif not comes_from(system, k):
                state[at.TENSION_FROM] = end_tension(system, k, IN, time)
            else:
                state[at.TENSION_FROM] = numbers_at(system, k - 1)[at_sheave.TENSION_AHEAD]
            if not goes_on(system, k):
                state[at.TENSION_TO] = 0.0 if is_freed(system, k) else end_tension(system, k, OUT, time)
            else:
                numbers = numbers_at(system, k)
                state[at.TENSION_TO] = numbers[at_sheave.TENSION_BEHIND]
                least = min(numbers[at_sheave.TENSION_BEHIND], numbers[at_sheave.TENSION_AHEAD])
                if least < 0.0:
                    note(state, limits.SLACK_AT_SHEAVE, least * least, 0.0)
                if is_at_point(system, k, 1):
                    gained = acceleration_at_sheave(system, k)
                    put_at(state, at.END_ACCELERATION, gained)
                    put_at(state_of(system, k + 1), at.START_ACCELERATION, gained)


@kernel
def hold(system, c):
    """Hold a coordinate (modified)."""
    numbers = own_numbers(system, c)
    numbers[at_sheave.RUNS] = numbers[at_sheave.SIGN] = numbers[at_sheave.GAIN] = 0.0


@kernel
def begin_end(system):
    """Let coordinates that rest (modified) be held, so that they gain no speed, but for those without friction."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if own_numbers(system, c)[at_sheave.SPEED] == 0.0 and has_friction(system, c):
            hold(system, c)


@kernel
def end_lengths(system, time):
    """Let the states (modified) have the lengths of portions and their rates at the end of a communication step [s]."""
    for k in range(lines_of(system)):
        if has_run(system, k):
            state = state_of(system, k)
            state[at.LENGTH] = numbers_at(system, k)[at_sheave.LENGTH_NOW]
            state[at.REELING] = speed_in(system, k, time) - speed_out(system, k)


@kernel
def end_ropes(system, time):
    """Let the states (modified) have what coordinates and portions have at the end of a communication step, a time [s]."""
    begin_end(system)
    if numbers_at(system, 0)[at_sheave.KNOWN] == 0.0:
        evaluate(system, time, time, False)
    write_tensions(system, time)
    for k in range(lines_of(system)):
        if carries_drum(system, k):
            drum, state = drum_numbers_at(system, k), state_of(system, k)
            state[at.DRUM_PAYOUT] += drum[at_sheave.PAID]
            state[at.DRUM_SPEED], state[at.DRUM_ACCELERATION] = drum[at_sheave.SPEED], drum[at_sheave.GAIN]
        if is_rope(system, k):
            numbers, state = numbers_at(system, k), state_of(system, k)
            leaving = gain = 0.0
            if goes_on(system, k):
                leaving, gain = numbers[at_sheave.SPEED], numbers[at_sheave.GAIN]
                state[at.PAYOUT] += numbers[at_sheave.PAID]
                state[at.SHEAVE_SPEED], state[at.SHEAVE_ACCELERATION] = leaving, gain
            if has_run(system, k):
                state[at.ACCELERATION] = numbers[at_sheave.INTO_GAIN] - gain
