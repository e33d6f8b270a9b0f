"""How inputs continue within a step, and the derivatives that the importer gives for it.

A given derivative replaces what the tether would estimate. Given derivatives wait in the state for the step that consumes
them. Theory: docs/models/theory.md, "Inputs within a step".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from .end_motion import limited_motion


@kernel
def given_derivative(state, place, estimate):
    """Derivative of the input at a place [unit/s]: the given one, else the estimate."""
    given = state[at.GIVEN_DERIVATIVES]
    if given != 0.0 and int(given) >> place & 1 == 1:  # nearly always 0
        return state[at.INPUT_DERIVATIVES + place]
    return estimate


@kernel
def given_derivatives(state, place, estimates):
    """The same of the three inputs from a place on."""
    if state[at.GIVEN_DERIVATIVES] == 0.0:
        return estimates
    return (
        given_derivative(state, place, estimates[0]),
        given_derivative(state, place + 1, estimates[1]),
        given_derivative(state, place + 2, estimates[2]),
    )


@kernel
def consume_given_derivatives(state):
    """Forget the given derivatives in the state (modified)."""
    if state[at.GIVEN_DERIVATIVES] != 0.0:
        for k in range(at.GIVEN_DERIVATIVES, at.INPUT_DERIVATIVES + at.INPUTS):
            state[k] = 0.0


@kernel
def is_continued(parameters):
    """Whether inputs continue linearly within a step, and are not held."""
    return parameters[at.INPUT_CONTINUATION] != at.HELD


@kernel
def followed(parameters, k, rate, acceleration, correction, state):
    """Velocity [m/s] and acceleration [m/s2] of what is known by positions only, after the time `correction` [s].

    k : place of its rate [m/s] behind `layout.LAST_RATED`.  acceleration : of `rates_of_inputs` [m/s2].  With
    `input_continuation = held` it stays where it is. In its first step and in its second there is nothing to compare with.
    """
    last, before = state[at.LAST_STEP], state[at.STEP_BEFORE]
    if last > 0.0 and not is_continued(parameters):
        return 0.0, 0.0
    if before <= 0.0:
        return rate + 0.5 * last * acceleration, acceleration
    known = state[at.LAST_RATED + k], state[at.RECENT_RATES + k]
    return limited_motion(rate, known[0], acceleration, known[1], last, correction)
