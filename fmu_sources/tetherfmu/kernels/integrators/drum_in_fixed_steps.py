"""Backward Euler with the drum of a winch: a secant method for its speed, around the step of the chain.

    m (u - u0)/h = T - W - c u - F sign(u),   L = L0 + h u,   T: first segment at the end of the step

T is found by `backward_euler.careful_step` with a length that changes at the constant rate u. A step ends neither where the
drum comes to rest nor at a stop: a speed that would turn it round under friction is 0, a length beyond a stop is that of
the stop. See docs/models/numerics.md, "A drum in the same system".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, NO_LENGTH, OK, STATE_NOT_FINITE

from ..arrays import copy
from ..compilation import kernel
from ..equations.boundary import BoundaryConditions, place_ends
from ..equations.drum import HELD, INWARDS, OUTWARDS, balance, drum_of, force_at, is_at_stop
from ..equations.properties import property_of
from ..equations.winch import NEUTRAL
from . import backward_euler, secant
from .drum_step import chain_with, first_tension
from .moving_drum import project

MOST_EVALUATIONS = 40  # of the tension for one step
SHARES = 6  # of the budget of iterations that a chain without a drum has: each evaluation is a step of the chain
MOST_REELED = 0.1  # part of the length by which it changes between two of them
CLOSE, ROUNDING = 1e-10, 1e-13  # of the forces; of EA and of the inertia of the length
GOOD_ENOUGH = 1e-6  # of the forces, where the iterations of the chain allow no more

Trial = namedtuple("Trial", "drum time h length speed")
Trial.__doc__ = """A step that is attempted: `Drum`, time [s] within the communication step, h [s], L0 [m] and u0 [m/s]."""


@kernel
def chain_step(conditions, trial, speed, x, v, b):
    """The step of the chain (x, v modified, from b.x, b.v) at a speed [m/s]: iterations (negative: none), tension [N]."""
    n, parameters, ground, kite, low, high, _, force, force_rate, wind, load, load_rate = conditions
    reeling = (trial.length - speed * trial.time, speed, 0.0, NEUTRAL)
    now = BoundaryConditions(n, parameters, ground, kite, low, high, reeling, force, force_rate, wind, load, load_rate)
    copy(b.x, x)
    copy(b.v, v)
    iterations = 0
    if low <= high:
        iterations = backward_euler.careful_step(now, trial.time, trial.h, x, v, b.chain)
    else:
        place_ends(now, trial.time + trial.h, x, v)
    return iterations, first_tension(chain_with(conditions, trial.length + trial.h * speed, speed), x, v)


@kernel
def limits_of(trial):
    """Speeds [m/s] with which the drum would come to its stops in the step, inwards and outwards."""
    return (trial.drum.shortest - trial.length) / trial.h, (trial.drum.longest - trial.length) / trial.h


@kernel
def turn(conditions, trial, direction, x, v, b):
    """The step with a drum that turns in a direction (x, v modified): its speed at the end [m/s], iterations, a status."""
    drum, h = trial.drum, trial.h
    stiffness, end = property_of(conditions, 0, at.STIFFNESS), trial.time + h
    slope = drum.mass / h + drum.damping + (h * stiffness + property_of(conditions, 0, at.DAMPING)) / trial.length
    search, speed = secant.begin(*limits_of(trial), trial.speed, slope)
    forces, spent = 0.0, 0
    for k in range(MOST_EVALUATIONS):
        iterations, tension = chain_step(conditions, trial, speed, x, v, b)
        if iterations < 0:
            if k == 0:
                return speed, spent, STATE_NOT_FINITE
            speed = 0.5 * (speed + search.last)
            continue
        spent += iterations
        pushing = drum.mass * (speed - trial.speed) / h
        residual = pushing - balance(drum, direction, tension, speed, end)
        forces = abs(force_at(drum, end)) + drum.friction + abs(pushing)
        allowed = CLOSE * forces + ROUNDING * (stiffness + drum.mass * abs(speed) / h)
        if abs(residual) <= allowed or secant.is_at_limit(search, speed, residual):
            return speed, spent, OK
        search, onward = secant.go_on(search, speed, residual, MOST_REELED * trial.length / h)
        is_narrow = secant.has_interval(search) and (search.high - search.low) * slope <= GOOD_ENOUGH * forces
        if is_narrow or onward == speed:
            break
        speed = onward
    is_found = secant.has_interval(search) or abs(search.residual) <= GOOD_ENOUGH * forces
    return search.last, spent, OK if is_found else NO_LENGTH


@kernel
def step(conditions, trial, x, v, b):
    """One step of (x, v) (modified): length [m] and speed [m/s] of the drum after it, iterations, a status."""
    drum, h = trial.drum, trial.h
    copy(x, b.x)
    copy(v, b.v)
    spent = 0
    moving = HELD
    if drum.mass > 0.0 and trial.speed != 0.0:
        moving = OUTWARDS if trial.speed > 0.0 else INWARDS
    elif drum.friction == 0.0:
        moving = OUTWARDS
    else:
        iterations, tension = chain_step(conditions, trial, 0.0, x, v, b)
        if iterations < 0:
            return trial.length, 0.0, spent, STATE_NOT_FINITE
        spent += iterations
        excess = tension - force_at(drum, trial.time + h)
        moving = OUTWARDS if excess > drum.friction else INWARDS if excess < -drum.friction else HELD
        if moving == HELD or is_at_stop(drum, trial.length, moving):
            return trial.length, 0.0, spent, OK
    speed, iterations, status = turn(conditions, trial, moving, x, v, b)
    spent += iterations
    if status != OK:
        return trial.length, speed, spent, status
    if drum.friction > 0.0 and speed * moving < 0.0:
        iterations, _ = chain_step(conditions, trial, 0.0, x, v, b)
        return trial.length, 0.0, spent + max(iterations, 0), OK if iterations >= 0 else STATE_NOT_FINITE
    lowest, highest = limits_of(trial)
    length = trial.length + h * speed
    if speed == lowest:
        return drum.shortest, 0.0, spent, OK
    if speed == highest:
        return drum.longest, 0.0, spent, OK
    if drum.mass == 0.0:
        length, speed, found = project(conditions, drum, moving, trial.time + h, h, length, speed, x, v)
        if not found:
            return length, speed, spent, NO_LENGTH
    return length, speed, spent, OK


@kernel
def integrate(conditions, duration, state, x, v, b):
    """Advance (x, v) (modified) over a communication step of `duration` [s] as `second_order.integrate` does, with a drum.

    b : `second_order.Workspace`. All steps are of order 1.
    Its length and speed, the counters in `state` and b.chain.restless are modified. Returns a status: OK,
    FIXED_STEPS_TOO_MANY, STATE_NOT_FINITE or NO_LENGTH.
    """
    budget = at.ITERATION_BUDGET // conditions.n
    count = backward_euler.count_of_steps(conditions, duration, budget)
    if count == 0:
        return FIXED_STEPS_TOO_MANY
    h = duration / count
    drum = drum_of(conditions.parameters, conditions.force, conditions.force_rate)
    length, speed = state[at.LENGTH], state[at.REELING]
    spent = 0
    b.chain.restless[0] = 0.0
    for i in range(count):
        if spent > SHARES * budget:
            return FIXED_STEPS_TOO_MANY
        length, speed, iterations, status = step(conditions, Trial(drum, i * h, h, length, speed), x, v, b)
        if status != OK:
            return status
        spent += iterations
    state[at.LENGTH], state[at.REELING] = length, speed
    state[at.STEPS] += count
    state[at.ITERATIONS] += spent
    return OK
