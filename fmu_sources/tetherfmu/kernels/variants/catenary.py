"""The catenary tether: weight plus mean drag is one uniform load on an elastic line.

The shape is the catenary under the mean drag along the chord: one pass, see `shape_load.py`.

Source: docs/models/theory.md, "Elastic catenary" and "Catenary on the ground".
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

from ..compilation import kernel
from ..equations import segment
from ..equations.ground import has_ground
from ..equations.properties import property_of
from ..linear_algebra.vectors import add, add_scaled, dot, norm, put_at, scale, sub, vector_at
from ..motion.drum_in_equilibrium import advance_with
from ..notes import note
from ..rest.elastic_catenary import crossing_and_sag, hang, point_in_space
from ..step.outputs import write_direction
from .chord import chord_of, no_work_size, write_common
from .shape_load import end_forces, load_on_chord, load_on_shape
from .touchdown import lowest, part_in_air, rest_on_ground, write_lying

LIGHTEST = 1e-12  # load over EA below which the catenary is a straight line

work_size = no_work_size


@kernel
def hang_in_wind(line, ground, chord, state):
    """Load per unstretched length [N/m], tension vector at the ground end [N], and the number of iterations (-1: none).

    For a catenary under the mean load on its shape, which is the catenary under the load along its chord.
    """
    stiffness = property_of(line, 0, at.STIFFNESS)
    load = load_on_chord(line, ground, chord, state)
    if norm(load) * line.length <= LIGHTEST * stiffness:
        distance, e = segment.geometry(chord)
        pull = stiffness * max(distance / line.length - 1.0, 0.0)
        return load, add_scaled(scale(0.5 * line.length, load), pull, e), 0
    tension, iterations = hang(chord, load, line.length, stiffness)
    if iterations < 0:
        return load, tension, iterations
    on_shape, _ = load_on_shape(line, ground, state, tension, load)
    change = sub(on_shape, load)
    note(state, limits.LOAD_OFF_CHORD, dot(change, change) / dot(on_shape, on_shape), limits.MOST_OFF_CHORD)
    tension, more = hang(chord, on_shape, line.length, stiffness)
    return on_shape, tension, iterations + more if more >= 0 else more


@kernel
def settle(n, parameters, state, work):
    """Store the end tension vectors in the state (modified); returns OK or NO_EQUILIBRIUM. n is 1.

    If the tether lies on the ground, also store the length on the ground.
    """
    line, ground, chord, _ = chord_of(parameters, state)
    load, tension, iterations = hang_in_wind(line, ground, chord, state)
    if iterations < 0:
        return NO_EQUILIBRIUM
    state[at.ITERATIONS] += iterations
    put_at(state, at.GROUND_TENSION_VECTOR, tension)
    put_at(state, at.KITE_TENSION_VECTOR, add_scaled(scale(-1.0, tension), line.length, load))
    state[at.LYING_LENGTH] = 0.0
    if has_ground(parameters) and iterations > 0:
        rest_on_ground(line, load, state)
    return OK


@kernel
def load_of(line, state):
    """Load per unstretched length [N/m] of a catenary without ground contact, from the tension vectors in a state."""
    both = add(vector_at(state, at.GROUND_TENSION_VECTOR), vector_at(state, at.KITE_TENSION_VECTOR))
    return scale(1.0 / line.length, both)


@kernel
def note_depth(parameters, state):
    """Note in the state (modified) the depth [m] of a tether below a ground without contact, both ends being above it."""
    plane = parameters[at.GROUND_HEIGHT]
    if not has_ground(parameters) and state[at.WARNED_VALUES + limits.GROUND_IGNORED] == 0.0:
        line, ground, chord, _ = chord_of(parameters, state)
        tension = vector_at(state, at.GROUND_TENSION_VECTOR)
        if tension[2] < 0.0 and min(ground[2], ground[2] + chord[2]) >= plane:
            stiffness = property_of(line, 0, at.STIFFNESS)
            point, _ = lowest(ground, tension, load_of(line, state), line.length, stiffness)
            depth = max(0.0, plane - point[2])
            note(state, limits.GROUND_IGNORED, depth * depth, limits.SHALLOW * line.length)


@kernel
def initialize(n, parameters, inputs, state, work):
    """Solve the tension in a new state (modified); returns a status: OK or NO_EQUILIBRIUM. n is 1."""
    status = settle(n, parameters, state, work)
    note_depth(parameters, state)
    return status


@kernel
def forces_of(line, ground, chord, state):
    """End forces of the tether [N] in a state in equilibrium; tension vector of its shape [N] and load [N/m]."""
    tension, load = vector_at(state, at.GROUND_TENSION_VECTOR), load_of(line, state)
    lies = has_ground(line.parameters) and state[at.LYING_LENGTH] > 0.0
    if lies or norm(load) == 0.0:
        return tension, vector_at(state, at.KITE_TENSION_VECTOR), tension, load
    part = part_in_air(line, load, state) if has_ground(line.parameters) else 1.0
    mean, moment = load_on_shape(line, ground, state, tension, load)
    return *end_forces(line, chord, tension, load, mean, moment, part), tension, load


@kernel
def tension_at_ground(n, parameters, state):
    """Ground tension [N] of a state in equilibrium. n is 1."""
    line, ground, chord, _ = chord_of(parameters, state)
    force, _, _, _ = forces_of(line, ground, chord, state)
    return norm(force)


@kernel
def largest_tension(n, parameters, state, work):
    """The larger end tension [N]. n is 1."""
    line, ground, chord, _ = chord_of(parameters, state)
    ground_force, kite_force, _, _ = forces_of(line, ground, chord, state)
    return max(norm(ground_force), norm(kite_force))


advance_in_equilibrium = advance_with(settle, tension_at_ground, largest_tension)


@kernel
def advance(n, parameters, given, before, state, work):
    """Move a state (modified) over a communication step with `StepInputs`; returns a status. n is 1."""
    status = advance_in_equilibrium(n, parameters, given, state, work)
    note_depth(parameters, state)
    return status


@kernel
def outputs_of(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) of a state. n is 1."""
    line, ground, chord, distance = chord_of(parameters, state)
    ground_force, kite_force, tension, load = forces_of(line, ground, chord, state)
    write_common(line, distance, ground_force, kite_force, outputs)
    outputs[at.GROUND_TENSION] = norm(ground_force)
    outputs[at.KITE_TENSION] = norm(kite_force)
    outputs[at.MAX_TENSION] = max(norm(ground_force), norm(kite_force))
    outputs[at.KITE_END_MASS] = 0.0
    if has_ground(parameters) and state[at.LYING_LENGTH] > 0.0:
        load, _, _ = hang_in_wind(line, ground, chord, state)
        write_lying(line, chord, load, state, shape_points, outputs)
        return
    write_direction(ground_force, outputs)
    outputs[at.WAVE_TIME], outputs[at.SAG] = crossing_and_sag(line, ground, line.length, ground, chord, tension, load)
    for k in range(shape_points):
        arc = line.length * k / max(1, shape_points - 1)
        point = point_in_space(ground, tension, load, arc, property_of(line, 0, at.STIFFNESS))
        put_at(outputs, at.SHAPE + 3 * k, point)
