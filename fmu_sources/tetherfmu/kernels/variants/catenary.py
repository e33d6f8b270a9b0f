"""The catenary tether: weight plus the mean drag along its chord is one uniform load on an elastic line.

Source: docs/models/theory.md, "Elastic catenary".
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

from ..compilation import kernel
from ..equations import node_loads, segment, winch
from ..equations.boundary import move_ends
from ..equations.properties import property_of
from ..equilibrium.elastic_catenary import LEAST, hang, point_in_space
from ..integrators.drum_in_equilibrium import drum_at
from ..linear_algebra.vectors import add, add_scaled, cross, dot, norm, put_at, scale, vector_at
from ..step.outputs import away_from_chord, place_along_chord, wave_time, write_direction
from .chord import chord_load, chord_of, no_work_size, write_common

SAMPLES = 24  # pieces of the catenary in which wave time and sag are found
HALVINGS = 40  # of the two pieces in which it is farthest from its chord
LIGHTEST = 1e-12  # load over EA below which the catenary is a straight line

work_size = no_work_size


@kernel
def uniform_load(line, state):
    """Weight plus mean drag per unstretched length [N/m]; a slack tether catches the wind with all its length."""
    mean, _ = chord_load(line.parameters, state)
    return add(mean, node_loads.weight(line, property_of(line, 0, at.LINE_DENSITY)))


@kernel
def settle(n, parameters, state, work):
    """Store the tension vector of the ground end in the state (modified); returns OK or NO_EQUILIBRIUM. n is 1."""
    line, _, chord, distance = chord_of(parameters, state)
    stiffness = property_of(line, 0, at.STIFFNESS)
    load = uniform_load(line, state)
    if norm(load) * line.length <= LIGHTEST * stiffness:
        _, e = segment.geometry(chord)
        pull = scale(stiffness * max(distance / line.length - 1.0, 0.0), e)
        put_at(state, at.GROUND_TENSION_VECTOR, add_scaled(pull, 0.5 * line.length, load))
        return OK
    tension, iterations = hang(chord, load, line.length, stiffness)
    if iterations < 0:
        return NO_EQUILIBRIUM
    state[at.ITERATIONS] += iterations
    put_at(state, at.GROUND_TENSION_VECTOR, tension)
    return OK


@kernel
def initialize(n, parameters, state, work):
    """Find the tension in a new state (modified); returns a status: OK or NO_EQUILIBRIUM. n is 1."""
    return settle(n, parameters, state, work)


@kernel
def ground_tension(n, parameters, state):
    """Tension at the ground [N] of a state in equilibrium. n is 1."""
    return norm(vector_at(state, at.GROUND_TENSION_VECTOR))


advance_drum = drum_at(settle, ground_tension)


@kernel
def advance(n, parameters, given, before, state, work):
    """Move a state (modified) over a communication step with `StepInputs`; returns a status. n is 1."""
    if winch.follows_force(parameters):
        return advance_drum(n, parameters, given, state, work)
    move_ends(n, given, state)
    return settle(n, parameters, state, work)


@kernel
def farthest_between(low, high, ground, chord, tension, load, stiffness):
    """Distance [m] from the chord where it is largest between two arcs [m]: (t - s q) . a = 0, with a from the chord."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        away = away_from_chord(point_in_space(ground, tension, load, middle, stiffness), ground, chord)
        if dot(away, add_scaled(tension, -middle, load)) > 0.0:
            low = middle
        else:
            high = middle
    return norm(away_from_chord(point_in_space(ground, tension, load, low, stiffness), ground, chord))


@kernel
def write_curve(line, ground, chord, tension, load, outputs):
    """Wave time and sag into the outputs (modified).

    Ground end [m], chord [m], tension vector of the ground end [N], load per unstretched length [N/m].
    """
    length = line.length
    stiffness = property_of(line, 0, at.STIFFNESS)
    piece = length / SAMPLES
    # beside its chord the tether is farthest from it where it is parallel to it: (t - s q) x c = 0; hanging from ends one
    # above the other, in its fold: (t - s q) . q = 0
    turning = cross(load, chord)
    parallel = dot(cross(tension, chord), turning) / max(dot(turning, turning), LEAST)
    fold = dot(tension, load) / max(dot(load, load), LEAST)
    sag, farthest = 0.0, 0.0
    for arc in (parallel, fold):
        arc = min(length, max(0.0, arc))
        distance = norm(away_from_chord(point_in_space(ground, tension, load, arc, stiffness), ground, chord))
        if distance > sag:
            sag, farthest = distance, arc
    crossing, longest = 0.0, 0.0
    for k in range(SAMPLES):
        middle = (k + 0.5) * piece
        pull = norm(add_scaled(tension, -middle, load))
        stretched = piece * (1.0 + pull / stiffness)
        longest = max(longest, stretched)
        crossing += wave_time(property_of(line, 0, at.LINE_DENSITY), piece, stretched, pull, stiffness)
        distance = norm(away_from_chord(point_in_space(ground, tension, load, middle, stiffness), ground, chord))
        if distance > sag:
            sag, farthest = distance, middle
    place = place_along_chord(point_in_space(ground, tension, load, farthest, stiffness), ground, chord)
    if min(place, 1.0 - place) * norm(chord) <= 2.0 * longest:  # it may be farthest beyond an end of the chord
        low, high = max(0.0, farthest - piece), min(length, farthest + piece)
        sag = max(sag, farthest_between(low, high, ground, chord, tension, load, stiffness))
    outputs[at.WAVE_TIME] = crossing
    outputs[at.SAG] = sag


@kernel
def outputs_of(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) that belong to a state. n is 1."""
    line, ground, chord, distance = chord_of(parameters, state)
    load = uniform_load(line, state)
    tension = vector_at(state, at.GROUND_TENSION_VECTOR)
    kite_force = add_scaled(scale(-1.0, tension), line.length, load)
    write_common(line, distance, tension, kite_force, outputs)
    outputs[at.GROUND_TENSION] = norm(tension)
    outputs[at.KITE_TENSION] = norm(kite_force)
    outputs[at.MAX_TENSION] = max(norm(tension), norm(kite_force))
    outputs[at.KITE_END_MASS] = 0.0
    write_direction(tension, outputs)
    write_curve(line, ground, chord, tension, load, outputs)
    for k in range(shape_points):
        arc = line.length * k / max(1, shape_points - 1)
        point = point_in_space(ground, tension, load, arc, property_of(line, 0, at.STIFFNESS))
        put_at(outputs, at.SHAPE + 3 * k, point)
