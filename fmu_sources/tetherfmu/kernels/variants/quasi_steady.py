"""The quasi-steady tether: at every instant in equilibrium under weight, drag, elasticity and the inertia of turning.

All nodes turn about the ground end with the kite. The chain, drag and end forces equal those of the dynamic tether, without
waves and damping. Source: P. Williams, Cable Modeling Approximations for Rapid Simulation, J. Guidance, Control, and
Dynamics 40 (2017) 1779; docs/models/theory.md, "Quasi-steady".
"""

from tetherfmu.runtime import layout as at

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..equations import winch
from ..equations.boundary import spring_at_ground
from ..equations.properties import chain_of, chain_without_flow
from ..equations.rope import spring_at_winch as tension_at_ground
from ..linear_algebra.vectors import add_scaled, get, put, scale, sub
from ..motion.drum_in_equilibrium import advance_with
from ..rest import newton, solve
from ..rest.rigid_body import rigid_velocity, spring_tensions
from ..step.outputs import outputs_of_chain
from ..step.plausibility import note_pressing

work_size = newton.workspace_size


@kernel
def initialize(n, parameters, inputs, state, work):
    """Solve the shape of a new state (modified); returns a status: OK or NO_EQUILIBRIUM."""
    return solve.settle(n, parameters, state, False, newton.workspace(n, work))


@kernel
def settle(n, parameters, state, work):
    """Solve the equilibrium of a state (modified) between its ends from nearby positions and tensions; a status."""
    return solve.settle(n, parameters, state, True, newton.workspace(n, work))


@kernel
def largest_tension(n, parameters, state, work):
    """Largest tension [N] of all segments of a state in equilibrium."""
    x, _ = positions_and_velocities(n, state)
    w, largest = newton.workspace(n, work), spring_at_ground(n, parameters, state)
    spring_tensions(chain_of(n, parameters, state), x, w.tension)
    for s in range(n):
        largest = max(largest, w.tension[s] + state[at.MISSING_TENSION])
    return largest


advance_in_equilibrium = advance_with(settle, tension_at_ground, largest_tension)


@kernel
def advance(n, parameters, given, before, state, work):
    """Move the shape of a state (modified) over a communication step with `StepInputs`, from the state `before`.

    The search for the next shape starts where the nodes arrive if they move on as in the last step; the state stores this
    motion in place of the velocities of the inner nodes (see `velocities_of`). Returns a status: OK or
    NO_EQUILIBRIUM.
    """
    x, v = positions_and_velocities(n, state)
    w = newton.workspace(n, work)
    spring_tensions(chain_of(n, parameters, before), x, w.tension)
    if not winch.follows_force(parameters):
        for i in range(1, n):
            put(x, i, add_scaled(get(x, i), given.step, get(v, i)))
    status = advance_in_equilibrium(n, parameters, given, state, work)
    last, _ = positions_and_velocities(n, before)
    for i in range(1, n):
        put(v, i, scale(1.0 / given.step, sub(get(x, i), get(last, i))))
    note_pressing(chain_of(n, parameters, state), x, v, False, state)
    return status


@view
def velocities_of(n, parameters, state, work):
    """Node velocities [m/s] of a state, in the work array (modified): nodes move with the body."""
    x, v = positions_and_velocities(n, state)
    w = newton.workspace(n, work)
    put(w.move, 0, get(v, 0))
    put(w.move, n, get(v, n))
    rigid_velocity(solve.body_of(n, parameters, state, x, w.move))
    return w.move


@kernel
def outputs_of(n, parameters, state, shape_points, outputs, work):
    """Write all outputs (modified) of a state."""
    x, _ = positions_and_velocities(n, state)
    v = velocities_of(n, parameters, state, work)
    mass = newton.workspace(n, work).mass
    outputs_of_chain(chain_without_flow(n, parameters, state), state, x, v, shape_points, outputs, mass)
    if winch.follows_force(parameters):
        outputs[at.GROUND_TENSION] = tension_at_ground(n, parameters, state)
