"""The quasi-steady tether: at every instant in equilibrium under weight, drag, elasticity and the inertia of turning.

All nodes turn about the ground end with the kite. The same chain as the dynamic tether, with its drag and end forces, but
no waves and no damping. Source: P. Williams, Cable Modeling Approximations for Rapid Simulation, J. Guidance, Control, and
Dynamics 40 (2017) 1779; docs/theory.md, "Quasi-steady".
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..algebra.vectors import along, get, put, scale, sub
from ..arrays import copy, positions_and_velocities, trial_state
from ..chain.properties import chain_of
from ..communication.acceptance import accept, begin, finish_start, remember, trial_of_step
from ..communication.ends import move_ends
from ..communication.outputs import observe_chain
from ..compilation import kernel, view
from ..equilibrium import end_tensions, newton, slower_motion


@view
def body_of(n, parameters, state):
    """The `newton.Body` that turns about the ground end with the kite of a state."""
    x, v = positions_and_velocities(n, state)
    spin, stretching = newton.rigid_motion(n, x, v)
    return newton.Body(chain_of(n, parameters, state), spin, stretching, x, v)


@kernel
def settle(n, parameters, state, warm, w):
    """Bring the inner nodes of a state (modified) into equilibrium between its ends; returns a status.

    warm : whether the inner nodes and the tensions in w.tension are close to it.
    """
    body = body_of(n, parameters, state)
    if warm:
        found, iterations = newton.follow(body, w)
        state[at.ITERATIONS] += iterations
        if found:
            end_tensions.store(body, state, w)
            return OK
    status, iterations = slower_motion.find(body, w)
    state[at.ITERATIONS] += iterations
    if status == OK:
        end_tensions.store(body, state, w)
    return status


@kernel
def initialize(n, parameters, inputs, state, work):
    """Fill the state (modified); returns a status: OK, INPUT_NOT_FINITE, NO_EQUILIBRIUM or STATE_NOT_FINITE."""
    status = begin(n, parameters, inputs, state)
    if status == OK:
        status = settle(n, parameters, state, False, newton.balance(n, work))
    return finish_start(n, parameters, status, state)


@kernel
def advance(n, parameters, inputs, step, state, work):
    """Advance the state (modified) by a communication step of `step` [s]; on any status but OK it is left as it was.

    The next shape is sought where the nodes come to if they move on as in the last step; this motion is what the state
    keeps as velocities of the inner nodes. Returns a status: that of `acceptance.check_step`, OK, NO_EQUILIBRIUM or
    STATE_NOT_FINITE.
    """
    status, trial = trial_of_step(n, parameters, inputs, step, state, work)
    if status != OK:
        return status
    x, v = positions_and_velocities(n, trial)
    w = newton.balance(n, work)
    newton.tensions(chain_of(n, parameters, state), x, w.tension)
    for i in range(1, n):
        put(x, i, along(get(x, i), step, get(v, i)))
    move_ends(n, parameters, inputs, step, trial)
    remember(parameters, inputs, step, trial)
    status = settle(n, parameters, trial, True, w)
    last, _ = positions_and_velocities(n, state)
    for i in range(1, n):
        put(v, i, scale(1.0 / step, sub(get(x, i), get(last, i))))
    return accept(n, parameters, status, trial, state)


@kernel
def observe(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) that belong to a state; returns a status: OK or OUTPUT_NOT_FINITE."""
    trial = trial_state(n, work)
    copy(state, trial)
    body = body_of(n, parameters, trial)
    newton.rigid_velocity(body)
    return observe_chain(body.chain, state, body.x, body.v, shape_points, outputs, newton.balance(n, work).mass)
