"""The dynamic tether: first state, one communication step, outputs.

These kernels join the parts: inputs -> end motion -> chain -> solver -> state -> outputs. A step works on a copy of the
state, so a refused step leaves the state of before.
"""

from math import atan2, inf, sqrt

from . import chain, end_motion, equilibrium, implicit_euler, rosenbrock, segment
from . import layout as at
from .compilation import kernel
from .status import INPUT_NOT_FINITE, OK, REELED_TOO_SHORT, STATE_NOT_FINITE, STEP_NOT_POSITIVE
from .vectors import along, dot, get, norm, put, scale, sub
from .workspace import Drive, place_ends, state_size, workspace

SLACKEST = 1e-9  # wave_time counts a tension as at least this part of EA


@kernel
def vector(array, first):
    """Three-vector from place `first` of a flat array."""
    return array[first], array[first + 1], array[first + 2]


@kernel
def set_vector(array, first, a):
    """Write a three-vector to place `first` of a flat array (modified)."""
    array[first] = a[0]
    array[first + 1] = a[1]
    array[first + 2] = a[2]


@kernel
def positions_and_velocities(n, state):
    """Views of the node positions [m] and node velocities [m/s] in a state."""
    nodes = 3 * (n + 1)
    return (
        state[at.STATE_HEADER : at.STATE_HEADER + nodes],
        state[at.STATE_HEADER + nodes : at.STATE_HEADER + 2 * nodes],
    )


@kernel
def check_inputs(inputs):
    """OK, or INPUT_NOT_FINITE with the place of the first input that is not a finite number."""
    for i in range(at.INPUTS):
        if not abs(inputs[i]) < inf:
            return INPUT_NOT_FINITE | i << 8
    return OK


@kernel
def initialize(n, parameters, inputs, state, work):
    """Fill the state (modified) with the shape that `initial_shape` asks for, between the ends in the inputs.

    Returns a status: OK, INPUT_NOT_FINITE, NO_EQUILIBRIUM or STATE_NOT_FINITE.
    """
    status = check_inputs(inputs)
    if status != OK:
        return status
    for k in range(state_size(n)):
        state[k] = 0.0
    w = workspace(n, work)
    x, v = positions_and_velocities(n, state)
    ground = vector(inputs, at.GROUND_POSITION)
    ground_velocity = vector(inputs, at.GROUND_VELOCITY)
    kite = vector(inputs, at.KITE_POSITION)
    kite_velocity = vector(inputs, at.KITE_VELOCITY)
    put(x, 0, ground)
    put(v, 0, ground_velocity)
    put(x, n, kite)
    put(v, n, kite_velocity)
    length = parameters[at.INITIAL_LENGTH]
    wind = vector(inputs, at.WIND_VELOCITY)
    state[at.LENGTH] = length
    state[at.REELING] = inputs[at.REEL_OUT_SPEED]
    set_vector(state, at.WIND, wind)
    if parameters[at.INITIAL_SHAPE] == at.STRAIGHT:
        equilibrium.straighten(n, parameters, x)
        equilibrium.straighten(n, parameters, v)
    else:
        spin = (0.0, 0.0, 0.0)
        stretching = 0.0
        if parameters[at.INITIAL_SHAPE] == at.QUASI_STEADY:
            spin, stretching = equilibrium.rigid_motion(sub(kite, ground), sub(kite_velocity, ground_velocity))
        else:
            put(v, 0, spin)
            put(v, n, spin)
        status, iterations = equilibrium.find(n, spin, stretching, length, wind, parameters, x, v, w)
        state[at.ITERATIONS] = iterations
        put(v, 0, ground_velocity)
        put(v, n, kite_velocity)
        if status != OK:
            return status
    for k in range(state_size(n)):
        if not abs(state[k]) < inf:
            return STATE_NOT_FINITE
    return OK


@kernel
def drive_of_step(n, parameters, inputs, step, state, x, v):
    """What acts on the chain during a communication step of `step` [s]: a `workspace.Drive`."""
    kite_velocity = vector(inputs, at.KITE_VELOCITY)
    ground_velocity = vector(inputs, at.GROUND_VELOCITY)
    last_step = state[at.LAST_STEP]
    kite_acceleration = end_motion.estimated_acceleration(
        kite_velocity, vector(state, at.LAST_KITE_VELOCITY), last_step, step
    )
    ground_acceleration = end_motion.estimated_acceleration(
        ground_velocity, vector(state, at.LAST_GROUND_VELOCITY), last_step, step
    )
    return Drive(
        end_motion.curve(
            get(x, 0), get(v, 0), vector(inputs, at.GROUND_POSITION), ground_velocity, ground_acceleration, step
        ),
        end_motion.curve(get(x, n), get(v, n), vector(inputs, at.KITE_POSITION), kite_velocity, kite_acceleration, step),
        0 if parameters[at.GROUND_IS_FREE] != 0.0 else 1,
        n if parameters[at.KITE_IS_FREE] != 0.0 else n - 1,
        state[at.LENGTH],
        inputs[at.REEL_OUT_SPEED],
        vector(inputs, at.WIND_VELOCITY),
        scale(1.0 if parameters[at.KITE_IS_FREE] != 0.0 else 0.0, vector(inputs, at.KITE_LOAD)),
    )


