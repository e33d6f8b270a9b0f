"""The dynamic tether: first shape, motion within a communication step, outputs.

These kernels join the parts: boundary conditions -> chain -> integrator -> state.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK, STEP_BUDGET_SPENT

from ..arrays import positions_and_velocities, state_size
from ..compilation import kernel, view
from ..equations import winch
from ..equations.boundary import conditions_of_chain, place_ends
from ..equations.properties import chain_of
from ..equilibrium import compressed_chain, end_tensions
from ..integrators import (
    drum_in_backward_euler,
    drum_in_fixed_steps,
    drum_step,
    iteration_limit,
    moving_drum,
    second_order,
    step_control,
)
from ..integrators.backward_euler import FixedSteps, given_steps
from ..step.plausibility import note_damping_of_steps, note_stiff_and_slack, note_unconverged, note_unresolved
from . import dynamic_chain, resting_kite


@kernel
def work_size(n):
    """Length of the work array."""
    return max(drum_step.workspace_size(n), drum_in_backward_euler.workspace_size(n), resting_kite.work_size(n))


@kernel
def initialize(n, parameters, inputs, state, work):
    """Give a new state (modified) the shape that `initial_shape` asks for; returns a status.

    A free kite that starts at rest is put there first, and the shape is that of static equilibrium.
    """
    note_damping_of_steps(chain_of(n, parameters, state), parameters, state)
    shape = parameters[at.INITIAL_SHAPE]
    if parameters[at.KITE_START] == at.START_AT_REST:
        status = resting_kite.find(n, parameters, inputs, state, work)
        if status != OK:
            return status
        shape = float(at.STATIC_EQUILIBRIUM)
    return dynamic_chain.initialize(n, parameters, shape, state, work)


@kernel
def move(n, parameters, given, steps, before, state, work):
    """Move the chain of a state (modified) over a communication step with `FixedSteps`; other arguments as of `advance`."""
    x, v = positions_and_velocities(n, state)
    conditions = conditions_of_chain(n, parameters, parameters[at.INITIAL_SHAPE], given, before, x, v)
    status = OK
    has_drum = winch.follows_force(parameters)
    if conditions.first <= conditions.last or has_drum:
        if steps.size > 0.0:
            b = drum_in_backward_euler.workspace(n, work)
            if has_drum:
                status = drum_in_fixed_steps.integrate(conditions, steps, given.step, state, x, v, b)
            else:
                status = second_order.integrate(conditions, steps, given.step, state, x, v, b.steps)
            note_unconverged(b.steps.chain.unconverged[0], steps.size, state)
        elif has_drum:
            status = moving_drum.integrate(conditions, given.step, state, x, v, drum_step.workspace(n, work))
        else:
            w = drum_step.workspace(n, work).chain
            status = step_control.integrate(conditions, given.step, state, x, v, w)
    if status == OK:
        if steps.size == 0.0 and (conditions.first <= conditions.last or has_drum):
            note_stiff_and_slack(chain_of(n, parameters, state), x, state)
        place_ends(conditions, given.step, x, v)
    return status


@kernel
def move_coarsely(n, parameters, given, before, state, work):
    """As `move`, from the start of a communication step that the adaptive solver has given up: with fixed steps of order 2.

    The next step is again one of the adaptive solver, see `step_control.is_given_up`.
    """
    h = given.step * n / at.COARSE_WORK
    for k in range(at.STATE_HEADER, state_size(n)):
        state[k] = before[k]
    status = move(n, parameters, given, FixedSteps(h, float(at.SECOND_ORDER)), before, state, work)
    state[at.SOLVER_STEP], state[at.SOLVER_ERROR] = 0.0, step_control.UNRESOLVED
    note_unresolved(h, state)
    return status


@kernel
def advance(n, parameters, given, before, state, work):
    """Move the chain of a state (modified) over a communication step with `StepInputs`, from the state `before`.

    Returns a status: OK, STATE_NOT_FINITE or one of the integrator's.
    """
    status = move(n, parameters, given, given_steps(parameters), before, state, work)
    if status == STEP_BUDGET_SPENT and move_coarsely(n, parameters, given, before, state, work) == OK:
        status = OK
    if status != OK:
        return status
    x, v = positions_and_velocities(n, state)
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
    dynamic_chain.outputs_of(n, parameters, state, shape_points, outputs, work)
    outputs[at.SOLVER_ITERATION_LIMIT] = iteration_limit.of_step(n, parameters, state[at.LAST_STEP])
