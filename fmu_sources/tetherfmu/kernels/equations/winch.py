"""Unstretched length within a communication step: a polynomial L + c1 t + c2 t^2 + c3 t^3 of the time.

The polynomial may end within the step; afterwards the length has a constant acceleration (`end_motion.curve`).

`winch_control` selects the quantity that controls the winch:

    speed     the reel-out speed u continues with a = (u - u_last)/h_last, estimated like the acceleration of an end; a = 0
              in the first step and with `input_continuation = held`. The length grows by u t + a t^2/2
    force     the equation of motion of the drum (`drum.py`) determines the length, which is not known in advance
    length    the length follows its input as a driven end follows its position (`end_motion.py`), from its present value
              and rate; the winch starts with the reel-out speed

If the speed jumps at the start of a step, the rope acquires the jump during the step: a fifth number, the jump over the step
[m/s2], is added to the acceleration in inertia terms (`flow.py`). The momentum is therefore right for any speed input.

A derivative set by the importer replaces the estimate: the rate of reel-out speed or force, or the speed of the length.

Theory: docs/models/theory.md, "Winch".
"""

from math import sqrt

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..linear_algebra.vectors import NEUTRAL
from . import past
from .continuation import followed, given_derivative, is_continued
from .end_motion import curve, time_of_correction

ALL_ALONG = 1e300  # [s]: end of a polynomial that covers the whole step


@kernel
def steadily(length, speed, acceleration):
    """Coefficients for a length [m] with constant second derivative [m/s2] throughout the step; rate [m/s]."""
    return length, speed, 0.5 * acceleration, NEUTRAL, NEUTRAL, ALL_ALONG, 0.0


@kernel
def from_length(length, reeling):
    """Shift these coefficients to another initial length [m]."""
    return length, reeling[1], reeling[2], reeling[3], reeling[4], reeling[5], reeling[6]


@kernel
def length_at(reeling, time):
    """Unstretched length [m] at a time [s] of the step."""
    until = min(time, reeling[5])
    length = reeling[0] + reeling[1] * until + reeling[2] * until * until + reeling[3] * until * until * until
    if time > until:
        length += (time - until) * (rate_at(reeling, until) + 0.5 * reeling[6] * (time - until))
    return length


@kernel
def rate_at(reeling, time):
    """Rate of the length [m/s] at a time [s] of the step."""
    until = min(time, reeling[5])
    rate = reeling[1] + 2.0 * reeling[2] * until + 3.0 * reeling[3] * until * until
    return rate + reeling[6] * (time - until) if time > until else rate


@kernel
def acceleration_at(reeling, time):
    """Second derivative of the length [m/s2] at a time [s] of the step."""
    return reeling[6] if time > reeling[5] else 2.0 * reeling[2] + 6.0 * reeling[3] * time


@kernel
def gain_at(reeling, time):
    """Acceleration [m/s2] of the rope, including the jump of its speed at the start of the step."""
    return acceleration_at(reeling, time) + reeling[4]


@kernel
def reel(reeling, step, state):
    """Update the length and its first two derivatives in a state (modified) to the end of a communication step [s]."""
    state[at.LENGTH], state[at.REELING] = length_at(reeling, step), rate_at(reeling, step)
    state[at.ACCELERATION] = gain_at(reeling, step)


@kernel
def with_jump(parameters, reeling, step, state):
    """Coefficients of the length in a step of `step` [s] from a state, and the jump of the speed over the step [m/s2]."""
    jump = NEUTRAL if follows_force(parameters) else (reeling[1] - state[at.REELING]) / step
    return reeling[0], reeling[1], reeling[2], reeling[3], jump, reeling[5], reeling[6]


@kernel
def jerk_at(reeling, time):
    """Third derivative of the length [m/s3] at a time [s] of the step."""
    return 0.0 if time > reeling[5] else 6.0 * reeling[3]


@kernel
def is_reeling(reeling):
    """Whether the unstretched length changes in the step."""
    return reeling[1] != 0.0 or reeling[2] != 0.0 or reeling[3] != 0.0 or reeling[6] != 0.0


