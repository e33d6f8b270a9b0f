"""The unstretched length within a communication step: a polynomial L + c1 t + c2 t^2 + c3 t^3 of the time.

`winch_control` says what controls the winch:

    speed     the reel-out speed u continues at the rate a = (u - u_last)/h_last, estimated as the acceleration of an end is,
              in the first step and with `input_continuation = held` at the rate 0: the length grows by u t + a t^2/2
    force     the drum turns as its equation of motion says (`drum.py`); it is not known before how the length changes
    length    the length follows its input as a driven end follows its position (`end_motion.py`), from the length and the
              speed that it has reached; the winch starts with the reel-out speed

Where the speed jumps at the start of a step, the rope gains it during the step: a fifth number, the jump over the step
[m/s2], is added to its acceleration in what is due to its mass (`flow.py`). So its momentum is right however speeds come.

A derivative that the importer gives replaces the estimate: of the reel-out speed and of the force its rate, of the length
its speed.

Theory: docs/models/theory.md, "Winch".
"""

from math import sqrt

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..linear_algebra.vectors import NEUTRAL
from .continuation import followed, given_derivative, is_continued
from .end_motion import curve

RATE_OF_LENGTH = 10  # place of the rate of `winch_length` behind `layout.LAST_RATED`


@kernel
def length_at(reeling, time):
    """Unstretched length [m] at a time [s] of the step."""
    return reeling[0] + reeling[1] * time + reeling[2] * time * time + reeling[3] * time * time * time


@kernel
def rate_at(reeling, time):
    """Its rate [m/s] at a time [s] of the step."""
    return reeling[1] + 2.0 * reeling[2] * time + 3.0 * reeling[3] * time * time


@kernel
def acceleration_at(reeling, time):
    """Its second derivative [m/s2] at a time [s] of the step."""
    return 2.0 * reeling[2] + 6.0 * reeling[3] * time


@kernel
def gain_at(reeling, time):
    """Acceleration [m/s2] with which the rope gains its speed: with what it has jumped by at the start of the step."""
    return acceleration_at(reeling, time) + reeling[4]


@kernel
def reel(reeling, step, state):
    """Let a state (modified) have the length, its rate and the rate of that at the end of a communication step [s]."""
    state[at.LENGTH], state[at.REELING] = length_at(reeling, step), rate_at(reeling, step)
    state[at.ACCELERATION] = gain_at(reeling, step)


@kernel
def with_jump(parameters, reeling, step, state):
    """Coefficients of the length in a step of `step` [s] from a state, and the jump of the speed over the step [m/s2]."""
    jump = NEUTRAL if follows_force(parameters) else (reeling[1] - state[at.REELING]) / step
    return reeling[0], reeling[1], reeling[2], reeling[3], jump


@kernel
def jerk_of(reeling):
    """Its third derivative [m/s3]."""
    return 6.0 * reeling[3]


@kernel
def is_reeling(reeling):
    """Whether the unstretched length changes in the step."""
    return reeling[1] != 0.0 or reeling[2] != 0.0 or reeling[3] != 0.0


@kernel
def shortest_length(reeling, step):
    """Least unstretched length [m] during a step [s]: at its end, or where the reeling turns round."""
    _, c1, c2, c3, _ = reeling
    least = length_at(reeling, step)
    square = c2 * c2 - 3.0 * c3 * c1
    if square > 0.0:
        turn = 0.0
        if c2 > 0.0:
            turn = -c1 / (c2 + sqrt(square))
        elif c3 > 0.0:
            turn = (sqrt(square) - c2) / (3.0 * c3)
        if turn > 0.0 and turn < step:
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
    """Whether the length at the start is the one at which the winch is in balance."""
    return follows_force(parameters) and parameters[at.WINCH_START] == at.WINCH_IN_BALANCE


@kernel
def given_length(parameters, inputs, state):
    """Length [m] that the winch should have paid out: `winch_length`; `initial_length` as long as it has been 0."""
    if inputs[at.WINCH_LENGTH] == 0.0 and state[at.LAST_WINCH_LENGTH] == 0.0:
        return parameters[at.INITIAL_LENGTH]
    return inputs[at.WINCH_LENGTH]


@kernel
def first_length(parameters, inputs, state):
    """Unstretched length [m] at the start, with a state that is 0."""
    return given_length(parameters, inputs, state) if follows_length(parameters) else parameters[at.INITIAL_LENGTH]


@kernel
def winch_speed(parameters, inputs, state):
    """Rate of `winch_length` over the last step [m/s]; before the second the speed with which the winch starts."""
    if state[at.LAST_STEP] > 0.0:
        last = state[at.LAST_WINCH_LENGTH] if state[at.LAST_WINCH_LENGTH] != 0.0 else parameters[at.INITIAL_LENGTH]
        return (given_length(parameters, inputs, state) - last) / state[at.LAST_STEP]
    return state[at.REELING]


@kernel
def pulls_only(parameters):
    """Whether the force of the winch can be no less than minus its friction: it has no mass, and holds what it pays out."""
    return parameters[at.WINCH_MASS] == 0.0 and parameters[at.PULLS_BACK] == 0.0


@kernel
def force_rate(parameters, inputs, estimate, step, state):
    """Rate [N/s] at which the force of the winch continues in a step [s], from an estimate.

    A winch without mass can pull only: its force is extrapolated to no less than minus its friction.
    """
    if pulls_only(parameters):
        estimate = max(estimate, -(inputs[at.WINCH_FORCE] + parameters[at.WINCH_FRICTION]) / step)
    return given_derivative(state, at.WINCH_FORCE, estimate)


@kernel
def on_axis(number):
    """A number as a vector, for the functions of driven ends."""
    return number, 0.0, 0.0


@kernel
def following(parameters, inputs, speed, acceleration, correction, state):
    """Coefficients of the length in a step that follows `winch_length` and comes to it in the time `correction` [s].

    speed, acceleration : `winch_speed` [m/s] and its rate [m/s2], which belong to the middle of the last step.
    """
    speed, acceleration = followed(parameters, RATE_OF_LENGTH, speed, acceleration, correction, state)
    length, rate = given_length(parameters, inputs, state), given_derivative(state, at.WINCH_LENGTH, speed)
    given = on_axis(length), on_axis(rate), on_axis(acceleration)
    c0, c1, c2, c3 = curve(on_axis(state[at.LENGTH]), on_axis(state[at.REELING]), *given, correction)
    return c0[0], c1[0], c2[0], c3[0]


@kernel
def reeling_of_step(parameters, inputs, speed, rates, correction, state):
    """Coefficients of the unstretched length [m], [m/s], [m/s2], [m/s3] in a step from a state; see `following`.

    speed : `winch_speed` [m/s].  rates : of the reel-out speed and of that one, estimated [m/s2].
    With a winch that is controlled by force, of a length that stays.
    """
    if parameters[at.TORN_NOW] > 0.0:  # it is braked
        return state[at.LENGTH], 0.0, 0.0, NEUTRAL
    if follows_length(parameters):
        return following(parameters, inputs, speed, rates[1], correction, state)
    if follows_force(parameters):
        return state[at.LENGTH], 0.0, 0.0, NEUTRAL
    acceleration = given_derivative(state, at.REEL_OUT_SPEED, rates[0] if is_continued(parameters) else 0.0)
    return state[at.LENGTH], inputs[at.REEL_OUT_SPEED], 0.5 * acceleration, NEUTRAL
