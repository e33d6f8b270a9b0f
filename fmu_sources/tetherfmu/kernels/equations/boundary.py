"""Boundary conditions of one communication step: motion of the ends, length, wind and load.

The inputs are interpreted once per step, for all variants (`inputs_of_step`):

    ends      prescribed position p, velocity v and acceleration a, see `end_motion.py`. With `end_velocities = given` v is
              an input; with `derived` it is computed from positions (`past.py`), and the input is not read
    reeling   a polynomial L + c1 t + c2 t^2 + c3 t^3 of the time within the step, see `winch.py`
    load      on a free kite end: extrapolated like the reel-out speed, as is the winch force
    wind      held constant

A derivative that the importer sets for the step replaces an estimate: the acceleration for a velocity input, the derived
velocity for a position input, the rate 0 for the wind. Given derivatives are stored in the state until a step consumes them.

A chain with waves also needs the curves of its ends and its free nodes (`BoundaryConditions`).

Theory: docs/models/theory.md, "Inputs within a step" and "Driven ends".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..linear_algebra.vectors import ZERO_VECTOR, add_scaled, get, norm, put, scale, sub, vector_at
from . import past, segment
from .continuation import followed, given_derivatives, is_continued
from .end_motion import (
    centripetal_accelerations,
    curve,
    estimated_rates,
    position_at,
    target,
    time_of_correction,
    velocity_at,
)
from .properties import chain_in_motion, chain_of, portion_in_motion
from .winch import follows_length, force_rate, gain_at, length_at, rate_at, reeling_of_step, with_jump

StepInputs = namedtuple(
    "StepInputs",
    "step corrections ground kite reeling force force_rate wind wind_rate load load_rate rated recent",
)
StepInputs.__doc__ = """Interpreted inputs of a communication step.

step, corrections : its length h and the correction times H of ground end, kite end and length [s].
ground, kite : position [m], velocity [m/s] and acceleration [m/s2] prescribed for each end at the start of the step.
reeling : of the unstretched length, see `winch.py`.
force, force_rate : of the winch at the start [N], its constant rate [N/s].
wind, wind_rate : at the start, at the reference height [m/s], and its constant rate [m/s2].
load, load_rate : force on a free kite end at the start [N], its constant rate [N/s].
rated : values from which the next step estimates rates, four vectors: velocity inputs of the kite end and of the
ground end [m/s]; load [N]; reel-out speed [m/s], winch force [N], unused.
recent : their rates, used by the next steps after a much shorter one."""

BoundaryConditions = namedtuple(
    "BoundaryConditions", "n parameters ground kite first last reeling force force_rate wind load load_rate"
)
BoundaryConditions.__doc__ = """A chain and the conditions on it during one communication step.

