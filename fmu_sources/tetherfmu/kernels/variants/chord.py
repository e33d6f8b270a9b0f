"""What the tethers without nodes share: they know the drag only along their chord.

Load of the air per length of the chord, with W the wind at the height of the point less its velocity, and e the chord:

    f(xi) = 1/2 rho cd d |w| w,   w = W - (W . e) e,   velocity (1 - xi) v_ground + xi v_kite,   xi = 0 .. 1

A wind that is given at points is the one at the same part of the chord as of the unstretched length, s = xi.

Source: docs/models/theory.md, "Straight line" and "Elastic catenary".
"""

from math import sqrt

import numpy as np

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..equations import segment, wind_points
from ..equations.air import air_density, varying_density
from ..equations.properties import chain_of, has_node_winds, property_of
from ..linear_algebra.pairs import broadcast, first, pair, second
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, get, put_at, scale, sub
from .sheared_air import sheared_load

# Gauss-Legendre points and weights on 0 .. 1, for uniform air: exact to degree 9, so for the turning tether without wind
POINTS = np.array((0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332))
WEIGHTS = np.array((0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095))
# three for each of several pieces between wind points, exact to degree 5: for a cross-wind that keeps its direction there
OFFSET = sqrt(0.15)  # of the outer ones from the middle, in lengths of the piece
OUTER_WEIGHT, MIDDLE_WEIGHT = 5.0 / 18.0, 8.0 / 18.0


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


@view
def motion_along(state):
    """Velocity [m/s] of the ground end, and what that of the kite end is more."""
    _, v = positions_and_velocities(1, state)
    return get(v, 0), sub(get(v, 1), get(v, 0))


@kernel
def load_between_two_points(line, state, height, rise, e):
    """`load_by_points` of two of them: one piece, at the points of uniform air."""
    start, more = motion_along(state)
    mean = moment = ZERO_VECTOR
    for i in range(len(POINTS)):
        xi = POINTS[i]
        wind = wind_points.wind_between(1, line.parameters, state, xi, 0.0)
        density, _ = air_density(height + xi * rise, line.parameters)
        half = segment.half_drag_in(line, 0, 1.0, e, wind, density, add_scaled(start, xi, more))
        mean = add_scaled(mean, 2.0 * WEIGHTS[i], half)
        moment = add_scaled(moment, 2.0 * WEIGHTS[i] * xi, half)
    return mean, moment


@kernel
def load_by_points(line, state, height, rise, e):
    """`chord_load` in the wind at the points of a state: ground end at `height` [m], direction e of the chord."""
    if wind_points.count_of(line.parameters) == 2:
        return load_between_two_points(line, state, height, rise, e)
    if line.parameters[at.AIR_DENSITY_SCALE_HEIGHT] > 0.0:
        return load_of_pieces(line, state, height, rise, e, True)
    return load_of_pieces(line, state, height, rise, e, False)


@view
def load_of_pieces(line, state, height, rise, e, thins_out):
    """`load_by_points`, piece by piece; thins_out : whether the density changes with the height.

    Wind and velocity are linear between two points, and so is the cross-wind w = m + g b: m in the middle of a piece, b from
    its one end to the other, g = -1/2 .. 1/2. Pairs: a piece and its mirror image, from the ends of the chord to its middle;
    a piece that is its own image counts half in both.
    """
    pieces = wind_points.count_of(line.parameters) - 1
    width, motion = 1.0 / pieces, motion_along(state)
    mean = moment = pair(ZERO_VECTOR, ZERO_VECTOR)  # the moment about the own end, in widths of a piece
    start = across_at_points(line, state, e, motion, 0, width)
    for k in range((pieces + 1) // 2):
        end = across_at_points(line, state, e, motion, k + 1, width)
        middle, change = scale(0.5, add(start, end)), sub(end, start)
        start, outwards, place = end, scale(OFFSET, change), k + 0.5
        share = 0.5 if 2 * k + 1 == pieces else 1.0
        near = share * mass_flux(line, height, rise, width * (place - OFFSET), sub(middle, outwards), thins_out)
        inner = share * mass_flux(line, height, rise, width * place, middle, thins_out)
        far = share * mass_flux(line, height, rise, width * (place + OFFSET), add(middle, outwards), thins_out)
        load, turning = load_of_piece(middle, change, near, inner, far)
        mean, moment = add(mean, load), add(moment, add_scaled(turning, place, load))
    near_ground, near_kite = first(mean), second(mean)
    moment = add_scaled(near_kite, width, sub(first(moment), second(moment)))
    factor = 2.0 * width * segment.half_drag_factor(line, 0, 1.0, 1.0)
    return scale(factor, add(near_ground, near_kite)), scale(factor, moment)


@kernel
def across_at_points(line, state, e, motion, k, width):
    """Cross-winds [m/s] at the k-th wind point from the ground end and at the k-th from the kite end, as pairs.

    e : direction of the chord.  motion : of `motion_along`.  width : of a piece between two points, in chords.
    """
    last, part = wind_points.count_of(line.parameters) - 1, k * width
    wind = wind_points.winds_at(1, line.parameters, state, (k, last - k))
    velocity = add_scaled(motion[0], pair(part, 1.0 - part), motion[1])
    w, _ = segment.apparent_wind(wind, e, velocity)
    return w


@kernel
def mass_flux(line, height, rise, part, w, thins_out):
    """rho |w| [kg/(m2 s)] at a part of the chord from the ground end and from the kite end; w [m/s] and this are pairs."""
    if thins_out:
        density, _ = varying_density(height + rise * pair(part, 1.0 - part), line.parameters)
    else:
        density = broadcast((line.parameters[at.AIR_DENSITY],), w[0])[0]
    return density * segment.speed_across(w)


@kernel
def load_of_piece(middle, change, near, inner, far):
    """Mean of rho |w| w in a piece, where w = m + g b, and that of g rho |w| w; from rho |w| at g = -`OFFSET`, 0, `OFFSET`.

    S0 m + S1 b,   S1 m + S2 b,   Sj = sum weight g^j rho |w|
    """
    both, twist = OUTER_WEIGHT * (near + far), OUTER_WEIGHT * OFFSET * (far - near)
    load = add_scaled(scale(both + MIDDLE_WEIGHT * inner, middle), twist, change)
    return load, add_scaled(scale(twist, middle), OFFSET * OFFSET * both, change)


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
