"""The dynamic tether: first state, one communication step, outputs.

These kernels join the parts: inputs -> end motion -> chain -> solver -> state. A step works on a copy of the
state, so a refused step leaves the state of before.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..algebra.vectors import get, put
from ..arrays import positions_and_velocities, shared_arrays
from ..chain.properties import chain_of
from ..communication.acceptance import accept, begin, finish_start, remember, trial_of_step
from ..communication.drive import drive_of_step, place_ends
from ..communication.outputs import observe_chain
from ..compilation import kernel
from ..equilibrium import end_tensions, newton, slower_motion, strut
from ..motion import implicit_euler, step_control
from ..motion.rosenbrock import stages


@kernel
def initialize(n, parameters, inputs, state, work):
    """Fill the state (modified) with the shape that `initial_shape` asks for, between the ends in the inputs.

    Returns a status: OK, INPUT_NOT_FINITE, NO_EQUILIBRIUM or STATE_NOT_FINITE.
    """
    status = begin(n, parameters, inputs, state)
    if status != OK:
        return status
    x, v = positions_and_velocities(n, state)
    chain = chain_of(n, parameters, state)
    if parameters[at.INITIAL_SHAPE] == at.STRAIGHT:
        newton.straighten(chain, x)
        newton.straighten(chain, v)
        return finish_start(n, parameters, status, state)
    ground_velocity = get(v, 0)
    kite_velocity = get(v, n)
    spin = (0.0, 0.0, 0.0)
    stretching = 0.0
    if parameters[at.INITIAL_SHAPE] == at.QUASI_STEADY:
        spin, stretching = newton.rigid_motion(n, x, v)
    else:
        put(v, 0, spin)
        put(v, n, spin)
    body = newton.Body(chain, spin, stretching, x, v)
    w = newton.balance(n, work)
    status, iterations = slower_motion.find(body, w)
    state[at.ITERATIONS] = iterations
    if status == OK:
        end_tensions.store(body, state, w)
    put(v, 0, ground_velocity)
    put(v, n, kite_velocity)
    return finish_start(n, parameters, status, state)


@kernel
def advance(n, parameters, inputs, step, state, work):
    """Advance the state (modified) by a communication step of `step` [s]; on any status but OK it is left as it was.

    Returns a status: that of `acceptance.check_step`, OK, STATE_NOT_FINITE or one of the solver's.
    """
    status, trial = trial_of_step(n, parameters, inputs, step, state, work)
    if status != OK:
        return status
    x, v = positions_and_velocities(n, trial)
    drive = drive_of_step(n, parameters, inputs, step, trial, x, v)
    if drive.first <= drive.last:
        if parameters[at.FIXED_STEP] > 0.0:
            status = implicit_euler.integrate(drive, step, trial, x, v, implicit_euler.descent(n, work))
        else:
            status = step_control.integrate(drive, step, trial, x, v, stages(n, work))
        if status != OK:
            return status
    place_ends(drive, step, x, v)
    remember(parameters, inputs, step, trial)
    end_tensions.forget(trial)
    strut.leave(chain_of(n, parameters, trial), x, v)
    return accept(n, parameters, status, trial, state)


@kernel
def observe(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) that belong to a state; returns a status: OK or OUTPUT_NOT_FINITE."""
    x, v = positions_and_velocities(n, state)
    _, _, mass, _ = shared_arrays(n, work)
    return observe_chain(chain_of(n, parameters, state), state, x, v, shape_points, outputs, mass)
