"""Sheaves, and drums beside them, in fixed steps: how rope runs in the stages of a step, and in backward Euler.

As drums (`turning.py`): the rope psi that has passed a sheave and its speed u go from stage to stage as x and v of a node,

    psi1 = psi0 + g h u1,   u1 = u0 + g h f(x1, v1, psi1, u1)/m,   and so on (`second_order.py`)

and a stage is a step of backward Euler over g h (`points/fixed_sheaves.py`). A step is taken anew by backward Euler where a
sheave begins to run or comes to rest, or where a portion gets as short as it may be. That stops the ropes at its ends, and
nodes take their momentum (`rope_directions.stop_ropes`).
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK, REELED_TOO_SHORT

from ..compilation import kernel
from ..equations import flow, segment
from ..equations.boundary import portion_moving
from ..equations.drum import force_at
from ..equations.lines import conditions_of, hold_length, lines_of, note_line, parameters_of, put_reeling
from ..equations.properties import property_of
from ..equations.ropes import comes_from, goes_on, is_rope, is_turned, stiffness_of
from ..equations.winch import steadily
from ..line.second_order import TO_NEXT, start_of_second, start_of_third
from ..linear_algebra.vectors import dot, get, sub
from ..points import sheave_room as at_sheave
from ..points.coordinates import coordinate_at, count_of, is_drum, own_numbers
from ..points.running_drums import drum_with_lines, has_friction, mass_of_drum
from ..points.sheave_pulls import mass_of
from ..points.sheave_room import (
    drum_numbers_at,
    has_run,
    numbers_at,
    portion_gaining,
    shortest_of,
    speed_in,
    speed_out,
    winch_of,
)
from ..points.sheave_stages import began_at, length_with, place_portions, put_speed
from .rope_directions import begin_directions, has_to_stop, stop_ropes
from .running_ropes import accept_ropes
from .turning import turns_smoothly

# --- a step that is attempted


@kernel
def attempt(system, time, h):
    """Let all ropes (modified) begin a step of h [s] at a time [s] with guesses of their speeds, in STAGE_SPEED."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        numbers = own_numbers(system, c)
        numbers[at_sheave.RUNS], numbers[at_sheave.SIGN] = 1.0, 0.0
        numbers[at_sheave.CHANGE], numbers[at_sheave.IS_FOUND] = 0.0, 0.0
        put_speed(system, c, h, numbers[at_sheave.STAGE_SPEED])
    for k in range(lines_of(system)):
        if has_run(system, k):
            hold_length(system, k, length_with(system, k, at_sheave.REACHED, began_at(system), time))
    place_portions(system, time + h)


@kernel
def begin(system, time):
    """Let a fixed step of all ropes (modified) begin at a time [s]."""
    for k in range(lines_of(system)):
        numbers_at(system, k)[at_sheave.BEGAN] = time
    for j in range(count_of(system)):
        numbers = own_numbers(system, coordinate_at(system, j))
        numbers[at_sheave.REACHED] = numbers[at_sheave.KEEPS] = numbers[at_sheave.PASSED] = 0.0
        numbers[at_sheave.STAGE_SPEED] = numbers[at_sheave.SPEED]


@kernel
def has_inertia(system, c):
    """Whether a coordinate does not jump where friction changes its sign: rope over a sheave, or a drum that has mass."""
    return not is_drum(system, c) or mass_of_drum(system, c) > 0.0


# --- backward Euler


@kernel
def attempt_whole_step(system, time, h):
    """Let all ropes (modified) begin a step of backward Euler of h [s] at a time [s]; friction does not turn them round."""
    begin(system, time)
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if has_friction(system, c) and has_inertia(system, c):
            speed = own_numbers(system, c)[at_sheave.SPEED]
            own_numbers(system, c)[at_sheave.KEEPS] = 0.0 if speed == 0.0 else (1.0 if speed > 0.0 else -1.0)
    attempt(system, time, h)


