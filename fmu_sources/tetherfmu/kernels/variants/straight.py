"""The straight tether: tension EA (c/L - 1) along its chord c, zero if slack.

The air load is distributed to the ends with fractions 1 - xi and xi, which conserves force and moment; if the tether turns
about the ground, a quarter of rho cd d c v^2/2 acts on the kite. Source: docs/models/theory.md, "Straight line".
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..compilation import kernel
from ..equations import node_loads, segment
from ..equations.properties import property_of
from ..linear_algebra.vectors import add, add_scaled, dot, put_at, scale, sub
from ..motion.drum_in_equilibrium import advance_with
from ..step.outputs import wave_time, write_direction
from .chord import chord_load, chord_of, no_work_size, write_common

work_size = no_work_size


@kernel
def initialize(n, parameters, inputs, state, work):
    """No-op: a new state is complete once its ends are set; returns OK. n is 1."""
    return OK


@kernel
def settle(n, parameters, state, work):
    """No-op: a state with its ends is in equilibrium; returns OK. n is 1."""
    return OK


@kernel
def end_forces(parameters, state):
    """Forces of the tether on the supports of its ground end and its kite end [N]."""
    line, _, chord, distance = chord_of(parameters, state)
    _, e = segment.geometry(chord)
    pull = property_of(line, 0, at.STIFFNESS) * max(distance / line.length - 1.0, 0.0)
    mean, moment = chord_load(parameters, state)
    half_weight = scale(0.5 * property_of(line, 0, at.LINE_DENSITY) * line.length, node_loads.free_acceleration(line))
    ground_force = add(add(scale(pull, e), half_weight), scale(distance, sub(mean, moment)))
    return ground_force, add(add(scale(-pull, e), half_weight), scale(distance, moment))


@kernel
def tension_at_ground(n, parameters, state):
    """Ground tension [N] of a state: the component of the force along the chord. n is 1."""
    _, _, chord, _ = chord_of(parameters, state)
    _, e = segment.geometry(chord)
    ground_force, _ = end_forces(parameters, state)
    return dot(ground_force, e)


@kernel
def largest_tension(n, parameters, state, work):
    """The larger end tension [N]. n is 1."""
    _, _, chord, _ = chord_of(parameters, state)
    _, e = segment.geometry(chord)
    ground_force, kite_force = end_forces(parameters, state)
    return max(dot(ground_force, e), -dot(kite_force, e))


advance_in_equilibrium = advance_with(settle, tension_at_ground, largest_tension)


@kernel
def advance(n, parameters, given, before, state, work):
    """Move a state (modified) over a communication step with `StepInputs`; returns a status. n is 1."""
    return advance_in_equilibrium(n, parameters, given, state, work)


@kernel
def outputs_of(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) of a state. n is 1."""
    line, ground, chord, distance = chord_of(parameters, state)
    _, e = segment.geometry(chord)
    stiffness = property_of(line, 0, at.STIFFNESS)
    line_density = property_of(line, 0, at.LINE_DENSITY)
    pull = stiffness * max(distance / line.length - 1.0, 0.0)
    ground_force, kite_force = end_forces(parameters, state)
    write_common(line, distance, ground_force, kite_force, outputs)
    outputs[at.GROUND_TENSION] = dot(ground_force, e)
    outputs[at.KITE_TENSION] = -dot(kite_force, e)
    outputs[at.MAX_TENSION] = max(outputs[at.GROUND_TENSION], outputs[at.KITE_TENSION])
    outputs[at.KITE_END_MASS] = 0.5 * line_density * line.length
    outputs[at.WAVE_TIME] = wave_time(line_density, line.length, distance, pull, stiffness)
    outputs[at.SAG] = 0.0
    write_direction(chord, outputs)
    for k in range(shape_points):
        put_at(outputs, at.SHAPE + 3 * k, add_scaled(ground, k / max(1, shape_points - 1), chord))
