"""The dynamic tether: first state, one communication step, outputs.

These kernels join the parts: inputs -> end motion -> chain -> solver -> state. A step works on a copy of the
state, so a refused step leaves the state of before.
"""

from tetherfmu.kernels.algebra.vectors import get, put
from tetherfmu.kernels.arrays import workspace
from tetherfmu.kernels.communication.drive import drive_of_step, place_ends
from tetherfmu.kernels.communication.inputs import (
    begin,
    check_state,
    check_step,
    copy,
    positions_and_velocities,
    remember,
    vector,
)
from tetherfmu.kernels.communication.outputs import observe_chain
from tetherfmu.kernels.compilation import kernel
from tetherfmu.kernels.equilibrium import newton
from tetherfmu.kernels.motion import implicit_euler, rosenbrock
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK


@kernel
def initialize(n, parameters, inputs, state, work):
    """Fill the state (modified) with the shape that `initial_shape` asks for, between the ends in the inputs.

    Returns a status: OK, INPUT_NOT_FINITE, NO_EQUILIBRIUM or STATE_NOT_FINITE.
    """
    status = begin(n, parameters, inputs, state)
    if status != OK:
        return status
    x, v = positions_and_velocities(n, state)
    if parameters[at.INITIAL_SHAPE] == at.STRAIGHT:
        newton.straighten(n, parameters, x)
        newton.straighten(n, parameters, v)
        return check_state(n, state)
    ground_velocity = get(v, 0)
    kite_velocity = get(v, n)
    spin = (0.0, 0.0, 0.0)
    stretching = 0.0
    if parameters[at.INITIAL_SHAPE] == at.QUASI_STEADY:
        spin, stretching = newton.rigid_motion(n, x, v)
    else:
        put(v, 0, spin)
        put(v, n, spin)
    w = workspace(n, work)
    wind = vector(state, at.WIND)
    status, iterations = newton.find(n, spin, stretching, state[at.LENGTH], wind, parameters, x, v, w)
    state[at.ITERATIONS] = iterations
    put(v, 0, ground_velocity)
    put(v, n, kite_velocity)
    if status != OK:
        return status
    return check_state(n, state)


@kernel
def advance(n, parameters, inputs, step, state, work):
    """Advance the state (modified) by a communication step of `step` [s]; on any status but OK it is left as it was.

    Returns a status: that of `communication.check_step`, OK, STATE_NOT_FINITE or one of the solver's.
    """
    status = check_step(n, parameters, inputs, step, state)
    if status != OK:
        return status
    w = workspace(n, work)
    copy(state, w.trial)
    x, v = positions_and_velocities(n, w.trial)
    drive = drive_of_step(n, parameters, inputs, step, w.trial, x, v)
    if drive.first <= drive.last:
        if parameters[at.FIXED_STEP] > 0.0:
            status = implicit_euler.integrate(n, drive, step, w.trial, x, v, parameters, w)
        else:
            status = rosenbrock.integrate(n, drive, step, w.trial, x, v, parameters, w)
        if status != OK:
            return status
    place_ends(n, drive, step, x, v)
    remember(inputs, step, w.trial)
    status = check_state(n, w.trial)
    if status == OK:
        copy(w.trial, state)
    return status


@kernel
def observe(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) that belong to a state."""
    observe_chain(n, parameters, state, shape_points, outputs, workspace(n, work).mass)