@kernel
def end_whole_step(system, time, h):
    """Let all ropes (modified) have the result of a step of backward Euler of h [s] from a time [s] on, and stop them."""
    accept_ropes(system, time, h)
    stops = 0
    for j in range(count_of(system)):
        stops += has_to_stop(system, coordinate_at(system, j))
    if stops > 0:
        begin_directions(system)
        stop_ropes(system, time + h)
    rest(system, time + h)


@kernel
def rest(system, time):
    """Let the lengths of all portions (modified) stay as they are at a time [s] after a step, for what looks at it."""
    for k in range(lines_of(system)):
        if has_run(system, k):
            hold_length(system, k, numbers_at(system, k)[at_sheave.LENGTH_NOW])


# --- stages


@kernel
def begin_stage(system, i, time, reach, known):
    """Let all ropes (modified), the results of the stage before, begin stage i of `reach` [s] at a time [s].

    Their speeds in the last stages are continued to a guess; known : of how many of these before the step they are known.
    """
    if i == 0:
        begin(system, time)
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        numbers = own_numbers(system, c)
        speed, passed = numbers[at_sheave.STAGE_SPEED], numbers[at_sheave.PASSED]
        guess = speed + (TO_NEXT[i] * (speed - numbers[at_sheave.BEFORE]) if known > 0 else 0.0)
        numbers[at_sheave.LONG_BEFORE], numbers[at_sheave.BEFORE] = numbers[at_sheave.BEFORE], speed
        start = numbers[at_sheave.START_SPEED]
        if i == 0:
            numbers[at_sheave.START_SPEED] = speed
        elif i == 1:
            numbers[at_sheave.REACHED], numbers[at_sheave.ONWARD_PASSED] = start_of_second(0.0, passed)
            numbers[at_sheave.SPEED], numbers[at_sheave.ONWARD_SPEED] = start_of_second(start, speed)
        else:
            numbers[at_sheave.REACHED] = start_of_third(numbers[at_sheave.ONWARD_PASSED], 0.0, passed)
            numbers[at_sheave.SPEED] = start_of_third(numbers[at_sheave.ONWARD_SPEED], start, speed)
        numbers[at_sheave.STAGE_SPEED] = guess
    attempt(system, time, reach)


@kernel
def end_stage(system, end):
    """Whether no portion has got as short as it may be in a stage to a time [s].

    Lengths of portions (modified) then change evenly from the start of the step to there.
    """
    at_stops, began = 0, began_at(system)
    for j in range(count_of(system)):
        numbers = own_numbers(system, coordinate_at(system, j))
        speed = numbers[at_sheave.STAGE_SPEED]
        at_stops += not (speed == 0.0 or numbers[at_sheave.LOWEST] < speed < numbers[at_sheave.HIGHEST])
    for k in range(lines_of(system)):
        if has_run(system, k):
            numbers = numbers_at(system, k)
            rate = (numbers[at_sheave.LENGTH] - numbers[at_sheave.LENGTH_NOW]) / (end - began)
            put_reeling(system, k, steadily(numbers[at_sheave.LENGTH_NOW] - rate * began, rate, 0.0))
    return at_stops == 0


@kernel
def run_smoothly(system):
    """Whether rope runs over each sheave, or is held, throughout a step whose stages are done."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        numbers = own_numbers(system, c)
        stages = numbers[at_sheave.LONG_BEFORE], numbers[at_sheave.BEFORE], numbers[at_sheave.STAGE_SPEED]
        if not turns_smoothly(has_friction(system, c), has_inertia(system, c), numbers[at_sheave.START_SPEED], *stages):
            return False
    return True


@kernel
def end_stages(system, time, h):
    """Let all ropes (modified) have the result of the stages of a step of h [s] from a time [s] on."""
    accept_ropes(system, time, h)
    rest(system, time + h)


@kernel
def go_back(system):
    """Put all ropes (modified) back to the start of a step of three stages."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        own_numbers(system, c)[at_sheave.SPEED] = own_numbers(system, c)[at_sheave.START_SPEED]


# --- after a step


