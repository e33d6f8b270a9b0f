"""The drums in fixed steps: how all of them turn in the stages of a step, and in backward Euler.

The laws of one drum are those of `drum_in_fixed_steps.py` and `drum_in_backward_euler.py`. What makes a step of one drum one
of backward Euler makes that of the whole system one.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..compilation import kernel, view
from ..equations.drum import force_at
from ..equations.lines import conditions_of, lines_of, motion_of, put_reeling, state_of
from ..equations.plan import note_line
from ..line import drum_in_backward_euler as of_one
from ..line.drum_in_fixed_steps import Motion, balanced, power_of_growth, turns_smoothly
from ..line.second_order import BESIDE, TO_NEXT, TO_SECOND, TO_THIRD
from ..linear_algebra.vectors import NEUTRAL
from ..points.system_drums import drum_at, length_of
from ..points.system_fixed_room import (
    BEFORE,
    CHANGE,
    FIRST,
    FROM_LENGTH,
    FROM_SPEED,
    HIGHEST,
    IS_FOUND,
    LOWEST,
    ONWARD_LENGTH,
    ONWARD_SPEED,
    REACHED,
    SECOND,
    SPEED,
    room_in_fixed_steps,
    trial_of_line,
)
from ..points.system_room import has_drum

# --- a step that is attempted


@kernel
def attempt(system, k, start, limits, guess):
    """Let the drum of line k (modified) begin a step from its length [m] and speed [m/s], with a guess of its speed [m/s].

    limits : of the speed [m/s].
    """
    numbers = room_in_fixed_steps(system, k).numbers
    numbers[FROM_LENGTH], numbers[FROM_SPEED] = start
    lowest, highest = limits
    numbers[LOWEST], numbers[HIGHEST] = lowest, highest
    numbers[SPEED], numbers[CHANGE], numbers[IS_FOUND] = min(highest, max(lowest, guess)), 0.0, 0.0
    put_reeling(system, k, (start[0], 0.0, 0.0, NEUTRAL))


@kernel
def change_evenly(system, k, time, h, length, later):
    """Let the length [m] of line k (modified) change to a later one in h [s] from a time [s] of the step on."""
    rate = (later - length) / h
    put_reeling(system, k, (length - rate * time, rate, 0.0, 0.0))


# --- backward Euler


@kernel
def attempt_whole_step(system, time, h):
    """Let all drums (modified) begin a step of backward Euler of h [s] at a time [s] of the communication step."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            start, drum = length_of(system, k), drum_at(conditions_of(system, k))
            trial = of_one.trial_of(drum, time, h, *start)
            attempt(system, k, start, (trial.lowest, trial.highest), start[1])


@kernel
def end_whole_step(system, step):
    """Let all drums (modified) have the result of a step of backward Euler."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            state, speed = state_of(system, k), room_in_fixed_steps(system, k).numbers[SPEED]
            state[at.LENGTH], state[at.REELING] = of_one.at_end(trial_of_line(system, k, step), speed)


@kernel
def turn_evenly(system, step):
    """Let all drums (modified) turn with the speeds of the iteration throughout a step, for lines that move alone."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers = room_in_fixed_steps(system, k).numbers
            length, speed = numbers[FROM_LENGTH], numbers[SPEED]
            put_reeling(system, k, (length - speed * step.time, speed, 0.0, NEUTRAL))


# --- stages


@kernel
def attempt_stage(system, reach, start, guess, k):
    """Let the drum of line k (modified) begin a stage of `reach` [s]; other arguments as of `attempt`."""
    limits = of_one.limits_of(drum_at(conditions_of(system, k)), start[0], reach)
    attempt(system, k, start, limits, guess)


@kernel
def go_to_first(system, reach, known):
    """Let all drums (modified) begin the first stage of `reach` [s]; known : as for `fixed_steps.stage`."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            length, speed = length_of(system, k)
            guess = speed
            if known > 0:
                guess += TO_NEXT[0] * (speed - room_in_fixed_steps(system, k).numbers[BEFORE])
            attempt_stage(system, reach, (length, speed), guess, k)


@kernel
def go_to_second(system, reach):
    """Let all drums (modified), the results of the first stage, begin the second one."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, (length, speed) = room_in_fixed_steps(system, k).numbers, length_of(system, k)
            reached, first = numbers[REACHED], numbers[SPEED]
            from_length, from_speed = length + TO_SECOND * (reached - length), speed + TO_SECOND * (first - speed)
            numbers[ONWARD_LENGTH] = length + TO_THIRD * (reached - length) - BESIDE * from_length
            numbers[ONWARD_SPEED] = speed + TO_THIRD * (first - speed) - BESIDE * from_speed
            numbers[FIRST] = first
            attempt_stage(system, reach, (from_length, from_speed), first + TO_NEXT[1] * (first - speed), k)


