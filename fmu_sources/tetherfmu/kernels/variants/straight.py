"""The straight tether: tension EA (c/L - 1) along its chord c, none if slack.

The load of the air goes to the ends so that its force and its moment are kept, parts 1 - xi and xi; for a tether that turns
about the ground a quarter of rho cd d c v^2/2 comes to the kite. Source: docs/theory.md, "Straight line".
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..algebra.vectors import add, along, dot, put_at, scale, sub
from ..chain import segment
from ..chain.properties import property_of
from ..communication.acceptance import accept, begin, finish_start, remember, trial_of_step
from ..communication.ends import move_ends
from ..communication.outputs import finish, wave_time, write_direction
from ..compilation import kernel
from .chord import chord_load, chord_of, write_common


@kernel
def initialize(n, parameters, inputs, state, work):
    """Fill the state (modified); returns a status: OK, INPUT_NOT_FINITE or STATE_NOT_FINITE. n is 1."""
    return finish_start(n, parameters, begin(n, parameters, inputs, state), state)


@kernel
def advance(n, parameters, inputs, step, state, work):
    """Advance the state (modified) by a communication step of `step` [s]; on any status but OK it is left as it was.

    Returns a status: that of `acceptance.check_step`, OK or STATE_NOT_FINITE. n is 1.
    """
    status, trial = trial_of_step(n, parameters, inputs, step, state, work)
    if status == OK:
        move_ends(n, parameters, inputs, step, trial)
        remember(parameters, inputs, step, trial)
    return accept(n, parameters, status, trial, state)


@kernel
def observe(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified); returns a status: OK or OUTPUT_NOT_FINITE. n is 1."""
    line, ground, chord, distance = chord_of(parameters, state)
    _, e = segment.geometry(chord)
    stiffness = property_of(line, 0, at.STIFFNESS)
    line_density = property_of(line, 0, at.LINE_DENSITY)
    pull = stiffness * max(distance / line.length - 1.0, 0.0)
    mean, moment = chord_load(parameters, state)
    half_weight = (0.0, 0.0, -0.5 * line_density * line.length * parameters[at.GRAVITY])
    ground_force = add(add(scale(pull, e), half_weight), scale(distance, sub(mean, moment)))
    kite_force = add(add(scale(-pull, e), half_weight), scale(distance, moment))
    write_common(line, distance, ground_force, kite_force, outputs)
    outputs[at.GROUND_TENSION] = dot(ground_force, e)
    outputs[at.KITE_TENSION] = -dot(kite_force, e)
    outputs[at.MAX_TENSION] = max(outputs[at.GROUND_TENSION], outputs[at.KITE_TENSION])
    outputs[at.KITE_END_MASS] = 0.5 * line_density * line.length
    outputs[at.WAVE_TIME] = wave_time(line_density, line.length, distance, pull, stiffness)
    outputs[at.SAG] = 0.0
    write_direction(chord, outputs)
    for k in range(shape_points):
        put_at(outputs, at.SHAPE + 3 * k, along(ground, k / max(1, shape_points - 1), chord))
    return finish(state, outputs)
