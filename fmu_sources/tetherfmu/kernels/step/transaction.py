"""Transaction of a start or a step: check the inputs, call the variant on the state, then commit or roll back.

The state is copied once, before a step; a refused step restores it, bit for bit.
"""

from math import inf

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import (
    INPUT_NOT_FINITE,
    NO_EQUILIBRIUM,
    OK,
    REELED_TOO_SHORT,
    START_BEYOND_STOP,
    START_UNDER_GROUND,
    STATE_NOT_FINITE,
    STEP_NOT_POSITIVE,
    WINCH_PUSHES,
    WINCH_TOO_SHORT,
)

from ..arrays import clear, copy, nodes_end, positions_and_velocities
from ..compilation import PARTS, kernel
from ..equations import past, winch, wind_points
from ..equations.boundary import are_derived, inputs_of_step, place_at_start, wind_of
from ..equations.continuation import consume_given_derivatives
from ..equations.ground import has_ground
from ..equations.properties import chain_at, property_of, rest_length
from ..linear_algebra.vectors import ZERO_VECTOR, add_scaled, get, put_at, vector_at
from .plausibility import note_idle_inputs, note_idle_parameters, note_shape, note_step

ROUNDING = 1e-6  # rounding of a force [N] that a controller or extrapolation sets to 0
ROUNDED_LENGTH = 1e-15  # of a length, relative


@kernel
def check_inputs(inputs):
    """OK, or INPUT_NOT_FINITE with the place of the first input that is huge or not a finite number."""
    all_good = True
    for i in range(len(inputs)):  # no early exit, which would prevent vectorization in pairs
        all_good &= abs(inputs[i]) <= at.LARGEST_INPUT
    if all_good:
        return OK
    i = 0
    while abs(inputs[i]) <= at.LARGEST_INPUT:
        i += 1
    return INPUT_NOT_FINITE | i << 8


@kernel
def check_state(n, state):
    """OK, or STATE_NOT_FINITE."""
    finite = 0
    for k in range(nodes_end(n)):  # a sum: an early exit would prevent vectorization in pairs
        finite += abs(state[k]) < inf
    return OK if finite == nodes_end(n) else STATE_NOT_FINITE


@kernel
def start(n, parameters, inputs, state):
    """Check the inputs and fill a new state (modified): header and ends; zeros for inner nodes. Returns a status."""
    status = check_inputs(inputs)
    if status != OK:
        return status
    clear(state)
    place_at_start(n, parameters, inputs, state)
    state[at.LENGTH] = winch.first_length(parameters, inputs, state)
    remember_positions(inputs, state)
    past.begin_past(state[at.LENGTH], state)
    state[at.REELING] = state[at.LAST_REEL_OUT_SPEED] = inputs[at.REEL_OUT_SPEED]
    state[at.PEAK_SO_FAR] = at.NO_TENSION
    put_at(state, at.WIND, wind_of(inputs))
    wind_points.start(n, parameters, inputs, state)
    if not winch.follows_force(parameters):
        return check_length(n, parameters, state[at.LENGTH])
    is_between = parameters[at.SHORTEST_LENGTH] <= state[at.LENGTH] <= parameters[at.LONGEST_LENGTH]
    return OK if is_between or winch.is_sought(parameters) else START_BEYOND_STOP


@kernel
def check_free_ends(n, parameters, state):
    """OK, or START_UNDER_GROUND with the place of the height of a free end that starts below a flat ground."""
    if has_ground(parameters):
        x, _ = positions_and_velocities(n, state)
        lowest = parameters[at.GROUND_HEIGHT] - parameters[at.GROUND_SINK] - at.DEEPEST_START
        if parameters[at.KITE_IS_FREE] != 0.0 and get(x, n)[2] < lowest:
            return START_UNDER_GROUND | (at.KITE_POSITION + 2) << 8
        if parameters[at.GROUND_IS_FREE] != 0.0 and get(x, 0)[2] < lowest:
            return START_UNDER_GROUND | (at.GROUND_POSITION + 2) << 8
    return OK


@kernel
def commit_start(n, parameters, inputs, status, state):
    """Check a new state if the status is OK, and note implausible behaviour in it (modified); returns the status."""
    if status == OK:
        status = check_state(n, state)
    if status in (OK, NO_EQUILIBRIUM):  # a free end below the ground causes NO_EQUILIBRIUM
        under = check_free_ends(n, parameters, state)
        status = under if under != OK else status
    if status == OK:
        note_shape(n, parameters, state)
        note_idle_inputs(parameters, inputs, state)
        note_idle_parameters(parameters, state)
    return status