@kernel
def go_to_third(system, reach):
    """Let all drums (modified), the results of the second stage, begin the third one."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers = room_in_fixed_steps(system, k).numbers
            first, second = numbers[FIRST], numbers[SPEED]
            from_length = numbers[ONWARD_LENGTH] + BESIDE * numbers[REACHED]
            from_speed = numbers[ONWARD_SPEED] + BESIDE * second
            numbers[SECOND] = second
            attempt_stage(system, reach, (from_length, from_speed), second + TO_NEXT[2] * (second - first), k)


@kernel
def end_stage(system, time, h, reach):
    """Lengths of all drums after a stage of `reach` [s] (modified); whether none has come to a stop.

    From then on the lengths of their lines change evenly from the start of the step to there: h [s] from its time [s] on.
    """
    at_stops = 0
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, (length, _) = room_in_fixed_steps(system, k).numbers, length_of(system, k)
            speed = numbers[SPEED]
            at_stops += not (speed == 0.0 or numbers[LOWEST] < speed < numbers[HIGHEST])
            numbers[REACHED] = numbers[FROM_LENGTH] + reach * speed
            change_evenly(system, k, time, h, length, numbers[REACHED])
    return at_stops == 0


@kernel
def turn_smoothly(system):
    """Whether each drum turns, or is held, throughout a step whose stages are done."""
    others = 0
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, (_, speed) = room_in_fixed_steps(system, k).numbers, length_of(system, k)
            stages = numbers[FIRST], numbers[SECOND], numbers[SPEED]
            others += not turns_smoothly(drum_at(conditions_of(system, k)), speed, *stages)
    return others == 0


@kernel
def end_stages(system):
    """Let all drums (modified) have the results of a step whose stages are done."""
    for k in range(lines_of(system)):
        if has_drum(system, k):
            numbers, state = room_in_fixed_steps(system, k).numbers, state_of(system, k)
            state[at.LENGTH], state[at.REELING] = numbers[REACHED], numbers[SPEED]
            numbers[BEFORE] = numbers[SECOND]


# --- energy


@view
def motion_in_stages(system, k, is_new):
    """`Motion` of the drum of line k after the stages of a step, or at its start."""
    numbers, (length, speed) = room_in_fixed_steps(system, k).numbers, length_of(system, k)
    if is_new:
        length, speed = numbers[REACHED], numbers[SPEED]
    return Motion(length, speed, speed)


@kernel
def hold_length(system, k, is_new):
    """Let the length of line k (modified) stay as it is after the stages of a step, or at its start."""
    put_reeling(system, k, (motion_in_stages(system, k, is_new).length, 0.0, 0.0, NEUTRAL))


@kernel
def energy_and_power(system, k, is_new, x, v):
    """Energy of the drum of line k [J] and the power of growth [W], see `drum_in_fixed_steps.power_of_growth`.

    With the nodes at x [m] and velocities v [m/s] after the stages of a step, or at its start.
    """
    conditions, motion = conditions_of(system, k), motion_in_stages(system, k, is_new)
    energy = 0.5 * drum_at(conditions).mass * motion.speed * motion.speed
    return energy, power_of_growth(conditions, motion, x, v)


@kernel
def work_of_motors(system, time, h):
    """Work of all motors [J] in the stages of a step of h [s] at a time [s] of the communication step."""
    work = 0.0
    for k in range(lines_of(system)):
        if has_drum(system, k):
            drum = drum_at(conditions_of(system, k))
            start, end = motion_in_stages(system, k, False), motion_in_stages(system, k, True)
            work += 0.5 * (force_at(drum, time) + force_at(drum, time + h)) * (start.length - end.length)
    return work


# --- drums without mass


@kernel
def balance(system, time, d):
    """`drum_in_fixed_steps.balanced` of all drums (modified) at a time [s] of the communication step; a status.

    The plan (modified) then says which line it is about.
    """
    for k in range(lines_of(system)):
        if has_drum(system, k):
            conditions, state = conditions_of(system, k), state_of(system, k)
            x, v = motion_of(system, k)
            start = Motion(state[at.LENGTH], state[at.REELING], state[at.REELING])
            end, status = balanced(conditions, drum_at(conditions), time, d, start, x, v)
            if status != OK:
                note_line(system.plan, k)
                return status
            state[at.LENGTH], state[at.REELING] = end.length, end.speed
    return OK
