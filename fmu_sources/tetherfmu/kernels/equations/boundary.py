"""Boundary conditions of one communication step: how its ends move, its length changes, the wind and a load act.

The inputs are interpreted once per step, for all variants (`inputs_of_step`):

    ends      position p, velocity v and acceleration a that are prescribed, see `end_motion.py`. With `end_velocities =
              given` v is an input; with `derived` it is a difference of positions, and the input is not read
    reeling   a polynomial L + c1 t + c2 t^2 + c3 t^3 of the time within the step, see `winch.py`
    load      on a free kite end: continues like the reel-out speed
    wind      held

A derivative that the importer gives for the step replaces what the tether would estimate: of a velocity the acceleration, of
a position the derived velocity, of the wind the rate 0. Given derivatives wait in the state for the step that consumes them.

A chain with waves needs more: the curves of its ends and what moves freely (`BoundaryConditions`).

Theory: docs/models/theory.md, "Inputs within a step" and "Driven ends".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..linear_algebra.vectors import ZERO_VECTOR, add_scaled, get, put, scale, vector_at
from .continuation import given_derivatives, is_continued
from .end_motion import (
    curve,
    derived_motion,
    difference,
    estimated_acceleration,
    position_at,
    target,
    turning_accelerations,
    velocity_at,
)
from .properties import chain_at
from .winch import length_at, rate_at, reeling_of_step, winch_speed

StepInputs = namedtuple(
    "StepInputs",
    "step ground kite ground_velocity kite_velocity reeling winch_speed wind wind_rate load load_rate",
)
StepInputs.__doc__ = """What the inputs of a communication step mean.

step : its length h [s].
ground, kite : position [m], velocity [m/s] and acceleration [m/s2] prescribed for each end at the start of the step.
ground_velocity, kite_velocity : given or derived, without given derivatives [m/s]: the next step compares its own with them.
reeling : of the unstretched length, see `winch.py`.
winch_speed : rate of `winch_length` over the last step, without given derivatives [m/s].
wind, wind_rate : at the start, at the reference height [m/s], and its constant rate [m/s2].
load, load_rate : force on a free kite end at the start [N], its constant rate [N/s].
"""

BoundaryConditions = namedtuple("BoundaryConditions", "n parameters ground kite first last reeling wind load load_rate")
BoundaryConditions.__doc__ = """A chain and what acts on it during one communication step.