@kernel
def shortest_length(reeling, step):
    """Least unstretched length [m] during a step [s]: at its end, or where the reeling reverses."""
    _, c1, c2, c3, _, until, acceleration = reeling
    least = min(length_at(reeling, step), length_at(reeling, min(step, until)))
    if until < step and acceleration > 0.0:
        least = min(least, length_at(reeling, max(until, min(step, until - rate_at(reeling, until) / acceleration))))
    square = c2 * c2 - 3.0 * c3 * c1
    if square > 0.0:
        turn = 0.0
        if c2 > 0.0:
            turn = -c1 / (c2 + sqrt(square))
        elif c3 > 0.0:
            turn = (sqrt(square) - c2) / (3.0 * c3)
        if turn > 0.0 and turn < min(step, until):
            least = min(least, length_at(reeling, turn))
    return least


@kernel
def follows_length(parameters):
    """Whether the winch is controlled by length."""
    return parameters[at.WINCH_CONTROL] == at.WINCH_BY_LENGTH


@kernel
def follows_force(parameters):
    """Whether the winch is controlled by force."""
    return parameters[at.WINCH_CONTROL] == at.WINCH_BY_FORCE


@kernel
def is_sought(parameters):
    """Whether the initial length is solved so that the winch is in balance."""
    return follows_force(parameters) and parameters[at.WINCH_START] == at.WINCH_IN_BALANCE


@kernel
def given_length(parameters, inputs, state):
    """Length input [m] of the winch: `winch_length`, or `initial_length` while that has been 0."""
    if inputs[at.WINCH_LENGTH] == 0.0 and state[at.LAST_WINCH_LENGTH] == 0.0:
        return parameters[at.INITIAL_LENGTH]
    return inputs[at.WINCH_LENGTH]


@kernel
def first_length(parameters, inputs, state):
    """Unstretched length [m] at the start, from a state of zeros."""
    return given_length(parameters, inputs, state) if follows_length(parameters) else parameters[at.INITIAL_LENGTH]


@kernel
def pulls_only(parameters):
    """Whether the winch force cannot fall below minus its friction: the winch is massless and cannot push rope."""
    return parameters[at.WINCH_MASS] == 0.0 and parameters[at.PULLS_BACK] == 0.0


@kernel
def force_rate(parameters, inputs, estimate, step, state):
    """Rate [N/s] at which the winch force continues in a step [s], from an estimate.

    A massless winch can only pull: its force is extrapolated to no less than minus its friction.
    """
    if pulls_only(parameters):
        estimate = max(estimate, -(inputs[at.WINCH_FORCE] + parameters[at.WINCH_FRICTION]) / step)
    return given_derivative(state, at.WINCH_FORCE, estimate)


@kernel
def on_axis(number):
    """A number as a vector, for the functions of driven ends."""
    return number, 0.0, 0.0


@kernel
def following(parameters, inputs, step, state):
    """The length in a step [s] that follows `winch_length` from the value reached, in the format of `reeling_of_step`."""
    length, speed, left = given_length(parameters, inputs, state), state[at.REELING], state[at.CORRECTIONS_LEFT + 2]
    time = max(step, state[at.LAST_STEP], left)
    rate, acceleration = followed(parameters, length, past.LENGTH, speed, time, state)
    rate = given_derivative(state, at.WINCH_LENGTH, rate)
    reached, given = (on_axis(state[at.LENGTH]), on_axis(speed)), (on_axis(length), on_axis(rate))
    time = time_of_correction(*reached, *given, state[at.LAST_STEP], left, time)
    c0, c1, c2, c3, _, _ = curve(*reached, *given, on_axis(acceleration), time)
    return c0[0], c1[0], c2[0], c3[0], NEUTRAL, time, acceleration


@kernel
def reeling_of_step(parameters, inputs, estimate, step, state):
    """The unstretched length in a step [s] from a state: L [m], c1 [m/s], c2 [m/s2], c3 [m/s3], no jump, H [s], a [m/s2].

    H, a : end of the polynomial, and the acceleration after it.  estimate : rate of the reel-out speed [m/s2].
    Constant length for a force-controlled winch.
    """
    if parameters[at.WINCH_IS_BRAKED] != 0.0 or follows_force(parameters):
        return steadily(state[at.LENGTH], 0.0, 0.0)
    if follows_length(parameters):
        return following(parameters, inputs, step, state)
    acceleration = given_derivative(state, at.REEL_OUT_SPEED, estimate if is_continued(parameters) else 0.0)
    return steadily(state[at.LENGTH], inputs[at.REEL_OUT_SPEED], acceleration)
