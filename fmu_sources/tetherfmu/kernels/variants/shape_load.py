"""The load on the shape of a catenary: the wind acts on the local position and direction of the tether, not on its chord.

On the catenary of a uniform load q, with the tension vector t(s) = t0 - s q at the unstretched length s from the ground end
and the position r(s) relative to it, in units of weight and drag per unstretched length

    f(s) = m g + (1 + |t|/EA) 1/2 rho cd d |w| w,   w across t/|t|, in the air and with the velocity at r(s)

Its mean F and M, the mean of r x (f - q), are evaluated at several places. The tether hangs with F in place of q. The
variation of f along it shifts the end forces, as on a beam, perpendicular to the chord c by -L c x M/c^2; along the chord
each end carries half of L (F - q).

Source: docs/models/theory.md, "Elastic catenary".
"""

from math import sqrt

import numpy as np

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import node_loads, segment, wind_points
from ..equations.properties import property_of
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, cross, dot, norm, scale, sub
from ..rest.elastic_catenary import LEAST, point_in_space
from .chord import motion_along

# Gauss-Legendre points and weights on 0 .. 1
PLACES = np.array(
    (
        *(0.019855071751231856, 0.101666761293186630, 0.237233795041835507, 0.408282678752175098),
        *(0.591717321247824902, 0.762766204958164493, 0.898333238706813370, 0.980144928248768144),
    )
)
WEIGHTS = np.array(
    (
        *(0.050614268145188130, 0.111190517226687235, 0.156853322938943644, 0.181341891689180991),
        *(0.181341891689180991, 0.156853322938943644, 0.111190517226687235, 0.050614268145188130),
    )
)
BETWEEN = 0.5 - 0.5 / sqrt(3.0)  # Gauss-Legendre point of two
SHORTEST_CHORD = 0.1  # of the length: the force shift of a shorter chord is not extrapolated


@kernel
def load_at(line, height, state, part, e, size):
    """f [N/m] at a fraction of the unstretched length and a height [m], with the direction and size [N] of the tension."""
    start, more = motion_along(state)
    wind, density, _, _ = segment.air_of(line, 0, height)
    if wind_points.count_of(line.parameters) > 0:
        wind = wind_points.wind_between(1, line.parameters, state, part, 0.0)
    half = segment.half_drag_in(line, 0, 1.0, e, wind, density, add_scaled(start, part, more))
    weight = node_loads.weight(line, property_of(line, 0, at.LINE_DENSITY))
    return add_scaled(weight, 2.0 * (1.0 + size / property_of(line, 0, at.STIFFNESS)), half)


@kernel
def count_of_places(parameters):
    """Number of places along the tether for its load: `PLACES`, or two between wind points if these are more."""
    return max(len(PLACES), 2 * (wind_points.count_of(parameters) - 1))


@kernel
def place_of(i, count):
    """The i-th of `count` places, as a fraction of the unstretched length, and its weight."""
    if count == len(PLACES):
        return PLACES[i], WEIGHTS[i]
    return 2.0 / count * (i // 2 + (1.0 - BETWEEN if i % 2 == 1 else BETWEEN)), 1.0 / count


@kernel
def load_on_chord(line, ground, chord, state):
    """Mean of f [N/m] on a straight tether without tension, from the ground end [m] along the chord [m]."""
    count, mean = count_of_places(line.parameters), ZERO_VECTOR
    _, e = segment.geometry(chord)
    for i in range(count):
        part, weight = place_of(i, count)
        mean = add_scaled(mean, weight, load_at(line, ground[2] + part * chord[2], state, part, e, 0.0))
    return mean


@kernel
def load_on_shape(line, ground, state, tension, load):
    """F [N/m] and M [N] on the catenary from the ground end [m] with the tension vector t0 [N] and the load q [N/m]."""
    stiffness, count = property_of(line, 0, at.STIFFNESS), count_of_places(line.parameters)
    mean = moment = ZERO_VECTOR
    for i in range(count):
        part, weight = place_of(i, count)
        arc = part * line.length
        r = point_in_space(ZERO_VECTOR, tension, load, arc, stiffness)
        pull = add_scaled(tension, -arc, load)
        size = norm(pull)
        f = load_at(line, ground[2] + r[2], state, part, scale(1.0 / max(size, LEAST), pull), size)
        mean = add_scaled(mean, weight, f)
        moment = add_scaled(moment, weight, cross(r, sub(f, load)))
    return mean, moment


@kernel
def end_forces(line, chord, tension, load, mean, moment, part):
    """End forces of the tether [N], on the catenary with t0 [N] and q [N/m], with F [N/m] and M [N] on it.

    part : fraction of the force shift to apply [-].
    """
    square, change = max(dot(chord, chord), (SHORTEST_CHORD * line.length) ** 2), sub(mean, load)
    shift = sub(scale(0.5 * dot(change, chord), chord), cross(chord, moment))
    shift = scale(part * line.length / square, shift)
    kite_force = add(add_scaled(scale(-1.0, tension), line.length, load), shift)
    return sub(add_scaled(tension, part * line.length, change), shift), kite_force
