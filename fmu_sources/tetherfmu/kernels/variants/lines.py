"""Tethers without nodes: the straight line and the catenary. Both know the drag only along their chord.

Load of the air per length of the chord, with W the wind at the height of the point less its velocity, and e the chord:

    f(xi) = 1/2 rho cd d |w| w,   w = W - (W . e) e,   velocity (1 - xi) v_ground + xi v_kite,   xi = 0 .. 1

Straight line: tension EA (c/L - 1), none if slack. The load goes to the ends so that its force and its moment are kept,
parts 1 - xi and xi; for a tether that turns about the ground a quarter of rho cd d c v^2/2 comes to the kite.
Catenary: weight plus the mean of f is one uniform load (`elastic_catenary.py`).

Source: docs/theory.md, "Straight line" and "Elastic catenary".
"""

import numpy as np

from tetherfmu.kernels.algebra.vectors import add, along, cross, dot, get, norm, scale, sub
from tetherfmu.kernels.arrays import workspace
from tetherfmu.kernels.chain import segment
from tetherfmu.kernels.communication.inputs import (
    begin,
    check_step,
    copy,
    move_ends,
    positions_and_velocities,
    remember,
    set_vector,
    vector,
)
from tetherfmu.kernels.communication.outputs import distance_to_chord, wave_time, write_direction
from tetherfmu.kernels.compilation import kernel
from tetherfmu.kernels.equilibrium import elastic_catenary
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

# Gauss-Legendre points and weights on 0 .. 1: exact to degree 9, so for the turning tether without wind
POINTS = np.array((0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332))
WEIGHTS = np.array((0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095))
SAMPLES = 24  # pieces of the catenary in which wave time and sag are found
LIGHTEST = 1e-12  # load over EA below which the catenary is a straight line


@kernel
def chord_load(parameters, state):
    """Mean of f [N/m] along the chord, and its first moment, the mean of xi f [N/m]."""
    x, v = positions_and_velocities(1, state)
    ground = get(x, 0)
    chord = sub(get(x, 1), ground)
    _, e = segment.geometry(chord)
    wind = vector(state, at.WIND)
    mean = (0.0, 0.0, 0.0)
    moment = (0.0, 0.0, 0.0)
    for i in range(len(POINTS)):
        xi = POINTS[i]
        velocity = along(get(v, 0), xi, sub(get(v, 1), get(v, 0)))
        half = segment.half_drag(0, 1, 1.0, e, ground[2] + xi * chord[2], velocity, wind, parameters)
        mean = along(mean, 2.0 * WEIGHTS[i], half)
        moment = along(moment, 2.0 * WEIGHTS[i] * xi, half)
    return mean, moment


@kernel
def property_of(parameters, name):
    """A property of the one segment."""
    return parameters[at.PARAMETER_SCALARS + name]


@kernel
def write_common(parameters, state, ground_force, kite_force, outputs):
    """Outputs (modified) that both lines share, from their end forces [N]."""
    x, _ = positions_and_velocities(1, state)
    length = state[at.LENGTH]
    distance, _ = segment.geometry(sub(get(x, 1), get(x, 0)))
    set_vector(outputs, at.GROUND_FORCE, ground_force)
    set_vector(outputs, at.KITE_FORCE, kite_force)
    outputs[at.TETHER_LENGTH] = length
    outputs[at.SLACK_SEGMENTS] = 1.0 if distance < length else 0.0
    outputs[at.KITE_STIFFNESS] = property_of(parameters, at.STIFFNESS) / length
    outputs[at.KITE_DAMPING] = property_of(parameters, at.DAMPING) / length


# --- straight line


@kernel
def initialize_straight(n, parameters, inputs, state, work):
    """Fill the state (modified); returns a status: OK or INPUT_NOT_FINITE. n is 1."""
    return begin(n, parameters, inputs, state)


@kernel
def advance_straight(n, parameters, inputs, step, state, work):
    """Advance the state (modified) by a communication step [s]; returns the status of `communication.check_step`. n is 1."""
    status = check_step(n, parameters, inputs, step, state)
    if status == OK:
        move_ends(n, inputs, step, state)
        remember(inputs, step, state)
    return status