@kernel
def begin(n, parameters, inputs, step, is_mean, state):
    """OK, or the reason to refuse a communication step of `step` [s]; and its `StepInputs`, valid on OK only.

    On OK, the header of the state and its wind points (modified) are advanced; is_mean : see `wind_points`.
    """
    given = inputs_of_step(n, parameters, inputs, step, state)
    status = check_inputs(inputs)
    if status == OK:
        status = check_step(n, parameters, given)
    if status == OK:
        note_idle_inputs(parameters, inputs, state)
        remember(parameters, inputs, given, state)
        wind_points.advance(n, parameters, inputs, step, is_mean, state)
    return status, given


@kernel
def check_length(n, parameters, length):
    """OK, or REELED_TOO_SHORT or WINCH_TOO_SHORT if an unstretched length [m] has too short segments."""
    chain = chain_at(n, parameters, length, 0.0, ZERO_VECTOR)
    least = at.MIN_SEGMENT_LENGTH - ROUNDED_LENGTH * parameters[at.LENGTH_BEYOND]
    for s in range(n):
        if rest_length(chain, s) < least and not (PARTS and chain.is_parted and property_of(chain, s, at.SHARE) <= 0.0):
            return WINCH_TOO_SHORT if winch.follows_length(parameters) else REELED_TOO_SHORT
    return OK


@kernel
def check_step(n, parameters, given):
    """OK, or the reason to refuse a step with `StepInputs`: its length, or the inputs of a winch."""
    if not (given.step > 0.0 and given.step <= at.LONGEST_STEP):
        return STEP_NOT_POSITIVE
    if not winch.follows_force(parameters):
        length = winch.shortest_length(given.reeling, given.step)
        if parameters[at.IS_PORTION] != 0.0:
            length *= 1.0 + at.ROUNDED_STOP
        return check_length(n, parameters, length)
    least = min(given.force, given.force + given.step * given.force_rate)
    if winch.pulls_only(parameters) and least < -parameters[at.WINCH_FRICTION] - ROUNDING:
        return WINCH_PUSHES
    return OK


@kernel
def remember_positions(inputs, state):
    """Store the position inputs of both ends and of the winch in a state (modified)."""
    put_at(state, at.LAST_KITE_POSITION, vector_at(inputs, at.KITE_POSITION))
    put_at(state, at.LAST_GROUND_POSITION, vector_at(inputs, at.GROUND_POSITION))
    state[at.LAST_WINCH_LENGTH] = inputs[at.WINCH_LENGTH]


@kernel
def remember_past(parameters, inputs, step, state):
    """Store the positions at the start of a communication step [s] in the state of its start (modified), for later steps."""
    length = winch.given_length(parameters, inputs, state)
    remember_positions(inputs, state)
    by_length = winch.follows_length(parameters)
    if by_length and state[at.LAST_STEP] <= 0.0:
        past.begin_moving(length, state[at.REELING], step, state)
    if by_length or are_derived(parameters):
        past.keep_past(length, step, state)


@kernel
def remember(parameters, inputs, given, state):
    """Header of the state (modified) after a communication step with `StepInputs`.

    The variant sets length and speed of a force-controlled winch.
    """
    step = given.step
    remember_past(parameters, inputs, step, state)
    if not winch.follows_force(parameters):
        winch.reel(given.reeling, step, state)
    for k in range(len(given.rated)):
        put_at(state, at.LAST_RATED + 3 * k, given.rated[k])
        put_at(state, at.RECENT_RATES + 3 * k, given.recent[k])
    state[at.LAST_STEP] = step
    state[at.PEAK_SO_FAR] = at.NO_TENSION
    state[at.LONGEST_SO_FAR] = max(state[at.LONGEST_SO_FAR], step)
    for k in range(3):
        state[at.CORRECTIONS_LEFT + k] = max(0.0, given.corrections[k] - step)
    state[at.CLOCK] += step
    put_at(state, at.WIND, add_scaled(given.wind, step, given.wind_rate))
    consume_given_derivatives(state)


@kernel
def commit(n, parameters, status, before, state):
    """End a step: note implausible behaviour if the status is OK and the state is finite, otherwise roll back.

    state (modified) : after the step.  before : the state before it.  Returns the status.
    """
    if status == OK:
        status = check_state(n, state)
    if status == OK:
        note_step(n, parameters, before, state)
    else:
        copy(before, state)
    return status