@kernel
def advance(n, parameters, inputs, step, state, work):
    """Advance the state (modified) by a communication step of `step` [s]; on any status but OK it is left as it was.

    Returns a status: OK, INPUT_NOT_FINITE, STEP_NOT_POSITIVE, REELED_TOO_SHORT, STATE_NOT_FINITE or one of the solver's.
    """
    status = check_inputs(inputs)
    if status != OK:
        return status
    if not (step > 0.0 and step < inf):
        return STEP_NOT_POSITIVE
    new_length = state[at.LENGTH] + inputs[at.REEL_OUT_SPEED] * step
    for s in range(n):
        if chain.rest_length(s, new_length, parameters) < at.MIN_SEGMENT_LENGTH:
            return REELED_TOO_SHORT
    w = workspace(n, work)
    trial = w.trial
    for k in range(state_size(n)):
        trial[k] = state[k]
    x, v = positions_and_velocities(n, trial)
    drive = drive_of_step(n, parameters, inputs, step, trial, x, v)
    if drive.first <= drive.last:
        if parameters[at.FIXED_STEP] > 0.0:
            status = implicit_euler.integrate(n, drive, step, trial, x, v, parameters, w)
        else:
            status = rosenbrock.integrate(n, drive, step, trial, x, v, parameters, w)
        if status != OK:
            return status
    place_ends(n, drive, step, x, v)
    trial[at.LENGTH] = new_length
    trial[at.REELING] = inputs[at.REEL_OUT_SPEED]
    trial[at.LAST_STEP] = step
    set_vector(trial, at.WIND, drive.wind)
    set_vector(trial, at.LAST_KITE_VELOCITY, vector(inputs, at.KITE_VELOCITY))
    set_vector(trial, at.LAST_GROUND_VELOCITY, vector(inputs, at.GROUND_VELOCITY))
    for k in range(state_size(n)):
        if not abs(trial[k]) < inf:
            return STATE_NOT_FINITE
    for k in range(state_size(n)):
        state[k] = trial[k]
    return OK


@kernel
def distance_to_chord(point, start, chord):
    """Distance [m] of a point from the straight line between the ends of the chord."""
    square = dot(chord, chord)
    part = 0.0
    if square > 0.0:
        part = min(1.0, max(0.0, dot(sub(point, start), chord) / square))
    return norm(along(sub(point, start), -part, chord))


@kernel
def survey(n, parameters, state, x, v, outputs):
    """Outputs that look at every segment (modified): largest tension, slack segments, stiffness, wave time, sag."""
    wind = vector(state, at.WIND)
    scalars = at.PARAMETER_SCALARS
    largest = -inf
    slack = 0
    wave_time = 0.0
    compliance = 0.0
    softness = 0.0
    sag = 0.0
    for s in range(n):
        rest = chain.rest_length(s, state[at.LENGTH], parameters)
        rest_rate = chain.rest_length(s, state[at.REELING], parameters)
        _, _, tension, length = segment.forces(
            s, n, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1), rest, rest_rate, wind, parameters
        )
        largest = max(largest, tension)
        if length < rest:
            slack += 1
        stiffness = parameters[scalars + at.STIFFNESS * n + s]
        line_density = parameters[scalars + at.LINE_DENSITY * n + s]
        wave_time += sqrt(line_density * rest * length / max(tension, SLACKEST * stiffness))
        compliance += rest / stiffness
        softness += rest / parameters[scalars + at.DAMPING * n + s]
        sag = max(sag, distance_to_chord(get(x, s), get(x, 0), sub(get(x, n), get(x, 0))))
    outputs[at.MAX_TENSION] = largest
    outputs[at.SLACK_SEGMENTS] = slack
    outputs[at.KITE_STIFFNESS] = 1.0 / compliance
    outputs[at.KITE_DAMPING] = 1.0 / softness
    outputs[at.WAVE_TIME] = wave_time
    outputs[at.SAG] = sag


@kernel
def shape(n, parameters, x, shape_points, outputs):
    """Points [m] at equal unstretched length along the tether, ground first, into the outputs (modified)."""
    s = 0
    passed = 0.0
    for k in range(shape_points):
        part = k / max(1, shape_points - 1)
        while s < n - 1 and part > passed + parameters[at.PARAMETER_SCALARS + s]:
            passed += parameters[at.PARAMETER_SCALARS + s]
            s += 1
        within = (part - passed) / parameters[at.PARAMETER_SCALARS + s]
        start = get(x, s)
        set_vector(outputs, at.SHAPE + 3 * k, along(start, within, sub(get(x, s + 1), start)))


@kernel
def observe(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) that belong to a state."""
    x, v = positions_and_velocities(n, state)
    w = workspace(n, work)
    length = state[at.LENGTH]
    wind = vector(state, at.WIND)
    chain.node_masses(n, length, parameters, w.mass)
    ground_force, ground_tension = chain.end_force(n, False, x, v, length, state[at.REELING], wind, w.mass, parameters)
    kite_force, kite_tension = chain.end_force(n, True, x, v, length, state[at.REELING], wind, w.mass, parameters)
    set_vector(outputs, at.GROUND_FORCE, ground_force)
    set_vector(outputs, at.KITE_FORCE, kite_force)
    outputs[at.GROUND_TENSION] = ground_tension
    outputs[at.KITE_TENSION] = kite_tension
    outputs[at.TETHER_LENGTH] = length
    leaving = sub(get(x, 1), get(x, 0))
    outputs[at.GROUND_ELEVATION] = atan2(leaving[2], sqrt(leaving[0] ** 2 + leaving[1] ** 2))
    outputs[at.GROUND_AZIMUTH] = atan2(leaving[1], leaving[0])
    outputs[at.KITE_END_MASS] = w.mass[n]
    survey(n, parameters, state, x, v, outputs)
    shape(n, parameters, x, shape_points, outputs)