n, parameters : number of segments and flat array of the chain, see `layout.py`.
ground, kite : curves of the driven ends, see `end_motion.curve`.
first, last : first and last node that moves freely.
reeling : of the unstretched length, see `winch.py`.
wind : mean over the step, at the reference height [m/s].
load, load_rate : force on a free kite end at the start [N], its constant rate [N/s].
"""


# --- inputs that continue within a step


@kernel
def load_rate(parameters, inputs, step, state):
    """Rate [N/s] at which the load of a free kite end continues in a step [s]."""
    estimate = ZERO_VECTOR
    if is_continued(parameters):
        last = vector_at(state, at.LAST_KITE_LOAD)
        estimate = estimated_acceleration(vector_at(inputs, at.KITE_LOAD), last, state[at.LAST_STEP], step)
    return given_derivatives(state, at.KITE_LOAD, estimate)


# --- ends


@kernel
def are_derived(parameters):
    """Whether the velocities of the ends come from their positions."""
    return parameters[at.END_VELOCITIES] == at.DERIVED


@kernel
def velocity_of_end(parameters, inputs, state, position, velocity, last_position):
    """Velocity [m/s] of an end: its input, or that over the last step; places of its inputs and of its last position."""
    if are_derived(parameters):
        return difference(vector_at(inputs, position), vector_at(state, last_position), state[at.LAST_STEP])
    return vector_at(inputs, velocity)


@kernel
def end_velocities(parameters, inputs, state):
    """Velocities [m/s] of the ground end and of the kite end, given or derived."""
    return (
        velocity_of_end(parameters, inputs, state, at.GROUND_POSITION, at.GROUND_VELOCITY, at.LAST_GROUND_POSITION),
        velocity_of_end(parameters, inputs, state, at.KITE_POSITION, at.KITE_VELOCITY, at.LAST_KITE_POSITION),
    )


@kernel
def motion_of_end(parameters, inputs, place, velocity, last_velocity, step, state):
    """Position [m], velocity [m/s] and acceleration [m/s2] that are prescribed for an end in a step [s].

    place : of its position among the inputs; its velocity stands behind.  velocity, last_velocity : of `end_velocities`.
    """
    position, last_step = vector_at(inputs, place), state[at.LAST_STEP]
    if are_derived(parameters):
        motion = derived_motion(position, velocity, last_velocity, last_step, state[at.STEP_BEFORE], step)
        position, velocity, acceleration = motion
        velocity = given_derivatives(state, place, velocity)
    else:
        acceleration = estimated_acceleration(velocity, last_velocity, last_step, step)
    return position, velocity, given_derivatives(state, place + 3, acceleration)


@kernel
def put_ends(n, state, ground, kite):
    """Write position [m] and velocity [m/s] of both ends to a state (modified)."""
    x, v = positions_and_velocities(n, state)
    put(x, 0, ground[0])
    put(v, 0, ground[1])
    put(x, n, kite[0])
    put(v, n, kite[1])


@kernel
def place_at_start(n, parameters, inputs, state):
    """Put both ends of a new state (modified, all 0) where the inputs say; a free kite end has its velocity from them."""
    ground, kite = end_velocities(parameters, inputs, state)
    if parameters[at.KITE_IS_FREE] != 0.0:
        kite = vector_at(inputs, at.KITE_VELOCITY)
    ground_position, kite_position = vector_at(inputs, at.GROUND_POSITION), vector_at(inputs, at.KITE_POSITION)
    put_ends(n, state, (ground_position, ground), (kite_position, kite))


@kernel
def move_ends(n, given, state):
    """Put both ends of a state (modified) where they are prescribed at the end of the step; for variants without waves."""
    put_ends(n, state, target(*given.ground, given.step), target(*given.kite, given.step))


# --- the step as a whole


@view
def inputs_of_step(parameters, inputs, step, state):
    """`StepInputs` of a communication step of `step` [s] from a state."""
    ground, kite = end_velocities(parameters, inputs, state)
    last_ground, last_kite = vector_at(state, at.LAST_GROUND_VELOCITY), vector_at(state, at.LAST_KITE_VELOCITY)
    return StepInputs(
        step,
        motion_of_end(parameters, inputs, at.GROUND_POSITION, ground, last_ground, step, state),
        motion_of_end(parameters, inputs, at.KITE_POSITION, kite, last_kite, step, state),
        ground,
        kite,
        reeling_of_step(parameters, inputs, step, state),
        winch_speed(inputs, state),
        vector_at(inputs, at.WIND_VELOCITY),
        given_derivatives(state, at.WIND_VELOCITY, ZERO_VECTOR),
        vector_at(inputs, at.KITE_LOAD),
        load_rate(parameters, inputs, step, state),
    )


@view
def conditions_of_chain(n, parameters, given, state, x, v):
    """`BoundaryConditions` of a chain from `StepInputs`, in a state with node positions x [m] and velocities v [m/s]."""
    ground, kite, step = given.ground, given.kite, given.step
    if state[at.LAST_STEP] <= 0.0 and parameters[at.INITIAL_SHAPE] == at.QUASI_STEADY:
        ground_turns, kite_turns = turning_accelerations(ground, kite, step)
        ground = ground[0], ground[1], given_derivatives(state, at.GROUND_VELOCITY, ground_turns)
        kite = kite[0], kite[1], given_derivatives(state, at.KITE_VELOCITY, kite_turns)
    kite_is_free = parameters[at.KITE_IS_FREE] != 0.0
    return BoundaryConditions(
        n,
        parameters,
        curve(get(x, 0), get(v, 0), *ground, step),
        curve(get(x, n), get(v, n), *kite, step),
        0 if parameters[at.GROUND_IS_FREE] != 0.0 else 1,
        n if kite_is_free else n - 1,
        given.reeling,
        add_scaled(given.wind, 0.5 * step, given.wind_rate),
        scale(1.0 if kite_is_free else 0.0, given.load),
        scale(1.0 if kite_is_free else 0.0, given.load_rate),
    )


@view
def chain_during(conditions, time):
    """The `Chain` at a time [s] of the communication step."""
    length, rate = length_at(conditions.reeling, time), rate_at(conditions.reeling, time)
    return chain_at(conditions.n, conditions.parameters, length, rate, conditions.wind)


@kernel
def load_during(conditions, time):
    """Load [N] on a free kite end at a time [s] of the communication step, else 0."""
    return add_scaled(conditions.load, time, conditions.load_rate)


@kernel
def place_ends(conditions, time, x, v):
    """Put the driven ends into x [m] and v [m/s] (both modified) at a time [s] of the communication step."""
    if conditions.first == 1:
        put(x, 0, position_at(conditions.ground, time))
        put(v, 0, velocity_at(conditions.ground, time))
    if conditions.last == conditions.n - 1:
        put(x, conditions.n, position_at(conditions.kite, time))
        put(v, conditions.n, velocity_at(conditions.kite, time))


@kernel
def hold_ends(conditions, a):
    """Set the vectors of the driven ends to zero in an array of node vectors (modified)."""
    if conditions.first == 1:
        put(a, 0, ZERO_VECTOR)
    if conditions.last == conditions.n - 1:
        put(a, conditions.n, ZERO_VECTOR)
