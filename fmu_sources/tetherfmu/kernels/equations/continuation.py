"""Continuation of inputs within a step, and the derivatives that the importer sets for it.

A given derivative replaces the estimate of the tether. Given derivatives are stored in the state until a step consumes
them. Theory: docs/models/theory.md, "Inputs within a step".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from .past import extrapolated


@kernel
def given_derivative(state, place, estimate):
    """Derivative of the input at a place [unit/s]: the importer's, or else the estimate."""
    given = state[at.GIVEN_DERIVATIVES]
    if given != 0.0 and int(given) >> place & 1 == 1:  # nearly always 0
        return state[at.INPUT_DERIVATIVES + place]
    return estimate


@kernel
def given_derivatives(state, place, estimates):
    """`given_derivative` of three inputs from a place on."""
    if state[at.GIVEN_DERIVATIVES] == 0.0:
        return estimates
    return (
        given_derivative(state, place, estimates[0]),
        given_derivative(state, place + 1, estimates[1]),
        given_derivative(state, place + 2, estimates[2]),
    )


@kernel
def consume_given_derivatives(state):
    """Clear the given derivatives in the state (modified)."""
    if state[at.GIVEN_DERIVATIVES] != 0.0:
        for k in range(at.GIVEN_DERIVATIVES, at.INPUT_DERIVATIVES + at.INPUTS):
            state[k] = 0.0


@kernel
def is_continued(parameters):
    """Whether inputs continue linearly within a step (otherwise they are held constant)."""
    return parameters[at.INPUT_CONTINUATION] != at.HELD


@kernel
def followed(parameters, position, k, speed, time, state):
    """Velocity [m/s] and acceleration [m/s2] of a quantity known by positions [m] only, for the next `time` [s].

    k : its place among the numbers of `past`.  speed : in the first step [m/s]; with `input_continuation = held` the
    position is constant in all other steps.
    """
    if state[at.LAST_STEP] <= 0.0:
        return speed, 0.0
    if not is_continued(parameters):
        return 0.0, 0.0
    return extrapolated(position, k, time, state)
