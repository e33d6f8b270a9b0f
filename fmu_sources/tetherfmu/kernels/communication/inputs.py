"""What every variant does in a communication step: check the inputs, lead the ends, remember what the next step needs."""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import INPUT_NOT_FINITE, OK, REELED_TOO_SHORT, STATE_NOT_FINITE, STEP_NOT_POSITIVE

from ..algebra.vectors import put, put_at, vector_at
from ..arrays import copy, positions_and_velocities, state_size, trial_state
from ..chain.properties import chain_at, rest_length
from ..compilation import kernel, view
from .driven_end import estimated_acceleration, target


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
    for k in range(state_size(n)):
        if not abs(state[k]) < inf:
            return STATE_NOT_FINITE
    return OK


@kernel
def ends(inputs):
    """Position [m] and velocity [m/s] of the ground end, then of the kite end."""
    return (
        (vector_at(inputs, at.GROUND_POSITION), vector_at(inputs, at.GROUND_VELOCITY)),
        (vector_at(inputs, at.KITE_POSITION), vector_at(inputs, at.KITE_VELOCITY)),
    )


@kernel
def put_ends(n, state, ground, kite):
    """Write position [m] and velocity [m/s] of both ends to a state (modified)."""
    x, v = positions_and_velocities(n, state)
    put(x, 0, ground[0])
    put(v, 0, ground[1])
    put(x, n, kite[0])
    put(v, n, kite[1])


@kernel
def begin(n, parameters, inputs, state):
    """Check the inputs and fill a new state (modified): header and ends; inner nodes at 0. Returns a status."""
    status = check_inputs(inputs)
    if status != OK:
        return status
    for k in range(state_size(n)):
        state[k] = 0.0
    ground, kite = ends(inputs)
    put_ends(n, state, ground, kite)
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
    after = chain_at(n, parameters, state[at.LENGTH] + speed * step, speed, vector_at(inputs, at.WIND_VELOCITY))
    for s in range(n):
        if rest_length(after, s) < at.MIN_SEGMENT_LENGTH:
            return REELED_TOO_SHORT
    return OK


@kernel
def accelerations(inputs, step, state):
    """Accelerations [m/s2] of the ground end and of the kite for a step [s], from the last two velocity inputs."""
    ground, kite = ends(inputs)
    last_ground, last_kite = vector_at(state, at.LAST_GROUND_VELOCITY), vector_at(state, at.LAST_KITE_VELOCITY)
    return (
        estimated_acceleration(ground[1], last_ground, state[at.LAST_STEP], step),
        estimated_acceleration(kite[1], last_kite, state[at.LAST_STEP], step),
    )


@kernel
def move_ends(n, inputs, step, state):
    """Put both ends of a state (modified) where they are led to by the end of the step; for variants without waves."""
    ground, kite = ends(inputs)
    ground_acceleration, kite_acceleration = accelerations(inputs, step, state)
    ground_target = target(ground[0], ground[1], ground_acceleration, step)
    put_ends(n, state, ground_target, target(kite[0], kite[1], kite_acceleration, step))


@kernel
def remember(inputs, step, state):
    """Header of the state (modified) after a communication step of `step` [s]."""
    state[at.LENGTH] += inputs[at.REEL_OUT_SPEED] * step
    state[at.REELING] = inputs[at.REEL_OUT_SPEED]
    state[at.LAST_STEP] = step
    put_at(state, at.WIND, vector_at(inputs, at.WIND_VELOCITY))
    put_at(state, at.LAST_KITE_VELOCITY, vector_at(inputs, at.KITE_VELOCITY))
    put_at(state, at.LAST_GROUND_VELOCITY, vector_at(inputs, at.GROUND_VELOCITY))


@view
def trial_of_step(n, parameters, inputs, step, state, work):
    """Status of `check_step`, and a copy of the state in which the step is tried, so that a refused one leaves no trace."""
    trial = trial_state(n, work)
    copy(state, trial)
    return check_step(n, parameters, inputs, step, state), trial


@kernel
def accept(n, status, trial, state):
    """Take a trial state over into the state (modified) if the status is OK and all of it is finite; returns the status."""
    if status == OK:
        status = check_state(n, trial)
    if status == OK:
        copy(trial, state)
    return status
