"""Derivatives of inputs that the importer gives for one communication step; they replace what the tether would estimate.

They wait in the state for the next step, which uses them up.
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel


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
def use_up(state):
    """Forget the given derivatives in the state (modified)."""
    if state[at.GIVEN_DERIVATIVES] != 0.0:
        for k in range(at.GIVEN_DERIVATIVES, at.INPUT_DERIVATIVES + at.INPUTS):
            state[k] = 0.0