n, parameters : number of segments and flat array of the chain, see `layout.py`.
ground, kite : curves of the driven ends, see `end_motion.curve`.
first, last : first and last free node.
reeling : of the unstretched length, see `winch.py`.
force, force_rate : of a force-controlled winch, at the start [N], its constant rate [N/s].
wind : mean over the step, at the reference height [m/s].
load, load_rate : force on a free kite end at the start [N], its constant rate [N/s]."""


@kernel
def wind_of(inputs):
    """Wind input [m/s] at the reference height, regardless of wind points."""
    return vector_at(inputs, at.WIND_VELOCITY)


# --- ends


@kernel
def are_derived(parameters):
    """Whether the end velocities are derived from positions."""
    return parameters[at.END_VELOCITIES] == at.DERIVED


@view
def rates_of_inputs(rated, step, state):
    """Estimated rates of the `rated` inputs (see `StepInputs`) for a step [s]: as many vectors."""
    return (
        rates_from(0, rated[0], step, state),
        rates_from(1, rated[1], step, state),
        rates_from(2, rated[2], step, state),
        rates_from(3, rated[3], step, state),
    )


@view
def rates_from(k, now, step, state):
    """Rates of vector k of the `rated` inputs, from its present value."""
    times = state[at.LAST_STEP], state[at.LAST_STEP], state[at.LAST_STEP]
    last, recent = vector_at(state, at.LAST_RATED + 3 * k), vector_at(state, at.RECENT_RATES + 3 * k)
    return estimated_rates(now, last, recent, times, state[at.LONGEST_SO_FAR], step)


@kernel
def motion_of_end(parameters, inputs, place, k, acceleration, time, state):
    """Prescribed position [m], velocity [m/s] and acceleration [m/s2] of an end at the start of a step.

    place : of its position among the inputs; its velocity follows.  k : its place among the numbers of `past`.
    acceleration : from `rates_of_inputs`.  time : correction time [s].
    """
    position, velocity = vector_at(inputs, place), vector_at(inputs, place + 3)
    if are_derived(parameters):
        x = followed(parameters, position[0], k, 0.0, time, state)
        y = followed(parameters, position[1], k + 1, 0.0, time, state)
        z = followed(parameters, position[2], k + 2, 0.0, time, state)
        velocity, acceleration = given_derivatives(state, place, (x[0], y[0], z[0])), (x[1], y[1], z[1])
    return position, velocity, given_derivatives(state, place + 3, acceleration)


@kernel
def correction_of_end(x, v, i, given, left, time, state):
    """Time [s] in which node i of a chain returns to its prescribed motion, see `time_of_correction`.

    x, v : of all nodes [m], [m/s].  given : from `motion_of_end`.  left, time : [s]
    """
    return time_of_correction(get(x, i), get(v, i), given[0], given[1], state[at.LAST_STEP], left, time)


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
    """Put both ends of a new state (modified, all 0) at their input positions, a free kite end with its input velocity."""
    ground, kite = vector_at(inputs, at.GROUND_VELOCITY), vector_at(inputs, at.KITE_VELOCITY)
    if are_derived(parameters):
        ground, kite = ZERO_VECTOR, kite if parameters[at.KITE_IS_FREE] != 0.0 else ZERO_VECTOR
    ground_position, kite_position = vector_at(inputs, at.GROUND_POSITION), vector_at(inputs, at.KITE_POSITION)
    put_ends(n, state, (ground_position, ground), (kite_position, kite))


@kernel
def move_ends(n, given, state):
    """Move both ends of a state (modified) to their prescribed motion at the end of the step; for variants without waves."""
    put_ends(n, state, target(*given.ground, given.step), target(*given.kite, given.step))


@kernel
def distance_of_ends(n, state):
    """Distance of the ends [m] in a state."""
    x, _ = positions_and_velocities(n, state)
    return norm(sub(get(x, n), get(x, 0)))


@kernel
def spring_at_ground(n, parameters, state):
    """Spring tension of the first segment [N] in a state, or the ground tension stored in the state."""
    held = norm(vector_at(state, at.GROUND_TENSION_VECTOR))
    if held > 0.0:
        return held
    x, _ = positions_and_velocities(n, state)
    chain = chain_of(n, parameters, state)
    length, _ = segment.geometry(sub(get(x, 1), get(x, 0)))
    return segment.spring_tension(chain, 0, length)


# --- the step as a whole


@kernel
def inputs_of_step(n, parameters, inputs, step, state):
    """`StepInputs` of a communication step of `step` [s] from a state."""
    load, force = vector_at(inputs, at.KITE_LOAD), inputs[at.WINCH_FORCE]
    velocities = vector_at(inputs, at.KITE_VELOCITY), vector_at(inputs, at.GROUND_VELOCITY)
    rated = *velocities, load, (inputs[at.REEL_OUT_SPEED], force, 0.0)
    of_kite, of_ground, of_load, of_winch = rates_of_inputs(rated, step, state)
    continued, (x, v) = is_continued(parameters), positions_and_velocities(n, state)
    left_at_ground, left_at_kite = state[at.CORRECTIONS_LEFT], state[at.CORRECTIONS_LEFT + 1]
    at_ground, at_kite = max(step, state[at.LAST_STEP], left_at_ground), max(step, state[at.LAST_STEP], left_at_kite)
    ground = motion_of_end(parameters, inputs, at.GROUND_POSITION, past.GROUND, of_ground, at_ground, state)
    kite = motion_of_end(parameters, inputs, at.KITE_POSITION, past.KITE, of_kite, at_kite, state)
    reeling = reeling_of_step(parameters, inputs, of_winch[0], step, state)
    at_ground = correction_of_end(x, v, 0, ground, left_at_ground, at_ground, state)
    at_kite = correction_of_end(x, v, n, kite, left_at_kite, at_kite, state)
    return StepInputs(
        step,
        (at_ground, at_kite, reeling[5] if follows_length(parameters) else step),
        ground,
        kite,
        with_jump(parameters, reeling, step, state),
        force,
        force_rate(parameters, inputs, of_winch[1] if continued else 0.0, step, state),
        wind_of(inputs),
        given_derivatives(state, at.WIND_VELOCITY, ZERO_VECTOR),
        load,
        given_derivatives(state, at.KITE_LOAD, of_load if continued else ZERO_VECTOR),
        rated,
        rates_of_inputs(rated, state[at.LONGEST_SO_FAR], state),
    )


@view
def conditions_of_chain(n, parameters, shape, given, state, x, v):
    """`BoundaryConditions` of a chain from `StepInputs`, in a state with node positions x [m] and velocities v [m/s].

    shape : its `initial_shape`: a chain that starts turning continues to turn in its first step.
    """
    ground, kite, step = given.ground, given.kite, given.step
    if state[at.LAST_STEP] <= 0.0 and shape == at.QUASI_STEADY:
        of_ground, of_kite = centripetal_accelerations(ground, kite, step)
        ground = ground[0], ground[1], given_derivatives(state, at.GROUND_VELOCITY, of_ground)
        kite = kite[0], kite[1], given_derivatives(state, at.KITE_VELOCITY, of_kite)
    kite_is_free = parameters[at.KITE_IS_FREE] != 0.0
    return BoundaryConditions(
        n,
        parameters,
        curve(get(x, 0), get(v, 0), *ground, given.corrections[0]),
        curve(get(x, n), get(v, n), *kite, given.corrections[1]),
        0 if parameters[at.GROUND_IS_FREE] != 0.0 else 1,
        n if kite_is_free else n - 1,
        given.reeling,
        given.force,
        given.force_rate,
        add_scaled(given.wind, 0.5 * step, given.wind_rate),
        scale(1.0 if kite_is_free else 0.0, given.load),
        scale(1.0 if kite_is_free else 0.0, given.load_rate),
    )


@view
def chain_moving(conditions, length, speed, acceleration):
    """`Chain` with this unstretched length [m] and its first [m/s] and second [m/s2] derivative."""
    return chain_in_motion(conditions.n, conditions.parameters, length, speed, acceleration, conditions.wind)


@view
def portion_moving(conditions, length, speed, acceleration, leaving):
    """`chain_moving` for a portion of a line over sheaves; leaving : as in `chain_with_flow`."""
    wind = conditions.wind
    return portion_in_motion(conditions.n, conditions.parameters, length, speed, acceleration, leaving, wind)


@view
def chain_with(conditions, length, speed):
    """`chain_moving` with a constant rate."""
    return chain_moving(conditions, length, speed, 0.0)


@view
def chain_during(conditions, time):
    """The `Chain` at a time [s] of the communication step."""
    reeling = conditions.reeling
    return chain_moving(conditions, length_at(reeling, time), rate_at(reeling, time), gain_at(reeling, time))


@kernel
def load_during(conditions, time):
    """Load [N] on a free kite end at a time [s] of the communication step, else 0."""
    return add_scaled(conditions.load, time, conditions.load_rate)


@kernel
def place_ends(conditions, time, x, v):
    """Write the driven ends into x [m] and v [m/s] (both modified) at a time [s] of the communication step."""
    if conditions.first == 1:
        put(x, 0, position_at(conditions.ground, time))
        put(v, 0, velocity_at(conditions.ground, time))
    if conditions.last == conditions.n - 1:
        put(x, conditions.n, position_at(conditions.kite, time))
        put(v, conditions.n, velocity_at(conditions.kite, time))
