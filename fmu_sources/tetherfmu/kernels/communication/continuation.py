"""How inputs go on within a communication step: with the derivative that the importer gives, else from the last two of them.

With `input_continuation = linear` an input u of a step of length h has the rate (u - u_last)/max(h_last, h/4), in the first
step 0; with `held` it is 0. The wind is held unless its derivative is given. The unstretched length of a tether that reels
at u + a t grows by u t + a t^2/2.

Theory: docs/theory.md, "Inputs within a step".
"""

from tetherfmu.runtime import layout as at

from ..algebra.vectors import along, vector_at
from ..compilation import kernel
from .driven_end import estimated_acceleration, per_last_step
from .given_derivatives import given_derivative, given_derivatives


@kernel
def goes_on(parameters):
    """Whether inputs go on linearly within a step, and are not held."""
    return parameters[at.INPUT_CONTINUATION] != at.HELD


@kernel
def reel_acceleration(parameters, inputs, step, state):
    """Rate [m/s2] at which the reel-out speed goes on in a step [s]."""
    estimate = 0.0
    if goes_on(parameters) and state[at.LAST_STEP] > 0.0:
        change = inputs[at.REEL_OUT_SPEED] - state[at.LAST_REEL_OUT_SPEED]
        estimate = change * per_last_step(state[at.LAST_STEP], step)
    return given_derivative(state, at.REEL_OUT_SPEED, estimate)


@kernel
def load_rate(parameters, inputs, step, state):
    """Rate [N/s] at which the load of a free kite end goes on in a step [s]."""
    estimate = (0.0, 0.0, 0.0)
    if goes_on(parameters):
        last = vector_at(state, at.LAST_KITE_LOAD)
        estimate = estimated_acceleration(vector_at(inputs, at.KITE_LOAD), last, state[at.LAST_STEP], step)
    return given_derivatives(state, at.KITE_LOAD, estimate)


@kernel
def wind_after(inputs, time, state):
    """Wind [m/s] at a time [s] of a step."""
    return along(vector_at(inputs, at.WIND_VELOCITY), time, given_derivatives(state, at.WIND_VELOCITY, (0.0, 0.0, 0.0)))


@kernel
def reeled(length, speed, acceleration, time):
    """Unstretched length [m] after a time [s], from the length [m], speed [m/s] and its rate [m/s2] at the start."""
    return length + speed * time + 0.5 * acceleration * time * time


@kernel
def shortest_reeled(length, speed, acceleration, step):
    """Least unstretched length [m] during a step [s]: at its end, or where the reeling turns round."""
    least = reeled(length, speed, acceleration, step)
    if speed < 0.0 and speed + acceleration * step > 0.0:
        least = min(least, reeled(length, speed, acceleration, -speed / acceleration))
    return least
