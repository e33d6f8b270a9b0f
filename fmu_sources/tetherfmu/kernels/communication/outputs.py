"""Outputs of a tether: of a chain of nodes, and the pieces that tethers without nodes share."""

from math import atan2, inf, sqrt

from tetherfmu.kernels.algebra.vectors import along, dot, get, norm, sub
from tetherfmu.kernels.chain import nodes, segment
from tetherfmu.kernels.compilation import kernel
from tetherfmu.runtime import layout as at

from .inputs import positions_and_velocities, set_vector, vector

SLACKEST = 1e-9  # wave_time counts a tension as at least this part of EA


@kernel
def wave_time(line_density, rest_length, length, tension, axial_stiffness):
    """Travel time [s] of a transverse wave over a piece of tether: sqrt(mu l0 l/T).

    Mass per unstretched length [kg/m], unstretched and present length [m], tension [N], EA [N]. A slack piece would
    never be crossed: its tension counts as at least 1e-9 EA.
    """
    return sqrt(line_density * rest_length * length / max(tension, SLACKEST * axial_stiffness))


@kernel
def write_direction(leaving, outputs):
    """Elevation and azimuth [rad] of the direction in which the tether leaves the ground, into the outputs (modified)."""
    outputs[at.GROUND_ELEVATION] = atan2(leaving[2], sqrt(leaving[0] ** 2 + leaving[1] ** 2))
    outputs[at.GROUND_AZIMUTH] = atan2(leaving[1], leaving[0])


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
    growth = state[at.REELING] / state[at.LENGTH]
    largest = -inf
    slack = 0
    crossing = 0.0
    compliance = 0.0
    softness = 0.0
    sag = 0.0
    for s in range(n):
        rest = nodes.rest_length(s, state[at.LENGTH], parameters)
        _, _, tension, length = segment.forces(
            s, n, segment.BY_LENGTH, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1), rest, growth, wind, parameters
        )
        largest = max(largest, tension)
        if length < rest:
            slack += 1
        stiffness = parameters[scalars + at.STIFFNESS * n + s]
        line_density = parameters[scalars + at.LINE_DENSITY * n + s]
        crossing += wave_time(line_density, rest, length, tension, stiffness)
        compliance += rest / stiffness
        softness += rest / parameters[scalars + at.DAMPING * n + s]
        sag = max(sag, distance_to_chord(get(x, s), get(x, 0), sub(get(x, n), get(x, 0))))
    outputs[at.MAX_TENSION] = largest
    outputs[at.SLACK_SEGMENTS] = slack
    outputs[at.KITE_STIFFNESS] = 1.0 / compliance
    outputs[at.KITE_DAMPING] = 1.0 / softness
    outputs[at.WAVE_TIME] = crossing
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
def observe_chain(n, parameters, state, shape_points, outputs, mass):
    """Write all outputs (modified) that belong to the nodes of a state; `mass` (modified) holds n + 1 numbers."""
    x, v = positions_and_velocities(n, state)
    length = state[at.LENGTH]
    wind = vector(state, at.WIND)
    nodes.node_masses(n, length, parameters, mass)
    ground_force, ground_tension = nodes.end_force(n, False, x, v, length, state[at.REELING], wind, mass, parameters)
    kite_force, kite_tension = nodes.end_force(n, True, x, v, length, state[at.REELING], wind, mass, parameters)
    set_vector(outputs, at.GROUND_FORCE, ground_force)
    set_vector(outputs, at.KITE_FORCE, kite_force)
    outputs[at.GROUND_TENSION] = ground_tension
    outputs[at.KITE_TENSION] = kite_tension
    outputs[at.TETHER_LENGTH] = length
    write_direction(sub(get(x, 1), get(x, 0)), outputs)
    outputs[at.KITE_END_MASS] = mass[n] - parameters[at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n + n]
    survey(n, parameters, state, x, v, outputs)
    shape(n, parameters, x, shape_points, outputs)
