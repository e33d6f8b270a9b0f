"""The dynamic tether: initial shape, motion within a communication step, outputs.

It is a system of one line, known at compile time except for the number of segments (`lines.OneLine`).
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..equations.lines import ONE_LINE_ROOM, OneLine, System
from ..equations.rope import tension_at_winch as tension_at_ground  # noqa: F401 - of `winch_start`
from ..equations.winch import follows_force
from ..flat_arrays import part
from ..line.backward_euler import given_steps
from ..motion.fixed_steps import most_iterations
from ..motion.states import end_coordinates
from ..points import room
from ..rest import dynamic_chain, resting_kite
from . import moving_lines


@kernel
def work_size(n):
    """Length of the work array."""
    return max(ONE_LINE_ROOM + room.line_work_size(n), resting_kite.work_size(n))


@kernel
def initialize(n, parameters, inputs, state, work):
    """Put a new state (modified) into its `initial_shape`; returns a status.

    A free kite that starts at rest is first moved there; the shape is then in static equilibrium.
    """
    shape = parameters[at.INITIAL_SHAPE]
    if parameters[at.KITE_START] == at.START_AT_REST:
        status = resting_kite.find(n, parameters, inputs, state, work)
        if status != OK:
            return status
        shape = float(at.STATIC_EQUILIBRIUM)
    return dynamic_chain.initialize(n, parameters, shape, state, work)


@kernel
def advance(n, parameters, given, before, state, work):
    """Move the chain of a state (modified) over a communication step with `StepInputs`, from the state `before`.

    Returns a status: OK, STATE_NOT_FINITE or one of the integrator's.
    """
    system = System(OneLine(n), parameters, part(work, 0, 0), state, work)
    moving_lines.begin_line(system, 0, parameters[at.INITIAL_SHAPE], given, before)
    status = moving_lines.advance(system, given.step, before)
    if status == OK:
        moving_lines.end_line(system, 0, given.step)
        if room.count_of(system) > 0:
            end_coordinates(system, given.step)
    return status


@view
def velocities_of(n, parameters, state, work):
    """Node velocities [m/s] of a state: they are stored in it."""
    _, v = positions_and_velocities(n, state)
    return v


@kernel
def outputs_of(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) of a state."""
    dynamic_chain.outputs_of(n, parameters, state, shape_points, outputs, work)
    steps, has_drum = given_steps(parameters), follows_force(parameters)
    outputs[at.SOLVER_ITERATION_LIMIT] = most_iterations(n, steps, has_drum, state[at.LAST_STEP])
