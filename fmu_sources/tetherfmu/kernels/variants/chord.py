"""Common code of the tethers without nodes, and the drag along the chord, which is the only drag of the straight tether.

Air load per length of the chord, with W the wind at the height of the point minus its velocity, and e the chord direction:

    f(xi) = 1/2 rho cd d |w| w,   w = W - (W . e) e,   velocity (1 - xi) v_ground + xi v_kite,   xi = 0 .. 1

A wind specified at points applies at the same fraction of the chord as of the unstretched length, s = xi.

Source: docs/models/theory.md, "Straight line".
"""

import numpy as np

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..equations import segment, wind_points
from ..equations.air import varying_density
from ..equations.properties import chain_of, has_node_winds, property_of
from ..linear_algebra.pairs import first, pair, second, swapped
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, get, put_at, scale, sub
from .sheared_air import sheared_load

# Gauss-Legendre points and weights on 0 .. 1, for uniform air: exact to degree 9, so for the turning tether without wind
POINTS = np.array((0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332))
WEIGHTS = np.array((0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683, 0.118463442528095))
OF_SIMPSON = 1.0 / 6.0  # weight of the ends of each piece between wind points; exact for a cross-wind of constant direction


@view
def chord_of(parameters, state):
    """The only segment of a line, as `Chain`; its ground end [m], its chord [m] and the length of the chord [m]."""
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
    """Whether wind and density are constant along the chord: uniform air, or a wind specified at the ends."""
    uniform_wind = line.parameters[at.WIND_PROFILE] == at.UNIFORM or has_node_winds(line)
    return uniform_wind and not thins_out(line)


@kernel
def thins_out(line):
    """Whether the air density varies with the height."""
    return line.parameters[at.AIR_DENSITY_SCALE_HEIGHT] > 0.0


@kernel
def chord_load(parameters, state):
    """Mean of f [N/m] along the chord, and its first moment, the mean of xi f [N/m]."""
    line, ground, chord, _ = chord_of(parameters, state)
    _, e = segment.geometry(chord)
    start, more = motion_along(state)
    points = wind_points.count_of(parameters)
    if points > 2:
        return load_by_points(line, state, ground[2], chord[2], e)
    if points == 0 and not is_same_along(line):
        return sheared_load(line, ground[2], chord[2], e, (start, more))
    mean = moment = ZERO_VECTOR
    for i in range(len(POINTS)):
        xi = POINTS[i]
        wind, density, _, _ = segment.air_of(line, 0, ground[2] + xi * chord[2])
        if points == 2:
            wind = wind_points.wind_between(1, parameters, state, xi, 0.0)
        half = segment.half_drag_in(line, 0, 1.0, e, wind, density, add_scaled(start, xi, more))
        mean = add_scaled(mean, 2.0 * WEIGHTS[i], half)
        moment = add_scaled(moment, 2.0 * WEIGHTS[i] * xi, half)
    return mean, moment


@view
def motion_along(state):
    """Velocity [m/s] of the ground end, and the kite velocity relative to it [m/s]."""
    _, v = positions_and_velocities(1, state)
    return get(v, 0), sub(get(v, 1), get(v, 0))


@kernel
def load_by_points(line, state, height, rise, e):
    """`chord_load` for more than two wind points, by Simpson's rule in each piece between two.

    height : of the ground end [m].  rise : of the kite end above it [m].  e : direction of the chord.

    If the cross-wind is a at one end of a piece and b at the other, linear in between, the mean of |w| w in it is

        1/6 (|a| a + |a + b| (a + b) + |b| b)

    Pairs: a point, or the middle of a piece, and its mirror image, from the ends of the chord to its middle, in steps of
    half a piece; a point that is its own image counts half in both.
    """
    pieces = wind_points.count_of(line.parameters) - 1
    half, (at_ground, more) = 0.5 / pieces, motion_along(state)
    velocity, change = pair(at_ground, add(at_ground, more)), scale(pair(2.0 * half, -2.0 * half), more)
    a = across_at_points(line, state, e, velocity, 0)
    load = scale(speed_in_density(line, height, rise, 0.0, a), a)
    moment = pair(ZERO_VECTOR, ZERO_VECTOR)  # about the middle of the chord, in half pieces: each step adds a load
    for k in range(1, pieces // 2 + 1):
        part = 2 * k * half
        velocity = add(velocity, change)
        b = across_at_points(line, state, e, velocity, k)
        between = add(a, b)
        moment = add(moment, load)
        load = add_scaled(load, speed_in_density(line, height, rise, part - half, between), between)
        moment = add(moment, load)
        share = 1.0 if 2 * k == pieces else 2.0
        load = add_scaled(load, share * speed_in_density(line, height, rise, part, b), b)
        a = b
    if pieces % 2 == 1:
        between = add(a, swapped(a))
        moment = add(moment, load)
        load = add_scaled(load, 0.5 * speed_in_density(line, height, rise, 0.5, between), between)
    all_of_it, about_middle = add(first(load), second(load)), sub(second(moment), first(moment))
    density = 1.0 if thins_out(line) else line.parameters[at.AIR_DENSITY]
    factor = 4.0 * half * OF_SIMPSON * segment.half_drag_factor(line, 0, 1.0, density)
    return scale(factor, all_of_it), scale(factor, add_scaled(scale(0.5, all_of_it), half, about_middle))


@kernel
def across_at_points(line, state, e, velocity, k):
    """Cross-winds [m/s] at the k-th wind point from the ground end and at the k-th from the kite end, as pairs.

    e : direction of the chord.  velocity : of the chord there [m/s], pairs.
    """
    last = wind_points.count_of(line.parameters) - 1
    wind = wind_points.winds_at(1, state, (k, last - k))
    w, _ = segment.apparent_wind(wind, e, velocity)
    return w


@kernel
def speed_in_density(line, height, rise, part, w):
    """|w| [m/s] at a distance from the ground end and from the kite end; w [m/s] and the result are pairs.

    If the density varies, rho |w| [kg/(m2 s)].
    """
    speed = segment.speed_across(w)
    if thins_out(line):
        density, _ = varying_density(height + rise * pair(part, 1.0 - part), line.parameters)
        return speed * density
    return speed


@kernel
def write_common(line, distance, ground_force, kite_force, outputs):
    """Outputs (modified) of both lines, from the length of the chord [m] and the end forces [N]."""
    put_at(outputs, at.GROUND_FORCE, ground_force)
    put_at(outputs, at.KITE_FORCE, kite_force)
    outputs[at.TETHER_LENGTH] = line.length
    outputs[at.GROUNDED_LENGTH] = 0.0
    outputs[at.SOLVER_ITERATION_LIMIT] = 0.0
    outputs[at.SLACK_SEGMENTS] = 1.0 if distance < line.length else 0.0
    outputs[at.KITE_STIFFNESS] = property_of(line, 0, at.STIFFNESS) / line.length
    outputs[at.KITE_DAMPING] = property_of(line, 0, at.DAMPING) / line.length
