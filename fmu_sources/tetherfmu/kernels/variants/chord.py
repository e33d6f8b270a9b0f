"""What the tethers without nodes share: they know the drag only along their chord.

Load of the air per length of the chord, with W the wind at the height of the point less its velocity, and e the chord:

    f(xi) = 1/2 rho cd d |w| w,   w = W - (W . e) e,   velocity (1 - xi) v_ground + xi v_kite,   xi = 0 .. 1

A wind that is given at points is the one at the same part of the chord as of the unstretched length, s = xi.

Source: docs/models/theory.md, "Straight line" and "Elastic catenary".
"""

import numpy as np

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..equations import segment, wind_points
from ..equations.air import air_density
from ..equations.properties import chain_of, has_node_winds, property_of
from ..linear_algebra.vectors import ZERO_VECTOR, add_scaled, get, put_at, sub
from .sheared_air import sheared_load

# Gauss-Legendre points and weights on 0 .. 1, for uniform air: exact to degree 9, so for the turning tether without wind
POINTS = np.array((0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332))
WEIGHTS = np.array((0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095))
# the same for each of several pieces between wind points, to degree 5: exact for a cross-wind that keeps its direction there
PIECE_POINTS = np.array((0.112701665379258, 0.5, 0.887298334620742))
PIECE_WEIGHTS = np.array((0.277777777777778, 0.444444444444444, 0.277777777777778))


@view
def chord_of(parameters, state):
    """The one segment of a line, as `Chain`; its ground end [m], its chord [m] and the length of the chord [m]."""
    x, _ = positions_and_velocities(1, state)
    ground = get(x, 0)
    chord = sub(get(x, 1), ground)
    distance, _ = segment.geometry(chord)
    return chain_of(1, parameters, state), ground, chord, distance


@kernel
def no_work_size(n):
    """Length of the work array: these tethers need none, but no array is empty."""
    return 1


@kernel
def is_same_along(line):
    """Whether wind and density are the same all along the chord: uniform air, or a wind that is given at the ends."""
    uniform_wind = line.parameters[at.WIND_PROFILE] == at.UNIFORM or has_node_winds(line)
    return uniform_wind and line.parameters[at.AIR_DENSITY_SCALE_HEIGHT] <= 0.0


@kernel
def chord_load(parameters, state):
    """Mean of f [N/m] along the chord, and its first moment, the mean of xi f [N/m]."""
    line, ground, chord, _ = chord_of(parameters, state)
    _, v = positions_and_velocities(1, state)
    _, e = segment.geometry(chord)
    if wind_points.count_of(parameters) > 0:
        return load_by_points(line, state, ground[2], chord[2], e)
    if not is_same_along(line):
        return sheared_load(line, ground[2], chord[2], e, (get(v, 0), sub(get(v, 1), get(v, 0))))
    mean = moment = ZERO_VECTOR
    for i in range(len(POINTS)):
        xi = POINTS[i]
        velocity = add_scaled(get(v, 0), xi, sub(get(v, 1), get(v, 0)))
        half = segment.half_drag(line, 0, 1.0, e, ground[2] + xi * chord[2], velocity)
        mean = add_scaled(mean, 2.0 * WEIGHTS[i], half)
        moment = add_scaled(moment, 2.0 * WEIGHTS[i] * xi, half)
    return mean, moment


@kernel
def load_by_points(line, state, height, rise, e):
    """`chord_load` in the wind at the points of a state: ground end at `height` [m], direction e of the chord."""
    _, v = positions_and_velocities(1, state)
    pieces = wind_points.count_of(line.parameters) - 1
    mean = moment = ZERO_VECTOR
    for k in range(pieces):
        for i in range(len(POINTS) if pieces == 1 else len(PIECE_POINTS)):
            point, weight = (POINTS[i], WEIGHTS[i]) if pieces == 1 else (PIECE_POINTS[i], PIECE_WEIGHTS[i])
            xi = (k + point) / pieces
            velocity = add_scaled(get(v, 0), xi, sub(get(v, 1), get(v, 0)))
            wind = wind_points.wind_between(1, line.parameters, state, xi, 0.0)
            density, _ = air_density(height + xi * rise, line.parameters)
            half = segment.half_drag_in(line, 0, 1.0, e, wind, density, velocity)
            mean = add_scaled(mean, 2.0 * weight / pieces, half)
            moment = add_scaled(moment, 2.0 * weight / pieces * xi, half)
    return mean, moment


@kernel
def write_common(line, distance, ground_force, kite_force, outputs):
    """Outputs (modified) that both lines share, from the length of the chord [m] and the end forces [N]."""
    put_at(outputs, at.GROUND_FORCE, ground_force)
    put_at(outputs, at.KITE_FORCE, kite_force)
    outputs[at.TETHER_LENGTH] = line.length
    outputs[at.GROUNDED_LENGTH] = 0.0
    outputs[at.SOLVER_ITERATION_LIMIT] = 0.0
    outputs[at.SLACK_SEGMENTS] = 1.0 if distance < line.length else 0.0
    outputs[at.KITE_STIFFNESS] = property_of(line, 0, at.STIFFNESS) / line.length
    outputs[at.KITE_DAMPING] = property_of(line, 0, at.DAMPING) / line.length
