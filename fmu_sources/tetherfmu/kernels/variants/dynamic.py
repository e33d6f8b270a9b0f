"""The dynamic tether: first shape, motion within a communication step, outputs.

These kernels join the parts: boundary conditions -> chain -> integrator -> state.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..arrays import positions_and_velocities, shared_arrays
from ..compilation import kernel, view
from ..equations import winch
from ..equations.boundary import conditions_of_chain, place_ends
from ..equations.ground import under
from ..equations.properties import chain_of
from ..equilibrium import compressed_chain, end_tensions, newton, solve
from ..equilibrium.rigid_body import Body, rigid_motion, straighten
from ..integrators import drum_in_fixed_steps, drum_step, moving_drum, second_order, step_control
from ..linear_algebra.vectors import ZERO_VECTOR, get, put
from ..step.outputs import outputs_of_chain
from ..step.plausibility import note_damping_of_steps, note_restless, note_stiff_and_slack


@kernel
def work_size(n):
    """Length of the work array."""
    return max(newton.workspace_size(n), drum_step.workspace_size(n), second_order.workspace_size(n))


@kernel
def initialize(n, parameters, state, work):
    """Give a new state (modified) the shape that `initial_shape` asks for; returns a status: OK or NO_EQUILIBRIUM."""
    x, v = positions_and_velocities(n, state)
    chain = chain_of(n, parameters, state)
    note_damping_of_steps(chain, parameters, state)
    if parameters[at.INITIAL_SHAPE] == at.STRAIGHT:
        straighten(chain, x)
        straighten(chain, v)
        return OK
    ground_velocity, kite_velocity = get(v, 0), get(v, n)
    spin, extension_rate = ZERO_VECTOR, 0.0
    if parameters[at.INITIAL_SHAPE] == at.QUASI_STEADY:
        spin, extension_rate = rigid_motion(n, x, v)
    else:
        put(v, 0, ZERO_VECTOR)
        put(v, n, ZERO_VECTOR)
    body = Body(chain, spin, extension_rate, x, v, under(parameters), x, False)
    w = newton.workspace(n, work)
    status, iterations = solve.find(body, w)
    state[at.ITERATIONS] = iterations
    if status == OK:
        end_tensions.store(body, state, w)
    put(v, 0, ground_velocity)
    put(v, n, kite_velocity)
    return status


@kernel
def advance(n, parameters, given, before, state, work):
    """Move the chain of a state (modified) over a communication step with `StepInputs`, from the state `before`.

    Returns a status: OK, STATE_NOT_FINITE or one of the integrator's.
    """
    x, v = positions_and_velocities(n, state)
    conditions = conditions_of_chain(n, parameters, given, before, x, v)
    status = OK
    has_drum = winch.follows_force(parameters)
    if conditions.first <= conditions.last or has_drum:
        if parameters[at.FIXED_STEP] > 0.0:
            b = second_order.workspace(n, work)
            if has_drum:
                status = drum_in_fixed_steps.integrate(conditions, given.step, state, x, v, b)
            else:
                status = second_order.integrate(conditions, given.step, state, x, v, b)
            note_restless(b.chain.restless[0], parameters, state)
        elif has_drum:
            status = moving_drum.integrate(conditions, given.step, state, x, v, drum_step.workspace(n, work))
        else:
            w = drum_step.workspace(n, work).chain
            status = step_control.integrate(conditions, given.step, state, x, v, w)
        if parameters[at.FIXED_STEP] == 0.0:
            note_stiff_and_slack(chain_of(n, parameters, state), x, state)
    if status != OK:
        return status
    place_ends(conditions, given.step, x, v)
    end_tensions.forget(state)
    compressed_chain.leave(chain_of(n, parameters, state), x, v)
    return OK


@view
def velocities_of(n, parameters, state, work):
    """Node velocities [m/s] that belong to a state: those that it has."""
    _, v = positions_and_velocities(n, state)
    return v


@kernel
def outputs_of(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) that belong to a state."""
    x, v = positions_and_velocities(n, state)
    _, _, mass, _ = shared_arrays(n, work)
    outputs_of_chain(chain_of(n, parameters, state), state, x, v, shape_points, outputs, mass)
