"""Fixed steps of a chain with the drum of a winch: the stages of `second_order.py`, with its length and speed beside them.

    L1 = L0 + g h u1,   u1 = u0 + g h f(x1, v1, L1, u1)/m,   and so on, as x and v of a node

A stage is a step of `drum_in_backward_euler.py` over g h. Without mass f = 0 in each stage, and what putting driven ends on
their curves leaves of it is taken away by `moving_drum.project`. A step is taken anew by backward Euler where one without a
drum is, and where the drum comes to rest or to a stop, or leaves them, within the step: it then rests, or turns, at its end.
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import MOST_ITERATIONS, STAGES, STIFF
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, NO_LENGTH, OK, STATE_NOT_FINITE

from ..arrays import copy
from ..compilation import kernel, view
from ..equations import segment
from ..equations.boundary import place_ends
from ..equations.drum import INWARDS, OUTWARDS, drum_of, force_at, is_at_stop
from ..equations.properties import property_of, stiffest
from ..linear_algebra.vectors import dot, get, sub
from . import backward_euler, second_order
from .drum_in_backward_euler import Trial, at_end, limits_of, step_in_any_case, subdivided_step, trial_of
from .drum_in_backward_euler import step as implicit_step
from .drum_step import chain_with, first_tension, with_length, with_reeling
from .moving_drum import project
from .second_order import BESIDE, GAMMA, MIDDLE, TO_NEXT, TO_SECOND, TO_THIRD

Motion = namedtuple("Motion", "length speed before")
Motion.__doc__ = "Length [m] and speed [m/s] of the drum; before : its speed in the second stage of the last step [m/s]."


@view
def between(conditions, time, h, length, later):
    """`BoundaryConditions` in which the length [m] changes evenly to a later one in h [s] from a time [s] on."""
    rate = (later - length) / h
    return with_reeling(conditions, (length - rate * time, rate, 0.0, 0.0))


@kernel
def stage(conditions, drum, time, reach, known, length, speed, guess, x, v, b):
    """A stage of `reach` [s] from (x, v) (modified), length [m] and speed [m/s] of its start, at a time [s].

    known : as for `second_order.stage`.  guess : of the speed [m/s].  Returns whether it converged away from stops, the
    iterations, length and speed after it.
    """
    lowest, highest = limits_of(drum, length, reach)
    kind = backward_euler.EXPECTED if known > 0 else backward_euler.STAGE
    trial = Trial(drum, time, reach, length, speed, lowest, highest)
    taken, iterations, found = implicit_step(conditions, trial, kind, MOST_ITERATIONS, guess, x, v, b)
    is_free = found == 0.0 or lowest < found < highest
    return taken and is_free, max(iterations, 0), length + reach * found, found


@kernel
def turns_smoothly(drum, speed, first, second, third):
    """Whether a drum turns, or is held, throughout a step, with its speeds [m/s] at the start and in the stages."""
    if first == 0.0 and second == 0.0 and third == 0.0:
        return drum.mass == 0.0 or speed == 0.0
    if first == 0.0 or second == 0.0 or third == 0.0:
        return False
    if drum.friction == 0.0:
        return True
    return first * second > 0.0 and second * third > 0.0 and (drum.mass == 0.0 or speed * first > 0.0)


@kernel
def power_of_growth(conditions, motion, x, v):
    """Power [W] at most with which the energy of chain and drum grows because not all segments pull as the first one does.

    What the drum pays out lengthens all of them, and only the first one pulls at it; motion : `Motion`.
    """
    chain, power = chain_with(conditions, motion.length, motion.speed), 0.0
    first = first_tension(chain, x, v)
    for s in range(chain.n):
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        rate = dot(e, sub(get(v, s + 1), get(v, s)))
        tension = segment.tension_of(chain, s, segment.BY_LENGTH, length, rate)
        power += abs(property_of(chain, s, at.SHARE) * first - tension * length / chain.length)
    return power * abs(motion.speed)


@kernel
def is_explained(conditions, drum, time, h, start, end, x, v, w):
    """Whether the energy of chain and drum after a step of h [s] is at most that before it and what was put in.

    start, end : `Motion`.
    """
    before, power = second_order.energy_and_power(with_length(conditions, start.length), time, w.x, w.v, w.chain.mass)
    after, later = second_order.energy_and_power(with_length(conditions, end.length), time + h, x, v, w.chain.mass)
    before += 0.5 * drum.mass * start.speed * start.speed
    after += 0.5 * drum.mass * end.speed * end.speed
    motor = 0.5 * (force_at(drum, time) + force_at(drum, time + h)) * (start.length - end.length)
    power += power_of_growth(conditions, start, w.x, w.v) + power_of_growth(conditions, end, x, v)
    rounding = second_order.ROUNDING * (abs(before) + abs(after) + abs(motor))
    return after - before - motor <= h * (power + later) + rounding


@kernel
def stages(conditions, drum, time, h, known, start, x, v, b):
    """`second_order.stages` with a drum from its `Motion` at the start: also returns that at the end."""
    length, speed, before = start
    w, reach = b.steps, GAMMA * h
    copy(x, w.x)
    copy(v, w.v)
    guess = speed
    if known > 0:
        second_order.expect(TO_NEXT[0], known, w)
        guess += TO_NEXT[0] * (speed - before)
    taken, iterations, reached, first = stage(conditions, drum, time, reach, known, length, speed, guess, x, v, b)
    if not taken:
        return False, iterations, start
    even = between(conditions, time, reach, length, reached)
    does_cross = second_order.crosses(even, time, w.x, time + reach, x)
    second_order.go_to_second(x, v, w)
    second_order.expect(TO_NEXT[1], known, w)
    from_length, from_speed = length + TO_SECOND * (reached - length), speed + TO_SECOND * (first - speed)
    onward = length + TO_THIRD * (reached - length) - BESIDE * from_length
    onward_speed = speed + TO_THIRD * (first - speed) - BESIDE * from_speed
    now, guess = time + (MIDDLE - GAMMA) * h, first + TO_NEXT[1] * (first - speed)
    taken, more, reached, second = stage(conditions, drum, now, reach, 1, from_length, from_speed, guess, x, v, b)
    iterations += more
    if not taken:
        return False, iterations, start
    even = between(conditions, time, MIDDLE * h, length, reached)
    does_cross = does_cross or second_order.crosses(even, time, w.x, time + MIDDLE * h, x)
    second_order.go_to_third(x, v, w)
    second_order.expect(TO_NEXT[2], 2, w)
    from_length, from_speed = onward + BESIDE * reached, onward_speed + BESIDE * second
    now, guess = time + (1.0 - GAMMA) * h, second + TO_NEXT[2] * (second - first)
    taken, more, reached, third = stage(conditions, drum, now, reach, 2, from_length, from_speed, guess, x, v, b)
    iterations += more
    end = Motion(reached, third, second)
    if not (taken and turns_smoothly(drum, speed, first, second, third)) or second_order.is_on_ground(conditions, x):
        return False, iterations, start
    place_ends(conditions, time + h, x, v)
    even = between(conditions, time, h, length, reached)
    does_cross = does_cross or second_order.crosses(even, time, w.x, time + h, x)
    is_smooth = not does_cross and iterations <= 2 * STAGES
    return is_smooth or is_explained(conditions, drum, time, h, start, end, x, v, w), iterations, end


@kernel
def step(conditions, method, drum, time, h, known, start, x, v, b):
    """`second_order.step` with a drum from its `Motion` at the start: also returns that at the end.

    At most `limits.WORST_WORK_WITH_DRUM` iterations.
    """
    iterations, way = 0, 1
    has_one_stage = method == at.BACKWARD_EULER
    is_stiff = stiffest(chain_with(conditions, start.length, 0.0)) >= STIFF
    if not (has_one_stage or is_stiff or second_order.is_on_ground(conditions, x)):
        taken, iterations, end = stages(conditions, drum, time, h, known, start, x, v, b)
        if taken:
            return iterations, 0, end
        way = 2
        copy(b.steps.x, x)
        copy(b.steps.v, v)
    more, length, speed = subdivided_step(conditions, drum, time, h, start.length, start.speed, x, v, b)
    return more if more < 0 else iterations + more, way, Motion(length, speed, speed)


@kernel
def balanced(conditions, drum, time, d, end, x, v):
    """`Motion` after a step with T = W + c u + F sign(u) at a time [s], of a drum without mass that turns; a status.

    d : as for `moving_drum.project`.
    """
    length, speed, before = end
    is_held = speed == 0.0 and (
        drum.friction > 0.0 or is_at_stop(drum, length, OUTWARDS) or is_at_stop(drum, length, INWARDS)
    )
    if drum.mass > 0.0 or is_held:
        return end, OK
    direction = INWARDS if speed < 0.0 else OUTWARDS
    length, speed, found = project(conditions, drum, direction, time, d, length, speed, x, v)
    return Motion(length, speed, before), OK if found else NO_LENGTH


@kernel
def integrate(conditions, steps, duration, state, x, v, b):
    """Advance (x, v) (modified) over a communication step of `duration` [s] as `second_order.integrate` does, with a drum.

    b : `drum_in_backward_euler.Workspace`. Length and speed of the drum, the counters in `state` and the unconverged steps
    are modified. Returns a status: OK, FIXED_STEPS_TOO_MANY, STATE_NOT_FINITE or NO_LENGTH.
    """
    budget = at.ITERATION_BUDGET // conditions.n
    count = backward_euler.count_of_steps(steps, duration, budget)
    if count == 0:
        return FIXED_STEPS_TOO_MANY
    h = duration / count
    drum = drum_of(conditions.parameters, conditions.force, conditions.force_rate)
    motion = Motion(state[at.LENGTH], state[at.REELING], state[at.REELING])
    spent, left, known = 0, 0, 0
    b.steps.chain.unconverged[0] = 0.0
    for i in range(count):
        time = i * h
        if spent > STAGES * budget:
            trial = trial_of(drum, time, h, motion.length, motion.speed)
            iterations, speed = step_in_any_case(conditions, trial, x, v, b)
            b.steps.chain.unconverged[0] += 1.0
            way = 1
            length, speed = at_end(trial, speed)
            motion = Motion(length, speed, speed)
        else:
            iterations, way, motion = step(conditions, steps.method, drum, time, h, known, motion, x, v, b)
        if iterations < 0:
            return STATE_NOT_FINITE
        motion, status = balanced(conditions, drum, time + h, GAMMA * h if way == 0 else h, motion, x, v)
        if status != OK:
            return status
        known = 3 if way == 0 else 0
        spent += iterations
        left += 1 if way == 2 else 0
    state[at.LENGTH], state[at.REELING] = motion.length, motion.speed
    state[at.STEPS] += count
    state[at.REJECTIONS] += left
    state[at.ITERATIONS] += spent
    return OK
