"""Shared code of the dynamic tether and the lines of a system: initial shape of a chain between its ends, and outputs."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.status import OK

from ..arrays import positions_and_velocities, shared_arrays
from ..compilation import kernel
from ..equations.properties import chain_of
from ..equations.rope import feels_rope, tension_at_winch, tension_of_rope
from ..equations.winch import follows_force
from ..linear_algebra.vectors import ZERO_VECTOR, get, norm, put, vector_at
from ..notes import note
from ..step.outputs import outputs_of_chain
from ..step.plausibility import note_damping_of_steps
from . import newton, solve
from .rigid_body import straighten


@kernel
def initialize(n, parameters, shape, state, work):
    """Put a new state (modified) into its `initial_shape`; returns a status: OK or NO_EQUILIBRIUM.

    If no shape that moves with its ends exists, use the shape at rest, and note it.
    """
    x, v = positions_and_velocities(n, state)
    chain = chain_of(n, parameters, state)
    note_damping_of_steps(chain, parameters, state)
    if shape == at.STRAIGHT:
        straighten(chain, x)
        straighten(chain, v)
        return OK
    w = newton.workspace(n, work)
    if shape == at.QUASI_STEADY:
        status = solve.settle(n, parameters, state, False, w)
        if status == OK or norm(get(v, 0)) + norm(get(v, n)) == 0.0:  # at rest the shape is the same
            return status
        note(state, limits.STARTED_AT_REST, 1.0, 0.0)
    ground_velocity, kite_velocity = get(v, 0), get(v, n)
    put(v, 0, ZERO_VECTOR)
    put(v, n, ZERO_VECTOR)
    status = solve.settle(n, parameters, state, False, w)
    put(v, 0, ground_velocity)
    put(v, n, kite_velocity)
    return status


@kernel
def outputs_of(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) of a state."""
    x, v = positions_and_velocities(n, state)
    _, _, mass, _ = shared_arrays(n, work)
    outputs_of_chain(chain_of(n, parameters, state), state, x, v, shape_points, outputs, mass)
    if follows_force(parameters) and feels_rope(parameters):
        tension = state[at.TENSION_AT_DRUM]
        if state[at.LAST_STEP] <= 0.0:
            tension = tension_at_winch(n, parameters, state)
            if norm(vector_at(state, at.GROUND_TENSION_VECTOR)) == 0.0:
                tension = tension_of_rope(chain_of(n, parameters, state), x, v, 1.0)
        outputs[at.GROUND_TENSION] = tension
        outputs[at.MAX_TENSION] = max(outputs[at.MAX_TENSION], tension)
