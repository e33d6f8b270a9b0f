"""What every variant does around its own part of a start or a step: check the inputs, try on a copy, remember, accept."""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import INPUT_NOT_FINITE, OK, REELED_TOO_SHORT, STATE_NOT_FINITE, STEP_NOT_POSITIVE

from ..algebra.vectors import put_at, vector_at
from ..arrays import copy, state_size, trial_state
from ..chain.properties import chain_at, rest_length
from ..compilation import kernel, view
from .continuation import reel_acceleration, reeled, shortest_reeled, wind_after
from .ends import place_at_start, velocities
from .given_derivatives import use_up
from .plausibility import note_shape, note_step


@kernel
def check_inputs(inputs):
    """OK, or INPUT_NOT_FINITE with the place of the first input that is no finite number or a huge one."""
    for i in range(at.INPUTS):
        if not abs(inputs[i]) <= at.LARGEST_INPUT:
            return INPUT_NOT_FINITE | i << 8
    return OK


@kernel
def check_state(n, state):
    """OK, or STATE_NOT_FINITE."""
    finite = 0
    for k in range(state_size(n)):  # a sum, since a way out of the loop would keep it from being done in pairs
        finite += abs(state[k]) < inf
    return OK if finite == state_size(n) else STATE_NOT_FINITE


@kernel
def begin(n, parameters, inputs, state):
    """Check the inputs and fill a new state (modified): header and ends; inner nodes at 0. Returns a status."""
    status = check_inputs(inputs)
    if status != OK:
        return status
    for k in range(state_size(n)):
        state[k] = 0.0
    place_at_start(n, parameters, inputs, state)
    state[at.LENGTH] = parameters[at.INITIAL_LENGTH]
    state[at.REELING] = inputs[at.REEL_OUT_SPEED]
    put_at(state, at.WIND, vector_at(inputs, at.WIND_VELOCITY))
    return OK


@kernel
def check_step(n, parameters, inputs, step, state):
    """OK, or why a communication step of `step` [s] cannot be: INPUT_NOT_FINITE, STEP_NOT_POSITIVE, REELED_TOO_SHORT."""
    status = check_inputs(inputs)
    if status != OK:
        return status
    if not (step > 0.0 and step <= at.LONGEST_STEP):
        return STEP_NOT_POSITIVE
    speed = inputs[at.REEL_OUT_SPEED]
    acceleration = reel_acceleration(parameters, inputs, step, state)
    least = shortest_reeled(state[at.LENGTH], speed, acceleration, step)
    shortest = chain_at(n, parameters, least, 0.0, vector_at(inputs, at.WIND_VELOCITY))
    for s in range(n):
        if rest_length(shortest, s) < at.MIN_SEGMENT_LENGTH:
            return REELED_TOO_SHORT
    return OK


@kernel
def remember(parameters, inputs, step, state):
    """Header of the state (modified) after a communication step of `step` [s]."""
    ground, kite = velocities(parameters, inputs, state)
    speed, acceleration = inputs[at.REEL_OUT_SPEED], reel_acceleration(parameters, inputs, step, state)
    state[at.LENGTH] = reeled(state[at.LENGTH], speed, acceleration, step)
    state[at.REELING] = speed + acceleration * step
    state[at.LAST_REEL_OUT_SPEED] = speed
    put_at(state, at.LAST_KITE_LOAD, vector_at(inputs, at.KITE_LOAD))
    state[at.STEP_BEFORE] = state[at.LAST_STEP]
    state[at.LAST_STEP] = step
    put_at(state, at.WIND, wind_after(inputs, step, state))
    put_at(state, at.LAST_KITE_VELOCITY, kite)
    put_at(state, at.LAST_GROUND_VELOCITY, ground)
    put_at(state, at.LAST_KITE_POSITION, vector_at(inputs, at.KITE_POSITION))
    put_at(state, at.LAST_GROUND_POSITION, vector_at(inputs, at.GROUND_POSITION))
    use_up(state)


@kernel
def finish_start(n, parameters, status, state):
    """Check a new state if the status is OK, and note in it (modified) what is implausible; returns the status."""
    if status == OK:
        status = check_state(n, state)
    if status == OK:
        note_shape(n, parameters, state)
    return status


@view
def trial_of_step(n, parameters, inputs, step, state, work):
    """Status of `check_step`, and a copy of the state in which the step is tried, so that a refused one leaves no trace."""
    trial = trial_state(n, work)
    copy(state, trial)
    return check_step(n, parameters, inputs, step, state), trial


@kernel
def accept(n, parameters, status, trial, state):
    """Take a trial state over into the state (modified) if the status is OK and all of it is finite; returns the status.

    What is implausible in the step is noted in it.
    """
    if status == OK:
        status = check_state(n, trial)
    if status == OK:
        note_step(n, parameters, state, trial)
        copy(trial, state)
    return status