@kernel
def observe_straight(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) of a straight line."""
    x, _ = positions_and_velocities(1, state)
    ground = get(x, 0)
    chord = sub(get(x, 1), ground)
    distance, e = segment.geometry(chord)
    length = state[at.LENGTH]
    stiffness = property_of(parameters, at.STIFFNESS)
    line_density = property_of(parameters, at.LINE_DENSITY)
    pull = stiffness * max(distance / length - 1.0, 0.0)
    mean, moment = chord_load(parameters, state)
    half_weight = (0.0, 0.0, -0.5 * line_density * length * parameters[at.GRAVITY])
    ground_force = add(add(scale(pull, e), half_weight), scale(distance, sub(mean, moment)))
    kite_force = add(add(scale(-pull, e), half_weight), scale(distance, moment))
    write_common(parameters, state, ground_force, kite_force, outputs)
    outputs[at.GROUND_TENSION] = dot(ground_force, e)
    outputs[at.KITE_TENSION] = -dot(kite_force, e)
    outputs[at.MAX_TENSION] = max(outputs[at.GROUND_TENSION], outputs[at.KITE_TENSION])
    outputs[at.KITE_END_MASS] = 0.5 * line_density * length
    outputs[at.WAVE_TIME] = wave_time(line_density, length, distance, pull, stiffness)
    outputs[at.SAG] = 0.0
    write_direction(chord, outputs)
    for k in range(shape_points):
        set_vector(outputs, at.SHAPE + 3 * k, along(ground, k / max(1, shape_points - 1), chord))


# --- catenary


@kernel
def uniform_load(parameters, state):
    """Weight plus mean drag per unstretched length [N/m]; a slack tether catches the wind with all its length."""
    mean, _ = chord_load(parameters, state)
    return mean[0], mean[1], mean[2] - property_of(parameters, at.LINE_DENSITY) * parameters[at.GRAVITY]


@kernel
def solve_catenary(parameters, state):
    """Store the tension vector of the ground end in the state (modified); returns OK or NO_EQUILIBRIUM."""
    x, _ = positions_and_velocities(1, state)
    chord = sub(get(x, 1), get(x, 0))
    length = state[at.LENGTH]
    stiffness = property_of(parameters, at.STIFFNESS)
    load = uniform_load(parameters, state)
    size = norm(load)
    if size * length <= LIGHTEST * stiffness:
        distance, e = segment.geometry(chord)
        pull = scale(stiffness * max(distance / length - 1.0, 0.0), e)
        set_vector(state, at.GROUND_TENSION_VECTOR, along(pull, 0.5 * length, load))
        return OK
    down = scale(1.0 / size, load)
    rise = -dot(chord, down)
    across = along(chord, rise, down)
    span = norm(across)
    horizontal, vertical, iterations = elastic_catenary.solve(span, rise, size, length, stiffness)
    if iterations < 0:
        return NO_EQUILIBRIUM
    state[at.ITERATIONS] += iterations
    sideways = scale(horizontal / max(span, segment.SHORTEST), across)
    set_vector(state, at.GROUND_TENSION_VECTOR, along(sideways, 0.5 * size * length - vertical, down))
    return OK


@kernel
def initialize_catenary(n, parameters, inputs, state, work):
    """Fill the state (modified); returns a status: OK, INPUT_NOT_FINITE or NO_EQUILIBRIUM. n is 1."""
    status = begin(n, parameters, inputs, state)
    if status == OK:
        status = solve_catenary(parameters, state)
    return status


@kernel
def advance_catenary(n, parameters, inputs, step, state, work):
    """Advance the state (modified) by a communication step of `step` [s]; on any status but OK it is left as it was.

    Returns a status: that of `communication.check_step`, OK or NO_EQUILIBRIUM. n is 1.
    """
    status = check_step(n, parameters, inputs, step, state)
    if status != OK:
        return status
    trial = workspace(n, work).trial
    copy(state, trial)
    move_ends(n, inputs, step, trial)
    remember(inputs, step, trial)
    status = solve_catenary(parameters, trial)
    if status == OK:
        copy(trial, state)
    return status


@kernel
def catenary_point(ground, tension, load, arc, stiffness):
    """Point [m] at unstretched length `arc` [m] from the ground end, from its tension vector [N] and the load [N/m]."""
    size = max(norm(load), 1e-300)
    down = scale(1.0 / size, load)
    vertical = -dot(tension, down)
    across = along(tension, vertical, down)
    horizontal = norm(across)
    out, up = elastic_catenary.point(arc, horizontal, vertical, size, stiffness)
    sideways = scale(out / max(horizontal, 1e-300), across)
    return along(add(ground, sideways), -up, down)


@kernel
def observe_catenary(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) of a catenary."""
    x, _ = positions_and_velocities(1, state)
    ground = get(x, 0)
    chord = sub(get(x, 1), ground)
    length = state[at.LENGTH]
    stiffness = property_of(parameters, at.STIFFNESS)
    load = uniform_load(parameters, state)
    tension = vector(state, at.GROUND_TENSION_VECTOR)
    kite_force = along(scale(-1.0, tension), length, load)
    write_common(parameters, state, tension, kite_force, outputs)
    outputs[at.GROUND_TENSION] = norm(tension)
    outputs[at.KITE_TENSION] = norm(kite_force)
    outputs[at.MAX_TENSION] = max(norm(tension), norm(kite_force))
    outputs[at.KITE_END_MASS] = 0.0
    write_direction(tension, outputs)
    piece = length / SAMPLES
    crossing = 0.0
    sag = 0.0
    for k in range(SAMPLES):
        middle = (k + 0.5) * piece
        pull = norm(along(tension, -middle, load))
        stretched = piece * (1.0 + pull / stiffness)
        crossing += wave_time(property_of(parameters, at.LINE_DENSITY), piece, stretched, pull, stiffness)
        sag = max(sag, distance_to_chord(catenary_point(ground, tension, load, middle, stiffness), ground, chord))
    # the tether is farthest from its chord where it is parallel to it: (t - s q) x c = 0, or, hanging from ends one above
    # the other, in its fold: (t - s q) . q = 0
    turning = cross(load, chord)
    parallel = dot(cross(tension, chord), turning) / max(dot(turning, turning), 1e-300)
    fold = dot(tension, load) / max(dot(load, load), 1e-300)
    for arc in (parallel, fold):
        point = catenary_point(ground, tension, load, min(length, max(0.0, arc)), stiffness)
        sag = max(sag, distance_to_chord(point, ground, chord))
    outputs[at.WAVE_TIME] = crossing
    outputs[at.SAG] = sag
    for k in range(shape_points):
        arc = length * k / max(1, shape_points - 1)
        set_vector(outputs, at.SHAPE + 3 * k, catenary_point(ground, tension, load, arc, stiffness))