@kernel
def check(system):
    """OK, or REELED_TOO_SHORT about a portion that its winch has left too short; the plan (modified) says which."""
    for k in range(lines_of(system)):
        if has_run(system, k) and numbers_at(system, k)[at_sheave.LENGTH_NOW] < at.SHORTEST_PART * shortest_of(system, k):
            note_line(system.plan, k)
            return REELED_TOO_SHORT
    return OK


# --- energy


@kernel
def energy_and_power(system, k, is_new, x, v):
    """Kinetic energy [J] of the rope that flows in portion k and of the sheave at its end; most power [W] that comes in.

    The power is that of the winch, and of rope that driven ends hand on. With the nodes at x [m] and velocities v [m/s]
    after the stages of a step, or at its start; the portion (modified) then has the length there.
    """
    conditions, numbers, first = conditions_of(system, k), numbers_at(system, k), not comes_from(system, k)
    chain = portion_gaining(system, k, 1.0)
    if not is_new:
        into = speed_in(system, k, began_at(system), at_sheave.START_SPEED)
        leaving = speed_out(system, k, at_sheave.START_SPEED)
        chain = portion_moving(conditions, numbers[at_sheave.LENGTH_NOW], into - leaving, 0.0, (leaving, 0.0))
    hold_length(system, k, chain.length)
    into, leaving, part, pull, n = chain.reeling + chain.leaving, chain.leaving, 1.0, 0.0, chain.n
    energy = 0.5 * mass_of(system, k) * leaving * leaving if goes_on(system, k) else 0.0
    for s in range(n):
        x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        energy += flow.energy(chain, s, part, x_p, x_q, v_p, v_q)
        length, e = segment.geometry(sub(x_q, x_p))
        pull += abs(segment.tension_of(chain, s, segment.BY_LENGTH, length, dot(e, sub(v_q, v_p)))) * length / chain.length
        part -= property_of(chain, s, at.SHARE)
    density = property_of(chain, 0, at.LINE_DENSITY)
    power = flow.most_power(chain, x, v) + density * abs(leaving) * dot(get(v, n), get(v, n))
    power += density * abs(into) * (into * into + dot(get(v, 0), get(v, 0)))
    if first:
        pull = with_strain_beyond(system, k) if is_turned(system, k) else pull
        power += abs(into) * (pull + density * chain.gravity * abs(x[2]))
    return energy, power


@kernel
def with_strain_beyond(system, k):
    """T^2/(2 EA) [N] where drums pay out line k: what each metre brings beyond what the drums give."""
    tension = max(numbers_at(system, k)[at_sheave.TENSION_IN], 0.0)
    return 0.5 * tension * tension / stiffness_of(system, k)


@kernel
def energy_of_drum(system, k, is_new):
    """Kinetic energy [J] of the drum that line k carries, after the stages of a step, or at its start."""
    numbers = drum_numbers_at(system, k)
    speed = numbers[at_sheave.STAGE_SPEED if is_new else at_sheave.START_SPEED]
    return 0.5 * parameters_of(system, k)[at.WINCH_MASS] * speed * speed


@kernel
def work_of_motors(system, time, h):
    """Work of all motors [J] in the stages of a step of h [s] at a time [s] of the communication step."""
    work = 0.0
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        if is_drum(system, c):
            drum = drum_with_lines(system, c)
            work -= 0.5 * (force_at(drum, time) + force_at(drum, time + h)) * own_numbers(system, c)[at_sheave.PASSED]
    return work


# --- a communication step


@kernel
def end_steps(system):
    """Say of all sheaves (modified) whether rope runs over them at the end of a communication step."""
    for j in range(count_of(system)):
        c = coordinate_at(system, j)
        own_numbers(system, c)[at_sheave.RUNS] = 0.0
    begin_directions(system)


@kernel
def mend(system):
    """Let the lengths of all portions (modified) change again as the conditions of their lines said."""
    for k in range(lines_of(system)):
        if is_rope(system, k):
            put_reeling(system, k, winch_of(system, k))
